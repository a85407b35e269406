//! `energywave help`, `man` and `completions`.

use clap::{CommandFactory, Parser};
use energywave::{Error, nearest, shown};

use super::args::Arguments;
use super::subcommands::{CompletionsArguments, HelpArguments, ManArguments};
use super::{Failure, Outcome, print, scene_help};

/// The topic that is no subcommand.
const SCENE: &str = "scene";

pub fn run(arguments: &HelpArguments) -> Outcome {
    let topic: Vec<&str> = arguments.topic.iter().map(String::as_str).collect();
    match topic[..] {
        [] => as_option("--help"),
        [SCENE] => print(&scene_help::all()),
        [SCENE, table] => print(&scene_help::of(table)?),
        [name] => {
            command(Some(name))?;
            as_option(name)
        }
        [name, more, ..] => {
            command(Some(name))?;
            let message = format!(
                "{}: help {name} has no further topics; leave it out",
                shown(more)
            );
            Err(Error::Unsupported(message).into())
        }
    }
}

/// Prints the help of the program, or of a subcommand, as the option does.
fn as_option(name: &str) -> Outcome {
    match Arguments::try_parse_from(["energywave", name, "--help"]) {
        Err(help) => help.print().map_err(Failure::Stdout),
        Ok(_) => Ok(()), // the option always ends so
    }
}

pub fn manual(arguments: &ManArguments) -> Outcome {
    let page = clap_mangen::Man::new(command(arguments.subcommand.as_deref())?);
    let mut text = Vec::new();
    page.render(&mut text).map_err(Failure::Stdout)?;
    print(&String::from_utf8_lossy(&text))
}

pub fn completions(arguments: &CompletionsArguments) -> Outcome {
    let mut program = Arguments::command();
    let mut text = Vec::new(); // a reader who leaves early is no fault
    clap_complete::generate(arguments.shell, &mut program, "energywave", &mut text);
    print(&String::from_utf8_lossy(&text))
}

/// Returns the program, or one of its subcommands.
fn command(name: Option<&str>) -> Result<clap::Command, Error> {
    let mut program = Arguments::command();
    program.build();
    let Some(name) = name else {
        return Ok(program);
    };
    if let Some(found) = program.find_subcommand(name) {
        return Ok(found.clone());
    }
    let names: Vec<&str> = program
        .get_subcommands()
        .map(clap::Command::get_name)
        .chain([SCENE])
        .collect();
    Err(unknown("no such topic", name, &names))
}

/// Says that there is nothing of this name, what was likely meant, and what there is.
pub fn unknown(what: &str, name: &str, names: &[&str]) -> Error {
    let there_are = match nearest(&name.to_lowercase(), names.iter().copied()) {
        Some(nearest) => format!("did you mean {nearest}? There are"),
        None => "there are".to_owned(),
    };
    let (name, names) = (shown(name), names.join(", "));
    Error::Unsupported(format!("{name}: {what}; {there_are} {names}"))
}
