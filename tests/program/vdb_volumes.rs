//! Volumes from OpenVDB's files: those that `energywave bake` writes and those that OpenVDB itself writes are read as
//! they were, and nothing that is damaged or foreign ends the program.

use std::fs;
use std::path::Path;
use std::process::Command;

use energywave::ErrorKind;
use energywave::glam::DVec3;
use energywave::volume::Texture;

use crate::bad_scenes::CAMERA;
use crate::common::program::{Folder, expect};

/// What half floats leave of light that is 2 or less, and what float32 leaves of products.
const OF_HALVES: f64 = 1e-3;
const OF_FLOATS: f64 = 1e-6;

/// Files that are damaged in the test of mutations.
const MUTATIONS: usize = 400;

const BALLS: &str = "[[sphere]]\ncenter = [0.1, 0.2, 0.3]\nradius = 0.1\nreach = 0.5\npeak = 2.0\n\
    color = [1, 0.5, 0.25]\n[[sphere]]\ncenter = [1.1, -0.2, 0.3]\nradius = 0.1\nreach = 0.5\npeak = 1.0\n";

/// Returns the lit cells of a texture: their middles, world space, and their light.
fn lit(texture: &Texture) -> Vec<(DVec3, DVec3)> {
    let [center, size] = texture.place().unwrap();
    let cells = texture.cells();
    let counts = DVec3::from(cells.map(f64::from));
    let plane = cells.iter().product::<u32>() as usize;
    let mut lit = Vec::new();
    for index in 0..plane {
        let value = |channel: usize| {
            let channel = channel.min(texture.channels() as usize - 1);
            f64::from(texture.values()[channel * plane + index])
        };
        let light = texture.color() * DVec3::new(value(0), value(1), value(2));
        let index = index as u32;
        let cell = [
            index % cells[0],
            index / cells[0] % cells[1],
            index / cells[0] / cells[1],
        ];
        if light != DVec3::ZERO {
            let share = (DVec3::from(cell.map(f64::from)) + 0.5) / counts;
            lit.push((center + (share - 0.5) * size, light));
        }
    }
    lit
}

/// Compares lit cells, in any order; light may be off by so much.
#[track_caller]
fn compare(
    name: &str,
    mut found: Vec<(DVec3, DVec3)>,
    mut expected: Vec<(DVec3, DVec3)>,
    limit: f64,
) {
    let key = |(place, _): &(DVec3, DVec3)| place.to_array().map(|it| (it * 1e6).round() as i64);
    found.sort_by_key(key);
    expected.sort_by_key(key);
    assert_eq!(found.len(), expected.len(), "{name}");
    let mut worst = 0.0_f64;
    for ((place, light), (at, given)) in found.iter().zip(&expected) {
        assert!((*place - *at).length() < 1e-6, "{name}: {place} {at}");
        worst = worst.max((*light - *given).abs().max_element());
    }
    println!("{name}: {} cells, {worst:.1e}", found.len());
    assert!(worst <= limit, "{name}: {worst}");
    // Cells that are moved by one are others.
    found.rotate_right(1);
    let off = found.iter().zip(&expected);
    assert!(
        off.clone()
            .any(|((_, light), (_, given))| (*light - *given).length() > limit)
    );
}

fn baked(folder: &Folder, scene: &str, names: &[&[&str]]) {
    fs::write(folder.path().join("balls.toml"), format!("{CAMERA}{scene}")).unwrap();
    for name in names {
        let bake = ["-q", "bake", "balls.toml", "--cells", "40", "-o"];
        expect(&folder.run(&[&bake[..], name].concat()), 0, "");
    }
}

#[test]
fn vdb_files_that_were_baked_are_read_as_they_were() {
    let one = BALLS.split("[[sphere]]").nth(1).unwrap();
    // Of several colours, and of one.
    for (scene, channels) in [(BALLS, 3), (&format!("[[sphere]]{one}"), 1)] {
        let folder = Folder::new();
        baked(
            &folder,
            scene,
            &[&["balls.raw"], &["balls.vdb"], &["half.vdb", "--half"]],
        );
        let open = |name: &str| Texture::open(folder.path().join(name)).unwrap();
        let expected = lit(&open("balls.raw"));
        assert_eq!(open("balls.vdb").channels(), channels);
        compare(
            "balls.vdb",
            lit(&open("balls.vdb")),
            expected.clone(),
            4.0 * OF_FLOATS,
        );
        compare(
            "half.vdb",
            lit(&open("half.vdb")),
            expected,
            4.0 * OF_HALVES,
        );
    }
}

#[test]
fn files_of_openvdb_are_read_as_it_wrote_them() {
    let folder = Folder::new();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/write_volumes.py");
    let written = Command::new("/usr/bin/python3")
        .arg(script)
        .arg(folder.path())
        .output();
    let said = written.map_or(String::new(), |output| {
        println!("{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    });
    if !said.contains("written: level") {
        let is_required = std::env::var_os("REQUIRE_VOLUME_READERS").is_some();
        assert!(!is_required, "OpenVDB is not there: {said}");
        return println!("skipped: {said}");
    }
    for (name, limit) in [
        ("dense", OF_FLOATS),
        ("sparse", OF_FLOATS),
        ("half", OF_HALVES),
        ("color", OF_FLOATS),
    ] {
        let texture = Texture::open(folder.path().join(format!("{name}.vdb"))).unwrap();
        let text = fs::read_to_string(folder.path().join(format!("{name}.txt"))).unwrap();
        let expected = text.lines().map(|line| {
            let numbers: Vec<f64> = line.split(' ').map(|it| it.parse().unwrap()).collect();
            let light = match numbers[3..] {
                [light] => DVec3::splat(light),
                _ => DVec3::from_slice(&numbers[3..]),
            };
            (DVec3::from_slice(&numbers[..3]), light)
        });
        let expected: Vec<_> = expected
            .filter(|(_, light)| *light != DVec3::ZERO)
            .collect();
        compare(name, lit(&texture), expected, limit);
    }
    let level = Texture::open(folder.path().join("level.vdb"))
        .map(|it| it.cells())
        .unwrap_err();
    assert!(level.to_string().contains("level set"), "{level}");
    damage(&fs::read(folder.path().join("color.vdb")).unwrap(), &folder);
}

#[test]
fn vdb_files_that_are_damaged_or_foreign_are_refused_with_the_place() {
    let folder = Folder::new();
    baked(&folder, BALLS, &[&["balls.vdb"]]);
    let bytes = fs::read(folder.path().join("balls.vdb")).unwrap();
    let refused = |bytes: &[u8], reason: &str| {
        let path = folder.path().join("bad.vdb");
        fs::write(&path, bytes).unwrap();
        let error = Texture::open(&path).map(|it| it.cells()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Scene);
        assert!(error.to_string().contains(reason), "{reason}: {error}");
    };
    refused(b"", "no OpenVDB file");
    refused(b"NRRD0004\ntype: float\n", "no OpenVDB file");
    for length in [9, 30, 70, 100, 200, 5000, bytes.len() / 2, bytes.len() - 1] {
        refused(&bytes[..length], "cut short, or damaged");
    }
    let with = |at: usize, byte: u8| {
        let mut bytes = bytes.clone();
        bytes[at] = byte;
        bytes
    };
    refused(&with(8, 200), "version 200 of OpenVDB's files");
    refused(&with(20, 0), "where its grids are");
    // The grids' kinds, and the first one's compression.
    let find = |text: &str| {
        let text = text.as_bytes();
        bytes.windows(text.len()).position(|it| it == text).unwrap()
    };
    let kind = find("Tree_float");
    refused(
        &with(kind + 5, b'q'),
        "no grid that is light; it has \"Tree_qloat",
    );
    let begin = u64::from_le_bytes(bytes[kind + 20..][..8].try_into().unwrap()) as usize;
    refused(&with(begin, 8), "compression 0x8 is not known");
    let map = find("UniformScaleTranslateMap");
    refused(&with(map, b'N'), "NniformScaleTranslateMap");
    damage(&bytes, &folder);
}

/// Reads files with some other bytes in the head, or anywhere: they are read, or refused with their name.
fn damage(bytes: &[u8], folder: &Folder) {
    let mut random = fastrand::Rng::with_seed(17);
    let path = folder.path().join("damaged.vdb");
    let mut refused = 0;
    for number in 0..MUTATIONS {
        let mut damaged = bytes.to_vec();
        for _ in 0..=number % 3 {
            let most = if number % 2 == 0 { 1500 } else { bytes.len() };
            let at = random.usize(..most.min(bytes.len()));
            damaged[at] = [0, 1, 0x7f, 0xff, random.u8(..)][random.usize(..5)];
        }
        if number % 7 == 0 {
            damaged.truncate(random.usize(..bytes.len()));
        }
        fs::write(&path, &damaged).unwrap();
        if let Err(error) = Texture::open(&path) {
            assert!(
                error.to_string().contains("damaged.vdb") || error.kind() == ErrorKind::OutOfMemory
            );
            refused += 1;
        }
    }
    println!("{refused} of {MUTATIONS} are refused");
    assert!((MUTATIONS / 7..MUTATIONS).contains(&refused));
}
