//! A particle system of a host: a million sparks that turn about a core, in the host's own OpenCL buffers. The host
//! makes their places and lights there anew for every frame, and they are drawn from there as a crowd. Leaves three
//! frames in the folder given, and says how long each took: to move all sparks, and to draw them.
//!
//! `cargo run --release --example sparks -- FOLDER [NUMBER OF SPARKS]`
#![allow(unsafe_code)] // hosts call OpenCL

use std::path::PathBuf;
use std::time::Instant;
use std::{error, ptr, slice};

use energywave::image::{Exposure, ImageSize, ToneMap};
use energywave::scene::{Antialias, Camera, Profile};
use energywave::{HostPoints, RadianceImage, Renderer, Scene};
use glam::DVec3;
use opencl3::command_queue::CommandQueue;
use opencl3::context::Context;
use opencl3::device::{CL_DEVICE_TYPE_ALL, Device, get_all_devices};
use opencl3::memory::{
    Buffer, CL_MAP_WRITE_INVALIDATE_REGION, CL_MEM_ALLOC_HOST_PTR, CL_MEM_READ_WRITE, ClMem,
};
use opencl3::types::CL_TRUE;

const SIZE: ImageSize = ImageSize {
    width: 960,
    height: 540,
};

/// Four float32: what kernels know as float4.
type Row = [f32; 4];

/// Returns where a spark is, and its light: linear RGB.
fn spark(number: usize, count: usize, time: f64) -> (Row, Row) {
    // Multiples of irrational numbers lie evenly.
    let share = |step: f64| (number as f64 * step).fract();
    let radius = 2.2 * (number as f64 + 0.5) / count as f64;
    let arm = std::f64::consts::PI * (number % 2) as f64 + 2.0 * radius;
    let turn = arm + 1.6 * (share(0.618_034) - 0.5) / (0.3 + radius) + time / (0.2 + radius);
    let height = 0.15 * (share(0.414_214) - 0.5) * (1.0 - 0.3 * radius);
    let heat = 1.0 / (1.0 + 3.0 * radius * radius) as f32;
    let (sine, cosine) = turn.sin_cos();
    let place = [radius * cosine, radius * sine, height, 0.0].map(|it| it as f32);
    (place, [0.25 + heat, 0.35 + 0.6 * heat, 1.0, 0.0])
}

/// What the host has of its sparks.
struct Sparks {
    positions: Buffer<Row>,
    lights: Buffer<Row>,
    count: usize,
}

impl Sparks {
    fn new(context: &Context, count: usize) -> Result<Self, Box<dyn error::Error>> {
        let flags = CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR;
        // SAFETY: no host pointer is given.
        let buffer = || unsafe { Buffer::create(context, flags, count, ptr::null_mut()) };
        Ok(Self {
            positions: buffer()?,
            lights: buffer()?,
            count,
        })
    }

    /// Moves them. Here the host's processor does that, in place; kernels of its own would do, too.
    fn turn(&mut self, queue: &CommandQueue, time: f64) -> Result<(), Box<dyn error::Error>> {
        let places = map(queue, &self.positions, self.count)?;
        let lights = map(queue, &self.lights, self.count)?;
        // SAFETY: both are mapped, of so many rows, and nobody else looks there.
        let rows = unsafe {
            let places = slice::from_raw_parts_mut(places, self.count);
            places
                .iter_mut()
                .zip(slice::from_raw_parts_mut(lights, self.count))
        };
        for (number, (place, light)) in rows.enumerate() {
            (*place, *light) = spark(number, self.count, time);
        }
        // SAFETY: the pointers came from the mappings, and are not used any more.
        unsafe {
            queue.enqueue_unmap_mem_object(self.positions.get(), places.cast(), &[])?;
            queue.enqueue_unmap_mem_object(self.lights.get(), lights.cast(), &[])?;
        }
        Ok(())
    }
}

/// Maps rows to be written.
fn map(
    queue: &CommandQueue,
    buffer: &Buffer<Row>,
    count: usize,
) -> Result<*mut Row, Box<dyn error::Error>> {
    let (mut pointer, bytes) = (ptr::null_mut(), count * size_of::<Row>());
    let flags = CL_MAP_WRITE_INVALIDATE_REGION;
    // SAFETY: the buffer has so many bytes.
    unsafe { queue.enqueue_map_buffer(buffer, CL_TRUE, flags, 0, bytes, &mut pointer, &[]) }?;
    Ok(pointer.cast())
}

fn main() -> Result<(), Box<dyn error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().unwrap_or_default());
    let count = arguments.next().and_then(|it| it.parse().ok());
    let count: usize = count.unwrap_or(1_000_000);

    // What every host has anyway.
    let device = get_all_devices(CL_DEVICE_TYPE_ALL)?
        .into_iter()
        .next()
        .ok_or("no OpenCL device")?;
    let context = Context::from_device(&Device::new(device))?;
    #[allow(deprecated)] // as OpenCL 1.2 makes queues, which every driver has
    // SAFETY: the device is the context's.
    let queue = unsafe { CommandQueue::create(&context, device, 0) }?;
    let mut sparks = Sparks::new(&context, count)?;
    // SAFETY: no host pointer is given.
    let target = unsafe {
        Buffer::<f32>::create(
            &context,
            CL_MEM_READ_WRITE,
            4 * SIZE.pixels(),
            ptr::null_mut(),
        )
    }?;

    let mut renderer = Renderer::on_host(&context, &queue)?;
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.5, 2.6), DVec3::ZERO));
    scene.image = SIZE;
    // A pixel has many sparks: what a single ray sees of them is as good as a mean over the pixel, and sooner there.
    scene.integration.antialias = Antialias::None;
    // All that light together is a veil: dark enough, only the arms and the core are left.
    scene.display.exposure = Exposure::Stops(-4.6);
    scene.display.tone_map = ToneMap::Aces;
    let mut points = HostPoints::new(sparks.positions.get(), count);
    points.lights = Some(sparks.lights.get());
    points.profile = Profile::InverseSquare;
    points.coefficient = 1.0 / count as f64;
    for frame in 0..3 {
        let begun = Instant::now();
        sparks.turn(&queue, 0.04 * f64::from(frame))?;
        let moved = begun.elapsed().as_secs_f64();
        // SAFETY: all buffers are alive, and nothing writes the sparks until the call returns, nor uses the target
        // until it is read, which waits for the frame: the queue is in order.
        unsafe {
            let points = slice::from_ref(&points);
            renderer.enqueue_points(&scene, (&target).into(), points, None, &[])?;
        }
        let mut radiance = RadianceImage::new(SIZE)?;
        // SAFETY: there is room for all values, and the call blocks.
        unsafe { queue.enqueue_read_buffer(&target, CL_TRUE, 0, radiance.as_mut_slice(), &[]) }?;
        let taken = begun.elapsed().as_secs_f64();
        let [moved, drawn] = [moved, taken - moved].map(|seconds| 1e3 * seconds);
        println!("frame {frame}: {count} sparks moved in {moved:.0} ms, drawn in {drawn:.0} ms");
        radiance.save(folder.join(format!("sparks-{frame}.png")), &scene.display)?;
    }
    Ok(())
}
