//! Meshes against float64 by another method, what they hide, and what hides them.

use energywave::image::{ClipRange, DepthAlong, DepthImage, ImageSize};
use energywave::internals::{mesh_rays, see_all_surfaces};
use energywave::scene::{
    Antialias, Camera, Collider, Mesh, Metaballs, PointList, Sphere, TriangleList,
};
use energywave::{Device, RadianceImage, Renderer, Scene};
use glam::{DMat4, DVec3, dcamera as camera};

use crate::common::meshes::{ball, hills};
use crate::common::{self, device, options, outer_lane_widths};

/// What float32 leaves of a length, of the length: of corners, of the ray, and of the plane that both span.
const LENGTH_ERROR: f64 = 1e-5;

/// Rays, of a thousand, that may pass an edge on another side than float64's, by what float32 leaves of both.
const BESIDE: usize = 1;

/// What adding up in another order may change.
const ROUNDING: f32 = 1e-5;

fn renderer(extra: &str) -> Renderer {
    common::renderer(device().lanes, extra)
}

fn scene_of(camera: Camera, meshes: impl IntoIterator<Item = Mesh>) -> Scene {
    let mut scene = Scene::new(camera);
    scene.image = ImageSize {
        width: 97,
        height: 70,
    };
    scene.integration.antialias = Antialias::None;
    scene.meshes = meshes.into_iter().collect();
    scene
}

/// A square across the view from -y, of which every ray in the middle column passes an edge.
fn square(y: f64, half: f64) -> Mesh {
    let corners = [
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 1.0],
        [-1.0, 1.0],
        [0.0, 0.0],
    ];
    let corners = corners.map(|[x, z]| half * DVec3::new(x, 0.0, z) + y * DVec3::Y);
    let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    Mesh::new(TriangleList::new(corners.to_vec(), triangles).unwrap())
}

fn facing_square() -> Scene {
    let mut scene = scene_of(
        Camera::new(-4.0 * DVec3::Y, DVec3::ZERO),
        [square(0.0, 1.0)],
    );
    scene.image.height = 97; // rays along both diagonals
    scene
}

/// Returns how many of a thousand lengths are off.
fn off(renderer: &mut Renderer, scene: &Scene) -> usize {
    let (lengths, _) = see_all_surfaces(renderer, scene).unwrap();
    let across = (lengths.len() / scene.image.pixels()).isqrt() as u32;
    let truth = mesh_rays(scene, across);
    assert_eq!(truth.len(), lengths.len());
    let pairs = lengths.iter().zip(&truth);
    let is_off = |(found, ray): &(&f32, &energywave::internals::MeshRay)| {
        let found = f64::from(**found);
        let is_same = !found.is_finite() && !ray.length.is_finite();
        let is_close = (found / ray.length - 1.0).abs() <= LENGTH_ERROR;
        !(is_same || is_close)
    };
    let count = pairs.filter(is_off).count();
    (1000 * count).div_ceil(lengths.len())
}

fn hills_from_above(corners: u32) -> Scene {
    let camera = Camera::new(DVec3::new(1.0, -7.0, 4.0), DVec3::ZERO);
    scene_of(camera, [hills(corners)])
}

fn placed_balls(rows: u32) -> Scene {
    let one = ball(rows);
    let mut other = one.clone();
    other.scale = 0.4;
    other.translate = DVec3::new(0.9, -1.2, 0.3);
    scene_of(
        Camera::new(DVec3::new(0.5, -5.0, 1.5), DVec3::ZERO),
        [one, other],
    )
}

#[test]
fn lengths_are_those_of_float64_up_to_a_million_triangles() {
    let mut renderer = renderer("");
    for (name, mut scene) in [
        ("few hills", hills_from_above(5)),
        ("hills", hills_from_above(708)),
        ("balls", placed_balls(30)),
        ("many", placed_balls(500)),
        ("square", facing_square()),
    ] {
        let found = off(&mut renderer, &scene);
        assert!(found <= BESIDE, "{name}: {found}");
        // Finer rays, most of them along the planes of their pixels.
        scene.integration.antialias = Antialias::Footprint;
        let found = off(&mut renderer, &scene);
        assert!(found <= BESIDE, "{name}, smooth: {found}");
    }
}

#[test]
fn lengths_are_the_same_on_one_lane_and_many_and_open_edges_lose_rays() {
    let scenes = [facing_square(), placed_balls(30), hills_from_above(40)];
    for lanes in outer_lane_widths() {
        let mut renderer = Renderer::with_options(&device(), &options(lanes, "")).unwrap();
        for scene in &scenes {
            let found = off(&mut renderer, scene);
            assert!(found <= BESIDE, "{lanes} lanes: {found}");
        }
    }
    let spoiled = off(&mut renderer("-DOPEN_EDGES"), &facing_square());
    assert!(spoiled > BESIDE, "the spoiled build passed: {spoiled}");
    // Planes in the place of curved surfaces.
    let mut smooth = placed_balls(30);
    smooth.integration.antialias = Antialias::Footprint;
    let spoiled = off(&mut renderer("-DFLAT=1.0f -DLEAST_COSINE=0.0f"), &smooth);
    assert!(spoiled > BESIDE, "the spoiled build passed: {spoiled}");
}

#[test]
fn every_camera_sees_the_same_mesh() {
    let mut renderer = renderer("");
    let frame = |scene: &mut Scene, projection: DMat4| {
        let view =
            camera::rh::view::look_at_mat4(DVec3::new(0.5, -5.0, 1.5), DVec3::ZERO, DVec3::Z);
        let camera = Camera::from_clip(view, projection, ClipRange::ZeroToOne);
        scene.camera = camera;
    };
    let parallel = camera::rh::proj::directx::orthographic(-1.5, 1.5, -1.0, 1.0, 0.1, 20.0);
    let perspective = camera::rh::proj::directx::perspective(0.6, 97.0 / 70.0, 0.1, 20.0);
    let mut leaning = perspective;
    leaning.x_axis.y += 0.3;
    for (name, projection) in [
        ("parallel", parallel),
        ("perspective", perspective),
        ("leaning", leaning),
    ] {
        let mut scene = placed_balls(60);
        frame(&mut scene, projection);
        for antialias in [Antialias::None, Antialias::Footprint] {
            scene.integration.antialias = antialias;
            let found = off(&mut renderer, &scene);
            assert!(found <= BESIDE, "{name}: {found}");
        }
    }
    let mut inside = placed_balls(60);
    inside.camera = Camera::new(DVec3::new(0.2, 0.1, 0.0), DVec3::X);
    inside.camera.near = 0.1;
    let (lengths, light) = see_all_surfaces(&mut renderer, &inside).unwrap();
    assert!(lengths.iter().all(|length| *length < 1.3));
    assert!(light.as_chunks::<4>().0.iter().all(|pixel| pixel[0] > 0.0));
}

fn glow(y: f64) -> Sphere {
    Sphere {
        center: DVec3::new(0.2, y, 0.1),
        ..Sphere::default()
    }
}

fn is_close(found: &[f32], expected: &[f32]) -> bool {
    let mut pairs = found.iter().zip(expected);
    pairs.all(|(found, expected)| (found - expected).abs() <= ROUNDING * (1.0 + expected.abs()))
}

/// Takes the light of meshes off a picture.
fn without(image: &RadianceImage, light: &[f32]) -> Vec<f32> {
    let pairs = image.as_slice().iter().zip(light).enumerate();
    pairs
        .map(|(index, (all, own))| if index % 4 == 3 { *all } else { all - own })
        .collect()
}

#[test]
fn a_mesh_hides_what_the_depths_up_to_it_hide() {
    let mut renderer = renderer("");
    for (y, antialias) in [
        (0.0, Antialias::None),
        (0.0, Antialias::Footprint),
        (3.0, Antialias::None),
    ] {
        let mut scene = placed_balls(40);
        scene.integration.antialias = antialias;
        scene.spheres.push(glow(y)); // the first ball is around it, or before it
        let image = renderer.render(&scene).unwrap();
        let (lengths, light) = see_all_surfaces(&mut renderer, &scene).unwrap();
        let across = (lengths.len() / scene.image.pixels()).isqrt() as u32;
        let size = ImageSize {
            width: across * scene.image.width,
            height: across * scene.image.height,
        };
        let mut expected = scene.clone();
        expected.meshes.clear();
        let open = renderer.render(&expected).unwrap();
        expected.depth = Some(DepthImage::new(size, DepthAlong::Ray, lengths).unwrap());
        let hidden = renderer.render(&expected).unwrap();
        assert!(
            is_close(&without(&image, &light), hidden.as_slice()),
            "{y} {antialias:?}"
        );
        assert!(!is_close(&without(&image, &light), open.as_slice()));
    }
}

#[test]
fn a_mesh_before_the_projection_plane_hides_all_light() {
    let mut renderer = renderer("");
    let mut scene = scene_of(
        Camera::new(-4.0 * DVec3::Y, DVec3::ZERO),
        [square(-3.5, 1.0)],
    );
    scene.spheres.push(glow(0.0));
    let image = renderer.render(&scene).unwrap();
    let (lengths, light) = see_all_surfaces(&mut renderer, &scene).unwrap();
    assert!(lengths.iter().all(|length| *length < 1.0));
    assert!(
        without(&image, &light)
            .iter()
            .step_by(4)
            .all(|red| *red == 0.0)
    );
}

#[test]
fn no_mesh_changes_nothing_and_meshes_alone_are_a_picture() {
    let mut renderer = renderer("");
    let mut scene = scene_of(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO), []);
    scene.spheres.push(glow(0.0));
    let before = renderer.render(&scene).unwrap();
    scene.meshes.push(square(0.0, 0.7));
    let with = renderer.render(&scene).unwrap();
    scene.meshes.clear();
    assert_eq!(
        renderer.render(&scene).unwrap().as_slice(),
        before.as_slice()
    );
    assert_ne!(with.as_slice(), before.as_slice());
    let alone = scene_of(
        Camera::new(-4.0 * DVec3::Y, DVec3::ZERO),
        [square(0.0, 0.7)],
    );
    let alone = renderer.render(&alone).unwrap();
    let lit = alone
        .as_slice()
        .iter()
        .step_by(4)
        .filter(|red| **red > 0.05);
    assert!(lit.count() > 200);
}

#[test]
fn surfaces_hide_each_other_and_the_light_of_what_is_hidden_does_not_show() {
    let mut renderer = renderer("");
    for antialias in [Antialias::None, Antialias::Footprint] {
        let mut scene = scene_of(
            Camera::new(-6.0 * DVec3::Y, DVec3::ZERO),
            [square(0.0, 1.2)],
        );
        scene.integration.antialias = antialias;
        scene.meshes[0].albedo = DVec3::X;
        let mut collider = Collider::sphere(DVec3::new(0.8, 0.0, 0.0), 0.5);
        collider.color = DVec3::Y;
        scene.colliders.push(collider);
        let points = PointList::new(vec![DVec3::new(-0.8, 0.0, 0.0)]).unwrap();
        let mut surface = Metaballs::new(points, 1.0);
        surface.threshold = 0.25;
        surface.color = DVec3::Z;
        scene.metaballs.push(surface);
        let truth = Renderer::new(&Device::reference()).unwrap().render(&scene);
        let (found, truth) = (renderer.render(&scene).unwrap(), truth.unwrap());
        let pixels = found.as_slice().as_chunks::<4>().0;
        for (channel, count) in [(0, 500), (1, 100), (2, 100)] {
            let alone = |pixel: &&[f32; 4]| {
                pixel[channel] > 0.05 && pixel[..3].iter().sum::<f32>() == pixel[channel]
            };
            assert!(pixels.iter().filter(alone).count() > count, "{channel}");
        }
        let pairs = found.as_slice().iter().zip(truth.as_slice());
        let off = pairs
            .filter(|(found, truth)| (*found - *truth).abs() > 1e-3)
            .count();
        assert!(500 * off <= found.as_slice().len(), "{off}");
    }
}

#[test]
fn what_rays_met_is_kept_until_something_changes() {
    let mut renderer = renderer("");
    let mut scene = placed_balls(40);
    let mut launches = |scene: &Scene| {
        renderer.render(scene).unwrap();
        renderer.last_cost().launches
    };
    let first = launches(&scene);
    let again = launches(&scene.clone());
    assert!(again < first, "{again} of {first}");
    scene.meshes[0].albedo = DVec3::X;
    assert_eq!(launches(&scene), again, "a colour moves nothing");
    scene.meshes[0].translate.x = 0.3;
    assert_eq!(launches(&scene), first);
    scene.camera.eye.x += 0.1;
    assert_eq!(launches(&scene), first);
    assert_eq!(launches(&scene), again);
}

#[test]
fn surfaces_that_hide_nothing_are_seen_through_all_light() {
    let mut renderer = renderer("");
    let camera = || Camera::new(-4.0 * DVec3::Y, DVec3::ZERO);
    let mut scene = scene_of(camera(), [square(0.0, 0.7)]);
    let surfaces = renderer.render(&scene).unwrap();
    scene.spheres.push(glow(1.0));
    let hidden = renderer.render(&scene).unwrap();
    scene.integration.hidden_surfaces = false;
    let through = renderer.render(&scene).unwrap();
    scene.meshes.clear();
    let light = renderer.render(&scene).unwrap();
    let sum = surfaces.as_slice().iter().zip(light.as_slice());
    let differs = |image: &RadianceImage| {
        let pairs = sum.clone().zip(image.as_slice()).enumerate();
        let off = |(index, ((a, b), c)): (usize, ((&f32, &f32), &f32))| {
            index % 4 < 3 && (a + b - c).abs() > ROUNDING * c.abs()
        };
        pairs.filter(|pair| off(*pair)).count()
    };
    assert_eq!(differs(&through), 0);
    assert!(differs(&hidden) > 600);
}
