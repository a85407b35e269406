//! Scenes as shaders: the text of their closed forms, for engines that draw by themselves, and the bytes of the uniform
//! block with their values.
//!
//! The text is written once, in WGSL (`wgsl/`), by the formulas of the kernels (`cl/wave/quadrature/closed_form.h`);
//! `naga` translates it. A text has only the kinds that its scene has, each in an array of a fixed length, one entry a
//! light. Time enters by the block: a host writes [`Shader::uniforms`] of the scene as it is at a time.

mod block;
#[cfg(feature = "shaders")]
mod constants;
mod curves;
mod irradiance;
mod lines;
mod paths;
mod points;
mod refuse;
mod text;
#[cfg(feature = "shaders")]
mod translate;
mod used;

use block::{Block, Exported, Row};

use crate::error::{Error, Result};
use crate::scene::Scene;

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
    /// GLSL ES 3.00 for Shadertoy, to paste as it is: the values are constants, and there is always a picture, with the
    /// scene's exposure, `1 - exp(-L)`, and the power 1/2.2 for sRGB.
    Shadertoy,
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
    /// The function `wave_irradiance` alone: from a place of a surface and its normal (of length 1), the light that
    /// points and straight cores cast on it, linear RGB, as `Renderer::irradiance` has it without shadows. The block
    /// is another.
    Irradiance,
}

/// A scene's text, and what it takes to fill its block.
#[derive(Debug, Clone, PartialEq)]
pub struct Shader {
    /// The text.
    pub text: String,
    counts: Vec<usize>,
    fields: Vec<UniformField>,
    entry: Entry,
}

/// Four float32 of a uniform block.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct UniformField {
    /// What the WGSL calls it, such as `beams[0].light.color`.
    pub name: String,
    /// Where it begins, bytes from the block's first.
    pub offset: usize,
}

impl Shader {
    /// Returns the bytes of the uniform block for a scene with the same sources as the one that was exported, such as
    /// an animated one at another time: little-endian float32, laid out as std140 has it.
    ///
    /// # Errors
    /// Those of [`export`]; [`Error::Unsupported`] where there are more or fewer lights of some kind.
    pub fn uniforms(&self, scene: &Scene) -> Result<Vec<u8>> {
        let others = || {
            let message =
                "the scene has other sources than the one that was exported: export it again";
            Error::Unsupported(message.to_owned())
        };
        if self.entry == Entry::Irradiance {
            return irradiance::uniforms(scene, &self.counts)?.ok_or_else(others);
        }
        let block = Block::of(scene)?;
        if block.counts() != self.counts {
            return Err(others());
        }
        let rows = [block.rows, block.series].concat();
        Ok(bytemuck::cast_slice(&rows).to_vec())
    }

    /// Returns the same for a scene that moves, as it is at a time in seconds: what a host writes each frame.
    ///
    /// # Errors
    /// Those of [`Shader::uniforms`], and of [`AnimatedScene::at`](crate::scene::AnimatedScene::at).
    #[cfg(feature = "files")]
    pub fn uniforms_at(&self, scene: &crate::scene::AnimatedScene, time: f64) -> Result<Vec<u8>> {
        let (bytes, _) = scene.made_at(time, |scene| self.uniforms(scene))?;
        Ok(bytes)
    }

    /// Returns what the block holds, in the order of its bytes.
    #[must_use]
    pub fn fields(&self) -> &[UniformField] {
        &self.fields
    }
}

/// What is said where there is no translator.
#[cfg(not(feature = "shaders"))]
const WGSL_ALONE: &str = "this build writes WGSL alone: build it with the feature shaders";

/// Writes a scene as a shader.
///
/// # Errors
/// [`Error::Scene`] by the key of what has no form, where nothing glows, and if values are wrong;
/// [`Error::Unsupported`] where this build lacks the language.
pub fn export(scene: &Scene, language: Language, entry: Entry) -> Result<Shader> {
    if entry == Entry::Irradiance && language != Language::Shadertoy {
        let shader = irradiance::export(scene)?;
        let text = match language {
            Language::Wgsl => shader.text.clone(),
            #[cfg(feature = "shaders")]
            _ => translate::translate(&shader.text, language, entry)?,
            #[cfg(not(feature = "shaders"))]
            _ => return Err(Error::Unsupported(WGSL_ALONE.to_owned())),
        };
        return Ok(Shader { text, ..shader });
    }
    let block = Block::of(scene)?;
    let entry = match language {
        Language::Shadertoy => Entry::Function,
        _ => entry,
    };
    let wgsl = block.text(entry);
    let text = match language {
        Language::Wgsl => wgsl,
        #[cfg(feature = "shaders")]
        Language::Shadertoy => translate::to_shadertoy(&wgsl, &block.constant())?,
        #[cfg(feature = "shaders")]
        _ => translate::translate(&wgsl, language, entry)?,
        #[cfg(not(feature = "shaders"))]
        _ => return Err(Error::Unsupported(WGSL_ALONE.to_owned())),
    };
    Ok(Shader {
        text,
        counts: block.counts(),
        fields: block.fields(),
        entry,
    })
}
