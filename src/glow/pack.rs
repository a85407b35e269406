//! The structs of `cl/glow/types.h`, in the same order, and what packs particles into them, seen from the eye.

use std::f64::consts::LOG2_E;
use std::mem;
use std::ops::Range;

use glam::DVec3;

use super::shapes::{self, Shape, Shine};
use super::tiles::PixelBox;
use crate::image::DepthAlong;
use crate::opencl::{DeviceStruct, StructLayout, by_value, device_struct};
use crate::scene::{Scene, ViewPlane};
use crate::threads;

device_struct! {
    /// The grid of rays, and what light becomes along them.
    GlowView [80] {
        first_x: f32 = 0,
        first_y: f32 = 4,
        step_x: f32 = 8,
        step_y: f32 = 12,
        near: f32 = 16,
        ray_length: f32 = 20,
        scale: f32 = 24,
        beta: f32 = 28,
        absorbed: f32 = 32,
        power: u32 = 36,
        width: u32 = 40,
        height: u32 = 44,
        is_parallel: u32 = 48,
        has_depth: u32 = 52,
        is_along_axis: u32 = 56,
        tile: u32 = 60,
        tile_columns: u32 = 64,
        skew_x: f32 = 68,
        padding0: u32 = 72,
        padding1: u32 = 76,
    }
}

device_struct! {
    /// A ball, or a stretch of a streak.
    Element [64] {
        x: f32 = 0,
        y: f32 = 4,
        z: f32 = 8,
        radius: f32 = 12,
        red: f32 = 16,
        green: f32 = 20,
        blue: f32 = 24,
        form: u32 = 28,
        axis_x: f32 = 32,
        axis_y: f32 = 36,
        axis_z: f32 = 40,
        growth: f32 = 44,
        inverse_radius: f32 = 48,
        rest_x: f32 = 52,
        rest_y: f32 = 56,
        rest_z: f32 = 60,
    }
}

device_struct! {
    /// A listed ray.
    GlowRay [72] {
        place: [f32; 3] = 0,
        place_rest: [f32; 3] = 12,
        toward: [f32; 3] = 24,
        toward_rest: [f32; 3] = 36,
        begin: f32 = 48,
        end: f32 = 52,
        begin_rest: f32 = 56,
        end_rest: f32 = 60,
        length: f32 = 64,
        beta: f32 = 68,
    }
}

device_struct! {
    /// A box around elements, where rays are listed.
    GlowBox [32] {
        low_x: f32 = 0,
        low_y: f32 = 4,
        low_z: f32 = 8,
        next: u32 = 12,
        high_x: f32 = 16,
        high_y: f32 = 20,
        high_z: f32 = 24,
        count: u32 = 28,
    }
}

by_value!(GlowView);

/// Every struct of this engine that crosses to the device.
pub const STRUCTS: &[StructLayout] = &[
    GlowView::LAYOUT,
    Element::LAYOUT,
    GlowRay::LAYOUT,
    GlowBox::LAYOUT,
];

pub(super) const IS_SMOOTH: u32 = 1;
pub(super) const IS_STRETCH: u32 = 2;
pub(super) const HAS_FIRST_CAP: u32 = 4;
pub(super) const HAS_LAST_CAP: u32 = 8;
const IS_CLEAR: u32 = 16;

/// Within this share of the way to a decay's pole moments tell enough, `MOMENTS_END` of `cl/glow/element.h`.
const MOMENTS_END: f64 = 0.2;

/// The eye, the axes of the picture, and the pixels' places on them.
#[derive(Debug)]
pub(super) struct Sight {
    eye: DVec3,
    right: DVec3,
    down: DVec3,
    forward: DVec3,
    /// Slope, or offset, of the first pixel, and from one to the next.
    first: [f64; 2],
    step: [f64; 2],
    per_step: [f64; 2],
    /// By which a row begins farther to the right than that above it.
    skew: f64,
    near: f64,
    ray_length: f64,
    is_parallel: bool,
    size: [u32; 2],
    /// From the projection plane to the pole of the decay, infinite where nothing decays; `None`: light fades in a way
    /// that moments do not tell.
    to_pole: Option<f64>,
}

impl Sight {
    /// Rows and columns are perpendicular to the view, whatever a projection's shear: matrices that are read have no
    /// other.
    pub(super) fn new(scene: &Scene, plane: &ViewPlane) -> Self {
        let right = plane.column_step.normalize();
        let down = (plane.row_step - plane.row_step.dot(right) * right).normalize();
        let scale = match plane.is_parallel {
            true => 1.0,
            false => 1.0 / plane.near,
        };
        let step = [
            scale * plane.column_step.length(),
            scale * plane.row_step.dot(down),
        ];
        Self {
            eye: plane.eye,
            right,
            down,
            forward: plane.forward,
            first: [right, down].map(|axis| scale * plane.first_pixel.dot(axis)),
            step,
            per_step: step.map(f64::recip),
            skew: scale * plane.row_step.dot(right),
            near: plane.near,
            ray_length: plane.ray_length,
            is_parallel: plane.is_parallel,
            size: [scene.image.width, scene.image.height],
            to_pole: to_pole(scene, plane),
        }
    }

    /// Packs it, and what a scene says of its light; `along` is what depths are measured along that end rays.
    pub(super) fn view(&self, scene: &Scene, along: Option<DepthAlong>) -> GlowView {
        let decay = scene.decay.filter(|decay| decay.power > 0);
        let measure = scene.integration.scale(self.ray_length) / self.ray_length;
        let is_along_axis = !matches!(along, None | Some(DepthAlong::Ray));
        GlowView {
            first_x: self.first[0] as f32,
            first_y: self.first[1] as f32,
            step_x: self.step[0] as f32,
            step_y: self.step[1] as f32,
            near: self.near as f32,
            ray_length: self.ray_length as f32,
            scale: (measure * alpha(scene)) as f32,
            beta: decay.map_or(0.0, |decay| decay.beta * self.ray_length) as f32,
            skew_x: self.skew as f32,
            width: self.size[0],
            height: self.size[1],
            is_parallel: u32::from(self.is_parallel),
            has_depth: u32::from(along.is_some()),
            is_along_axis: u32::from(is_along_axis),
            ..fading_view(scene)
        }
    }

    /// Returns a position seen from the eye, along the axes of the picture.
    fn seen(&self, place: DVec3) -> DVec3 {
        self.turned(place - self.eye)
    }

    fn turned(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.right), v.dot(self.down), v.dot(self.forward))
    }

    pub(super) fn to_pole(&self) -> Option<f64> {
        self.to_pole
    }

    /// Returns whether all chords of a ball lie on the rays, and far enough from the decay's pole.
    fn is_clear(&self, center: DVec3, radius: f64) -> bool {
        let (front, reach) = (center.z - radius, 1.0001 * radius);
        let end = self.near + self.ray_length;
        let last = match self.is_parallel {
            true => center.z,
            false => center.length(),
        };
        self.to_pole.is_some_and(|to_pole| {
            front >= self.near + 1e-4 * radius
                && last + reach <= end
                && reach <= MOMENTS_END * (to_pole + front - self.near)
        })
    }

    /// Returns the pixels whose rays may come into a ball, as a range of columns and one of rows; `None`: none.
    fn cover(&self, center: DVec3, radius: f64) -> Option<[[f64; 2]; 2]> {
        if center.z + radius <= self.near {
            return None;
        }
        let (x, y, z) = (center.x, center.y, center.z);
        let ([left, right], [above, below]) = if self.is_parallel {
            ([x - radius, x + radius], [y - radius, y + radius])
        } else if z <= 1.001 * radius {
            // The eye is in the ball, or beside it: any ray may be.
            let all = [f64::NEG_INFINITY, f64::INFINITY];
            (all, all)
        } else {
            let square = (z - radius) * (z + radius);
            let inverse = 1.0 / square;
            let range = |place: f64| {
                let (middle, root) = (place * z, radius * (place * place + square).sqrt());
                [(middle - root) * inverse, (middle + root) * inverse]
            };
            (range(x), range(y))
        };
        let row = |at: f64| (at - self.first[1]) * self.per_step[1];
        let column = |at: f64| (at - self.first[0]) * self.per_step[0];
        let rows = [row(above), row(below)];
        let (one, other) = match self.skew {
            0.0 => (0.0, 0.0),
            skew => (skew * rows[0], skew * rows[1]),
        };
        Some([
            [
                column(left - one.max(other)),
                column(right - one.min(other)),
            ],
            rows,
        ])
    }
}

/// A decay of power 0 is alpha everywhere.
fn alpha(scene: &Scene) -> f64 {
    scene.decay.map_or(1.0, |decay| decay.alpha)
}

/// Packs how light fades along rays of any length, over their parameter.
pub(super) fn fading_view(scene: &Scene) -> GlowView {
    let kappa = scene.absorption.map_or(0.0, |absorption| absorption.kappa);
    GlowView {
        scale: alpha(scene) as f32,
        absorbed: (kappa * LOG2_E) as f32,
        power: scene.decay.map_or(0, |decay| decay.power),
        ..bytemuck::Zeroable::zeroed()
    }
}

fn to_pole(scene: &Scene, plane: &ViewPlane) -> Option<f64> {
    let is_absorbed = scene.absorption.is_some_and(|it| it.kappa > 0.0);
    let decay = scene.decay.filter(|decay| decay.power > 0);
    match decay {
        _ if is_absorbed => None,
        None => Some(f64::INFINITY),
        Some(decay) => (decay.power == 2).then_some(decay.beta * plane.ray_length),
    }
}

/// So few particles are packed by one thread.
const FEW: usize = 4096;

/// What is packed of a frame: elements, and the pixels of each.
#[derive(Debug, Default)]
pub(super) struct Packed {
    pub elements: Vec<Element>,
    pub boxes: Vec<PixelBox>,
    /// What each thread packs.
    pieces: Vec<Piece>,
}

impl Packed {
    /// Packs all particles of a scene, in its order; those that no ray meets are left out.
    pub(super) fn pack(&mut self, scene: &Scene, sight: &Sight) {
        let count = shapes::count(scene);
        let pieces = threads::count().min(count.div_ceil(FEW)).max(1);
        self.pieces.resize_with(pieces, Piece::default);
        threads::for_each_chunk(&mut self.pieces, 1, |number, piece| {
            let part = number * count / pieces..(number + 1) * count / pieces;
            piece[0].pack(scene, sight, part);
        });
        let mut pieces = self.pieces.iter_mut();
        if let Some(first) = pieces.next() {
            mem::swap(&mut self.elements, &mut first.elements);
            mem::swap(&mut self.boxes, &mut first.boxes);
        }
        for piece in pieces {
            self.elements.extend_from_slice(&piece.elements);
            self.boxes.extend_from_slice(&piece.boxes);
        }
    }
}

/// What is packed of some particles.
#[derive(Debug, Default)]
struct Piece {
    elements: Vec<Element>,
    boxes: Vec<PixelBox>,
}

impl Piece {
    /// Packs some of all lists one after the other.
    fn pack(&mut self, scene: &Scene, sight: &Sight, part: Range<usize>) {
        self.elements.clear();
        self.boxes.clear();
        shapes::for_each(scene, part, |shape, shine| match shape {
            Shape::Ball { center, radius } => self.add_ball(sight, (center, radius), shine),
            Shape::Stretch { ends, radii } => self.add_stretch(sight, ends, radii, shine),
        });
    }

    fn add_ball(&mut self, sight: &Sight, (center, radius): (DVec3, f64), mut shine: Shine) {
        let center = sight.seen(center);
        let Some(cover) = sight.cover(center, radius) else {
            return;
        };
        if let Some(pixels) = PixelBox::new(cover, sight.size) {
            if sight.is_clear(center, radius) {
                shine.form |= IS_CLEAR;
            }
            self.boxes.push(pixels);
            let shape = Shape::Ball { center, radius };
            self.elements.push(Element::new(shape, shine));
        }
    }

    fn add_stretch(&mut self, sight: &Sight, ends: [DVec3; 2], radii: [f64; 2], shine: Shine) {
        let ends = ends.map(|end| sight.seen(end));
        let covers = [0, 1].map(|end| sight.cover(ends[end], radii[end]));
        // Before the plane is no light, but what is between the ends may be seen beyond them.
        let pixels = match covers {
            [None, None] => return,
            [Some(one), Some(other)] => PixelBox::around(one, other, sight.size),
            _ => PixelBox::new([[f64::NEG_INFINITY, f64::INFINITY]; 2], sight.size),
        };
        if let Some(pixels) = pixels {
            self.boxes.push(pixels);
            let shape = Shape::Stretch { ends, radii };
            self.elements.push(Element::new(shape, shine));
        }
    }
}
