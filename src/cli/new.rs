//! `energywave new`: a preset to a scene file.

use std::fs;
use std::path::{Path, PathBuf};

use energywave::scene::Preset;
use energywave::{Error, nearest, shown};

use super::subcommands::NewArguments;
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
    let meant = match nearest(&name.to_lowercase(), names.iter().copied()) {
        Some(nearest) => format!(" did you mean {nearest}?"),
        None => String::new(),
    };
    Error::Unsupported(format!(
        "{}: no preset has this name;{meant} There are {}",
        shown(name),
        names.join(", ")
    ))
}
