//! Surfaces in scene files: particles from every kind of file, tracks, what is written and read again, and what the
//! program says.

use energywave::glam::DVec3;
use energywave::scene::{
    AnimatedScene, Camera, MetaballKernel, MetaballMethod, MetaballSampling, MetaballShading,
    Metaballs, PointList, PointSize,
};
use energywave::{RadianceImage, Renderer, Scene};

use crate::common::device;
use crate::common::program::{self, Folder, expect, stderr};

const CAMERA: &str = "[camera]\neye = [0.0, -6.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\n[image]\nwidth = 40\nheight = 30\n";
const PLACES: [[f32; 3]; 3] = [[0.0, 0.5, -0.25], [1.0, 0.0, 0.0], [-0.5, 0.25, 2.0]];

fn bytes_of(numbers: impl IntoIterator<Item = f32>) -> Vec<u8> {
    numbers.into_iter().flat_map(f32::to_le_bytes).collect()
}

#[test]
fn particles_are_the_same_from_every_kind_of_file() {
    let folder = Folder::new();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let lines = PLACES.map(|[x, y, z]| format!("{x} {y} {z}\n")).concat();
    write(
        "a.csv",
        ("x,y,z\n".to_owned() + &lines.replace(' ', ",")).as_bytes(),
    );
    write("b.csv", ("# by hand\n\n".to_owned() + &lines).as_bytes());
    write("a.f32", &bytes_of(PLACES.into_iter().flatten()));
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 3), }";
    let mut npy = b"\x93NUMPY\x01\x00".to_vec();
    npy.extend((header.len() as u16).to_le_bytes());
    npy.extend(header.bytes());
    npy.extend(bytes_of(PLACES.into_iter().flatten()));
    write("a.npy", &npy);
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    write("a.ply", (head.to_owned() + &lines).as_bytes());
    let expected: Vec<DVec3> = PLACES
        .iter()
        .map(|place| DVec3::from_array(place.map(f64::from)))
        .collect();
    for name in ["a.csv", "b.csv", "a.f32", "a.npy", "a.ply"] {
        write(
            "scene.toml",
            format!("{CAMERA}[[metaballs]]\nfile = \"{name}\"\n").as_bytes(),
        );
        let scene = Scene::from_file(folder.path().join("scene.toml")).unwrap();
        assert_eq!(scene.metaballs[0].points.positions(), expected, "{name}");
        let again = Scene::from_toml(&scene.to_toml().unwrap()).unwrap();
        assert_eq!(again, scene, "{name}");
    }
    write("sized.csv", b"0,0,0,0.5,2\n1,0,0,0.25,1\n");
    let points = PointList::from_file(folder.path().join("sized.csv")).unwrap();
    let expected = [(0.5, 2.0), (0.25, 1.0)].map(|(radius, weight)| PointSize { radius, weight });
    assert_eq!(points.sizes(), Some(&expected[..]));
}

#[test]
fn a_surface_that_was_written_is_read_again() {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -6.0, 2.0), DVec3::ZERO));
    scene.metaballs.push(Metaballs {
        threshold: 0.25,
        kernel: MetaballKernel::Smooth,
        shading: MetaballShading::Normals,
        method: MetaballMethod::Sampling(MetaballSampling {
            interval: Some(0.125),
            samples: 48,
            refinements: 2,
        }),
        color: DVec3::new(0.5, 0.25, 1.0),
        translate: DVec3::X,
        ..Metaballs::new(PointList::new(vec![DVec3::Y, DVec3::Z]).unwrap(), 1.5)
    });
    scene
        .metaballs
        .push(Metaballs::new(PointList::default(), 2.0));
    assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene);
    assert_eq!(Scene::from_json(&scene.to_json().unwrap()).unwrap(), scene);
    let sizes = vec![PointSize {
        radius: 1.0,
        weight: 1.0,
    }];
    scene.metaballs[0].points = PointList::with_sizes(vec![DVec3::X], sizes).unwrap();
    let error = scene.to_toml().unwrap_err().to_string();
    assert!(error.contains("write them as .csv"), "{error}");
}

#[test]
fn tracks_move_a_surface_whose_particles_are_read_once() {
    let text = format!(
        "{CAMERA}[[metaballs]]\nlattice = {{ count = 600, spacing = 0.4 }}\n\
         radius = {{ times = [0, 2], values = [0.5, 1.0] }}\n\
         translate = {{ times = [0, 2], values = [[0, 0, 0], [0, 0, 4]] }}\n\
         [[metaballs]]\npoints = [[{{ times = [0, 2], values = [0, 6] }}, 0, 0]]\n"
    );
    let scene = AnimatedScene::from_toml(text).unwrap();
    let (first, last) = (scene.at(0.0).unwrap(), scene.at(1.0).unwrap());
    assert_eq!(
        (first.metaballs[0].radius, last.metaballs[0].radius),
        (0.5, 0.75)
    );
    assert_eq!(last.metaballs[0].translate, DVec3::new(0.0, 0.0, 2.0));
    let list = |scene: &Scene| scene.metaballs[0].points.positions().as_ptr();
    assert_eq!(list(&first), list(&last));
    assert_eq!(
        last.metaballs[1].points.positions(),
        [DVec3::new(3.0, 0.0, 0.0)]
    );
    assert_ne!(first, last);
}

#[test]
fn a_scene_of_surfaces_alone_is_drawn_without_a_warning_and_one_without_particles_with_one() {
    let folder = Folder::new();
    let save = |text: &str| {
        std::fs::write(folder.path().join("scene.toml"), format!("{CAMERA}{text}")).unwrap()
    };
    save("[[metaballs]]\npoints = [[0, 0, 0]]\nradius = 3\n");
    let arguments = [
        "render",
        "scene.toml",
        "-o",
        "out.png",
        "--device",
        program::device(),
    ];
    let output = folder.run(&arguments);
    expect(&output, 0, "drawn: 40x30 pixels");
    assert!(!stderr(&output).contains("warning"), "{}", stderr(&output));
    let picture = image::open(folder.path().join("out.png"))
        .unwrap()
        .into_rgb8();
    assert!(picture.iter().any(|value| *value > 150));
    save("[[metaballs]]\n");
    expect(
        &folder.run(&arguments),
        0,
        "warning: scene.toml:7:1: metaballs[0]: it has no particle",
    );
}

#[test]
fn two_devices_draw_what_one_does() {
    let folder = Folder::new();
    let scene = "[[metaballs]]\nlattice = { columns = [4, 3], count = 40, spacing = 0.5, jitter = 0.3 }\nradius = 0.8\n\
        [[sphere]]\ncenter = [0, 1, 0]\nradius = 0.2\n";
    std::fs::write(folder.path().join("scene.toml"), format!("{CAMERA}{scene}")).unwrap();
    if device().platform != "Portable Computing Language" {
        return; // which shows one processor twice
    }
    for (devices, choice, name) in [
        ("pthread", "cpu", "one.exr"),
        ("pthread pthread", "all", "two.exr"),
    ] {
        let mut command = folder.command();
        command.args(["render", "scene.toml", "-o", name, "--device", choice]);
        let output = command.env("POCL_DEVICES", devices).output().unwrap();
        expect(&output, 0, "drawn: 40x30 pixels");
    }
    let pixels = |name: &str| RadianceImage::open(folder.path().join(name)).unwrap();
    let (one, two) = (pixels("one.exr"), pixels("two.exr"));
    let (one, two) = (one.as_slice(), two.as_slice());
    let differ = one
        .iter()
        .zip(two)
        .filter(|(a, b)| (*a - *b).abs() > 2e-3 * (0.1 + a.abs()));
    assert_eq!(differ.count(), 0);
}

#[test]
fn groups_of_lights_add_up_to_the_scene_whose_surfaces_hide_them_all() {
    let text = format!(
        "{CAMERA}[integration]\nantialias = \"none\"\n[[metaballs]]\npoints = [[0, 0, 0]]\nradius = 4\n\
         [[sphere]]\ncenter = [0, 2, 0]\nlight_group = \"key\"\n"
    );
    let scene = Scene::from_toml(&text).unwrap();
    let mut renderer = Renderer::new(&device()).unwrap();
    let mut draw = |scene: &Scene| renderer.render(scene).unwrap();
    let (whole, key, rest) = (
        draw(&scene),
        draw(&scene.of_light_group(Some("key"))),
        draw(&scene.of_light_group(None)),
    );
    assert!(scene.has_ungrouped_light());
    let mut open = scene.clone();
    open.metaballs.clear();
    let (open, middle) = (draw(&open), 4 * (15 * 40 + 20));
    assert!(key.as_slice()[middle] < 0.3 * open.as_slice()[middle]);
    let parts = key.as_slice().chunks(4).zip(rest.as_slice().chunks(4));
    for (whole, (key, rest)) in whole.as_slice().chunks(4).zip(parts) {
        assert!((whole[0] - key[0] - rest[0]).abs() < 1e-5 * (1.0 + whole[0]));
    }
}

#[test]
fn single_rays_see_no_surface() {
    let text = format!(
        "{CAMERA}[[metaballs]]\npoints = [[0, 0, 0]]\nradius = 3\n[[sphere]]\nradius = 0.5\n"
    );
    let mut scene = Scene::from_toml(&text).unwrap();
    let ray = energywave::Ray::between(DVec3::new(0.0, -6.0, 1.0), DVec3::new(0.0, 6.0, 1.0));
    let mut renderer = Renderer::new(&device()).unwrap();
    let with = renderer.integrate(&scene, &[ray]).unwrap();
    scene.metaballs.clear();
    assert_eq!(with, renderer.integrate(&scene, &[ray]).unwrap());
}
