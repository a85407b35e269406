//! Damaged files: whatever bytes change or are missing, a file ends in a result or in an error, never in a panic, an
//! abort, or an allocation of what it claims. `ENERGYWAVE_FUZZ_SECONDS` goes on for so long, from another seed.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::common;
use energywave::image::{DepthAlong, DepthImage};
use energywave::scene::AnimatedScene;
use energywave::{ErrorKind, RadianceImage, Scene};

/// How often each file is changed.
const CHANGES: usize = 150;

/// Files of every compression, of parts and of tiles.
fn images() -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/exr");
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.clone(), fs::read(path).unwrap()))
        .collect();
    files.sort();
    assert!(files.len() >= 14, "{}", files.len());
    files
}

/// Seeds: one, or as many as the time allows.
fn seeds() -> impl Iterator<Item = u64> {
    let seconds = std::env::var("ENERGYWAVE_FUZZ_SECONDS");
    let seconds = seconds.map_or(0, |text| text.parse().unwrap());
    let (begun, limit) = (Instant::now(), Duration::from_secs(seconds));
    (1..).take_while(move |seed| *seed == 1 || begun.elapsed() < limit)
}

/// Changes a file: bytes, a number, a missing end, a piece twice or not at all.
fn change(random: &mut fastrand::Rng, bytes: &[u8]) -> Vec<u8> {
    let mut changed = bytes.to_vec();
    let at = |random: &mut fastrand::Rng| random.usize(..bytes.len());
    match random.u32(..11) {
        0 => changed.truncate(at(random)),
        1 => {
            let (begin, length) = (at(random), random.usize(1..40));
            let end = (begin + length).min(bytes.len());
            changed.drain(begin..end);
        }
        2 => {
            let (begin, length) = (at(random), random.usize(1..40));
            let piece = bytes[begin..(begin + length).min(bytes.len())].to_vec();
            changed.splice(begin..begin, piece);
        }
        3 => {
            // Pixels that another compression packed.
            let name = b"compression\0compression\0\x01\0\0\0";
            let found = bytes.windows(name.len()).position(|part| part == name);
            let place = found.map_or_else(|| at(random), |begin| begin + name.len());
            changed[place] = random.u8(..12);
        }
        4 | 5 => {
            let number = match random.u32(..4) {
                0 => random.u64(..),
                1 => 1 << random.u32(..63),
                2 => u64::MAX >> random.u32(..33),
                _ => random.u64(..300),
            };
            let begin = at(random);
            let width = [2, 4, 8][random.usize(..3)];
            for (to, from) in changed[begin..]
                .iter_mut()
                .take(width)
                .zip(number.to_le_bytes())
            {
                *to = from;
            }
        }
        _ => {
            for _ in 0..random.usize(1..4) {
                let place = at(random);
                changed[place] = match random.u32(..4) {
                    0 => changed[place] ^ (1 << random.u32(..8)),
                    1 => changed[place].wrapping_add(1),
                    2 => [0, 0x7f, 0x80, 0xff][random.usize(..4)],
                    _ => random.u8(..),
                };
            }
        }
    }
    changed
}

#[test]
fn a_damaged_image_ends_in_a_result_or_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.exr");
    // Written over and never closed: some file systems wait for the disk where a file is cut and closed.
    let mut file = File::create(&path).unwrap();
    let mut put = |bytes: &[u8]| {
        file.rewind().unwrap();
        file.write_all(bytes).unwrap();
        file.set_len(bytes.len() as u64).unwrap();
    };
    let images = images();
    let (mut read, mut refused) = (0, 0);
    let mut caught = BTreeMap::new(); // panics of the decoder, with the first file
    let mut check = |bytes: &[u8], what: &dyn Fn() -> String| {
        put(bytes);
        let (kind, message) = match DepthImage::open(&path, DepthAlong::Ray) {
            Ok(image) => {
                assert_eq!(image.as_slice().len(), image.size().pixels());
                read += 1;
                return;
            }
            Err(error) => (error.kind(), error.to_string()),
        };
        refused += 1;
        if let Some((_, panic)) = message.split_once("the decoder gave up: ") {
            caught.entry(panic.to_owned()).or_insert_with(what);
        }
        let is_line = !message.contains(char::is_control) && message.len() < 3000;
        assert!(is_line && kind == ErrorKind::Input, "{}: {message}", what());
        if let Err(error) = RadianceImage::open(&path) {
            let kinds = [ErrorKind::Input, ErrorKind::OutOfMemory];
            assert!(kinds.contains(&error.kind()), "{}: {error}", what());
        }
    };
    for (file, bytes) in &images {
        for length in (0..bytes.len()).step_by(1 + bytes.len() / 60) {
            check(&bytes[..length], &|| {
                format!("{}, {length} bytes", file.display())
            });
        }
    }
    for seed in seeds() {
        for (index, (file, bytes)) in images.iter().enumerate() {
            let mut random = fastrand::Rng::with_seed(seed << 8 | index as u64);
            for number in 0..CHANGES {
                let what = || format!("{}, seed {seed}, change {number}", file.display());
                check(&change(&mut random, bytes), &what);
            }
        }
    }
    println!("{read} read, {refused} refused; panics caught: {caught:#?}");
    assert!(
        read > 100 && refused > 500,
        "{read} read, {refused} refused"
    );
}

/// A scene with layers and groups, which no scene has that was read.
const PLACED_TOML: &str = "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n\
    [[sphere]]\nlayers = [{ radius = 1, color = [1, 2, 3] }, { reach = 2 }]\n\
    [[group]]\nscale = 2\nrotate = { axis = [0, 0, 1], angle = 9 }\nrepeat = { count = 12, axis = [0, 1, 0] }\n\
    [[group.group]]\nrepeat = { count = 3, step = [1, 2, 3] }\n[[group.group.torus]]\nmajor_radius = 3\n\
    [[group.group.torus.layers]]\nradius = 0.5\n";
const PLACED_JSON: &str = r#"{"camera": {"eye": [0, -4, 2], "target": [0, 0, 0]}, "group": [{"scale": 2,
    "rotate": {"axis": [0, 0, 1], "angle": 9}, "repeat": {"count": 12, "axis": [0, 1, 0]}, "group": [
    {"torus": [{"major_radius": 3, "layers": [{"radius": 0.5}]}], "repeat": {"count": 3, "step": [1, 2, 3]}}]}]}"#;

/// A scene that moves.
const MOVING_TOML: &str = "[camera]\neye = { times = [0, 1], values = [[0, -4, 2], [1, -4, 2]] }\n\
    target = [0, 0, 0]\n[time]\nloop = 3\n[[torus]]\nmajor_radius = { times = [0, 1, 3], values = [1, 2, 1.5], \
    phase = 0.3, interpolation = \"smooth\", \
    loop = \"repeat\" }\ncolor = { times = [0, 1], values = [\"#ff8000\", [0, 1, 2]], \
    interpolation = \"step\" }\n[torus.coefficient]\nvalue = 3\nnoise = { amplitude = 2, frequency = 3, octaves = 2 }\n\
    [[group]]\n[[group.path]]\npoints = { times = [0, 2], values = [[[0, 0, 0], [1, 1, 1]], [[0, 0, 0], [0, 0, 1]], \
    [[1, 0, 0], [1, 1, 2]], [[0, 0, 0], [0, 1, 0]], [[1, 1, 0], [1, 1, 3]], [[0, 0, 0], [0, 0, 0]]], \
    interpolation = \"cubic\" }\n";

#[test]
fn a_damaged_scene_ends_in_a_result_or_an_error() {
    let mut scenes: Vec<(String, String)> = common::scene_files()
        .into_iter()
        .map(|path| {
            let text = fs::read_to_string(&path).unwrap();
            let json = Scene::from_file(&path).unwrap().to_json().unwrap();
            (text, json)
        })
        .collect();
    scenes.push((PLACED_TOML.to_owned(), PLACED_JSON.to_owned()));
    let moving: serde_json::Value = toml::from_str(MOVING_TOML).unwrap();
    AnimatedScene::from_toml(MOVING_TOML)
        .unwrap()
        .at(0.7)
        .unwrap();
    for _ in 0..20 {
        scenes.push((MOVING_TOML.to_owned(), moving.to_string()));
    }
    let (mut read, mut refused) = (0, 0);
    let mut check = |bytes: Vec<u8>, parse: &dyn Fn(&str) -> energywave::Result<Scene>| {
        let text = String::from_utf8_lossy(&bytes);
        match parse(&text) {
            Ok(_) => read += 1,
            Err(error) => {
                refused += 1;
                assert_eq!(error.kind(), ErrorKind::Scene, "{error}\n{text}");
            }
        }
    };
    for seed in seeds() {
        for (index, (toml, json)) in scenes.iter().enumerate() {
            let mut random = fastrand::Rng::with_seed(seed << 8 | index as u64);
            for _ in 0..CHANGES / 3 {
                let time = random.f64() * 4.0 - 1.0;
                let (toml, json) = (toml.as_bytes(), json.as_bytes());
                check(change(&mut random, toml), &|text| {
                    AnimatedScene::from_toml(text)?.at(time)
                });
                check(change(&mut random, json), &|text| {
                    AnimatedScene::from_json(text)?.at(time)
                });
            }
        }
    }
    // Nesting is no recursion without end.
    for piece in [
        "[", "{", "a.", "{a=", "[[", "{\"a\":", "\"", "'''", "#", "\\",
    ] {
        let deep = piece.repeat(100_000);
        check(deep.clone().into_bytes(), &Scene::from_toml);
        check(format!("x = {deep}").into_bytes(), &Scene::from_toml);
        check(deep.clone().into_bytes(), &Scene::from_json);
        check(
            format!("{{\"camera\": {deep}").into_bytes(),
            &Scene::from_json,
        );
    }
    println!("{read} read, {refused} refused");
    assert!(
        read > 100 && refused > 500,
        "{read} read, {refused} refused"
    );
}
