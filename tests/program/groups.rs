//! Groups are the sources that they stand for: as TOML, as JSON and in code.

use std::fmt::Write;

use energywave::Scene;
use energywave::scene::{
    Beam, BeamEnd, Camera, Curve, Cylinder, Group, Layer, LightPath, Repeat, Rotation, Segment,
    Sphere, Torus,
};
use glam::{DMat3, DVec3};

use crate::bad_scenes::CAMERA;

/// What rounding makes of a turn.
const ROUNDING: f64 = 1e-12;

fn scene(rest: &str) -> Scene {
    Scene::from_toml(&format!("{CAMERA}{rest}")).unwrap()
}

#[track_caller]
fn near(found: DVec3, expected: DVec3) {
    assert!(found.distance(expected) < ROUNDING, "{found} {expected}");
}

#[test]
fn twelve_beams_by_repeat_are_twelve_beams_written_out() {
    let repeated = scene(
        "[[group]]\nrepeat = { count = 12, axis = [0, 0, 2] }\n\
         [[group.beam]]\ntip = [0.5, 0, 0.1]\ndirection = [1, 0, 0]\nradius = 0.1\ntaper_length = 0.4\n",
    );
    let mut text = String::new();
    for k in 0..12 {
        let (sine, cosine) = f64::from(30 * k).to_radians().sin_cos();
        let tip = (0.5 * cosine, 0.5 * sine);
        write!(
            text,
            "[[beam]]\ntip = [{:?}, {:?}, 0.1]\ndirection = [{cosine:?}, {sine:?}, 0]\nradius = 0.1\ntaper_length = 0.4\n",
            tip.0, tip.1
        )
        .unwrap();
    }
    let written = scene(&text);
    assert_eq!(repeated.source_count(), 12);
    for (one, other) in repeated.beams.iter().zip(&written.beams) {
        near(one.tip, other.tip);
        near(one.direction, other.direction);
        let same = Beam {
            tip: other.tip,
            direction: other.direction,
            ..one.clone()
        };
        assert_eq!(same, *other);
    }
    // What is written back is what was made.
    let again = Scene::from_toml(&repeated.to_toml().unwrap()).unwrap();
    assert_eq!(again, repeated);
}

/// A group whose scale, turn and way no two orders make alike.
fn placed() -> Group {
    Group {
        scale: 2.0,
        rotate: Some(Rotation {
            axis: 3.0 * DVec3::Z,
            angle: 90.0,
        }),
        translate: DVec3::new(10.0, 0.0, 1.0),
        ..Group::default()
    }
}

#[test]
fn a_group_scales_then_turns_then_moves_and_scales_lengths_alone() {
    let layer = Layer {
        radius: Some(0.1),
        reach: Some(3.0),
        coefficient: Some(5.0),
        ..Layer::default()
    };
    let (x, y) = (DVec3::X, DVec3::Y);
    let group = Group {
        spheres: vec![Sphere {
            center: x,
            coefficient: 3.0,
            radius: 0.25,
            reach: Some(1.5),
            layers: vec![layer.clone()],
            ..Sphere::default()
        }],
        cylinders: vec![Cylinder {
            point: x,
            ..Cylinder::new(x)
        }],
        beams: vec![Beam {
            tip: x,
            end: BeamEnd::Taper(0.5),
            sphere_coefficient: 0.3,
            ..Beam::new(3.0 * x)
        }],
        tori: vec![Torus {
            center: x,
            axis: x,
            radius: 0.1,
            ..Torus::new(0.7)
        }],
        curves: vec![Curve::new([DVec3::ZERO, x, y])],
        segments: vec![Segment::new(x, y)],
        paths: vec![LightPath {
            flatness: Some(0.01),
            ..LightPath::new(vec![DVec3::ZERO, x, y])
        }],
        ..placed()
    };
    let mut scene = Scene::new(Camera::new(-4.0 * y, DVec3::ZERO));
    scene.spheres.push(Sphere::default());
    scene.add_group(&group).unwrap();
    let (o, of_x) = (DVec3::new(10.0, 0.0, 1.0), DVec3::new(10.0, 2.0, 1.0));
    let of_y = DVec3::new(8.0, 0.0, 1.0);
    assert_eq!(scene.spheres[0], Sphere::default());
    let sphere = &scene.spheres[1];
    near(sphere.center, of_x);
    assert_eq!(
        (sphere.coefficient, sphere.radius, sphere.reach),
        (3.0, 0.5, Some(3.0))
    );
    let layers = [Layer {
        radius: Some(0.2),
        reach: Some(6.0),
        ..layer
    }];
    assert_eq!(sphere.layers, layers);
    near(scene.cylinders[0].point, of_x);
    near(scene.cylinders[0].direction, y);
    near(scene.beams[0].tip, of_x);
    near(scene.beams[0].direction, 3.0 * y);
    assert_eq!(scene.beams[0].end, BeamEnd::Taper(1.0));
    assert_eq!(scene.beams[0].sphere_coefficient, 0.3);
    let torus = &scene.tori[0];
    near(torus.center, of_x);
    near(torus.axis, y);
    assert_eq!((torus.major_radius, torus.radius), (1.4, 0.2));
    let [a, b, c] = scene.curves[0].control_points;
    near(a, o);
    near(b, of_x);
    near(c, of_y);
    near(scene.segments[0].from, of_x);
    near(scene.segments[0].to, of_y);
    let path = &scene.paths[0];
    near(path.points[0], o);
    near(path.points[2], of_y);
    assert_eq!(path.flatness, Some(0.02));
}

#[test]
fn groups_in_groups_are_placed_one_after_the_other() {
    let repeat = Repeat {
        angle: Some(20.0),
        step: DVec3::new(0.0, 0.0, 0.5),
        ..Repeat::around(3, DVec3::Z)
    };
    let inner = Group {
        repeat: Some(repeat),
        translate: DVec3::new(1.0, 0.0, 0.0),
        spheres: vec![Sphere {
            center: DVec3::X,
            ..Sphere::default()
        }],
        ..Group::default()
    };
    let outer = Group {
        repeat: Some(Repeat::along(2, DVec3::new(0.0, 5.0, 0.0))),
        groups: vec![inner],
        ..placed()
    };
    let mut made = Scene::new(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO));
    made.add_group(&outer).unwrap();
    let mut expected = Vec::new();
    for row in 0..2 {
        for k in 0..3 {
            let turned = DMat3::from_rotation_z(f64::from(20 * k).to_radians()) * DVec3::X;
            let inside = turned + f64::from(k) * 0.5 * DVec3::Z + DVec3::X;
            let repeated = inside + f64::from(row) * 5.0 * DVec3::Y;
            let (scaled, quarter) = (
                2.0 * repeated,
                DMat3::from_rotation_z(1.5 * std::f64::consts::PI).transpose(),
            );
            expected.push(quarter * scaled + DVec3::new(10.0, 0.0, 1.0));
        }
    }
    assert_eq!(made.spheres.len(), 6);
    for (sphere, expected) in made.spheres.iter().zip(expected) {
        near(sphere.center, expected);
    }
    // The same as TOML and as JSON.
    let toml = "[[group]]\nscale = 2\ntranslate = [10, 0, 1]\nrotate = { axis = [0, 0, 3], angle = 90 }\n\
        repeat = { count = 2, step = [0, 5, 0] }\n\
        [[group.group]]\ntranslate = [1, 0, 0]\nrepeat = { count = 3, angle = 20, axis = [0, 0, 1], step = [0, 0, 0.5] }\n\
        [[group.group.sphere]]\ncenter = [1, 0, 0]\n";
    assert_eq!(scene(toml).spheres, made.spheres);
    let json = r#"{"camera": {"eye": [0, -4, 2], "target": [0, 0, 0]}, "group": [{"scale": 2, "translate": [10, 0, 1],
        "rotate": {"axis": [0, 0, 3], "angle": 90}, "repeat": {"count": 2, "step": [0, 5, 0]}, "group": [
        {"translate": [1, 0, 0], "repeat": {"count": 3, "angle": 20, "axis": [0, 0, 1], "step": [0, 0, 0.5]},
        "sphere": [{"center": [1, 0, 0]}]}]}]}"#;
    assert_eq!(Scene::from_json(json).unwrap(), scene(toml));
}

#[test]
fn a_group_in_code_is_refused_and_the_scene_stays() {
    let mut scene = Scene::new(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO));
    let sphere = || vec![Sphere::default()];
    let many = |groups| Group {
        repeat: Some(Repeat::around(10_000, DVec3::Z)),
        groups,
        ..Group::default()
    };
    let mut deep = Group::default();
    for _ in 0..8 {
        deep = Group {
            groups: vec![deep],
            ..Group::default()
        };
    }
    let none = Group {
        spheres: sphere(),
        repeat: Some(Repeat::along(0, DVec3::X)),
        ..Group::default()
    };
    let dark = Group {
        spheres: vec![Sphere {
            radius: -1.0,
            ..Sphere::default()
        }],
        ..Group::default()
    };
    let full = Group {
        spheres: sphere(),
        ..Group::default()
    };
    for (group, words) in [
        (none, "group.repeat.count: 0 copies"),
        (dark, "group.sphere[0].radius: a thickness"),
        (deep, "at most 8 deep"),
        (
            many(vec![many(vec![many(vec![full])])]),
            "group: groups make 1000000000000 sources, more than 1000000",
        ),
        (
            Group {
                scale: 0.0,
                ..Group::default()
            },
            "group.scale: must be positive, found 0",
        ),
    ] {
        let error = scene.add_group(&group).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
        assert_eq!(scene.source_count(), 0);
    }
    // Ten thousand times ten thousand times nothing is nothing, at once.
    scene
        .add_group(&many(vec![many(vec![many(vec![])])]))
        .unwrap();
    assert_eq!(scene.source_count(), 0);
}

#[test]
fn a_large_file_with_groups_and_layers_is_read_and_its_faults_have_their_places() {
    const COUNT: usize = 9_000;
    let group = "[[group]]\ntranslate = [1, 2, 3]\n[group.repeat]\ncount = 2\nstep = [0, 0, 1]\n\
        [[group.sphere]]\ncenter = [1, 0, 0]\n[[group.sphere.layers]]\nradius = 0.1\n[[group.sphere.layers]]\n";
    let torus = "[[torus]]\nmajor_radius = 1\n[[torus.layers]]\nradius = 0.5\n";
    let unit = format!("{group}{torus}");
    let text = format!("{CAMERA}{}", unit.repeat(COUNT));
    assert!(text.len() > 1 << 20, "{} bytes are one piece", text.len());
    let whole = Scene::from_toml(&text).unwrap();
    assert_eq!((whole.spheres.len(), whole.tori.len()), (2 * COUNT, COUNT));
    assert!(whole.spheres.iter().all(|it| it.layers.len() == 2));
    let lines = |text: &str| text.lines().count();
    let bad = unit.replace("radius = 0.1", "radius = -0.1");
    let text = format!("{CAMERA}{}{bad}{unit}", unit.repeat(COUNT));
    let line = lines(CAMERA) + COUNT * lines(&unit) + 9;
    let error = Scene::from_toml(&text).unwrap_err().to_string();
    let place = format!("{line}:10: group[{COUNT}].sphere[0].layers[0].radius: a thickness");
    assert!(error.contains(&place), "{error}\nhas not {place}");
    let bad = unit.replace("count = 2", "count = 2.5");
    let text = format!("{CAMERA}{}{bad}{unit}", unit.repeat(COUNT));
    let error = Scene::from_toml(&text).unwrap_err().to_string();
    let place = format!("{}:9: group[{COUNT}].repeat.count:", line - 5);
    assert!(error.contains(&place), "{error}\nhas not {place}");
}
