//! Asks of exported shaders what is beside their pictures: blocks, refusals, other compilers.

use std::fs;
use std::path::Path;
use std::process::Command;

use energywave::glam::DVec3;
use energywave::reference;
use energywave::scene::{AnimatedScene, Antialias, Preset};
use energywave::shader::{Entry, Language, export};
use energywave::{Device, Renderer, Scene};

use crate::common::program::{Folder, expect};
use crate::export::drawn;
use crate::export_scenes::SIDE;

const HEAD: &str = "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n";

#[test]
fn a_scene_that_moves_takes_a_new_block_and_no_new_text() {
    let folder = Folder::new();
    let text = format!(
        "{HEAD}[[beam]]\ndirection = [1, 0, 0]\nradius = {{ times = [0, 2], values = [0.1, 0.3] }}\n\
         [[curve]]\ncontrol_points = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\nradius = 0.1\n\
         intensity = {{ times = [0, 2], values = [[1, 1, 1], [0, 3, 1]] }}\n"
    );
    fs::write(folder.path().join("scene.toml"), &text).unwrap();
    let scene = AnimatedScene::from_toml(text).unwrap();
    let at = |time| export(&scene.at(time).unwrap(), Language::Wgsl, Entry::Image).unwrap();
    let shader = at(0.0);
    assert_eq!(shader.text, at(1.0).text);
    let block = shader.uniforms_at(&scene, 1.0).unwrap();
    assert_eq!(block, shader.uniforms(&scene.at(1.0).unwrap()).unwrap());
    assert_ne!(block, shader.uniforms_at(&scene, 0.0).unwrap());

    let arguments = [
        "-q",
        "export",
        "scene.toml",
        "--to",
        "glsl",
        "-o",
        "x.frag",
        "--at",
        "1",
    ];
    let output = folder.run(&[&arguments[..], &["--uniforms", "x.json"]].concat());
    assert!(output.status.success());
    let json = fs::read_to_string(folder.path().join("x.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["bytes"], block.len());
    let fields = json["fields"].as_array().unwrap();
    assert_eq!(16 * fields.len(), block.len());
    for field in fields {
        let offset = field["offset"].as_u64().unwrap() as usize;
        for (k, value) in field["values"].as_array().unwrap().iter().enumerate() {
            let bytes = &block[offset + 4 * k..offset + 4 * k + 4];
            let found = f32::from_le_bytes(bytes.try_into().unwrap());
            assert_eq!(found, value.as_f64().unwrap() as f32, "{field}");
        }
    }
    let value = |name: &str, k: usize| {
        let field = fields.iter().find(|field| field["name"] == name).unwrap();
        field["values"][k].as_f64().unwrap()
    };
    assert!((value("beams[0].light.core", 0) - 0.04).abs() < 1e-7); // 0.2 squared
    // The names are those of the text, in its order.
    let names: Vec<&str> = fields
        .iter()
        .map(|field| field["name"].as_str().unwrap())
        .collect();
    for (kind, rows) in [
        ("Beam", &["tip", "direction", "parts"][..]),
        ("Curve", &["middle", "velocity", "second"]),
    ] {
        let list = format!("{}s[0].", kind.to_lowercase());
        let first = names
            .iter()
            .position(|name| name.starts_with(&list))
            .unwrap();
        let declared = shader
            .text
            .split(&format!("struct {kind} {{"))
            .nth(1)
            .unwrap();
        let mut from = 0;
        for (k, row) in rows.iter().enumerate() {
            assert_eq!(names[first + k], format!("{list}{row}"));
            from += declared[from..].find(&format!("{row}: vec4f")).unwrap();
        }
    }
    assert!(names.ends_with(&["curves[0].light.core", "series[0]"]));
}

#[test]
fn what_has_no_form_is_refused_by_its_place_and_nothing_is_written() {
    let folder = Folder::new();
    let cases = [
        ("", "scene.toml:1:1: the scene has no source that glows"),
        (
            "[[sphere]]\nprofile = \"smeared\"\nradius = 1\n",
            "scene.toml:5:11: sphere[0].profile",
        ),
        (
            "[[group]]\n[[group.sphere]]\nlayers = [{}, { profile = \"smeared\", radius = 1 }]\n",
            "scene.toml:6:27: group[0].sphere[0].layers[1].profile",
        ),
        (
            "[[volume]]\nlight_ball = {}\n",
            "scene.toml:4:1: volume[0]: [[volume]] has no form",
        ),
    ];
    for (scene, words) in cases {
        fs::write(folder.path().join("scene.toml"), format!("{HEAD}{scene}")).unwrap();
        let output = folder.run(&["-q", "export", "scene.toml", "--to", "wgsl", "-o", "x.wgsl"]);
        expect(&output, 3, words);
        assert!(!folder.path().join("x.wgsl").exists());
    }
    let output = folder.run(&["-q", "export", "scene.toml", "--to", "metal", "-o", "x"]);
    expect(&output, 2, "wgsl, glsl, hlsl");
    fs::write(
        folder.path().join("scene.toml"),
        format!("{HEAD}[[sphere]]\n"),
    )
    .unwrap();
    let output = folder.run(&[
        "-q",
        "export",
        "scene.toml",
        "--to",
        "wgsl",
        "-o",
        "none/x.wgsl",
    ]);
    expect(&output, 7, "none");
}

/// Compiles a text by glslang; `None` where there is none.
fn compiles(folder: &Path, name: &str, text: &str, options: &[&str]) -> Option<bool> {
    let file = folder.join(name);
    fs::write(&file, text).unwrap();
    let mut command = Command::new("glslangValidator");
    let Ok(output) = command.args(options).arg(&file).output() else {
        let must = std::env::var_os("REQUIRE_SHADER_DRAWING").is_some();
        assert!(!must, "no glslangValidator");
        return None;
    };
    if !output.status.success() {
        println!("{}", String::from_utf8_lossy(&output.stdout));
    }
    Some(output.status.success())
}

#[test]
fn a_compiler_takes_the_texts_for_direct3d_and_webgl() {
    let folder = Folder::new();
    for name in ["charge", "laser-corridor", "slash", "aura"] {
        let scene = Scene::from_toml(Preset::named(name).unwrap().text).unwrap();
        let hlsl = export(&scene, Language::Hlsl, Entry::Image).unwrap().text;
        for (stage, entry) in [("frag", "image"), ("vert", "screen")] {
            let spirv = folder.path().join("x.spv");
            let spirv = spirv.to_str().unwrap();
            let options = ["-D", "-V", "-S", stage, "-e", entry, "-o", spirv];
            let Some(is_fine) = compiles(folder.path(), "x.hlsl", &hlsl, &options) else {
                return println!("skipped: no glslangValidator");
            };
            assert!(is_fine, "{name}");
        }
        let spoiled = hlsl.replace("wave_light(", "light_of_wave(").replacen(
            "light_of_wave(",
            "wave_light(",
            1,
        );
        let spirv = folder.path().join("x.spv");
        let options = [
            "-D",
            "-V",
            "-S",
            "frag",
            "-e",
            "image",
            "-o",
            spirv.to_str().unwrap(),
        ];
        assert_eq!(
            compiles(folder.path(), "x.hlsl", &spoiled, &options),
            Some(false)
        );

        let toy = export(&scene, Language::Shadertoy, Entry::Image)
            .unwrap()
            .text;
        let head =
            "#version 300 es\nprecision highp float;\nuniform vec3 iResolution;\nout vec4 pixel;\n";
        let stage = "void main() { mainImage(pixel, gl_FragCoord.xy); }\n";
        let text = format!("{head}{toy}{stage}");
        assert_eq!(
            compiles(folder.path(), "x.frag", &text, &[]),
            Some(true),
            "{name}"
        );
    }
}

/// What is checked in under `examples/exports`, and written by the program there.
const WRITTEN: [&str; 5] = [
    "shadertoy/beam.glsl",
    "three/beam.js",
    "godot/beam.gdshader",
    "bevy/beam.wgsl",
    "bevy/rows.rs",
];

/// What tone-mapped channels may be off by.
const MOST_OFF: f32 = 1e-3;

#[test]
fn the_exports_of_the_examples_are_those_that_are_written_and_draw_their_scene() {
    let checked_in = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/exports");
    let folder = Folder::new();
    let test = std::env::current_exe().unwrap();
    let program = test
        .parent()
        .unwrap()
        .parent()
        .unwrap()
        .join("examples/exports");
    let status = Command::new(program).arg(folder.path()).status().unwrap();
    assert!(status.success());
    for name in WRITTEN {
        let read = |folder: &Path| fs::read_to_string(folder.join(name)).unwrap();
        let is_same = read(&checked_in) == read(folder.path());
        assert!(is_same, "{name}: cargo run --release --example exports");
    }

    let mut scene = Scene::from_file(checked_in.join("beam.toml")).unwrap();
    (scene.image.width, scene.image.height) = (SIDE, SIDE);
    scene.integration.antialias = Antialias::None;
    let expected = reference::render(&scene).unwrap();
    let toy = fs::read_to_string(checked_in.join("shadertoy/beam.glsl")).unwrap();
    let text = |toy: &str| {
        let head =
            format!("#version 330 core\nconst vec3 iResolution = vec3({SIDE}.0, {SIDE}.0, 1.0);\n");
        format!(
            "{head}out vec4 pixel;\n{toy}void main() {{ mainImage(pixel, gl_FragCoord.xy); }}\n"
        )
    };
    let off = |toy: &str| {
        let found = drawn(folder.path(), &text(toy), &[], SIDE)?;
        let pixels = found.chunks_exact(3).enumerate();
        let offs = pixels.map(|(index, found)| {
            let index = index as u32;
            let light = expected
                .pixel(index % SIDE, SIDE - 1 - index / SIDE)
                .unwrap();
            let shown = light.map(|it| (1.0 - (-it).exp()).powf(1.0 / 2.2));
            let channels = found.iter().zip(shown);
            channels.fold(0.0, |most: f32, (a, b)| most.max((a - b).abs()))
        });
        Some(offs.fold(0.0, f32::max))
    };
    let Some(found) = off(&toy) else {
        return println!("skipped: no OpenGL");
    };
    println!("{found:e}");
    assert!(found <= MOST_OFF, "{found:e}");
    let spoiled = off(&toy.replace("0.1894506", "0.2894506")).unwrap();
    assert!(spoiled > MOST_OFF, "a spoiled text passes: {spoiled:e}");
}

/// What float32 leaves of an irradiance, of the greatest.
const MOST_OFF_OF_IRRADIANCE: f64 = 1e-5;

#[test]
fn opengl_finds_the_irradiance_of_points_and_lines_as_the_reference_does() {
    let folder = Folder::new();
    let scene = Scene::from_toml(&format!(
        "{HEAD}[[sphere]]\ncenter = [0.2, 0.1, 0.4]\ncolor = [1, 0.5, 0.2]\n\
         [[segment]]\nfrom = [-0.8, -0.3, -0.4]\nto = [0.5, 0.6, 0.9]\n[[cylinder]]\ndirection = [1, 0.2, 0.1]\n\
         point = [0, 0, 1]\n[[path]]\npoints = [[1, 1, 0.5], [0, 1, 1], [-1, 0.5, 0.2]]\n"
    ))
    .unwrap();
    let shader = export(&scene, Language::Glsl, Entry::Irradiance).unwrap();
    assert!(shader.text.contains("// Returns the irradiance of a place"));
    let uniforms = shader.uniforms(&scene).unwrap();
    assert_eq!(uniforms.len(), 16 * shader.fields().len());
    // A tilted surface that cores cross.
    const WIDE: u32 = 64;
    let normal = DVec3::new(0.48, -0.36, 0.8);
    let (declared, pixel) = match shader.text.contains("_fs2p_location0") {
        true => ("", "_fs2p_location0"),
        false => ("out vec4 pixel;", "pixel"),
    };
    let stage = format!(
        "{declared}\nvoid main() {{ vec2 uv = gl_FragCoord.xy / {WIDE}.0; \
         {pixel} = vec4(wave_irradiance(vec3(2.0 * uv - 1.0, 0.25), vec3(0.48, -0.36, 0.8)), 1.0); }}\n"
    );
    let at = |it: u32| (f64::from(it) + 0.5) / f64::from(WIDE) * 2.0 - 1.0;
    let pixels: Vec<u32> = (0..WIDE * WIDE).step_by(7).collect();
    let points: Vec<DVec3> = pixels
        .iter()
        .map(|it| DVec3::new(at(it % WIDE), at(it / WIDE), 0.25))
        .collect();
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    let normals = vec![normal; points.len()];
    let expected = reference.irradiance(&scene, &points, &normals).unwrap();
    let brightest = expected
        .iter()
        .flatten()
        .fold(0.0_f32, |most, it| most.max(*it));
    let off = |text: &str| {
        let found = drawn(folder.path(), &format!("{text}{stage}"), &uniforms, WIDE)?;
        let pairs = pixels.iter().zip(&expected).flat_map(|(pixel, expected)| {
            let found = &found[3 * *pixel as usize..][..3];
            found
                .iter()
                .zip(expected)
                .map(|(a, b)| f64::from((a - b).abs()))
                .collect::<Vec<_>>()
        });
        Some(pairs.fold(0.0, f64::max) / f64::from(brightest))
    };
    let Some(found) = off(&shader.text) else {
        return println!("skipped: no OpenGL");
    };
    println!("{found:e}");
    assert!(found <= MOST_OFF_OF_IRRADIANCE, "{found:e}");
    let spoiled = off(&shader.text.replace("max(dot(", "1.001 * max(dot(")).unwrap();
    assert!(
        spoiled > MOST_OFF_OF_IRRADIANCE,
        "a spoiled text passes: {spoiled:e}"
    );
    for kind in [
        "[[torus]]\nmajor_radius = 1\n",
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\ntaper_lengths = [0.5, 0]\n",
    ] {
        let scene = Scene::from_toml(&format!("{HEAD}{kind}")).unwrap();
        let refused = export(&scene, Language::Wgsl, Entry::Irradiance).unwrap_err();
        let said = refused.to_string();
        let table = &kind[2..kind.find(']').unwrap()];
        assert!(
            said.contains("no irradiance in shaders") && said.contains(&format!("{table}[0]")),
            "{said}"
        );
    }
}

#[test]
fn blocks_that_are_too_large_are_refused_by_the_table_that_fills_them() {
    let many = "[[sphere]]\nradius = 0.1\n".repeat(513);
    let scene = Scene::from_toml(&format!(
        "{HEAD}[[cylinder]]\npoint = [0, 0, 0]\ndirection = [0, 0, 1]\n{many}"
    ))
    .unwrap();
    for (entry, key) in [
        (Entry::Function, "sphere[0]"),
        (Entry::Irradiance, "sphere[512]"),
    ] {
        let refused = export(&scene, Language::Wgsl, entry)
            .unwrap_err()
            .to_string();
        assert!(
            refused.contains(key) && refused.contains("uniform block"),
            "{refused}"
        );
    }
    let mut few = scene;
    few.spheres.truncate(100);
    assert!(export(&few, Language::Wgsl, Entry::Function).is_ok());
}
