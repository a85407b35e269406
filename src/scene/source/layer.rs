//! Several lights of one core.

use glam::DVec3;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

use super::{Brightness, Light, Profile, Shared, item};
use crate::scene::colors::read_some_color;
use crate::scene::light_group::check_light_group;
use crate::scene::values::{Checked, Fault, finite, vector};

/// More layers than this hardly differ.
const MOST_LAYERS: usize = 16;

/// One of several lights of a source's core, such as a white core or a coloured halo. What is `None` is as the source
/// says.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Layer {
    /// The energy coefficient; of a beam that of its line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coefficient: Option<f64>,
    /// Linear RGB.
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_some_color"
    )]
    pub color: Option<DVec3>,
    /// How the field falls off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<Profile>,
    /// How thick the core is, world units; 0 for none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// The distance at which the light ends, world units, more than the radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reach: Option<f64>,
    /// Takes the coefficient's place, that of the source too: the light of a ray straight across the core, measured by
    /// length, without decay.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak: Option<f64>,
}

// What is read of `layers`.
keys! { pub(in crate::scene) LAYER_KEYS;
    coefficient: ANY, NONE, Otherwise("its source's"), "the papers' energy coefficient";
    color: Color, "linear RGB", Otherwise("its source's"), "the colour";
    profile: PROFILE, NONE, Otherwise("its source's"), "how light falls off with the distance to the core";
    radius: NOT_NEGATIVE, WORLD, Otherwise("its source's"), "how thick the core is, 0 for none";
    reach: POSITIVE, WORLD, Otherwise("its source's"), "the distance at which the light ends, more than the radius";
    peak: ANY, NONE, Otherwise("its source's"),
        "in the place of coefficient: the light of a ray straight across the core";
}

impl Layer {
    /// Returns what the keys say of it, where those of its source stand for what it does not name.
    pub(super) fn over(&self, source: &Shared<'_>) -> Shared<'static> {
        let peak = match (self.peak, self.coefficient) {
            (Some(peak), _) => Some(peak),
            (None, Some(_)) => None,
            (None, None) => source.peak,
        };
        Shared {
            coefficient: self.coefficient.unwrap_or(source.coefficient),
            color: self.color.unwrap_or(source.color),
            profile: self.profile.unwrap_or(source.profile),
            radius: self.radius.unwrap_or(source.radius),
            reach: self.reach.or(source.reach),
            peak,
            layers: &[],
            light_group: None,
            adds_up: source.adds_up,
        }
    }

    /// Multiplies its lengths.
    pub(super) fn scale(&mut self, scale: f64) {
        self.radius = self.radius.map(|radius| scale * radius);
        self.reach = self.reach.map(|reach| scale * reach);
    }

    /// Returns whether a key of this name is at fault here, and not in the source.
    fn owns(&self, key: &str, source: &Shared<'_>) -> bool {
        match key {
            "coefficient" => self.coefficient.is_some(),
            "color" => self.color.is_some(),
            "radius" => self.radius.is_some() || source.radius == 0.0,
            "reach" => self.reach.is_some() || source.reach.is_none(),
            "peak" => self.peak.is_some() || source.peak.is_none(),
            _ => true,
        }
    }

    fn check(
        &self,
        source: &Shared<'_>,
        brightness: &Brightness,
        strongest: &dyn Fn(&Light) -> f64,
    ) -> Checked {
        if self.peak.is_some() && self.coefficient.is_some() {
            let message = "takes the place of coefficient: leave one of them out";
            return Err(Fault::new("peak", message));
        }
        brightness.check_light(&self.over(source), strongest)
    }
}

impl Shared<'_> {
    /// Checks the keys that every kind has; `strongest` gives the greatest coefficient that a light has anywhere.
    pub(super) fn check(
        &self,
        brightness: &Brightness,
        strongest: &dyn Fn(&Light) -> f64,
    ) -> Checked {
        self.light_group.map_or(Ok(()), check_light_group)?;
        let count = self.layers.len();
        if count == 0 {
            return brightness.check_light(self, strongest);
        }
        if count > MOST_LAYERS {
            let message = format!(
                "{count} layers on one core; give at most {MOST_LAYERS}, or a second source"
            );
            return Err(Fault::new("layers", message));
        }
        // A layer may take none of these: they are checked for themselves.
        vector("color", self.color)?;
        finite("coefficient", self.coefficient)?;
        finite("peak", self.peak.unwrap_or(0.0))?;
        self.falloff().check_sizes()?;
        for (index, layer) in self.layers.iter().enumerate() {
            layer.check(self, brightness, strongest).map_err(|fault| {
                match layer.owns(fault.key(), self) {
                    true => {
                        let key = format!("{}.{}", item("layers", index), fault.key());
                        fault.at(key.into())
                    }
                    false => fault,
                }
            })?;
        }
        Ok(())
    }
}

/// Reads a list of layers, which an author leaves out where there are none.
pub(super) fn read_layers<'de, D: Deserializer<'de>>(reader: D) -> Result<Vec<Layer>, D::Error> {
    let layers = Vec::<Layer>::deserialize(reader)?;
    if layers.is_empty() {
        let message = "an empty list of layers is no light: leave layers out, or give one such as { radius = 0.1 }";
        return Err(D::Error::custom(message));
    }
    Ok(layers)
}
