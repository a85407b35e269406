//! One core of many pieces.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::core::ball_around;
use super::{Brightness, Core, HasLight, Light, Placement, Profile, SourceKind, item, source, source_struct};
use crate::scene::colors::read_some_colors;
use crate::scene::values::{Checked, Fault, finite, positive, read_vectors, vector};

source_struct! {
    /// A chain of light: one core of many pieces, whose field is that of the nearest point of them all. Joints are no
    /// brighter than what lies beside them.
    #[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
    #[serde(deny_unknown_fields)]
    pub struct LightPath {
        /// What the shape goes through, or is drawn towards; at least two points.
        #[serde(deserialize_with = "read_vectors")]
        pub points: Vec<DVec3>,
        /// How the points make the core.
        #[serde(default)]
        pub shape: PathShape,
        /// Whether the last point is joined to the first.
        #[serde(default)]
        pub closed: bool,
        /// How far the straight pieces that devices draw may be off a curved shape, world units; `None`: as the
        /// tolerance asks, and less than a hundredth of a pixel.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub flatness: Option<f64>,
        /// What the light is multiplied with along the core: values at equal steps of its length, linear between, at
        /// least 2; `None`: 1 everywhere.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub intensity: Option<Vec<f64>>,
        /// The same for each of red, green and blue.
        #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "read_some_colors")]
        pub colors: Option<Vec<DVec3>>,
    }
}

/// How the points of a [`LightPath`] make its core.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum PathShape {
    /// Straight from point to point.
    #[default]
    Polyline,
    /// A smooth curve through all points: a uniform Catmull-Rom spline (Catmull, Rom 1974). At the ends of an open one
    /// it sets out straight for the second point.
    Spline,
    /// Quadratic Bezier curves: end, control point, end, control point, end and so on.
    Quadratic,
    /// Cubic Bezier curves: end, two control points, end, two control points, end and so on.
    Cubic,
}

impl PathShape {
    /// Returns how many points lie from one end of a piece to the next.
    fn step(self) -> usize {
        match self {
            Self::Polyline | Self::Spline => 1,
            Self::Quadratic => 2,
            Self::Cubic => 3,
        }
    }
}

/// A polynomial piece of a path: `c0 + c1 t + c2 t^2 + c3 t^3`, t in `[0,1]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PathPiece(pub [DVec3; 4]);

impl PathPiece {
    fn cubic([b0, b1, b2, b3]: [DVec3; 4]) -> Self {
        Self([
            b0,
            3.0 * (b1 - b0),
            3.0 * (b0 - 2.0 * b1 + b2),
            b3 - b0 + 3.0 * (b1 - b2),
        ])
    }

    fn quadratic([b0, b1, b2]: [DVec3; 3]) -> Self {
        Self([b0, 2.0 * (b1 - b0), b0 - 2.0 * b1 + b2, DVec3::ZERO])
    }

    fn straight(from: DVec3, to: DVec3) -> Self {
        Self([from, to - from, DVec3::ZERO, DVec3::ZERO])
    }

    pub(crate) fn at(&self, t: f64) -> DVec3 {
        let [c0, c1, c2, c3] = self.0;
        ((c3 * t + c2) * t + c1) * t + c0
    }

    /// Returns a ball in which it lies: its centre and radius.
    pub(crate) fn ball(&self) -> (DVec3, f64) {
        let [_, c1, c2, c3] = self.0;
        let half = 0.5 * (c1.length() + c2.length() + c3.length());
        (self.at(0.5), half.max(self.at(0.5).distance(self.at(1.0))))
    }

    /// Returns how far a chord over all of it is off at most: an eighth of its greatest second derivative. Chords over
    /// a k-th of it are off by that over k squared.
    fn bulge(&self) -> f64 {
        let [_, _, c2, c3] = self.0;
        let bend = (2.0 * c2).length().max((2.0 * c2 + 6.0 * c3).length());
        bend / 8.0
    }
}

/// A chain of straight lines in the place of a path.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PathLevel {
    pub corners: Vec<DVec3>,
    /// How far it is off the path at most.
    pub off: f64,
}

/// Most chords that a piece is cut into, and how often their number is halved.
const MOST_CHORDS: usize = 4096;
const MOST_HALVINGS: u32 = 7;

/// Most points of a path.
const MOST_POINTS: usize = 65_536;

/// Cuts of a piece where only roughly counts where it is.
const ROUGH_CHORDS: usize = 16;

impl LightPath {
    /// Makes a white chain of straight lines.
    #[must_use]
    pub fn new(points: Vec<DVec3>) -> Self {
        source!(Self {
            points,
            shape: PathShape::default(),
            closed: false,
            flatness: None,
            intensity: None,
            colors: None,
        })
    }

    /// Returns its polynomial pieces, one after another.
    pub(crate) fn pieces(&self) -> Vec<PathPiece> {
        let count = self.points.len();
        let step = self.shape.step();
        let pieces = match self.closed {
            true => count / step,
            false => count.saturating_sub(1) / step,
        };
        let point = |k: usize| self.points[k % count];
        let piece = |i: usize| {
            let k = i * step;
            match self.shape {
                PathShape::Polyline => PathPiece::straight(point(k), point(k + 1)),
                PathShape::Spline => {
                    let (from, to) = (point(k), point(k + 1));
                    let before = match (self.closed, k) {
                        (false, 0) => 2.0 * from - to,
                        _ => point(k + count - 1),
                    };
                    let after = match (self.closed, i + 1 == pieces) {
                        (false, true) => 2.0 * to - from,
                        _ => point(k + 2),
                    };
                    PathPiece::cubic([from, from + (to - before) / 6.0, to - (after - from) / 6.0, to])
                }
                PathShape::Quadratic => PathPiece::quadratic([k, k + 1, k + 2].map(point)),
                PathShape::Cubic => PathPiece::cubic([k, k + 1, k + 2, k + 3].map(point)),
            }
        };
        (0..pieces).map(piece).collect()
    }

    /// Returns chains of straight lines, the first off by no more than the path's flatness, or where it has none, what
    /// `default` says of a piece; each of the others has about half as many as the one before.
    pub(crate) fn levels(&self, default: impl Fn(&PathPiece) -> f64) -> Vec<PathLevel> {
        let flatness = |piece: &PathPiece| self.flatness.unwrap_or_else(|| default(piece));
        let finest = |piece: &PathPiece| {
            let chords = (piece.bulge() / flatness(piece)).sqrt().ceil();
            chords.clamp(1.0, MOST_CHORDS as f64) as usize
        };
        let pieces = self.pieces();
        let most = pieces.iter().map(finest).max().unwrap_or(1);
        let level = |halvings: u32| {
            let chords = |piece: &PathPiece| finest(piece).div_ceil(1 << halvings);
            let off = |piece: &PathPiece| piece.bulge() / (chords(piece) as f64).powi(2);
            PathLevel {
                corners: corners(&pieces, chords),
                off: pieces.iter().map(off).fold(0.0, f64::max),
            }
        };
        (0..=most.ilog2().min(MOST_HALVINGS)).map(level).collect()
    }

    fn check_points(&self) -> Checked {
        let fault = |message: String| Err(Fault::new("points", message));
        let count = self.points.len();
        if count < 2 {
            return fault(format!("a path has at least two points, found {count}"));
        }
        if count > MOST_POINTS {
            return fault(format!("{count} points; a path has at most {MOST_POINTS}: make several"));
        }
        let step = self.shape.step();
        let (rest, example) = match self.closed {
            true => (count % step, 2 * step),
            false => ((count - 1) % step, step + 1),
        };
        if rest != 0 {
            let (kind, form) = match self.shape {
                PathShape::Quadratic => ("quadratic", "end and control point in turn"),
                _ => ("cubic", "an end and two control points in turn"),
            };
            let joined = if self.closed { "closed" } else { "open" };
            return fault(format!(
                "{count} points make no {joined} chain of {kind} curves: {form}, such as {example} or {} points",
                example + step
            ));
        }
        for (k, point) in self.points.iter().enumerate() {
            vector("points", *point).map_err(|fault| fault.at(item("points", k)))?;
        }
        self.flatness
            .map_or(Ok(()), |flatness| positive("flatness", flatness))
    }
}

/// Returns the corners of chords of pieces, one after another. No two corners that follow each other are equal; there
/// is at least one.
fn corners(pieces: &[PathPiece], chords: impl Fn(&PathPiece) -> usize) -> Vec<DVec3> {
    let mut corners = Vec::with_capacity(pieces.len() + 1);
    corners.extend(pieces.first().map(|piece| piece.at(0.0)));
    for piece in pieces {
        let count = chords(piece);
        corners.extend((1..=count).map(|k| piece.at(k as f64 / count as f64)));
    }
    corners.dedup();
    corners
}

/// A light of a path, and what it is multiplied with: knots at shares of the core's length, with a value at each,
/// linear between; none: 1 everywhere.
pub(crate) type LightAlong = (Light, Vec<(f64, f64)>);

impl LightPath {
    /// Checks what the light is multiplied with, and returns the greatest of it.
    fn check_series(&self) -> std::result::Result<f64, Fault> {
        let mut strongest = 1.0;
        if let Some(series) = &self.intensity {
            check_length("intensity", series.len())?;
            for (k, value) in series.iter().enumerate() {
                finite("intensity", *value).map_err(|fault| fault.at(item("intensity", k)))?;
            }
            strongest *= series.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        }
        if let Some(colors) = &self.colors {
            check_length("colors", colors.len())?;
            for (k, color) in colors.iter().enumerate() {
                vector("colors", *color).map_err(|fault| fault.at(item("colors", k)))?;
            }
            let most = |color: &DVec3| color.abs().max_element();
            strongest *= colors.iter().map(most).fold(0.0, f64::max);
        }
        Ok(strongest)
    }

    /// Returns a light with what it is multiplied with along the core; its red, green and blue apart where that is not
    /// the same for all.
    pub(crate) fn along(&self, light: &Light) -> Vec<LightAlong> {
        let Some(colors) = &self.colors else {
            let series = self.intensity.as_deref().unwrap_or_default();
            return vec![(*light, knots(series.len()).map(|s| (s, at_share(series, s))).collect())];
        };
        let intensity = self.intensity.as_deref().unwrap_or(&[1.0, 1.0]);
        let mut shares: Vec<f64> = knots(colors.len()).chain(knots(intensity.len())).collect();
        shares.sort_by(f64::total_cmp);
        shares.dedup();
        let of_channel = |axis: DVec3| {
            let channel: Vec<f64> = colors.iter().map(|color| color.dot(axis)).collect();
            let value = |s: &f64| (*s, at_share(&channel, *s) * at_share(intensity, *s));
            let color = light.color * axis;
            (Light { color, ..*light }, shares.iter().map(value).collect())
        };
        DVec3::AXES.map(of_channel).into()
    }
}

/// Returns where along a core the values of a series are: equal shares of its length.
fn knots(count: usize) -> impl Iterator<Item = f64> {
    let last = count.max(2) - 1;
    (0..count).map(move |k| k as f64 / last as f64)
}

/// Returns a series at a share of the core's length.
fn at_share(series: &[f64], share: f64) -> f64 {
    let scaled = share * (series.len() - 1) as f64;
    let piece = (scaled as usize).min(series.len() - 2);
    let (from, to) = (series[piece], series[piece + 1]);
    from + (to - from) * (scaled - piece as f64)
}

fn check_length(key: &'static str, found: usize) -> Checked {
    match found {
        0 | 1 => {
            let message = format!("needs at least 2 values, from one end to the other; found {found}");
            Err(Fault::new(key, message))
        }
        _ => Ok(()),
    }
}

impl SourceKind for LightPath {
    fn check(&self, brightness: &Brightness) -> Checked {
        self.check_points()?;
        let strongest = self.check_series()?;
        self.shared()
            .check(brightness, &|light| strongest * light.coefficient.abs())
    }

    fn move_core(&mut self, place: &Placement) {
        for point in &mut self.points {
            *point = place.point(*point);
        }
        self.flatness = self.flatness.map(|flatness| place.scale * flatness);
    }

    fn core(&self) -> Core {
        Core::Chain(corners(&self.pieces(), |piece| match piece.bulge() {
            0.0 => 1,
            _ => ROUGH_CHORDS,
        }))
    }

    fn ball(&self) -> Option<(DVec3, f64)> {
        Some(ball_around(self.pieces().iter().map(PathPiece::ball)))
    }

    fn for_each_emission(&self, add: &mut dyn FnMut(DVec3)) {
        for (light, knots) in self.lights().flat_map(|light| self.along(&light)) {
            match knots.is_empty() {
                true => add(light.emission()),
                false => knots.iter().for_each(|(_, value)| add(*value * light.emission())),
            }
        }
    }

    fn with_series(self) -> Self {
        Self {
            intensity: Some(vec![0.6, 1.0, 0.3, 0.8]),
            ..self
        }
    }

    fn specimen(place: DVec3, profile: Profile) -> Self {
        let points = [(-1.2, 0.9), (-0.4, -0.6), (0.3, 0.8), (1.1, -0.4), (0.5, -0.9)];
        Self {
            color: DVec3::new(0.4, 1.0, 0.7),
            profile,
            ..Self::new(points.map(|(x, z)| place + DVec3::new(x, 0.4 * z, z)).to_vec())
        }
    }
}
