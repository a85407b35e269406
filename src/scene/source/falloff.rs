//! How a field falls off with the distance to its core: a profile, the thickness of the core, and where light ends.

use std::f64::consts::{FRAC_2_SQRT_PI, PI, SQRT_2};

use serde::{Deserialize, Serialize};

use crate::scene::Measure;
use crate::scene::values::{Checked, Fault, finite, positive};

/// How a field falls off with the distance d to its core.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Profile {
    /// `1/d` (2015, 2010).
    Inverse,
    /// `1/d^2` (Sakai 2006).
    #[default]
    InverseSquare,
    /// `1/d^3`; with a radius that of Plummer's sphere.
    InverseCube,
    /// `exp(-d^2 / (2 radius^2))`: the radius is the standard deviation, and there must be one.
    Gaussian,
    /// `erf(d / (sqrt(2) radius)) / d`: `1/d` smeared by a Gaussian of that standard deviation.
    Smeared,
    /// The sum of `1/d` over all points of the core, per unit of its length: light that adds up, without a joint where
    /// cores meet. For a [`Segment`](super::Segment), a [`LightPath`](super::LightPath) and a [`Torus`](super::Torus).
    Convolution,
}

impl Profile {
    /// Returns whether the radius is a width of the profile itself, without which there is none.
    fn needs_radius(self) -> bool {
        matches!(self, Self::Gaussian | Self::Smeared)
    }
}

/// How a field of coefficient 1 falls off with the distance d to its core: by its profile, of `q^2 = d^2 + radius^2`
/// in the place of `d^2`; times `(1 - (d/reach)^2)^2` where d is less than the reach, and 0 beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Falloff {
    /// Of the distance.
    pub profile: Profile,
    /// World units, 0 for a core without thickness.
    pub radius: f64,
    /// World units.
    pub reach: Option<f64>,
}

/// Steps of the sum across a core with a reach; an even number.
const ACROSS: u32 = 200;

impl Falloff {
    /// Returns whether its integrals have no closed form on the devices.
    pub(crate) fn is_shaped(&self) -> bool {
        match self.profile {
            Profile::Inverse | Profile::InverseSquare | Profile::Convolution => {
                self.reach.is_some()
            }
            _ => true,
        }
    }

    /// Returns whether there is a distance from which on there is no light on the devices.
    pub(crate) fn ends(&self) -> bool {
        self.reach.is_some() || self.profile == Profile::Gaussian
    }

    /// Returns whether it has a sharper peak than 1 over the distance.
    pub(crate) fn is_sharp(&self) -> bool {
        let is_soft = matches!(
            self.profile,
            Profile::Inverse | Profile::Smeared | Profile::Convolution
        );
        !is_soft
    }

    /// Returns the coefficient with which a ray straight across the core has the light `peak`; without a peak the one
    /// that is given.
    pub(crate) fn coefficient(&self, given: f64, peak: Option<f64>) -> f64 {
        peak.map_or(given, |peak| peak / self.light_across())
    }

    /// Returns the light of a ray straight across a core of coefficient 1, measured by length; infinite where it has
    /// no limit.
    pub(crate) fn light_across(&self) -> f64 {
        let Self {
            profile,
            radius,
            reach,
        } = *self;
        if radius == 0.0 {
            return f64::INFINITY;
        }
        let Some(reach) = reach else {
            return match profile {
                Profile::Inverse | Profile::Smeared | Profile::Convolution => f64::INFINITY,
                Profile::InverseSquare => PI / radius,
                Profile::InverseCube => 2.0 / (radius * radius),
                Profile::Gaussian => (2.0 * PI).sqrt() * radius,
            };
        };
        self.sum_across(reach, |field| field)
    }

    /// Returns the intensity of a point of coefficient 1 that casts light, before the gain: `r0^2` times its field at
    /// r0. For powers of the distance r0 is 1, whatever the thickness and the reach, also for `smeared`, which is `1/d`
    /// from afar; for `gaussian`, and for `inverse-cube` with a radius, r0 is the radius.
    pub(crate) fn cast_by_point(&self) -> f64 {
        let radius = self.radius;
        match self.profile {
            Profile::Inverse | Profile::InverseSquare | Profile::Smeared | Profile::Convolution => {
                1.0
            }
            Profile::InverseCube if radius == 0.0 => 1.0,
            Profile::InverseCube => 0.5_f64.powf(1.5) / radius,
            Profile::Gaussian => (-0.5_f64).exp() * radius * radius,
        }
    }

    /// Returns the same per length of a line: `r0 / pi` times its field at r0; of light that adds up over the core, of
    /// each of its points.
    pub(crate) fn cast_by_line(&self) -> f64 {
        let per_length = self.cast_by_point() / PI;
        match self.profile {
            Profile::Convolution => 1.0,
            Profile::Gaussian => per_length / self.radius,
            Profile::InverseCube if self.radius > 0.0 => per_length / self.radius,
            _ => per_length,
        }
    }

    /// Integrates what is summed of the field of coefficient 1 straight across a core with a radius, on both sides as
    /// far as `end`, by length: Simpson's rule over u, d = radius sinh u, as what is steep at the core is even in u.
    pub(crate) fn sum_across(&self, end: f64, summand: impl Fn(f64) -> f64) -> f64 {
        let radius = self.radius;
        let step = (end / radius).asinh() / f64::from(ACROSS);
        let light = |k: u32| {
            let u = f64::from(k) * step;
            let distance2 = (radius * u.sinh()).powi(2);
            let field = self.field(distance2, distance2 + radius * radius);
            summand(field) * radius * u.cosh()
        };
        let pairs =
            (0..ACROSS / 2).map(|k| light(2 * k) + 4.0 * light(2 * k + 1) + light(2 * k + 2));
        2.0 * pairs.sum::<f64>() * step / 3.0
    }

    /// Returns the field of coefficient 1, of a convolution that of one point, from the squared distance to the core,
    /// and what profiles take for it: with the squared radius and whatever else softens it.
    pub(crate) fn field(&self, distance2: f64, softened2: f64) -> f64 {
        let width = SQRT_2 * self.radius;
        let distance = distance2.sqrt();
        let profile = match self.profile {
            Profile::Inverse | Profile::Convolution => 1.0 / softened2.sqrt(),
            Profile::InverseSquare => 1.0 / softened2,
            Profile::InverseCube => softened2.powf(-1.5),
            Profile::Gaussian => (-distance2 / (width * width)).exp(),
            Profile::Smeared if distance == 0.0 => FRAC_2_SQRT_PI / width,
            Profile::Smeared => libm::erf(distance / width) / distance,
        };
        let window = self.reach.map_or(1.0, |reach| {
            (1.0 - distance2 / (reach * reach)).max(0.0).powi(2)
        });
        profile * window
    }

    /// Checks a peak that takes a coefficient's place.
    pub(super) fn check_peak(&self, peak: f64, measure: Measure) -> Checked {
        finite("peak", peak)?;
        let advice = match measure {
            Measure::Parameter => {
                "is light measured by length: write measure = \"length\" in [integration]"
            }
            Measure::Length if self.radius == 0.0 => {
                "is the light across a core, and without a thickness there is no limit to that: give a radius"
            }
            Measure::Length if self.light_across().is_infinite() => {
                "has no limit along a ray without end: give a reach, at which light ends"
            }
            Measure::Length => return Ok(()),
        };
        Err(Fault::new("peak", advice))
    }

    /// Checks what goes with light that is added up over a core.
    pub(super) fn check_convolution(&self, peak: Option<f64>) -> Checked {
        if self.reach.is_some() {
            let message = "light that is added up over a core has no end: leave reach out, or choose another profile";
            return Err(Fault::new("reach", message));
        }
        if peak.is_some() {
            let message = "light that is added up over a core has no limit along a ray without end: give a coefficient";
            return Err(Fault::new("peak", message));
        }
        Ok(())
    }

    /// Checks its numbers, each for itself.
    pub(super) fn check_sizes(&self) -> Checked {
        finite("radius", self.radius)?;
        if self.radius < 0.0 {
            let message = format!(
                "a thickness is positive, or 0 for none; found {}",
                self.radius
            );
            return Err(Fault::new("radius", message));
        }
        if self.radius > 0.0 {
            positive("radius", self.radius)?;
        }
        self.reach.map_or(Ok(()), |reach| positive("reach", reach))
    }

    /// Checks its numbers, and whether they go together.
    pub(in crate::scene) fn check(&self) -> Checked {
        self.check_sizes()?;
        if self.radius == 0.0 && self.profile.needs_radius() {
            let message = "this profile has a radius as its width: give one, such as 0.1";
            return Err(Fault::new("radius", message));
        }
        match self.reach {
            Some(reach) if reach <= self.radius => {
                let message = format!(
                    "light that ends at {reach} leaves nothing of a core of the radius {}: make reach larger",
                    self.radius
                );
                Err(Fault::new("reach", message))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::Scene;
    use crate::scene::{Camera, Measure, Profile, Sphere};

    #[track_caller]
    fn expect(change: impl Fn(&mut Sphere), key: &str, words: &str) {
        let mut scene = Scene::new(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO));
        scene.integration.measure = Measure::Parameter;
        let mut sphere = Sphere::default();
        change(&mut sphere);
        scene.spheres.push(sphere);
        let fault = scene.check().unwrap_err();
        assert_eq!(fault.key, format!("sphere[0].{key}"));
        assert!(fault.message.contains(words), "{fault}");
    }

    #[test]
    fn a_core_and_its_light_have_sizes_that_go_together() {
        expect(|it| it.radius = -0.1, "radius", "0 for none; found -0.1");
        expect(|it| it.radius = f64::NAN, "radius", "not a finite number");
        expect(|it| it.radius = 1e-12, "radius", "below 1e-9");
        expect(|it| it.reach = Some(0.0), "reach", "must be positive");
        expect(|it| it.reach = Some(-2.0), "reach", "must be positive");
        expect(
            |it| it.profile = Profile::Gaussian,
            "radius",
            "give one, such as 0.1",
        );
        expect(|it| it.profile = Profile::Smeared, "radius", "give one");
        let thick = |it: &mut Sphere| (it.radius, it.reach) = (0.5, Some(0.5));
        expect(thick, "reach", "make reach larger");
        expect(|it| it.peak = Some(1.0), "peak", "measure = \"length\"");
        let mut scene = Scene::new(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO));
        scene.integration.measure = Measure::Length;
        scene.spheres.push(Sphere {
            peak: Some(1.0),
            radius: 0.5,
            reach: Some(0.51),
            profile: Profile::Gaussian,
            ..Sphere::default()
        });
        scene.check().unwrap();
        scene.spheres[0].reach = None;
        scene.spheres[0].profile = Profile::Inverse;
        assert!(scene.check().unwrap_err().message.contains("give a reach"));
        scene.spheres[0].radius = 0.0;
        assert!(scene.check().unwrap_err().message.contains("give a radius"));
        scene.spheres[0].peak = Some(f64::INFINITY);
        assert_eq!(scene.check().unwrap_err().key, "sphere[0].peak");
    }
}
