//! The tables of keys against what serde reads, and the schema against both, and against every scene.

mod tracks;
mod validator;

use std::collections::BTreeSet;
use std::fs;
use std::ops::Bound;
use std::path::Path;

use serde_json::Value as Json;

use super::{Absent, Count, Form, Key, Table, json_schema, table, tables, track_tables};
use crate::scene::file::raw_fault;
use crate::scene::{Preset, Scene};
use validator::{refusal, refusal_of_table};

const DEPTH: &str = "tests/data/tetrahedra.exr";

/// Returns a value of a key that is right there, in TOML.
fn sample(key: &Key) -> String {
    match key.form {
        _ if key.name == "target" => "[0, 0, 0]".to_owned(),
        Form::ColorOrFile => "\"#102030\"".to_owned(),
        Form::Matrix => format!("{:?}", glam::DMat4::IDENTITY.to_cols_array()),
        Form::Number(..) | Form::NumberOrNan | Form::NumberOr(..) => "0.5".to_owned(),
        Form::Whole(least, _) => least.max(1).to_string(),
        Form::Flag => "true".to_owned(),
        Form::Text => "\"Z\"".to_owned(),
        Form::File => format!("\"{DEPTH}\""),
        Form::Word(words) => format!("\"{}\"", words[0]),
        Form::Color => "[1, 0.5, 0]".to_owned(),
        Form::Numbers(least, _) => {
            format!("[{}]", ["1.5", "2.5", "0.5"][..least as usize].join(", "))
        }
        Form::Vectors(least, _) => {
            format!("[{}]", vec!["[1, 2, 3]"; least.max(1) as usize].join(", "))
        }
        Form::Colors(least) => format!("[{}]", vec!["\"#ff8800\""; least as usize].join(", ")),
        Form::TrackValue => "0.5".to_owned(),
        Form::TrackValues(least) => format!("[{}]", vec!["0.5"; least as usize].join(", ")),
        Form::Table(name) => inline(&table(name).unwrap()),
        Form::Tables(name) => format!("[{}]", inline(&table(name).unwrap())),
    }
}

fn inline(table: &Table) -> String {
    format!("{{ {} }}", required(table, "").join(", "))
}

fn must_be_said(key: &Key) -> bool {
    matches!(key.absent, Absent::Required | Absent::RequiredWithout(_))
}

/// Returns what must be said in a table, but for one key.
fn required(table: &Table, but: &str) -> Vec<String> {
    let needed = table
        .keys()
        .filter(|key| must_be_said(key) && key.name != but);
    needed
        .map(|key| format!("{} = {}", key.name, sample(key)))
        .collect()
}

/// Returns a scene in which a table says what it must, but for one key, and besides a line.
fn scene(table: &Table, but: &str, line: &str) -> String {
    let keys = |table: &Table, but: &str| match table.name {
        // The keys of matrices stand without those that they replace.
        "camera" if ["view", "projection", "range", "y"].contains(&but) => {
            let both = ["view", "projection"]
                .into_iter()
                .filter(|name| *name != but);
            let matrix = |name| {
                table
                    .keys()
                    .find(|key| key.name == name)
                    .map(sample)
                    .unwrap()
            };
            both.map(|name| format!("{name} = {}\n", matrix(name)))
                .collect()
        }
        // A collider has one shape.
        "collider" if !["box", "sphere", "plane", "mesh"].contains(&but) => {
            "sphere = { radius = 1 }\n".to_owned()
        }
        // A mesh has triangles.
        "mesh" if !["vertices", "triangles", "file"].contains(&but) => {
            "vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\ntriangles = [[0, 1, 2]]\n".to_owned()
        }
        // A volume has cells.
        "volume" if !["file", "slices", "light_ball"].contains(&but) => {
            "light_ball = {}\n".to_owned()
        }
        "simulation" if but != "time" => "time = 70\n".to_owned(),
        _ => required(table, but).join("\n") + "\n",
    };
    // Waves are shown as they are at a frame, whatever the time.
    let simulation = match table.name {
        "simulation" => "",
        _ => "[simulation]\ntime = 70\n",
    };
    let camera = format!("[camera]\n{}{simulation}", keys(&tables()[0], ""));
    let name = table.key();
    let own = keys(table, but) + line + "\n";
    match table.count {
        Count::Required => format!("[{name}]\n{own}"),
        Count::Once if name == "depth" => {
            format!("{camera}[image]\nwidth = 256\nheight = 256\n[depth]\n{own}")
        }
        Count::Once => format!("{camera}[{name}]\n{own}"),
        Count::Many => format!("{camera}[[{name}]]\n{own}"),
        Count::Inside | Count::ListInside => {
            let holds = |key: &Key| matches!(key.form, Form::Table(it) | Form::Tables(it) if it == table.name);
            let tables = tables();
            let mut hosts = tables.iter().filter(|host| host.keys().any(holds));
            let host = hosts.find(|host| host.name != "beam").unwrap(); // which has no arc
            let header = match table.count {
                Count::Inside => format!("[{}.{name}]", host.name),
                _ => format!("[[{}.{name}]]", host.name),
            };
            format!(
                "{camera}{}\n{}{header}\n{own}",
                host.header(),
                keys(host, name)
            )
        }
    }
}

/// Returns the names that serde says it expects.
fn expected(message: &str) -> BTreeSet<&str> {
    let (_, list) = message
        .split_once(", expected ")
        .unwrap_or_else(|| panic!("{message}"));
    list.split('`').skip(1).step_by(2).collect()
}

/// Returns what a table and serde do not both name.
fn differences(table: &Table) -> Vec<String> {
    let fault = raw_fault(&scene(table, "", "zzz = 1")).unwrap();
    let known: BTreeSet<&str> = table.keys().map(|key| key.name).collect();
    expected(&fault)
        .symmetric_difference(&known)
        .map(|name| format!("{}.{name}", table.name))
        .collect()
}

#[test]
fn every_table_has_the_keys_that_are_read() {
    for mut table in tables() {
        assert_eq!(differences(&table), Vec::<String>::new());
        assert_eq!(
            table
                .keys()
                .map(|key| key.name)
                .collect::<BTreeSet<_>>()
                .len(),
            table.keys().count()
        );
        // One less is told.
        let all = table.groups[0].keys;
        table.groups[0].keys = &all[1..];
        if !must_be_said(&all[0]) {
            assert_eq!(
                differences(&table),
                [format!("{}.{}", table.name, all[0].name)]
            );
        }
    }
    let fault = raw_fault(&("zzz = 1\n".to_owned() + &scene(&tables()[0], "", ""))).unwrap();
    let is_inside = |table: &Table| matches!(table.count, Count::Inside | Count::ListInside);
    let tables = tables();
    let known = tables
        .iter()
        .filter(|table| !is_inside(table))
        .map(|table| table.name);
    assert_eq!(expected(&fault), known.collect());
}

#[test]
fn required_is_what_cannot_be_left_out() {
    for table in tables() {
        let whole = scene(&table, "", "");
        assert_eq!(raw_fault(&whole), None, "{whole}");
        for key in table.keys().filter(|key| must_be_said(key)) {
            let fault = raw_fault(&scene(&table, key.name, ""));
            assert_eq!(fault, Some(format!("missing field `{}`", key.name)));
        }
    }
}

#[test]
fn a_default_says_what_holds_without_it() {
    let read =
        |text: &str| Scene::from_toml(text).unwrap_or_else(|fault| panic!("{fault}\n{text}"));
    let mut count = 0;
    for table in tables() {
        let placed = match table.name {
            "group" => "[[group.sphere]]\ncenter = [1, 0, 0]\n",
            "repeat" | "rotate" => "[[group.sphere]]\ncenter = [0, 0, 0]\n",
            _ => "",
        };
        let turned = if table.name == "repeat" {
            "axis = [0, 0, 1]"
        } else {
            ""
        };
        let without = read(&(scene(&table, "", turned) + placed));
        for key in table.keys() {
            if let Absent::Value(value) = key.absent {
                let line = format!("{turned}\n{} = {value}", key.name);
                let with = read(&(scene(&table, "", &line) + placed));
                assert!(with == without, "{}.{} = {value}", table.name, key.name);
                count += 1;
            }
        }
    }
    assert!(count > 40, "{count}");
    let camera = &tables()[0];
    assert!(read(&scene(camera, "", "fov_y = 46")) != read(&scene(camera, "", "")));
}

/// Values of every kind.
const VALUES: [&str; 16] = [
    "0.5",
    "3",
    "-2",
    "true",
    "\"zzz\"",
    "\"nan\"",
    "\"#ff8800\"",
    "[]",
    "[0, 1]",
    "[1, 2, 3]",
    "[1, 2, 3, 4]",
    "[\"#ff8800\", [1, 1, 1]]",
    "[[1, 2, 3], [1, 2, 3], [2, 2, 3]]",
    "[[1, 2], [1, 2, 3], [2, 2, 3]]",
    "{}",
    "[{ zzz = 1 }]",
];

/// Returns numbers that lie just beyond the bounds of a key, or on one that is excluded.
fn beyond(form: &Form) -> Vec<String> {
    match *form {
        Form::Number(least, most) => [(least, -1.0), (most, 1.0)]
            .into_iter()
            .map(|(bound, sign)| match bound {
                Bound::Included(0.0) => format!("{:e}", sign * 1e-9),
                Bound::Included(value) => format!("{:e}", value + sign * 1e-3 * f64::abs(value)),
                Bound::Excluded(value) => format!("{value:e}"),
                Bound::Unbounded => panic!("a number without a bound"),
            })
            .collect(),
        Form::Whole(least, most) => vec![
            (i64::from(least) - 1).to_string(),
            (i64::from(most) + 1).to_string(),
        ],
        Form::Word(words) => words.iter().map(|word| format!("\"{word}\"")).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn the_schema_takes_no_value_that_is_not_read_and_refuses_none_that_is() {
    let schema: Json = serde_json::from_str(&json_schema()).unwrap();
    let (mut taken, mut refused) = (0, 0);
    for table in tables() {
        for key in table.keys() {
            Scene::from_toml(&scene(&table, "", "")).unwrap();
            let own = [sample(key)];
            let values = VALUES.iter().map(|value| (*value).to_owned());
            for value in values.chain(own).chain(beyond(&key.form)) {
                let text = scene(&table, key.name, &format!("{} = {value}", key.name));
                let instance: Json = toml::from_str(&text).unwrap();
                match refusal(&schema, &instance) {
                    // What depends on other keys is not the schema's.
                    None => assert_eq!(raw_fault(&text), None, "{text}"),
                    // Of the values of a table serde also reads a list, in the order of its keys.
                    Some(_) if value.starts_with('[') && matches!(key.form, Form::Table(_)) => {}
                    Some(why) => assert!(Scene::from_toml(&text).is_err(), "{why}\n{text}"),
                }
                match refusal(&schema, &instance) {
                    None => taken += 1,
                    Some(_) => refused += 1,
                }
            }
            let text = scene(&table, key.name, &format!("{} = {}", key.name, sample(key)));
            assert_eq!(raw_fault(&text), None, "{text}");
            assert_eq!(
                refusal(&schema, &toml::from_str(&text).unwrap()),
                None,
                "{text}"
            );
        }
    }
    assert!(taken > 300 && refused > 1000, "{taken} {refused}");
}

#[test]
fn a_wrong_arc_is_refused_before_its_kinks_are_made() {
    let arc = table("arc").unwrap();
    for line in ["scale = 1e-10", "scale = -2", "scale = 0"] {
        let fault = Scene::from_toml(&scene(&arc, "scale", line))
            .unwrap_err()
            .to_string();
        assert!(fault.contains("arc.scale: "), "{fault}");
    }
}

#[test]
fn words_are_all_that_are_read() {
    for table in tables() {
        for key in table.keys() {
            if let Form::Word(words) = key.form {
                let text = scene(&table, key.name, &format!("{} = \"zzz\"", key.name));
                let fault = raw_fault(&text).unwrap_or_else(|| panic!("{text}"));
                assert_eq!(expected(&fault), words.iter().copied().collect(), "{text}");
            }
        }
    }
}

#[test]
fn the_schema_takes_every_scene_and_no_broken_one() {
    let schema: Json = serde_json::from_str(&json_schema()).unwrap();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let scenes = files.filter(|path| path.extension().is_some_and(|it| it == "toml"));
    let mut texts: Vec<String> = scenes
        .map(|path| fs::read_to_string(path).unwrap())
        .collect();
    texts.extend(Preset::ALL.iter().map(|preset| preset.text.to_owned()));
    assert!(texts.len() > 40);
    for text in &texts {
        let instance: Json = toml::from_str(text).unwrap();
        assert_eq!(refusal(&schema, &instance), None, "{text}");
        for (line, words) in [
            ("zzz = 1\n", ": unknown zzz"),
            ("sphere = { }\n", ".sphere: type \"array\""),
            ("sphere = [{ radius = 1, color = \"red\" }]\n", "anyOf"),
            ("group = [{ zoom = 2 }]\n", "group[0]: unknown zoom"),
        ] {
            let broken: Json = match toml::from_str(&(line.to_owned() + text)) {
                Ok(broken) => broken,
                Err(_) => continue, // the table is there already
            };
            let found = refusal(&schema, &broken).unwrap_or_default();
            assert!(found.contains(words), "{line}: {found}");
        }
        let mut blind = instance.clone();
        blind["camera"].as_object_mut().unwrap().remove("eye");
        let fault = refusal(&schema, &blind).unwrap();
        assert!(
            fault.starts_with(".camera: anyOf [{\"required\":[\"eye\""),
            "{fault}"
        );
    }
    let word: Json = serde_json::json!({ "profile": "cubic" });
    assert!(
        refusal_of_table(&schema, "layers", &word)
            .unwrap()
            .contains("layers.profile: enum")
    );
}

#[test]
fn the_documentation_of_scenes_names_every_key() {
    let text =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/scenes.md")).unwrap();
    for table in tables().into_iter().chain(track_tables()) {
        for key in table.keys() {
            let name = key.name;
            assert!(
                text.contains(&format!("`{name}")) || text.contains(&format!("[[{name}")),
                "{}.{}",
                table.name,
                key.name
            );
            let is_line = !key.help.contains('\n') && (5..90).contains(&key.help.len());
            assert!(is_line, "{}: {}", key.name, key.help);
        }
    }
}
