//! What casts light on surfaces: the cores of all sources, in parts of few forms, with what each emits.
//!
//! A core emits evenly in all directions, a point its intensity, every other core one per length. A core has one
//! emission, whatever its layers: that of all its lights.

use glam::DVec3;

use super::chain::{LitChain, Piece, Run, series_at};
use super::kinds::for_each_kind;
use super::source::{Core, Falloff, Light, SourceKind};
use super::{Lighting, Scene};

/// Where a part of a core is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum EmitterCore {
    Point(DVec3),
    /// From where to where along a line, world units; an end may be at infinity, the light is then even.
    Line {
        point: DVec3,
        /// Of length 1.
        direction: DVec3,
        range: [f64; 2],
    },
    /// A part of a circle: `center + x cos + y sin`, x and y perpendicular and as long as the radius; radians.
    Arc {
        center: DVec3,
        x: DVec3,
        y: DVec3,
        angles: [f64; 2],
    },
    Curve(Piece),
}

/// A part of a core, and what it emits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Emitter {
    pub core: EmitterCore,
    /// Linear RGB where it begins, at the middle of its parameter and where it ends, a parabola between; the intensity
    /// of a point, else one per length, in world units.
    pub light: [DVec3; 3],
    /// Within which its light grows no more, world units.
    pub radius: f64,
    /// The table and the number of its source.
    pub source: (&'static str, usize),
}

/// Hears a part of a core, and its light as that of [`Emitter`].
pub(crate) type AddEmitter<'a> = &'a mut dyn FnMut(EmitterCore, [DVec3; 3]);

/// A line this long has no end.
const ENDLESS: f64 = 1e9;

/// How near to a core its light grows no more: as a share of its size, and where it has none.
const OF_SIZE: f64 = 1e-3;
const WITHOUT_SIZE: f64 = 1e-3;

macro_rules! define_emitters {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        impl Scene {
            /// Returns what casts light on surfaces, of a valid scene that is lit so.
            pub(crate) fn emitters(&self, lighting: &Lighting) -> Vec<Emitter> {
                let mut emitters = Vec::new();
                if lighting.cast {
                    $(for (index, source) in self.$list.iter().enumerate() {
                        let named = (source, (stringify!($kind), index));
                        add_emitters(named, lighting, &mut emitters);
                    })*
                }
                emitters
            }
        }
    };
}
for_each_kind!(define_emitters);

fn add_emitters<T: SourceKind>(
    (source, name): (&T, (&'static str, usize)),
    lighting: &Lighting,
    emitters: &mut Vec<Emitter>,
) {
    let of_size = |source: &T| match source.core().ball() {
        Some((_, radius)) if radius > 0.0 => OF_SIZE * 2.0 * radius,
        _ => WITHOUT_SIZE,
    };
    let radius = lighting.radius.unwrap_or_else(|| of_size(source));
    source.for_each_emitter(&mut |core, light| {
        let light = light.map(|it| lighting.gain * it);
        if light != [DVec3::ZERO; 3] {
            emitters.push(Emitter {
                core,
                light,
                radius,
                source: name,
            });
        }
    });
}

/// Returns what the lights of a core make together, each times `cast` of how it falls off.
pub(crate) fn emission(
    lights: impl Iterator<Item = Light>,
    cast: impl Fn(&Falloff) -> f64,
) -> DVec3 {
    lights
        .map(|light| cast(&light.falloff) * light.emission())
        .sum()
}

/// Adds the emitters of a source whose light is the same all along its core, unless it is drawn as chains.
pub(super) fn add_even(source: &impl SourceKind, add: AddEmitter<'_>) {
    if let Some(chains) = source.as_chains() {
        chains.iter().for_each(|lit| lit.for_each_emitter(add));
        return;
    }
    let by_length = || [emission(source.lights(), Falloff::cast_by_line); 3];
    match source.core() {
        Core::Bezier([a, b, c]) if a == b && b == c => {
            add(
                EmitterCore::Point(a),
                [emission(source.lights(), Falloff::cast_by_point); 3],
            );
        }
        Core::Bezier([a, b, c]) => match b == (a + c) / 2.0 {
            true => add(straight(a, c), by_length()),
            false => add(EmitterCore::Curve(Piece::quadratic([a, b, c])), by_length()),
        },
        Core::Line {
            point,
            direction,
            begins,
        } => {
            let begin = if begins { 0.0 } else { f64::NEG_INFINITY };
            let line = EmitterCore::Line {
                point,
                direction,
                range: [begin, f64::INFINITY],
            };
            add(line, by_length());
        }
        Core::Circle {
            center,
            axis,
            radius,
        } => {
            let x = axis.any_orthonormal_vector();
            let arc = EmitterCore::Arc {
                center,
                x: radius * x,
                y: radius * axis.cross(x),
                angles: [0.0, std::f64::consts::TAU],
            };
            add(arc, by_length());
        }
        Core::Chain(_) => {} // is drawn as chains
    }
}

/// Makes the core of a straight line between two points.
fn straight(from: DVec3, to: DVec3) -> EmitterCore {
    let length = from.distance(to);
    EmitterCore::Line {
        point: from,
        direction: (to - from) / length,
        range: [
            0.0,
            if length < ENDLESS {
                length
            } else {
                f64::INFINITY
            },
        ],
    }
}

/// Knots this close together, in shares of a run, are one.
const LEAST_STEP: f64 = 1e-9;

impl LitChain {
    /// Returns what all lights emit at a place of a run, by `cast`.
    fn emission(&self, run: &Run, own: f64, cast: impl Fn(&Falloff) -> f64) -> DVec3 {
        let share = run.share(own);
        let of_light = |it: &super::chain::LightAlong| {
            let thickest = it.radii.iter().map(|(_, radius)| *radius);
            let falloff = Falloff {
                radius: thickest.fold(it.light.falloff.radius, f64::max),
                ..it.light.falloff
            };
            cast(&falloff) * series_at(&it.values, share, 1.0) * it.light.emission()
        };
        run.fade(own) * self.lights.iter().map(of_light).sum::<DVec3>()
    }

    /// Returns what they emit at the ends and in the middle of a part of a run.
    pub(super) fn light_over(&self, run: &Run, [from, middle, to]: [f64; 3]) -> [DVec3; 3] {
        [from, middle, to].map(|own| self.emission(run, own, Falloff::cast_by_line))
    }

    /// Returns where light bends along a run, from 0 to 1, with `more` places.
    pub(super) fn knots(&self, run: &Run, more: &[f64]) -> Vec<f64> {
        let [begin, end] = run.shares;
        let of_light = |it: &super::chain::LightAlong| {
            let series = it.values.iter().chain(&it.radii).map(|(share, _)| *share);
            series.collect::<Vec<_>>()
        };
        let shares = self.lights.iter().flat_map(of_light);
        let own = shares.map(|share| (share - begin) / (end - begin));
        let mut knots: Vec<f64> = own.chain(more.iter().copied()).collect();
        knots.retain(|own| *own > LEAST_STEP && *own < 1.0 - LEAST_STEP);
        knots.extend([0.0, 1.0]);
        knots.sort_by(f64::total_cmp);
        knots.dedup_by(|b, a| *b - *a < LEAST_STEP);
        knots
    }

    /// Calls `add` with all parts of the core along which light is no more than bent.
    pub(super) fn for_each_emitter(&self, add: AddEmitter<'_>) {
        for run in &self.chain.runs {
            let lengths = run.lengths();
            let length: f64 = lengths.iter().sum();
            if length == 0.0 {
                let light = self.emission(run, 0.0, Falloff::cast_by_point);
                if let Some(piece) = run.pieces.first() {
                    add(EmitterCore::Point(piece.at(0.0)), [light; 3]);
                }
                continue;
            }
            let mut begin = 0.0;
            let joints: Vec<f64> = std::iter::once(0.0)
                .chain(lengths.iter().map(|own| {
                    begin += own;
                    begin / length
                }))
                .collect();
            let knots = self.knots(run, &joints);
            for pair in knots.windows(2) {
                let [from, to] = [pair[0], pair[1]];
                let after = joints.partition_point(|joint| *joint <= 0.5 * (from + to));
                let index = after.clamp(1, lengths.len()) - 1;
                let own = |share: f64| share * length - joints[index] * length;
                let part = run.pieces[index].between(lengths[index], own(from), own(to));
                let half = part.length(0.5) / part.length(1.0);
                let core = match part.is_straight() {
                    true => straight(part.at(0.0), part.at(1.0)),
                    false => EmitterCore::Curve(part),
                };
                add(
                    core,
                    self.light_over(run, [from, from + half * (to - from), to]),
                );
            }
        }
    }
}
