//! The struct of `cl/light/types.h`, and what packs emitters into it, as seen from an origin that surfaces share.
//!
//! Cubic curves are cut until they hardly differ from quadratic ones, k equal parts of which are off by
//! `sqrt(3)/36 |c3| / k^3` at most, c3 the coefficient of t^3.

use bytemuck::Zeroable;
use glam::DVec3;

use crate::opencl::{StructLayout, device_struct};
use crate::scene::{Emitter, EmitterCore, Piece};

device_struct! {
    /// A part of a core that casts light.
    CastLight [128] {
        place: [f32; 4] = 0,
        along: [f32; 4] = 16,
        across: [f32; 4] = 32,
        last: [f32; 4] = 48,
        light: [f32; 4] = 64,
        slope: [f32; 4] = 80,
        bend: [f32; 4] = 96,
        from: f32 = 112,
        to: f32 = 116,
        form: u32 = 120,
        padding: u32 = 124,
    }
}

/// Every struct of this engine that crosses to the device.
pub const STRUCTS: &[StructLayout] = &[<CastLight as crate::opencl::DeviceStruct>::LAYOUT];

const POINT: u32 = 0;
const LINE: u32 = 1;
const RING: u32 = 2;
const CURVE: u32 = 3;

/// How far a cubic curve may be off a quadratic one, as a share of its length.
const OF_LENGTH: f64 = 0.01;

/// Most parts of a cubic curve.
const MOST_PARTS: f64 = 64.0;

/// A vertex this near to an end, as a share of the part, is no reason to cut it.
const LEAST_PART: f64 = 1e-3;

/// Packs emitters, places relative to `origin`.
pub(crate) fn pack(emitters: &[Emitter], origin: DVec3) -> Vec<CastLight> {
    let mut packed = Vec::with_capacity(emitters.len());
    for emitter in emitters {
        pack_one(emitter, origin, &mut packed);
    }
    packed
}

fn pack_one(emitter: &Emitter, origin: DVec3, packed: &mut Vec<CastLight>) {
    let radius = emitter.radius;
    let row = |v: DVec3, last: f64| [v.x as f32, v.y as f32, v.z as f32, last as f32];
    let at = |place: DVec3| row(place - origin, radius * radius);
    let lit = lit(emitter.light);
    match emitter.core {
        EmitterCore::Point(place) => packed.push(CastLight {
            place: at(place),
            form: POINT,
            ..lit
        }),
        EmitterCore::Line {
            point,
            direction,
            range: [from, to],
        } => {
            // The parameter 0 is where it begins, or nearest to the origin.
            let zero = match from.is_finite() {
                true => from,
                false => (origin - point).dot(direction),
            };
            packed.push(CastLight {
                place: at(point + zero * direction),
                along: row(direction, 0.0),
                from: (from - zero) as f32,
                to: (to - zero) as f32,
                form: LINE,
                ..lit
            });
        }
        EmitterCore::Arc {
            center,
            x,
            y,
            angles: [from, to],
        } => packed.push(CastLight {
            place: at(center),
            along: row(x.normalize(), x.length()),
            across: row(y.normalize(), 0.0),
            from: from as f32,
            to: to as f32,
            form: RING,
            ..lit
        }),
        EmitterCore::Curve(piece) => {
            for (part, [from, to]) in curves(&piece) {
                let [c0, c1, c2, c3] = part.0;
                packed.push(CastLight {
                    place: at(c0),
                    along: row(c1, 0.0),
                    across: row(c2, 0.0),
                    last: row(c3, 0.0),
                    from: 0.0,
                    to: 1.0,
                    form: CURVE,
                    ..self::lit([from, 0.5 * (from + to), to].map(|s| parabola(emitter.light, s)))
                });
            }
        }
    }
}

/// Returns a light that is struck, without a core.
fn lit([begin, middle, end]: [DVec3; 3]) -> CastLight {
    let bend = 2.0 * (begin + end - 2.0 * middle);
    let row = |v: DVec3| [v.x as f32, v.y as f32, v.z as f32, 0.0];
    CastLight {
        light: row(begin),
        slope: row(end - begin - bend),
        bend: row(bend),
        ..Zeroable::zeroed()
    }
}

/// Returns what lies at s on the parabola through values at 0, 1/2 and 1.
pub(super) fn parabola([begin, middle, end]: [DVec3; 3], s: f64) -> DVec3 {
    let bend = 2.0 * (begin + end - 2.0 * middle);
    begin + s * (end - begin - bend + s * bend)
}

/// Returns the parts of a piece, and where on it each goes from and to, cut at their vertices: the distance from
/// anywhere has one minimum on each.
fn curves(piece: &Piece) -> Vec<(Piece, [f64; 2])> {
    let [_, _, _, c3] = piece.0;
    let off = 3.0_f64.sqrt() / 36.0 * c3.length() / (OF_LENGTH * piece.length(1.0));
    let count = off.sqrt().ceil().clamp(1.0, MOST_PARTS);
    let mut curves = Vec::new();
    for k in 0..count as u32 {
        let [from, to] = [k, k + 1].map(|k| f64::from(k) / count);
        let [_, c1, c2, c3] = piece.part(from, to).0;
        // Of the quadratic curve with the same ends.
        let (c1, c2) = (c1 - 0.5 * c3, c2 + 1.5 * c3);
        let vertex = -0.5 * c1.dot(c2) / c2.length_squared();
        let ends = match vertex > LEAST_PART && vertex < 1.0 - LEAST_PART {
            true => vec![from, from + vertex * (to - from), to],
            false => vec![from, to],
        };
        let part = |pair: &[f64]| (piece.part(pair[0], pair[1]), [pair[0], pair[1]]);
        curves.extend(ends.windows(2).map(part));
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_cut_without_a_gap_and_light_is_a_parabola() {
        let points = [
            [0.0, 0.1, 0.0],
            [1.0, 2.0, -1.0],
            [2.0, -1.0, 0.5],
            [3.0, 0.4, 1.0],
        ];
        let piece = Piece::cubic(points.map(DVec3::from));
        let curves = curves(&piece);
        assert!(curves.len() > 2, "{}", curves.len());
        let mut end = 0.0;
        for (part, [from, to]) in curves {
            assert_eq!(from, end);
            end = to;
            for t in [0.0, 0.3, 1.0] {
                assert!(part.at(t).distance(piece.at(from + t * (to - from))) < 1e-13);
            }
        }
        assert_eq!(end, 1.0);
        let values = [1.0, 3.0, 2.0].map(DVec3::splat);
        assert_eq!([0.0, 0.5, 1.0].map(|s| parabola(values, s)), values);
    }
}
