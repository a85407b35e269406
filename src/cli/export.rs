//! `energywave export`: a scene as a shader.

use std::path::Path;

use energywave::TextFile;
use energywave::shader::{Entry, Language, export};

use super::subcommands::{EntryName, ExportArguments, LanguageName};
use super::{Outcome, note, open_scene, print, shown};

pub fn run(arguments: &ExportArguments) -> Outcome {
    let (scene, _) = open_scene(&arguments.scene)?
        .at_with_warnings(arguments.time.unwrap_or(0.0), |_, _| Ok(()))?;
    let language = match arguments.language {
        LanguageName::Wgsl => Language::Wgsl,
        LanguageName::Glsl => Language::Glsl,
        LanguageName::Hlsl => Language::Hlsl,
    };
    let entry = match arguments.entry {
        EntryName::Function => Entry::Function,
        EntryName::Image => Entry::Image,
    };
    let shader = export(&scene, language, entry)?;
    if let Some(path) = &arguments.uniforms {
        TextFile::create(path)?.write_bytes(&shader.uniforms(&scene)?)?;
    }
    if arguments.output == Path::new("-") {
        return print(&shader.text);
    }
    TextFile::create(&arguments.output)?.write(&shader.text)?;
    let file = shown(&arguments.output.to_string_lossy());
    note(&format!(
        "wrote {file}: {} lines",
        shader.text.lines().count()
    ));
    Ok(())
}
