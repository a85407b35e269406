//! Colliders as the simulation asks them: how far a point is outside, and where a motion enters. Meshes are in
//! `facets.rs`.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::facets::Facets;
use crate::scene::{Collider, ColliderShape, Rotation};

/// So far within a solid, as a part of where and how large it is, a point still lies on its surface: rounding of points
/// that were put there.
pub(super) const TOUCH: f64 = 1e-12;

/// A motion that begins on a surface enters if it has such a part of its length against the normal.
pub(super) const INWARD: f64 = 1e-9;

#[derive(Debug, Clone)]
pub(crate) struct Solid {
    form: Form,
    /// Within this distance below its surface a point lies on it, world units.
    touch: f64,
}

#[derive(Debug, Clone)]
enum Form {
    Box {
        center: DVec3,
        half: DVec3,
        /// Its axes as rows: turns what is the world's into what is its own.
        axes: DMat3,
    },
    Sphere {
        center: DVec3,
        radius: f64,
    },
    Plane {
        point: DVec3,
        normal: DVec3,
    },
    Mesh(Arc<Facets>),
}

/// What touches a mesh is put back from what it hits by so many times what still touches.
const CLEAR: f64 = 4.0;

/// Where a motion enters a solid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    /// How much of the motion is done, 0 to the most that was asked for.
    pub share: f64,
    /// Outwards, of length 1.
    pub normal: DVec3,
}

impl Solid {
    pub(crate) fn new(collider: &Collider) -> Self {
        let (form, size) = match &collider.shape {
            &ColliderShape::Box {
                center,
                half,
                rotation,
            } => {
                let axes = rotation.map_or(DMat3::IDENTITY, turn).transpose();
                (
                    Form::Box { center, half, axes },
                    center.length() + half.length(),
                )
            }
            &ColliderShape::Sphere { center, radius } => {
                (Form::Sphere { center, radius }, center.length() + radius)
            }
            &ColliderShape::Plane { point, normal } => {
                let normal = normal.normalize();
                (Form::Plane { point, normal }, point.length() + 1.0)
            }
            ColliderShape::Mesh(mesh) => {
                let facets = Facets::new(mesh);
                let size = facets.touch() / TOUCH;
                (Form::Mesh(facets.into()), size)
            }
        };
        Self {
            form,
            touch: TOUCH * size,
        }
    }

    /// Returns how far a point lies outside; within, the negative distance to the surface.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        match &self.form {
            Form::Box { center, half, axes } => {
                let beyond = (*axes * (point - *center)).abs() - *half;
                beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
            }
            Form::Sphere { center, radius } => (point - *center).length() - radius,
            Form::Plane {
                point: base,
                normal,
            } => (point - *base).dot(*normal),
            Form::Mesh(facets) => facets.distance(point),
        }
    }

    /// Returns whether what left its surface cannot hit it again on the straight way from there.
    pub(super) fn is_convex(&self) -> bool {
        !matches!(self.form, Form::Mesh(_))
    }

    /// Returns how far from its surface particles are put that hit something, where that is not left to rounding.
    pub(super) fn clearance(&self) -> f64 {
        match self.is_convex() {
            true => 0.0,
            false => CLEAR * self.touch,
        }
    }

    /// Adds the normals of its faces that a point lies on, or within by rounding; those of a mesh are on the side of
    /// `front`, one of them, or where the velocity comes from.
    pub(super) fn faces(
        &self,
        point: DVec3,
        velocity: DVec3,
        front: Option<DVec3>,
        normals: &mut Vec<DVec3>,
    ) {
        match &self.form {
            Form::Mesh(facets) => facets.normals_at(point, velocity, front, normals),
            _ if front.is_none() && self.touches(point) => normals.push(self.normal(point)),
            _ => {}
        }
    }

    /// Returns the direction outwards at a point on or near the surface.
    pub(super) fn normal(&self, point: DVec3) -> DVec3 {
        match &self.form {
            Form::Box { center, half, axes } => {
                let place = *axes * (point - *center);
                let beyond = (place.abs() - *half).to_array();
                let axis = (1..3).fold(
                    0,
                    |most, it| if beyond[it] > beyond[most] { it } else { most },
                );
                axes.row(axis) * place[axis].signum()
            }
            Form::Sphere { center, .. } => (point - *center).normalize_or(DVec3::Z),
            Form::Plane { normal, .. } => *normal,
            Form::Mesh(facets) => facets.normal(point),
        }
    }

    /// Returns whether a point lies on the surface, or within it by rounding.
    fn touches(&self, point: DVec3) -> bool {
        self.distance(point).abs() <= self.touch
    }

    /// Returns where a motion from a point first enters from outside, within so many times itself.
    pub(crate) fn entry(&self, point: DVec3, motion: DVec3, most: f64) -> Option<Entry> {
        let entry = match &self.form {
            Form::Box { center, half, axes } => {
                let (place, own) = (*axes * (point - *center), *axes * motion);
                // Most that ask are far away.
                if (place.abs() - *half).cmpgt(most * own.abs()).any() {
                    return None;
                }
                self.box_entry(place, own, *half, motion, axes)
            }
            Form::Sphere { center, radius } => self.sphere_entry(point - *center, motion, *radius),
            Form::Plane {
                point: base,
                normal,
            } => {
                let (height, inward) = ((point - *base).dot(*normal), -motion.dot(*normal));
                let share = self.share(height / inward, inward, motion);
                share.filter(|_| inward > 0.0).map(|share| Entry {
                    share,
                    normal: *normal,
                })
            }
            Form::Mesh(facets) => facets.entry(point, motion, most),
        };
        entry.filter(|entry| entry.share <= most)
    }

    /// Returns a share of a motion that is not negative; of one that begins within the surface by rounding, 0. `inward`
    /// is how fast the motion goes against the normal.
    fn share(&self, share: f64, inward: f64, motion: DVec3) -> Option<f64> {
        if share >= 0.0 {
            return Some(share);
        }
        let is_there = -share * inward <= self.touch && inward >= INWARD * motion.length();
        is_there.then_some(0.0)
    }

    /// Returns where a motion enters a box; place and motion are turned into what is the box' own.
    fn box_entry(
        &self,
        place: DVec3,
        own: DVec3,
        half: DVec3,
        motion: DVec3,
        axes: &DMat3,
    ) -> Option<Entry> {
        let (p, d) = (place.to_array(), own.to_array());
        let (mut near, mut far, mut axis) = (f64::NEG_INFINITY, f64::INFINITY, 3);
        for k in 0..3 {
            if d[k] == 0.0 {
                if p[k].abs() >= half[k] {
                    return None;
                }
                continue;
            }
            let side = half[k] * d[k].signum();
            let (enters, leaves) = ((-side - p[k]) / d[k], (side - p[k]) / d[k]);
            if enters > near {
                (near, axis) = (enters, k);
            }
            far = far.min(leaves);
        }
        if axis == 3 || near > far || far <= 0.0 {
            return None;
        }
        Some(Entry {
            share: self.share(near, d[axis].abs(), motion)?,
            normal: axes.row(axis) * -d[axis].signum(),
        })
    }

    fn sphere_entry(&self, place: DVec3, motion: DVec3, radius: f64) -> Option<Entry> {
        let inward = -place.dot(motion);
        if inward <= 0.0 {
            return None;
        }
        // |place + share motion| = radius, without cancellation near the surface.
        let outside = (place.length() - radius) * (place.length() + radius);
        let root = inward * inward - motion.length_squared() * outside;
        if root < 0.0 {
            return None;
        }
        let share = outside / (inward + root.sqrt());
        let share = self.share(share, inward / radius, motion)?;
        let normal = (place + share * motion).normalize_or(DVec3::Z);
        Some(Entry { share, normal })
    }
}

/// Makes the turn about an axis by an angle (Rodrigues), with sine and cosine that are the same everywhere.
pub(super) fn turn(rotation: Rotation) -> DMat3 {
    let axis = rotation.axis.normalize();
    let (sin, cos) = libm::sincos(rotation.angle.to_radians());
    let turned = |v: DVec3| v * cos + axis.cross(v) * sin + axis * axis.dot(v) * (1.0 - cos);
    DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z))
}
