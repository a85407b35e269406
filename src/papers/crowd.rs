//! The crowds of `energywave bench --table crowd`: points of light that lie evenly in a ball, open or behind boxes.

use glam::DVec3;

use crate::error::Result;
use crate::image::{DepthAlong, DepthImage, ImageSize};
use crate::scene::{Antialias, Camera, Decay, PointList, Points, Profile, Scene};

/// Returns numbers that lie evenly in a cube from -1 to 1: multiples of powers of the root of x^4 = x + 1 (Roberts
/// 2018).
fn even(number: f64) -> DVec3 {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    let share = |power: i32| 2.0 * (number * ROOT.powi(-power)).fract() - 1.0;
    DVec3::new(share(1), share(2), share(3))
}

/// Makes points that lie evenly in a ball of radius 1, seen from 4 away at 1920x1080; the light of all is 2.
///
/// # Errors
/// [`Error::Scene`](crate::Error::Scene) for more than 2^27.
pub fn crowd(count: u32, profile: Profile) -> Result<Scene> {
    let mut number = 0.0;
    let mut place = || loop {
        number += 1.0;
        let place = even(number);
        if place.length_squared() <= 1.0 {
            return place;
        }
    };
    let positions: Vec<DVec3> = (0..count).map(|_| place()).collect();
    let lights = (0..count).map(|k| {
        let warm = (k % 97) as f32 / 97.0;
        [1.0, 0.4 + 0.4 * warm, 0.2 + 0.7 * warm]
    });
    let mut points = Points::new(PointList::with_lights(positions, lights.collect())?);
    points.profile = profile;
    points.coefficient = 2.0 / f64::from(count);
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO));
    scene.camera.ray_length = Some(12.0);
    scene.image = ImageSize {
        width: 1920,
        height: 1080,
    };
    // Single rays, which have a truth.
    scene.integration.antialias = Antialias::None;
    scene.decay = Some(Decay::new(0.1, 0.1));
    scene.points.push(points);
    Ok(scene)
}

/// Returns how far from the eye rays meet boxes that lie evenly in and around the ball of [`crowd`].
///
/// # Errors
/// As [`DepthImage::new`].
pub fn depths_of_boxes(scene: &Scene, count: u32) -> Result<DepthImage> {
    let boxes: Vec<(DVec3, DVec3)> = (0..count)
        .map(|number| {
            let (middle, size) = (even(f64::from(number)), even(f64::from(number) + 0.5));
            let half = 0.12 * size.abs() + 0.03;
            (1.6 * middle - half, 1.6 * middle + half)
        })
        .collect();
    let (plane, size) = (scene.view_plane(), scene.image);
    let length = |index: usize| {
        let ray = plane.ray(index as u32 % size.width, index as u32 / size.width);
        let toward = (ray.origin - plane.eye).normalize();
        let hit = |(low, high): &(DVec3, DVec3)| {
            let (a, b) = ((*low - plane.eye) / toward, (*high - plane.eye) / toward);
            let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
            (enter <= leave && enter > 0.0).then_some(enter)
        };
        let lengths = boxes.iter().filter_map(hit);
        lengths.fold(f64::INFINITY, f64::min) as f32
    };
    DepthImage::new(
        size,
        DepthAlong::Ray,
        (0..size.pixels()).map(length).collect(),
    )
}
