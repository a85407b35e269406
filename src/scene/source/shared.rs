//! The keys that every kind of source has: how bright it is, of which colour, and how its light falls off.

use glam::DVec3;

use super::{Falloff, Layer, Light, Profile};

/// Defines a source's struct: the fields that are its kind's own, then those that every kind has; with `along` also
/// those of a core along which light may change. With `thick` the kind's own `radii` may stand for the radius.
macro_rules! source_struct {
    (
        $(#[$attribute:meta])*
        $visibility:vis struct $Type:ident { $($fields:tt)* }
    ) => {
        $crate::scene::source::shared::source_struct! {
            @thickest |source| source.radius;
            $(#[$attribute])*
            $visibility struct $Type { $($fields)* }
        }
    };
    (
        $(#[$attribute:meta])*
        $visibility:vis struct $Type:ident thick { $($fields:tt)* }
    ) => {
        $crate::scene::source::shared::source_struct! {
            @thickest |source| source.radii.iter().flatten().copied().fold(source.radius, f64::max);
            $(#[$attribute])*
            $visibility struct $Type { $($fields)* }
        }
    };
    (
        $(#[$attribute:meta])*
        $visibility:vis struct $Type:ident along { $($fields:tt)* }
    ) => {
        $crate::scene::source::shared::source_struct! {
            $(#[$attribute])*
            $visibility struct $Type thick {
                $($fields)*
                /// What the light is multiplied with along the core: values at equal steps of its length, linear
                /// between, at least 2; `None`: 1 everywhere.
                #[serde(default, skip_serializing_if = "Option::is_none")]
                pub intensity: Option<Vec<f64>>,
                /// The same for each of red, green and blue.
                #[serde(
                    default,
                    skip_serializing_if = "Option::is_none",
                    deserialize_with = "crate::scene::colors::read_some_colors"
                )]
                pub colors: Option<Vec<glam::DVec3>>,
                /// How thick the core is along it, in the place of `radius`: values at equal steps of its length,
                /// linear between, at least 2; world units. A `peak` is met at each of them.
                #[serde(default, skip_serializing_if = "Option::is_none")]
                pub radii: Option<Vec<f64>>,
                /// Kinks and side arms of the core, as those of lightning.
                #[serde(default, skip_serializing_if = "Option::is_none")]
                pub arc: Option<$crate::scene::ElectricArc>,
                /// Gaps that part the core, after it was displaced.
                #[serde(default, skip_serializing_if = "Option::is_none")]
                pub dashes: Option<$crate::scene::Dashes>,
            }
        }

        #[allow(dead_code, reason = "a table of a file is only read and written")]
        impl $Type {
            /// Returns what its keys say of the change along its core.
            fn along_keys(&self) -> $crate::scene::chain::Along<'_> {
                $crate::scene::chain::Along {
                    intensity: self.intensity.as_deref(),
                    colors: self.colors.as_deref(),
                    radii: self.radii.as_deref(),
                    arc: self.arc,
                    dashes: self.dashes,
                    tapers: [0.0; 2],
                }
            }

            /// Multiplies the lengths among them.
            fn scale_along(&mut self, scale: f64) {
                self.radii.iter_mut().flatten().for_each(|radius| *radius *= scale);
                self.arc.iter_mut().for_each(|arc| arc.scale_by(scale));
            }
        }
    };
    (
        @thickest |$source:ident| $thickest:expr;
        $(#[$attribute:meta])*
        $visibility:vis struct $Type:ident { $($fields:tt)* }
    ) => {
        $(#[$attribute])*
        $visibility struct $Type {
            $($fields)*
            /// The papers' energy coefficient; of a beam that of its line.
            #[serde(default = "crate::scene::source::one")]
            pub coefficient: f64,
            /// Linear RGB; in files also `"#rrggbb"`, sRGB.
            #[serde(
                default = "crate::scene::source::white",
                deserialize_with = "crate::scene::colors::read_color"
            )]
            pub color: glam::DVec3,
            /// How the field falls off.
            #[serde(default)]
            pub profile: $crate::scene::Profile,
            /// How thick the core is: `d^2 + radius^2` stands for `d^2`; world units, 0 for none.
            #[serde(default)]
            pub radius: f64,
            /// The distance at which the light ends, smoothly; world units, more than the radius. `None`: nowhere.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub reach: Option<f64>,
            /// Takes the coefficient's place: the light of a ray straight across the core, measured by length, without
            /// decay. It needs a radius, and where the light of the profile has no end, a reach.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub peak: Option<f64>,
            /// Several lights of the core, whose sum is the source's light: what a layer does not name it takes from
            /// the source. At most 16; none: the source has one light.
            #[serde(
                default,
                skip_serializing_if = "Vec::is_empty",
                deserialize_with = "crate::scene::source::read_layers"
            )]
            pub layers: Vec<$crate::scene::Layer>,
            /// The group of lights that it is counted to ([`Scene::light_groups`](crate::Scene::light_groups)).
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub light_group: Option<Box<str>>,
        }

        impl $crate::scene::source::HasLight for $Type {
            fn shared(&self) -> $crate::scene::source::Shared<'_> {
                let $source = self;
                $crate::scene::source::Shared {
                    coefficient: self.coefficient,
                    color: self.color,
                    profile: self.profile,
                    radius: $thickest,
                    reach: self.reach,
                    peak: self.peak,
                    layers: &self.layers,
                    light_group: self.light_group.as_deref(),
                    adds_up: false,
                }
            }

            fn join(&mut self, light_group: &str) {
                self.light_group.get_or_insert_with(|| light_group.into());
            }

            fn scale(&mut self, scale: f64) {
                self.radius *= scale;
                self.reach = self.reach.map(|reach| scale * reach);
                self.layers.iter_mut().for_each(|layer| layer.scale(scale));
            }
        }
    };
}
pub(super) use source_struct;

// What is read of every kind.
keys! { pub(in crate::scene) SHARED_KEYS;
    coefficient: ANY, NONE, Value("1"), "the papers' energy coefficient; may be negative";
    color: Color, "linear RGB", Value("[1, 1, 1]"), "the colour";
    profile: PROFILE, NONE, Value("\"inverse-square\""), "how light falls off with the distance to the core";
    radius: NOT_NEGATIVE, WORLD, Value("0"), "how thick the core is, 0 for none";
    reach: POSITIVE, WORLD, Otherwise("nowhere"), "the distance at which the light ends, more than the radius";
    peak: ANY, NONE, Otherwise("none"), "in the place of coefficient: the light of a ray straight across the core";
    layers: Tables("layers"), NONE, Otherwise("one light"), "several lights of this core, whose sum it is";
    light_group: Text, NONE, Otherwise("that of its group, or none"),
        "a name; an EXR has a layer for each on request (--light-groups)";
}

// What is read besides of cores along which light may change.
keys! { pub(in crate::scene) ALONG_KEYS;
    intensity: Numbers(2, None), NONE, Otherwise("1 everywhere"), "what the light is multiplied with along the core";
    colors: Colors(2), "linear RGB", Otherwise("1 everywhere"), "the same for red, green and blue";
    radii: Numbers(2, None), WORLD, Otherwise("radius"), "how thick the core is along it, in the place of radius";
    arc: Table("arc"), NONE, Otherwise("none"), "kinks and branches, as those of lightning";
    dashes: Table("dashes"), NONE, Otherwise("none"), "gaps that part the core";
}

/// Makes a source of its kind's own fields; those that every kind has are at their defaults, or like another's.
macro_rules! source {
    ($Type:ident along { $($fields:tt)* }) => {
        $crate::scene::source::shared::source!($Type {
            $($fields)*
            intensity: None,
            colors: None,
            radii: None,
            arc: None,
            dashes: None,
        })
    };
    ($Type:ident { $($fields:tt)* }) => {
        $crate::scene::source::shared::source!($Type { $($fields)* } like $crate::scene::source::Shared::default())
    };
    ($Type:ident { $($fields:tt)* } like $other:expr) => {{
        let other = $other;
        $Type {
            coefficient: other.coefficient,
            color: other.color,
            profile: other.profile,
            radius: other.radius,
            reach: other.reach,
            peak: other.peak,
            layers: other.layers.to_vec(),
            light_group: other.light_group.map(Into::into),
            $($fields)*
        }
    }};
}
pub(super) use source;

/// What the keys that every kind has say of a source.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shared<'a> {
    pub coefficient: f64,
    pub color: DVec3,
    pub profile: Profile,
    pub radius: f64,
    pub reach: Option<f64>,
    pub peak: Option<f64>,
    pub layers: &'a [Layer],
    pub light_group: Option<&'a str>,
    /// Whether its core can be added up (`Profile::Convolution`).
    pub adds_up: bool,
}

/// A light of a source's core.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CoreLight {
    pub light: Light,
    /// Whether its radius is that of its layer alone.
    pub has_own_radius: bool,
    /// Whether its peak says how bright it is.
    pub has_peak: bool,
}

impl Default for Shared<'_> {
    fn default() -> Self {
        Self {
            coefficient: super::one(),
            color: super::white(),
            profile: Profile::default(),
            radius: 0.0,
            reach: None,
            peak: None,
            layers: &[],
            light_group: None,
            adds_up: false,
        }
    }
}

impl<'a> Shared<'a> {
    /// Says that its core can be added up.
    pub(super) fn adding_up(self) -> Self {
        Self {
            adds_up: true,
            ..self
        }
    }

    pub(super) fn falloff(&self) -> Falloff {
        Falloff {
            profile: self.profile,
            radius: self.radius,
            reach: self.reach,
        }
    }

    /// Returns the light that they make without layers.
    pub(super) fn light(&self) -> Light {
        let falloff = self.falloff();
        Light {
            coefficient: falloff.coefficient(self.coefficient, self.peak),
            color: self.color,
            falloff,
        }
    }

    /// Returns the colours that they name and some light has, each with the layer that names it.
    pub(crate) fn colors(self) -> impl Iterator<Item = (Option<usize>, DVec3)> + 'a {
        let layers = self.layers.iter().map(|layer| layer.color);
        let is_own_seen = self.layers.is_empty() || layers.clone().any(|color| color.is_none());
        let own = is_own_seen.then_some((None, self.color));
        let named = layers
            .enumerate()
            .filter_map(|(index, color)| Some((Some(index), color?)));
        own.into_iter().chain(named)
    }

    /// Returns the distance at which all light ends; `None` where some has no end.
    pub(crate) fn farthest_reach(&self) -> Option<f64> {
        let mut layers = self.layers.iter();
        match self.layers {
            [] => self.reach,
            _ => layers.try_fold(0.0, |farthest: f64, layer| {
                Some(farthest.max(layer.reach.or(self.reach)?))
            }),
        }
    }

    /// Returns whether some light says by its peak how bright it is.
    pub(crate) fn has_peak(&self) -> bool {
        self.peak.is_some() || self.layers.iter().any(|layer| layer.peak.is_some())
    }

    /// Returns whether some light is that of all points of the core, added up.
    pub(crate) fn adds_any_up(self) -> bool {
        self.lights()
            .any(|light| light.falloff.profile == Profile::Convolution)
    }

    /// Returns how many lights they make.
    pub(crate) fn light_count(&self) -> usize {
        self.layers.len().max(1)
    }

    /// Returns all lights that they make: one, or that of each layer.
    pub(crate) fn lights(self) -> impl Iterator<Item = Light> + 'a {
        self.core_lights().map(|it| it.light)
    }

    /// Returns the same, each with what of it is not the source's.
    pub(crate) fn core_lights(self) -> impl Iterator<Item = CoreLight> + 'a {
        let own = self.layers.is_empty().then(|| CoreLight {
            light: self.light(),
            has_own_radius: false,
            has_peak: self.peak.is_some(),
        });
        let of_layer = move |layer: &Layer| {
            let shared = layer.over(&self);
            CoreLight {
                light: shared.light(),
                has_own_radius: layer.radius.is_some(),
                has_peak: shared.peak.is_some(),
            }
        };
        own.into_iter().chain(self.layers.iter().map(of_layer))
    }
}

/// Has the keys that every kind has.
pub(crate) trait HasLight {
    /// Returns what they say.
    fn shared(&self) -> Shared<'_>;

    /// Counts it to a group of lights, unless it names one.
    fn join(&mut self, light_group: &str);

    /// Multiplies the lengths among them.
    fn scale(&mut self, scale: f64);

    /// Returns its lights, whose sum is what is seen of it.
    fn lights(&self) -> impl Iterator<Item = Light> + '_ {
        self.shared().lights()
    }
}
