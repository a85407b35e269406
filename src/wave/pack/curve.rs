//! A Bezier curve on the device (`cl/wave/source/curve.h`), in its own frame: the plane of its parabola, origin C(1/2).

use bytemuck::Zeroable;
use glam::DVec3;

use super::{Anchor, Pack, Row, Rows, device_struct, fine, falloff, scene, vector};
use super::layout::Falloff;
use crate::scene::Light;

/// Below this ratio of `|C2|` to `|C'(1/2)|` a curve counts as straight: the cubic's roots would lose digits to its
/// far-off vertex, while the kernels' foot on the tangent needs two Newton steps.
const STRAIGHT: f64 = 1e-3;

/// Below this one it is a line that is run through evenly, but for the rounding of float64.
const LINE: f64 = 1e-13;

/// So does one whose bend is below this share of the distances to it: the cubic's coefficients would overflow.
const TINY: f64 = 1e-12;

device_struct! {
    /// A quadratic curve of light.
    Curve [208] {
        middle: [f32; 4] = 0,
        middle_rest: [f32; 4] = 16,
        velocity: [f32; 4] = 32,
        velocity_rest: [f32; 4] = 48,
        second: [f32; 4] = 64,
        second_rest: [f32; 4] = 80,
        along: [f32; 4] = 96,
        across: [f32; 4] = 112,
        normal: [f32; 4] = 128,
        emission: [f32; 4] = 144,
        velocity_along: f32 = 160,
        velocity_across: f32 = 164,
        bend: f32 = 168,
        vertex: f32 = 172,
        is_straight: u32 = 176,
        spline_begin: u32 = 180,
        spline_count: u32 = 184,
        padding: u32 = 188,
        falloff: Falloff = 192,
    }
}

impl Pack for scene::Curve {
    type Device = Curve;

    fn pack(&self, light: &Light, anchor: &Anchor, rows: &mut Rows) -> Curve {
        let begin = rows.list.len();
        let [b0, b1, b2] = self.control_points;
        let mut coefficient = light.coefficient;
        match self.intensity.as_deref() {
            // A point is nearest at t = 0, whatever the series holds beyond.
            Some([first, ..]) if b0 == b1 && b1 == b2 => coefficient *= first,
            Some(series) => {
                // What the kernels call unseen is measured by an intensity of 1.
                let most = series.iter().fold(0.0, |most: f64, w| most.max(w.abs()));
                let per_most = if most > 0.0 { most.recip() } else { 1.0 };
                coefficient *= most;
                rows.list.extend(spline_pieces(series, per_most));
                rows.has_series = true;
            }
            None => {}
        }
        let spline = begin as u32..rows.list.len() as u32;
        Curve {
            emission: anchor.emission(coefficient, light.color),
            spline_begin: spline.start,
            spline_count: spline.end - spline.start,
            falloff: falloff(light.falloff),
            ..shape(anchor, self.control_points)
        }
    }
}

/// Packs where a curve is.
fn shape(anchor: &Anchor, [b0, b1, b2]: [DVec3; 3]) -> Curve {
    let velocity = b2 - b0; // C'(1/2)
    let bent = b0 - 2.0 * b1 + b2;
    let rounding = LINE * (b0.length() + b1.length() + b2.length());
    let is_line = bent.length() <= rounding && velocity.length() > 0.0;
    let c2 = if is_line { DVec3::ZERO } else { bent };
    let middle = 0.25 * b0 + 0.5 * b1 + 0.25 * b2;
    let bend = c2.length();
    let far = TINY * (anchor.reach + middle.distance(anchor.origin));
    let is_straight = bend <= STRAIGHT * velocity.length() || bend < far;
    // `across` follows C2 where there is any; what lies perpendicular to the velocity serves the rest.
    let across = c2
        .try_normalize()
        .or_else(|| velocity.try_normalize().map(|v| v.any_orthonormal_vector()))
        .unwrap_or(DVec3::Y);
    let along = velocity - across * velocity.dot(across);
    // Exactly 0 on a fold, which runs twice through the same points: equal distances then stay equal.
    let is_fold = along.length() <= 1e-12 * velocity.length();
    let (along, velocity_along) = if is_fold {
        (across.any_orthonormal_vector(), 0.0)
    } else {
        (along.normalize(), along.length())
    };
    let velocity_across = velocity.dot(across);
    let (middle, world_velocity, second) = (anchor.position(middle), fine(velocity), fine(c2));
    Curve {
        middle: middle.value,
        middle_rest: middle.rest,
        velocity: world_velocity.value,
        velocity_rest: world_velocity.rest,
        second: second.value,
        second_rest: second.rest,
        along: vector(along),
        across: vector(across),
        normal: vector(along.cross(across)),
        velocity_along: velocity_along as f32,
        velocity_across: velocity_across as f32,
        bend: bend as f32,
        vertex: if is_straight {
            0.0
        } else {
            (0.5 * velocity_across / bend) as f32
        },
        is_straight: u32::from(is_straight) + u32::from(is_line),
        ..Zeroable::zeroed()
    }
}

/// Returns the polynomial pieces of the clamped uniform quadratic B-spline (2015, eq. 14-16): each is a quadratic
/// Bezier whose inner control value is the weight, and whose ends are the means of two weights, or an end weight
/// itself; all times a scale.
fn spline_pieces(series: &[f64], scale: f64) -> impl Iterator<Item = Row> {
    let last = series.len() - 1;
    let joint = move |i: usize| match i {
        0 => series[0],
        i if i == last - 1 => series[last],
        i => 0.5 * (series[i] + series[i + 1]),
    };
    (0..last - 1).map(move |i| {
        let (from, control, to) = (joint(i), series[i + 1], joint(i + 1));
        let coefficients = [from, 2.0 * (control - from), from - 2.0 * control + to, 0.0];
        coefficients.map(|c| (scale * c) as f32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::b_spline;

    #[test]
    fn the_pieces_are_the_spline() {
        for series in [
            vec![1.0, 0.6, 0.2, 0.4, 0.8, 0.6, 1.0],
            vec![2.0, 5.0, 3.0],
            vec![0.1, 0.9, 0.4, 0.7],
        ] {
            let pieces: Vec<_> = spline_pieces(&series, 0.5).collect();
            assert_eq!(pieces.len(), series.len() - 2);
            for k in 0..=100 {
                let t = f64::from(k) / 100.0;
                let scaled = t * pieces.len() as f64;
                let index = (scaled as usize).min(pieces.len() - 1);
                let x = scaled - index as f64;
                let [c0, c1, c2, _] = pieces[index].map(f64::from);
                let value = c0 + x * (c1 + x * c2);
                let expected = 0.5 * b_spline(&series, t);
                assert!((value - expected).abs() < 1e-6, "{t}: {value} {expected}");
            }
        }
    }
}
