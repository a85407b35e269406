//! What the program says of what it does, and what of that is left when it is asked to be quiet.

use std::fs;

use energywave::Scene;

use crate::common::program::{Folder, SCENE, expect, stderr};

const SMALL: [&str; 4] = ["--size", "24x16", "--device", "reference"];

#[test]
fn render_says_in_a_line_what_it_drew() {
    let folder = Folder::new();
    let output = folder.render("out.exr", &SMALL);
    expect(&output, 0, "reference (built in");
    let said = stderr(&output);
    let line = said.lines().last().unwrap();
    let image = energywave::RadianceImage::open(folder.path().join("out.exr")).unwrap();
    let light = || image.as_slice().chunks(4).flat_map(|pixel| &pixel[..3]);
    let greatest = light().copied().fold(0.0_f32, f32::max);
    let number = |from: &str, to: &str| -> f64 {
        let (_, rest) = line.split_once(from).unwrap_or_else(|| panic!("{line}"));
        rest.split(to).next().unwrap().parse().unwrap()
    };
    assert!(line.starts_with("drawn: 24x16 pixels in "), "{line}");
    assert!(line.contains(" s on reference"), "{line}");
    assert!(number("pixels in ", " s") < 60.0);
    assert!(
        (number(" to ", ",") / f64::from(greatest) - 1.0).abs() < 1e-3,
        "{line} {greatest}"
    );
    let exposure = Scene::from_file(SCENE)
        .unwrap()
        .display
        .exposure
        .stops(&image);
    assert!(
        (number("exposure ", " ") - exposure).abs() < 1e-3 * exposure.abs(),
        "{line}"
    );
}

#[test]
fn quiet_leaves_warnings_and_errors_alone() {
    let folder = Folder::new();
    for quiet in ["-q", "--quiet"] {
        let output = folder.render("out.png", &[&SMALL[..], &[quiet]].concat());
        expect(&output, 0, "");
        assert_eq!(stderr(&output), "");
        let output = folder.run(&[quiet, "new", "nova", "--force"]);
        expect(&output, 0, "");
        assert_eq!(stderr(&output), "");
        let output = folder.render("out.gif", &[quiet]);
        expect(&output, 2, "error: out.gif: unknown output ending");
    }
    let dim = fs::read_to_string(SCENE)
        .unwrap()
        .replace("fov_y = 48.0", "fov_y = 0.48")
        + "\n";
    fs::write(folder.path().join("dim.toml"), dim).unwrap();
    let arguments = ["render", "dim.toml", "-o", "dim.png", "-q"];
    let output = folder.run(&[&arguments[..], &SMALL].concat());
    expect(&output, 0, "warning: ");
    assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
}

#[test]
fn words_have_colours_where_they_are_wanted_alone() {
    let folder = Folder::new();
    let said = |variables: &[(&str, &str)]| {
        let mut command = folder.command();
        command.args(["render", "none.toml", "-o", "out.png"]);
        for name in ["NO_COLOR", "CLICOLOR_FORCE"] {
            command.env_remove(name);
        }
        command.envs(variables.iter().copied());
        stderr(&command.output().unwrap())
    };
    let plain = said(&[]);
    assert!(plain.starts_with("error: none.toml: "), "{plain}");
    let colored = said(&[("CLICOLOR_FORCE", "1")]);
    assert!(
        colored.starts_with("\u{1b}[1m\u{1b}[31merror:\u{1b}[0m none.toml: "),
        "{colored:?}"
    );
    assert_eq!(said(&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]), plain);
}
