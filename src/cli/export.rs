//! `energywave export`: a scene as a shader.

use std::path::Path;

use energywave::TextFile;
use energywave::shader::{Entry, Language, Shader, export};
use serde::Serialize;

use super::subcommands::{EntryName, ExportArguments, LanguageName};
use super::{Outcome, note, open_scene, print, shown, warn};

pub fn run(arguments: &ExportArguments) -> Outcome {
    let scene = open_scene(&arguments.scene)?;
    let time = arguments.time.unwrap_or(0.0);
    let language = match arguments.language {
        LanguageName::Wgsl => Language::Wgsl,
        LanguageName::Glsl => Language::Glsl,
        LanguageName::Hlsl => Language::Hlsl,
        LanguageName::Shadertoy => Language::Shadertoy,
    };
    let entry = match arguments.entry {
        EntryName::Function => Entry::Function,
        EntryName::Image => Entry::Image,
        EntryName::Irradiance => Entry::Irradiance,
    };
    let uniforms = arguments.uniforms.as_ref().map(TextFile::create);
    let uniforms = uniforms.transpose()?;
    let text = match arguments.output == Path::new("-") {
        true => None,
        false => Some(TextFile::create(&arguments.output)?),
    };
    let ((shader, bytes, has_depths), _) = scene.made_at(time, |scene| {
        let shader = export(scene, language, entry)?;
        let bytes = shader.uniforms(scene)?;
        Ok((shader, bytes, scene.depth.is_some()))
    })?;
    if has_depths {
        warn("the shader has no depths: whoever calls it gives the depth at which a ray ends");
    }
    if let (Some(file), Some(path)) = (uniforms, &arguments.uniforms) {
        match path
            .extension()
            .is_some_and(|it| it.eq_ignore_ascii_case("json"))
        {
            true => file.write(&block_in_json(&shader, &bytes, language, time))?,
            false => file.write_bytes(&bytes)?,
        }
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

/// A field of the block.
#[derive(Serialize)]
struct Field<'a> {
    name: &'a str,
    offset: usize,
    values: [f32; 4],
}

/// Returns the block as an engine reads it that looks for names: a line for each field.
fn block_in_json(shader: &Shader, bytes: &[u8], language: Language, time: f64) -> String {
    let number = |offset: usize| {
        let of_value = bytes.get(offset..offset + 4).unwrap_or_default();
        of_value.try_into().map_or(f32::NAN, f32::from_le_bytes)
    };
    let fields = shader.fields().iter().map(|field| Field {
        name: &field.name,
        offset: field.offset,
        values: [0, 4, 8, 12].map(|k| number(field.offset + k)),
    });
    let lines: Vec<String> = fields
        .map(|field| serde_json::to_string(&field).unwrap_or_default())
        .collect();
    let block = match language {
        Language::Glsl => "WaveBlock",
        _ => "wave",
    };
    format!(
        "{{\n\"block\": \"{block}\", \"time\": {time:?}, \"bytes\": {}, \"fields\": [\n{}\n]\n}}\n",
        bytes.len(),
        lines.join(",\n")
    )
}
