//! Volumetric energy effects - beams, rings and curves of light - integrated along every view ray on any OpenCL device.
//!
//! A pixel is `I = integral over s in [0,1] of psi(L(s)) zeta(s) ds` with
//!
//! ```text
//! L(s)    = (1 - s) S + s E          the ray, from the projection plane on    Watanabe, Abe, Konno 2015, eq. 19
//! zeta(s) = alpha / (s + beta)^2     the decay, or 1, or another power        eq. 21
//! psi(P)  = sum of coefficient * field(P)                                     eq. 18
//! field   = 1 / distance to the core: a point, a line, a ring,                eq. 2, 3, 7
//!           a quadratic curve, here times its local intensity,                eq. 8-17
//!           a half-line                                                       Abe, Watanabe 2010, eq. 6, 11, 12
//!           or the square of that                                             Sakai 2006
//! ```
//!
//! Where surfaces hide light, a [`DepthImage`](image::DepthImage) ends each ray (2010, eq. 13, 14).
//!
//! The integral is computed to a stated relative error, or summed by the paper's Simpson rule ([`scene::Method`]); the
//! former at every pixel near a source's core, at few pixels of a tile elsewhere ([`scene::Sampling`]).
//!
//! A [`Scene`] is packed, uploaded and integrated on a [`Device`] by a [`Renderer`] into a [`RadianceImage`], which is
//! tone-mapped into a [`DisplayImage`]. [`mod@reference`] computes the same in float64 by another method.
//!
//! ```no_run
//! use energywave::scene::{Camera, Torus};
//! use energywave::{Device, Renderer, Scene};
//! use energywave::glam::DVec3;
//!
//! # fn main() -> energywave::Result<()> {
//! let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 2.0), DVec3::ZERO));
//! scene.tori.push(Torus {
//!     color: DVec3::new(0.15, 0.35, 1.0),
//!     coefficient: 0.01,
//!     ..Torus::new(0.9)
//! });
//! let mut renderer = Renderer::new(&Device::best()?)?; // keeps kernels and buffers from frame to frame
//! let radiance = renderer.render(&scene)?; // linear RGBA in float32
//! # #[cfg(feature = "files")]
//! radiance.tone_map(&scene.display).save("ring.png")?;
//! # Ok(())
//! # }
//! ```
//!
//! Features, all on by default: `files` (EXR and PNG images, TOML scenes), `webp` and `jpeg` (such images), `json`
//! (JSON scenes and rays), `kernel-cache` (built kernels on disk, for drivers that keep none), `threads` (the reference
//! and tone mapping on all cores), `papers` (the papers' tables), `shaders` (shaders in GLSL and HLSL), `cli` (the
//! program, with all of these). Off by default: `window` (`energywave watch` in a window).
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod bloom;
mod cost;
mod crowd;
mod error;
mod glow;
pub mod image;
#[doc(hidden)]
pub mod internals;
pub mod light;
mod memory;
mod mesh;
mod metaball;
#[cfg(feature = "files")]
mod nearest;
mod opencl;
#[cfg(feature = "files")]
mod output;
#[cfg(feature = "papers")]
pub mod papers;
pub mod particle;
pub mod reference;
mod render;
pub mod scene;
pub mod shader;
mod shown;
mod texture;
mod threads;
#[cfg(feature = "json")]
pub mod verify;
pub mod volume;
mod wave;

pub use cost::{CrowdCost, FrameCost};
pub use error::{Cause, Error, ErrorKind, Result, SceneError};
pub use glam; // whose vectors are in scenes
pub use image::{DisplayImage, RadianceImage};
#[cfg(feature = "files")]
pub use nearest::nearest;
#[cfg(feature = "kernel-cache")]
pub use opencl::KernelCache;
pub use opencl::{
    DeviceForm, DeviceType, HostDepthMemory, HostTarget, RendererOptions, SlowStart,
    keep_pocl_threads_apart, suit_pocl,
};
pub use opencl3; // whose handles hosts give
#[cfg(feature = "files")]
pub use output::TextFile;
pub use render::{BakeError, Device, Devices, HostDepth, HostPoints, MappedImage, Renderer};
pub use scene::{Ray, Scene};
pub use shown::{shown, shown_lines};
