//! 3D images of float32, for kernels that read their texels.

use std::ptr;
use std::sync::Arc;

use opencl3::device::Device;
use opencl3::memory::{
    CL_FLOAT, CL_MEM_OBJECT_IMAGE3D, CL_MEM_READ_ONLY, CL_R, ClMem, Image, cl_image_desc,
    cl_image_format,
};
use opencl3::types::CL_TRUE;

use super::failure::failed;
use super::handle::Handle;
use super::kernel::RawMemory;
use super::{Argument, Compute};
use crate::error::Result;

/// Returns whether a device has images of one channel of this size, texels along x, y and z.
pub(crate) fn has_images(compute: &Compute, size: [u32; 3]) -> bool {
    let device = Device::new(compute.device.handle.id());
    let most = [
        device.image3d_max_width(),
        device.image3d_max_height(),
        device.image3d_max_depth(),
    ];
    let fits = most
        .iter()
        .zip(size)
        .all(|(most, size)| most.as_ref().is_ok_and(|most| size as usize <= *most));
    fits && device.image_support().is_ok_and(|it| it)
}

/// Shared values that never change, as a 3D image of one channel; uploaded when others are given.
#[derive(Debug, Default)]
pub(crate) struct SharedImage {
    image: Option<(Handle<Image>, [u32; 3])>,
    contents: Option<Arc<Vec<f32>>>,
}

impl SharedImage {
    /// Makes the texels these, x fastest, then y, then z, unless they are already; waits for that.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Device`](crate::Error::Device).
    pub(crate) fn upload(
        &mut self,
        compute: &Compute,
        size: [u32; 3],
        values: &Arc<Vec<f32>>,
    ) -> Result<()> {
        let is_there = |there: &Arc<Vec<f32>>| Arc::ptr_eq(there, values);
        if self.contents.as_ref().is_some_and(is_there) {
            return Ok(());
        }
        self.contents = None;
        let name = &compute.device.name;
        let region = size.map(|it| it as usize);
        if region.iter().product::<usize>() != values.len() {
            let wrong = format!("{} texels of {size:?}", values.len());
            return Err(super::failure::fault(name, "clEnqueueWriteImage", wrong));
        }
        let (mut image, _) = match self.image.take() {
            Some(kept) if kept.1 == size => kept,
            _ => (create(compute, region)?, size),
        };
        let (origin, texels) = ([0; 3], values.as_ptr().cast_mut().cast());
        let (queue, region) = (&compute.queue, region.as_ptr());
        // SAFETY: the texels are as many as the image's, and the call blocks.
        unsafe {
            queue.enqueue_write_image(
                &mut image,
                CL_TRUE,
                origin.as_ptr(),
                region,
                0,
                0,
                texels,
                &[],
            )
        }
        .map(Handle::new)
        .map_err(failed(name, "clEnqueueWriteImage"))?;
        self.image = Some((image, size));
        self.contents = Some(Arc::clone(values));
        Ok(())
    }

    /// Returns the image, for kernels; null before the first upload.
    pub(crate) fn argument(&self) -> impl Argument {
        RawMemory(
            self.image
                .as_ref()
                .map_or(ptr::null_mut(), |(image, _)| image.get()),
        )
    }
}

fn create(compute: &Compute, [width, height, depth]: [usize; 3]) -> Result<Handle<Image>> {
    let format = cl_image_format {
        image_channel_order: CL_R,
        image_channel_data_type: CL_FLOAT,
    };
    let description = cl_image_desc {
        image_type: CL_MEM_OBJECT_IMAGE3D,
        image_width: width,
        image_height: height,
        image_depth: depth,
        image_array_size: 0,
        image_row_pitch: 0,
        image_slice_pitch: 0,
        num_mip_levels: 0,
        num_samples: 0,
        buffer: ptr::null_mut(),
    };
    // SAFETY: no host pointer is given.
    unsafe {
        Image::create(
            &compute.context,
            CL_MEM_READ_ONLY,
            &format,
            &description,
            ptr::null_mut(),
        )
    }
    .map(Handle::new)
    .map_err(failed(&compute.device.name, "clCreateImage"))
}
