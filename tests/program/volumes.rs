//! Volumes from files: those that `energywave bake` writes are read as they were, slices are stacked, and what is no
//! volume is refused.

use std::fs;

use energywave::volume::{CellValue, Grid, LightBall, Storage, Texture};
use energywave::{Device, Renderer, Scene};

use crate::bad_scenes::CAMERA;
use crate::common::program::{Folder, expect};

/// What a cell may be off, of the brightest: what float32 leaves of distances.
const ERROR: f32 = 1e-4;

const BALL: &str = "[[sphere]]\ncenter = [0.1, 0.2, 0.3]\nradius = 0.1\nreach = 0.5\npeak = 2.0\n\
    color = [1, 0.5, 0.25]\n";

const RING: &str =
    "[[torus]]\nmajor_radius = 0.3\nradius = 0.1\nreach = 0.2\npeak = 1.0\ncolor = [0.2, 0.5, 1]\n";

#[test]
fn volumes_that_were_baked_are_read_as_they_were() {
    // Light of one colour is one number a cell.
    for (ring, channels) in [("", 1), (RING, 3)] {
        compare(&format!("{CAMERA}{BALL}{ring}"), channels);
    }
}

fn compare(scene: &str, channels: u32) {
    let folder = Folder::new();
    fs::write(folder.path().join("ball.toml"), scene).unwrap();
    let scene = Scene::from_file(folder.path().join("ball.toml")).unwrap();
    let [low, high] = scene.light_bounds().unwrap();
    let grid = Grid::new(0.5 * (low + high), high - low, 12).unwrap();
    let mut renderer = Renderer::new(&Device::reference()).unwrap();
    let nothing = &mut |_: f32| std::ops::ControlFlow::Continue(());
    let volume = renderer
        .bake(&scene, grid, CellValue::Center, nothing)
        .unwrap();
    for name in ["ball.raw", "ball.nrrd", "ball.vti"] {
        let output = folder.run(&["-q", "bake", "ball.toml", "-o", name, "--cells", "12"]);
        expect(&output, 0, "");
        let texture = Texture::open(folder.path().join(name)).unwrap();
        assert_eq!(
            (texture.cells(), texture.channels()),
            (grid.cells(), channels)
        );
        let color = texture.color().as_vec3();
        let [center, size] = texture.place().unwrap();
        assert!(
            (center - 0.5 * (low + high)).length() < 1e-9 && (size - (high - low)).length() < 1e-9
        );
        let [columns, rows, layers] = grid.cells();
        let plane = columns * rows * layers;
        let worst = |shift: u32| {
            let mut worst = 0.0_f32;
            for place in 0..plane - 1 {
                let cell = [
                    place % columns,
                    place / columns % rows,
                    place / columns / rows,
                ];
                let expected = volume.at(cell);
                for channel in 0..3 {
                    let of_cell = channel.min(channels - 1) * plane + place + shift;
                    let found = texture.values()[of_cell as usize] * color[channel as usize];
                    worst = worst.max((found - expected[channel as usize]).abs());
                }
            }
            worst / volume.greatest()
        };
        println!("{name}: {}, of the cells beside {}", worst(0), worst(1));
        assert!(worst(0) < ERROR && worst(1) > ERROR);
    }
}

#[test]
fn damaged_and_foreign_files_are_refused() {
    let folder = Folder::new();
    fs::write(folder.path().join("ball.toml"), format!("{CAMERA}{BALL}")).unwrap();
    for name in ["ball.raw", "ball.nrrd", "ball.vti"] {
        let output = folder.run(&["-q", "bake", "ball.toml", "-o", name, "--cells", "8"]);
        expect(&output, 0, "");
        let path = folder.path().join(name);
        let bytes = fs::read(&path).unwrap();
        for length in [0, 5, 100, bytes.len() / 2, bytes.len() - 40] {
            fs::write(&path, &bytes[..length]).unwrap();
            let error = Texture::open(&path).unwrap_err();
            println!("{error}");
            assert!(error.to_string().contains(name), "{error}");
        }
    }
    let refused = |name: &str, bytes: &[u8], reason: &str| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let error = Texture::open(&path).unwrap_err().to_string();
        assert!(error.contains(reason), "{name}: {error}");
    };
    let header = "NRRD0004\ntype: float\nencoding: raw\nendian: little\n";
    let nrrd = |rest: &str| format!("{header}{rest}\n\n").into_bytes();
    refused("a.nrrd", &nrrd("sizes: 0 1 1"), "1 to 4096");
    refused(
        "b.nrrd",
        &nrrd("sizes: 4096 4096 4096"),
        "more than devices count",
    );
    refused("f.nrrd", &nrrd("sizes: 1024 1024 1024"), "cut short");
    refused("c.nrrd", &nrrd("sizes: 9999999999 1 1"), "`sizes`");
    let mut cells = nrrd("sizes: 2 1 1");
    cells.extend([1.0, f32::NAN].into_iter().flat_map(f32::to_le_bytes));
    refused("d.nrrd", &cells, "cell (1, 0, 0) holds NaN");
    refused("e.png", &cells, "files that end in");
}

#[test]
fn slices_are_stacked_by_name() {
    let folder = Folder::new();
    let path = folder.path();
    assert!(Texture::open_slices(path.join("*.png")).is_err());
    let draw = |name: &str, width: u32, gray: u8, alpha: u8| {
        let mut picture = image::RgbaImage::new(width, 2);
        picture.put_pixel(0, 0, image::Rgba([gray, gray, gray, alpha]));
        picture.save(path.join(name)).unwrap();
    };
    draw("b.png", 3, 255, 51);
    draw("a.png", 3, 255, 255);
    let texture = Texture::open_slices(path.join("*.png")).unwrap();
    assert_eq!((texture.cells(), texture.channels()), ([3, 2, 2], 1));
    let values = texture.values();
    // The pictures' upper left pixels, of y = 1.
    assert!(
        (values[3] - 1.0).abs() < 1e-6 && (values[9] - 0.2).abs() < 1e-6,
        "{values:?}"
    );
    assert_eq!(values.iter().filter(|it| **it != 0.0).count(), 2);
    draw("c.png", 4, 1, 1);
    let error = Texture::open_slices(path.join("*.png")).unwrap_err();
    assert!(error.to_string().contains("one size"), "{error}");
}

#[test]
fn light_balls_have_the_shells_of_the_thesis() {
    let ball = LightBall::default();
    let texture = Texture::light_ball(&ball).unwrap();
    assert_eq!(
        (texture.cells(), texture.storage()),
        ([16; 3], Storage::Emission)
    );
    let at = |x: usize| {
        [0, 1, 2].map(|channel| texture.values()[channel * 4096 + (8 * 16 + 8) * 16 + x])
    };
    let light = |shell: usize| {
        (ball.alphas[shell] * ball.colors[shell])
            .as_vec3()
            .to_array()
    };
    assert_eq!(
        [at(8), at(12), at(14), at(15)],
        [light(0), light(1), light(2), [0.0; 3]]
    );
    let wrong = LightBall {
        radii: [3.0, 2.0, 7.0],
        ..ball
    };
    assert!(Texture::light_ball(&wrong).is_err());
}

#[test]
fn reciprocals_are_stored_and_drawn_as_the_light_that_they_are_of() {
    let folder = Folder::new();
    let ball = "[[sphere]]\nradius = 0.2\nprofile = \"inverse\"\n";
    fs::write(folder.path().join("ball.toml"), format!("{CAMERA}{ball}")).unwrap();
    let bake = [
        "-q",
        "bake",
        "ball.toml",
        "--cells",
        "8",
        "--box",
        "0,0,0",
        "2,2,2",
        "-o",
    ];
    expect(&folder.run(&[&bake[..], &["light.nrrd"]].concat()), 0, "");
    for name in ["squares.nrrd", "squares.vti", "squares.raw"] {
        expect(
            &folder.run(&[&bake[..], &[name, "--store", "reciprocal"]].concat()),
            0,
            "",
        );
        let light = Texture::open(folder.path().join("light.nrrd")).unwrap();
        let squares = Texture::open(folder.path().join(name)).unwrap();
        assert_eq!(squares.storage(), Storage::Reciprocal { power: 2 });
        for (light, square) in light.values().iter().zip(squares.values().iter()) {
            assert!(
                (light * light * square - 1.0).abs() < 1e-5,
                "{light} {square}"
            );
        }
    }
    // Beside another source: the strongest one's light, and the rest.
    for (color, channels) in [("1, 1, 1", 2), ("1, 0.5, 0.1", 6)] {
        let other = format!(
            "[[sphere]]\ncenter = [1, 0, 0]\nradius = 0.1\nprofile = \"inverse\"\ncolor = [{color}]\n"
        );
        let both = format!("{CAMERA}{ball}{other}");
        fs::write(folder.path().join("ball.toml"), both).unwrap();
        expect(&folder.run(&[&bake[..], &["light.nrrd"]].concat()), 0, "");
        let light = Texture::open(folder.path().join("light.nrrd")).unwrap();
        for name in ["squares.nrrd", "squares.vti", "squares.raw"] {
            let run = folder.run(&[&bake[..], &[name, "--store", "reciprocal"]].concat());
            expect(&run, 0, "");
            let squares = Texture::open(folder.path().join(name)).unwrap();
            let rest = squares.rest().unwrap();
            assert_eq!(2 * squares.channels(), channels, "{name}");
            let parts = squares.values().iter().zip(rest.values().iter());
            for (light, (square, rest)) in light.values().iter().zip(parts) {
                let sum = square.powf(-0.5) + rest;
                assert!(*rest > 0.0 && (sum / light - 1.0).abs() < 1e-5, "{name}");
            }
        }
    }
    let refused = folder.run(&[&bake[..], &["x.vdb", "--store", "reciprocal"]].concat());
    expect(&refused, 2, "reciprocals are of .nrrd");
}

#[test]
fn volumes_that_cannot_be_are_refused_with_their_place() {
    let folder = Folder::new();
    let cases = [
        ("[[volume]]\n", "volume[0].file"),
        (
            "[[volume]]\nlight_ball = {}\nsize = [1, 0, 1]\n",
            "edges above 0",
        ),
        ("[[volume]]\nlight_ball = { cells = 0 }\n", "1 to 512"),
        (
            "[[volume]]\nlight_ball = { radii = [3, 2, 7] }\n",
            "volume[0].light_ball.radii",
        ),
        ("[[volume]]\nfile = \"none.nrrd\"\n", "none.nrrd"),
        ("[[volume]]\nslices = \"none/*.png\"\n", "cannot read"),
        (
            "[[volume]]\nlight_ball = {}\ncoefficient = -1\n",
            "0 or more",
        ),
        (
            "[integration]\nslices = 0\n[[volume]]\nlight_ball = {}\n",
            "1 to 65536 slices",
        ),
    ];
    for (text, reason) in cases {
        fs::write(folder.path().join("wrong.toml"), format!("{CAMERA}{text}")).unwrap();
        let output = folder.run(&["render", "wrong.toml", "-o", "x.png"]);
        expect(&output, 3, reason);
    }
    fs::write(
        folder.path().join("good.toml"),
        format!("{CAMERA}[[volume]]\nlight_ball = {{}}\n"),
    )
    .unwrap();
    expect(
        &folder.run(&["render", "good.toml", "-o", "x.png", "--size", "16x16"]),
        0,
        "",
    );
    let scene = Scene::from_file(folder.path().join("good.toml")).unwrap();
    assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene);
}
