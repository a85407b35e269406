//! Tracks in the place of every value of every table.

use std::collections::BTreeSet;

use serde_json::Value as Json;

use super::super::track_tables;
use super::validator::refusal;
use super::{Form, json_schema, sample, scene, tables};
use crate::scene::{AnimatedScene, Scene};

/// Returns a scene, or what is wrong with it without its place, and without the time of the frame.
fn outcome(scene: crate::Result<Scene>) -> Result<Scene, String> {
    scene.map_err(|error| {
        let error = error.to_string();
        let (_, words) = error.split_once(' ').unwrap();
        words.split(" (at ").next().unwrap().to_owned()
    })
}

#[test]
fn every_number_vector_colour_and_series_may_be_a_track() {
    let schema: Json = serde_json::from_str(&json_schema()).unwrap();
    let (mut same, mut lists) = (0, 0);
    for table in tables().iter().filter(|table| table.name != "time") {
        for key in table.keys().filter(|key| key.form.may_be_track()) {
            let value = sample(key);
            let placed = match table.name {
                "group" | "rotate" | "repeat" => "[[group.sphere]]\ncenter = [1, 0.5, 0]\n",
                _ => "",
            };
            let text =
                |value: &str| scene(table, key.name, &format!("{} = {value}", key.name)) + placed;
            let expected = outcome(Scene::from_toml(&text(&value)));
            let check = |track: &str| {
                let text = text(track);
                let instance: Json = toml::from_str(&text).unwrap();
                assert_eq!(refusal(&schema, &instance), None, "{text}");
                assert_eq!(outcome(Scene::from_toml(&text)), expected, "{text}");
                let json = instance.to_string();
                assert_eq!(outcome(Scene::from_json(&json)), expected, "{json}");
                for scene in [
                    AnimatedScene::from_toml(text),
                    AnimatedScene::from_json(json),
                ] {
                    let scene = scene.unwrap();
                    assert!(scene.is_animated());
                    assert_eq!(outcome(scene.at(0.3)), expected, "{track}");
                }
            };
            for way in ["step", "linear", "smooth"] {
                let times = "times = [0, 1]";
                let way = format!("interpolation = \"{way}\"");
                check(&format!(
                    "{{ {times}, values = [{value}, {value}], {way} }}"
                ));
            }
            check(&format!(
                "{{ value = {value}, noise = {{ amplitude = 0, frequency = 9 }} }}"
            ));
            // A track in the place of the first item.
            if let Some((first, rest)) = value.strip_prefix('[').and_then(|it| it.split_once(", "))
                && !first.starts_with('[')
            {
                let still = format!("value = {first}, noise = {{ amplitude = 0, frequency = 9 }}");
                check(&format!("[{{ {still} }}, {rest}"));
                lists += 1;
            }
            // Another value is another scene.
            let other = value
                .replace("0.5", "0.25")
                .replace("1.5", "1.25")
                .replace('2', "3");
            let moves = format!("{{ times = [0, 1], values = [{value}, {other}] }}");
            let moves = AnimatedScene::from_toml(text(&moves)).unwrap();
            // What depths or a method have that there are not is not in the scene.
            let is_unused = ["none", "interval"].contains(&key.name);
            if expected.is_ok() && other != value && !is_unused && table.name != "repeat" {
                assert_ne!(
                    outcome(moves.at(1.0)),
                    expected,
                    "{}.{}",
                    table.name,
                    key.name
                );
                same += 1;
            }
        }
    }
    assert!(same > 70 && lists > 30, "{same} {lists}");
}

#[test]
fn what_is_no_number_is_no_track() {
    let schema: Json = serde_json::from_str(&json_schema()).unwrap();
    let mut count = 0;
    for table in tables() {
        let fixed = table
            .keys()
            .filter(|key| !key.form.may_be_track() || table.name == "time");
        for key in fixed {
            let line = format!("{} = {{ times = [0, 1], values = [1, 1] }}", key.name);
            let text = scene(&table, key.name, &line);
            assert!(
                refusal(&schema, &toml::from_str(&text).unwrap()).is_some(),
                "{text}"
            );
            let error = outcome(Scene::from_toml(&text)).unwrap_err();
            let says = match key.form {
                Form::Table(_) => "not of a whole table",
                Form::Tables(_) => "there may be several",
                _ if table.name == "time" => "expected a number",
                _ => "this stays as it is over time",
            };
            assert!(error.contains(says), "{}\n{text}\n{error}", key.name);
            count += 1;
        }
    }
    assert!(count > 40, "{count}");
}

#[test]
fn the_tables_of_tracks_have_the_keys_that_are_read() {
    let text = |keys: &str| {
        format!(
            "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n[[sphere]]\n[sphere.radius]\n{keys}"
        )
    };
    let read = |keys: &str| AnimatedScene::from_toml(text(keys));
    const NOISY: &str = "noise = { amplitude = 0.1, frequency = 2, zzz }\n";
    for (table, host) in track_tables()
        .iter()
        .zip(["times = [0, 1]\nvalues = [1, 2]\nzzz", NOISY])
    {
        let base = if table.name == "noise" {
            "value = 1\n"
        } else {
            ""
        };
        let fill = |words: &str| format!("{base}{}", host.replace("zzz", words));
        let fault = read(&fill("zzz = 1")).unwrap_err().to_string();
        let (_, expected) = fault.split_once(", expected one of ").unwrap();
        let expected: BTreeSet<&str> = expected.split('`').skip(1).step_by(2).collect();
        let known: BTreeSet<&str> = table.keys().map(|key| key.name).collect();
        assert_eq!(expected, known);
        let plain = read(&fill(""))
            .or_else(|_| read(&fill("seed = 0")))
            .unwrap();
        for key in table.keys() {
            if let super::Absent::Value(value) = key.absent {
                let with = read(&fill(&format!("{} = {value}", key.name))).unwrap();
                for time in [-0.3, 0.3, 1.7] {
                    assert_eq!(
                        with.at(time).unwrap(),
                        plain.at(time).unwrap(),
                        "{}",
                        key.name
                    );
                }
            }
        }
    }
}
