//! A collider of triangles: where a motion meets them, from either side, and what is inside.
//!
//! A point within `touch` of a triangle's plane lies on it. A motion that begins off the plane meets it if it ends on
//! it or beyond: heights are computed of the same point alike at the end of a step and at the begin of the next, so
//! that none is passed between two. A particle is put back along its way until it is off the plane (`Solid::clear`):
//! that way is free. Which side is outside is told by the corners' order, turned round if the volume is negative.

use glam::{DMat3, DVec3};

use super::solid::{Entry, INWARD, TOUCH, turn};
use crate::scene::{Halves, Mesh, Triangle};

/// Normals that differ by less are one.
const SAME: f64 = 1e-12;

#[derive(Debug)]
pub(super) struct Facets {
    halves: Halves,
    /// Of each triangle, by its number.
    planes: Vec<Plane>,
    /// Within this distance of a plane a point lies on it, world units.
    touch: f64,
    is_closed: bool,
}

#[derive(Debug, Clone, Copy)]
struct Plane {
    /// Outwards, of length 1.
    normal: DVec3,
    point: DVec3,
}

impl Plane {
    fn height(&self, point: DVec3) -> f64 {
        (point - self.point).dot(self.normal)
    }
}

impl Facets {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let axes = mesh.rotate.map_or(DMat3::IDENTITY, turn);
        let place = |vertex: &DVec3| axes * (mesh.scale * *vertex) + mesh.translate;
        let placed: Vec<DVec3> = mesh.triangles.vertices().iter().map(place).collect();
        let corners = mesh.triangles.triangles().iter();
        let corners = corners.map(|it| it.map(|corner| placed[corner as usize]));
        let corners: Vec<[DVec3; 3]> = corners.collect();
        let middle = corners[0][0];
        let volume = |[a, b, c]: &[DVec3; 3]| (*a - middle).dot((*b - middle).cross(*c - middle));
        let is_closed = mesh.triangles.is_closed();
        let is_inside_out = is_closed && corners.iter().map(volume).sum::<f64>() < 0.0;
        let halves = Halves::of(corners.iter().map(|corners| (*corners, 0)));
        let plane = |[a, b, c]: &[DVec3; 3]| {
            let normal = (*b - *a).cross(*c - *a).normalize_or(DVec3::Z);
            Plane {
                normal: if is_inside_out { -normal } else { normal },
                point: *a,
            }
        };
        let (low, high) = halves.bounds();
        Self {
            planes: corners.iter().map(plane).collect(),
            touch: TOUCH * (low.abs().max(high.abs()).length() + (high - low).length()),
            is_closed,
            halves,
        }
    }

    pub(super) fn touch(&self) -> f64 {
        self.touch
    }

    fn plane(&self, triangle: &Triangle) -> &Plane {
        &self.planes[triangle.number as usize]
    }

    /// Returns where a motion first meets a triangle, within so many times itself.
    pub(super) fn entry(&self, point: DVec3, motion: DVec3, most: f64) -> Option<Entry> {
        let end = point + most * motion;
        let length = motion.length();
        let mut first: Option<(Entry, u32)> = None;
        let see = &mut |triangle: &Triangle, most: &mut f64| {
            let plane = self.plane(triangle);
            let (height, rate) = (plane.height(point), motion.dot(plane.normal));
            let is_on = height.abs() <= self.touch;
            // From its plane a motion meets it only inwards.
            let side = if is_on { 1.0 } else { height.signum() };
            let inward = -side * rate;
            let meets = match is_on {
                true => inward >= INWARD * length && inward > 0.0,
                false if end.is_finite() => side * plane.height(end) <= self.touch,
                false => inward > 0.0,
            };
            if !meets {
                return;
            }
            let (crossing, is_within) = triangle.crossing(point, motion);
            let share = match crossing.is_finite() {
                true => crossing.clamp(0.0, *most),
                false => return,
            };
            let is_nearer = first
                .as_ref()
                .is_none_or(|(entry, number)| (share, triangle.number) < (entry.share, *number));
            if is_within && is_nearer {
                let normal = side * plane.normal;
                first = Some((Entry { share, normal }, triangle.number));
                *most = share;
            }
        };
        self.halves
            .along(point, motion, most, 2.0 * self.touch, see);
        first.map(|(entry, _)| entry)
    }

    /// Adds the normals of the triangles that a point lies on, but for those that are there: on the side of one of
    /// them, `front`, if it is given, else where the velocity comes from. At edges that stand out only those that the
    /// velocity goes against.
    pub(super) fn normals_at(
        &self,
        point: DVec3,
        velocity: DVec3,
        front: Option<DVec3>,
        normals: &mut Vec<DVec3>,
    ) {
        let reach = 2.0 * self.touch;
        let mut found = Vec::new();
        self.halves.around(point, reach, &mut |triangle, _| {
            if triangle.nearest_to(point).distance(point) <= reach {
                found.push(triangle);
            }
        });
        found.sort_unstable_by_key(|triangle| triangle.number);
        let same = |one: DVec3, other: DVec3| one.dot(other) > 1.0 - SAME;
        let side = front.map(|front| {
            let turned = |it: &&Triangle| same(self.plane(it).normal, -front);
            if found.iter().any(turned) { -1.0 } else { 1.0 }
        });
        for triangle in found {
            let normal = self.plane(triangle).normal;
            let normal = match side {
                Some(side) => side * normal,
                None if self.is_closed || velocity.dot(normal) < 0.0 => normal,
                None => -normal,
            };
            let is_hollow = front.is_some_and(|front| {
                let heights = triangle.corners.map(|corner| (corner - point).dot(front));
                heights.iter().any(|height| *height > reach)
            });
            let counts = is_hollow || velocity.dot(normal) < 0.0;
            if counts && !normals.iter().any(|it| same(*it, normal)) {
                normals.push(normal);
            }
        }
    }

    /// Returns how far a point lies from the nearest triangle; within a closed mesh, the negative distance.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        let (distance, triangle) = self.nearest(point);
        let [a, b, c] = triangle.corners;
        let way = (a + b + c) / 3.0 - point;
        // What is first on the way to it shows the side that the point is on.
        let seen = self.halves.nearest(point, way).map_or(triangle, |it| it.1);
        let is_inside = self.is_closed && self.plane(seen).normal.dot(way) > 0.0;
        if is_inside { -distance } else { distance }
    }

    /// Returns the direction outwards of what is nearest to a point.
    pub(super) fn normal(&self, point: DVec3) -> DVec3 {
        self.plane(self.nearest(point).1).normal
    }

    fn nearest(&self, point: DVec3) -> (f64, &Triangle) {
        let mut nearest: Option<(f64, &Triangle)> = None;
        let see = &mut |triangle, most: &mut f64| {
            let distance = Triangle::nearest_to(triangle, point).distance(point);
            let is_nearer = nearest
                .is_none_or(|(before, it)| (distance, triangle.number) < (before, it.number));
            if is_nearer {
                nearest = Some((distance, triangle));
                *most = distance;
            }
        };
        self.halves.around(point, f64::INFINITY, see);
        nearest.unwrap_or((f64::INFINITY, self.halves.any()))
    }
}
