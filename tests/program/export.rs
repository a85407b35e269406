//! Draws exported shaders by OpenGL, beside the reference.

use std::fs;
use std::path::Path;
use std::process::Command;

use energywave::scene::Method;
use energywave::shader::{Entry, Language, export};
use energywave::{Device, Ray, Renderer, Scene};

use crate::common::program::Folder;
use crate::export_scenes::{mapped_scenes, scenes};

/// What float32 without further digits, and a driver's own logarithms, are off by: of the pixel's brightest channel.
const MOST_OFF: f64 = 1e-4;

/// The same on cores without thickness: beside them, float32 places lose digits that kernels carry along.
const MOST_OFF_BESIDE_BARE_CORES: f64 = 2e-3;

/// What the nodes of rings and curves leave, of the pixel's brightest channel.
const MOST_OFF_BY_NODES: f64 = 1e-2;

/// What is left of light and thickness that change along a core.
const MOST_OFF_ALONG: f64 = 3e-2;

/// Draws a text by OpenGL; `None` where there is no OpenGL.
pub fn drawn(folder: &Path, text: &str, uniforms: &[u8], width: u32) -> Option<Vec<f32>> {
    all_drawn(folder, &[(text.to_owned(), uniforms.to_vec(), width)])?.pop()
}

/// Draws texts with their blocks, so many pixels wide and high; a process for all takes half the time.
fn all_drawn(folder: &Path, texts: &[(String, Vec<u8>, u32)]) -> Option<Vec<Vec<f32>>> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/draw_shader.py");
    let mut command = Command::new("/usr/bin/python3");
    command.arg(script);
    let place = |number: usize, end: &str| folder.join(format!("{number}.{end}"));
    for (number, (text, uniforms, width)) in texts.iter().enumerate() {
        let files = ["frag", "bin", "raw"].map(|end| place(number, end));
        // Places of pixels are exact so; those that are handed from corner to corner lose digits.
        let pixel = format!("#define _vs2fs_location0 (gl_FragCoord.xy / {width}.0)");
        let text = text.replace("smooth in vec2 _vs2fs_location0;", &pixel);
        fs::write(&files[0], text).unwrap();
        fs::write(&files[1], uniforms).unwrap();
        command.args(&files).arg(width.to_string());
    }
    let output = command.output().ok()?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    if !said.contains("drawn: ") {
        println!("{said}{}", String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success(), "OpenGL refuses the text");
        let must = std::env::var_os("REQUIRE_SHADER_DRAWING").is_some();
        assert!(!must, "no OpenGL");
        return None;
    }
    let read = |number: usize| {
        let bytes = fs::read(place(number, "raw")).unwrap();
        let floats = bytes.chunks_exact(4);
        floats
            .map(|it| f32::from_le_bytes(it.try_into().unwrap()))
            .collect()
    };
    Some((0..texts.len()).map(read).collect())
}

/// Draws scenes by their exports, and some by texts that `spoil` has spoiled, which must be off by more than the `most`
/// of their name.
fn compare(
    scenes: Vec<(String, Scene)>,
    spoil: impl Fn(&str) -> String,
    most: impl Fn(&str) -> f64,
) {
    let folder = Folder::new();
    let mut texts = Vec::new();
    let mut names = Vec::new();
    for (number, (name, scene)) in scenes.iter().enumerate() {
        let shader = export(scene, Language::Glsl, Entry::Image).unwrap();
        let uniforms = shader.uniforms(scene).unwrap();
        if number.is_multiple_of(SPOILED) {
            let spoiled = spoil(&shader.text);
            assert_ne!(spoiled, shader.text);
            texts.push((spoiled, uniforms.clone(), scene.image.width));
            names.push((number, name, true));
        }
        texts.push((shader.text, uniforms, scene.image.width));
        names.push((number, name, false));
    }
    let Some(all_found) = all_drawn(folder.path(), &texts) else {
        return println!("skipped: no OpenGL");
    };
    let expected: Vec<_> = scenes.iter().map(|(_, scene)| expected(scene)).collect();
    for ((number, name, is_spoiled), found) in names.into_iter().zip(all_found) {
        let off = error(&found, &expected[number]);
        println!("{name}: {off:.1e}, spoiled: {is_spoiled}");
        let is_near = off <= most(name);
        assert_ne!(is_near, is_spoiled, "{name}: {off:e}");
    }
}

/// Where light ends, a window is a small difference: pixels are not asked for more digits than those with this share of
/// the brightest one.
const LEAST_SHARE: f64 = 1e-3;

/// Every so many pixels are compared: the reference takes its time.
const STRIDE: usize = 211;

/// Every so many texts are spoiled, too.
const SPOILED: usize = 4;

/// Returns the light of every so many pixels by the reference.
fn expected(scene: &Scene) -> Vec<[f64; 3]> {
    let plane = scene.view_plane();
    let width = scene.image.width;
    let pixels = (0..width * width).step_by(STRIDE);
    let rays: Vec<Ray> = pixels.map(|it| plane.ray(it % width, it / width)).collect();
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    let mut scene = scene.clone();
    scene.integration.method = Method::default();
    reference.integrate(&scene, &rays).unwrap()
}

/// Returns the greatest error of a picture, relative to the brightest channel of each pixel.
fn error(found: &[f32], expected: &[[f64; 3]]) -> f64 {
    let brightest = expected
        .iter()
        .flatten()
        .fold(0.0_f64, |most, it| most.max(*it));
    let pixels = found.chunks_exact(3).step_by(STRIDE).zip(expected);
    let errors = pixels.map(|(found, expected)| {
        let channels = found.iter().zip(expected);
        let off = channels
            .map(|(a, b)| (f64::from(*a) - b).abs())
            .fold(0.0, f64::max);
        let most = expected
            .iter()
            .fold(LEAST_SHARE * brightest, |most, it| most.max(it.abs()));
        if found.iter().any(|it| it.is_nan()) {
            f64::INFINITY
        } else {
            off / most.max(1e-30)
        }
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn opengl_draws_an_exported_scene_as_the_reference_does() {
    let scenes = scenes();
    assert!(scenes.len() >= 20);
    let spoil = |text: &str| {
        text.replace("atan(", "1.01 * atan(")
            .replace("0.5 * log(", "0.505 * log(")
            .replace("0.1894506", "0.1994506")
    };
    compare(scenes, spoil, |name| match name.ends_with(" None 0") {
        true => MOST_OFF_BESIDE_BARE_CORES,
        false => MOST_OFF,
    });
}

#[test]
fn opengl_draws_rings_curves_and_paths_within_what_is_stated_of_them() {
    let spoil = |text: &str| {
        text.replace("atan(", "1.1 * atan(")
            .replace("0.5 * log(", "0.55 * log(")
            .replace("0.1894506", "0.2894506")
    };
    compare(mapped_scenes(), spoil, |name| match name {
        "along" | "dashes" => MOST_OFF_ALONG,
        _ => MOST_OFF_BY_NODES,
    });
}

#[test]
fn every_language_has_every_scene_with_comments_and_short() {
    for (name, scene) in scenes()
        .into_iter()
        .chain(mapped_scenes().into_iter().step_by(3))
    {
        for language in [Language::Wgsl, Language::Glsl, Language::Hlsl] {
            for entry in [Entry::Function, Entry::Image] {
                // What is translated is validated before.
                let text = export(&scene, language, entry).unwrap().text;
                assert!(text.contains("wave_light("), "{name}");
                assert!(text.contains("// Returns the light along a ray"), "{name}");
                assert!(text.contains("MIT OR Apache-2.0"), "{name}");
                let has_stage = text.contains("void main") || text.contains(" image(");
                assert_eq!(has_stage, entry == Entry::Image, "{name} {language:?}");
                let count = text.lines().count();
                let kinds = [
                    "sphere", "cylinder", "segment", "beam", "torus", "curve", "path",
                ];
                let kinds = kinds
                    .iter()
                    .filter(|it| text.contains(&format!("fn {it}_light(")));
                // One kind is short, whatever its form, but for paths; several are the longer.
                let is_path = text.contains("fn path_light(");
                let most = if kinds.count() == 1 && !is_path {
                    300
                } else {
                    600
                };
                let is_short = language != Language::Wgsl || count < most;
                if entry == Entry::Image && language == Language::Wgsl {
                    println!("{name}: {count} lines");
                }
                assert!(is_short, "{name}: {count} lines");
            }
        }
    }
}
