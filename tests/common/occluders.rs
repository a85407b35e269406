//! What hides light in the tests: distances from the eye.

use energywave::Scene;
use glam::DVec3;

/// Distances, from the eye, of what a scene holds besides light.
pub type Occluder = fn(DVec3, &Scene) -> f64;

fn to_ball(direction: DVec3, scene: &Scene, center: DVec3, radius: f64) -> f64 {
    let from_eye = center - scene.camera.eye;
    let ahead = from_eye.dot(direction);
    let left = radius * radius - from_eye.cross(direction).length_squared();
    if left > 0.0 && ahead > left.sqrt() {
        ahead - left.sqrt()
    } else {
        f64::INFINITY
    }
}

fn to_plane(direction: DVec3, scene: &Scene, point: DVec3, normal: DVec3) -> f64 {
    let distance = (point - scene.camera.eye).dot(normal) / direction.dot(normal);
    if distance > 0.0 {
        distance
    } else {
        f64::INFINITY
    }
}

/// What a tile's nodes cannot see, or may see too well.
pub const OCCLUDERS: [(&str, Occluder); 7] = [
    ("a ball", |d, s| {
        to_ball(d, s, DVec3::new(0.2, -0.3, 0.1), 0.5)
    }),
    ("a ball of two pixels", |d, s| {
        to_ball(d, s, DVec3::new(0.3, -0.4, 0.2), 0.02)
    }),
    ("a wall through the cores", |d, s| {
        to_plane(d, s, DVec3::ZERO, DVec3::new(0.1, 1.0, 0.2))
    }),
    ("a floor up to the horizon", |d, s| {
        to_plane(d, s, DVec3::new(0.0, 0.0, -0.8), DVec3::Z)
    }),
    ("a wall at the projection plane", |_, s| {
        1.02 * s.camera.near
    }),
    ("a wall and a hole in it", |d, s| {
        let plane = to_plane(d, s, DVec3::new(0.0, -0.5, 0.0), DVec3::Y);
        let ball = to_ball(d, s, DVec3::new(0.4, -0.5, 0.3), 0.2);
        if ball.is_finite() {
            f64::INFINITY
        } else {
            plane
        }
    }),
    ("waves on a wall", |d, s| {
        let plane = to_plane(d, s, DVec3::ZERO, DVec3::Y);
        plane * (1.0 + 0.02 * (80.0 * d.x).sin())
    }),
];
