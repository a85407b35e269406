//! Images of OpenCL: made, read and mapped.

use std::ffi::c_void;
use std::ptr;

use opencl3::event::Event;
use opencl3::memory::{
    CL_FLOAT, CL_MAP_WRITE_INVALIDATE_REGION, CL_MEM_OBJECT_IMAGE2D, CL_MEM_WRITE_ONLY, CL_RGBA,
    Image, cl_image_desc, cl_image_format,
};
use opencl3::types::{CL_FALSE, CL_TRUE, cl_mem};

use super::failure::failed;
use super::handle::Handle;
use super::{Compute, Pixel};
use crate::error::Result;

/// Makes an image of float32 RGBA that kernels write.
pub(super) fn create_image(compute: &Compute, width: u32, height: u32) -> Result<Handle<Image>> {
    let format = cl_image_format {
        image_channel_order: CL_RGBA,
        image_channel_data_type: CL_FLOAT,
    };
    let description = cl_image_desc {
        image_type: CL_MEM_OBJECT_IMAGE2D,
        image_width: width as usize,
        image_height: height as usize,
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

/// Reads a whole image of float32 RGBA and waits for it.
pub(super) fn read_image(compute: &Compute, image: &Image, pixels: &mut [Pixel]) -> Result<()> {
    let name = &compute.device.name;
    let width = image.width().map_err(failed(name, "clGetImageInfo"))?;
    let height = image.height().map_err(failed(name, "clGetImageInfo"))?;
    if width * height != pixels.len() {
        return Err(super::failure::fault(
            name,
            "clEnqueueReadImage",
            format!("{} pixels of {width}x{height}", pixels.len()),
        ));
    }
    let (origin, region) = ([0; 3], [width, height, 1]);
    let (origin, region, values) = (origin.as_ptr(), region.as_ptr(), pixels.as_mut_ptr().cast());
    let queue = &compute.queue;
    // SAFETY: the pixels are as many as the image's, and the call blocks.
    unsafe { queue.enqueue_read_image(image, CL_TRUE, origin, region, 0, 0, values, &[]) }
        .map(Handle::new)
        .map_err(failed(name, "clEnqueueReadImage"))?;
    Ok(())
}

/// Maps a whole image for writing by commands that come after this one, and returns where its first row is and the
/// bytes from there to the second.
pub(super) fn enqueue_map(
    compute: &Compute,
    image: &Image,
    (width, height): (u32, u32),
    events: &mut Vec<Handle<Event>>,
) -> Result<(*mut c_void, usize)> {
    let (mut pointer, mut pitch) = (ptr::null_mut(), 0);
    let (origin, region) = ([0; 3], [width as usize, height as usize, 1]);
    // SAFETY: the region is the whole image; the pointer is used by commands that come after this one.
    let event = unsafe {
        compute.queue.enqueue_map_image(
            image,
            CL_FALSE,
            CL_MAP_WRITE_INVALIDATE_REGION,
            origin.as_ptr(),
            region.as_ptr(),
            &raw mut pitch,
            ptr::null_mut(),
            &mut pointer,
            &[],
        )
    }
    .map(Handle::new)
    .map_err(failed(&compute.device.name, "clEnqueueMapImage"))?;
    events.push(event);
    Ok((pointer, pitch))
}

/// Ends a mapping, after what was enqueued.
pub(super) fn enqueue_unmap(
    compute: &Compute,
    memory: cl_mem,
    pointer: *mut c_void,
    events: &mut Vec<Handle<Event>>,
) -> Result<()> {
    // SAFETY: the memory is mapped there, and nobody uses the pointer after this.
    let event = unsafe { compute.queue.enqueue_unmap_mem_object(memory, pointer, &[]) }
        .map(Handle::new)
        .map_err(failed(&compute.device.name, "clEnqueueUnmapMemObject"))?;
    events.push(event);
    Ok(())
}
