//! Single parts of the kernels, and devices that share a frame.
#![allow(clippy::unwrap_used, clippy::panic)] // tests fail by panicking

#[path = "../common/mod.rs"]
mod common;

mod bloom; // compares the bloom of a picture with the host's
mod canaries; // looks for what is written behind an image
mod crowd_memory; // counts what crowds of a million points take of memory
mod device_functions; // compares device functions, one at a time, with float64
mod distances; // compares the distance to every kind of core with float64
mod film; // lets a second engine add its light to the wave's
mod hidden; // sends rays through edges and corners of a closed mesh
mod layout; // finds every field of every device struct by its name
mod same_states; // simulates on one device and on two what hits a mesh
mod sanitizer; // runs every kernel on every lane width, small enough for a simulator
mod several_devices; // draws one frame on several devices
mod splits; // cuts a frame into launches in every way
