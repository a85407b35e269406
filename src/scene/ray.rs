//! View rays: `L(s) = (1-s) S + s E` for s in `[0,1]`, one for every pixel (Watanabe, Abe, Konno 2015, eq. 19).

use glam::DVec3;

use super::Camera;
use crate::image::{DepthAlong, ImageSize};

/// The greatest coordinate that float32 devices can integrate to, world units.
const FARTHEST: f64 = 1e9;

/// Says why a point is none that float32 devices can work with.
pub(crate) fn point_fault(point: DVec3) -> Option<String> {
    let mut axes = ["x", "y", "z"].into_iter().zip(point.to_array());
    axes.find_map(|(axis, value)| {
        if !value.is_finite() {
            return Some(format!(
                "{axis} is {value}; coordinates are finite numbers, to 1e9"
            ));
        }
        let is_far = value.abs() > FARTHEST;
        is_far.then(|| format!("{axis} is {value:e}; float32 devices can integrate to 1e9"))
    })
}

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

    /// Says why float32 devices cannot integrate along this ray, and by which coordinate; `None`: they can.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        let is_bounded = |v: DVec3| v.to_array().iter().all(|x| x.abs() <= FARTHEST);
        if !is_bounded(self.origin) || !is_bounded(self.span) {
            let ends = [("start", self.origin), ("end", self.origin + self.span)];
            let fault_of = |(end, at)| Some(format!("{end}: {}", point_fault(at)?));
            let longest = || "longer than float32 devices can integrate, 1e9".to_owned();
            return Some(ends.into_iter().find_map(fault_of).unwrap_or_else(longest));
        }
        let is_short = self.span.length() < 1e-9;
        is_short.then(|| "start and end are less than 1e-9 apart".to_owned())
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
    /// From the eye to the plane, along the axis of view, world units.
    pub near: f64,
    /// The axis of view, of length 1.
    pub forward: DVec3,
    /// Whether all rays go along the axis of view, as those of an orthographic camera do. Depths are then measured from
    /// the eye's plane.
    pub is_parallel: bool,
}

impl ViewPlane {
    /// Places the plane at distance `camera.near` from the eye, divided into the image's pixels, for rays of a length
    /// ([`Scene::ray_length`](super::Scene::ray_length)).
    #[must_use]
    pub fn new(camera: &Camera, image: ImageSize, ray_length: f64) -> Self {
        let grid = camera.grid(image);
        Self {
            eye: grid.eye,
            first_pixel: grid.first_pixel,
            column_step: grid.column_step,
            row_step: grid.row_step,
            ray_length,
            near: camera.near,
            forward: grid.forward,
            is_parallel: grid.is_parallel,
        }
    }

    /// Returns the parameter s, in `[0,1]`, at which a pixel's ray ends: g, or 1 if it is not hidden (Abe, Watanabe
    /// 2010, eq. 13, 14). A depth begins at the eye, s at the plane.
    #[must_use]
    pub fn end(&self, ray: &Ray, depth: f32, along: DepthAlong) -> f64 {
        let to_plane = self.before_plane(ray.origin - self.eye);
        let distance = self.distance(depth, along, to_plane);
        ((distance - to_plane) / self.ray_length).clamp(0.0, 1.0)
    }

    /// Returns how far along its ray a point of the plane, seen from the eye, is from where depths begin.
    pub(crate) fn before_plane(&self, point: DVec3) -> f64 {
        match self.is_parallel {
            true => self.near,
            false => point.length(),
        }
    }

    /// Returns the distance along a ray that a depth stands for, `to_plane` that of its beginning.
    pub(crate) fn distance(&self, depth: f32, along: DepthAlong, to_plane: f64) -> f64 {
        let depth = f64::from(depth);
        match along {
            _ if self.is_parallel => depth,
            DepthAlong::Ray => depth,
            // An image holds no others.
            DepthAlong::Axis | DepthAlong::Ndc | DepthAlong::Buffer => depth * to_plane / self.near,
        }
    }

    /// Makes the ray through a pixel, where the camera's jitter puts it: without one through its centre.
    #[must_use]
    pub fn ray(&self, column: u32, row: u32) -> Ray {
        self.ray_at(f64::from(column), f64::from(row))
    }

    /// Makes the ray through a place of the plane, in pixels from the centre of the first one.
    #[must_use]
    pub fn ray_at(&self, column: f64, row: f64) -> Ray {
        let to_plane = self.first_pixel + self.column_step * column + self.row_step * row;
        let direction = match self.is_parallel {
            true => self.forward,
            false => to_plane.normalize(),
        };
        Ray {
            origin: self.eye + to_plane,
            span: direction * self.ray_length,
        }
    }

    /// Returns the distance of the farthest pixel of an image from the eye.
    pub(crate) fn farthest_pixel(&self, image: ImageSize) -> f64 {
        let corner = |(column, row): (u32, u32)| {
            let steps = self.column_step * f64::from(column) + self.row_step * f64::from(row);
            (self.first_pixel + steps).length()
        };
        let (right, below) = (image.width.max(1) - 1, image.height.max(1) - 1);
        let corners = [(0, 0), (right, 0), (0, below), (right, below)];
        corners.into_iter().map(corner).fold(0.0, f64::max)
    }
}
