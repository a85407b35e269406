//! The program: exit codes, messages and outputs.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::program::{Folder, PROGRAM, SCENE, device, expect, stderr, wait_for_the_device};
use energywave::RadianceImage;

#[test]
fn render_writes_png_and_exr_and_names_the_device() {
    let folder = Folder::new();
    for name in ["out.png", "out.exr", "OUT.PNG"] {
        let output = folder.render(name, &["--size", "40x30"]);
        expect(&output, 0, "device: ");
        assert!(output.stdout.is_empty());
    }
    let image = RadianceImage::open(folder.path().join("out.exr")).unwrap();
    assert_eq!((image.size().width, image.size().height), (40, 30));
    assert!(image.pixel(20, 15).unwrap()[2] > 0.1);
    let png = std::fs::read(folder.path().join("out.png")).unwrap();
    assert_eq!(&png[..4], b"\x89PNG");
    assert_eq!(
        folder.names().len(),
        3,
        "temporary files left: {:?}",
        folder.names()
    );
}

#[test]
fn the_reference_and_the_opencl_device_draw_the_same_picture() {
    let folder = Folder::new();
    expect(
        &folder.render("a.exr", &["--size", "32x32", "--device", "reference"]),
        0,
        "reference",
    );
    expect(
        &folder.render("b.exr", &["--size", "32x32", "--device", device()]),
        0,
        "device: ",
    );
    let open = |name: &str| RadianceImage::open(folder.path().join(name)).unwrap();
    let found = energywave::image::compare(&open("b.exr"), &open("a.exr")).unwrap();
    assert!(found.max < 2e-4 && found.max > 0.0, "{found:?}");
}

#[test]
fn overrides_replace_the_scenes_values() {
    let folder = Folder::new();
    let reference = ["--size", "16x16", "--device", "reference"];
    for (name, more) in [
        ("a.exr", vec!["--divisions", "8"]),
        ("b.exr", vec!["--divisions", "200"]),
        ("c.exr", vec!["--method", "exact"]),
        ("d.exr", vec!["--method", "simpson", "--divisions", "65536"]),
    ] {
        expect(
            &folder.render(name, &[&reference[..], &more].concat()),
            0,
            "",
        );
    }
    let conflict = ["--method", "simpson", "--sampling", "tiles"];
    expect(&folder.render("e.exr", &conflict), 2, "every pixel");
    expect(
        &folder.render("e.exr", &["--sampling", "rows"]),
        2,
        "pixels, tiles",
    );
    let open = |name: &str| RadianceImage::open(folder.path().join(name)).unwrap();
    let exact = open("c.exr");
    let off = |name: &str| energywave::image::compare(&open(name), &exact).unwrap().max;
    assert!(off("a.exr") > off("b.exr") && off("b.exr") > off("d.exr"));
    assert!(off("d.exr") < 1e-5, "{}", off("d.exr"));
}

#[test]
fn an_environment_variable_that_counts_for_nothing_is_told() {
    let folder = Folder::new();
    let draw = |name: &str, value: &str| {
        let mut command = folder.command();
        command.args(["render", SCENE, "-o", "out.png", "--device", "reference"]);
        command
            .args(["--size", "2x2", "-q"])
            .env(name, value)
            .output()
            .unwrap()
    };
    for (name, value, words) in [
        (
            "ENERGYWAVE_CACHE",
            "alwyas",
            "warning: ENERGYWAVE_CACHE: \"alwyas\" is no choice",
        ),
        ("ENERGYWAVE_CACHE", "\u{1b}x", "\\u{1b}x"),
        (
            "ENERGYWAVE_CACHE_DIR",
            PROGRAM,
            "warning: ENERGYWAVE_CACHE_DIR: ",
        ),
        (
            "ENERGYWAVE_DEVCIE",
            "cpu",
            "warning: ENERGYWAVE_DEVCIE: no such environment variable; there are",
        ),
    ] {
        let output = draw(name, value);
        expect(&output, 0, words);
        assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
    }
    for (name, value) in [
        ("ENERGYWAVE_CACHE", "never"),
        ("ENERGYWAVE_CACHE", ""),
        ("ENERGYWAVE_CACHE_DIR", "none/yet"),
    ] {
        assert_eq!(stderr(&draw(name, value)), "");
    }
}

#[test]
fn usage_errors_exit_with_2_and_write_nothing() {
    let folder = Folder::new();
    expect(&folder.run(&[]), 2, "Usage");
    expect(&folder.run(&["paint"]), 2, "paint");
    expect(&folder.run(&["render", SCENE]), 2, "--output");
    expect(
        &folder.render("out.gif", &[]),
        2,
        "out.gif: unknown output ending; use .png",
    );
    expect(&folder.render("out", &[]), 2, "unknown output ending");
    expect(
        &folder.render("out.png", &["--size", "0x4"]),
        2,
        "two positive numbers",
    );
    expect(&folder.render("out.png", &["--size", "-3x4"]), 2, "--size");
    expect(&folder.render("out.png", &["--size", "640"]), 2, "640x360");
    expect(
        &folder.render("out.png", &["--divisions", "3"]),
        2,
        "even number",
    );
    expect(
        &folder.render("out.png", &["--divisions", "0"]),
        2,
        "even number",
    );
    expect(
        &folder.render("out.png", &["--tolerance", "0"]),
        2,
        "tolerance",
    );
    expect(
        &folder.render("out.png", &["--method", "romberg"]),
        2,
        "simpson, jittered, exact",
    );
    assert!(folder.names().is_empty(), "{:?}", folder.names());
}

#[test]
fn depths_hide_light_or_are_refused_before_anything_is_written() {
    let folder = Folder::new();
    let size = energywave::image::ImageSize {
        width: 24,
        height: 16,
    };
    let save = |name: &str, size, value: f32| {
        let mut image = energywave::RadianceImage::new(size).unwrap();
        image.as_mut_slice().fill(value);
        let display = energywave::image::Display::default();
        image.save(folder.path().join(name), &display).unwrap();
    };
    save("near.exr", size, 3.5);
    save("far.exr", size, f32::INFINITY);
    save("nan.exr", size, f32::NAN);
    save("negative.exr", size, -1.0);
    std::fs::write(folder.path().join("text.exr"), "depth").unwrap();
    let draw = |name: &str, depth: &[&str]| {
        let options = ["--size", "24x16", "--device", device()];
        folder.render(name, &[&options, depth].concat())
    };
    let light = |name: &str, depth: &[&str]| -> f32 {
        expect(&draw(name, depth), 0, "");
        let image = energywave::RadianceImage::open(folder.path().join(name)).unwrap();
        image.as_slice().iter().sum()
    };
    let open = light("open.exr", &[]);
    assert_eq!(light("far-away.exr", &["--depth", "far.exr"]), open);
    let by_ray = light("ray.exr", &["--depth", "near.exr"]);
    let by_axis = light(
        "axis.exr",
        &["--depth", "near.exr", "--depth-along", "axis"],
    );
    // A depth along the axis lies farther out along a slanted ray.
    assert!(
        by_ray < by_axis && by_axis < 0.9 * open,
        "{by_ray} {by_axis} {open}"
    );

    // What is typed takes the place of the scene's own, which is then not read.
    let text = std::fs::read_to_string(SCENE).unwrap();
    let scene = format!("{text}[depth]\nfile = \"nowhere.exr\"\n");
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let draw_own = |depth: &[&str]| {
        let options = ["render", "scene.toml", "--size", "24x16", "-o", "own.exr"];
        folder.run(&[&options, depth].concat())
    };
    expect(&draw_own(&[]), 3, "depth.file: ");
    expect(&draw_own(&["--depth", "near.exr"]), 0, "");

    let before = folder.names().len();
    for (file, words) in [
        ("nan.exr", "nan.exr: channel R: NaN at column 0, row 0"),
        (
            "negative.exr",
            "negative.exr: channel R: -1 at column 0, row 0",
        ),
        ("text.exr", "text.exr: not an OpenEXR image"),
        ("nowhere.exr", "nowhere.exr: cannot read"),
    ] {
        expect(&draw("out.png", &["--depth", file]), 3, words);
    }
    let other_size = folder.render("out.png", &["--depth", "near.exr"]);
    expect(
        &other_size,
        3,
        "near.exr: 24x16 pixels, the image has 256x256",
    );
    expect(
        &draw("out.png", &["--depth-along", "axis"]),
        2,
        "--depth <FILE>",
    );
    assert_eq!(folder.names().len(), before);
}

#[test]
fn an_image_beyond_the_limit_exits_with_3() {
    let folder = Folder::new();
    expect(
        &folder.render("out.png", &["--size", "16385x4"]),
        3,
        "at most 16384x16384",
    );
    assert!(folder.names().is_empty());
}

#[test]
fn outputs_that_cannot_be_written_exit_with_7_before_the_work() {
    let folder = Folder::new();
    let begun = Instant::now();
    let large = ["--size", "16000x16000"];
    expect(
        &folder.render("none/out.png", &large),
        7,
        "there is no folder none; create it first",
    );
    std::fs::create_dir(folder.path().join("out.png")).unwrap();
    expect(&folder.render("out.png", &large), 7, "it is a folder");
    expect(
        &folder.render("/proc/out.png", &large),
        7,
        "/proc/out.png: cannot write",
    );
    assert!(
        begun.elapsed() < Duration::from_secs(5),
        "the image was computed first"
    );
}

#[test]
fn a_write_that_fails_midway_exits_with_7_and_leaves_nothing() {
    let folder = Folder::new();
    // A limit on the size of files stands for a full disk: it too stops a write after some kilobytes.
    let script = format!(
        "trap '' XFSZ; ulimit -f 8; exec '{PROGRAM}' render '{SCENE}' -o out.exr --device reference"
    );
    let output = Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path())
        .output()
        .unwrap();
    expect(&output, 7, "File too large");
    assert!(
        stderr(&output).contains("out.exr: cannot write"),
        "{}",
        stderr(&output)
    );
    assert!(folder.names().is_empty(), "left: {:?}", folder.names());
}

#[test]
fn an_image_too_large_for_the_memory_exits_with_5() {
    let folder = Folder::new();
    let script = format!(
        "ulimit -v 3000000; exec '{PROGRAM}' render '{SCENE}' -o out.exr --device reference --size 16384x16384"
    );
    let output = Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path())
        .output()
        .unwrap();
    expect(&output, 5, "make the image smaller");
    assert!(folder.names().is_empty(), "left: {:?}", folder.names());
}

#[test]
fn a_large_scene_is_read_in_little_memory_or_refused() {
    let folder = Folder::new();
    let camera = "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n";
    let table = "[[sphere]]\ncenter = [0.1, 0.2, 3.5]\n";
    let inline = "{ center = [0.1, 0.2, 3.5] },\n";
    let json = format!("{{\"center\": [0.1, 0.2, 3.5]}}{}", " ".repeat(270)); // as long as others are together
    let many = |item: &str| item.repeat(100_000);
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    write("tables.toml", format!("{camera}{}", many(table)));
    write(
        "inline.toml",
        format!("sphere = [{}]\n{camera}", many(inline)),
    );
    let json = vec![json; 100_000].join(",");
    write(
        "large.json",
        format!(
            "{{\"camera\": {{\"eye\": [0, -4, 2], \"target\": [0, 0, 0]}}, \"sphere\": [{json}]}}"
        ),
    );
    // Whole, the tables took 260 MiB.
    for (name, code, words) in [
        ("tables.toml", 0, "device: reference (built in"), // no driver is loaded
        ("inline.toml", 5, "ulimit -v"),
        ("large.json", 5, "ulimit -v"),
    ] {
        let script = format!(
            "ulimit -v 300000; exec '{PROGRAM}' render {name} -o out.exr --device reference --size 1x1"
        );
        let output = Command::new("sh")
            .args(["-c", &script])
            .env("MALLOC_ARENA_MAX", "1") // glibc reserves 64 MiB of addresses for each thread
            .current_dir(folder.path())
            .output()
            .unwrap();
        expect(&output, code, words);
        let said = stderr(&output);
        assert!(
            code == 0 || said.contains("MiB needed") && said.contains("may address 292 MiB"),
            "{said}"
        );
    }
}

#[test]
fn ctrl_c_exits_with_130_and_leaves_nothing() {
    interrupt_on("reference");
    interrupt_on(device());
}

/// Presses Ctrl-C in the middle of minutes of work.
fn interrupt_on(device: &str) {
    let folder = Folder::new();
    let mut child = folder
        .command()
        .args([
            "render",
            SCENE,
            "-o",
            "out.png",
            "--device",
            device,
            "--size",
            "8000x8000",
            "--divisions",
            "4096",
        ])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for_the_device(&mut child);
    let interrupt = format!("kill -INT {}", child.id()); // the shell's own: minimal systems have no other
    assert!(
        Command::new("sh")
            .args(["-c", &interrupt])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    expect(&output, 130, "interrupted");
    assert!(folder.names().is_empty(), "left: {:?}", folder.names());
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let script = format!("'{PROGRAM}' verify --device reference | head -n 1");
    let output = Command::new("sh").args(["-c", &script]).output().unwrap();
    expect(&output, 0, "");
    assert!(!stderr(&output).contains("error"), "{}", stderr(&output));
}
