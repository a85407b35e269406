//! The structs of `cl/glow/types.h`, in the same order, and what packs particles into them, seen from the eye.

use std::f64::consts::LOG2_E;
use std::mem;
use std::ops::Range;

use glam::DVec3;

use super::tiles::PixelBox;
use crate::error::{Error, Result};
use crate::image::DepthAlong;
use crate::opencl::{DeviceStruct, StructLayout, by_value, device_struct};
use crate::scene::{LightElement, MetaballKernel, Scene, ViewPlane};
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
        per_length: f32 = 32,
        absorbed: f32 = 36,
        power: u32 = 40,
        width: u32 = 44,
        height: u32 = 48,
        is_parallel: u32 = 52,
        has_depth: u32 = 56,
        is_along_axis: u32 = 60,
        tile: u32 = 64,
        tile_columns: u32 = 68,
        skew_x: f32 = 72,
        padding0: u32 = 76,
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
        padding0: f32 = 52,
        padding1: f32 = 56,
        padding2: f32 = 60,
    }
}

by_value!(GlowView);

/// Every struct of this engine that crosses to the device.
pub const STRUCTS: &[StructLayout] = &[GlowView::LAYOUT, Element::LAYOUT];

const IS_SMOOTH: u32 = 1;
const IS_STRETCH: u32 = 2;
const HAS_FIRST_CAP: u32 = 4;
const HAS_LAST_CAP: u32 = 8;
const IS_CLEAR: u32 = 16;

/// Within this share of the way to a decay's pole moments tell enough, `MOMENTS_END` of `cl/glow/element.h`.
const MOMENTS_END: f64 = 0.2;

/// A streak shorter than this share of its radius is a ball.
const SHORT: f64 = 1e-4;

/// By so much of its radius a streak may miss an even growth and still be one stretch.
const EVEN: f64 = 1e-7;

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
    /// # Errors
    /// [`Error::Unsupported`] if the picture's axes are not perpendicular to the view.
    pub(super) fn new(scene: &Scene, plane: &ViewPlane) -> Result<Self> {
        let right = plane.column_step.normalize();
        let down = (plane.row_step - plane.row_step.dot(right) * right).normalize();
        let leans = |axis: DVec3| axis.dot(plane.forward).abs() > 1e-6;
        if leans(right) || leans(down) {
            let message = "particles are drawn by cameras whose rows and columns are perpendicular to the view; this \
                projection has a shear along it";
            return Err(Error::Unsupported(message.to_owned()));
        }
        let scale = match plane.is_parallel {
            true => 1.0,
            false => 1.0 / plane.near,
        };
        let step = [
            scale * plane.column_step.length(),
            scale * plane.row_step.dot(down),
        ];
        Ok(Self {
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
        })
    }

    /// Packs it, and what a scene says of its light; `along` is what depths are measured along that end rays.
    pub(super) fn view(&self, scene: &Scene, along: Option<DepthAlong>) -> GlowView {
        let decay = scene.decay.filter(|decay| decay.power > 0);
        // A decay of power 0 is alpha everywhere.
        let alpha = scene.decay.map_or(1.0, |decay| decay.alpha);
        let measure = scene.integration.scale(self.ray_length) / self.ray_length;
        let kappa = scene.absorption.map_or(0.0, |absorption| absorption.kappa);
        let is_along_axis = !matches!(along, None | Some(DepthAlong::Ray));
        GlowView {
            first_x: self.first[0] as f32,
            first_y: self.first[1] as f32,
            step_x: self.step[0] as f32,
            step_y: self.step[1] as f32,
            near: self.near as f32,
            ray_length: self.ray_length as f32,
            scale: (measure * alpha) as f32,
            beta: decay.map_or(0.0, |decay| decay.beta * self.ray_length) as f32,
            per_length: decay.map_or(0.0, |_| 1.0 / self.ray_length) as f32,
            absorbed: (kappa * LOG2_E) as f32,
            skew_x: self.skew as f32,
            power: decay.map_or(0, |decay| decay.power),
            width: self.size[0],
            height: self.size[1],
            is_parallel: u32::from(self.is_parallel),
            has_depth: u32::from(along.is_some()),
            is_along_axis: u32::from(is_along_axis),
            ..bytemuck::Zeroable::zeroed()
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
        let [[left, right], rows] = if self.is_parallel {
            [[x - radius, x + radius], [y - radius, y + radius]]
        } else if z <= 1.001 * radius {
            // The eye is in the ball, or beside it: any ray may be.
            [[f64::NEG_INFINITY, f64::INFINITY]; 2]
        } else {
            let square = (z - radius) * (z + radius);
            let inverse = 1.0 / square;
            [x, y].map(|place| {
                let (middle, root) = (place * z, radius * (place * place + square).sqrt());
                [(middle - root) * inverse, (middle + root) * inverse]
            })
        };
        let rows = rows.map(|at| (at - self.first[1]) * self.per_step[1]);
        let [one, other] = match self.skew {
            0.0 => [0.0; 2],
            skew => rows.map(|row| row * skew),
        };
        let columns = [left - one.max(other), right - one.min(other)];
        Some([
            columns.map(|at| (at - self.first[0]) * self.per_step[0]),
            rows,
        ])
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
        let lists = scene.particles.iter().map(|it| it.points.len());
        let count = lists.sum::<usize>() + scene.light_elements.len();
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
        let mut first = 0;
        let mut of_part = |len: usize| {
            let [start, end] =
                [part.start, part.end].map(|it| it.clamp(first, first + len) - first);
            first += len;
            start..end
        };
        for particles in scene.particles.iter() {
            let form = match particles.kernel {
                MetaballKernel::Smooth => IS_SMOOTH,
                MetaballKernel::Cone => 0,
            };
            particles.for_each(of_part(particles.points.len()), |center, radius, light| {
                self.add_ball(sight, (center, radius), light, form);
            });
        }
        let elements = &scene.light_elements;
        for element in &elements[of_part(elements.len())] {
            match element {
                LightElement::Ball {
                    center,
                    radius,
                    light,
                } => self.add_ball(sight, (*center, *radius), *light, 0),
                LightElement::Streak { ends, radii, light } => {
                    self.add_streak(sight, *ends, *radii, *light);
                }
            }
        }
    }

    fn add_ball(&mut self, sight: &Sight, (center, radius): (DVec3, f64), light: DVec3, form: u32) {
        let center = sight.seen(center);
        let Some(cover) = sight.cover(center, radius) else {
            return;
        };
        if let Some(pixels) = PixelBox::new(cover, sight.size) {
            let clear = if sight.is_clear(center, radius) {
                IS_CLEAR
            } else {
                0
            };
            self.add(pixels, center, radius, light, form | clear);
        }
    }

    fn add(&mut self, pixels: PixelBox, center: DVec3, radius: f64, light: DVec3, form: u32) {
        if light == DVec3::ZERO {
            return;
        }
        self.boxes.push(pixels);
        self.elements.push(Element {
            x: center.x as f32,
            y: center.y as f32,
            z: center.z as f32,
            radius: radius as f32,
            inverse_radius: (1.0 / radius) as f32,
            red: light.x as f32,
            green: light.y as f32,
            blue: light.z as f32,
            form,
            ..bytemuck::Zeroable::zeroed()
        });
    }

    fn add_streak(&mut self, sight: &Sight, ends: [DVec3; 2], radii: [f64; 3], light: DVec3) {
        let [from, to] = ends;
        let [first, middle, last] = radii;
        let center = 0.5 * (from + to);
        if from.distance(to) <= SHORT * first.max(last) {
            return self.add_ball(sight, (center, middle), light, 0);
        }
        if (0.5 * (first + last) - middle).abs() <= EVEN * middle {
            let caps = HAS_FIRST_CAP | HAS_LAST_CAP;
            return self.add_stretch(sight, ends, [first, last], light, caps);
        }
        self.add_stretch(sight, [from, center], [first, middle], light, HAS_FIRST_CAP);
        self.add_stretch(sight, [center, to], [middle, last], light, HAS_LAST_CAP);
    }

    fn add_stretch(
        &mut self,
        sight: &Sight,
        ends: [DVec3; 2],
        radii: [f64; 2],
        light: DVec3,
        caps: u32,
    ) {
        let [from, to] = ends.map(|end| sight.seen(end));
        let covers =
            [(from, radii[0]), (to, radii[1])].map(|(end, radius)| sight.cover(end, radius));
        // Before the plane is no light, but what is between the ends may be seen beyond them.
        let pixels = match covers {
            [None, None] => return,
            [Some(one), Some(other)] => PixelBox::around(one, other, sight.size),
            _ => PixelBox::new([[f64::NEG_INFINITY, f64::INFINITY]; 2], sight.size),
        };
        let Some(pixels) = pixels else {
            return;
        };
        let count = self.elements.len();
        self.add(
            pixels,
            0.5 * (from + to),
            0.5 * (radii[0] + radii[1]),
            light,
            IS_STRETCH | caps,
        );
        let axis = 0.5 * (to - from);
        for element in &mut self.elements[count..] {
            element.axis_x = axis.x as f32;
            element.axis_y = axis.y as f32;
            element.axis_z = axis.z as f32;
            element.growth = (0.5 * (radii[1] - radii[0])) as f32;
        }
    }
}
