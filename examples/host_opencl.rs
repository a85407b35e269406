//! A host that owns its OpenCL, such as an engine: waves are drawn on its context and queue into its own image, and
//! nothing is read back until the host does. Draws `host.png` into the folder given.
//!
//! `cargo run --release --example host_opencl -- FOLDER`
//!
//! At the end: behind a depth buffer; the same for a texture of OpenGL and for an image of Vulkan.
#![allow(unsafe_code)] // hosts call OpenCL

use std::path::PathBuf;
use std::{error, ptr};

use energywave::image::{DepthAlong, ImageSize};
use energywave::scene::{Camera, Torus};
use energywave::{HostDepth, HostTarget, RadianceImage, Renderer, Scene};
use glam::DVec3;
use opencl3::command_queue::CommandQueue;
use opencl3::context::Context;
use opencl3::device::{CL_DEVICE_TYPE_ALL, Device, get_all_devices};
use opencl3::event::Event;
use opencl3::memory::{
    CL_FLOAT, CL_MEM_OBJECT_IMAGE2D, CL_MEM_READ_WRITE, CL_RGBA, Image, cl_image_desc,
    cl_image_format,
};
use opencl3::types::{CL_TRUE, cl_mem};

const SIZE: ImageSize = ImageSize {
    width: 320,
    height: 240,
};

fn main() -> Result<(), Box<dyn error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_default());

    // What every host has anyway.
    let device = get_all_devices(CL_DEVICE_TYPE_ALL)?
        .into_iter()
        .next()
        .ok_or("no OpenCL device")?;
    let context = Context::from_device(&Device::new(device))?;
    #[allow(deprecated)] // as OpenCL 1.2 makes queues, which every driver has
    // SAFETY: the device is the context's.
    let queue = unsafe { CommandQueue::create(&context, device, 0) }?;
    let image = host_image(&context)?;

    // Made once: the renderer keeps kernels and buffers from frame to frame, and a reference to context and queue.
    // Hosts in C pass their handles to `Renderer::on_raw_host`.
    let mut renderer = Renderer::on_host(&context, &queue)?;
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 2.0), DVec3::ZERO));
    scene.image = SIZE;
    for step in 0..3 {
        scene.tori = vec![Torus {
            color: DVec3::new(1.0, 0.5, 0.15),
            coefficient: 0.008,
            ..Torus::new(0.7 + 0.15 * f64::from(step))
        }]
        .into();
        // The call returns at once. The frame begins when `wait_list` and what is on the queue before it are over; what
        // the host puts on the queue afterwards finds the image drawn.
        // SAFETY: the image is alive, and nothing else uses it now.
        let drawn = unsafe { renderer.enqueue(&scene, (&image).into(), &[]) }?;
        // Other queues wait for the event; so may the host.
        drawn.wait()?;
    }

    // The host's own use of the image; here it is saved.
    let mut radiance = RadianceImage::new(SIZE)?;
    read(&queue, &image, radiance.as_mut_slice())?;
    radiance.save(folder.join("host.png"), &scene.display)?;
    Ok(())
}

/// Makes an image for linear radiance: four channels of float32. Half floats (`CL_HALF_FLOAT`) would do, too.
fn host_image(context: &Context) -> Result<Image, Box<dyn error::Error>> {
    let format = cl_image_format {
        image_channel_order: CL_RGBA,
        image_channel_data_type: CL_FLOAT,
    };
    let description = cl_image_desc {
        image_type: CL_MEM_OBJECT_IMAGE2D,
        image_width: SIZE.width as usize,
        image_height: SIZE.height as usize,
        image_depth: 0,
        image_array_size: 0,
        image_row_pitch: 0,
        image_slice_pitch: 0,
        num_mip_levels: 0,
        num_samples: 0,
        buffer: ptr::null_mut(),
    };
    let (flags, nothing) = (CL_MEM_READ_WRITE, ptr::null_mut());
    // SAFETY: no host pointer is given.
    Ok(unsafe { Image::create(context, flags, &format, &description, nothing) }?)
}

fn read(
    queue: &CommandQueue,
    image: &Image,
    values: &mut [f32],
) -> Result<(), Box<dyn error::Error>> {
    let (origin, region) = ([0; 3], [SIZE.width as usize, SIZE.height as usize, 1]);
    let (origin, region, values) = (origin.as_ptr(), region.as_ptr(), values.as_mut_ptr().cast());
    // SAFETY: the values are as many as the image's, and the call blocks.
    unsafe { queue.enqueue_read_image(image, CL_TRUE, origin, region, 0, 0, values, &[]) }?;
    Ok(())
}

/// Draws behind what an engine has drawn: its depth buffer is an image of `CL_R` or `CL_DEPTH`, which came to OpenCL as
/// the textures below do, the lowest row first. The scene's camera has the engine's matrices.
///
/// # Safety
/// Both images are alive. Nothing writes the depths, and nothing uses the target, until the returned event is over.
pub unsafe fn draw_behind_depth_buffer(
    renderer: &mut Renderer,
    scene: &Scene,
    depth_buffer: &Image,
    target: &Image,
) -> Result<Event, Box<dyn error::Error>> {
    let matrices = scene.camera.matrices.ok_or("a camera without matrices")?;
    let mut depth = HostDepth::from_clip(depth_buffer, DepthAlong::Buffer, &matrices.clip_depth()?);
    depth.is_bottom_up = true; // as OpenGL draws
    // SAFETY: the caller's promise.
    Ok(unsafe { renderer.enqueue_behind(scene, target.into(), &depth, &[]) }?)
}

/// Draws into a texture of OpenGL. The host makes its context for the GL context's device, with the properties
/// `CL_GL_CONTEXT_KHR` and `CL_GLX_DISPLAY_KHR`, `CL_WGL_HDC_KHR` or `CL_EGL_DISPLAY_KHR`, and the renderer on it, as
/// above. `texture` is what `clCreateFromGLTexture(context, CL_MEM_WRITE_ONLY, GL_TEXTURE_2D, 0, name)` made, once, of
/// a texture of type `GL_RGBA32F` or `GL_RGBA16F` and of the scene's size.
///
/// # Safety
/// `texture` is alive, and the queue is in order. GL has finished with it (`glFinish`, or a fence that was waited for)
/// and does not touch it until the returned event is over.
pub unsafe fn draw_into_gl_texture(
    renderer: &mut Renderer,
    queue: &CommandQueue,
    scene: &Scene,
    texture: cl_mem,
) -> Result<Event, Box<dyn error::Error>> {
    let textures = [texture.cast_const()];
    // SAFETY: the caller's promise, three times.
    unsafe {
        queue.enqueue_acquire_gl_objects(&textures, &[])?;
        // In order: what comes on the queue later waits for the frame. After an error, too, the texture goes back.
        let drawn = renderer.enqueue(scene, HostTarget::Image(texture), &[]);
        let released = queue.enqueue_release_gl_objects(&textures, &[])?;
        queue.flush()?; // or GL may wait forever
        drawn?;
        Ok(released)
    }
}

/// Draws into an image of Vulkan, with `cl_khr_external_memory` and `cl_khr_semaphore`. `image` is what
/// `clCreateImageWithProperties` made, once, of the memory that `vkGetMemoryFdKHR` exported (property
/// `CL_EXTERNAL_MEMORY_HANDLE_OPAQUE_FD_KHR`; format `VK_FORMAT_R32G32B32A32_SFLOAT` or
/// `VK_FORMAT_R16G16B16A16_SFLOAT`); `vulkan_is_done` and `opencl_is_done` are `VkSemaphore`s, imported by
/// `clCreateSemaphoreWithPropertiesKHR`.
///
/// # Safety
/// All are alive, and the queue is in order. Vulkan signals the first semaphore when it has finished with the image,
/// and does not touch the image until the second is signalled.
pub unsafe fn draw_into_vulkan_image(
    renderer: &mut Renderer,
    queue: &CommandQueue,
    scene: &Scene,
    image: cl_mem,
    [vulkan_is_done, opencl_is_done]: [*const std::ffi::c_void; 2],
) -> Result<Event, Box<dyn error::Error>> {
    let images = [image.cast_const()];
    // SAFETY: the caller's promise, five times; binary semaphores have no payload.
    unsafe {
        queue.enqueue_wait_semaphores_khr(&[vulkan_is_done], ptr::null(), &[])?;
        queue.enqueue_acquire_external_mem_objects_khr(&images, &[])?;
        // In order: what comes on the queue later waits for the frame. After an error, too, Vulkan gets its image back.
        let drawn = renderer.enqueue(scene, HostTarget::Image(image), &[]);
        queue.enqueue_release_external_mem_objects_khr(&images, &[])?;
        let done = queue.enqueue_signal_semaphores_khr(&[opencl_is_done], ptr::null(), &[])?;
        queue.flush()?; // or Vulkan may wait forever
        drawn?;
        Ok(done)
    }
}
