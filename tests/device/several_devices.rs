//! One frame on several devices is the frame that one of them draws.

use crate::common;
use std::ops::ControlFlow;
use std::sync::LazyLock;

use crate::common::apart::apart;
use crate::common::program::{Folder, device, expect, stderr};
use energywave::image::DepthAlong;
use energywave::scene::{
    Antialias, Collider, Lattice, LightElement, Lighting, Metaballs, Method, Particles, PointList,
    Sampling,
};
use energywave::verify::built_in_rays;
use energywave::{Device, Devices, Error, RadianceImage, Renderer, RendererOptions, Scene};
use glam::DVec3;
use serde_json::Value;

/// PoCL shows its CPU as often as it is told to, to a whole process.
pub const POCL_DEVICES: (&str, &str) = ("POCL_DEVICES", "pthread pthread pthread");

/// Three devices of the kind under test; elsewhere one device thrice, with a context and a queue each.
fn devices() -> &'static [Device] {
    static FOUND: LazyLock<Vec<Device>> = LazyLock::new(|| {
        let all = Devices::discover().select_all("all").unwrap();
        let Ok(first) = Device::select(device()) else {
            return all; // a part of a name: it fits all three
        };
        let equal: Vec<Device> = all.into_iter().filter(|d| d.name == first.name).collect();
        match equal.len() {
            3 => equal,
            _ => vec![first; 3],
        }
    });
    &FOUND
}

pub fn on(count: usize) -> Renderer {
    Renderer::on_devices(&devices()[..count], &RendererOptions::default()).unwrap()
}

fn is_pocl() -> bool {
    let is_pocl = devices()[0].platform == "Portable Computing Language";
    if !is_pocl {
        println!("only PoCL can show one device twice: not checked here");
    }
    is_pocl
}

fn ring(width: u32, height: u32, sampling: Option<Sampling>) -> Scene {
    let mut scene = common::empty_scene(width, height);
    let tilted = common::torus([0.1, 0.0, 0.2], [0.2, 0.1, 1.0], 0.9);
    scene.tori.push(tilted);
    if let Some(sampling) = sampling {
        scene.integration.method = common::by(sampling);
    }
    scene
}

/// The values of a frame by each way to draw it.
pub fn draw(renderer: &mut Renderer, scene: &Scene, way: usize) -> Vec<f32> {
    let row = 4 * scene.image.width as usize;
    let mut values = vec![-7.0; row * scene.image.height as usize];
    match way {
        0 => values = renderer.render(scene).unwrap().as_slice().to_vec(),
        1 => renderer.render_into(scene, &mut values).unwrap(),
        2 => values = renderer.render_mapped(scene).unwrap().to_vec(),
        _ => {
            let stride = row + 4 * way;
            let mut target = vec![-7.0; stride * scene.image.height as usize];
            renderer
                .render_rows(scene, 0..scene.image.height, &mut target, stride)
                .unwrap();
            assert!(
                target
                    .chunks(stride)
                    .all(|row_of| row_of[row..].iter().all(|v| *v == -7.0))
            );
            values = target
                .chunks(stride)
                .flat_map(|r| r[..row].to_vec())
                .collect();
        }
    }
    values
}

#[test]
fn equal_devices_draw_the_image_of_one_to_the_bit() {
    apart(&[POCL_DEVICES], || {
        let (pixels, tiles) = (Some(Sampling::Pixels), Some(Sampling::Tiles));
        let mut scenes = vec![
            ring(96, 64, None),
            ring(37, 101, None),
            ring(130, 1, None),
            ring(1, 1, None),
            ring(64, 50, pixels),
            ring(99, 53, pixels),
            ring(7, 3, pixels),
            ring(130, 300, tiles),
            ring(200, 129, tiles),
            ring(300, 1, tiles),
            ring(9, 5, tiles),
        ];
        for sampling in [None, pixels, tiles] {
            let mut scene = ring(90, 150, sampling);
            let near = |column: u32, row: u32| if column + row < 110 { 2.5 } else { 4.0 };
            scene.depth = Some(common::depths(&scene, DepthAlong::Ray, near));
            scenes.push(scene.clone());
            for k in 0..5 {
                let place = [0.2 * f64::from(k) - 0.4, 0.3, 0.5];
                scene.spheres.push(common::sphere(place, 0.4));
            }
            scenes.push(scene);
        }
        for mut scene in [ring(37, 101, None), ring(130, 33, None)] {
            scene.integration.method = Method::Jittered {
                divisions: 20,
                seed: 1,
            };
            scenes.push(scene);
        }
        let mut one = on(1);
        let mut several = [on(2), on(3)];
        for scene in &scenes {
            let (size, sampling) = (scene.image, scene.sampling());
            let expected = draw(&mut one, scene, 0);
            assert!(expected.iter().any(|value| *value > 0.0 && *value != 1.0));
            for renderer in &mut several {
                for frame in 0..8 {
                    let found = draw(renderer, scene, frame % 4);
                    let shares = renderer.shares();
                    assert!(
                        found == expected,
                        "{size:?} {sampling:?} {frame}: {shares:?}"
                    );
                    assert_eq!(
                        shares.iter().map(|rows| rows.len() as u32).sum::<u32>(),
                        size.height
                    );
                }
            }
        }
    });
}

/// A ring among particles, streaks, metaballs, a ball and a mesh that it lights.
fn crowded(antialias: Antialias) -> Scene {
    let mut scene = ring(90, 70, Some(Sampling::Pixels));
    scene.integration.antialias = antialias;
    let points = |count| {
        let lattice = Lattice {
            columns: [3, 2],
            ..Lattice::new(count, 0.4)
        };
        PointList::lattice(&lattice).unwrap()
    };
    let mut surface = Metaballs::new(points(6), 0.6);
    surface.translate = DVec3::new(0.1, -1.6, 0.9);
    scene.metaballs.push(surface);
    scene.particles.push(Particles::new(points(40), 0.3));
    for k in 0..5 {
        let x = 0.3 * f64::from(k) - 0.6;
        scene.light_elements.push(LightElement::Streak {
            ends: [DVec3::new(x, -0.4, -0.5), DVec3::new(-x, 0.3, 0.6)],
            radii: [0.1, 0.15, 0.05],
            light: DVec3::new(0.2, 0.6, 1.0),
        });
    }
    let ball = Collider::sphere(DVec3::new(-0.7, 0.1, 0.2), 0.3);
    scene.colliders.push(ball);
    let mut mesh = common::meshes::ball(8);
    (mesh.scale, mesh.translate) = (0.3, DVec3::new(0.7, 0.2, 0.1));
    scene.meshes.push(mesh);
    scene.lighting = Some(Lighting::default());
    scene
}

#[test]
fn equal_devices_draw_particles_and_surfaces_as_one_does() {
    apart(&[POCL_DEVICES], || {
        let mut one = on(1);
        for antialias in [Antialias::None, Antialias::Footprint] {
            let scene = crowded(antialias);
            let expected = draw(&mut one, &scene, 0);
            for count in [2, 3] {
                let mut renderer = on(count);
                for frame in 0..4 {
                    let found = draw(&mut renderer, &scene, frame);
                    assert!(found == expected, "{antialias:?}, {count} devices: {frame}");
                    // Later shares follow the time that each took.
                    let rows = renderer.shares().iter().filter(|rows| !rows.is_empty());
                    assert!(frame > 0 || rows.count() > 1, "{:?}", renderer.shares());
                }
                for remove in [
                    |scene: &mut Scene| scene.metaballs.clear(),
                    |scene: &mut Scene| scene.particles.clear(),
                    |scene: &mut Scene| scene.light_elements.clear(),
                    |scene: &mut Scene| scene.colliders.clear(),
                    |scene: &mut Scene| scene.meshes.clear(),
                    |scene: &mut Scene| scene.lighting = None,
                ] {
                    let mut less = scene.clone();
                    remove(&mut less);
                    assert!(draw(&mut renderer, &less, 0) != expected);
                }
            }
        }
    });
}

#[test]
fn every_device_draws_and_the_costs_add_up() {
    apart(&[POCL_DEVICES], || {
        let scene = ring(128, 256, Some(Sampling::Tiles));
        let (mut one, mut three) = (on(1), on(3));
        assert!(one.shares().is_empty() && three.shares().is_empty());
        one.render(&scene).unwrap();
        three.render(&scene).unwrap();
        let rows: Vec<usize> = three.shares().iter().map(ExactSizeIterator::len).collect();
        assert!(
            rows.iter().all(|rows| *rows > 0 && rows % 64 == 0),
            "{rows:?}"
        );
        let (alone, together) = (one.last_cost(), three.last_cost());
        assert_eq!(alone.integrals, together.integrals);
        assert!(together.kernel.as_nanos() > 0);
        one.render_mapped(&ring(64, 64, None)).unwrap();
        three.render_mapped(&ring(64, 64, None)).unwrap();
        assert_eq!(one.last_cost().integrals, 64 * 64);
        assert_eq!(three.last_cost().samples, one.last_cost().samples);
    });
}

#[test]
fn single_rays_are_traced_as_on_one_device() {
    apart(&[POCL_DEVICES], || {
        let (mut one, mut two) = (on(1), on(2));
        for known in &built_in_rays().unwrap()[..5] {
            let (scene, rays) = (known.scene.clone().unwrap(), [known.ray]);
            assert_eq!(
                two.integrate(&scene, &rays).unwrap(),
                one.integrate(&scene, &rays).unwrap()
            );
        }
    });
}

#[test]
fn progress_hears_of_all_devices_and_stops_them() {
    apart(&[POCL_DEVICES], || {
        let mut scene = ring(512, 512, None);
        scene.integration.method = Method::simpson(2000);
        let mut renderer = on(3);
        for stops_at in [0.0, 0.5] {
            let mut calls_after = 0;
            let stopped = renderer.render_with_progress(&scene, &mut |share| {
                if share < stops_at {
                    return ControlFlow::Continue(());
                }
                calls_after += 1;
                ControlFlow::Break(())
            });
            assert!(matches!(stopped, Err(Error::Interrupted)), "{stops_at}");
            assert_eq!(calls_after, 1);
        }
        let mut heard = Vec::new();
        let image = renderer.render_with_progress(&scene, &mut |share| {
            heard.push(share);
            ControlFlow::Continue(())
        });
        assert!(heard.windows(2).all(|pair| pair[0] <= pair[1]), "{heard:?}");
        assert!((0.9999..=1.0).contains(heard.last().unwrap()), "{heard:?}");
        assert!(image.unwrap() == on(1).render(&scene).unwrap());
    });
}

#[test]
fn a_list_without_devices_or_with_the_reference_is_refused() {
    apart(&[POCL_DEVICES], || {
        let options = RendererOptions::default();
        let none = Renderer::on_devices(&[], &options).unwrap_err();
        assert!(none.to_string().contains("needs a device"), "{none}");
        let reference = Device::select("reference").unwrap();
        assert!(Renderer::on_devices(std::slice::from_ref(&reference), &options).is_ok());
        let both = [devices()[0].clone(), reference];
        let mixed = Renderer::on_devices(&both, &options).unwrap_err();
        assert!(
            mixed
                .to_string()
                .contains("built-in reference shares no frame"),
            "{mixed}"
        );
    });
}

#[test]
fn the_program_draws_with_all_devices_or_those_of_a_list() {
    apart(&[POCL_DEVICES], || {
        if !is_pocl() {
            return;
        }
        let folder = Folder::new();
        let render = |name: &str, arguments: &[&str]| {
            let mut command = folder.command();
            command.args([
                "render",
                common::program::SCENE,
                "--size",
                "130x150",
                "-o",
                name,
            ]);
            command.env("POCL_DEVICES", "pthread pthread");
            command.args(arguments).output().unwrap()
        };
        let one = render("one.exr", &["--device", "0"]);
        expect(&one, 0, "device: 0: pthread");
        for (name, choice) in [
            ("all.exr", "all"),
            ("list.exr", "0,1"),
            ("turned.exr", "1, CPU"),
        ] {
            let several = render(name, &["--device", choice]);
            expect(&several, 0, "device: 0: pthread");
            assert!(stderr(&several).contains("device: 1: pthread"));
            let image = |name: &str| RadianceImage::open(folder.path().join(name)).unwrap();
            assert!(image(name) == image("one.exr"), "{name}");
        }
        for (choice, code, words) in [
            ("0,0", 4, "names a device twice: 0: pthread"),
            ("0,cpu", 4, "names a device twice"),
            ("0,9", 4, "no device \"9\""),
            ("0,", 4, "no device \"\""),
            ("all,0", 4, "no device \"all\""),
            ("0,pthread", 4, "fits 2 devices"),
            ("0,reference", 2, "choose it alone"),
        ] {
            expect(&render("wrong.exr", &["--device", choice]), code, words);
        }
        assert!(!folder.names().contains(&"wrong.exr".to_owned()));
    });
}

#[test]
fn every_subcommand_takes_several_devices() {
    apart(&[POCL_DEVICES], || {
        if !is_pocl() {
            return;
        }
        let folder = Folder::new();
        let run = |arguments: &[&str]| {
            let mut command = folder.command();
            command
                .env("POCL_DEVICES", "pthread pthread")
                .env("ENERGYWAVE_DEVICE", "all");
            let output = command.args(arguments).output().unwrap();
            expect(&output, 0, "device: 1: pthread");
            serde_json::from_slice::<Value>(&output.stdout).unwrap()
        };
        let rays: Vec<Value> = serde_json::from_str(include_str!("../data/rays.json")).unwrap();
        let few = serde_json::to_string(&rays[..3]).unwrap();
        std::fs::write(folder.path().join("few.json"), few).unwrap();
        let rows = run(&["verify", "--json", "--rays", "few.json"]);
        let rows = rows.as_array().unwrap();
        let of = |index: &str| {
            let is_of = |row: &&Value| row["device"].as_str().unwrap().starts_with(index);
            rows.iter().filter(is_of).count()
        };
        assert_eq!((rows.len(), of("0: pthread"), of("1: pthread")), (12, 6, 6));

        let scene = common::program::SCENE;
        let speed = run(&[
            "bench",
            scene,
            "--json",
            "--seconds",
            "0",
            "--size",
            "64x64",
        ]);
        assert!(
            speed["device"].as_str().unwrap().contains(" + pthread"),
            "{speed}"
        );
        let errors = run(&[
            "compare",
            scene,
            "--json",
            "--seconds",
            "0",
            "--size",
            "16x16",
        ]);
        assert_eq!(errors.as_array().unwrap().len(), 8);
    });
}

#[test]
fn all_devices_are_none_without_opencl() {
    let folder = Folder::new();
    let empty = folder.path().join("vendors");
    std::fs::create_dir(&empty).unwrap();
    let mut command = folder.command();
    command.args([
        "render",
        common::program::SCENE,
        "-o",
        "out.png",
        "--device",
        "all",
    ]);
    let output = command.env("OCL_ICD_VENDORS", &empty).output().unwrap();
    expect(
        &output,
        4,
        "no device \"all\" (the OpenCL loader finds no driver",
    );
}
