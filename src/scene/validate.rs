//! The one check of a scene's values. What passes here needs no defence further on: not in the packing, not in a kernel.

use glam::DVec3;

use super::{
    Beam, Camera, Curve, ImageSize, Integration, Measure, Method, Profile, Sampling, Scene,
};
use crate::error::{Result, SceneError};
use crate::reference::CORE_FLOOR;

/// Largest magnitude of any number, smallest of a positive one: squares and cubes of what lies between stay finite and
/// normal in the devices' float32.
const LARGEST: f64 = 1e9;
const SMALLEST: f64 = 1e-9;

/// No product on the way to a pixel may exceed this: sums of up to 1e8 such lights are still finite in float32.
const BRIGHTEST: f64 = 1e30;

type Checked = std::result::Result<(), SceneError>;

impl Scene {
    /// Checks every value. The renderer calls it too: call it where you want the fault before the frame.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] with the key of the first value that cannot be drawn.
    pub fn validate(&self) -> Result<()> {
        Ok(self.check()?)
    }

    pub(super) fn check(&self) -> Checked {
        check_camera(&self.camera)?;
        check_size(self.image)?;
        if let Some(decay) = self.decay {
            positive("decay.alpha", decay.alpha)?;
            positive("decay.beta", decay.beta)?;
        }
        check_integration(&self.integration)?;
        finite("display.exposure", self.display.exposure)?;
        if self.display.exposure.abs() > 100.0 {
            return fault("display.exposure", "more than 100 stops");
        }
        self.check_depth()?;
        let most = |profile| self.greatest_integrand(profile);
        let inverse = most(Profile::Inverse);
        if inverse > BRIGHTEST {
            return fault(
                "decay.beta",
                format!(
                    "alpha / beta^2 next to a core comes to {inverse:.0e}, more than float32 holds"
                ),
            );
        }
        for (i, sphere) in self.spheres.iter().enumerate() {
            let key = |name| format!("sphere[{i}].{name}");
            vector(&key("center"), sphere.center)?;
            light(&key, sphere.coefficient, sphere.color, most(sphere.profile))?;
        }
        for (i, cylinder) in self.cylinders.iter().enumerate() {
            let key = |name| format!("cylinder[{i}].{name}");
            vector(&key("point"), cylinder.point)?;
            direction(&key("direction"), cylinder.direction)?;
            let most = most(cylinder.profile);
            light(&key, cylinder.coefficient, cylinder.color, most)?;
        }
        for (i, beam) in self.beams.iter().enumerate() {
            check_beam(i, beam, most(beam.profile))?;
        }
        for (i, torus) in self.tori.iter().enumerate() {
            let key = |name| format!("torus[{i}].{name}");
            vector(&key("center"), torus.center)?;
            direction(&key("axis"), torus.axis)?;
            positive(&key("major_radius"), torus.major_radius)?;
            light(&key, torus.coefficient, torus.color, most(torus.profile))?;
        }
        for (i, curve) in self.curves.iter().enumerate() {
            check_curve(i, curve, most(curve.profile))?;
        }
        Ok(())
    }

    /// The greatest value that decay times field times measure can take, on a ray through a core.
    fn greatest_integrand(&self, profile: Profile) -> f64 {
        let decay = self.decay.map_or(1.0, |decay| decay.at(0.0));
        let length = self.camera.ray_length();
        let least_distance = (CORE_FLOOR * length).max(self.integration.softening);
        let measure = match self.integration.measure {
            Measure::Parameter => 1.0,
            Measure::Length => length,
        };
        let field = match profile {
            Profile::Inverse => 1.0 / least_distance,
            Profile::InverseSquare => 1.0 / (least_distance * least_distance),
        };
        decay * field * measure.max(1.0)
    }

    fn check_depth(&self) -> Checked {
        let Some(depth) = &self.depth else {
            return Ok(());
        };
        let (depth, image) = (depth.size(), self.image);
        if depth == image {
            return Ok(());
        }
        fault(
            "depth",
            format!(
                "the depth image has {}x{} pixels, the image {}x{}; they must be equal",
                depth.width, depth.height, image.width, image.height
            ),
        )
    }
}

fn check_camera(camera: &Camera) -> Checked {
    vector("camera.eye", camera.eye)?;
    vector("camera.target", camera.target)?;
    direction("camera.up", camera.up)?;
    finite("camera.fov_y", camera.fov_y)?;
    if !(0.001..=179.9).contains(&camera.fov_y) {
        return fault("camera.fov_y", "must lie between 0.001 and 179.9 degrees");
    }
    positive("camera.near", camera.near)?;
    let view = camera.target - camera.eye;
    if view.length() < SMALLEST {
        return fault(
            "camera.target",
            "the same point as camera.eye: there is no view direction",
        );
    }
    if view.normalize().cross(camera.up.normalize()).length() < 1e-6 {
        return fault(
            "camera.up",
            "parallel to the view direction; choose any other",
        );
    }
    match camera.ray_length {
        Some(length) => positive("camera.ray_length", length),
        None if camera.ray_length() < SMALLEST => fault(
            "camera.near",
            "the projection plane lies behind the target, so ray_length has no default: \
             give camera.ray_length, or a smaller near",
        ),
        None => Ok(()),
    }
}

fn check_size(size: ImageSize) -> Checked {
    let limit = ImageSize::LIMIT;
    for (key, pixels) in [("image.width", size.width), ("image.height", size.height)] {
        if pixels == 0 {
            return fault(key, "must be at least 1 pixel");
        }
        if pixels > limit {
            return fault(
                key,
                format!("{pixels} pixels; an image is at most {limit}x{limit}"),
            );
        }
    }
    Ok(())
}

fn check_integration(integration: &Integration) -> Checked {
    let divisions = integration.divisions;
    if !(2..=65536).contains(&divisions) || !divisions.is_multiple_of(2) {
        return fault(
            "integration.divisions",
            format!("{divisions}; Simpson's rule needs an even number from 2 to 65536"),
        );
    }
    if integration.method == Method::Simpson && integration.sampling == Some(Sampling::Tiles) {
        return fault(
            "integration.sampling",
            "tiles are for the method \"exact\"; Simpson's rule takes every pixel",
        );
    }
    finite("integration.tolerance", integration.tolerance)?;
    if !(1e-12..1.0).contains(&integration.tolerance) {
        return fault(
            "integration.tolerance",
            "must lie between 1e-12 and 1, 1 excluded",
        );
    }
    finite("integration.softening", integration.softening)?;
    if integration.softening < 0.0 {
        return fault("integration.softening", "must not be negative");
    }
    Ok(())
}

fn check_beam(index: usize, beam: &Beam, most: f64) -> Checked {
    let key = |name| format!("beam[{index}].{name}");
    vector(&key("tip"), beam.tip)?;
    direction(&key("direction"), beam.direction)?;
    if let Some(length) = beam.taper_length {
        positive(&key("taper_length"), length)?;
        if beam.cap_coefficient.is_some() {
            return fault(
                key("cap_coefficient"),
                "behind its tip a beam has a cap or a taper: leave out cap_coefficient or taper_length",
            );
        }
    }
    if let Some(cap) = beam.cap_coefficient {
        finite(&key("cap_coefficient"), cap)?;
    }
    finite(&key("sphere_coefficient"), beam.sphere_coefficient)?;
    light(&key, beam.coefficient, beam.color, most)?;
    let strongest = beam.coefficient.abs().max(beam.cap().abs()) + beam.sphere_coefficient.abs();
    bright(&key, strongest, beam.color, most)
}

fn check_curve(index: usize, curve: &Curve, most: f64) -> Checked {
    let key = |name| format!("curve[{index}].{name}");
    for (k, point) in curve.control_points.iter().enumerate() {
        vector(&format!("curve[{index}].control_points[{k}]"), *point)?;
    }
    let series = curve.intensity.iter().flatten();
    let strongest = series.fold(1.0_f64, |most, value| most.max(value.abs()));
    light(&key, curve.coefficient, curve.color, most * strongest)?;
    if let Some(series) = &curve.intensity {
        if series.len() < 3 {
            return fault(
                key("intensity"),
                format!(
                    "needs at least 3 values, found {}; leave it out for 1 everywhere",
                    series.len()
                ),
            );
        }
        for (k, value) in series.iter().enumerate() {
            finite(&format!("curve[{index}].intensity[{k}]"), *value)?;
        }
    }
    Ok(())
}

/// `most` is the greatest integrand that meets this light.
fn light(
    key: &impl Fn(&'static str) -> String,
    coefficient: f64,
    color: DVec3,
    most: f64,
) -> Checked {
    finite(&key("coefficient"), coefficient)?;
    vector(&key("color"), color)?;
    bright(key, coefficient, color, most)
}

fn bright(
    key: &impl Fn(&'static str) -> String,
    coefficient: f64,
    color: DVec3,
    most: f64,
) -> Checked {
    let brightest = most * coefficient.abs() * color.abs().max_element();
    if brightest > BRIGHTEST {
        return fault(
            key("coefficient"),
            format!("next to the core the light comes to {brightest:.0e}, more than float32 holds"),
        );
    }
    Ok(())
}

fn fault(key: impl Into<String>, message: impl Into<String>) -> Checked {
    Err(SceneError::value(key, message))
}

fn finite(key: &str, value: f64) -> Checked {
    if !value.is_finite() {
        return fault(key, format!("{value} is not a finite number"));
    }
    if value.abs() > LARGEST {
        return fault(
            key,
            format!("{value:e} is beyond {LARGEST:e}, what float32 devices can integrate"),
        );
    }
    Ok(())
}

fn positive(key: &str, value: f64) -> Checked {
    finite(key, value)?;
    if value <= 0.0 {
        return fault(key, format!("must be positive, found {value}"));
    }
    if value < SMALLEST {
        return fault(
            key,
            format!("{value:e} is below {SMALLEST:e}, what float32 devices can integrate"),
        );
    }
    Ok(())
}

fn vector(key: &str, value: DVec3) -> Checked {
    value
        .to_array()
        .into_iter()
        .try_for_each(|v| finite(key, v))
}

fn direction(key: &str, value: DVec3) -> Checked {
    vector(key, value)?;
    if value.length() < SMALLEST {
        return fault(
            key,
            format!(
                "a vector shorter than {SMALLEST:e}, such as the zero vector, has no direction; give one such as \
                 [0.0, 0.0, 1.0]"
            ),
        );
    }
    Ok(())
}
