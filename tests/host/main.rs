//! Frames in a host's own OpenCL.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests fail by panicking

#[path = "../common/mod.rs"]
mod common;

mod clip_depths; // ends rays at depths of clip space in a host's memory
mod depths; // ends rays at depths in a host's own buffer or image
mod frames; // draws both
#[allow(clippy::module_inception)] // the module says what it tests, as in the other programs
mod host; // draws into a host's buffers and images, on its queue, after its events
mod points; // draws points of light in a host's own buffers
mod surfaces; // draws frames that are put together of surfaces and light
