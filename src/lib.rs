//! Volumetric energy effects - beams, rings and curves of light - integrated along every view ray on any OpenCL device.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod device;
mod error;
pub mod image;
mod memory;
pub mod opencl;
pub mod pack;
pub mod ray;
pub mod reference;
mod renderer;
pub mod scene;
pub mod verify;

pub use device::{Device, DeviceType, Devices};
pub use error::{Error, Result, SceneError};
pub use image::{DisplayImage, RadianceImage};
pub use opencl::BuildOptions;
pub use renderer::Renderer;
pub use scene::Scene;
