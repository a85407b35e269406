//! Depth images of other programs: which channel is read, in which units, and what is said of it.

use std::path::{Path, PathBuf};

use crate::common::program::{Folder, expect, stderr};
use energywave::image::{DepthAlong, DepthImage, DepthOptions};
use energywave::{Error, Scene};

const SCENE: &str = "
[camera]
eye = [0.0, -4.0, 1.0]
target = [0.0, 0.0, 0.0]
near = 1.0
ray_length = 8.0
[image]
width = 64
height = 48
[[torus]]
major_radius = 1.0
coefficient = 0.5
";

fn data(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    folder.join(name)
}

fn open(name: &str, options: impl Into<DepthOptions>) -> Result<DepthImage, Error> {
    DepthImage::open(data(name), options)
}

#[test]
fn depths_are_found_among_other_passes_or_refused_with_the_list() {
    let right = open("depth/reference-Z-only.exr", DepthAlong::Ray).unwrap();
    for (file, channel) in [
        ("Depth.V-and-Normal.Z", "Depth.V"),
        ("RGB-and-Z-Depth.RGB", "Z-Depth.R"),
        ("RGBA-and-ZDepth", "ZDepth"),
        ("RGBA-and-zdepth.R", "zdepth.R"),
        ("Z-and-N.Z", "Z"),
        ("ZDepth.V-and-normals.Z", "ZDepth.V"),
        ("parts-rgba-N-depth", "depth.Z"),
        ("two-passes", "Depth.V"),
    ] {
        let found = open(&format!("depth/{file}.exr"), DepthAlong::Ray).unwrap();
        assert_eq!(found.channel(), Some(channel), "{file}");
        assert_eq!(found, right, "{file}");
    }
    for (file, words) in [
        ("beauty-RGBA-without-depth", "red, green and blue differ"),
        ("dd.y-and-nn.Z", "channels: B, G, R, dd.y, nn.X, nn.Y, nn.Z"),
    ] {
        let refused = open(&format!("depth/{file}.exr"), DepthAlong::Ray).unwrap_err();
        let message = refused.to_string();
        assert!(
            message.contains(words) && message.contains("`channel`"),
            "{message}"
        );
    }
    // What is asked for by name is taken, whatever it is called.
    let mut asked = DepthOptions::from(DepthAlong::Ray);
    asked.channel = Some("dd.y".to_owned());
    assert_eq!(
        open("depth/dd.y-and-nn.Z.exr", asked.clone()).unwrap(),
        right
    );
    asked.channel = Some("Z".to_owned());
    let twice = open("depth/parts-rgba-N-depth.exr", asked.clone())
        .unwrap_err()
        .to_string();
    assert!(
        twice.contains("in several parts") && twice.contains("N.Z, depth.Z"),
        "{twice}"
    );
    asked.channel = Some("N.Z".to_owned());
    assert_ne!(open("depth/parts-rgba-N-depth.exr", asked).unwrap(), right);
}

#[test]
fn units_and_values_that_mean_nothing_are_said_by_the_scene() {
    let right = open("depth/units/reference.exr", DepthAlong::Ray).unwrap();
    let scene = |file: &str, keys: &str| {
        let path = data(&format!("depth/units/{file}.exr"));
        let text = format!(
            "{SCENE}[depth]\nfile = {:?}\n{keys}\n",
            path.to_str().unwrap()
        );
        Scene::from_toml(&text)
    };
    let values = |file: &str, keys: &str| {
        let depth = scene(file, keys).unwrap().depth.unwrap();
        depth.as_slice().to_vec()
    };
    let is_near = |found: &[f32]| {
        let mut pairs = found.iter().zip(right.as_slice());
        pairs.all(|(a, b)| (a - b).abs() < 1e-5)
    };
    assert!(is_near(&values("centimetres", "scale = 0.01")));
    assert!(!is_near(&values("centimetres", "")));
    assert!(is_near(&values("negative-z", "scale = -1")));
    let nothing = values("background-0", "none = 0");
    assert_eq!(nothing, values("background-minus-1", "none = -1"));
    assert_eq!(nothing, values("background-nan", "none = nan"));
    assert_eq!(nothing, values("background-nan", "none = \"nan\""));
    let there = nothing.iter().filter(|depth| depth.is_finite()).count();
    assert!(0 < there && there < nothing.len());

    // A scene that is written says the same.
    for keys in [
        "none = nan\nchannel = \"Z\"",
        "none = -1\nscale = 0.5\nalong = \"axis\"",
    ] {
        let file = if keys.contains("nan") {
            "background-nan"
        } else {
            "background-minus-1"
        };
        let first = scene(file, keys).unwrap();
        let text = first.to_toml().unwrap();
        assert_eq!(Scene::from_toml(&text).unwrap(), first, "{text}");
        let text = first.to_json().unwrap();
        assert_eq!(Scene::from_json(&text).unwrap(), first, "{text}");
    }
    for (keys, words) in [
        ("scale = 0", "depth.scale: must not be 0"),
        ("scale = inf", "depth.scale: inf is not"),
        ("none = \"black\"", "a number or \"nan\""),
        ("chanel = \"Z\"", "unknown field `chanel`"),
        ("channel = \"Q\"", "no channel `Q`; channels: Z"),
    ] {
        let message = scene("reference", keys).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn what_the_depths_come_to_is_told_and_what_is_likely_wrong_even_if_quiet() {
    let folder = Folder::new();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    let draw = |file: &str, more: &[&str]| {
        let path = data(&format!("depth/{file}.exr"));
        let path = path.to_str().unwrap();
        let common = [
            "render",
            "scene.toml",
            "--device",
            "reference",
            "-o",
            "o.exr",
        ];
        folder.run(&[&common[..], &["--size", "64x48", "--depth", path], more].concat())
    };
    let told = draw("units/reference", &[]);
    let words =
        "depth: reference.exr: channel Z, 2.5 to 4, 0 % of the pixels without a depth, 0 % before";
    expect(&told, 0, words);
    assert!(!stderr(&told).contains("warning"), "{}", stderr(&told));
    let quiet = stderr(&draw("units/reference", &["-q"]));
    assert!(
        !quiet.contains("channel") && !quiet.contains("warning"),
        "{quiet}"
    );
    for (file, words) in [
        ("units/centimetres", "lie beyond the ends of the rays"),
        ("units/opengl-0-to-1", "likely those of a z-buffer"),
        ("units/reversed-z", "likely those of a z-buffer"),
        ("units/background-0", "50 % of the pixels have depth 0"),
        ("two-passes", "channel Depth.V is taken"),
    ] {
        expect(
            &draw(file, &["-q"]),
            0,
            &format!("warning: {}", file.rsplit('/').next().unwrap()),
        );
        expect(&draw(file, &["-q"]), 0, words);
    }
    for (file, options, words) in [
        (
            "units/background-minus-1",
            "",
            "channel Z: -1 at column 32, row 0",
        ),
        ("units/background-minus-1", "", "`none = -1`"),
        ("units/background-nan", "", "`none = nan`"),
        ("units/negative-z", "", "`scale = -1`"),
        (
            "two-passes",
            "--depth-channel Normal.X",
            "channel Normal.X: -",
        ),
        (
            "two-passes",
            "--depth-channel Normal",
            "no channel `Normal`; channels: Depth.V, ",
        ),
    ] {
        let options: Vec<&str> = options.split_whitespace().collect();
        expect(&draw(file, &options), 3, words);
    }
    for (file, options) in [
        ("units/background-minus-1", "--depth-none -1"),
        ("units/background-nan", "--depth-none nan"),
        ("units/negative-z", "--depth-scale -1"),
        ("units/centimetres", "--depth-scale 0.01"),
        ("two-passes", "--depth-channel Depth.V"),
    ] {
        let options: Vec<&str> = options.split_whitespace().collect();
        let output = draw(file, &[&options[..], &["-q"]].concat());
        expect(&output, 0, "");
        assert!(!stderr(&output).contains("warning"), "{}", stderr(&output));
    }
    expect(
        &draw("units/reference", &["--depth-scale", "0"]),
        2,
        "a scale is a number but 0",
    );
}

#[test]
fn every_compression_is_read_but_deep_and_htj2k_which_are_told() {
    let plain = open("exr/none.exr", DepthAlong::Ray).unwrap();
    for (file, error) in [
        ("rle", 0.0),
        ("zips", 0.0),
        ("zip", 0.0),
        ("pxr24", 1e-4),
        ("b44", 0.0),
        ("b44a", 0.0),
        ("dwaa", 0.0),
        ("dwab", 0.0),
        ("tiles", 0.0),
        ("levels", 0.0), // of which the smaller ones are not there
        ("parts", 0.0),
    ] {
        let found = open(&format!("exr/{file}.exr"), DepthAlong::Ray).unwrap();
        assert_eq!(found.size(), plain.size(), "{file}");
        for (a, b) in found.as_slice().iter().zip(plain.as_slice()) {
            assert!((a - b).abs() <= error * b, "{file}: {a}, expected {b}");
        }
    }
    let piz = open("exr/piz.exr", DepthAlong::Ray).unwrap();
    for (index, value) in piz.as_slice().iter().enumerate() {
        assert_eq!(*value, 3.0 + ((index % 34) / 8) as f32, "{index}");
    }
    let folder = tempfile::tempdir().unwrap();
    let refused = |bytes: &[u8]| {
        let path = folder.path().join("depth.exr");
        std::fs::write(&path, bytes).unwrap();
        let refused = DepthImage::open(path, DepthAlong::Ray);
        refused.unwrap_err().to_string()
    };
    let bytes = std::fs::read(data("exr/zip.exr")).unwrap();
    for (length, words) in [
        (0, "not an OpenEXR image"),
        (100, "its header cannot be read"),
        (bytes.len() - 1, "cut off"),
    ] {
        let message = refused(&bytes[..length]);
        assert!(message.contains(words), "{length} bytes: {message}");
    }
    let png = refused(b"\x89PNG\r\n\x1a\n and more");
    assert!(png.contains("not an OpenEXR image"), "{png}");
    for (file, words) in [
        ("deep", "its pixels are deep"),
        (
            "htj2k",
            "compressed by HTJ2K, which cannot be read; write it with another compression: none, RLE",
        ),
        (
            "dwab-damaged",
            "damaged: a chunk claims 2305843009213695424 unknown values",
        ),
    ] {
        let message = open(&format!("exr/{file}.exr"), DepthAlong::Ray)
            .unwrap_err()
            .to_string();
        assert!(message.contains(words), "{message}");
    }
}
