//! A quadratic curve of light.

use glam::DVec3;
use serde::{Deserialize, Deserializer, Serialize};

use super::{
    Brightness, Core, Falloff, HasLight, Placement, Profile, SourceKind, emissions_along, item, source, source_struct,
};
use crate::scene::Dashes;
use crate::scene::chain::{Along, LitChain, Piece, Run};
use crate::scene::emitter::{AddEmitter, EmitterCore, add_even, emission};
use crate::scene::values::{Checked, Fault, finite, read_vectors, vector};

source_struct! {
    /// A quadratic Bezier curve of light: `S(t*)/d`, or by its [`Profile`] `S(t*)/d^2`, d the distance to its nearest
    /// point `C(t*)`, `S(t*)` the local intensity there (2015, eq. 8-17).
    #[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
    #[serde(deny_unknown_fields)]
    pub struct Curve thick {
        /// Bezier control points. They may be collinear or coincide.
        #[serde(deserialize_with = "three_points")]
        pub control_points: [DVec3; 3],
        /// The local-intensity series W: weights of a clamped uniform quadratic B-spline over the curve's parameter, at
        /// least 3; `None`: 1 everywhere.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub intensity: Option<Vec<f64>>,
        /// What red, green and blue are multiplied with along the core: values at equal steps of its length, linear
        /// between, at least 2; `None`: 1 everywhere. Not with an intensity.
        #[serde(
            default,
            skip_serializing_if = "Option::is_none",
            deserialize_with = "crate::scene::colors::read_some_colors"
        )]
        pub colors: Option<Vec<DVec3>>,
        /// How thick the core is along it, in the place of `radius`, as `colors` go; world units.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub radii: Option<Vec<f64>>,
        /// Gaps that part the core. Not with an intensity.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub dashes: Option<Dashes>,
    }
}

impl Curve {
    /// Makes a white curve of even intensity.
    #[must_use]
    pub fn new(control_points: [DVec3; 3]) -> Self {
        source!(Self {
            control_points,
            intensity: None,
            colors: None,
            radii: None,
            dashes: None,
        })
    }

    /// Returns what changes along it by its length; the intensity goes by the curve's parameter.
    fn along_keys(&self) -> Along<'_> {
        Along {
            colors: self.colors.as_deref(),
            radii: self.radii.as_deref(),
            dashes: self.dashes,
            ..Along::default()
        }
    }
}

impl SourceKind for Curve {
    keys! { KEYS;
        control_points: Vectors(3, Some(3)), WORLD, Required, "three points; they may be collinear or coincide";
        intensity: Numbers(3, None), NONE, Otherwise("1 everywhere"), "weights of a quadratic B-spline over the curve";
        colors: Colors(2), "linear RGB", Otherwise("1 everywhere"),
            "what red, green and blue are multiplied with along it";
        radii: Numbers(2, None), WORLD, Otherwise("radius"), "how thick the core is along it, in the place of radius";
        dashes: Table("dashes"), NONE, Otherwise("none"), "gaps that part the core; not with an intensity";
    }

    fn check(&self, brightness: &Brightness) -> Checked {
        for (k, point) in self.control_points.iter().enumerate() {
            vector("control_points", *point).map_err(|fault| fault.at(item("control_points", k)))?;
        }
        let series = self.intensity.iter().flatten();
        let strongest = series.fold(1.0_f64, |most, value| most.max(value.abs()));
        let strongest = strongest.max(self.along_keys().strongest());
        self.shared()
            .check(brightness, &|light| strongest * light.coefficient.abs())?;
        let along = self.along_keys();
        along.check(&self.shared(), self.radius)?;
        let Some(series) = &self.intensity else {
            return Ok(());
        };
        if !along.is_even() {
            return Err(Fault::new(
                "intensity",
                "goes by the curve's parameter, colors, radii and dashes by its length: leave it out, or draw a \
                 [[path]] of the shape \"quadratic\"",
            ));
        }
        if series.len() < 3 {
            return Err(Fault::new(
                "intensity",
                format!(
                    "needs at least 3 values, found {}; leave it out for 1 everywhere",
                    series.len()
                ),
            ));
        }
        for (k, value) in series.iter().enumerate() {
            finite("intensity", *value).map_err(|fault| fault.at(item("intensity", k)))?;
        }
        Ok(())
    }

    fn as_chains(&self) -> Option<Vec<LitChain>> {
        let along = self.along_keys();
        let whole = || Run::whole(vec![Piece::quadratic(self.control_points)]);
        (!along.is_even()).then(|| along.lit(whole(), None, &self.shared()))
    }

    fn for_each_emitter(&self, add: AddEmitter<'_>) {
        let Some(series) = &self.intensity else {
            return add_even(self, add);
        };
        let [a, b, c] = self.control_points;
        if a == b && b == c {
            let light = series[0] * emission(self.lights(), Falloff::cast_by_point);
            return add(EmitterCore::Point(a), [light; 3]);
        }
        // Of a spline, between two knots: the means of two weights, or an end weight, with the weight between (2015,
        // eq. 14 to 16).
        let whole = Piece::quadratic(self.control_points);
        let light = emission(self.lights(), Falloff::cast_by_line);
        let spans = series.len() - 2;
        let joint = |k: usize| match k {
            0 => series[0],
            k if k == spans => series[k + 1],
            k => 0.5 * (series[k] + series[k + 1]),
        };
        for k in 0..spans {
            let [from, to] = [k, k + 1].map(|knot| knot as f64 / spans as f64);
            let (begin, end) = (joint(k), joint(k + 1));
            let middle = 0.25 * (begin + end) + 0.5 * series[k + 1];
            let part = EmitterCore::Curve(whole.part(from, to));
            add(part, [begin, middle, end].map(|weight| weight * light));
        }
    }

    fn for_each_emission(&self, add: &mut dyn FnMut(DVec3)) {
        if !self.along_keys().is_even() {
            emissions_along(&self.along_keys().lights(&self.shared()), add);
            return;
        }
        for light in self.lights() {
            for weight in self.intensity.as_deref().unwrap_or(&[1.0]) {
                add(weight * light.emission());
            }
        }
    }

    fn move_core(&mut self, place: &Placement) {
        self.control_points = self.control_points.map(|point| place.point(point));
        self.radii.iter_mut().flatten().for_each(|radius| *radius *= place.scale);
    }

    fn core(&self) -> Core {
        Core::Bezier(self.control_points)
    }

    fn uneven(&self) -> Option<&'static str> {
        let intensity = self.intensity.is_some().then_some("intensity");
        intensity.or(self.along_keys().uneven())
    }

    fn specimen(place: DVec3, profile: Profile) -> Self {
        let points = [(-1.3, 0.1), (0.2, 1.4), (1.1, -0.6)];
        Self {
            color: DVec3::new(1.0, 0.3, 0.6),
            profile,
            ..Self::new(points.map(|(x, z)| place + DVec3::new(x, 0.3 * z, z)))
        }
    }

    fn with_series(self) -> Self {
        Self {
            intensity: Some(vec![0.6, 1.0, 0.3, 0.8, 0.5]),
            ..self
        }
    }
}

/// Reads exactly three control points.
fn three_points<'de, D: Deserializer<'de>>(reader: D) -> Result<[DVec3; 3], D::Error> {
    let points = read_vectors(reader)?;
    let found = points.len();
    points.try_into().map_err(|_| {
        serde::de::Error::custom(format!(
            "a quadratic curve has three control points, found {found}"
        ))
    })
}
