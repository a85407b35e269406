//! How a field falls off with the distance to its core: a profile, the thickness of the core, and where light ends.

use serde::{Deserialize, Serialize};

use crate::scene::values::{Checked, Fault, finite, positive};

/// How a field falls off with the distance d to its core.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Profile {
    /// `1/d` (2015, 2010).
    #[default]
    Inverse,
    /// `1/d^2` (Sakai 2006).
    InverseSquare,
    /// `1/d^3`; with a radius that of Plummer's sphere.
    InverseCube,
    /// `exp(-d^2 / (2 radius^2))`: the radius is the standard deviation, and there must be one.
    Gaussian,
    /// `erf(d / (sqrt(2) radius)) / d`: `1/d` smeared by a Gaussian of that standard deviation.
    Smeared,
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

impl Falloff {
    /// Returns whether its integrals have no closed form on the devices.
    pub(crate) fn is_shaped(&self) -> bool {
        let is_inverse = matches!(self.profile, Profile::Inverse | Profile::InverseSquare);
        !is_inverse || self.reach.is_some()
    }

    /// Returns whether it has a sharper peak than 1 over the distance.
    pub(crate) fn is_sharp(&self) -> bool {
        !matches!(self.profile, Profile::Inverse | Profile::Smeared)
    }

    /// Checks its numbers.
    pub(super) fn check(&self) -> Checked {
        finite("radius", self.radius)?;
        if self.radius < 0.0 {
            let message = format!(
                "a thickness is positive, or 0 for none; found {}",
                self.radius
            );
            return Err(Fault::new("radius", message));
        }
        match self.radius {
            0.0 if self.profile.needs_radius() => {
                let message = "this profile has a radius as its width: give one, such as 0.1";
                return Err(Fault::new("radius", message));
            }
            0.0 => {}
            radius => positive("radius", radius)?,
        }
        let Some(reach) = self.reach else {
            return Ok(());
        };
        positive("reach", reach)?;
        if reach <= self.radius {
            let message = format!(
                "light that ends at {reach} leaves nothing of a core of the radius {}: make reach larger",
                self.radius
            );
            return Err(Fault::new("reach", message));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::Scene;
    use crate::scene::{Camera, Profile, Sphere};

    #[track_caller]
    fn expect(change: impl Fn(&mut Sphere), key: &str, words: &str) {
        let mut scene = Scene::new(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO));
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
        let mut scene = Scene::new(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO));
        scene.spheres.push(Sphere {
            radius: 0.5,
            reach: Some(0.51),
            profile: Profile::Gaussian,
            ..Sphere::default()
        });
        scene.check().unwrap();
    }
}
