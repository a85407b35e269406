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

/// Draws a text by OpenGL; `None` where there is no OpenGL.
pub fn drawn(folder: &Path, text: &str, uniforms: &[u8], width: u32) -> Option<Vec<f32>> {
    let files = ["shader.frag", "uniforms.bin", "image.raw"].map(|name| folder.join(name));
    // Places of pixels are exact so; those that are handed from corner to corner lose digits.
    let place = format!("#define _vs2fs_location0 (gl_FragCoord.xy / {width}.0)");
    let text = text.replace("smooth in vec2 _vs2fs_location0;", &place);
    fs::write(&files[0], text).unwrap();
    fs::write(&files[1], uniforms).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/draw_shader.py");
    let mut command = Command::new("/usr/bin/python3");
    let side = width.to_string();
    let output = command
        .arg(script)
        .args(&files)
        .args([&side, &side])
        .output()
        .ok()?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    if !said.contains("drawn: ") {
        println!("{said}{}", String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success(), "OpenGL refuses the text");
        assert!(
            std::env::var_os("REQUIRE_SHADER_DRAWING").is_none(),
            "no OpenGL"
        );
        return None;
    }
    let bytes = fs::read(&files[2]).unwrap();
    Some(
        bytes
            .chunks_exact(4)
            .map(|it| f32::from_le_bytes(it.try_into().unwrap()))
            .collect(),
    )
}

/// Where light ends, a window is a small difference: pixels are not asked for more digits than those with this share of
/// the brightest one.
const LEAST_SHARE: f64 = 1e-3;

/// Every so many pixels are compared: the reference takes its time.
const STRIDE: usize = 101;

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
    let folder = Folder::new();
    let scenes = scenes();
    assert!(scenes.len() >= 20);
    for (number, (name, scene)) in scenes.into_iter().enumerate() {
        let shader = export(&scene, Language::Glsl, Entry::Image).unwrap();
        let uniforms = shader.uniforms(&scene).unwrap();
        let Some(found) = drawn(folder.path(), &shader.text, &uniforms, scene.image.width) else {
            return println!("skipped: no OpenGL");
        };
        let expected = expected(&scene);
        let off = error(&found, &expected);
        let most = match name.ends_with(" None 0") {
            true => MOST_OFF_BESIDE_BARE_CORES,
            false => MOST_OFF,
        };
        println!("{name}: {off:.1e}");
        assert!(off <= most, "{name}: {off:e}");
        if !number.is_multiple_of(SPOILED) {
            continue;
        }
        // A spoiled text must fail.
        let spoiled = shader
            .text
            .replace("atan(", "1.01 * atan(")
            .replace("0.5 * log(", "0.505 * log(")
            .replace("0.1894506", "0.1994506");
        assert_ne!(spoiled, shader.text);
        let found = drawn(folder.path(), &spoiled, &uniforms, scene.image.width).unwrap();
        let off = error(&found, &expected);
        assert!(off > most, "{name}: a spoiled text passes: {off:e}");
    }
}

#[test]
fn opengl_draws_rings_and_curves_within_what_their_nodes_leave() {
    let folder = Folder::new();
    for (number, (name, scene)) in mapped_scenes().into_iter().enumerate() {
        let shader = export(&scene, Language::Glsl, Entry::Image).unwrap();
        let uniforms = shader.uniforms(&scene).unwrap();
        let Some(found) = drawn(folder.path(), &shader.text, &uniforms, scene.image.width) else {
            return println!("skipped: no OpenGL");
        };
        let expected = expected(&scene);
        let off = error(&found, &expected);
        println!("{name}: {off:.1e}");
        assert!(off <= MOST_OFF_BY_NODES, "{name}: {off:e}");
        if !number.is_multiple_of(SPOILED) {
            continue;
        }
        let spoiled = shader.text.replace("0.1894506", "0.2894506");
        assert_ne!(spoiled, shader.text);
        let found = drawn(folder.path(), &spoiled, &uniforms, scene.image.width).unwrap();
        let off = error(&found, &expected);
        assert!(
            off > MOST_OFF_BY_NODES,
            "{name}: a spoiled text passes: {off:e}"
        );
    }
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
                let kinds = ["sphere", "cylinder", "segment", "beam", "torus", "curve"];
                let kinds = kinds
                    .iter()
                    .filter(|it| text.contains(&format!("fn {it}_light(")));
                // One kind is short, whatever its form; several are the longer.
                let most = if kinds.count() == 1 { 300 } else { 600 };
                let is_short = language != Language::Wgsl || count < most;
                if entry == Entry::Image && language == Language::Wgsl {
                    println!("{name}: {count} lines");
                }
                assert!(is_short, "{name}: {count} lines");
            }
        }
    }
}
