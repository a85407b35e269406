//! Something that hides light: the tetrahedra of Abe, Watanabe 2010, figures 15-18, as depths.

use glam::DVec3;
use rayon::prelude::*;

use crate::error::Result;
use crate::image::{DepthAlong, DepthImage, ImageSize};
use crate::scene::{Camera, ViewPlane};

/// Where the two tetrahedra stand (2010), and how far their corners are from there, which is not given.
const TETRAHEDRA: [(DVec3, f64); 2] = [(DVec3::ZERO, 80.0), (DVec3::new(10.0, 0.0, 250.0), 18.0)];

/// An apex over a base, at distance 1 from the middle.
const CORNERS: [DVec3; 4] = [
    DVec3::new(0.0, 1.0, 0.0),
    DVec3::new(0.942_809, -0.333_333, 0.0),
    DVec3::new(-0.471_405, -0.333_333, 0.816_497),
    DVec3::new(-0.471_405, -0.333_333, -0.816_497),
];

/// Returns the distance, along each pixel's ray, to the nearer of two tetrahedra; infinite beside them.
///
/// # Errors
/// None for sizes that an image can have.
pub fn tetrahedra(camera: &Camera, size: ImageSize) -> Result<DepthImage> {
    let plane = ViewPlane::new(camera, size, 1.0);
    let faces: Vec<[DVec3; 3]> = TETRAHEDRA
        .into_iter()
        .flat_map(|(place, reach)| {
            let corners = CORNERS.map(|corner| place + reach * corner);
            (0..4).map(move |left_out| {
                [1, 2, 3].map(|step: usize| corners[(left_out + step) % corners.len()])
            })
        })
        .collect();
    let depth = |index: usize| {
        let width = size.width as usize;
        let ray = plane.ray((index % width) as u32, (index / width) as u32);
        let direction = ray.span.normalize();
        let hits = faces
            .iter()
            .filter_map(|face| distance_to(face, plane.eye, direction));
        hits.fold(f64::INFINITY, f64::min) as f32
    };
    let values = (0..size.pixels()).into_par_iter().map(depth).collect();
    DepthImage::new(size, DepthAlong::Ray, values)
}

/// Returns the distance from `origin` to a triangle (Moeller, Trumbore 1997); `None` if the ray misses it.
fn distance_to([a, b, c]: &[DVec3; 3], origin: DVec3, direction: DVec3) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let normal = direction.cross(ac);
    let volume = ab.dot(normal);
    let from_a = origin - a;
    let u = from_a.dot(normal) / volume;
    let turned = from_a.cross(ab);
    let v = direction.dot(turned) / volume;
    let distance = ac.dot(turned) / volume;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_tetrahedron_hides_the_farther_one_and_nothing_the_sky() {
        let camera = super::super::camera_2010();
        let size = ImageSize {
            width: 101,
            height: 101,
        };
        let depths = tetrahedra(&camera, size).unwrap();
        let at = |column: usize, row: usize| depths.as_slice()[row * 101 + column];
        let near = depths.as_slice().iter().filter(|depth| **depth < 120.0);
        let far = depths.as_slice().iter();
        let far = far.filter(|depth| (200.0..500.0).contains(*depth));
        assert!(near.count() > 200 && far.count() > 200);
        assert_eq!(at(0, 0), f32::INFINITY);
        // The near one's apex is seen 18 above its middle, 100 from the eye.
        let apex = |row| at(60, row);
        assert!(
            apex(31) > 120.0 && (apex(34) - 101.0).abs() < 3.0,
            "{}",
            apex(34)
        );
    }
}
