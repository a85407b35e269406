//! What drivers do wrong: calls that fail, devices that are lost, kernels that compute wrong, OpenCL that is missing.
//!
//! Whoever looks at this process' own calls to OpenCL has a process of its own, see [`common::apart`]: loaders load
//! layers once, and objects and memory are counted for all threads together.
#![allow(clippy::unwrap_used, clippy::panic)] // tests fail by panicking
#![cfg(unix)] // the OpenCL layer is a shared library

#[path = "../common/mod.rs"]
mod common;

mod animation; // counts what frames of a scene that moves make on the device
mod bloom_faults; // lets every call of a bloom fail in turn
mod faults; // lets every call of a frame fail in turn
mod host_depths; // gives a frame a host's depths that do not fit, and lets what reads them fail
mod host_faults; // lets every call of a host's frame fail, and gives what does not fit
mod kernel_cache; // spoils the kernels that are kept on disk
#[cfg(target_os = "linux")] // resident memory is read from /proc
mod leaks; // counts objects and memory over ten thousand frames
mod missing_opencl; // takes OpenCL away, or makes the choice of a device ambiguous
mod self_test; // has kernels that compute wrong refused at their first use
mod slow_start; // is told of a first launch that does not end
