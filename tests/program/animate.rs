//! Frames of scenes that move: they are what `render --time` draws, whole, and drawn once.

use std::fs;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

use energywave::RadianceImage;
use energywave::image::{DepthAlong, DepthImage, ImageFile, ImageSize};

use crate::common::program::{Folder, device, expect, stderr};

pub const CAMERA: &str = "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n";

/// A ring that grows for 2 s.
pub const RING: &str = "[image]\nwidth = 24\nheight = 16\n[[torus]]\n\
    major_radius = { times = [0, 2], values = [0.5, 1.5] }\nlayers = [{ radius = 0.2, reach = 1.0, peak = 2.0 }]\n";

/// Writes a scene, and returns how to draw it on the reference.
pub fn scene(folder: &Folder, name: &str, more: &str) {
    fs::write(folder.path().join(name), format!("{CAMERA}{RING}{more}")).unwrap();
}

pub fn animate(folder: &Folder, arguments: &[&str]) -> Output {
    let all = [&["animate", "a.toml", "--device", "reference"], arguments].concat();
    folder.run(&all)
}

fn exr(folder: &Folder, name: &str) -> Vec<f32> {
    let image = RadianceImage::open(folder.path().join(name)).unwrap();
    image.as_slice().to_vec()
}

pub fn png(folder: &Folder, name: &str) -> Vec<u8> {
    let picture = image::open(folder.path().join(name)).unwrap();
    picture.into_bytes()
}

pub fn sorted(folder: &Folder) -> Vec<String> {
    let mut names = folder.names();
    names.sort();
    names
}

/// Runs with `--json`, and returns how many frames are done, skipped and failed.
fn counts(folder: &Folder, arguments: &[&str]) -> [u64; 3] {
    let output = animate(folder, &[&["--json"], arguments].concat());
    expect(&output, 0, "");
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    ["done", "skipped", "failed"].map(|key| report[key].as_u64().unwrap())
}

#[test]
fn a_frame_is_what_render_draws_at_its_time_to_the_bit() {
    let folder = Folder::new();
    let bloom = "[display]\nbloom = { strength = 0.3 }\n";
    scene(&folder, "a.toml", bloom);
    let run = |arguments: &[&str]| {
        let all = [arguments, &["--device", device(), "--size", "40x30"]].concat();
        expect(&folder.run(&all), 0, "");
    };
    for format in ["exr", "png"] {
        let frames = format!("f.%03d.{format}");
        run(&[
            "animate",
            "a.toml",
            "-o",
            &frames,
            "--frames",
            "5..7",
            "--fps",
            "30000/1001",
        ]);
    }
    for frame in 5..8_u32 {
        let time = (f64::from(frame) * 1001.0 / 30000.0).to_string();
        for format in ["exr", "png"] {
            let name = format!("r.{frame}.{format}");
            run(&["render", "a.toml", "-o", &name, "--time", &time]);
        }
        assert_eq!(
            exr(&folder, &format!("f.00{frame}.exr")),
            exr(&folder, &format!("r.{frame}.exr"))
        );
        assert_eq!(
            png(&folder, &format!("f.00{frame}.png")),
            png(&folder, &format!("r.{frame}.png"))
        );
    }
    assert_ne!(exr(&folder, "f.005.exr"), exr(&folder, "r.6.exr"));
    assert_ne!(png(&folder, "f.005.png"), png(&folder, "r.6.png"));
}

#[test]
fn a_frame_is_blurred_as_that_of_render_is() {
    let folder = Folder::new();
    let blurred = "[time]\nshutter = 0.5\n[integration]\ntolerance = 0.01\nantialias = \"none\"\n";
    scene(&folder, "a.toml", blurred);
    let frames = ["-o", "f.exr", "--frames", "3..3", "--fps", "4"];
    expect(&animate(&folder, &frames), 0, "");
    let draw = |name: &str, rate: &[&str]| {
        let render = [
            "render",
            "a.toml",
            "--device",
            "reference",
            "-o",
            name,
            "--time",
            "0.75",
        ];
        expect(&folder.run(&[&render, rate].concat()), 0, "");
        exr(&folder, name)
    };
    assert_eq!(exr(&folder, "f.0003.exr"), draw("r.exr", &["--fps", "4"]));
    assert_ne!(exr(&folder, "f.0003.exr"), draw("m.exr", &[]));
}

#[test]
fn whole_frames_of_the_same_scene_are_drawn_once() {
    let folder = Folder::new();
    let at = |name: &str| folder.path().join(name);
    for format in ["exr", "png"] {
        scene(&folder, "a.toml", "");
        let frames = format!("f.{format}");
        let all = ["-o", frames.as_str(), "--frames", "0..5"];
        let name = |frame: u32| at(&format!("f.{frame:04}.{format}"));
        assert_eq!(counts(&folder, &all), [6, 0, 0]);
        let first: Vec<Vec<u8>> = (0..6).map(|frame| fs::read(name(frame)).unwrap()).collect();
        assert_eq!(counts(&folder, &all), [0, 6, 0]);
        // One is missing, one is cut off, one is empty, and one is another.
        fs::remove_file(name(0)).unwrap();
        fs::write(name(1), &first[1][..first[1].len() - 40]).unwrap();
        fs::write(name(2), "").unwrap();
        fs::copy(name(5), name(3)).unwrap();
        assert_eq!(counts(&folder, &all), [4, 2, 0]);
        for (frame, bytes) in (0..).zip(&first) {
            assert_eq!(&fs::read(name(frame)).unwrap(), bytes, "{frame}");
        }
        assert_eq!(
            counts(&folder, &[&all[..], &["--overwrite"]].concat()),
            [6, 0, 0]
        );
        // Whatever decides the picture draws them anew.
        for other in [
            ["--exposure", "1"],
            ["--tolerance", "1e-4"],
            ["--fps", "25"],
            ["--size", "12x8"],
        ] {
            let other = [&all[..], &other].concat();
            assert!(counts(&folder, &other)[0] > 0, "{other:?}");
            assert_eq!(counts(&folder, &other), [0, 6, 0]);
        }
        assert_eq!(counts(&folder, &all), [6, 0, 0]);
        scene(&folder, "a.toml", "# another scene\n");
        assert_eq!(counts(&folder, &all), [6, 0, 0]);
        let size = ImageSize {
            width: 24,
            height: 16,
        };
        let depth = |depth: f32| {
            let image = DepthImage::new(size, DepthAlong::Ray, vec![depth; size.pixels()]).unwrap();
            image.save(at("depth.exr")).unwrap();
        };
        scene(&folder, "a.toml", "[depth]\nfile = \"depth.exr\"\n");
        depth(4.0);
        assert_eq!(counts(&folder, &all), [6, 0, 0]);
        assert_eq!(counts(&folder, &all), [0, 6, 0]);
        depth(4.5);
        assert_eq!(counts(&folder, &all), [6, 0, 0]);
        for table in ["particles", "metaballs"] {
            let named = format!("[[{table}]]\nfile = \"points.csv\"\n");
            scene(&folder, "a.toml", &named);
            fs::write(at("points.csv"), "0, 0, 0\n").unwrap();
            assert_eq!(counts(&folder, &all), [6, 0, 0]);
            assert_eq!(counts(&folder, &all), [0, 6, 0]);
            fs::write(at("points.csv"), "0, 0, 0.1\n").unwrap();
            assert_eq!(counts(&folder, &all), [6, 0, 0], "{table}");
        }
    }
}

#[test]
fn frames_of_any_ending_are_known_again() {
    let folder = Folder::new();
    scene(&folder, "a.toml", "");
    for format in ["png", "exr"] {
        let arguments = ["-o", "f.%02d.data", "--format", format, "--frames", "1..2"];
        assert_eq!(counts(&folder, &arguments), [2, 0, 0]);
        assert_eq!(counts(&folder, &arguments), [0, 2, 0]);
    }
    assert_eq!(sorted(&folder), ["a.toml", "f.01.data", "f.02.data"]);
}

#[test]
fn shares_make_together_what_one_makes() {
    let folder = Folder::new();
    scene(&folder, "a.toml", "[display]\nexposure = \"auto\"\n");
    for share in ["1/3", "2/3", "3/3"] {
        let output = animate(
            &folder,
            &["-o", "s.#.png", "--frames", "2..8", "--shard", share],
        );
        expect(&output, 0, "of which this share has");
    }
    let whole = animate(&folder, &["-o", "w.#.png", "--frames", "2..8"]);
    expect(&whole, 0, "frames: w.2.png to w.8.png, 7 at 30 a second");
    expect(
        &whole,
        0,
        "stops for all frames, by auto: it fits the brightest of 7",
    );
    for frame in 2..9 {
        let read =
            |kind: &str| fs::read(folder.path().join(format!("{kind}.{frame}.png"))).unwrap();
        assert_eq!(read("s"), read("w"), "{frame}");
    }
    assert_eq!(folder.names().len(), 15);
    // More shares than frames.
    assert_eq!(
        counts(
            &folder,
            &["-o", "x.png", "--frames", "1..2", "--shard", "4/9"]
        ),
        [0, 0, 0]
    );
}

#[test]
fn one_exposure_fits_all_frames() {
    let folder = Folder::new();
    let light = "[image]\nwidth = 24\nheight = 16\n[[sphere]]\nradius = 0.3\n\
        coefficient = { times = [0, 1], values = [0.0, 8.0] }\n";
    let says = |display: &str, frames: &str| {
        fs::write(
            folder.path().join("a.toml"),
            format!("{CAMERA}{light}{display}"),
        )
        .unwrap();
        let output = animate(&folder, &["-o", "f.png", "--frames", frames]);
        expect(&output, 0, "");
        stderr(&output)
    };
    let stops = |said: &str| -> f64 {
        let (_, rest) = said.split_once("exposure: ").unwrap();
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    let auto = "[display]\nexposure = \"auto\"\n";
    let all = stops(&says(auto, "0..30"));
    let (dim, bright) = (stops(&says(auto, "3..3")), stops(&says(auto, "30..30")));
    assert!(
        (all - bright).abs() < 0.02 && dim > all + 2.0,
        "{all} {bright} {dim}"
    );
    // Light that grows is seen to grow, also where the scene names no exposure.
    says("", "0..30");
    let sum = |name: &str| png(&folder, name).into_iter().map(u64::from).sum::<u64>();
    let (before, after) = (sum("f.0003.png"), sum("f.0030.png"));
    assert!(
        sum("f.0000.png") == 0 && 2 * before < after,
        "{before} {after}"
    );
}

#[test]
fn ctrl_c_leaves_whole_frames_alone_and_the_same_command_goes_on() {
    let folder = Folder::new();
    scene(&folder, "a.toml", "");
    let arguments = [
        "animate",
        "a.toml",
        "-o",
        "f.exr",
        "--device",
        "reference",
        "--json",
    ];
    let mut command = folder.command();
    let command = command.args(arguments).args(["--frames", "0..5000"]);
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !folder.path().join("f.0003.exr").exists() {
        sleep(Duration::from_millis(5));
    }
    let interrupt = format!("kill -INT {}", child.id());
    assert!(
        Command::new("sh")
            .args(["-c", &interrupt])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    expect(
        &output,
        130,
        "of 5001 frames are there and whole, the same command draws the others",
    );
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let frames: Vec<String> = sorted(&folder)
        .into_iter()
        .filter(|name| name != "a.toml")
        .collect();
    assert_eq!(report["done"].as_u64().unwrap(), frames.len() as u64);
    assert_eq!(
        report["failed"].as_u64().unwrap(),
        5_001 - frames.len() as u64
    );
    for name in &frames {
        let print = ImageFile::fingerprint_of(folder.path().join(name));
        assert!(print.is_some_and(|print| print.len() == 64), "{name}");
    }
    let output = folder.run(&[&arguments[..], &["--frames", "0..3"]].concat());
    expect(&output, 0, "0 of 4 drawn and 4 were there");
}
