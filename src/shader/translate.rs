//! WGSL to GLSL 3.30 and ES 3.00, and HLSL 5.1, by `naga`, which drops comments: those before functions are put back.

use naga::back::{glsl, hlsl};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};

use super::text::LICENCE;
use super::{Entry, Language};
use crate::error::{Error, Result};

const MAIN_IMAGE: &str = include_str!("../../wgsl/shadertoy.glsl");

/// A stage that makes GLSL write all functions, where the text has none.
const STAGE: &str = "\n@fragment\nfn image(@location(0) uv: vec2f) -> @location(0) vec4f {\n    \
                     return vec4f(wave_light(vec3f(uv, 0.0), vec3f(0.0, 0.0, 1.0), 1.0), 1.0);\n}\n";

/// Translates a text that [`super::export`] has made.
pub(super) fn translate(wgsl: &str, language: Language, entry: Entry) -> Result<String> {
    let source = match entry {
        Entry::Function => format!("{wgsl}{STAGE}"),
        Entry::Irradiance => {
            let light = "wave_light(vec3f(uv, 0.0), vec3f(0.0, 0.0, 1.0), 1.0)";
            let call = "wave_irradiance(vec3f(uv, 0.0), vec3f(0.0, 0.0, 1.0))";
            format!("{wgsl}{}", STAGE.replace(light, call))
        }
        Entry::Image => wgsl.to_owned(),
    };
    let (module, info) = parsed(&source)?;
    let translated = match language {
        Language::Hlsl => to_hlsl(&module, &info)?,
        _ => to_glsl(&module, &info, glsl::Version::Desktop(330))?,
    };
    let whole = match entry {
        Entry::Image => translated.as_str(),
        Entry::Function | Entry::Irradiance => without_stage(&translated, language),
    };
    Ok(with_comments(whole, wgsl, language))
}

/// Translates a text that is only a function, with the values of its block as a constant.
pub(super) fn to_shadertoy(wgsl: &str, constant: &str) -> Result<String> {
    let (module, info) = parsed(&format!("{wgsl}{STAGE}"))?;
    let version = glsl::Version::Embedded {
        version: 300,
        is_webgl: true,
    };
    let text = to_glsl(&module, &info, version)?;
    let text = without_stage(&text, Language::Shadertoy);
    // What the stage needs, and the block.
    let dropped = ["#version", "precision", "smooth in", "layout("];
    let kept = text
        .lines()
        .skip_while(|line| line.is_empty())
        .filter(|line| !dropped.iter().any(|begin| line.starts_with(begin)));
    let mut whole = String::new();
    let mut is_before_functions = true;
    for line in kept {
        let is_function = line.ends_with('{') && line.contains('(');
        if is_before_functions && is_function {
            whole += &format!("{constant}\n");
            is_before_functions = false;
        }
        whole += &format!("{line}\n");
    }
    let whole = with_comments(&whole, wgsl, Language::Shadertoy);
    Ok(format!("{}\n{MAIN_IMAGE}", whole.trim_end()))
}

/// Parses and validates a text.
fn parsed(wgsl: &str) -> Result<(Module, ModuleInfo)> {
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|fault| failed(&fault))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator
        .validate(&module)
        .map_err(|fault| failed(&fault))?;
    Ok((module, info))
}

fn to_glsl(module: &Module, info: &ModuleInfo, version: glsl::Version) -> Result<String> {
    let options = glsl::Options {
        version,
        writer_flags: glsl::WriterFlags::empty(),
        ..Default::default()
    };
    let pipeline = glsl::PipelineOptions {
        shader_stage: ShaderStage::Fragment,
        entry_point: "image".to_owned(),
        multiview: None,
    };
    let mut text = String::new();
    let policies = Default::default();
    glsl::Writer::new(&mut text, module, info, &options, &pipeline, policies)
        .and_then(|mut writer| writer.write())
        .map_err(|fault| failed(&fault))?;
    Ok(text
        .replace("_group_0_binding_0_fs", "wave")
        .replace("Wave_block_0Fragment", "WaveBlock"))
}

fn to_hlsl(module: &Module, info: &ModuleInfo) -> Result<String> {
    let options = hlsl::Options {
        fake_missing_bindings: true,
        ..Default::default()
    };
    let pipeline = hlsl::PipelineOptions::default();
    let mut text = String::new();
    hlsl::Writer::new(&mut text, &options, &pipeline)
        .write(module, info, None)
        .map_err(|fault| failed(&fault))?;
    Ok(with_plain_arrays(&text))
}

/// Writes constant arrays as lists: some compilers take the functions that `naga` makes for them for recursive ones.
fn with_plain_arrays(text: &str) -> String {
    const MAKER: &str = "Constructarray8_float_(";
    let mut whole = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if line.starts_with("typedef float ret_Constructarray8") {
            let _ = lines.by_ref().take_while(|line| !line.is_empty()).count();
            continue;
        }
        match line.split_once(MAKER) {
            Some((begin, values)) => {
                whole += &format!("{begin}{{ {} }};\n", values.trim_end_matches(");"));
            }
            None => whole += &format!("{line}\n"),
        }
    }
    whole
}

/// Cuts the stage off that made the translator write all functions.
fn without_stage(text: &str, language: Language) -> &str {
    let begin = match language {
        Language::Hlsl => text.find("float4 image("),
        _ => text.find("void main()"),
    };
    begin.map_or(text, |begin| text[..begin].trim_end())
}

/// Puts the comments before functions of the original before those of the translation, after the licence.
fn with_comments(text: &str, wgsl: &str, language: Language) -> String {
    let lines: Vec<&str> = wgsl.lines().collect();
    let comment_of = |name: &str| -> String {
        let begins = format!("fn {name}(");
        let Some(at) = lines.iter().position(|line| line.starts_with(&begins)) else {
            return String::new();
        };
        let above = lines[..at]
            .iter()
            .rev()
            .take_while(|line| line.starts_with("//"));
        let above: Vec<&&str> = above.collect();
        above.iter().rev().map(|line| format!("{line}\n")).collect()
    };
    let mut whole = String::new();
    let head = format!(
        "{LICENCE}// Translated from WGSL: `--to wgsl` has the formulas, and the offset of every field of the block.\n"
    );
    let version = text
        .lines()
        .next()
        .filter(|line| line.starts_with("#version"));
    let rest = version.map_or(text, |line| &text[line.len()..]);
    if language == Language::Glsl {
        whole += &version.map_or(String::new(), |line| format!("{line}\n"));
    }
    whole += &head;
    for line in rest.lines() {
        let is_function =
            line.ends_with(['{', ')']) && line.contains('(') && !line.starts_with([' ', '#', '/']);
        if is_function {
            let name = line
                .split('(')
                .next()
                .and_then(|it| it.split(' ').next_back());
            whole += &comment_of(name.unwrap_or_default());
        }
        whole += line;
        whole.push('\n');
    }
    whole
}

/// Says what the translator says.
fn failed(fault: &dyn std::fmt::Display) -> Error {
    Error::Unsupported(format!(
        "the shader cannot be translated: {fault}; use WGSL"
    ))
}
