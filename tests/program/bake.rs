//! `energywave bake`: volumes are those of the reference, files are what other programs read, and what cannot be is
//! refused.

use std::fs;
use std::path::Path;
use std::process::Command;

use energywave::glam::DVec3;
use energywave::scene::{Sphere, Torus};
use energywave::volume::{CellValue, Grid, Volume};
use energywave::{Device, ErrorKind, Renderer, RendererOptions, Scene};

use crate::bad_scenes::CAMERA;
use crate::common;
use crate::common::program::{Folder, expect, stderr};

/// What a cell may be off, of the brightest: what float32 leaves of distances.
const ERROR: f64 = 1e-4;

const RING: &str = "[[torus]]\nmajor_radius = 0.7\nradius = 0.05\nreach = 0.4\npeak = 1.0\ncolor = [0.2, 0.5, 1.0]\n\
    [[sphere]]\ncenter = [0.1, 0.2, 0.3]\nradius = 0.1\nreach = 0.5\npeak = 2.0\n";

fn bake(renderer: &mut Renderer, scene: &Scene, grid: Grid, value: CellValue) -> Volume {
    let nothing = &mut |_: f32| std::ops::ControlFlow::Continue(());
    renderer.bake(scene, grid, value, nothing).unwrap()
}

/// Returns the greatest difference of any cell, of the brightest.
fn difference(one: &Volume, other: &Volume) -> f64 {
    let [columns, rows, layers] = one.grid().cells();
    let mut worst = 0.0_f64;
    for number in 0..columns * rows * layers {
        let cell = [
            number % columns,
            number / columns % rows,
            number / columns / rows,
        ];
        for (one, other) in one.at(cell).into_iter().zip(other.at(cell)) {
            worst = worst.max(f64::from((one - other).abs()));
        }
    }
    worst / f64::from(other.greatest())
}

#[test]
fn a_volume_is_that_of_the_reference_whatever_its_size_and_its_sources() {
    let mut scene = common::full_scene(8, 8);
    scene.integration.softening = 0.02;
    let mut devices = [
        Renderer::new(&common::device()).unwrap(),
        common::renderer(1, ""),
    ];
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    let grid = Grid::new(DVec3::new(0.2, -0.1, 0.3), DVec3::new(2.6, 1.9, 1.1), 37).unwrap();
    for value in [CellValue::Center, CellValue::Mean(2), CellValue::Apart] {
        let expected = bake(&mut reference, &scene, grid, value);
        for device in &mut devices {
            let found = bake(device, &scene, grid, value);
            let error = difference(&found, &expected);
            println!("{value:?}: {error:.1e}");
            assert!(error < ERROR, "{value:?}: {error}");
            let rests = found.rest().zip(expected.rest());
            assert_eq!(rests.is_some(), value == CellValue::Apart);
            if let Some((found, of_reference)) = rests {
                let error = difference(found, of_reference);
                println!("the rest: {error:.1e}");
                assert!(error < ERROR, "{error}");
                assert!(difference(found, &expected) > ERROR, "the rest is all");
            }
        }
        // A scene that is a little brighter is another.
        scene.spheres[0].coefficient *= 1.01;
        let other = bake(&mut devices[0], &scene, grid, value);
        scene.spheres[0].coefficient /= 1.01;
        assert!(difference(&other, &expected) > ERROR);
    }
}

#[test]
fn a_device_that_samples_wrong_is_refused() {
    let scene = Scene::from_toml(&format!("{CAMERA}{RING}")).unwrap();
    let grid = Grid::new(DVec3::ZERO, DVec3::ONE, 8).unwrap();
    let outcome = |spoil: &str| {
        let options = common::compiled_with(&RendererOptions::default(), spoil);
        let mut renderer = Renderer::with_options(&common::device(), &options).unwrap();
        let nothing = &mut |_: f32| std::ops::ControlFlow::Continue(());
        renderer.bake(&scene, grid, CellValue::Center, nothing)
    };
    let error = outcome("-Dtwice_inverse_sqrt(x)=(2.02f/sqrt(x))").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::SelfTest, "{error}");
    assert!(error.to_string().contains("cell"), "{error}");
    assert!(outcome("").is_ok());
}

#[test]
fn finer_volumes_show_their_scene_more_exactly() {
    let scene = Scene::from_toml(&format!("{CAMERA}{RING}")).unwrap();
    let mut renderer = Renderer::new(&Device::reference()).unwrap();
    let mut errors = Vec::new();
    for cells in [16, 48] {
        let [low, high] = scene.light_bounds().unwrap();
        let grid = Grid::new(0.5 * (low + high), high - low, cells).unwrap();
        let volume = bake(&mut renderer, &scene, grid, scene.cell_value());
        errors.push(renderer.bake_error(&scene, &volume).unwrap().unwrap());
    }
    println!("{errors:?}");
    assert!(errors[1].median < 0.2 * errors[0].median && errors[1].worst < errors[0].worst);
    assert!(errors[1].median < 5e-2);
}

#[test]
fn boxes_are_those_around_all_light_and_black_beyond() {
    let mut scene = Scene::from_toml(&format!("{CAMERA}{RING}")).unwrap();
    let [low, high] = scene.light_bounds().unwrap();
    assert!(
        (low - DVec3::new(-1.1, -1.1, -0.4)).length() < 1e-12,
        "{low}"
    );
    assert!(
        (high - DVec3::new(1.1, 1.1, 0.8)).length() < 1e-12,
        "{high}"
    );
    scene.tori.push(Torus::new(1.0));
    assert_eq!(scene.light_bounds(), None, "its light has no end");
    scene.tori.pop();
    scene.spheres.push(Sphere::default());
    assert_eq!(scene.light_bounds(), None);
    assert_eq!(scene.cell_value(), CellValue::Mean(4));
}

#[test]
fn a_raw_file_holds_the_cells_that_its_json_describes() {
    let folder = Folder::new();
    fs::write(folder.path().join("ring.toml"), format!("{CAMERA}{RING}")).unwrap();
    let output = folder.run(&["bake", "ring.toml", "-o", "ring.raw", "--cells", "20"]);
    expect(&output, 0, "baked: 20x20x11 cells");
    assert!(
        stderr(&output).contains("error: median"),
        "{}",
        stderr(&output)
    );
    let json = fs::read_to_string(folder.path().join("ring.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["cells"], serde_json::json!([20, 20, 11]));
    assert!(json["error"].as_str().unwrap().contains("99.9 %"));
    let bytes = fs::read(folder.path().join("ring.raw")).unwrap();
    assert_eq!(bytes.len(), 12 * 20 * 20 * 11);
    let scene = Scene::from_file(folder.path().join("ring.toml")).unwrap();
    let [low, high] = scene.light_bounds().unwrap();
    let grid = Grid::new(0.5 * (low + high), high - low, 20).unwrap();
    let mut renderer = Renderer::new(&Device::reference()).unwrap();
    let expected = bake(&mut renderer, &scene, grid, CellValue::Center);
    let number = |index: usize| f32::from_le_bytes(bytes[4 * index..][..4].try_into().unwrap());
    for (x, y, z) in [(3, 10, 4), (10, 3, 5), (12, 12, 7)] {
        let index = 3 * ((z * 20 + y) * 20 + x);
        let found = [0, 1, 2].map(|channel| f64::from(number(index + channel)));
        let expected = DVec3::from(expected.at([x as u32, y as u32, z as u32]).map(f64::from));
        assert!(expected.max_element() > 1e-3);
        assert!(
            (DVec3::from(found) - expected).length() < 1e-4,
            "{found:?} {expected}"
        );
    }
}

#[test]
fn other_programs_read_every_file_and_find_the_same_cells() {
    let folder = Folder::new();
    fs::write(folder.path().join("ring.toml"), format!("{CAMERA}{RING}")).unwrap();
    // More than a leaf, and more than a node of leaves, along an edge.
    let names = ["ring.raw", "ring.vdb", "ring.nrrd", "ring.vti"];
    for name in names {
        let output = folder.run(&["-q", "bake", "ring.toml", "-o", name, "--cells", "150"]);
        expect(&output, 0, "");
    }
    let output = folder.run(&[
        "-q",
        "bake",
        "ring.toml",
        "-o",
        "half.vdb",
        "--cells",
        "150",
        "--half",
    ]);
    expect(&output, 0, "");
    let white = RING.replace("[0.2, 0.5, 1.0]", "[1, 1, 1]");
    fs::write(folder.path().join("white.toml"), format!("{CAMERA}{white}")).unwrap();
    for name in ["white.raw", "white.vdb"] {
        let output = folder.run(&["-q", "bake", "white.toml", "-o", name, "--cells", "150"]);
        expect(&output, 0, "");
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/read_volumes.py");
    let read = |spoiled: &str| {
        let mut command = Command::new("/usr/bin/python3");
        command
            .arg(&script)
            .arg(folder.path())
            .arg(spoiled)
            .output()
    };
    let Ok(output) = read("") else {
        return println!("skipped: no python3");
    };
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    println!("{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success());
    let is_required = std::env::var_os("REQUIRE_VOLUME_READERS").is_some();
    assert!(
        !(is_required && said.contains("skipped: ring.vdb")),
        "OpenVDB is not there"
    );
    if said.contains("read: ring.vdb") {
        assert!(
            !read("spoiled").unwrap().status.success(),
            "other cells pass, too"
        );
    }
}

#[test]
fn what_cannot_be_baked_is_refused_and_nothing_is_written() {
    let folder = Folder::new();
    fs::write(folder.path().join("ring.toml"), format!("{CAMERA}{RING}")).unwrap();
    fs::write(
        folder.path().join("endless.toml"),
        format!("{CAMERA}[[torus]]\nmajor_radius = 1\n"),
    )
    .unwrap();
    let rms = format!("{CAMERA}[integration]\nreduction = \"rms\"\n[[torus]]\nmajor_radius = 1\n");
    fs::write(folder.path().join("rms.toml"), rms).unwrap();
    let cases: [(&[&str], i32, &str); 12] = [
        (
            &["ring.toml", "-o", "x.vdb", "--cells", "0"],
            2,
            "1 to 2048 cells",
        ),
        (
            &["ring.toml", "-o", "x.vdb", "--cells", "4096"],
            2,
            "1 to 2048 cells",
        ),
        (
            &["ring.toml", "-o", "x.vdb", "--box", "0,0,0", "1,0,1"],
            2,
            "edges above 0",
        ),
        (
            &["ring.toml", "-o", "x.vdb", "--box", "0,0", "1"],
            2,
            "three numbers",
        ),
        (
            &["ring.toml", "-o", "x.vdb", "--mean", "0"],
            2,
            "1 to 16 places",
        ),
        (&["ring.toml", "-o", "x.png"], 2, ".vdb, .nrrd"),
        (
            &["ring.toml", "-o", "x.nrrd", "--half"],
            2,
            "half floats are of .vdb",
        ),
        (&["ring.toml", "-o", "none/x.vdb"], 7, "none"),
        (
            &["endless.toml", "-o", "x.vdb"],
            2,
            "--box MIDDLE EDGES is needed",
        ),
        (
            &["rms.toml", "-o", "x.vdb", "--box", "0", "1"],
            2,
            "reduction \"rms\"",
        ),
        (
            &["ring.toml", "-o", "x.vdb", "--frames", "3..1"],
            2,
            "frames run forwards",
        ),
        (&["missing.toml", "-o", "x.vdb"], 3, "missing.toml"),
    ];
    for (arguments, code, message) in cases {
        let output = folder.run(&[&["bake"], arguments].concat());
        expect(&output, code, message);
    }
    let left = fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(left, 3, "only the scenes are there");
    let output = folder.run(&[
        "bake",
        "ring.toml",
        "-o",
        "dark.vdb",
        "--cells",
        "8",
        "--box",
        "9,9,9",
        "1",
    ]);
    expect(&output, 0, "all cells are black");
}

#[test]
fn a_scene_that_moves_becomes_a_volume_a_frame() {
    let folder = Folder::new();
    let moving = RING.replace(
        "peak = 2.0",
        "peak = { times = [0, 1], values = [1.0, 3.0] }",
    );
    fs::write(folder.path().join("ring.toml"), format!("{CAMERA}{moving}")).unwrap();
    let output = folder.run(&[
        "bake",
        "ring.toml",
        "-o",
        "r.###.raw",
        "--cells",
        "8",
        "--frames",
        "0..2",
        "--fps",
        "2",
    ]);
    expect(&output, 0, "baked");
    let frame = |number: u32| fs::read(folder.path().join(format!("r.{number:03}.raw"))).unwrap();
    let still = [
        "bake",
        "ring.toml",
        "-o",
        "s.raw",
        "--cells",
        "8",
        "--time",
        "0.5",
    ];
    expect(&folder.run(&still), 0, "baked");
    assert_eq!(frame(1), fs::read(folder.path().join("s.raw")).unwrap());
    assert_ne!(frame(0), frame(1));
    assert_ne!(frame(1), frame(2));
}
