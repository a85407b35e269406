//! `energywave help scene`: all keys of scene files.

use std::ops::Bound;

use energywave::Error;
use energywave::scene::keys::{
    Absent, Count, Form, Key, KeyGroup, Table, table, tables, track_tables,
};

use super::help::unknown;

/// Where columns end, and lines.
const NAME: usize = 20;
const ABSENT: usize = 18;
const LINE: usize = 100;

/// Describes all tables, keys that several have only once.
pub fn all() -> String {
    let mut text = "\
A scene file is TOML, or JSON of the same structure. Its tables with their keys, what holds where
a key is left out, and what it is; `energywave help scene torus` shows one table with all its keys.
Vectors are three numbers in a right-handed world, lengths in world units.
In the place of any number, vector, colour or list of such a track may stand, its value over time:
  radius = { times = [0, 2], values = [0.1, 0.5] }; `energywave render SCENE -o FILE --time 1`
  radius = { value = 0.3, noise = { amplitude = 0.1, frequency = 5 } }
"
    .to_owned();
    let mut told: Vec<KeyGroup> = Vec::new();
    for table in tables().into_iter().chain(track_tables()) {
        let is_new = |group: &&KeyGroup| group.of.is_empty() || !told.contains(group);
        let groups: Vec<KeyGroup> = table.groups.iter().filter(is_new).copied().collect();
        let others = table.groups.iter().filter(|group| !groups.contains(group));
        let others: Vec<&str> = others.map(|group| group.of).collect();
        text += &head(&table);
        text += &groups.iter().map(keys).collect::<String>();
        if !others.is_empty() {
            text += &format!("  and the keys of {}\n", others.join(" and of "));
        }
        told.extend(groups);
    }
    text
}

/// Describes one table.
pub fn of(name: &str) -> Result<String, Error> {
    let bare = name.trim_matches(['[', ']']);
    let Some(table) = table(bare) else {
        let tables: Vec<Table> = tables().into_iter().chain(track_tables()).collect();
        let names: Vec<&str> = tables.iter().map(|table| table.name).collect();
        return Err(unknown("no table of a scene file", name, &names));
    };
    let keys: String = table.groups.iter().map(keys).collect();
    Ok(head(&table).trim_start().to_owned() + &keys)
}

fn head(table: &Table) -> String {
    let needed = match table.count {
        Count::Required => " (required)",
        _ => "",
    };
    format!("\n{}  {}{needed}\n", table.header(), table.about)
}

fn keys(group: &KeyGroup) -> String {
    let head = match group.of {
        "" => String::new(),
        of => format!("  {of}:\n"),
    };
    head + &group.keys.iter().map(line).collect::<String>()
}

/// Describes a key, on one line or more.
fn line(key: &Key) -> String {
    let absent = match key.absent {
        Absent::Required | Absent::RequiredWithout(_) => "required",
        Absent::Value(text) | Absent::Otherwise(text) => text,
        _ => "",
    };
    let kind = match (key.unit, form(&key.form)) {
        ("", form) => form,
        (unit, form) => match form.trim_start_matches("number").trim_start_matches(", ") {
            "" => unit.to_owned(),
            form => format!("{unit}, {form}"),
        },
    };
    let absent = format!("{absent} "); // some are longer than the column
    let mut text = format!("  {:NAME$}{absent:ABSENT$}", key.name);
    let mut column = text.chars().count();
    for word in format!("{} ({kind})", key.help).split(' ') {
        let length = word.chars().count();
        if column + length > LINE {
            text = text.trim_end().to_owned() + "\n" + &" ".repeat(2 + NAME + ABSENT);
            column = 2 + NAME + ABSENT;
        }
        text += word;
        text.push(' ');
        column += length + 1;
    }
    text.trim_end().to_owned() + "\n"
}

/// Says what a value may be.
fn form(form: &Form) -> String {
    let counted = |least: u32, most: Option<u32>, what: &str| match most {
        Some(most) if most == least => format!("{least} {what}"),
        Some(most) => format!("{least} to {most} {what}"),
        None => format!("at least {least} {what}"),
    };
    match *form {
        Form::Number(least, most) => number(least, most),
        Form::Whole(0, u32::MAX) => "whole number, 0 or more".to_owned(),
        Form::Whole(least, most) => format!("whole number, {least} to {most}"),
        Form::NumberOr(least, most, word) => format!("{least} to {most}, or \"{word}\""),
        Form::ColorOrFile => "3 numbers, \"#rrggbb\" or a file".to_owned(),
        Form::Matrix => "16 numbers by rows".to_owned(),
        Form::NumberOrNan => "number or \"nan\"".to_owned(),
        Form::Flag => "true or false".to_owned(),
        Form::Text => "text".to_owned(),
        Form::File => "name of a file".to_owned(),
        Form::Word(words) => format!("\"{}\"", words.join("\", \"")),
        Form::Color => "3 numbers or \"#rrggbb\"".to_owned(),
        Form::Numbers(3, Some(3)) => "vector".to_owned(),
        Form::Numbers(least, most) => counted(least, most, "numbers"),
        Form::Vectors(least, most) => counted(least, most, "vectors"),
        Form::Colors(least) => counted(least, None, "colours"),
        Form::TrackValue => "number, or list".to_owned(),
        Form::TrackValues(least) => counted(least, None, "numbers or lists"),
        Form::Table(name) => format!("table: help scene {name}"),
        Form::Tables(name) => format!("list of tables: help scene {name}"),
        _ => String::new(),
    }
}

/// Says between which numbers one lies; what every number of a scene keeps to is not said.
fn number(least: Bound<f64>, most: Bound<f64>) -> String {
    const LARGEST: f64 = 1e9;
    const SMALLEST: f64 = 1e-9;
    let plain = |value: f64| match value != 0.0 && value.abs() < 1e-3 {
        true => format!("{value:e}"),
        false => value.to_string(),
    };
    match (least, most) {
        (Bound::Included(least), Bound::Included(LARGEST)) => match least {
            SMALLEST => "number, positive".to_owned(),
            0.0 => "number, 0 or more".to_owned(),
            _ => "number".to_owned(),
        },
        (Bound::Included(least), Bound::Included(most)) => {
            format!("number, {} to {}", plain(least), plain(most))
        }
        (Bound::Included(least), Bound::Excluded(most)) => {
            format!("number, {} to below {}", plain(least), plain(most))
        }
        (Bound::Excluded(least), Bound::Excluded(most)) => {
            format!(
                "number, more than {} and less than {}",
                plain(least),
                plain(most)
            )
        }
        _ => "number".to_owned(),
    }
}
