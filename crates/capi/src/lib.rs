//! energywave for C and C++: scenes from files or texts, rendered into the caller's memory, on the host or on an OpenCL
//! device. `include/energywave.h` is made of these files by cbindgen; `docs/c.md` tells how to use it.
//!
//! Every call gives a [`Status`](status::Status); what went wrong is kept for the calling thread
//! (`energywave_last_error`). Handles are numbers in a register, never addresses: one that was freed, or that is none,
//! is an error. No panic leaves a call. What C hands over as addresses is turned into Rust in `border.rs` alone.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

// What lies below the calls.
mod border;
mod registry;

// The order of the header.
mod version;

mod status;

mod device;

mod scene;

mod override_values;

mod renderer;

mod render;

mod rays;

mod picture;

mod host;
mod host_points;
