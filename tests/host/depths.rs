//! Depths in a host's own buffer or image end rays where the same values in the scene's depth do: in every format, by
//! every meaning, with no bit of difference where the device has float64.
#![allow(unsafe_code)] // hosts call OpenCL

use crate::common::host::Host;
use crate::frames::{Frames, SIZE, difference, image_of, lengths, limit, scene, spoiled};
use energywave::image::{DepthAlong, DepthImage, ImageSize};
use energywave::scene::Sampling;
use energywave::{HostDepth, HostDepthMemory};
use half::f16;
use opencl3::event::{CL_COMPLETE, Event, create_user_event, set_user_event_status};
use opencl3::memory::{
    Buffer, CL_DEPTH, CL_FLOAT, CL_HALF_FLOAT, CL_MEM_HOST_NO_ACCESS, CL_MEM_READ_ONLY,
    CL_MEM_READ_WRITE, CL_R, CL_RGBA, CL_UNORM_INT16, ClMem, Image,
};
use opencl3::types::CL_NON_BLOCKING;

/// The number that stands for a length up to 8.
fn share(length: f32) -> u16 {
    (f64::from(length.min(8.0)) / 8.0 * 65535.0).round() as u16
}

/// The rows from the last to the first.
fn upside_down(values: &[f32]) -> Vec<f32> {
    values.chunks(99).rev().flatten().copied().collect()
}

/// All ways to store values as float32: a buffer, dense or with gaps, upside down, and images.
fn stored_as_floats(host: &Host, values: &[f32]) -> Vec<(String, Kept, HostDepthMemory, bool)> {
    let dense = host.floats(values);
    let (mut gaps, pitch, before) = (vec![-7.0; 13], 128, 13);
    for row in values.chunks(99) {
        gaps.extend(row);
        gaps.resize(gaps.len() + pitch - row.len(), -7.0);
    }
    gaps.truncate(before + 69 * pitch + 99); // no value more than needed
    let gaps = host.floats(&gaps);
    let place = HostDepthMemory::Buffer {
        buffer: gaps.get(),
        offset: 4 * before,
        row_pitch: 4 * pitch,
    };
    let turned = host.floats(&upside_down(values));
    let (memory, turned_memory) = ((&dense).into(), (&turned).into());
    let mut all = vec![
        ("buffer".to_owned(), Kept::Buffer(dense), memory, false),
        ("gaps".to_owned(), Kept::Buffer(gaps), place, false),
        (
            "turned".to_owned(),
            Kept::Buffer(turned),
            turned_memory,
            true,
        ),
    ];
    for (order, channels) in [(CL_R, 1), (CL_RGBA, 4), (CL_DEPTH, 1)] {
        if !host.has_format(order, CL_FLOAT) {
            assert!(order != CL_RGBA, "every device has float32 RGBA");
            continue;
        }
        for is_bottom_up in [false, true] {
            let stored = if is_bottom_up {
                upside_down(values)
            } else {
                values.to_vec()
            };
            let bytes = channels_of(&stored, channels, |value| value.to_le_bytes());
            let image = host.image_with(SIZE, order, CL_FLOAT, &bytes);
            let memory = (&image).into();
            let name = format!("image {order:#x}, {is_bottom_up}");
            all.push((name, Kept::Image(image), memory, is_bottom_up));
        }
    }
    all
}

/// Keeps memory of the host's alive.
enum Kept {
    Buffer(#[allow(dead_code)] Buffer<f32>),
    Image(#[allow(dead_code)] Image),
}

/// Values as the first of so many channels, in little-endian bytes.
fn channels_of<const LEN: usize>(
    values: &[f32],
    channels: usize,
    bytes: impl Fn(f32) -> [u8; LEN],
) -> Vec<u8> {
    let pixel = |value: &f32| {
        let mut pixel = bytes(*value).to_vec();
        pixel.extend(std::iter::repeat_n(bytes(0.5), channels - 1).flatten());
        pixel
    };
    values.iter().flat_map(pixel).collect()
}

#[test]
fn lengths_in_any_memory_give_the_picture_of_the_scenes_depth() {
    let mut frames = Frames::new();
    let values = lengths();
    for sampling in [Sampling::Pixels, Sampling::Tiles] {
        let scene = scene(sampling);
        let open = frames.renderer.render(&scene).unwrap();
        for along in [DepthAlong::Ray, DepthAlong::Axis] {
            let expected = frames.expected(&scene, image_of(&values, along));
            for (name, _kept, memory, is_bottom_up) in stored_as_floats(&frames.host, &values) {
                let what = format!("{sampling:?}, {along:?}, {name}");
                let mut depth = HostDepth::new(memory, along);
                depth.is_bottom_up = is_bottom_up;
                let found = frames.behind(&scene, &depth);
                assert_eq!(difference(&found, &expected), 0.0, "{what}");
                assert!(difference(&found, &open) > 0.5, "{what}: hides nothing");
                depth.is_bottom_up = !is_bottom_up;
                let found = frames.behind(&scene, &depth);
                assert!(difference(&found, &expected) > 0.1, "{what}: up is down");
                depth.is_bottom_up = is_bottom_up;
                depth.along = match along {
                    DepthAlong::Ray => DepthAlong::Axis,
                    _ => DepthAlong::Ray,
                };
                let found = frames.behind(&scene, &depth);
                assert!(
                    difference(&found, &expected) > 1e-3,
                    "{what}: along another"
                );
            }
        }
    }
}

#[test]
fn a_depth_one_pixel_aside_gives_another_picture() {
    let mut frames = Frames::new();
    let scene = scene(Sampling::Pixels);
    let values = lengths();
    let expected = frames.expected(&scene, image_of(&values, DepthAlong::Ray));
    let buffer = frames.host.floats(&[&values[..], &[3.0]].concat());
    let mut memory = HostDepthMemory::from(&buffer);
    if let HostDepthMemory::Buffer { offset, .. } = &mut memory {
        *offset = 4;
    }
    let found = frames.behind(&scene, &HostDepth::new(memory, DepthAlong::Ray));
    assert!(difference(&found, &expected) > 1e-3);
}

#[test]
fn halves_and_shares_give_the_picture_of_what_they_stand_for() {
    let mut frames = Frames::new();
    let scene = scene(Sampling::Tiles);
    let halves = |value: &f32| f32::from(f16::from_f32(*value));
    let shares = |value: &f32| ((f64::from(share(*value)) / 65535.0) as f32) * 8.0;
    let stored: [(u32, f64, Vec<f32>, Encode); 2] = [
        (
            CL_HALF_FLOAT,
            1.0,
            lengths().iter().map(halves).collect(),
            |value| f16::from_f32(value).to_bits().to_le_bytes(),
        ),
        (
            CL_UNORM_INT16,
            8.0,
            lengths().iter().map(shares).collect(),
            |value| share(value).to_le_bytes(),
        ),
    ];
    let mut count = 0;
    for (kind, scale, values, encode) in stored {
        let expected = frames.expected(&scene, image_of(&values, DepthAlong::Axis));
        for (order, channels) in [(CL_R, 1), (CL_RGBA, 4), (CL_DEPTH, 1)] {
            if !frames.host.has_format(order, kind) {
                continue;
            }
            let bytes = channels_of(&lengths(), channels, encode);
            let image = frames.host.image_with(SIZE, order, kind, &bytes);
            let mut depth = HostDepth::new(&image, DepthAlong::Axis);
            depth.scale = scale;
            let found = frames.behind(&scene, &depth);
            let what = format!("order {order:#x}, type {kind:#x}");
            assert!(difference(&found, &expected) <= limit(), "{what}");
            depth.scale *= 1.001;
            let found = frames.behind(&scene, &depth);
            assert!(difference(&found, &expected) > 1e-4, "{what}: any scale");
            count += 1;
        }
    }
    assert!(count >= 2, "every device has both types of RGBA");
}

type Encode = fn(f32) -> [u8; 2];

#[test]
fn what_the_scene_would_refuse_hides_nothing() {
    let mut frames = Frames::new();
    let scene = scene(Sampling::Tiles);
    let (nan, infinity) = (f32::NAN, f32::INFINITY);
    let values = spoiled(&lengths(), &[nan, -1.0, -infinity, -1e-30]);
    assert!(energywave::image::DepthImage::new(SIZE, DepthAlong::Ray, values.clone()).is_err());
    let expected = image_of(&spoiled(&lengths(), &[infinity]), DepthAlong::Ray);
    let expected = frames.expected(&scene, expected);
    let buffer = frames.host.floats(&values);
    let found = frames.behind(&scene, &HostDepth::new(&buffer, DepthAlong::Ray));
    assert_eq!(difference(&found, &expected), 0.0);
    let unspoiled = frames.expected(&scene, image_of(&lengths(), DepthAlong::Ray));
    assert!(difference(&found, &unspoiled) > 0.1);
}

#[test]
fn every_frame_has_the_depths_of_its_time() {
    let mut frames = Frames::new();
    let scene = scene(Sampling::Tiles);
    let steps = [0.0_f32, 0.4, -0.3];
    let values = steps.map(|step| {
        lengths()
            .iter()
            .map(|value| value + step.max(-value))
            .collect()
    });
    let values: [Vec<f32>; 3] = values;
    let targets = steps.map(|_| frames.host.buffer(CL_MEM_READ_WRITE, SIZE));
    let flags = CL_MEM_READ_ONLY | CL_MEM_HOST_NO_ACCESS;
    let (mut depths, copies) = (
        frames.host.buffer(flags, SIZE),
        values.each_ref().map(|values| frames.host.floats(values)),
    );
    let depth = HostDepth::new(&depths, DepthAlong::Axis);
    let mut events: Vec<Event> = Vec::new();
    for (from, target) in copies.iter().zip(&targets) {
        // The host's own commands, on its queue; nobody waits for them.
        // SAFETY: all of it lives until the reads below are over.
        events.push(unsafe {
            let bytes = 4 * SIZE.pixels();
            let queue = &frames.host.queue;
            queue
                .enqueue_copy_buffer(from, &mut depths, 0, 0, bytes, &[])
                .unwrap();
            let renderer = &mut frames.renderer;
            renderer
                .enqueue_behind(&scene, target.into(), &depth, &[])
                .unwrap()
        });
    }
    for (event, (target, values)) in events.iter().zip(targets.iter().zip(&values)) {
        let found = frames.host.read(target.into(), SIZE, &[event]);
        let expected = frames.expected(&scene, image_of(values, DepthAlong::Axis));
        assert_eq!(difference(&found, &expected), 0.0);
    }
    // Neither a frame without depths nor one with the scene's own sees the host's.
    let target = (&frames.target).into();
    // SAFETY: the target lives until it has been read.
    let event = unsafe { frames.renderer.enqueue(&scene, target, &[]) }.unwrap();
    let found = frames.host.read(target, SIZE, &[&event]);
    assert_eq!(
        difference(&found, &frames.renderer.render(&scene).unwrap()),
        0.0
    );
    let mut own = scene.clone();
    own.depth = Some(image_of(&values[1], DepthAlong::Ray));
    // SAFETY: as before.
    let event = unsafe { frames.renderer.enqueue(&own, target, &[]) }.unwrap();
    let found = frames.host.read(target, SIZE, &[&event]);
    assert_eq!(
        difference(&found, &frames.renderer.render(&own).unwrap()),
        0.0
    );
    let fine = ImageSize {
        width: 2 * SIZE.width,
        height: 2 * SIZE.height,
    };
    let value = |pixel: usize| [3.8, f32::INFINITY][pixel % 2];
    let depths = (0..fine.pixels()).map(value).collect();
    // Finer than pixels, they are the mean of what is seen before each.
    own.depth = Some(DepthImage::new(fine, DepthAlong::Ray, depths).unwrap());
    // SAFETY: as before.
    let event = unsafe { frames.renderer.enqueue(&own, target, &[]) }.unwrap();
    let found = frames.host.read(target, SIZE, &[&event]);
    let fine = frames.renderer.render(&own).unwrap();
    assert!(difference(&found, &fine) < 1e-6);
    own.depth = Some(image_of(&values[1], DepthAlong::Ray));
    let coarse = frames.renderer.render(&own).unwrap();
    assert!(difference(&found, &coarse) > 1e-2);
}

#[test]
fn depths_that_another_queue_writes_are_waited_for() {
    let mut frames = Frames::new();
    let scene = scene(Sampling::Pixels);
    let expected = frames.expected(&scene, image_of(&lengths(), DepthAlong::Ray));
    let mut buffer = frames.host.floats(&vec![f32::INFINITY; SIZE.pixels()]);
    let depth = HostDepth::new(&buffer, DepthAlong::Ray);
    let open = frames.renderer.render(&scene).unwrap();
    let before = frames.behind(&scene, &depth);
    assert!(difference(&before, &expected) > 0.1 && difference(&before, &open) == 0.0);

    let other = frames.host.another_queue();
    let gate = Event::new(create_user_event(frames.host.context.get()).unwrap());
    let (values, waits) = (lengths(), [gate.get()]);
    let target = (&frames.target).into();
    // SAFETY: the values, the depths and the target live until the read below is over.
    let drawn = unsafe {
        let written = other.enqueue_write_buffer(&mut buffer, CL_NON_BLOCKING, 0, &values, &waits);
        let written = written.unwrap();
        other.flush().unwrap();
        let renderer = &mut frames.renderer;
        renderer.enqueue_behind(&scene, target, &depth, &[written.get()])
    };
    let drawn = drawn.unwrap();
    std::thread::sleep(std::time::Duration::from_millis(50));
    assert!(drawn.command_execution_status().unwrap().0 > CL_COMPLETE);
    set_user_event_status(gate.get(), CL_COMPLETE).unwrap();
    let found = frames.host.read(target, SIZE, &[&drawn]);
    assert_eq!(difference(&found, &expected), 0.0);
}
