//! Scene to device structs: world space to positions seen from the eye, float64 to float32, curves to their own frame.

mod curve;
pub mod layout;
mod rule;

use bytemuck::Zeroable;
use glam::DVec3;

pub use rule::Rule;

use crate::image::{DepthAlong, DepthImage};
use crate::ray::{Ray, ViewPlane};
use crate::reference::simpson_nodes;
use crate::scene::{Beam, Cylinder, Decay, Measure, Profile, Scene, Sphere, Torus};

/// A scene's sources as the kernels read them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sources {
    /// Points of light.
    pub spheres: Vec<layout::Sphere>,
    /// Lines of light.
    pub cylinders: Vec<layout::Cylinder>,
    /// Half-lines of light.
    pub beams: Vec<layout::Beam>,
    /// Rings of light.
    pub tori: Vec<layout::Torus>,
    /// Curves of light.
    pub curves: Vec<layout::Curve>,
    /// Pieces of all curves' intensity series.
    pub spline_pieces: Vec<layout::SplinePiece>,
}

/// Where the float32 coordinates begin, and what every emission is multiplied with.
#[derive(Debug, Clone, Copy)]
struct Frame {
    origin: DVec3,
    reach: f64,
    measure: f64,
}

impl Frame {
    fn position(&self, point: DVec3) -> Fine {
        fine(point - self.origin)
    }

    fn emission(&self, coefficient: f64, color: DVec3) -> [f32; 4] {
        vector(color * (coefficient * self.measure))
    }
}

impl Sources {
    /// Packs all sources of a valid scene as seen from `origin`, world space, for rays that stay within `reach` of it.
    /// With [`Measure::Length`] every emission is multiplied with `ray_length`, `|E - S|`.
    pub fn new(scene: &Scene, origin: DVec3, reach: f64, ray_length: f64) -> Self {
        let measure = match scene.integration.measure {
            Measure::Parameter => 1.0,
            Measure::Length => ray_length,
        };
        let frame = Frame {
            origin,
            reach,
            measure,
        };
        let mut packed = Self {
            spheres: scene.spheres.iter().map(|s| sphere(&frame, s)).collect(),
            cylinders: scene
                .cylinders
                .iter()
                .map(|c| cylinder(&frame, c))
                .collect(),
            beams: scene.beams.iter().map(|b| beam(&frame, b)).collect(),
            tori: scene.tori.iter().map(|t| torus(&frame, t)).collect(),
            curves: Vec::new(),
            spline_pieces: Vec::new(),
        };
        for curve in &scene.curves {
            let begin = packed.spline_pieces.len();
            let [b0, b1, b2] = curve.control_points;
            let mut coefficient = curve.coefficient;
            match curve.intensity.as_deref() {
                // A point is nearest at t = 0, whatever the series holds beyond.
                Some([first, ..]) if b0 == b1 && b1 == b2 => coefficient *= first,
                Some(series) => packed.spline_pieces.extend(curve::spline_pieces(series)),
                None => {}
            }
            let spline = begin as u32..packed.spline_pieces.len() as u32;
            let emission = frame.emission(coefficient, curve.color);
            packed
                .curves
                .push(curve::curve(&frame, curve, emission, spline));
        }
        packed
    }
}

impl Sources {
    /// Whether any source falls off with the squared distance.
    pub fn have_squares(&self) -> bool {
        let open = (self.spheres.iter().map(|s| s.is_square))
            .chain(self.cylinders.iter().map(|c| c.is_square))
            .chain(self.beams.iter().map(|b| b.is_square));
        let closed =
            (self.tori.iter().map(|t| t.is_square)).chain(self.curves.iter().map(|c| c.is_square));
        open.chain(closed).any(|is_square| is_square == 1)
    }
}

/// The view plane, and what is integrated along its rays, as the kernels read it.
pub fn view(plane: &ViewPlane, scene: &Scene) -> layout::View {
    let [first_pixel, column_step, row_step] =
        [plane.first_pixel, plane.column_step, plane.row_step].map(fine);
    layout::View {
        first_pixel: first_pixel.value,
        column_step: column_step.value,
        row_step: row_step.value,
        first_pixel_rest: first_pixel.rest,
        column_step_rest: column_step.rest,
        row_step_rest: row_step.rest,
        ray_length: plane.ray_length as f32,
        width: scene.image.width,
        height: scene.image.height,
        ..depth_limits(plane, scene)
    }
}

/// What depths are lengths of, and which hide all of any ray; a little less than float32 may say.
fn depth_limits(plane: &ViewPlane, scene: &Scene) -> layout::View {
    const MARGIN: f64 = 1e-5;
    let along = scene.depth.as_ref().map(DepthImage::along);
    let near_plane = match along {
        Some(DepthAlong::Axis) => plane.near,
        Some(DepthAlong::Ray) | None => 0.0,
    };
    layout::View {
        near_plane: near_plane as f32,
        near_plane_rest: rest(near_plane),
        hides_all: ((1.0 - MARGIN) * plane.near) as f32,
        ..view_of_rays(scene)
    }
}

/// What is integrated along single rays, as the kernels read it; the view itself plays no part.
pub fn view_of_rays(scene: &Scene) -> layout::View {
    let softening = scene.integration.softening;
    layout::View {
        softening2: (softening * softening) as f32,
        decay_strength: scene.decay.map_or(1.0, |decay| decay.alpha / decay.beta) as f32,
        decay_beta: scene.decay.map_or(0.0, |decay| decay.beta) as f32,
        decay_per_beta: scene.decay.map_or(0.0, |decay| 1.0 / decay.beta) as f32,
        ..Zeroable::zeroed()
    }
}

/// A ray as the kernels read it, its origin seen from `origin`.
pub fn ray(ray: &Ray, origin: DVec3) -> layout::RayRecord {
    let (origin, span) = (fine(ray.origin - origin), fine(ray.span));
    layout::RayRecord {
        origin: origin.value,
        origin_rest: origin.rest,
        span: span.value,
        span_rest: span.rest,
    }
}

/// The nodes of the composite Simpson rule, the decay in their weights.
pub fn nodes(divisions: u32, decay: Option<Decay>) -> Vec<layout::Node> {
    simpson_nodes(divisions)
        .map(|(s, weight)| layout::Node {
            s: s as f32,
            weight: (weight * decay.map_or(1.0, |decay| decay.at(s))) as f32,
        })
        .collect()
}

fn sphere(frame: &Frame, sphere: &Sphere) -> layout::Sphere {
    let center = frame.position(sphere.center);
    layout::Sphere {
        center: center.value,
        center_rest: center.rest,
        emission: frame.emission(sphere.coefficient, sphere.color),
        is_square: is_square(sphere.profile),
        ..Zeroable::zeroed()
    }
}

fn cylinder(frame: &Frame, cylinder: &Cylinder) -> layout::Cylinder {
    let (point, direction) = line(frame, cylinder.point, cylinder.direction);
    layout::Cylinder {
        point: point.value,
        point_rest: point.rest,
        direction: direction.value,
        direction_rest: direction.rest,
        emission: frame.emission(cylinder.coefficient, cylinder.color),
        is_square: is_square(cylinder.profile),
        ..Zeroable::zeroed()
    }
}

fn beam(frame: &Frame, beam: &Beam) -> layout::Beam {
    let tip = frame.position(beam.tip);
    let per_taper = beam.taper_length.map_or(0.0, |length| 1.0 / length);
    let (point, direction) = line(frame, beam.tip, beam.direction);
    layout::Beam {
        tip: tip.value,
        tip_rest: tip.rest,
        point: point.value,
        point_rest: point.rest,
        direction: direction.value,
        direction_rest: direction.rest,
        emission: frame.emission(1.0, beam.color),
        line: beam.coefficient as f32,
        cap: beam.cap() as f32,
        sphere: beam.sphere_coefficient as f32,
        per_taper: per_taper as f32,
        per_taper_rest: rest(per_taper),
        is_square: is_square(beam.profile),
        ..Zeroable::zeroed()
    }
}

/// A line's point nearest to the eye, and its direction.
fn line(frame: &Frame, point: DVec3, direction: DVec3) -> (Fine, Fine) {
    let direction = direction.normalize();
    let to_eye = frame.origin - point;
    let nearest_to_eye = point + direction * to_eye.dot(direction);
    (frame.position(nearest_to_eye), fine(direction))
}

fn is_square(profile: Profile) -> u32 {
    u32::from(profile == Profile::InverseSquare)
}

fn torus(frame: &Frame, torus: &Torus) -> layout::Torus {
    let (center, axis) = (frame.position(torus.center), fine(torus.axis.normalize()));
    layout::Torus {
        center: center.value,
        center_rest: center.rest,
        axis: axis.value,
        axis_rest: axis.rest,
        emission: frame.emission(torus.coefficient, torus.color),
        major_radius: torus.major_radius as f32,
        major_radius_rest: rest(torus.major_radius),
        is_square: is_square(torus.profile),
        padding: 0,
    }
}

/// A vector as two of float32.
#[derive(Debug, Clone, Copy)]
struct Fine {
    value: [f32; 4],
    rest: [f32; 4],
}

fn fine(v: DVec3) -> Fine {
    let value = v.as_vec3();
    Fine {
        value: vector(v),
        rest: vector(v - value.as_dvec3()),
    }
}

/// What float32 leaves of a number.
fn rest(value: f64) -> f32 {
    (value - f64::from(value as f32)) as f32
}

fn vector(v: DVec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}
