//! A host with an OpenCL context, a queue and targets of its own.
#![allow(unsafe_code)] // hosts call OpenCL
#![allow(deprecated)] // queues as OpenCL 1.2 makes them, which every driver has

use std::ptr;

use energywave::HostTarget;
use energywave::image::ImageSize;
use half::f16;
use opencl3::command_queue::CommandQueue;
use opencl3::context::Context;
use opencl3::device::{CL_DEVICE_TYPE_ALL, Device as ClDevice};
use opencl3::event::Event;
use opencl3::memory::{
    Buffer, CL_FLOAT, CL_HALF_FLOAT, CL_MEM_OBJECT_IMAGE2D, CL_MEM_READ_ONLY, CL_MEM_READ_WRITE,
    CL_RGBA, Image, cl_image_desc, cl_image_format,
};
use opencl3::platform::get_platforms;
use opencl3::types::{CL_TRUE, cl_event, cl_mem};

pub struct Host {
    pub context: Context,
    pub queue: CommandQueue,
}

/// The device under test, as a host finds it.
pub fn device() -> ClDevice {
    let name = super::device().name;
    let platforms = get_platforms().unwrap();
    let devices = platforms
        .iter()
        .flat_map(|platform| platform.get_devices(CL_DEVICE_TYPE_ALL).unwrap());
    devices
        .map(ClDevice::new)
        .find(|device| device.name().unwrap().trim() == name)
        .unwrap()
}

fn queue(context: &Context, properties: u64) -> CommandQueue {
    // SAFETY: the device is the context's.
    unsafe { CommandQueue::create(context, context.default_device(), properties) }.unwrap()
}

impl Host {
    pub fn new(queue_properties: u64) -> Self {
        let context = Context::from_device(&device()).unwrap();
        let queue = queue(&context, queue_properties);
        Self { context, queue }
    }

    /// A second queue, in order.
    pub fn another_queue(&self) -> CommandQueue {
        queue(&self.context, 0)
    }

    pub fn buffer(&self, flags: u64, size: ImageSize) -> Buffer<f32> {
        // SAFETY: no host pointer is given.
        unsafe { Buffer::create(&self.context, flags, 4 * size.pixels(), ptr::null_mut()) }.unwrap()
    }

    pub fn image(&self, size: ImageSize, channel_type: u32) -> Image {
        self.image_of(CL_MEM_READ_WRITE, size, CL_RGBA, channel_type)
    }

    pub fn image_of(&self, flags: u64, size: ImageSize, order: u32, channel_type: u32) -> Image {
        let format = cl_image_format {
            image_channel_order: order,
            image_channel_data_type: channel_type,
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
        // SAFETY: format and description live; no host pointer is given.
        unsafe { Image::create(&self.context, flags, &format, &description, ptr::null_mut()) }
            .unwrap()
    }

    /// A buffer of these values.
    pub fn floats(&self, values: &[f32]) -> Buffer<f32> {
        // SAFETY: no host pointer is given.
        let made = unsafe {
            Buffer::create(
                &self.context,
                CL_MEM_READ_ONLY,
                values.len(),
                ptr::null_mut(),
            )
        };
        let mut buffer = made.unwrap();
        // SAFETY: the write blocks, and the buffer has as many values.
        unsafe {
            self.queue
                .enqueue_write_buffer(&mut buffer, CL_TRUE, 0, values, &[])
        }
        .unwrap();
        buffer
    }

    /// Whether the device reads images of a format.
    pub fn has_format(&self, order: u32, channel_type: u32) -> bool {
        let formats = self
            .context
            .get_supported_image_formats(CL_MEM_READ_ONLY, CL_MEM_OBJECT_IMAGE2D)
            .unwrap();
        formats.iter().any(|format| {
            (format.image_channel_order, format.image_channel_data_type) == (order, channel_type)
        })
    }

    /// An image of these bytes, by rows without gaps.
    pub fn image_with(
        &self,
        size: ImageSize,
        order: u32,
        channel_type: u32,
        bytes: &[u8],
    ) -> Image {
        let mut image = self.image_of(CL_MEM_READ_ONLY, size, order, channel_type);
        assert_eq!(bytes.len(), image.element_size().unwrap() * size.pixels());
        let (origin, region) = ([0; 3], [size.width as usize, size.height as usize, 1]);
        let (origin, region) = (origin.as_ptr(), region.as_ptr());
        let bytes = bytes.as_ptr().cast_mut().cast();
        // SAFETY: the write blocks, and the bytes are as many as the image's.
        let written = unsafe {
            self.queue
                .enqueue_write_image(&mut image, CL_TRUE, origin, region, 0, 0, bytes, &[])
        };
        written.unwrap();
        image
    }

    /// The same image where the host may read it.
    pub fn copy(&self, image: &Image, size: ImageSize, after: &Event) -> Image {
        let mut copy = self.image(size, image.format().unwrap()[0].image_channel_data_type);
        let (origin, region) = ([0; 3], [size.width as usize, size.height as usize, 1]);
        let (origin, region) = (origin.as_ptr(), region.as_ptr());
        // SAFETY: both images have the region.
        let copied = unsafe {
            self.queue
                .enqueue_copy_image(image, &mut copy, origin, origin, region, &[after.get()])
        };
        copied.unwrap().wait().unwrap();
        copy
    }

    /// What a target holds, after some events.
    pub fn read(&self, target: HostTarget, size: ImageSize, after: &[&Event]) -> Vec<f32> {
        let events: Vec<cl_event> = after.iter().map(|event| event.get()).collect();
        match target {
            HostTarget::Buffer(buffer) => {
                let mut values = vec![0.0; 4 * size.pixels()];
                let buffer = Borrowed::new(Buffer::<f32>::new(buffer));
                // SAFETY: the read blocks, and the buffer holds as many values.
                let read = unsafe {
                    self.queue
                        .enqueue_read_buffer(&buffer.0, CL_TRUE, 0, &mut values, &events)
                };
                read.unwrap();
                values
            }
            HostTarget::Image(image) => self.read_image(image, size, &events),
            other => panic!("not read here: {other:?}"),
        }
    }

    fn read_image(&self, image: cl_mem, size: ImageSize, events: &[cl_event]) -> Vec<f32> {
        let image = Borrowed::new(Image::new(image));
        let channel_type = image.0.format().unwrap()[0].image_channel_data_type;
        let (origin, region) = ([0; 3], [size.width as usize, size.height as usize, 1]);
        let read = |values: *mut std::ffi::c_void| {
            // SAFETY: the read blocks, and there is room for all pixels of the type.
            let read = unsafe {
                self.queue.enqueue_read_image(
                    &image.0,
                    CL_TRUE,
                    origin.as_ptr(),
                    region.as_ptr(),
                    0,
                    0,
                    values,
                    events,
                )
            };
            read.unwrap();
        };
        let count = 4 * size.pixels();
        match channel_type {
            CL_FLOAT => {
                let mut values = vec![0.0_f32; count];
                read(values.as_mut_ptr().cast());
                values
            }
            CL_HALF_FLOAT => {
                let mut values = vec![0_u16; count];
                read(values.as_mut_ptr().cast());
                values
                    .into_iter()
                    .map(|bits| f16::from_bits(bits).into())
                    .collect()
            }
            other => panic!("images of type {other:#x} are not read here"),
        }
    }
}

/// An object of opencl3 that is not released.
struct Borrowed<T>(std::mem::ManuallyDrop<T>);

impl<T> Borrowed<T> {
    fn new(object: T) -> Self {
        Self(std::mem::ManuallyDrop::new(object))
    }
}
