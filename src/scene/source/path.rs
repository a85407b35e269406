//! One core of many pieces.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, HasLight, Placement, Profile, SourceKind, emissions_along, item, source, source_struct};
use crate::scene::chain::{LitChain, Piece, Run};
use crate::scene::values::{Checked, Fault, positive, read_vectors, vector};

source_struct! {
    /// A chain of light: one core of many pieces, whose field is that of the nearest point of them all. Joints are no
    /// brighter than what lies beside them.
    #[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
    #[serde(deny_unknown_fields)]
    pub struct LightPath along {
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

/// Most points of a path.
const MOST_POINTS: usize = 65_536;

impl LightPath {
    /// Makes a white chain of straight lines.
    #[must_use]
    pub fn new(points: Vec<DVec3>) -> Self {
        source!(Self along {
            points,
            shape: PathShape::default(),
            closed: false,
            flatness: None,
        })
    }

    /// Returns its polynomial pieces, one after another.
    fn pieces(&self) -> Vec<Piece> {
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
                PathShape::Polyline => Piece::straight(point(k), point(k + 1)),
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
                    Piece::cubic([from, from + (to - before) / 6.0, to - (after - from) / 6.0, to])
                }
                PathShape::Quadratic => Piece::quadratic([k, k + 1, k + 2].map(point)),
                PathShape::Cubic => Piece::cubic([k, k + 1, k + 2, k + 3].map(point)),
            }
        };
        (0..pieces).map(piece).collect()
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

impl SourceKind for LightPath {
    keys! { KEYS;
        points: Vectors(2, Some(MOST_POINTS as u32)), WORLD, Required,
            "what the shape goes through, or is drawn towards";
        shape: Word(&["polyline", "spline", "quadratic", "cubic"]), NONE, Value("\"polyline\""),
            "how the points make the core";
        closed: Flag, NONE, Value("false"), "whether the last point is joined to the first";
        flatness: POSITIVE, WORLD, Otherwise("below 0.01 pixel"), "how far straight pieces may be off a curved shape";
    }

    #[cfg(feature = "files")]
    const ALONG: &[crate::scene::keys::Key] = super::shared::ALONG_KEYS;

    fn check(&self, brightness: &Brightness) -> Checked {
        self.check_points()?;
        let (along, shared) = (self.along_keys(), self.shared().adding_up());
        along.check(&shared, self.radius)?;
        along.check_arc(|| Run::whole(self.pieces()))?;
        shared.check(brightness, &|light| along.strongest() * light.coefficient.abs())
    }

    fn move_core(&mut self, place: &Placement) {
        for point in &mut self.points {
            *point = place.point(*point);
        }
        self.flatness = self.flatness.map(|flatness| place.scale * flatness);
        self.scale_along(place.scale);
    }

    fn core(&self) -> Core {
        let whole = Run::whole(self.pieces());
        Core::Chain(self.along_keys().chain(whole, self.flatness).rough_corners())
    }

    fn as_chains(&self) -> Option<Vec<LitChain>> {
        let whole = Run::whole(self.pieces());
        Some(self.along_keys().lit(whole, self.flatness, &self.shared()))
    }

    fn for_each_emission(&self, add: &mut dyn FnMut(DVec3)) {
        emissions_along(&self.along_keys().lights(&self.shared()), add);
    }

    fn uneven(&self) -> Option<&'static str> {
        self.along_keys().uneven()
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
