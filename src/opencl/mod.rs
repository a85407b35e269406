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
    use crate::scene::Method;

    #[test]
    fn an_image_larger_than_a_buffer_comes_in_bands() {
        let mut scene = Table::Torus.scene(96, 64);
        scene.image.width = 100;
        let mut images = Vec::new();
        for bytes in [1 << 30, 40_000] {
            let mut device = discover().devices.swap_remove(0);
            device.max_allocation_bytes = bytes;
            let mut renderer = OpenClRenderer::new(&device, &BuildOptions::default()).unwrap();
            for stride in [400, 401] {
                let mut target = vec![0.0; 96 * stride];
                let nothing = &mut |_: f32| ControlFlow::Continue(());
                renderer
                    .render_rows(&scene, 0..96, &mut target, stride, nothing)
                    .unwrap();
                let rows = target.chunks(stride).map(|row| row[..400].to_vec());
                images.push(rows.collect::<Vec<_>>());
            }
        }
        assert!(images.windows(2).all(|pair| pair[0] == pair[1]));
        assert!(images[0].iter().flatten().all(|value| *value > 0.0));
    }

    #[test]
    fn an_image_cut_between_tiles_is_the_same_to_the_bit_and_cut_elsewhere_is_not() {
        let mut scene = Table::Torus.scene(160, 64);
        scene.integration.method = Method::Exact;
        let device = discover().devices.swap_remove(0);
        let mut renderer = OpenClRenderer::new(&device, &BuildOptions::default()).unwrap();
        let mut draw = |cut: u32, is_in_place: bool| {
            renderer.writes_in_place = is_in_place;
            let mut target = vec![0.0; 160 * 640];
            let (upper, lower) = target.split_at_mut(cut as usize * 640);
            let nothing = &mut |_: f32| ControlFlow::Continue(());
            for (rows, part) in [(0..cut, upper), (cut..160, lower)] {
                renderer
                    .render_rows(&scene, rows, part, 640, nothing)
                    .unwrap();
            }
            target
        };
        let whole = draw(0, false);
        for cut in [0, grain_rows(&scene), 128, 160] {
            assert!(
                draw(cut, true) == whole && draw(cut, false) == whole,
                "{cut}"
            );
        }
        assert!(draw(60, true) != whole && draw(60, false) != whole);
    }
}
