//! The exposure of a scene that names none, from what it says of its sources.

use super::kinds::for_each_kind;
use super::source::{Falloff, HasLight, Shared};
use super::{Measure, Reduction, Scene};

/// So far from a core, as a share of the picture's height, light is shown at about two thirds of white. That holds for
/// AgX as for `1 - exp(-L)`: seen on one ring, both are as dark far from it, and half a stop more is fog around it.
const HALO: f64 = 0.008;

macro_rules! define_all_shared {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        impl Scene {
            fn for_each_shared(&self, visit: &mut dyn FnMut(Shared<'_>)) {
                $(self.$list.iter().for_each(|source| visit(source.shared()));)*
            }
        }
    };
}
for_each_kind!(define_all_shared);

impl Scene {
    /// Returns the exposure, stops, that a scene file gets which names none. With it the light of the brightest source
    /// is 1 beside its core, 0.008 of the picture's height away as far off as the target: cores are white and the
    /// background is dark, whatever coefficients and the scale of the world are. 0 for a scene with a decay, with
    /// surfaces, particles or volumes, or with a source that says by its peak how bright it is.
    #[must_use]
    pub fn fitting_exposure(&self) -> f64 {
        self.exposure_of_brightest().unwrap_or(0.0)
    }

    /// Returns it where the brightest source decides: not where there is a peak or a decay, or no light.
    pub(super) fn exposure_of_brightest(&self) -> Option<f64> {
        let reduction = self.integration.reduction;
        let height = self.camera.height_at(self.focus());
        let mut brightest: f64 = 0.0;
        // What a surface sends out is said by its colour, what a particle does by its coefficient.
        let mut has_peak = self.decay.is_some()
            || !self.metaballs.is_empty()
            || !self.meshes.is_empty()
            || self.has_particles()
            || self.has_points()
            || !self.volumes.is_empty();
        self.for_each_shared(&mut |source| {
            has_peak |= source.has_peak();
            for light in source.lights() {
                let beside = beside(light.falloff, HALO * height, self.ray_length(), reduction);
                brightest = brightest.max(light.emission().abs().max_element() * beside);
            }
        });
        let measure = match self.integration.measure {
            Measure::Length => 1.0,
            Measure::Parameter => reduction.of(self.ray_length()),
        };
        match measure / brightest {
            times if has_peak || !times.is_normal() => None,
            times => Some(times.log2().clamp(-100.0, 100.0)),
        }
    }
}

/// Returns the light of a ray that passes a core of coefficient 1 at a distance, measured by length.
fn beside(falloff: Falloff, distance: f64, ray_length: f64, reduction: Reduction) -> f64 {
    let wider = Falloff {
        radius: falloff.radius.hypot(distance),
        reach: falloff.reach.map(|reach| reach.max(2.0 * distance)),
        ..falloff
    };
    let far = ray_length.max(2.0 * wider.radius);
    if reduction != Reduction::Sum {
        let end = wider.reach.unwrap_or(far);
        let squares = wider.sum_across(end, |field| reduction.summand(field));
        return reduction.of(squares);
    }
    match wider.light_across() {
        light if light.is_finite() => light,
        _ => Falloff {
            reach: Some(far),
            ..wider
        }
        .light_across(),
    }
}
