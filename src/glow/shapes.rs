//! What shines of a scene's particles, one after the other: balls, and stretches of streaks along which the radius
//! changes evenly.

use std::ops::Range;

use glam::DVec3;

use super::pack::{Element, HAS_FIRST_CAP, HAS_LAST_CAP, IS_SMOOTH, IS_STRETCH};
use crate::scene::{LightElement, MetaballKernel, Scene};

/// A streak shorter than this share of its radius is a ball.
const SHORT: f64 = 1e-4;

/// By so much of its radius a streak may miss an even growth and still be one stretch.
const EVEN: f64 = 1e-7;

/// Where something shines.
#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    Ball { center: DVec3, radius: f64 },
    Stretch { ends: [DVec3; 2], radii: [f64; 2] },
}

/// What shines there, and in which form.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shine {
    pub light: DVec3,
    pub form: u32,
}

/// Returns how many particles there are.
pub(super) fn count(scene: &Scene) -> usize {
    let lists = scene.particles.iter().map(|it| it.points.len());
    lists.sum::<usize>() + scene.light_elements.len()
}

/// Calls `add` with all that shines of some of a scene's particles, of all lists one after the other.
pub(super) fn for_each(scene: &Scene, part: Range<usize>, mut add: impl FnMut(Shape, Shine)) {
    let mut first = 0;
    let mut of_part = |len: usize| {
        let [start, end] = [part.start, part.end].map(|it| it.clamp(first, first + len) - first);
        first += len;
        start..end
    };
    for particles in scene.particles.iter() {
        let form = match particles.kernel {
            MetaballKernel::Smooth => IS_SMOOTH,
            MetaballKernel::Cone => 0,
        };
        particles.for_each(of_part(particles.points.len()), |center, radius, light| {
            if light != DVec3::ZERO {
                add(Shape::Ball { center, radius }, Shine { light, form });
            }
        });
    }
    let elements = &scene.light_elements;
    for element in &elements[of_part(elements.len())] {
        match *element {
            LightElement::Ball { light, .. } | LightElement::Streak { light, .. }
                if light == DVec3::ZERO => {}
            LightElement::Ball {
                center,
                radius,
                light,
            } => add(Shape::Ball { center, radius }, Shine { light, form: 0 }),
            LightElement::Streak { ends, radii, light } => {
                add_streak(ends, radii, light, &mut add);
            }
        }
    }
}

fn add_streak(ends: [DVec3; 2], radii: [f64; 3], light: DVec3, add: &mut impl FnMut(Shape, Shine)) {
    let [from, to] = ends;
    let [first, middle, last] = radii;
    let center = 0.5 * (from + to);
    let mut add_stretch = |ends: [DVec3; 2], radii: [f64; 2], caps: u32| {
        let form = IS_STRETCH | caps;
        add(Shape::Stretch { ends, radii }, Shine { light, form });
    };
    if from.distance(to) <= SHORT * first.max(last) {
        let radius = middle;
        add(Shape::Ball { center, radius }, Shine { light, form: 0 });
    } else if (0.5 * (first + last) - middle).abs() <= EVEN * middle {
        add_stretch(ends, [first, last], HAS_FIRST_CAP | HAS_LAST_CAP);
    } else {
        add_stretch([from, center], [first, middle], HAS_FIRST_CAP);
        add_stretch([center, to], [middle, last], HAS_LAST_CAP);
    }
}

impl Element {
    /// Packs what shines, wherever it is seen from.
    pub(super) fn new(shape: Shape, shine: Shine) -> Self {
        let of_ball = |center: DVec3, radius: f64| Self {
            x: center.x as f32,
            y: center.y as f32,
            z: center.z as f32,
            radius: radius as f32,
            inverse_radius: (1.0 / radius) as f32,
            red: shine.light.x as f32,
            green: shine.light.y as f32,
            blue: shine.light.z as f32,
            form: shine.form,
            ..bytemuck::Zeroable::zeroed()
        };
        match shape {
            Shape::Ball { center, radius } => of_ball(center, radius),
            Shape::Stretch { ends, radii } => {
                let axis = 0.5 * (ends[1] - ends[0]);
                Self {
                    axis_x: axis.x as f32,
                    axis_y: axis.y as f32,
                    axis_z: axis.z as f32,
                    growth: (0.5 * (radii[1] - radii[0])) as f32,
                    ..of_ball(0.5 * (ends[0] + ends[1]), 0.5 * (radii[0] + radii[1]))
                }
            }
        }
    }
}
