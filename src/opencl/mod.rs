//! The OpenCL side: finding devices, building the kernels, buffers, launches. The one home of `unsafe`.
#![allow(unsafe_code)] // calls into OpenCL are unsafe by nature; each block says why it is sound

mod affinity;
mod buffer;
mod compute;
mod counts;
mod depths;
mod discover;
mod failure;
mod job;
mod kernels;
mod launch;
mod lists;
mod mapped;
mod program;
mod renderer;
mod source;
mod tiles;

pub use affinity::keep_pocl_threads_apart;
pub use buffer::{DeviceBuffer, Uploaded};
pub use compute::Compute;
pub use discover::{Discovery, OpenClDevice, discover};
pub use mapped::Mapped;
pub use program::{Argument, BuildOptions, Program};
pub use renderer::OpenClRenderer;
pub use source::{FILES, resolve};
