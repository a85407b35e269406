//! View rays: `L(s) = (1-s) S + s E` for s in `[0,1]`, one for every pixel (Watanabe, Abe, Konno 2015, eq. 19).

use glam::DVec3;

use super::Camera;
use crate::image::{DepthAlong, ImageSize};

/// A stretch of a view ray, from S (s = 0) to E (s = 1), world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// S, where the integral begins.
    pub origin: DVec3,
    /// E - S.
    pub span: DVec3,
}

impl Ray {
    /// Makes the ray from `start` to `end`.
    #[must_use]
    pub fn between(start: DVec3, end: DVec3) -> Self {
        Self {
            origin: start,
            span: end - start,
        }
    }

    /// Says why float32 devices cannot integrate along this ray; `None`: they can.
    #[must_use]
    pub fn fault(&self) -> Option<&'static str> {
        let is_bounded = |v: DVec3| v.to_array().iter().all(|x| x.abs() <= 1e9);
        if !is_bounded(self.origin) || !is_bounded(self.span) {
            Some("a coordinate beyond 1e9, what float32 devices can integrate")
        } else if self.span.length() < 1e-9 {
            Some("start and end are less than 1e-9 apart")
        } else {
            None
        }
    }

    /// Returns the point L(s).
    #[must_use]
    pub fn at(&self, s: f64) -> DVec3 {
        self.origin + self.span * s
    }

    /// Returns the parameter s of the point of the whole line that is nearest to `point`; it may lie outside `[0,1]`.
    #[must_use]
    pub fn nearest_to(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.span) / self.span.length_squared()
    }
}

/// The projection plane, ready to give every pixel its ray. Row 0 is the top, pixel centres lie at half-integers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewPlane {
    /// The eye, world space.
    pub eye: DVec3,
    /// From the eye to the centre of the pixel in column 0, row 0.
    pub first_pixel: DVec3,
    /// From a pixel to its right neighbour.
    pub column_step: DVec3,
    /// From a pixel to the one below.
    pub row_step: DVec3,
    /// `|E - S|`, world units.
    pub ray_length: f64,
    /// From the eye to the plane, along the direction of view, world units.
    pub near: f64,
}

impl ViewPlane {
    /// Places the plane at distance `camera.near` from the eye, divided into the image's pixels, for rays of a length
    /// ([`Scene::ray_length`](super::Scene::ray_length)).
    #[must_use]
    pub fn new(camera: &Camera, image: ImageSize, ray_length: f64) -> Self {
        let forward = (camera.target - camera.eye).normalize();
        let right = forward.cross(camera.up).normalize();
        let up = right.cross(forward);
        let half_height = camera.near * (camera.fov_y.to_radians() / 2.0).tan();
        let pixel = 2.0 * half_height / f64::from(image.height);
        let middle_column = (f64::from(image.width) - 1.0) / 2.0;
        let middle_row = (f64::from(image.height) - 1.0) / 2.0;
        let column_step = right * pixel;
        let row_step = -up * pixel;
        Self {
            eye: camera.eye,
            first_pixel: forward * camera.near
                - column_step * middle_column
                - row_step * middle_row,
            column_step,
            row_step,
            ray_length,
            near: camera.near,
        }
    }

    /// Returns the parameter s, in `[0,1]`, at which a pixel's ray ends: g, or 1 if it is not hidden (Abe, Watanabe
    /// 2010, eq. 13, 14). A depth begins at the eye, s at the plane.
    #[must_use]
    pub fn end(&self, ray: &Ray, depth: f32, along: DepthAlong) -> f64 {
        let to_plane = ray.origin.distance(self.eye);
        let depth = f64::from(depth);
        let distance = match along {
            DepthAlong::Ray => depth,
            DepthAlong::Axis => depth * to_plane / self.near,
        };
        ((distance - to_plane) / self.ray_length).clamp(0.0, 1.0)
    }

    /// Makes the ray through the centre of a pixel.
    #[must_use]
    pub fn ray(&self, column: u32, row: u32) -> Ray {
        self.ray_at(f64::from(column), f64::from(row))
    }

    /// Makes the ray through a place of the plane, in pixels from the centre of the first one.
    #[must_use]
    pub fn ray_at(&self, column: f64, row: f64) -> Ray {
        let to_plane = self.first_pixel + self.column_step * column + self.row_step * row;
        Ray {
            origin: self.eye + to_plane,
            span: to_plane.normalize() * self.ray_length,
        }
    }
}
