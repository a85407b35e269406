//! Depths of clip space, as the depth buffers of engines hold them: z / w behind a projection, the NDC depth. With a
//! perspective projection it is `a + b / w`, w growing with the distance along the axis of view, with an orthographic
//! one it grows with that distance itself.

use glam::{DMat4, DVec3, DVec4, Vec4Swizzles};
use serde::{Deserialize, Serialize};

use super::DepthAlong;
use crate::error::{Result, SceneError};

/// From where to where the depths of clip space go between near plane and far plane, or back with reversed z.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
pub enum ClipRange {
    /// Of Vulkan, Direct3D, Metal and WebGPU.
    #[serde(rename = "0..1")]
    ZeroToOne,
    /// Of OpenGL and WebGL.
    #[serde(rename = "-1..1")]
    MinusOneToOne,
}

impl ClipRange {
    /// Returns the least depth; the greatest is 1.
    #[must_use]
    pub fn low(self) -> f64 {
        match self {
            Self::ZeroToOne => 0.0,
            Self::MinusOneToOne => -1.0,
        }
    }
}

/// Which way a projection takes rays.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Perspective,
    Orthographic,
}

/// What NDC depths are along the axis of view: read from a projection, perspective or orthographic, with normal or
/// reversed z and a far plane that may be infinitely far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClipDepth {
    kind: Kind,
    /// The depth is `a + b / d` (perspective) or `a + b d`, d the distance from the eye along the axis of view.
    a: f64,
    b: f64,
    range: ClipRange,
    projection: DMat4,
}

/// How far numbers of float32 may be off what they are meant to be, as shares.
const ROUNDED: f64 = 1e-6;

/// Below this share of its rows' lengths a determinant is none.
const SINGULAR: f64 = 1e-12;

/// NDC depths beyond the planes by no more than this lie on them.
const BEYOND: f64 = 1e-4;

impl ClipDepth {
    /// Reads a projection: a matrix for columns, from view space to clip space.
    ///
    /// Whether z is reversed is what the matrix says, as is an infinitely far plane. The range is `-1..1` where a
    /// reversed z says so, or an orthographic projection has both planes on one side of the eye with it; else it cannot
    /// be told, and without a `range` it is taken for `0..1`.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) if the matrix is not finite, singular, or neither perspective nor
    /// orthographic.
    pub fn new(projection: DMat4, range: Option<ClipRange>) -> Result<Self> {
        let read = Self::read(projection, range);
        Ok(read.map_err(|message| SceneError::value("projection", message))?)
    }

    /// Reads a projection, or says why it is none.
    pub(crate) fn read(
        projection: DMat4,
        range: Option<ClipRange>,
    ) -> std::result::Result<Self, String> {
        check_matrix(&projection)?;
        let [x, y, z, w] = rows(&projection);
        let scale = w.xyz().length();
        if scale <= ROUNDED * w.w.abs() {
            return Self::orthographic(projection, [x, y, z].map(|row| row / w.w), range);
        }
        // Transposed, a perspective has -1 where its last row should, and an orthographic one a 1 at its end.
        let is_turned = (w.w == 0.0 && z.w.abs() == 1.0 && (scale - 1.0).abs() > ROUNDED)
            || (w.w == 1.0 && z.w == 0.0);
        let a = z.xyz().dot(w.xyz()) / (scale * scale);
        let b = (z.w - a * w.w) / scale;
        let is_oblique = (z.xyz() - a * w.xyz()).length() > ROUNDED * z.xyz().length();
        if is_turned || is_oblique || b == 0.0 {
            return Err(neither(is_turned));
        }
        let is_reversed = b > 0.0;
        let told = match (is_reversed, a) {
            (true, a) if a <= ROUNDED - 1.0 => ClipRange::MinusOneToOne,
            (false, a) if a <= 0.0 => ClipRange::MinusOneToOne,
            _ => ClipRange::ZeroToOne,
        };
        let found = Self {
            kind: Kind::Perspective,
            a,
            b,
            range: range.unwrap_or(told),
            projection,
        };
        let near = found.near();
        if !(near > 0.0 && near.is_finite()) {
            return Err(format!(
                "its near plane is not before the eye with a range of {}: give the `range` of its depths, or another \
                 matrix",
                found.range
            ));
        }
        Ok(found)
    }

    /// Reads the rows of x, y and z, which the last row does not divide. It looks from the view's origin to the middle
    /// of what is between the planes.
    fn orthographic(
        projection: DMat4,
        [x, y, z]: [DVec4; 3],
        range: Option<ClipRange>,
    ) -> std::result::Result<Self, String> {
        let growth = z.xyz().length();
        let is_across =
            |row: DVec4| row.xyz().dot(z.xyz()).abs() <= ROUNDED * row.xyz().length() * growth;
        if !(is_across(x) && is_across(y)) {
            return Err(neither(false));
        }
        let plane = |depth: f64| (depth - z.w) / growth;
        let planes = |range: ClipRange| [plane(range.low()), plane(1.0)];
        let [first, last] = planes(ClipRange::MinusOneToOne);
        let margin = ROUNDED * (last - first);
        let told = match first >= -margin || last <= margin {
            true => ClipRange::MinusOneToOne,
            false => ClipRange::ZeroToOne,
        };
        let range = range.unwrap_or(told);
        let [first, last] = planes(range);
        let is_reversed = first + last < -ROUNDED * (last - first);
        Ok(Self {
            kind: Kind::Orthographic,
            a: z.w,
            b: if is_reversed { -growth } else { growth },
            range,
            projection,
        })
    }

    /// Measures distances in other units, of which one is so many of the projection's.
    pub(crate) fn in_units(self, unit: f64) -> Self {
        let b = match self.kind {
            Kind::Perspective => self.b / unit,
            Kind::Orthographic => self.b * unit,
        };
        Self {
            b,
            projection: self.projection * DMat4::from_scale(DVec3::splat(unit)),
            ..self
        }
    }

    /// Returns the projection, for lengths in the units of its distances.
    #[must_use]
    pub fn projection(&self) -> DMat4 {
        self.projection
    }

    /// Returns a and b: the depth is `a + b / d` (perspective) or `a + b d`, d the distance.
    pub(crate) fn terms(&self) -> (f64, f64) {
        (self.a, self.b)
    }

    /// Returns the range of the depths.
    #[must_use]
    pub fn range(&self) -> ClipRange {
        self.range
    }

    /// Returns whether near depths are greater than far ones.
    #[must_use]
    pub fn is_reversed(&self) -> bool {
        match self.kind {
            Kind::Perspective => self.b > 0.0,
            Kind::Orthographic => self.b < 0.0,
        }
    }

    /// Returns whether all rays are parallel.
    #[must_use]
    pub fn is_orthographic(&self) -> bool {
        self.kind == Kind::Orthographic
    }

    /// Returns the near plane's distance from the eye along the axis of view, in the projection's units; that of an
    /// orthographic projection may be negative.
    #[must_use]
    pub fn near(&self) -> f64 {
        match self.is_reversed() {
            true => self.distance(1.0),
            false => self.distance(self.range.low()),
        }
    }

    /// Returns the far plane's distance; infinite where there is none.
    #[must_use]
    pub fn far(&self) -> f64 {
        let distance = self.distance(self.far_depth());
        match self.kind {
            Kind::Perspective if !(distance > 0.0 && distance < self.near() / ROUNDED.powi(2)) => {
                f64::INFINITY
            }
            _ => distance,
        }
    }

    /// Returns the depth at the far plane, to which buffers are cleared.
    #[must_use]
    pub fn far_depth(&self) -> f64 {
        match self.is_reversed() {
            true => self.range.low(),
            false => 1.0,
        }
    }

    /// Returns how far from the eye along the axis of view a depth is; infinite at the far plane and beyond, where
    /// nothing is. `None` for what lies before the near plane, or is no number.
    #[must_use]
    pub fn along_axis(&self, depth: f64) -> Option<f64> {
        let low = self.range.low();
        let (before, is_far) = match self.is_reversed() {
            true => (depth - 1.0, depth <= low),
            false => (low - depth, depth >= 1.0),
        };
        if before.is_nan() || before > BEYOND || depth < low - BEYOND || depth > 1.0 + BEYOND {
            return None;
        }
        let distance = self.distance(depth.clamp(low, 1.0));
        let is_nowhere = is_far || (self.kind == Kind::Perspective && distance <= 0.0);
        Some(if is_nowhere { f64::INFINITY } else { distance })
    }

    /// Returns the same of what an image holds: an NDC depth, or what a depth buffer has of it, from 0 to 1.
    pub(crate) fn along_axis_of(&self, along: DepthAlong, value: f64) -> Option<f64> {
        let low = self.range.low();
        match along {
            DepthAlong::Buffer => self.along_axis(low + value * (1.0 - low)),
            DepthAlong::Ndc | DepthAlong::Ray | DepthAlong::Axis => self.along_axis(value),
        }
    }

    fn distance(&self, depth: f64) -> f64 {
        match self.kind {
            Kind::Perspective => self.b / (depth - self.a),
            Kind::Orthographic => (depth - self.a) / self.b,
        }
    }
}

impl std::fmt::Display for ClipRange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::ZeroToOne => "0..1",
            Self::MinusOneToOne => "-1..1",
        })
    }
}

/// Returns the rows of a matrix.
pub(crate) fn rows(matrix: &DMat4) -> [DVec4; 4] {
    [0, 1, 2, 3].map(|k| matrix.row(k))
}

/// Says what of a matrix cannot be inverted.
pub(crate) fn check_matrix(matrix: &DMat4) -> std::result::Result<(), String> {
    for (row, values) in rows(matrix).iter().enumerate() {
        for (column, value) in values.to_array().iter().enumerate() {
            if !(value.is_finite() && value.abs() <= 1e12) {
                return Err(format!(
                    "{value} in row {row}, column {column}, counted from 0: not a finite number up to 1e12"
                ));
            }
        }
    }
    let lengths: f64 = rows(matrix).iter().map(|row| row.length()).product();
    let is_regular = matrix.determinant().abs() > SINGULAR * lengths;
    if !is_regular {
        let message = "the matrix is singular: no ray leads back through it; two of its rows are alike, or one is 0";
        return Err(message.to_owned());
    }
    Ok(())
}

fn neither(is_turned: bool) -> String {
    let advice = match is_turned {
        true => {
            "it looks transposed: give it by rows, for columns as in `projection * view * point`"
        }
        false => {
            "a perspective one has a last row like 0 0 -1 0 and an x and y of 0 in the row before it; an orthographic \
             one has the last row 0 0 0 1 and no shear; is it transposed, or its near plane oblique?"
        }
    };
    format!("the matrix is neither a perspective nor an orthographic projection: {advice}")
}

/// Returns the direction of the axis of view, in the space that a projection starts from.
pub(crate) fn axis_of(projection: &DMat4, depth: &ClipDepth) -> DVec3 {
    let [_, _, z, w] = rows(projection);
    match depth.kind {
        Kind::Perspective => w.xyz().normalize(),
        Kind::Orthographic => (z.xyz() * depth.b * w.w).normalize(),
    }
}
