//! The OpenCL side: finding devices, building the kernels, buffers, launches. The one home of `unsafe`.
#![allow(unsafe_code)] // calls into OpenCL are unsafe by nature; each block says why it is sound

mod affinity;
mod buffer;
mod cache;
mod compute;
mod copies;
mod counts;
mod depths;
mod discover;
mod failure;
mod handle;
mod host;
mod host_image;
mod in_place;
mod job;
mod kernels;
mod key;
mod known_scene;
mod launch;
mod lists;
mod mapped;
mod pace;
mod program;
mod renderer;
mod self_test;
mod source;
mod tiles;

pub use affinity::keep_pocl_threads_apart;
pub use buffer::{DeviceBuffer, Uploaded};
pub use cache::KernelCache;
pub use compute::Compute;
pub use discover::{Discovery, OpenClDevice, discover};
pub use host::HostTarget;
pub(crate) use job::grain_rows;
pub use key::ProgramKey;
pub use mapped::Mapped;
pub use program::{Argument, BuildOptions, Program};
pub use renderer::OpenClRenderer;
pub use source::{FILES, resolve};

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::bench::Table;

    #[test]
    fn an_image_larger_than_a_buffer_comes_in_bands() {
        let mut scene = Table::Torus.scene(96, 64);
        scene.image.width = 100;
        let mut images = Vec::new();
        for bytes in [1 << 30, 40_000] {
            let mut device = discover().devices.swap_remove(0);
            device.max_allocation_bytes = bytes;
            let mut renderer = OpenClRenderer::new(&device, &BuildOptions::default()).unwrap();
            for (stride, cut) in [(400, 0), (401, 0), (400, 64)] {
                let mut target = vec![0.0; 96 * stride];
                let nothing = &mut |_: f32| ControlFlow::Continue(());
                let (upper, lower) = target.split_at_mut(cut as usize * stride);
                for (rows, part) in [(0..cut, upper), (cut..96, lower)] {
                    renderer
                        .render_rows(&scene, rows, part, stride, nothing)
                        .unwrap();
                }
                let rows = target.chunks(stride).map(|row| row[..400].to_vec());
                images.push(rows.collect::<Vec<_>>());
            }
        }
        assert!(images.windows(2).all(|pair| pair[0] == pair[1]));
        assert!(images[0].iter().flatten().all(|value| *value > 0.0));
    }
}
