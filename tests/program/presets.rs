//! `energywave new` writes what it lists, and nothing over what is there.

use std::fs;

use energywave::scene::Preset;
use energywave::{ErrorKind, Scene};

use crate::common::program::{Folder, expect, stderr};

/// A preset is read at a glance.
const FEWER_LINES_THAN: usize = 60;

#[test]
fn every_preset_is_short_explained_and_read_without_a_warning() {
    let folder = Folder::new();
    for preset in Preset::ALL {
        let lines = preset.text.lines().count();
        assert!(lines < FEWER_LINES_THAN, "{}: {lines} lines", preset.name);
        let comments = preset.text.matches('#').count();
        assert!(comments >= 5, "{}: {comments} comments", preset.name);
        assert!(preset.text.starts_with("# "), "{}", preset.name);
        let path = folder.path().join("scene.toml");
        preset.save(&path).unwrap();
        let (_, warnings) = Scene::from_file_with_warnings(&path, |_, _| Ok(())).unwrap();
        assert!(warnings.is_empty(), "{}: {warnings:?}", preset.name);
    }
    // Warnings are found.
    let dim = Preset::ALL[0].text.replace("fov_y = 40.0", "fov_y = 0.8");
    fs::write(folder.path().join("dim.toml"), dim).unwrap();
    let path = folder.path().join("dim.toml");
    let (_, warnings) = Scene::from_file_with_warnings(path, |_, _| Ok(())).unwrap();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
}

#[test]
fn new_lists_every_preset_and_writes_each() {
    let folder = Folder::new();
    let output = folder.run(&["new", "--list"]);
    expect(&output, 0, "");
    let list = String::from_utf8(output.stdout).unwrap();
    assert_eq!(list.lines().count(), Preset::ALL.len(), "{list}");
    for (line, preset) in list.lines().zip(Preset::ALL) {
        let (name, about) = line.split_once("  ").unwrap();
        assert_eq!((name, about.trim()), (preset.name, preset.about()));
        assert!(about.trim().len() > 20, "{line}");
        expect(
            &folder.run(&["new", name]),
            0,
            &format!("wrote {name}.toml"),
        );
        let written = fs::read_to_string(folder.path().join(format!("{name}.toml"))).unwrap();
        assert_eq!(written, preset.text);
        let piped = folder.run(&["new", name, "-o", "-"]);
        expect(&piped, 0, "");
        assert_eq!(String::from_utf8(piped.stdout).unwrap(), preset.text);
    }
    assert_eq!(folder.names().len(), Preset::ALL.len());
}

#[test]
fn a_file_that_is_there_stays_without_force() {
    let folder = Folder::new();
    let path = folder.path().join("nova.toml");
    fs::write(&path, "mine").unwrap();
    let words = "nova.toml: cannot write: it is there already; --force";
    expect(&folder.run(&["new", "nova"]), 7, words);
    expect(&folder.run(&["new", "laser", "-o", "nova.toml"]), 7, words);
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    expect(&folder.run(&["new", "nova", "-o", "other.toml"]), 0, "");
    expect(&folder.run(&["new", "nova", "--force"]), 0, "");
    let nova = Preset::named("nova").unwrap().text;
    for name in ["nova.toml", "other.toml"] {
        assert_eq!(fs::read_to_string(folder.path().join(name)).unwrap(), nova);
    }
}

#[test]
fn what_cannot_be_made_says_why_and_leaves_nothing() {
    let folder = Folder::new();
    let unknown = folder.run(&["new", "lazer"]);
    expect(
        &unknown,
        2,
        "lazer: no preset has this name; did you mean laser?",
    );
    for preset in Preset::ALL {
        assert!(stderr(&unknown).contains(preset.name), "{}", preset.name);
    }
    let strange = folder.run(&["new", "\u{1b}[31mquarterstaff"]);
    expect(&strange, 2, "no preset has this name; There are");
    assert!(!stderr(&strange).contains('\u{1b}'));
    let nowhere = folder.run(&["new", "nova", "-o", "none/nova.toml"]);
    expect(&nowhere, 7, "there is no folder none; create it first");
    let at_a_folder = folder.run(&["new", "nova", "-o", ".", "--force"]);
    expect(&at_a_folder, 7, "it is a folder");
    for wrong in [
        &["new"][..],
        &["new", "nova", "--list"],
        &["new", "--list", "-o", "x"],
    ] {
        expect(&folder.run(wrong), 2, "Usage:");
    }
    assert!(folder.names().is_empty(), "{:?}", folder.names());
    let missing = Preset::ALL[0].save(folder.path().join("none/a.toml"));
    assert_eq!(missing.unwrap_err().kind(), ErrorKind::Output);
}
