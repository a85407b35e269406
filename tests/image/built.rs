//! Scenes built to break what random ones keep, `tests/data/accuracy`: cores on pixels, along rays and level with the
//! eye, dark weights, opposite signs. Each names its tolerance.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{device, difference, meets, renderer, tolerance};
use energywave::scene::Antialias;
use energywave::{Scene, reference};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/accuracy")
}

/// Returns how far a scene is off when its kernels are built with these options, and whether it meets its tolerance.
fn drawn(path: &Path, options: &str) -> (String, bool) {
    drawn_on(path, device().lanes, options)
}

fn drawn_on(path: &Path, lanes: u32, options: &str) -> (String, bool) {
    let mut scene = Scene::from_file(path).unwrap();
    scene.integration.antialias = Antialias::None;
    let image = renderer(lanes, options).render(&scene).unwrap();
    let found = difference(&image, &reference::render(&scene).unwrap());
    let is_met = meets(&found, tolerance(&scene));
    (format!("{}: {found:?}", path.display()), is_met)
}

#[test]
fn built_scenes_meet_their_tolerance() {
    let files = fs::read_dir(folder()).unwrap();
    let mut files: Vec<PathBuf> = files.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(files.len() > 10);
    for path in files {
        let (found, is_met) = drawn(&path, "");
        assert!(is_met, "{found}");
    }
}

/// Neighbours that cut their panels do not help a ray that is alone.
#[test]
fn weighted_curves_do_so_ray_by_ray() {
    let scene = |name: &str| folder().join(name).with_extension("toml");
    for name in [
        "weighted-smooth-pixels",
        "weighted-dark-end",
        "five-dark-weights",
    ] {
        let (found, is_met) = drawn_on(&scene(name), 1, "");
        assert!(is_met, "{found}");
    }
    let blind = "-DSEEN_END=2.0f";
    let (found, is_met) = drawn_on(&scene("weighted-smooth-pixels"), 1, blind);
    assert!(!is_met, "{found}");
}

#[test]
fn without_cuts_they_do_not() {
    for name in ["tight-tolerance-curve", "small-decay-ring-square"] {
        let path = folder().join(name).with_extension("toml");
        let (found, is_met) = drawn(&path, "-DMOST_CUTS=0");
        assert!(!is_met, "{found}");
    }
}
