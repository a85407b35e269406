//! `energywave compare`: its maps of errors, and what it measured as data.

use energywave::RadianceImage;
use serde_json::Value;

use crate::common::program::{Folder, SCENE, device, expect};

/// Returns the arguments of a small and quick comparison.
fn compare(more: &[&'static str]) -> Vec<&'static str> {
    let mut all = vec!["compare", SCENE, "--size", "40x24", "--seconds", "0"];
    all.extend(["--device", device()]);
    all.extend(more);
    all
}

#[test]
fn the_map_is_of_the_row_of_the_scenes_tolerance() {
    let folder = Folder::new();
    let more = ["--json", "--map", "a.exr", "--map", "b.png"];
    let output = folder.run(&compare(&more));
    expect(&output, 0, "error map: exact, tolerance 1e-3");
    let rows: Value = serde_json::from_slice(&output.stdout).unwrap();
    let row = |tolerance: f64| {
        let rows = rows.as_array().unwrap().iter();
        let mut found = rows.filter(|row| row["tolerance"] == tolerance);
        found.next().unwrap().clone()
    };
    let map = RadianceImage::open(folder.path().join("a.exr")).unwrap();
    let worst = |pixel: &[f32]| f64::from(pixel[..3].iter().copied().fold(0.0, f32::max));
    let max = map.as_slice().chunks(4).map(worst).fold(0.0, f64::max);
    let is_it = |row: &Value| (max / row["max"].as_f64().unwrap() - 1.0).abs() < 1e-6;
    assert!(is_it(&row(1e-3)) && !is_it(&row(1e-2)) && !is_it(&row(1e-4)));
    let place = &row(1e-3)["worst"];
    let place = |axis: usize| place[axis].as_u64().unwrap() as u32;
    assert_eq!(worst(&map.pixel(place(0), place(1)).unwrap()), max);
    let picture = image::open(folder.path().join("b.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (320, 192 + 44));
    assert_eq!(folder.names().len(), 2);
}

#[test]
fn maps_that_cannot_be_written_are_refused_before_the_work() {
    let folder = Folder::new();
    for (name, code, words) in [
        ("errors.gif", 2, "error: errors.gif: unknown output ending"),
        (
            "none/errors.exr",
            7,
            "there is no folder none; create it first",
        ),
        ("-", 2, "error: -: unknown output ending"),
    ] {
        let output = folder.run(&compare(&["--map", "errors.png", "--map", name]));
        expect(&output, code, words);
        assert!(folder.names().is_empty() && output.stdout.is_empty());
    }
}

/// Returns the lines of a CSV without quotes, by commas.
fn lines(csv: &[u8]) -> Vec<Vec<String>> {
    let text = std::str::from_utf8(csv).unwrap();
    assert!(!text.contains('"') && text.ends_with('\n'), "{text}");
    let cells = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().map(cells).collect()
}

/// Checks the columns that say what measured and when, and how times are spread.
#[track_caller]
fn check_origin(names: &[String], row: &[String]) {
    let cell = |name: &str| {
        let place = names.iter().position(|it| it == name).unwrap();
        row[place].as_str()
    };
    let number = |name: &str| cell(name).parse::<f64>().unwrap();
    assert_eq!(cell("version"), env!("CARGO_PKG_VERSION"));
    assert!(!cell("driver").is_empty() && !cell("device").is_empty());
    let date = cell("date");
    let shape: String = date
        .chars()
        .map(|c| if c.is_ascii_digit() { '0' } else { c })
        .collect();
    assert!(shape == "0000-00-00T00:00:00Z" && date > "2024", "{date}");
    assert!(number("repetitions") >= 3.0);
    assert!(number("least_ms") > 0.0 && number("least_ms") <= number("median_ms"));
    assert!(number("median_ms") <= number("greatest_ms"));
    assert!((number("fps") * number("median_ms") / 1e3 - 1.0).abs() < 1e-9);
}

#[test]
fn csv_has_the_fields_of_json_in_columns() {
    let folder = Folder::new();
    let found = folder.run(&compare(&["--csv"]));
    expect(&found, 0, "");
    let found = lines(&found.stdout);
    assert_eq!(found.len(), 1 + 8);
    assert_eq!(found[0][..3], ["method", "divisions", "tolerance"]);
    assert_eq!(found[1][..3], ["simpson", "64", ""]);
    assert_eq!(found[8][..3], ["exact", "", "0.0001"]);
    let json = folder.run(&compare(&["--json"]));
    let json: Value = serde_json::from_slice(&json.stdout).unwrap();
    let mut names: Vec<&String> = json[0].as_object().unwrap().keys().collect();
    let mut columns: Vec<&String> = found[0].iter().collect();
    names.sort();
    columns.sort();
    assert_eq!(names, columns);
    for row in &found[1..] {
        check_origin(&found[0], row);
    }
    let both = folder.run(&compare(&["--csv", "--json"]));
    expect(&both, 2, "cannot be used with");
}

#[test]
fn a_bench_is_a_line_of_csv() {
    let folder = Folder::new();
    let arguments = ["bench", SCENE, "--size", "16x8", "--seconds", "0", "--csv"];
    let output = folder.run(&[&arguments[..], &["--device", device()]].concat());
    expect(&output, 0, "");
    let found = lines(&output.stdout);
    assert_eq!(found.len(), 2);
    assert_eq!(found[1][..3], [SCENE, "16", "8"]);
    check_origin(&found[0], &found[1]);
}
