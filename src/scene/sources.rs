//! The sources of light: each a scalar field that falls off from a core, times a coefficient and a colour.

use glam::DVec3;
use serde::Deserialize;

use super::{one, plus_z, read, white};

/// How a field falls off with the distance d to its core.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Profile {
    /// `1/d` (2015, 2010).
    #[default]
    Inverse,
    /// `1/d^2` (Sakai 2006).
    InverseSquare,
}

/// A point of light: `1/d`, or by its [`Profile`] `1/d^2`, d the distance to the point M (2015, eq. 2).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sphere {
    /// The point, M.
    #[serde(deserialize_with = "read::vector")]
    pub center: DVec3,
    /// The paper's energy coefficient.
    pub coefficient: f64,
    /// Linear RGB.
    #[serde(deserialize_with = "read::vector")]
    pub color: DVec3,
    /// How the field falls off.
    pub profile: Profile,
}

impl Default for Sphere {
    fn default() -> Self {
        Self {
            center: DVec3::ZERO,
            coefficient: one(),
            color: white(),
            profile: Profile::Inverse,
        }
    }
}

/// An infinite line of light: `1/d`, or by its [`Profile`] `1/d^2`, d the distance to the line (2015, eq. 3).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// A point of the line.
    #[serde(default, deserialize_with = "read::vector")]
    pub point: DVec3,
    /// Direction of the line, of any length but zero.
    #[serde(deserialize_with = "read::vector")]
    pub direction: DVec3,
    /// The paper's energy coefficient.
    #[serde(default = "one")]
    pub coefficient: f64,
    /// Linear RGB.
    #[serde(default = "white", deserialize_with = "read::vector")]
    pub color: DVec3,
    /// How the field falls off.
    #[serde(default)]
    pub profile: Profile,
}

impl Cylinder {
    /// A white line through the origin.
    pub fn new(direction: DVec3) -> Self {
        Self {
            point: DVec3::ZERO,
            direction,
            coefficient: one(),
            color: white(),
            profile: Profile::Inverse,
        }
    }
}

/// A half-line of light (Abe, Watanabe 2010, eq. 6, 11, 12); `1/d^2` for `1/d` by its [`Profile`]. Ahead of the plane through its tip M, perpendicular to its
/// direction, `1/d` with d the distance to the line; behind it `1/d` with d the distance to M, or the line's own field,
/// fading (Sakai 2006, fig. 4.3).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Beam {
    /// The point at which it begins, M.
    #[serde(default, deserialize_with = "read::vector")]
    pub tip: DVec3,
    /// Where it goes, of any length but zero.
    #[serde(deserialize_with = "read::vector")]
    pub direction: DVec3,
    /// The energy coefficient of the line, b.
    #[serde(default = "one")]
    pub coefficient: f64,
    /// Linear RGB.
    #[serde(default = "white", deserialize_with = "read::vector")]
    pub color: DVec3,
    /// The coefficient of the point behind the tip; `None`: the line's, without a jump between them. A taper stands in its
    /// place.
    #[serde(default)]
    pub cap_coefficient: Option<f64>,
    /// The coefficient of a further sphere around M, everywhere (2010, eq. 12: a).
    #[serde(default)]
    pub sphere_coefficient: f64,
    /// Instead of a cap: the line's field, falling linearly to 0 over this length behind the tip, world units (2006).
    #[serde(default)]
    pub taper_length: Option<f64>,
    /// How the fields fall off.
    #[serde(default)]
    pub profile: Profile,
}

impl Beam {
    /// A white beam from the origin.
    pub fn new(direction: DVec3) -> Self {
        Self {
            tip: DVec3::ZERO,
            direction,
            coefficient: one(),
            color: white(),
            cap_coefficient: None,
            sphere_coefficient: 0.0,
            taper_length: None,
            profile: Profile::Inverse,
        }
    }

    /// The coefficient of the sphere behind the tip; 0 where there is a taper instead.
    pub fn cap(&self) -> f64 {
        match self.taper_length {
            Some(_) => 0.0,
            None => self.cap_coefficient.unwrap_or(self.coefficient),
        }
    }
}

/// A ring of light: `1/d`, or by its [`Profile`] `1/d^2`, d the distance to the nearest point of the major circle (2015,
/// eq. 7).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Torus {
    /// Middle of the ring.
    #[serde(default, deserialize_with = "read::vector")]
    pub center: DVec3,
    /// Normal of the ring's plane, of any length but zero.
    #[serde(default = "plus_z", deserialize_with = "read::vector")]
    pub axis: DVec3,
    /// Radius of the circle, positive.
    pub major_radius: f64,
    /// The paper's energy coefficient.
    #[serde(default = "one")]
    pub coefficient: f64,
    /// Linear RGB.
    #[serde(default = "white", deserialize_with = "read::vector")]
    pub color: DVec3,
    /// How the field falls off.
    #[serde(default)]
    pub profile: Profile,
}

impl Torus {
    /// A white ring around the origin, in the plane z = 0.
    pub fn new(major_radius: f64) -> Self {
        Self {
            center: DVec3::ZERO,
            axis: plus_z(),
            major_radius,
            coefficient: one(),
            color: white(),
            profile: Profile::Inverse,
        }
    }
}

/// A quadratic Bezier curve of light: `S(t*)/d`, or by its [`Profile`] `S(t*)/d^2`, d the distance to its nearest point `C(t*)`, `S(t*)` the local intensity
/// there (2015, eq. 8-17).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Bezier control points. They may be collinear or coincide.
    #[serde(deserialize_with = "read::three_points")]
    pub control_points: [DVec3; 3],
    /// The paper's energy coefficient.
    #[serde(default = "one")]
    pub coefficient: f64,
    /// Linear RGB.
    #[serde(default = "white", deserialize_with = "read::vector")]
    pub color: DVec3,
    /// The local-intensity series W: weights of a clamped uniform quadratic B-spline over the curve's parameter, at
    /// least 3; `None`: 1 everywhere.
    #[serde(default)]
    pub intensity: Option<Vec<f64>>,
    /// How the field falls off.
    #[serde(default)]
    pub profile: Profile,
}

impl Curve {
    /// A white curve of even intensity.
    pub fn new(control_points: [DVec3; 3]) -> Self {
        Self {
            control_points,
            coefficient: one(),
            color: white(),
            intensity: None,
            profile: Profile::Inverse,
        }
    }
}
