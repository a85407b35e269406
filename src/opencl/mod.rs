//! The OpenCL runtime: finding devices, building programs, memory, launches, and the film that engines draw into. It
//! knows no scene, and is the home of `unsafe`.
#![allow(unsafe_code)] // calls into OpenCL are unsafe by nature; each block says why it is sound

mod absent;
mod adder;
mod affinity;
mod buffer;
#[cfg(feature = "kernel-cache")]
mod cache;
mod compute;
mod copies;
mod counters;
mod discover;
mod failure;
mod film;
mod film_memory;
mod half;
mod handle;
mod host;
mod host_depth;
mod host_image;
mod host_lengths;
mod host_points;
mod image;
mod image3d;
mod kernel;
#[cfg(feature = "kernel-cache")]
mod key;
mod layout;
mod options;
mod pocl;
mod program;
mod record;
mod source;
mod uploaded;
mod watch;

pub(crate) use adder::{Added, Adder};
pub use affinity::keep_pocl_threads_apart;
pub use buffer::{DeviceBuffer, Pixel};
#[cfg(feature = "kernel-cache")]
pub use cache::KernelCache;
pub use compute::Compute;
pub(crate) use copies::state;
pub(crate) use counters::wait;
pub use counters::{Counted, Counters};
pub use discover::{DeviceForm, DeviceType, Discovery, OpenClDevice, discover};
pub use film::{Film, FilmFormat, FilmPart};
pub(crate) use film_memory::MappedFilm;
pub(crate) use handle::Handle;
pub use host::HostTarget;
pub(crate) use host::{HostLink, unfit};
pub(crate) use host_depth::HeldDepths;
pub use host_depth::HostDepthMemory;
pub(crate) use host_lengths::{ClipValues, DepthValues, HostDepths};
pub use host_lengths::{StoredDepths, definitions as host_depth_definitions};
pub(crate) use host_points::HeldRows;
pub(crate) use image3d::{SharedImage, has_images};
pub use kernel::{Argument, Kernel};
pub(crate) use kernel::{RawMemory, by_value, halved, run_time, set_value};
#[cfg(feature = "kernel-cache")]
pub use key::ProgramKey;
pub(crate) use layout::device_struct;
pub use layout::{DeviceStruct, StructLayout};
pub use options::RendererOptions;
pub use pocl::suit_pocl;
pub use program::Program;
pub(crate) use program::flags_for;
pub(crate) use source::embed;
pub use source::{SHARED, SourceFile, Sources};
pub use uploaded::{Uploaded, UploadedShared};
pub use watch::SlowStart;
pub(crate) use watch::Watch;
