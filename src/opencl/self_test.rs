//! The first use of freshly built kernels: a small scene whose light is known from the float64 reference. Drivers have
//! miscompiled kernels; one that does is refused before it draws.

use std::mem;
use std::ptr;

use glam::DVec3;
use half::f16;
use opencl3::memory::{
    CL_FLOAT, CL_MEM_OBJECT_IMAGE2D, CL_MEM_WRITE_ONLY, CL_RGBA, ClMem, Image, cl_image_desc,
    cl_image_format,
};
use opencl3::types::CL_TRUE;

use super::cache::Folder;
use super::failure::failed;
use super::handle::Handle;
use super::kernels::{Film, Rays, Task};
use super::known_scene::known_scene;
use super::launch::Output;
use super::{Compute, DeviceBuffer, OpenClRenderer, ProgramKey};
use crate::error::{Error, Result};
use crate::ray::ViewPlane;
use crate::reference::Tracer;
use crate::scene::{ImageSize, Integration, Scene};

/// The kind of the cache's entries for kernels that were found right.
const TESTED: &str = "tested";

/// Which pixels are compared: every so many, a number that shares no divisor with the width.
const STRIDE: usize = 7;

/// What is allowed at least, relative to the pixel: for Simpson's sum in float32, and for half floats.
const LEAST_LIMIT: f64 = 1e-3;

/// Of so many pixels one may be off by more, but none by ten times as much.
const WORSE: usize = 8;

impl OpenClRenderer {
    /// Tests kernels that were just built, unless that was done on this device before.
    ///
    /// # Errors
    /// [`Error::SelfTest`] if they compute wrong. The kernels are forgotten.
    pub(super) fn self_test(
        &mut self,
        task: Task,
        key: ProgramKey,
        integration: &Integration,
    ) -> Result<()> {
        let device = &self.compute.device;
        // Another rule is somebody's experiment; simulators take minutes.
        if self.options.skips_self_test || self.options.rule.is_some() || device.is_simulator {
            return Ok(());
        }
        let folder = Folder::of_user();
        if folder
            .as_ref()
            .is_some_and(|f| f.read(key, TESTED).is_some())
        {
            return Ok(());
        }
        // On a queue of its own: the renderer's may wait for a host.
        let mut tester = Self::with_compute(self.compute.sibling()?, &self.options);
        mem::swap(&mut tester.kernels, &mut self.kernels);
        let outcome = tester.check(task, &known_scene(task, integration)?);
        mem::swap(&mut tester.kernels, &mut self.kernels);
        match &outcome {
            Ok(()) => {
                if let Some(folder) = folder {
                    let _ = folder.write(key, TESTED, &[]); // else it is tested again
                }
            }
            Err(_) => self.kernels.forget(task),
        }
        outcome
    }

    fn check(&mut self, task: Task, scene: &Scene) -> Result<()> {
        let (found, size) = (self.draw_known(task, scene)?, scene.image);
        let plane = ViewPlane::new(&scene.camera, scene.image);
        let tracer = Tracer::new(scene, scene.integration.method, plane.ray_length);
        let limit = scene.integration.tolerance.max(LEAST_LIMIT);
        let mut worse = 0;
        for (index, pixel) in found.iter().enumerate().step_by(STRIDE) {
            let expected = tracer.pixel(scene, &plane, index);
            let found = DVec3::new(pixel[0].into(), pixel[1].into(), pixel[2].into());
            worse += usize::from(!agrees(found, expected, limit));
            if !agrees(found, expected, 10.0 * limit) || worse * WORSE * STRIDE > size.pixels() {
                let device = &self.compute.device;
                return Err(Error::SelfTest {
                    device: device.name.clone(),
                    driver: format!("{} {}", device.platform, device.driver),
                    reason: format!("pixel {index} of the test is {found:.6}, not {expected:.6}"),
                });
            }
        }
        Ok(())
    }

    /// Pixels of the known scene, by the very kernels of a task.
    fn draw_known(&mut self, task: Task, scene: &Scene) -> Result<Vec<[f32; 4]>> {
        let size = scene.image;
        let mut pixels = vec![[0.0; 4]; size.pixels()];
        match (task.rays, task.film) {
            (Rays::Listed, _) => {
                let plane = ViewPlane::new(&scene.camera, size);
                let index = 0..size.pixels() as u32;
                let ray = |i| plane.ray(i % size.width, i / size.width);
                return self.trace(scene, &index.map(ray).collect::<Vec<_>>());
            }
            (_, Film::Floats) => {
                let values = bytemuck::cast_slice_mut(&mut pixels);
                let nothing = &mut |_: f32| std::ops::ControlFlow::Continue(());
                let stride = 4 * size.width as usize;
                self.render_rows(scene, 0..size.height, values, stride, nothing)?;
            }
            (_, Film::Halves) => {
                let halves = DeviceBuffer::new(&self.compute, "the test", 4 * size.pixels())?;
                self.launch_frame(scene, Output::Halves(halves.handle()))?;
                let mut values = vec![0_u16; halves.len()];
                halves.read(&self.compute, &mut values)?;
                for (channel, bits) in pixels.as_flattened_mut().iter_mut().zip(values) {
                    *channel = f16::from_bits(bits).into();
                }
            }
            (_, Film::Image) => {
                let image = create_image(&self.compute, size)?;
                self.launch_frame(scene, Output::Image(image.get()))?;
                read_image(&self.compute, &image, size, &mut pixels)?;
            }
        }
        Ok(pixels)
    }
}

/// Whether all channels are within the limit, relative to the brightest.
fn agrees(found: DVec3, expected: DVec3, limit: f64) -> bool {
    let allowed = limit * expected.max_element();
    let errors = (found - expected).abs().to_array();
    errors.iter().all(|error| *error <= allowed) // which no NaN is
}

fn create_image(compute: &Compute, size: ImageSize) -> Result<Handle<Image>> {
    let format = cl_image_format {
        image_channel_order: CL_RGBA,
        image_channel_data_type: CL_FLOAT,
    };
    let description = cl_image_desc {
        image_type: CL_MEM_OBJECT_IMAGE2D,
        image_width: size.width as usize,
        image_height: size.height as usize,
        image_depth: 0,
        image_array_size: 0,
        image_row_pitch: 0,
        image_slice_pitch: 0,
        num_mip_levels: 0,
        num_samples: 0,
        buffer: ptr::null_mut(),
    };
    let (context, flags) = (&compute.context, CL_MEM_WRITE_ONLY);
    // SAFETY: no host pointer is given.
    unsafe { Image::create(context, flags, &format, &description, ptr::null_mut()) }
        .map(Handle::new)
        .map_err(failed(&compute.device.name, "clCreateImage"))
}

fn read_image(
    compute: &Compute,
    image: &Image,
    size: ImageSize,
    pixels: &mut [[f32; 4]],
) -> Result<()> {
    let (origin, region) = ([0; 3], [size.width as usize, size.height as usize, 1]);
    let (origin, region, values) = (origin.as_ptr(), region.as_ptr(), pixels.as_mut_ptr().cast());
    let queue = &compute.queue;
    // SAFETY: the pixels are as many as the image's, and the call blocks.
    unsafe { queue.enqueue_read_image(image, CL_TRUE, origin, region, 0, 0, values, &[]) }
        .map(Handle::new)
        .map_err(failed(&compute.device.name, "clEnqueueReadImage"))?;
    Ok(())
}
