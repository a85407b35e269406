//! Points in a host's own buffers give the picture that the same points give as a list, with no bit of difference.
#![allow(unsafe_code)] // hosts call OpenCL

use crate::common::host::Host;
use crate::frames::{Frames, SIZE, lengths};
use energywave::image::DepthAlong;
use energywave::scene::{Antialias, Camera, Crowd, PointList, Points, Profile};
use energywave::{Error, HostDepth, HostPoints, Scene};
use fastrand::Rng;
use glam::DVec3;
use opencl3::event::{CL_COMPLETE, Event, create_user_event, set_user_event_status};
use opencl3::memory::{Buffer, CL_MEM_HOST_NO_ACCESS, CL_MEM_READ_WRITE, ClMem};
use opencl3::types::CL_TRUE;

/// So many are a crowd.
const COUNT: usize = 700;

/// Points as a host has them, some of which are drawn by themselves: about the projection plane, and a bright one.
fn rows(seed: u64) -> [Vec<f32>; 2] {
    let mut rng = Rng::with_seed(seed);
    let mut row = |low: f32, high: f32, fourth: f32| {
        let mut share = || low + (high - low) * rng.f32();
        [share(), share(), share(), fourth]
    };
    let positions = (0..COUNT).flat_map(|_| row(-2.5, 2.5, f32::NAN));
    let positions = positions.collect();
    let mut lights: Vec<f32> = (0..COUNT).flat_map(|_| row(0.2, 1.0, -7.0)).collect();
    lights[4 * 17] = 90.0;
    [positions, lights]
}

fn scene() -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.3, -4.0, 0.5), DVec3::ZERO));
    scene.image = SIZE;
    scene.integration.antialias = Antialias::None;
    scene
}

/// Adds the same points as a list.
fn listed(scene: &Scene, [positions, lights]: &[Vec<f32>; 2], profile: Profile) -> Scene {
    let place = |row: &[f32]| DVec3::new(row[0].into(), row[1].into(), row[2].into());
    let positions = positions.chunks(4).map(place).collect();
    let lights = lights.chunks(4).map(|row| [row[0], row[1], row[2]]);
    let list = PointList::with_lights(positions, lights.collect()).unwrap();
    let mut points = Points::new(list);
    (points.coefficient, points.profile) = (1e-3, profile);
    let mut scene = scene.clone();
    scene.points.push(points);
    scene
}

/// Keeps a host's points.
struct Kept([Buffer<f32>; 2]);

impl Kept {
    fn new(host: &Host, rows: &[Vec<f32>; 2]) -> Self {
        Self([host.floats(&rows[0]), host.floats(&rows[1])])
    }

    fn points(&self, profile: Profile) -> HostPoints {
        let mut points = HostPoints::new(self.0[0].get(), COUNT);
        points.lights = Some(self.0[1].get());
        (points.coefficient, points.profile) = (1e-3, profile);
        points
    }
}

impl Frames {
    fn with_points(
        &mut self,
        scene: &Scene,
        points: &[HostPoints],
        depth: Option<&HostDepth>,
    ) -> energywave::Result<Vec<f32>> {
        let target = (&self.target).into();
        // SAFETY: target, points and depths live until the read is over.
        let event = unsafe {
            self.renderer
                .enqueue_points(scene, target, points, depth, &[])
        }?;
        Ok(self.host.read(target, SIZE, &[&event]))
    }
}

#[test]
fn trails_in_a_hosts_buffers_are_those_of_a_list_to_the_bit() {
    let mut frames = Frames::new();
    let (scene, rows, [before, _]) = (scene(), rows(3), rows(5));
    let kept = Kept::new(&frames.host, &rows);
    let previous = frames.host.floats(&before);
    let mut points = [kept.points(Profile::Inverse)];
    points[0].previous = Some(previous.get());
    let found = frames.with_points(&scene, &points, None).unwrap();
    let mut listed = listed(&scene, &rows, Profile::Inverse);
    let resting = frames.renderer.render(&listed).unwrap();
    assert_ne!(found, resting.as_slice(), "trails are of no account");
    let place = |row: &[f32]| DVec3::new(row[0].into(), row[1].into(), row[2].into());
    let list = listed.points[0].points.clone();
    let moved = list.with_previous(before.chunks(4).map(place).collect());
    listed.points[0].points = moved.unwrap();
    let expected = frames.renderer.render(&listed).unwrap();
    assert_eq!(found, expected.as_slice());
}

#[test]
fn points_in_a_hosts_buffers_are_those_of_a_list_to_the_bit() {
    let mut frames = Frames::new();
    let scene = scene();
    let first = rows(3);
    let mut kept = Kept::new(&frames.host, &first);
    for profile in [Profile::Inverse, Profile::InverseSquare] {
        let points = [kept.points(profile)];
        let expected = frames
            .renderer
            .render(&listed(&scene, &first, profile))
            .unwrap();
        let found = frames.with_points(&scene, &points, None).unwrap();
        assert_eq!(found, expected.as_slice(), "{profile:?}");
        let mut apart = listed(&scene, &first, profile);
        apart.integration.crowd = Crowd::Never;
        let apart = frames.renderer.render(&apart).unwrap();
        assert_ne!(found, apart.as_slice(), "no crowd was drawn");
    }
    // The host moves them in place, and the next frame shows that.
    let second = rows(4);
    for (buffer, rows) in kept.0.iter_mut().zip(&second) {
        let queue = &frames.host.queue;
        // SAFETY: the write blocks, and the buffer has as many values.
        unsafe { queue.enqueue_write_buffer(buffer, CL_TRUE, 0, rows, &[]) }.unwrap();
    }
    let profile = Profile::InverseSquare;
    let points = [kept.points(profile)];
    let found = frames.with_points(&scene, &points, None).unwrap();
    let expected = frames
        .renderer
        .render(&listed(&scene, &second, profile))
        .unwrap();
    let before = frames
        .renderer
        .render(&listed(&scene, &first, profile))
        .unwrap();
    assert_eq!(found, expected.as_slice());
    assert_ne!(found, before.as_slice());
}

#[test]
fn points_and_depths_of_a_host_are_those_of_a_list_to_the_bit() {
    let mut frames = Frames::new();
    let (scene, rows) = (scene(), rows(5));
    let kept = Kept::new(&frames.host, &rows);
    let depths = frames.host.floats(&lengths());
    let depth = HostDepth::new(&depths, DepthAlong::Ray);
    let profile = Profile::Inverse;
    let expected = frames.behind(&listed(&scene, &rows, profile), &depth);
    let points = [kept.points(profile)];
    let found = frames.with_points(&scene, &points, Some(&depth)).unwrap();
    assert_eq!(found, expected);
    let whole = frames.with_points(&scene, &points, None).unwrap();
    assert_ne!(found, whole);
}

#[test]
fn points_are_read_after_the_events_of_the_wait_list() {
    let mut frames = Frames::new();
    let (scene, first, second) = (scene(), rows(6), rows(7));
    let mut kept = Kept::new(&frames.host, &first);
    let start = create_user_event(frames.host.context.get()).unwrap();
    let start = Event::new(start);
    let other = frames.host.another_queue();
    // SAFETY: the rows live until the frame is read, which waits for the write.
    let written =
        unsafe { other.enqueue_write_buffer(&mut kept.0[0], 0, 0, &second[0], &[start.get()]) }
            .unwrap();
    other.flush().unwrap();
    let handle = start.get() as usize;
    let starter = std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_millis(30));
        set_user_event_status(handle as *mut _, CL_COMPLETE).unwrap();
    });
    let (target, profile) = ((&frames.target).into(), Profile::Inverse);
    let points = [kept.points(profile)];
    let list = [written.get()];
    // SAFETY: all live until the read is over.
    let event = unsafe {
        let renderer = &mut frames.renderer;
        renderer.enqueue_points(&scene, target, &points, None, &list)
    }
    .unwrap();
    starter.join().unwrap();
    let found = frames.host.read(target, SIZE, &[&event]);
    let moved = [second[0].clone(), first[1].clone()];
    let expected = frames
        .renderer
        .render(&listed(&scene, &moved, profile))
        .unwrap();
    assert_eq!(found, expected.as_slice());
}

#[test]
fn points_that_do_not_fit_are_refused_with_a_reason() {
    let mut frames = Frames::new();
    let (scene, right) = (scene(), rows(8));
    let kept = Kept::new(&frames.host, &right);
    let mut reason = |points: HostPoints| match frames.with_points(&scene, &[points], None) {
        Err(Error::Host { object, reason, .. }) => format!("{object}: {reason}"),
        other => panic!("{other:?}"),
    };
    let good = || kept.points(Profile::Inverse);
    let mut more = good();
    more.count = COUNT + 1;
    let bytes = 16 * COUNT;
    assert_eq!(
        reason(more),
        format!("positions of points: {bytes} bytes; 701 points need 16 each")
    );
    let mut none = good();
    none.positions = std::ptr::null_mut();
    assert_eq!(reason(none), "positions of points: null");
    let host = Host::new(0);
    let foreign = host.floats(&right[1]);
    let mut other = good();
    other.lights = Some(foreign.get());
    assert_eq!(
        reason(other),
        "lights of points: it belongs to another context"
    );
    for (which, index, words) in [
        (0, 4 * 5 + 1, "points: point 5 is at"),
        (1, 4 * 699 + 2, "points: the light of point 699 is"),
    ] {
        let mut wrong = right.clone();
        wrong[which][index] = f32::NAN;
        let mut frames = Frames::new();
        let kept = Kept::new(&frames.host, &wrong);
        let found = frames.with_points(&scene, &[kept.points(Profile::Inverse)], None);
        let said = found.unwrap_err().to_string();
        assert!(said.contains(words), "{said}");
    }
    let mut frames = Frames::new();
    let unread = CL_MEM_READ_WRITE | CL_MEM_HOST_NO_ACCESS;
    // SAFETY: no host pointer is given.
    let unread = unsafe {
        Buffer::<f32>::create(
            &frames.host.context,
            unread,
            4 * COUNT,
            std::ptr::null_mut(),
        )
    }
    .unwrap();
    let found = frames.with_points(&scene, &[HostPoints::new(unread.get(), COUNT)], None);
    let said = found.unwrap_err().to_string();
    assert!(said.contains("CL_MEM_HOST_NO_ACCESS"), "{said}");
    let mut wrong = HostPoints::new(kept.0[0].get(), 0);
    wrong.profile = Profile::Gaussian;
    let mut frames = Frames::new();
    let kept = Kept::new(&frames.host, &right);
    wrong.positions = kept.0[0].get();
    let found = frames.with_points(&scene, &[wrong], None);
    let said = found.unwrap_err().to_string();
    assert!(said.contains("\"inverse-square\""), "{said}");
}
