//! Groups of lights: layers of an EXR that add up to the image.

use energywave::image::compare;
use energywave::{RadianceImage, Scene};

use crate::bad_scenes::CAMERA;
use crate::common::program::{Folder, expect};

/// A ring in a group, a beam that leaves it, a point in none.
const SOURCES: &str = r#"
[integration]
tolerance = 1e-4
antialias = "none"
[[group]]
light_group = "rings"
translate = [0, 0, 0.2]
[[group.torus]]
major_radius = 0.6
color = [1, 0.2, 0]
radius = 0.1
[[group.sphere]]
light_group = "far points"
color = [0, 0.2, 1]
center = [1, 0, 0]
radius = 0.1
[[sphere]]
radius = 0.1
"#;

fn folder() -> Folder {
    let folder = Folder::new();
    write(&folder, SOURCES);
    folder
}

fn write(folder: &Folder, rest: &str) {
    std::fs::write(folder.path().join("lit.toml"), format!("{CAMERA}{rest}")).unwrap();
}

fn render(folder: &Folder, output: &str, options: &[&str]) -> std::process::Output {
    let mut arguments = vec!["render", "lit.toml", "-o", output, "--size", "48x40"];
    arguments.extend(options);
    folder.run(&arguments)
}

#[test]
fn layers_of_light_groups_add_up_to_the_image() {
    let folder = folder();
    let sum_of = |file: &str, limit: f64| {
        let path = folder.path().join(file);
        let image = RadianceImage::open(&path).unwrap();
        let mut sum = image.clone();
        sum.as_mut_slice().fill(0.0);
        for layer in ["rings", "far points", "rest"] {
            let part = RadianceImage::open_layer(&path, layer).unwrap();
            assert!(
                !compare(&part, &image).is_some_and(|found| found.max < 0.1),
                "{layer}"
            );
            let values = sum.as_mut_slice().iter_mut().zip(part.as_slice());
            values.for_each(|(sum, part)| *sum += part);
        }
        sum.as_mut_slice()
            .chunks_mut(4)
            .for_each(|pixel| pixel[3] = 1.0);
        let found = compare(&sum, &image).unwrap();
        assert!(found.max < limit, "{file}: {found:?}");
    };
    expect(
        &render(&folder, "lit.exr", &["--light-groups"]),
        0,
        "drawn: ",
    );
    sum_of("lit.exr", 2e-4);
    expect(
        &render(&folder, "half.exr", &["--light-groups", "--bits", "16"]),
        0,
        "",
    );
    sum_of("half.exr", 2e-3);
    expect(&render(&folder, "plain.exr", &[]), 0, "");
    let missing = RadianceImage::open_layer(folder.path().join("plain.exr"), "rings").unwrap_err();
    assert!(
        missing
            .to_string()
            .contains("no channels rings.R, rings.G and rings.B"),
        "{missing}"
    );
    let [plain, with] =
        ["plain.exr", "lit.exr"].map(|name| RadianceImage::open(folder.path().join(name)).unwrap());
    assert_eq!(plain, with);
}

#[test]
fn a_group_names_what_names_none() {
    let scene = Scene::from_toml(&format!("{CAMERA}{SOURCES}")).unwrap();
    assert_eq!(scene.light_groups(), ["far points", "rings"]);
    assert!(scene.has_ungrouped_light());
    let rings = scene.of_light_group(Some("rings"));
    assert_eq!((rings.source_count(), rings.tori.len()), (1, 1));
    assert_eq!(rings.view_plane(), scene.view_plane());
    assert_eq!(scene.of_light_group(None).spheres.len(), 1);
    // What is written keeps them.
    assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene);
}

#[test]
fn wrong_light_groups_are_told_and_nothing_is_written() {
    let folder = folder();
    expect(
        &render(&folder, "lit.png", &["--light-groups"]),
        2,
        "--light-groups: they are layers, which need an .exr",
    );
    for (rest, code, words) in [
        (
            "[[sphere]]\n",
            2,
            "--light-groups: no source or [[group]] of the scene names a light_group",
        ),
        (
            "[[sphere]]\nlight_group = \"rest\"\n[[sphere]]\n",
            2,
            "`rest` is the layer of sources without a light_group",
        ),
        (
            "[[sphere]]\nlight_group = \"a.b\"\n",
            3,
            "lit.toml:5:15: sphere[0].light_group: `a.b`; a name has 1 to 60",
        ),
        (
            "[[sphere]]\nlight_group = \" \"\n",
            3,
            "sphere[0].light_group: ` `; a name has",
        ),
        (
            "[[group]]\nlight_group = \"\"\n[[group.sphere]]\n",
            3,
            "group[0].light_group: ``; a name has",
        ),
        ("[[sphere]]\nlight_group = 3\n", 3, "light_group"),
        (
            "[[sphere]]\nlight_groups = \"a\"\n",
            3,
            "did you mean `light_group`?",
        ),
    ] {
        write(&folder, rest);
        expect(
            &render(&folder, "lit.exr", &["--light-groups"]),
            code,
            words,
        );
    }
    assert_eq!(folder.names(), ["lit.toml"]);
}
