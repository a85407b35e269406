//! Scenes as shaders: the text of their closed forms, for engines that draw by themselves, and the bytes of the uniform
//! block with their values.
//!
//! The text is written once, in WGSL (`wgsl/`), by the formulas of the kernels (`cl/wave/quadrature/closed_form.h`);
//! `naga` translates it. A text has only the kinds that its scene has, each in an array of a fixed length, one entry a
//! light. Time enters by the block: a host writes [`Shader::uniforms`] of the scene as it is at a time.

mod curves;
mod lines;
mod points;
#[cfg(feature = "shaders")]
mod translate;

use glam::DVec3;

use crate::error::{Error, Result};
use crate::scene::kinds::for_each_kind;
use crate::scene::{Fading, Profile, Reduction, Scene};
use crate::wave::pack::layout::Falloff;
use crate::wave::pack::{Anchor, Sources};

/// What a shader is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Language {
    /// WebGPU's.
    Wgsl,
    /// OpenGL's, version 3.30.
    Glsl,
    /// Direct3D's, shader model 5.1.
    Hlsl,
}

/// Where a text begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Entry {
    /// The function `wave_light` alone: from the origin, the direction (of length 1) and the end depth of a ray, linear
    /// RGB.
    Function,
    /// Also a picture by the scene's camera: the fragment stage `image`, and in WGSL and HLSL the vertex stage
    /// `screen`.
    Image,
}

/// A scene's text, and what it takes to fill its block.
#[derive(Debug, Clone, PartialEq)]
pub struct Shader {
    /// The text.
    pub text: String,
    counts: Vec<usize>,
}

/// Four numbers of the block.
type Row = [f32; 4];

/// The most bytes that every implementation of OpenGL ES 3 and WebGPU has for a block.
const MOST_BYTES: usize = 16384;

const LICENCE: &str = "// Written by energywave, MIT OR Apache-2.0.\n";
const RAY: &str = include_str!("../../wgsl/ray.wgsl");
const CLOSED_FORM: &str = include_str!("../../wgsl/closed_form.wgsl");
const NODES: &str = include_str!("../../wgsl/nodes.wgsl");
const MAPPED: &str = include_str!("../../wgsl/mapped.wgsl");
const IMAGE: &str = include_str!("../../wgsl/image.wgsl");

/// A packed source that a shader may have.
trait Exported {
    /// The text of its kind; `None` where it has no closed form.
    const TEXT: Option<&'static str>;

    /// Whether it is integrated by nodes.
    const IS_MAPPED: bool = false;

    /// How its field falls off.
    fn falloff(&self) -> Falloff;

    /// Returns its struct in the block, but for its light.
    fn rows(&self) -> Vec<Row>;

    /// Returns colour times coefficient times measure.
    fn emission(&self) -> Row;

    /// Returns whether its light changes along its core, which no shader has.
    fn changes_along(&self) -> bool {
        false
    }
}

impl Shader {
    /// Returns the bytes of the uniform block for a scene with the same sources as the one that was exported, such as
    /// an animated one at another time: little-endian float32, laid out as std140 has it.
    ///
    /// # Errors
    /// [`Error::Unsupported`] as [`export`], and where there are more or fewer lights of some kind.
    pub fn uniforms(&self, scene: &Scene) -> Result<Vec<u8>> {
        let block = Block::of(scene)?;
        if block.counts() != self.counts {
            let message =
                "the scene has other sources than the one that was exported: export it again";
            return Err(Error::Unsupported(message.to_owned()));
        }
        Ok(bytemuck::cast_slice(&block.rows).to_vec())
    }
}

/// Writes a scene as a shader.
///
/// # Errors
/// [`Error::Unsupported`] where something in it has no closed form, where nothing glows, and where this build lacks
/// the language; [`Error::Scene`] if its values are wrong.
pub fn export(scene: &Scene, language: Language, entry: Entry) -> Result<Shader> {
    let block = Block::of(scene)?;
    let wgsl = block.text(entry);
    let text = match language {
        Language::Wgsl => wgsl,
        #[cfg(feature = "shaders")]
        _ => translate::translate(&wgsl, language, entry)?,
        #[cfg(not(feature = "shaders"))]
        _ => {
            let message = "this build writes WGSL alone: build it with the feature shaders";
            return Err(Error::Unsupported(message.to_owned()));
        }
    };
    let counts = block.counts();
    Ok(Shader { text, counts })
}

/// The values of a scene, and what there is of every kind.
struct Block {
    rows: Vec<Row>,
    kinds: Vec<Kind>,
}

struct Kind {
    name: &'static str,
    type_name: &'static str,
    text: &'static str,
    is_mapped: bool,
    count: usize,
    first_byte: usize,
}

macro_rules! add_kinds {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// Adds all sources; fails where one has no closed form.
        fn add_kinds(block: &mut Block, sources: &Sources, softening2: f32) -> Result<()> {
            $(block.add(stringify!($kind), stringify!($Type), &sources.$list, softening2)?;)*
            Ok(())
        }
    };
}
for_each_kind!(add_kinds);

impl Block {
    fn of(scene: &Scene) -> Result<Self> {
        scene.validate()?;
        refuse(scene)?;
        let length = scene.ray_length();
        let anchor = Anchor::new(scene, DVec3::ZERO, length, length);
        let sources = Sources::new(scene, &anchor);
        let softening2 = scene.integration.softening.powi(2) as f32;
        let mut block = Self {
            rows: head(scene, length),
            kinds: Vec::new(),
        };
        add_kinds(&mut block, &sources, softening2)?;
        if block.kinds.is_empty() {
            let message = "the scene has no source that glows: give it one";
            return Err(Error::Unsupported(message.to_owned()));
        }
        let bytes = size_of::<Row>() * block.rows.len();
        if bytes > MOST_BYTES {
            let message = format!(
                "the lights of the scene take {bytes} bytes of a uniform block, which has {MOST_BYTES}: \
                 export fewer sources, or fewer layers, at a time"
            );
            return Err(Error::Unsupported(message));
        }
        Ok(block)
    }

    fn counts(&self) -> Vec<usize> {
        self.kinds.iter().map(|kind| kind.count).collect()
    }

    fn add<Device: Exported>(
        &mut self,
        name: &'static str,
        type_name: &'static str,
        list: &[Device],
        softening2: f32,
    ) -> Result<()> {
        if list.is_empty() {
            return Ok(());
        }
        let is_uneven = list.iter().any(Exported::changes_along);
        let Some(text) = Device::TEXT.filter(|_| !is_uneven) else {
            return Err(no_form(&format!(
                "[[{name}]], or light that changes along a core,"
            )));
        };
        self.kinds.push(Kind {
            name,
            type_name,
            text,
            is_mapped: Device::IS_MAPPED,
            count: list.len(),
            first_byte: size_of::<Row>() * self.rows.len(),
        });
        for source in list {
            let falloff = source.falloff();
            let [red, green, blue, _] = source.emission();
            let square = if falloff.profile == 1 { 1.0 } else { 0.0 };
            self.rows.extend(source.rows());
            self.rows.push([red, green, blue, square]);
            self.rows
                .push([falloff.radius2 + softening2, 0.0, 0.0, 0.0]);
        }
        Ok(())
    }

    /// Returns the text in WGSL.
    fn text(&self, entry: Entry) -> String {
        let mut text = LICENCE.to_owned();
        text += "// Light along a ray, the integral of field times decay: linear RGB before tone mapping.\n";
        text += &self.layout();
        text += &format!("\n{RAY}");
        for (is_mapped, part) in [(false, CLOSED_FORM), (true, NODES)] {
            if self.kinds.iter().any(|kind| kind.is_mapped == is_mapped) {
                text += &format!("\n{part}");
            }
        }
        for kind in &self.kinds {
            text += &format!("\n{}", kind.text);
            if kind.is_mapped {
                let mapped = MAPPED.replace("KIND", kind.name);
                text += &format!("\n{}", mapped.replace("TYPE", kind.type_name));
            }
        }
        text += &self.sum();
        if entry == Entry::Image {
            text += &format!("\n{IMAGE}");
        }
        text
    }

    /// Returns the declaration of the block, with the offset of every field.
    fn layout(&self) -> String {
        let mut text = String::from(
            "\n// The scene's values. Before each field its offset in bytes.\nstruct Wave {\n\
             \x20   /* 0 */ rays: vec4f, // |E - S|; beta |E - S|, or 0 without decay; what multiplies all light;\n\
             \x20                        // no squared distance to a core is taken below the last\n\
             \x20   /* 16 */ eye: vec4f, // last 1, or 0 where rays are parallel\n\
             \x20   /* 32 */ corner: vec4f, // from the eye to the top left corner of the projection plane\n\
             \x20   /* 48 */ across: vec4f, // from there to the top right corner\n\
             \x20   /* 64 */ down: vec4f, // and to the bottom left corner\n\
             \x20   /* 80 */ forward: vec4f, // where parallel rays go\n",
        );
        for Kind {
            name,
            type_name,
            count,
            first_byte,
            ..
        } in &self.kinds
        {
            text += &format!("    /* {first_byte} */ {name}s: array<{type_name}, {count}>,\n");
        }
        text += &format!(
            "}} // {} bytes\n@group(0) @binding(0) var<uniform> wave: Wave;\n",
            size_of::<Row>() * self.rows.len()
        );
        text
    }

    /// Returns the function that adds all light up.
    fn sum(&self) -> String {
        let mut text = String::from(
            "\n// Returns the light along a ray: linear RGB. The direction is of length 1, depth the length at which\n\
             // the ray is hidden, world units from its origin.\n\
             fn wave_light(origin: vec3f, direction: vec3f, depth: f32) -> vec3f {\n\
             \x20   let ray = Ray(origin, direction, clamp(depth, 0.0, wave.rays.x));\n\
             \x20   var light = vec3f(0.0);\n",
        );
        for Kind { name, count, .. } in &self.kinds {
            text += &format!(
                "    for (var i = 0; i < {count}; i++) {{\n        light += {name}_light(ray, wave.{name}s[i]) * \
                 wave.{name}s[i].light.color.rgb;\n    }}\n"
            );
        }
        text + "    return light;\n}\n"
    }
}

/// Returns what the block begins with.
fn head(scene: &Scene, length: f64) -> Vec<Row> {
    let plane = scene.view_plane();
    let decay = scene.decay.filter(|decay| decay.power > 0);
    let strength = decay.map_or(1.0, |decay| decay.alpha / (decay.beta * decay.beta));
    let row = |v: DVec3, last: f64| [v.x as f32, v.y as f32, v.z as f32, last as f32];
    let (width, height) = (f64::from(scene.image.width), f64::from(scene.image.height));
    let corner = plane.first_pixel - 0.5 * (plane.column_step + plane.row_step);
    let kind = if plane.is_parallel { 0.0 } else { 1.0 };
    let floor = crate::scene::CORE_FLOOR * length;
    let beta = decay.map_or(0.0, |decay| decay.beta * length);
    vec![
        // Emission is measured over s, the integral over lengths.
        [length, beta, strength / length, floor * floor].map(|it| it as f32),
        row(plane.eye, kind),
        row(corner, 0.0),
        row(width * plane.column_step, 0.0),
        row(height * plane.row_step, 0.0),
        row(plane.forward, 0.0),
    ]
}

/// Refuses what has no closed form here.
fn refuse(scene: &Scene) -> Result<()> {
    let surfaces = [
        ("[[mesh]]", scene.meshes.len()),
        ("[[metaballs]]", scene.metaballs.len()),
        (
            "[[particles]]",
            scene.particles.len() + scene.light_elements.len(),
        ),
        ("[[wave]]", scene.waves.len()),
        ("[[volume]]", scene.volumes.len()),
    ];
    if let Some((name, _)) = surfaces.iter().find(|(_, count)| *count > 0) {
        return Err(no_form(name));
    }
    if scene.integration.reduction == Reduction::Rms {
        return Err(no_form("reduction = \"rms\""));
    }
    match scene.fading() {
        Some(Fading { kappa, .. }) if kappa != 0.0 => return Err(no_form("[absorption]")),
        Some(_) => return Err(no_form("a [decay] of another power than 2 or 0")),
        None => {}
    }
    if scene.any_falloff(|it| it.reach.is_some()) {
        return Err(no_form("reach"));
    }
    if scene.any_falloff(|it| !matches!(it.profile, Profile::Inverse | Profile::InverseSquare)) {
        return Err(no_form("a profile beside inverse and inverse-square"));
    }
    Ok(())
}

fn no_form(what: &str) -> Error {
    Error::Unsupported(format!(
        "{what} has no form in shaders, which have point, line, segment, beam, ring and curve with 1/d or 1/d^2: \
         export a scene without it, or give the engine a baked volume"
    ))
}
