//! The native half of the Python package `energywave`: scenes that are read, renderers, devices and pictures. The other
//! half, in `python/energywave/`, is what users see: scenes as objects, overrides as keywords, docstrings.
//!
//! Arrays are NumPy's: light is (height, width, 4) of float32, linear RGBA from the top left, rays are (n, 3) of
//! float64. Whatever takes long is done without Python's lock, and looks for Ctrl-C several times a second.

mod devices;
mod failure;
mod opencl;
mod overrides;
mod picture;
mod points;
mod renderer;
mod scene;
mod watch;

use pyo3::prelude::*;

#[pymodule]
mod _energywave {
    #[pymodule_export]
    use super::devices::devices;
    #[pymodule_export]
    use super::opencl::suit_drivers;
    #[pymodule_export]
    use super::picture::{save, tone_map};
    #[pymodule_export]
    use super::renderer::Renderer;
    #[pymodule_export]
    use super::scene::OpenedScene;
    #[pymodule_export]
    use super::schema;
}

/// Returns the JSON Schema of scenes, as text.
#[pyfunction]
fn schema() -> String {
    energywave::scene::keys::json_schema()
}
