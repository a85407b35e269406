//! Writes `beam.toml` as it is given to hosts: Shadertoy, three.js, Godot 4 and Bevy; what is checked in beside this
//! file was written by it: `cargo run --release --example exports`.

use std::path::Path;
use std::{env, fs};

use energywave::Scene;
use energywave::shader::{Entry, Language, export};

/// The picture by the scene's own camera, in Godot's language.
const GODOT: &str = "void fragment() {
    vec3 on_plane = wave.corner.xyz + UV.x * wave.across.xyz + UV.y * wave.down.xyz; // seen from the eye
    vec3 light = wave_light(wave.eye.xyz + on_plane, normalize(on_plane), wave.rays.x);
    COLOR = vec4(pow(1.0 - exp(-EXPOSURE * light), vec3(1.0 / 2.2)), 1.0);
}
";

/// The same for Bevy's 2D materials, whose targets are linear.
const BEVY: &str = "
// The picture by the scene's own camera.
#import bevy_sprite::mesh2d_vertex_output::VertexOutput

@fragment
fn fragment(mesh: VertexOutput) -> @location(0) vec4<f32> {
    let on_plane = wave.corner.xyz + mesh.uv.x * wave.across.xyz + mesh.uv.y * wave.down.xyz; // seen from the eye
    let light = wave_light(wave.eye.xyz + on_plane, normalize(on_plane), wave.rays.x);
    return vec4<f32>(1.0 - exp(-light), 1.0);
}
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let here = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/exports");
    let folder = env::args().nth(1).unwrap_or_else(|| here.to_owned());
    let scene = Scene::from_file(format!("{here}/beam.toml"))?;
    let write = |name: &str, text: &str| {
        let path = Path::new(&folder).join(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        fs::write(path, text)
    };

    let shadertoy = export(&scene, Language::Shadertoy, Entry::Image)?.text;
    write("shadertoy/beam.glsl", &shadertoy)?;

    let head = "precision highp float;\nuniform vec3 iResolution;\nout vec4 pixel;\n";
    let text = shadertoy.replace('`', "'"); // which ends a text in JavaScript
    let stage = "\nvoid main() {\n    mainImage(pixel, gl_FragCoord.xy);\n}\n";
    write(
        "three/beam.js",
        &format!("export const FRAGMENT = `{head}{text}{stage}`;\n"),
    )?;

    let functions = shadertoy
        .split("// The picture by")
        .next()
        .unwrap_or_default();
    write(
        "godot/beam.gdshader",
        &format!("shader_type canvas_item;\n\n{functions}{GODOT}"),
    )?;

    let wgsl = export(&scene, Language::Wgsl, Entry::Function)?;
    let text = wgsl.text.replace("@group(0)", "@group(2)");
    write("bevy/beam.wgsl", &format!("{text}{BEVY}"))?;
    let bytes = wgsl.uniforms(&scene)?;
    let number = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let mut rows = format!("const ROWS: [[f32; 4]; {}] = [\n", bytes.len() / 16);
    for (row, field) in bytes.chunks_exact(16).zip(wgsl.fields()) {
        let numbers: Vec<f32> = row.chunks_exact(4).map(number).collect();
        rows += &format!("    {numbers:?}, // {}\n", field.name);
    }
    write("bevy/rows.rs", &(rows + "];\n"))?;
    Ok(())
}
