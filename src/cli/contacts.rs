//! `energywave contacts`: where and when waves of particles hit something, for sound and other effects.

use std::path::Path;

use energywave::particle::{Contact, Simulation};
use energywave::{Error, Scene, TextFile};

use super::animate::Range;
use super::subcommands::ContactsArguments;
use super::{Failure, Outcome, note, open_scene, print, warn};

pub fn run(arguments: &ContactsArguments) -> Outcome {
    let path = arguments.output.as_path();
    let file = match path == Path::new("-") {
        true => None,
        false => Some(TextFile::create(path)?),
    };
    // What it warns of is about pictures.
    let (scene, _) = open_scene(&arguments.scene)?.into_frame(0.0, |_, _| Ok(()))?;
    let Range { first, last } = frames(arguments, &scene)?;
    let contacts = Simulation::new(&scene)?.contacts(first..=last)?;
    let text = json(&contacts).map_err(|error| Failure::Stdout(error.into()))?;
    match file {
        Some(file) => file.write(&text)?,
        None => print(&text)?,
    }
    if scene.waves.is_empty() || scene.colliders.is_empty() {
        warn("nothing can be hit: a scene needs a [[wave]] and a [[collider]] for that");
    }
    note(&format!(
        "contacts: {} in frames {first} to {last}",
        contacts.len()
    ));
    Ok(())
}

/// Returns the frames that were typed, else those until the one that the scene shows.
fn frames(arguments: &ContactsArguments, scene: &Scene) -> Result<Range, Error> {
    let shown = scene.simulation_settings().time.unwrap_or(0.0);
    match arguments.frames {
        Some(range) => Ok(range),
        None if shown > 0.0 => Ok(Range {
            first: 0,
            last: shown as u32,
        }),
        None => Err(Error::Unsupported(
            "--frames A..B is needed: the scene's [simulation] names no time, until which contacts would be told"
                .to_owned(),
        )),
    }
}

/// Writes a contact a line.
fn json(contacts: &[Contact]) -> serde_json::Result<String> {
    let lines: serde_json::Result<Vec<String>> =
        contacts.iter().map(serde_json::to_string).collect();
    let lines = lines?;
    Ok(match lines.is_empty() {
        true => "[]\n".to_owned(),
        false => format!("[\n{}\n]\n", lines.join(",\n")),
    })
}
