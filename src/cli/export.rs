//! `energywave export`: a scene as a shader.

use std::path::Path;

use energywave::TextFile;
use energywave::shader::{Entry, Language, export};

use super::subcommands::{EntryName, ExportArguments, LanguageName};
use super::{Outcome, note, open_scene, print, shown, warn};

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
    let uniforms = arguments.uniforms.as_ref().map(TextFile::create);
    let uniforms = uniforms.transpose()?;
    let text = match arguments.output == Path::new("-") {
        true => None,
        false => Some(TextFile::create(&arguments.output)?),
    };
    let shader = export(&scene, language, entry)?;
    if scene.depth.is_some() {
        warn("the shader has no depths: whoever calls it gives the depth at which a ray ends");
    }
    if let Some(file) = uniforms {
        file.write_bytes(&shader.uniforms(&scene)?)?;
    }
    let Some(text) = text else {
        return print(&shader.text);
    };
    text.write(&shader.text)?;
    let file = shown(&arguments.output.to_string_lossy());
    note(&format!(
        "wrote {file}: {} lines",
        shader.text.lines().count()
    ));
    Ok(())
}
