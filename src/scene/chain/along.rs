//! What changes along a core: how bright it is, of which colour, how thick.

use glam::DVec3;

use super::{Chain, Dashes, ElectricArc, LitChain, Run};
use crate::scene::source::{CoreLight, Falloff, Light, Profile, Shared, item};
use crate::scene::values::{Checked, Fault, finite, vector};

/// What the keys of a source say of the change along its core. Values of a series stand at equal steps of the core's
/// length, and are linear between.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Along<'a> {
    pub intensity: Option<&'a [f64]>,
    pub colors: Option<&'a [DVec3]>,
    pub radii: Option<&'a [f64]>,
    pub arc: Option<ElectricArc>,
    pub dashes: Option<Dashes>,
    /// Over which shares of the core, from either end, its light rises from 0; 0: it does not.
    pub tapers: [f64; 2],
}

/// Values at shares of a core's length, in their order, linear between; none: they are everywhere the same.
pub(crate) type Series = Vec<(f64, f64)>;

/// A light, what it is multiplied with along the core, and how thick the core is where that changes: the light's own
/// radius is then 0.
#[derive(Debug, Clone)]
pub(crate) struct LightAlong {
    pub light: Light,
    pub values: Series,
    pub radii: Series,
}

/// Returns a series at a share of the core's length; `even` where there is none.
pub(crate) fn series_at(series: &[(f64, f64)], share: f64, even: f64) -> f64 {
    match series {
        [] => even,
        [(_, only)] => *only,
        _ => {
            let after = series.partition_point(|(s, _)| *s <= share);
            let after = after.clamp(1, series.len() - 1);
            let ((s0, v0), (s1, v1)) = (series[after - 1], series[after]);
            v0 + (v1 - v0) * ((share - s0) / (s1 - s0)).clamp(0.0, 1.0)
        }
    }
}

/// Puts values at equal steps of a core.
fn evenly(values: impl ExactSizeIterator<Item = f64>) -> Series {
    let last = values.len().max(2) - 1;
    values
        .enumerate()
        .map(|(k, value)| (k as f64 / last as f64, value))
        .collect()
}

impl Along<'_> {
    /// Returns whether the core is the same all along.
    pub(crate) fn is_even(&self) -> bool {
        self.intensity.is_none()
            && self.colors.is_none()
            && self.radii.is_none()
            && self.arc.is_none()
            && self.dashes.is_none()
            && self.tapers == [0.0; 2]
    }

    /// Returns the key by which its light is not the same all along the core, if there is one.
    pub(crate) fn uneven(&self) -> Option<&'static str> {
        let keys = [
            (self.intensity.is_some(), "intensity"),
            (self.colors.is_some(), "colors"),
            (self.tapers != [0.0; 2], "taper_lengths"),
            (self.arc.is_some_and(|arc| arc.branches > 0), "arc"),
        ];
        keys.into_iter()
            .find_map(|(is_named, key)| is_named.then_some(key))
    }

    /// Checks it; `given_radius` is the source's own.
    pub(crate) fn check(&self, shared: &Shared<'_>, given_radius: f64) -> Checked {
        check_each("intensity", self.intensity, |value| {
            finite("intensity", *value)
        })?;
        check_each("colors", self.colors, |color| vector("colors", *color))?;
        check_each("radii", self.radii, |radius| {
            finite("radii", *radius)?;
            match *radius < 0.0 {
                true => Err(Fault::new(
                    "radii",
                    format!("a core is 0 or more thick; found {radius}"),
                )),
                false => Ok(()),
            }
        })?;
        self.dashes.map_or(Ok(()), |dashes| dashes.check())?;
        if self.radii.is_none() {
            return Ok(());
        }
        if given_radius != 0.0 {
            return Err(Fault::new(
                "radii",
                "take the place of radius: leave one of them out",
            ));
        }
        let is_width = |profile| {
            matches!(
                profile,
                Profile::Gaussian | Profile::Smeared | Profile::Convolution
            )
        };
        match shared
            .core_lights()
            .any(|it| !it.has_own_radius && is_width(it.light.falloff.profile))
        {
            true => Err(Fault::new(
                "radii",
                "go with the profiles inverse, inverse-square and inverse-cube; give a radius instead",
            )),
            false => Ok(()),
        }
    }

    /// Checks how the whole core is displaced.
    pub(crate) fn check_arc(&self, whole: impl FnOnce() -> Run) -> Checked {
        self.arc.map_or(Ok(()), |arc| arc.check(&whole()))
    }

    /// Returns the greatest factor that light is multiplied with.
    pub(crate) fn strongest(&self) -> f64 {
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let intensity = self.intensity.map_or(1.0, |values| {
            most(&mut values.iter().map(|value| value.abs()))
        });
        let colors = self.colors.map_or(1.0, |colors| {
            most(&mut colors.iter().map(|color| color.abs().max_element()))
        });
        intensity * colors
    }

    /// Returns the rise and fall of light at the ends.
    fn taper(&self) -> Series {
        let [a, b] = self.tapers;
        let value = |share: f64| {
            let rise = |over: f64, from_end: f64| match over {
                0.0 => 1.0,
                over => (from_end / over).min(1.0),
            };
            rise(a, share).min(rise(b, 1.0 - share))
        };
        if [a, b] == [0.0; 2] {
            return Vec::new();
        }
        let mut knots = vec![0.0, a.min(1.0), (1.0 - b).max(0.0), a / (a + b), 1.0];
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        knots
            .into_iter()
            .map(|share| (share, value(share)))
            .collect()
    }

    /// Returns the lights of a source along its core; red, green and blue apart where they do not change alike.
    pub(crate) fn lights(&self, shared: &Shared<'_>) -> Vec<LightAlong> {
        let intensity = self
            .intensity
            .map_or_else(Series::new, |values| evenly(values.iter().copied()));
        let of_light = |CoreLight {
                            light,
                            has_own_radius,
                            has_peak,
                        }: CoreLight| {
            let radii = match self.radii {
                Some(radii) if !has_own_radius => evenly(radii.iter().copied()),
                _ => Series::new(),
            };
            let mut factors = vec![intensity.clone(), self.taper()];
            if has_peak {
                factors.push(peak_factor(&radii, &light.falloff));
            }
            let radius = if radii.is_empty() {
                light.falloff.radius
            } else {
                0.0
            };
            let channels: Vec<(DVec3, Series)> = match self.colors {
                None => vec![(DVec3::ONE, Series::new())],
                Some(colors) => DVec3::AXES
                    .map(|axis| (axis, evenly(colors.iter().map(|color| color.dot(axis)))))
                    .into(),
            };
            channels.into_iter().map(move |(axis, channel)| LightAlong {
                light: Light {
                    color: light.color * axis,
                    falloff: Falloff {
                        radius,
                        ..light.falloff
                    },
                    ..light
                },
                values: product(factors.iter().chain([&channel])),
                radii: radii.clone(),
            })
        };
        shared.core_lights().flat_map(of_light).collect()
    }

    /// Returns a core with its dashes, then its branches, and their lights.
    pub(crate) fn lit(
        &self,
        whole: Run,
        flatness: Option<f64>,
        shared: &Shared<'_>,
    ) -> Vec<LitChain> {
        let lights = self.lights(shared);
        let of_arm = |runs| LitChain {
            chain: Chain { runs, flatness },
            lights: lights.clone(),
        };
        self.arms(whole).into_iter().map(of_arm).collect()
    }

    /// Returns the same in one, without lights.
    pub(crate) fn chain(&self, whole: Run, flatness: Option<f64>) -> Chain {
        let runs = self.arms(whole).concat();
        Chain { runs, flatness }
    }

    /// Returns the runs of a core, then of each of its branches.
    fn arms(&self, whole: Run) -> Vec<Vec<Run>> {
        // The length of rays asks for cores before sources are checked: of a wrong arc, kinks might be without number.
        let arms = match self.arc.filter(|arc| arc.check(&whole).is_ok()) {
            Some(arc) => arc.displaced(whole),
            None => vec![whole],
        };
        let length = arms.first().map_or(0.0, Run::length);
        let dashed = arms.into_iter().map(|arm| match self.dashes {
            Some(dashes) => dashes.cut(&arm, length),
            None => vec![arm],
        });
        dashed.filter(|runs| !runs.is_empty()).collect()
    }
}

/// Returns what keeps a peak the same where the radius changes, relative to where the core is thickest.
fn peak_factor(radii: &[(f64, f64)], falloff: &Falloff) -> Series {
    let across = |radius: f64| Falloff { radius, ..*falloff }.light_across();
    let most = across(falloff.radius);
    let factor = |(share, radius): &(f64, f64)| (*share, most / across(*radius));
    radii.iter().map(factor).collect()
}

/// Multiplies series: at every knot of any, linear between.
fn product<'a>(factors: impl Iterator<Item = &'a Series>) -> Series {
    let factors: Vec<&Series> = factors.filter(|factor| !factor.is_empty()).collect();
    let mut shares: Vec<f64> = factors
        .iter()
        .flat_map(|factor| factor.iter().map(|(s, _)| *s))
        .collect();
    shares.sort_by(f64::total_cmp);
    shares.dedup();
    let value = |share: f64| {
        factors
            .iter()
            .map(|factor| series_at(factor, share, 1.0))
            .product()
    };
    shares
        .into_iter()
        .map(|share| (share, value(share)))
        .collect()
}

/// Checks how many values a series has, and each of them.
fn check_each<T>(
    key: &'static str,
    series: Option<&[T]>,
    check: impl Fn(&T) -> Checked,
) -> Checked {
    let Some(series) = series else {
        return Ok(());
    };
    if series.len() < 2 {
        let found = series.len();
        let message = format!("needs at least 2 values, from one end to the other; found {found}");
        return Err(Fault::new(key, message));
    }
    for (k, value) in series.iter().enumerate() {
        check(value).map_err(|fault| fault.at(item(key, k)))?;
    }
    Ok(())
}
