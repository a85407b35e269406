//! Holds what meshes leave of the light that waves cast to the reference, which asks of every place of a core whether
//! it is seen.

use energywave::image::ImageSize;
use energywave::scene::{Camera, Curve, Lighting, Mesh, Segment, Sphere, Sun, Torus, TriangleList};
use energywave::{Renderer, Scene, reference};
use glam::DVec3;

use super::common::{device, meshes};

/// What 16 pieces leave, relative to the light without shadows: in the mean over penumbrae, and at worst.
const MEAN: f64 = 0.014;
const WORST: f64 = 0.056;

/// What float32 leaves of light that nothing hides.
const EXACT: f64 = 2e-3;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn scene() -> Scene {
    let mut scene = Scene::new(Camera::new(v(0.0, -6.0, 3.0), DVec3::ZERO));
    let mut lighting = Lighting::default();
    lighting.shadows = true;
    scene.lighting = Some(lighting);
    let mut ball = meshes::ball(24);
    ball.scale = 0.4;
    scene.meshes.push(ball);
    scene
}

/// Scenes in which a ball is before a core of each form.
fn scenes() -> Vec<(&'static str, Scene)> {
    let with = |name, add: fn(&mut Scene)| {
        let mut scene = scene();
        add(&mut scene);
        (name, scene)
    };
    vec![
        with("a point", |scene| {
            scene.spheres.push(Sphere {
                center: v(0.1, 0.2, 1.5),
                ..Sphere::default()
            });
        }),
        with("a segment", |scene| {
            scene
                .segments
                .push(Segment::new(v(-0.9, 0.1, 1.2), v(0.8, 0.3, 1.6)));
        }),
        with("a ring", |scene| {
            scene.tori.push(Torus {
                center: v(0.1, 0.1, 1.3),
                ..Torus::new(0.7)
            });
        }),
        with("a curve", |scene| {
            let points = [v(-0.9, 0.1, 1.2), v(0.1, 1.2, 1.0), v(0.8, -0.4, 1.6)];
            scene.curves.push(Curve::new(points));
        }),
    ]
}

#[test]
fn what_a_ball_leaves_of_a_core_is_that_of_the_reference() {
    let mut renderer = Renderer::new(&device()).unwrap();
    let mut random = fastrand::Rng::with_seed(31);
    let points: Vec<DVec3> = (0..200)
        .map(|_| v(3.0 * random.f64() - 1.5, 3.0 * random.f64() - 1.5, -0.6))
        .collect();
    let normals = vec![DVec3::Z; points.len()];
    for (name, scene) in scenes() {
        let mut open = scene.clone();
        open.lighting.as_mut().unwrap().shadows = false;
        let found = renderer.irradiance(&scene, &points, &normals).unwrap();
        let whole = renderer.irradiance(&open, &points, &normals).unwrap();
        let truth = reference::irradiance(&scene, &points, &normals).unwrap();
        let all = reference::irradiance(&open, &points, &normals).unwrap();
        let (mut sum, mut penumbrae, mut dark, mut lit) = (0.0, 0, 0, 0);
        let mut most: f64 = 0.0;
        let mut off_without: f64 = 0.0;
        for k in 0..points.len() {
            let share = truth[k][0] / all[k][0];
            let found_share = f64::from(found[k][0]) / all[k][0];
            off_without = off_without.max((f64::from(whole[k][0]) / all[k][0] - share).abs());
            if share == 0.0 {
                dark += 1;
                assert!(found_share < WORST, "{name}: {found_share} in the umbra");
                sum += found_share;
            } else if share > 1.0 - 1e-9 {
                lit += 1;
                assert!(
                    (found_share - 1.0).abs() < EXACT || found_share > 1.0 - WORST,
                    "{name}: {found_share} where all is seen"
                );
                if (found_share - 1.0).abs() < EXACT {
                    let same = f64::from((found[k][0] / whole[k][0] - 1.0).abs());
                    assert!(same < 1e-4, "{name}: {same:.1e} off what has no shadows");
                }
            } else {
                penumbrae += 1;
                sum += (found_share - share).abs();
                most = most.max((found_share - share).abs());
            }
        }
        let mean = sum / f64::from(penumbrae.max(1));
        println!(
            "{name}: {lit} see all, {dark} nothing, {penumbrae} a part: off by {mean:.4} in the mean, {most:.4} at most"
        );
        assert!(dark + penumbrae > 10 && lit > 50, "{name}");
        assert!(mean < MEAN && most < WORST, "{name}");
        assert!(off_without > 0.5, "{name}: there are shadows");
    }
}

/// A square floor, and a box that stands on it.
fn room() -> Vec<Mesh> {
    let floor = [
        v(-3.0, -3.0, -0.5),
        v(3.0, -3.0, -0.5),
        v(3.0, 3.0, -0.5),
        v(-3.0, 3.0, -0.5),
    ];
    let floor = TriangleList::new(floor.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let corners = (0..8).map(|k| v(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)));
    let corners = corners.map(|it| 0.8 * it - v(0.4, 0.4, 0.49)).collect();
    let sides = [
        [0, 1, 3, 2],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 3, 7, 5],
    ];
    let triangles = sides
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    let cube = TriangleList::new(corners, triangles.collect()).unwrap();
    vec![
        Mesh::new(floor),
        Mesh {
            albedo: v(0.9, 0.4, 0.2),
            ..Mesh::new(cube)
        },
    ]
}

#[test]
fn lit_meshes_are_those_of_the_reference() {
    let mut scene = scene();
    scene.meshes.clear();
    scene.meshes.extend(room());
    scene.image = ImageSize {
        width: 40,
        height: 30,
    };
    scene.segments.push(Segment {
        coefficient: 2.0,
        color: v(1.0, 0.6, 0.3),
        ..Segment::new(v(-1.2, -0.6, 0.9), v(-0.9, 1.1, 0.6))
    });
    scene.tori.push(Torus {
        center: v(0.9, 0.4, 0.6),
        ..Torus::new(0.4)
    });
    let lighting = scene.lighting.as_mut().unwrap();
    lighting.ambient = DVec3::splat(0.02);
    lighting.sun = Some(Sun {
        color: v(0.0, 0.1, 0.3),
        ..Sun::new(v(-1.0, -0.5, 2.0))
    });
    let see = |scene: &Scene, renderer: &mut Renderer| {
        energywave::internals::see_all_surfaces(renderer, scene)
            .unwrap()
            .1
    };
    let mut on_device = Renderer::new(&device()).unwrap();
    let mut on_reference = Renderer::new(&energywave::Device::reference()).unwrap();
    let found = see(&scene, &mut on_device);
    let truth = see(&scene, &mut on_reference);
    let off = |found: &[f32]| {
        // Without alpha.
        let light = |values: &[f32]| -> Vec<f64> {
            let pixels = values.chunks(4);
            pixels
                .flat_map(|pixel| pixel[..3].iter().map(|it| f64::from(*it)))
                .collect()
        };
        let (found, truth) = (light(found), light(&truth));
        let sum: f64 = found.iter().zip(&truth).map(|(a, b)| (a - b).abs()).sum();
        sum / truth.iter().sum::<f64>()
    };
    println!("off by {:.4} of all light", off(&found));
    assert!(off(&found) < 0.002);
    // Each part of the light counts.
    type Change = fn(&mut Lighting);
    let changes: [Change; 4] = [
        |it| it.shadows = false,
        |it| it.cast = false,
        |it| it.sun = None,
        |it| it.ambient = DVec3::ZERO,
    ];
    for (k, change) in changes.into_iter().enumerate() {
        let mut other = scene.clone();
        change(other.lighting.as_mut().unwrap());
        let off = off(&see(&other, &mut on_device));
        assert!(off > 0.004, "change {k}: {off}");
    }
}
