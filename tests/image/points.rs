//! Points of light: as many spheres, from every kind of file.

use std::fs;

use energywave::image::ImageSize;
use energywave::scene::{Antialias, Camera, Crowd, Decay, PointList, Points, Profile, Sphere};
use energywave::{Scene, reference};
use glam::DVec3;

use crate::common;

/// No multiple of a block or a tile.
pub const SIZE: ImageSize = ImageSize {
    width: 61,
    height: 45,
};

/// A few points, each with a light of its own, of both signs.
fn few(profile: Profile) -> Points {
    let positions = (0..7).map(|k| {
        let turn = f64::from(k);
        DVec3::new(turn.cos(), 0.3 * turn - 1.0, turn.sin())
    });
    let lights = (0..7_u8).map(|k| [0.1 * f32::from(k), 0.2, 0.5 - 0.1 * f32::from(k)]);
    let list = PointList::with_lights(positions.collect(), lights.collect()).unwrap();
    let mut points = Points::new(list);
    (points.profile, points.coefficient) = (profile, 0.5);
    points
}

pub fn scene() -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 0.5), DVec3::ZERO));
    scene.image = SIZE;
    scene.decay = Some(Decay::new(0.1, 0.1));
    scene.integration.antialias = Antialias::None;
    scene
}

#[test]
fn points_apart_are_spheres_on_the_device_and_the_reference() {
    for profile in [Profile::Inverse, Profile::InverseSquare] {
        let points = few(profile);
        let (mut crowd, mut spheres) = (scene(), scene());
        crowd.integration.crowd = Crowd::Never;
        for (position, light) in points
            .points
            .positions()
            .iter()
            .zip(points.points.lights().unwrap())
        {
            spheres.spheres.push(Sphere {
                center: *position,
                color: 0.5 * DVec3::from(light.map(f64::from)),
                profile,
                ..Sphere::default()
            });
        }
        crowd.points.push(points);
        assert_eq!(crowd.ray_length(), spheres.ray_length());
        let mut renderer = common::renderer(common::device().lanes, "");
        let image = renderer.render(&crowd).unwrap();
        assert_eq!(
            image.as_slice(),
            renderer.render(&spheres).unwrap().as_slice()
        );
        let truth = reference::render(&crowd).unwrap();
        assert_eq!(
            truth.as_slice(),
            reference::render(&spheres).unwrap().as_slice()
        );
        crowd.points[0].coefficient = 0.4;
        assert_ne!(
            image.as_slice(),
            renderer.render(&crowd).unwrap().as_slice()
        );
    }
}

#[test]
fn points_are_the_same_from_every_kind_of_file() {
    let folder = tempfile::tempdir().unwrap();
    let points = few(Profile::Inverse).points;
    let path = |name: &str| folder.path().join(name);
    let rows: Vec<[f32; 6]> = points
        .positions()
        .iter()
        .zip(points.lights().unwrap())
        .map(|(place, light)| {
            let [x, y, z] = place.as_vec3().to_array();
            [x, y, z, light[0], light[1], light[2]]
        })
        .collect();
    let words = |row: &[f32; 6]| row.map(|it| it.to_string()).join(",") + "\n";
    let text: String = rows.iter().map(words).collect();
    fs::write(path("points.csv"), format!("x,y,z,r,g,b\n{text}")).unwrap();
    let numbers: Vec<u8> = rows
        .iter()
        .flatten()
        .flat_map(|it| it.to_le_bytes())
        .collect();
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (7, 6), }\n";
    let mut npy = b"\x93NUMPY\x01\x00".to_vec();
    npy.extend((header.len() as u16).to_le_bytes());
    fs::write(
        path("points.npy"),
        [npy, header.into(), numbers.clone()].concat(),
    )
    .unwrap();
    let names = ["x", "y", "z", "red", "green", "blue"].map(|it| format!("property float {it}\n"));
    let head = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex 7\n{}end_header\n",
        names.concat()
    );
    fs::write(path("points.ply"), [head.into_bytes(), numbers].concat()).unwrap();
    let scene = |name: &str| {
        let text = format!(
            "[camera]\neye = [0, -4, 0]\ntarget = [0, 0, 0]\n[[points]]\nfile = \"{name}\"\nprofile = \"inverse\"\n"
        );
        fs::write(path("scene.toml"), text).unwrap();
        Scene::from_file(path("scene.toml")).unwrap()
    };
    let first = scene("points.csv");
    assert_eq!(
        first.points[0].points.lights().unwrap(),
        points.lights().unwrap()
    );
    for name in ["points.npy", "points.ply"] {
        let list = scene(name).points[0].points.clone();
        assert_eq!(list.lights(), first.points[0].points.lights(), "{name}");
        let pairs = list.positions().iter().zip(points.positions());
        let farthest = pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(list.len() == 7 && farthest < 1e-6, "{name}: {farthest}");
    }
    let again = Scene::from_toml(&first.to_toml().unwrap()).unwrap();
    assert!(again.points == first.points);
}
