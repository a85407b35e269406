//! Colliders as the simulation asks them: how far a point is outside, and where a motion enters.

use glam::{DMat3, DVec3};

use crate::scene::{Collider, ColliderShape, Rotation};

/// So far within a solid, as a part of where and how large it is, a point still lies on its surface: rounding of points
/// that were put there.
const TOUCH: f64 = 1e-12;

/// A motion that begins on a surface enters if it has such a part of its length against the normal.
const INWARD: f64 = 1e-9;

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
}

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
        let (form, size) = match collider.shape {
            ColliderShape::Box {
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
            ColliderShape::Sphere { center, radius } => {
                (Form::Sphere { center, radius }, center.length() + radius)
            }
            ColliderShape::Plane { point, normal } => {
                let normal = normal.normalize();
                (Form::Plane { point, normal }, point.length() + 1.0)
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
        }
    }

    /// Returns whether a point lies on the surface, or within it by rounding.
    pub(super) fn touches(&self, point: DVec3) -> bool {
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
fn turn(rotation: Rotation) -> DMat3 {
    let axis = rotation.axis.normalize();
    let (sin, cos) = libm::sincos(rotation.angle.to_radians());
    let turned = |v: DVec3| v * cos + axis.cross(v) * sin + axis * axis.dot(v) * (1.0 - cos);
    DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z))
}
