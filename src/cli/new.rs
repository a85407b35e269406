//! `energywave new`: a preset to a scene file.

use std::fs;
use std::path::{Path, PathBuf};

use energywave::scene::Preset;
use energywave::{Error, shown};

use super::args::NewArguments;
use super::{Outcome, note, print};

pub fn run(arguments: &NewArguments) -> Outcome {
    // Without a name there is --list.
    let Some(name) = &arguments.name else {
        return print(&list());
    };
    let preset = Preset::named(name).ok_or_else(|| unknown(name))?;
    let default = PathBuf::from(format!("{name}.toml"));
    let path = arguments.output.as_deref().unwrap_or(&default);
    if path == Path::new("-") {
        return print(preset.text);
    }
    // Pipes and devices are written through.
    if !arguments.force && fs::metadata(path).is_ok_and(|meta| meta.is_file()) {
        let reason = "it is there already; --force writes in its place, -o names another file";
        return Err(Error::output(path, reason).into());
    }
    preset.save(path)?;
    let file = shown(&path.to_string_lossy());
    note(&format!("wrote {file}; `energywave render` draws it"));
    Ok(())
}

/// Says in a line of each preset what it shows.
fn list() -> String {
    let longest = Preset::ALL.iter().map(|preset| preset.name.len()).max();
    let width = longest.unwrap_or_default();
    let line = |preset: &Preset| format!("{:width$}  {}\n", preset.name, preset.about());
    Preset::ALL.iter().map(line).collect()
}

/// Says which presets there are, and which one was likely meant.
fn unknown(name: &str) -> Error {
    let names: Vec<&str> = Preset::ALL.iter().map(|preset| preset.name).collect();
    let edits = |other: &str| (edits(&name.to_lowercase(), other), other.len());
    let nearest = names.iter().min_by_key(|other| edits(other));
    let meant = match nearest {
        Some(nearest) if edits(nearest).0 <= nearest.len() / 2 => {
            format!(" did you mean {nearest}?")
        }
        _ => String::new(),
    };
    Error::Unsupported(format!(
        "{}: no preset has this name;{meant} There are {}",
        shown(name),
        names.join(", ")
    ))
}

/// Returns how many letters must be put in, left out or changed to make one word of another (Levenshtein 1966).
fn edits(one: &str, other: &str) -> usize {
    let other: Vec<char> = other.chars().collect();
    let mut row: Vec<usize> = (0..=other.len()).collect();
    for (i, letter) in one.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, expected) in other.iter().enumerate() {
            let changed = diagonal + usize::from(letter != *expected);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j].min(diagonal) + 1);
        }
    }
    row[other.len()]
}

#[cfg(test)]
mod tests {
    use super::edits;

    #[test]
    fn edits_are_counted() {
        let found = [
            ("laser", "laser"),
            ("lazer", "laser"),
            ("", "nova"),
            ("portals", "portal"),
            ("amgic", "magic"),
        ]
        .map(|(one, other)| edits(one, other));
        assert_eq!(found, [0, 1, 4, 1, 2]);
    }
}
