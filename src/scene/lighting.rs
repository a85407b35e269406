//! How surfaces are lit: by the cores of waves, by a light from everywhere, and by a sun.
//!
//! What coefficient means of light that is cast: in thin air, a point of the intensity I glows like `I / (g r^2)`, an
//! infinite line of I' per length like `pi I' / (g d)`. The fields `1/r^2` of points and `1/d` of lines are those of
//! air that is lit by their cores; g is the gain, and [`Falloff::cast_by_point`](super::Falloff) has the other
//! profiles.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::colors::read_color;
use super::values::{Checked, Fault, direction, finite, positive, read_vector, vector};

/// How surfaces are lit. Cores emit light evenly in all directions: a surface has the irradiance
/// `integral of I' max(0, n.y) / (|y|^2 + radius^2)^(3/2)` over all cores, y from the surface's point to the core's, n
/// the surface's normal.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Lighting {
    /// Whether the waves cast light on surfaces.
    pub cast: bool,
    /// What their light is multiplied with, 0 or more.
    pub gain: f64,
    /// How near to a core its light grows no more, world units, positive; `None`: a thousandth of the diameter of the
    /// core, and of points and of lines without end 0.001 world units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Whether surfaces cast shadows.
    pub shadows: bool,
    /// How many pieces of a core are tested for whether they are seen from a surface, 1 to 1024.
    pub shadow_samples: u32,
    /// Light from everywhere, linear RGB: a surface has its albedo times this.
    #[serde(deserialize_with = "read_color")]
    pub ambient: DVec3,
    /// A light from one direction; `None`: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sun: Option<Sun>,
}

/// A light from one direction.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Sun {
    /// Where it stands: from a surface towards it, of any length but zero.
    #[serde(deserialize_with = "read_vector")]
    pub direction: DVec3,
    /// Linear RGB: a surface that faces it has its albedo times this.
    #[serde(default = "super::source::white", deserialize_with = "read_color")]
    pub color: DVec3,
}

// What is read of `[lighting]`.
keys! { pub(super) LIGHTING_KEYS;
    cast: Flag, NONE, Value("true"), "whether the waves light meshes";
    gain: NOT_NEGATIVE, NONE, Value("1"), "what their light on meshes is multiplied with";
    radius: POSITIVE, WORLD, Otherwise("a thousandth of the core's size"), "how near to a core its light grows no more";
    shadows: Flag, NONE, Value("false"), "whether meshes cast shadows";
    shadow_samples: Whole(1, MOST_SAMPLES), NONE, Value("16"),
        "pieces of a core that are tested for whether they are seen";
    ambient: Color, "linear RGB", Value("[0, 0, 0]"), "light from everywhere";
    sun: Table("sun"), NONE, Otherwise("none"), "a light from one direction";
}

// What is read of `sun`.
keys! { pub(super) SUN_KEYS;
    direction: VECTOR, NONE, Required, "where it stands, from the scene towards it; of any length but zero";
    color: Color, "linear RGB", Value("[1, 1, 1]"), "its light";
}

/// Most pieces of a core.
const MOST_SAMPLES: u32 = 1024;

impl Default for Lighting {
    fn default() -> Self {
        Self {
            cast: true,
            gain: 1.0,
            radius: None,
            shadows: false,
            shadow_samples: 16,
            ambient: DVec3::ZERO,
            sun: None,
        }
    }
}

impl Sun {
    /// Makes a white one.
    #[must_use]
    pub fn new(direction: DVec3) -> Self {
        Self {
            direction,
            color: super::source::white(),
        }
    }
}

impl Lighting {
    pub(super) fn check(&self) -> Checked {
        finite("gain", self.gain)?;
        if self.gain < 0.0 {
            let message = format!("light is multiplied with 0 or more; found {}", self.gain);
            return Err(Fault::new("gain", message));
        }
        self.radius
            .map_or(Ok(()), |radius| positive("radius", radius))?;
        if !(1..=MOST_SAMPLES).contains(&self.shadow_samples) {
            let message = format!(
                "{} pieces of a core; give from 1 to {MOST_SAMPLES}",
                self.shadow_samples
            );
            return Err(Fault::new("shadow_samples", message));
        }
        check_light("ambient", self.ambient)?;
        let Some(sun) = &self.sun else {
            return Ok(());
        };
        direction("sun.direction", sun.direction)?;
        check_light("sun.color", sun.color)
    }
}

fn check_light(key: &'static str, light: DVec3) -> Checked {
    vector(key, light)?;
    match light.min_element() < 0.0 {
        true => Err(Fault::new(key, "it takes no light away: 0 or more")),
        false => Ok(()),
    }
}

/// Reads `true` and `false`, too, for a table of which all is left out, and for none.
#[cfg(feature = "files")]
pub(super) fn read_lighting<'de, D>(reader: D) -> Result<Option<Lighting>, D::Error>
where
    D: serde::Deserializer<'de>,
{
    struct LightingVisitor;

    impl<'de> serde::de::Visitor<'de> for LightingVisitor {
        type Value = Option<Lighting>;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("a table, or true")
        }

        fn visit_bool<E>(self, is_lit: bool) -> Result<Self::Value, E> {
            Ok(is_lit.then(Lighting::default))
        }

        fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
            let reader = serde::de::value::MapAccessDeserializer::new(map);
            Lighting::deserialize(reader).map(Some)
        }
    }

    reader.deserialize_any(LightingVisitor)
}
