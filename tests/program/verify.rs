//! `energywave verify`: a row for every known ray, past one source or a whole scene, and exit code 6 where one is off.

use crate::common::program::{Folder, device, expect};
use energywave::scene::Method;
use energywave::{Device, Ray, Renderer, Scene};
use glam::DVec3;
use serde_json::Value;

#[test]
fn verify_prints_a_row_for_every_ray_and_fails_on_a_wrong_one() {
    let folder = Folder::new();
    let output = folder.run(&["verify", "--json", "--device", device()]);
    expect(&output, 0, "320 of 320 values within their limits");
    let rows: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(rows.len(), 320);
    assert_eq!(rows[32]["kind"], "torus");
    assert_eq!(rows[160]["method"], "exact");
    assert!(
        rows.iter()
            .all(|row| row["relative_error"].as_f64().unwrap() < 1e-3)
    );

    let mut rays: Vec<Value> = serde_json::from_str(include_str!("../data/rays.json")).unwrap();
    rays.truncate(3);
    rays[1]["simpson_200"] = (rays[1]["simpson_200"].as_f64().unwrap() * 1.01).into();
    let file = folder.path().join("rays.json");
    std::fs::write(&file, serde_json::to_string(&rays).unwrap()).unwrap();
    let spoiled = folder.run(&[
        "verify",
        "--rays",
        "rays.json",
        "--json",
        "--device",
        device(),
    ]);
    expect(
        &spoiled,
        6,
        "5 of 6 values within their limits; the worst is ray 1",
    );
    let rows: Vec<Value> = serde_json::from_slice(&spoiled.stdout).unwrap();
    assert_eq!(
        rows.len(),
        6,
        "the rows are printed before the program fails"
    );
    expect(
        &folder.run(&["verify", "--rays", "rays.json", "--device", device()]),
        6,
        "ray 1",
    );

    std::fs::write(&file, "[{\"kind\": \"torus\"}]").unwrap();
    expect(
        &folder.run(&["verify", "--rays", "rays.json"]),
        3,
        "rays.json: not a list of rays",
    );
    rays[2]["start"] = serde_json::json!([1e30, 0.0, 0.0]);
    std::fs::write(&file, serde_json::to_string(&rays).unwrap()).unwrap();
    let far = folder.run(&["verify", "--rays", "rays.json"]);
    expect(
        &far,
        3,
        "rays.json: ray 2: start: x is 1e30; float32 devices can integrate to 1e9",
    );
    std::fs::write(&file, "[]").unwrap();
    expect(
        &folder.run(&["verify", "--rays", "rays.json"]),
        6,
        "nothing was checked",
    );
    expect(
        &folder.run(&["verify", "--rays", "none.json"]),
        3,
        "none.json: cannot read",
    );
}

/// A row of a rays file: past a whole scene, green light only, whose integral is `exact`.
fn row_of(scene: &Value, exact: f64) -> Value {
    serde_json::json!({
        "scene": scene,
        "start": [0.2, -3.0, 1.0],
        "end": [0.1, 3.0, -1.0],
        "exact": exact,
    })
}

#[test]
fn verify_takes_whole_scenes_with_and_without_a_camera_by_either_measure() {
    let torus =
        serde_json::json!({"major_radius": 0.9, "coefficient": 5.0, "color": [9.0, 0.5, 0.1]});
    let beam = serde_json::json!({"tip": [0.1, 0.3, 0.2], "direction": [1.0, 0.1, 0.2], "color": [0.0, 2.0, 0.0]});
    let sources = serde_json::json!({
        "torus": [torus],
        "beam": [beam],
        "decay": {"alpha": 0.1, "beta": 0.2},
        "integration": {"measure": "parameter"},
    });
    let mut seen = sources.clone();
    seen["camera"] = serde_json::json!({"eye": [5.0, 6.0, 7.0], "target": [0.0, 0.0, 0.0]});
    seen["image"] = serde_json::json!({"width": 3, "height": 2});
    let mut by_length = sources.clone();
    by_length["integration"] = serde_json::json!({"measure": "length"});

    let ray = Ray::between(DVec3::new(0.2, -3.0, 1.0), DVec3::new(0.1, 3.0, -1.0));
    let scene = Scene::from_json(&seen.to_string()).unwrap();
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    let [_, exact, _] = reference.integrate(&scene, &[ray]).unwrap()[0];
    let length = ray.span.length();

    let folder = Folder::new();
    let verify = |rows: &[Value]| {
        let text = serde_json::to_string(rows).unwrap();
        std::fs::write(folder.path().join("rays.json"), text).unwrap();
        folder.run(&[
            "verify",
            "--rays",
            "rays.json",
            "--json",
            "--device",
            device(),
        ])
    };
    let rows = [
        row_of(&sources, exact),
        row_of(&seen, exact),
        row_of(&by_length, exact * length),
    ];
    let right = verify(&rows);
    expect(&right, 0, "3 of 3 values within their limits");
    let found: Vec<Value> = serde_json::from_slice(&right.stdout).unwrap();
    assert_eq!(found.len(), 3, "without simpson_200 there is no row for it");
    for (row, expected) in found.iter().zip([exact, exact, exact * length]) {
        assert_eq!(
            (&row["kind"], &row["method"]),
            (&"scene".into(), &"exact".into())
        );
        assert_eq!(row["exact"].as_f64(), Some(expected));
    }

    // By the Simpson rule too, where its sum is given.
    let mut simpson = scene;
    simpson.integration.method = Method::simpson(200);
    let [_, sum, _] = reference.integrate(&simpson, &[ray]).unwrap()[0];
    let mut both = row_of(&sources, exact);
    both["simpson_200"] = sum.into();
    expect(&verify(&[both]), 0, "2 of 2 values");

    // Whatever is wrong, the length or the integral, is found.
    for (wrong, worst) in [
        (row_of(&sources, exact * length), "ray 1 (scene, exact)"),
        (row_of(&by_length, exact), "ray 1 (scene, exact)"),
        (row_of(&seen, 1.01 * exact), "ray 1 (scene, exact)"),
    ] {
        let spoiled = verify(&[row_of(&sources, exact), wrong]);
        expect(&spoiled, 6, "1 of 2 values within their limits");
        expect(&spoiled, 6, worst);
    }

    let mut invalid = sources.clone();
    invalid["torus"][0]["major_radius"] = (-1.0).into();
    let mut unknown = sources;
    unknown["toruss"] = 1.into();
    let mut bare = row_of(&Value::Null, exact);
    bare.as_object_mut().unwrap().remove("scene");
    for (row, words) in [
        (
            row_of(&invalid, exact),
            "rays.json: ray 0: scene: torus[0].major_radius: must be positive",
        ),
        (row_of(&unknown, exact), "unknown field `toruss`"),
        (bare, "rays.json: ray 0: neither a kind nor a scene"),
    ] {
        expect(&verify(&[row]), 3, words);
    }
}

#[test]
fn verify_goes_through_volumes() {
    let folder = Folder::new();
    // A light ball larger than its cube: 0.9 in all of it, which is 2 wide.
    let ball =
        serde_json::json!({"light_ball": {"radii": [60.0, 61.0, 62.0], "alphas": [0.9, 0.5, 0.1]}});
    let scene = serde_json::json!({"volume": [ball], "integration": {"measure": "length"}});
    let row = |exact: f64| serde_json::json!({"scene": scene, "start": [-3.0, 0.1, 0.2], "end": [3.0, 0.1, 0.2], "exact": exact});
    for (exact, code) in [(1.8, 0), (1.81, 6)] {
        let rays = serde_json::to_string(&[row(exact)]).unwrap();
        std::fs::write(folder.path().join("rays.json"), rays).unwrap();
        let output = folder.run(&["verify", "--rays", "rays.json", "--device", device()]);
        expect(&output, code, "values within their limits");
    }
}
