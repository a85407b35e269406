//! Kernels that compute wrong are refused at their first use; those that compute right are tested once.

use crate::common;
use std::any::type_name_of_val;
use std::fs;
use std::path::PathBuf;

use crate::common::BROKEN_FIELDS;
use crate::common::apart;
use crate::common::layer::{self, LAYERS, Layer};
use crate::common::program::{Folder, SCENE, device, expect};
use energywave::Ray;
use energywave::image::DepthAlong;
use energywave::scene::{Antialias, Method, Reduction, Sampling};
use energywave::{Error, Renderer, RendererOptions, Scene};
use glam::DVec3;

const OUT_OF_RESOURCES: i32 = -5;

/// Where entries are kept, as the program reads it.
const CACHE: &str = "ENERGYWAVE_CACHE_DIR";

/// Runs a test in a process of its own, with the layer and a folder for entries.
#[track_caller]
fn alone<Test: FnOnce()>(test: Test) {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().join("cache");
    let variables = [
        (LAYERS, layer::path()),
        (CACHE, cache.to_str().unwrap().to_owned()),
    ];
    let variables = variables
        .each_ref()
        .map(|(name, value)| (*name, value.as_str()));
    apart::run(type_name_of_val(&test), &variables, test);
}

/// The layer, and where entries are kept.
fn begin() -> (Layer, PathBuf) {
    (Layer::new(), PathBuf::from(std::env::var(CACHE).unwrap()))
}

fn renderer(extra: &str, skips_self_test: bool) -> Renderer {
    let mut options = RendererOptions::default();
    options.skips_self_test = skips_self_test;
    let options = common::compiled_with(&options, extra);
    Renderer::with_options(&common::device(), &options).unwrap()
}

/// A scene by every way to take pixels, also with depths, and as rays.
fn draws() -> Vec<(&'static str, Scene)> {
    let mut lit = common::empty_scene(20, 10);
    lit.spheres.push(common::sphere([0.3, 0.2, 0.1], 1.5));
    let axis = [0.1, 0.2, 1.0];
    lit.tori.push(common::torus([0.0, 0.1, 0.0], axis, 0.9));
    let with = |method| {
        let mut scene = lit.clone();
        scene.integration.method = method;
        scene
    };
    let tiles = common::by(Sampling::Tiles);
    let strict = Method::Exact {
        tolerance: 1e-4, // of another rule, with kernels of its own
        sampling: Sampling::Pixels,
    };
    let mut hidden = common::squared(&with(tiles));
    hidden.depth = Some(common::depths(&hidden, DepthAlong::Ray, |x, _| {
        3.0 + f64::from(x)
    }));
    let jittered = Method::Jittered {
        divisions: common::DIVISIONS,
        seed: 1,
    };
    let mut roots = common::squared(&with(tiles));
    roots.spheres.clear();
    roots.integration.reduction = Reduction::Rms;
    let mut ends = with(tiles);
    ends.tori.clear();
    let reaching = &mut ends.spheres[0];
    (reaching.radius, reaching.reach) = (0.1, Some(0.9));
    let mut means = with(tiles);
    means.integration.antialias = Antialias::Footprint;
    vec![
        ("simpson", with(Method::simpson(common::DIVISIONS))),
        ("jittered", with(jittered)),
        ("pixels", with(strict)),
        ("tiles", with(tiles)),
        ("depth", hidden),
        ("roots", roots),
        ("ends", ends),
        ("means", means),
        ("rays", lit),
    ]
}

fn draw(renderer: &mut Renderer, name: &str, scene: &Scene) -> energywave::Result<Vec<f32>> {
    if name == "rays" {
        let ray = Ray::between(DVec3::new(0.2, -3.0, 1.0), DVec3::new(0.1, 3.0, -1.0));
        let values = renderer.integrate(scene, &[ray])?;
        return Ok(values.as_flattened().iter().map(|v| *v as f32).collect());
    }
    Ok(renderer.render(scene)?.as_slice().to_vec())
}

#[test]
fn kernels_that_compute_wrong_are_refused_until_somebody_insists() {
    alone(|| {
        let (_layer, folder) = begin();
        let not_a_number = "-Dtwice_inverse_sqrt(x)=(NAN*(x))";
        for (name, scene) in draws() {
            let right = draw(&mut renderer("", false), name, &scene).unwrap();
            for spoiled in [BROKEN_FIELDS, not_a_number] {
                let mut strict = renderer(spoiled, false);
                for _ in 0..2 {
                    let Err(error) = draw(&mut strict, name, &scene) else {
                        panic!("{name} passes with {spoiled}");
                    };
                    let words = error.to_string();
                    assert!(matches!(error, Error::SelfTest { .. }), "{name}: {words}");
                    assert!(
                        words.contains("computes wrong") && words.contains("choose another device")
                    );
                    assert!(words.starts_with(&common::device().name), "{words}");
                }
                let wrong = draw(&mut renderer(spoiled, true), name, &scene).unwrap();
                assert_ne!(wrong, right, "{name}");
            }
        }
        let entries = fs::read_dir(folder).unwrap().count();
        assert_eq!(entries, draws().len(), "of right kernels only");
    });
}

#[test]
fn kernels_are_tested_once_for_each_device_driver_and_build() {
    alone(|| {
        let (layer, folder) = begin();
        let launches = |extra: &str, scene: &Scene| {
            let before = layer.calls("clEnqueueNDRangeKernel");
            let image = renderer(extra, false).render(scene).unwrap();
            (layer.calls("clEnqueueNDRangeKernel") - before, image)
        };
        for (name, scene) in &draws()[..4] {
            let _ = fs::remove_dir_all(&folder);
            let (first, image) = launches("", scene);
            let (second, again) = launches("", scene);
            assert!(second < first, "{name}: {first} launches, then {second}");
            assert_eq!(image, again);
            assert_eq!(launches("-DOTHER_BUILD", scene).0, first, "{name}");

            // What does not fit is no entry.
            for file in fs::read_dir(&folder).unwrap() {
                let path = file.unwrap().path();
                let mut bytes = fs::read(&path).unwrap();
                bytes[20] ^= 1;
                fs::write(path, bytes).unwrap();
            }
            assert_eq!(launches("", scene).0, first, "{name}");
            assert_eq!(launches("", scene).0, second, "{name}");
        }
        // Without a folder they are tested at every start.
        fs::remove_dir_all(&folder).unwrap();
        fs::write(&folder, "a file").unwrap();
        let scene = &draws()[0].1;
        assert_eq!(launches("", scene).0, launches("", scene).0);
        fs::remove_file(&folder).unwrap();
    });
}

#[test]
fn the_kernels_that_are_tested_are_those_that_draw() {
    alone(|| {
        let (layer, _) = begin();
        for (name, scene) in draws() {
            let before = layer.calls("clBuildProgram");
            draw(&mut renderer("", false), name, &scene).unwrap();
            assert_eq!(layer.calls("clBuildProgram") - before, 1, "{name}");
        }
    });
}

#[test]
fn a_test_that_cannot_be_done_is_an_error_and_done_again() {
    alone(|| {
        let (layer, _) = begin();
        let (_, scene) = draws().swap_remove(2);
        let image = renderer("", true).render(&scene).unwrap();
        let mut renderer = renderer("", false);
        for function in [
            "clCreateCommandQueue",
            "clCreateBuffer",
            "clEnqueueNDRangeKernel",
        ] {
            layer.fail(function, 1, OUT_OF_RESOURCES);
            let error = renderer.render(&scene).unwrap_err();
            assert!(!matches!(error, Error::SelfTest { .. }), "{error}");
        }
        layer.disarm();
        assert_eq!(renderer.render(&scene).unwrap(), image);
    });
}

#[test]
fn the_program_refuses_with_5_and_writes_nothing() {
    let folder = Folder::new();
    let run = |arguments: &[&str]| {
        let mut command = folder.command();
        command.args(["render", SCENE, "-o", "out.png", "--device", device()]);
        command
            .args(arguments)
            .env("ENERGYWAVE_BUILD_OPTIONS", BROKEN_FIELDS);
        command.env("ENERGYWAVE_CACHE_DIR", folder.path().join("cache"));
        command.output().unwrap()
    };
    expect(&run(&[]), 5, "insist on this one with --no-self-test");
    assert!(folder.names().is_empty(), "left: {:?}", folder.names());
    expect(&run(&["--no-self-test"]), 0, "");
    assert_eq!(folder.names(), ["out.png"]);
}
