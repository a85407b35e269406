//! What the program says of itself and of scene files: help, schema, completions, manual pages.

use std::process::Command;

use energywave::scene::keys::{json_schema, tables, track_tables};

use crate::common::program::{Folder, PROGRAM, expect, stderr};

/// Returns what is said on standard output.
#[track_caller]
fn said(folder: &Folder, arguments: &[&str]) -> String {
    let output = folder.run(arguments);
    expect(&output, 0, "");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn help_scene_has_every_key_of_every_table_within_a_hundred_columns() {
    let folder = Folder::new();
    let all = said(&folder, &["help", "scene"]);
    for table in tables().into_iter().chain(track_tables()) {
        assert!(all.contains(&table.header()), "{}", table.name);
        let one = said(&folder, &["help", "scene", table.name]);
        assert!(one.starts_with(&table.header()), "{one}");
        for key in table.keys() {
            let begin = format!("\n  {} ", key.name);
            let help: Vec<&str> = key.help.split_whitespace().collect();
            let words: Vec<&str> = one.split_whitespace().collect();
            assert!(one.contains(&begin) && all.contains(&begin), "{begin}");
            assert!(
                words.windows(help.len()).any(|it| it == help),
                "{}",
                key.help
            );
        }
        let longest = all
            .lines()
            .chain(one.lines())
            .map(|line| line.chars().count())
            .max();
        assert!(longest <= Some(100), "{longest:?}");
    }
    assert_eq!(
        said(&folder, &["help", "scene", "[[torus]]"]),
        said(&folder, &["help", "scene", "torus"])
    );
}

#[test]
fn help_is_what_the_option_says_and_wrong_topics_are_told() {
    let folder = Folder::new();
    assert_eq!(said(&folder, &["help"]), said(&folder, &["--help"]));
    assert_eq!(
        said(&folder, &["help", "render"]),
        said(&folder, &["render", "--help"])
    );
    for (arguments, words) in [
        (
            &["help", "rander"][..],
            "rander: no such topic; did you mean render? There are render, ",
        ),
        (
            &["help", "painting"],
            "painting: no such topic; there are render, ",
        ),
        (
            &["help", "scene", "tours"],
            "tours: no table of a scene file; did you mean torus?",
        ),
        (
            &["help", "render", "scene"],
            "scene: help render has no further topics",
        ),
        (&["help", "scene", "torus", "axis"], "no more were expected"),
        (&["man", "\u{1b}[31mred"], "\\u{1b}[31mred: no such topic"),
        (&["completions", "basch"], "bash"),
        (&["completions"], "Usage"),
        (&["schema", "x"], "unexpected argument"),
    ] {
        let output = folder.run(arguments);
        expect(&output, 2, words);
        assert!(!stderr(&output).contains('\u{1b}') && output.stdout.is_empty());
    }
}

#[test]
fn schema_completions_and_manual_pages_go_to_standard_output() {
    let folder = Folder::new();
    assert_eq!(said(&folder, &["schema"]), json_schema() + "\n");
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let text = said(&folder, &["completions", shell]);
        assert!(
            text.contains("tolerance") && text.contains("compare"),
            "{shell}"
        );
    }
    assert!(said(&folder, &["man"]).contains("\n.SH SUBCOMMANDS\n"));
    let page = said(&folder, &["man", "render"]);
    for words in [".TH energywave-render 1", "\\-\\-tolerance", "Examples:"] {
        assert!(page.contains(words), "{page}");
    }
    assert!(folder.names().is_empty(), "{:?}", folder.names());
}

#[test]
fn examples_of_drawing_can_be_typed_as_they_stand() {
    let folder = Folder::new();
    let bin = std::path::Path::new(PROGRAM)
        .parent()
        .unwrap()
        .to_str()
        .unwrap();
    let path = format!("{bin}:{}", std::env::var("PATH").unwrap());
    let mut count = 0;
    for subcommand in ["new", "render", "help", "schema", "completions", "man"] {
        let help = said(&folder, &["help", subcommand]);
        for line in help
            .lines()
            .filter(|line| line.starts_with("  energywave "))
        {
            // Smaller, as it is the line that is tried here and not the picture.
            let line = line
                .replace("laser.png", "laser.png --size 8x8 --antialias none")
                .replace("320x180", "8x8 --antialias none");
            let output = Command::new("sh")
                .args(["-c", line.trim()])
                .current_dir(folder.path())
                .env("PATH", &path)
                .env("ENERGYWAVE_DEVICE", "reference")
                .output()
                .unwrap();
            expect(&output, 0, "");
            count += 1;
        }
    }
    assert!(count > 12, "{count}");
    let names = folder.names();
    for name in [
        "laser.toml",
        "circle.toml",
        "laser.png",
        "laser.exr",
        "nova.png",
        "energywave.1",
        "scene.schema.json",
    ] {
        assert!(names.contains(&name.to_owned()), "{names:?}");
    }
}
