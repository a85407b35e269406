//! JSON Schema of scene files (draft 2020-12), by which editors complete and check them, TOML as JSON.

use std::ops::Bound;

use serde_json::{Map, Value, json};

use super::{Absent, Count, Form, Key, Table, tables, track_tables};

/// Returns the JSON Schema of scene files, draft 2020-12. What it refuses the reader refuses; what depends on several
/// keys, such as a `peak` that needs a radius, only the reader knows.
#[must_use]
pub fn json_schema() -> String {
    let tables = tables();
    let mut properties = Map::new();
    let mut required = Vec::new();
    for table in &tables {
        let described = |mut schema: Value| {
            schema["description"] = table.about.as_str().into();
            schema
        };
        let schema = match table.count {
            Count::Once if table.name == "lighting" => {
                let short = json!({ "type": "boolean" });
                described(json!({ "anyOf": [reference(table.name), short] }))
            }
            Count::Required | Count::Once => described(reference(table.name)),
            Count::Many => described(list_of(reference(table.name), 0, None)),
            Count::Inside | Count::ListInside => continue,
        };
        if table.count == Count::Required {
            required.push(table.name);
        }
        properties.insert(table.name.to_owned(), schema);
    }
    let mut definitions: Map<String, Value> = tables
        .iter()
        .map(|table| {
            (
                table.name.to_owned(),
                definition(table, table.name != "time"),
            )
        })
        .collect();
    let of_tracks = track_tables();
    let of_tracks = of_tracks.iter();
    definitions.extend(of_tracks.map(|table| (table.name.to_owned(), definition(table, false))));
    definitions["track"]["anyOf"] =
        json!([{ "required": ["times", "values"] }, { "required": ["value", "noise"] }]);
    let items = list_of(reference("track_value"), 1, None);
    let value = json!({ "anyOf": [{ "type": "number" }, hexadecimal(), items] });
    definitions.insert("track_value".to_owned(), value);
    let schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A scene of energywave",
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
        "$defs": definitions,
    });
    format!("{schema:#}")
}

fn reference(table: &str) -> Value {
    json!({ "$ref": format!("#/$defs/{table}") })
}

/// Returns what a table is; in some, tracks may stand in the place of values.
fn definition(table: &Table, may_move: bool) -> Value {
    let properties: Map<String, Value> = table
        .keys()
        .map(|key| (key.name.to_owned(), property(key, may_move)))
        .collect();
    let required: Vec<&str> = table
        .keys()
        .filter(|key| key.absent == Absent::Required)
        .map(|key| key.name)
        .collect();
    let mut schema = json!({
        "description": table.about,
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    if let Some(choices) = choices(table) {
        schema["anyOf"] = choices;
    }
    schema
}

/// Returns what must be there of keys that another one replaces.
fn choices(table: &Table) -> Option<Value> {
    let replaced = table.keys().filter_map(|key| match key.absent {
        Absent::RequiredWithout(other) => Some((key.name, other)),
        _ => None,
    });
    let (keys, others): (Vec<_>, Vec<_>) = replaced.unzip();
    let other = others.first()?;
    Some(json!([{ "required": keys }, { "required": [other] }]))
}

fn property(key: &Key, may_move: bool) -> Value {
    let may_move = may_move && key.form.may_be_track();
    let mut schema = or_track(form(&key.form, may_move), may_move);
    let mut description = key.help.to_owned();
    if !key.unit.is_empty() {
        description += &format!(" ({})", key.unit);
    }
    match key.absent {
        Absent::Required => {}
        Absent::RequiredWithout(other) => description += &format!("; required without {other}"),
        Absent::Otherwise(words) => description += &format!("; without it: {words}"),
        Absent::Value(text) => {
            if let Some(value) = value_of(text) {
                schema["default"] = value;
            }
        }
    }
    schema["description"] = description.into();
    schema
}

/// Returns a value that TOML and JSON write alike.
fn value_of(text: &str) -> Option<Value> {
    serde_json::from_str(text).ok()
}

/// Adds a track to what a value may be.
fn or_track(schema: Value, may_move: bool) -> Value {
    match may_move {
        true => json!({ "anyOf": [schema, reference("track")] }),
        false => schema,
    }
}

fn hexadecimal() -> Value {
    json!({ "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" })
}

/// Returns what a value may be; of some lists, the items may be tracks.
fn form(form: &Form, may_move: bool) -> Value {
    let number = || json!({ "type": "number" });
    let item = |schema| or_track(schema, may_move);
    let numbers = |least, most| list_of(item(number()), least, most);
    let vector = || numbers(3, Some(3));
    let color = || json!({ "anyOf": [vector(), hexadecimal()] });
    match *form {
        Form::Number(least, most) => {
            let mut schema = number();
            let bounds = [
                (least, "minimum", "exclusiveMinimum"),
                (most, "maximum", "exclusiveMaximum"),
            ];
            for (bound, included, excluded) in bounds {
                match bound {
                    Bound::Included(value) => schema[included] = value.into(),
                    Bound::Excluded(value) => schema[excluded] = value.into(),
                    Bound::Unbounded => {}
                }
            }
            schema
        }
        Form::Whole(least, most) => {
            json!({ "type": "integer", "minimum": least, "maximum": most })
        }
        Form::NumberOr(least, most, word) => {
            let bounded = json!({ "type": "number", "minimum": least, "maximum": most });
            json!({ "anyOf": [bounded, { "const": word }] })
        }
        Form::ColorOrFile => json!({ "anyOf": [vector(), { "type": "string" }] }),
        Form::Matrix => {
            let row = item(numbers(4, Some(4)));
            json!({ "anyOf": [numbers(16, Some(16)), list_of(row, 4, Some(4))] })
        }
        Form::NumberOrNan => json!({ "anyOf": [number(), { "const": "nan" }] }),
        Form::Flag => json!({ "type": "boolean" }),
        Form::Text | Form::File => json!({ "type": "string" }),
        Form::Word(words) => json!({ "enum": words }),
        Form::Color => color(),
        Form::Numbers(least, most) => numbers(least, most),
        Form::Vectors(least, most) => list_of(item(vector()), least, most),
        Form::Colors(least) => list_of(item(color()), least, None),
        Form::TrackValue => reference("track_value"),
        Form::TrackValues(least) => list_of(reference("track_value"), least, None),
        Form::Table(name) => reference(name),
        Form::Tables("layers") => list_of(reference("layers"), 1, Some(16)),
        Form::Tables(name) => list_of(reference(name), 0, None),
    }
}

fn list_of(item: Value, least: u32, most: Option<u32>) -> Value {
    let mut schema = json!({ "type": "array", "items": item, "minItems": least });
    if let Some(most) = most {
        schema["maxItems"] = most.into();
    }
    schema
}
