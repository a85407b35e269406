//! Where the sources of a scene are, and how long rays are that pass them.

use glam::DVec3;

use super::kinds::for_each_kind;
use super::source::{Falloff, HasLight, SourceKind};
use super::{Camera, Profile, Scene};

/// Rays of a length that no camera names go so many times as far from the projection plane as what they look at.
const TIMES_BEYOND: f64 = 5.0;

/// What float32 devices can integrate along, world units.
const LONGEST: f64 = 1e9;

/// How far a Gaussian is bright, in its radii: beyond is less than 4e-6 of its peak.
const BRIGHT_RADII: f64 = 5.0;

/// Returns how far from its core there is light; `None`: everywhere.
fn end_of(falloff: Falloff) -> Option<f64> {
    let of_gaussian = BRIGHT_RADII * falloff.radius;
    match falloff.profile {
        Profile::Gaussian => Some(
            falloff
                .reach
                .map_or(of_gaussian, |reach| reach.min(of_gaussian)),
        ),
        _ => falloff.reach,
    }
}

/// A box along the axes of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

impl Bounds {
    const EMPTY: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    fn join(&mut self, low: DVec3, high: DVec3) {
        // What is no number is a fault that others tell.
        if low.is_finite() && high.is_finite() {
            (self.low, self.high) = (self.low.min(low), self.high.max(high));
        }
    }

    /// Returns the greatest distance of its points from a point; 0 of an empty box.
    fn farthest_from(&self, point: DVec3) -> f64 {
        match self.low.cmple(self.high).all() {
            true => (point - self.low)
                .abs()
                .max((self.high - point).abs())
                .length(),
            false => 0.0,
        }
    }
}

/// Where some sources are: the cores of those whose light goes on, and the others with all of their light. Of lines
/// without end it has the point that they name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    endless: Bounds,
    ended: Bounds,
}

impl Extent {
    const EMPTY: Self = Self {
        endless: Bounds::EMPTY,
        ended: Bounds::EMPTY,
    };

    /// Finds that of sources, right or wrong.
    fn of(sources: &[impl SourceKind]) -> Self {
        let mut extent = Self::EMPTY;
        for source in sources {
            let (low, high) = source.core().bounds();
            match source.shared().farthest_reach() {
                None => extent.endless.join(low, high),
                Some(reach) => extent.ended.join(low - reach, high + reach),
            }
        }
        extent
    }

    fn join(&mut self, other: &Self) {
        self.endless.join(other.endless.low, other.endless.high);
        self.ended.join(other.ended.low, other.ended.high);
    }

    /// Returns how far from the eye what a camera looks at is: its target, or where its matrices have none the middle
    /// of all sources, if that lies before the projection plane.
    fn focus(&self, camera: &Camera) -> f64 {
        if camera.matrices.is_none() {
            return camera.eye.distance(camera.target);
        }
        let (eye, axis) = camera.eye_and_axis();
        let mut all = self.endless;
        all.join(self.ended.low, self.ended.high);
        let ahead = (0.5 * (all.low + all.high) - eye).dot(axis);
        match ahead > camera.near {
            true => ahead,
            false => camera.near + camera.near.abs().max(1.0),
        }
    }

    /// Returns the length of rays that pass all of it.
    fn ray_length(&self, camera: &Camera) -> f64 {
        let (eye, beyond) = (camera.eye_and_axis().0, self.focus(camera));
        let endless = self.endless.farthest_from(eye).max(beyond);
        let ended = self.ended.farthest_from(eye) - camera.near;
        (TIMES_BEYOND * (endless - camera.near))
            .max(ended)
            .min(LONGEST)
    }
}

macro_rules! define_extent {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        impl Scene {
            fn extent(&self) -> Extent {
                let mut extent = Extent::EMPTY;
                $(extent.join(&self.$list.extent(|sources| Extent::of(sources)));)*
                for particles in self.particles.iter().filter(|it| !it.points.is_empty()) {
                    let (low, high) = particles.points.bounds();
                    let (place, reach) = (particles.translate, particles.greatest_radius());
                    extent.ended.join(low + place - reach, high + place + reach);
                }
                for points in self.points.iter().filter(|it| !it.points.is_empty()) {
                    let (low, high) = points.points.bounds();
                    match points.reach {
                        None => extent.endless.join(low, high),
                        Some(reach) => extent.ended.join(low - reach, high + reach),
                    }
                }
                for volume in self.volumes.iter() {
                    let (place, reach) = (volume.center, volume.radius());
                    extent.ended.join(place - reach, place + reach);
                }
                extent
            }

            /// Returns the lowest and the highest corner of a box around all light of all sources, world space; `None`
            /// where there are none, or the light of any has no end.
            #[must_use]
            pub fn light_bounds(&self) -> Option<[DVec3; 2]> {
                let mut bounds = Bounds::EMPTY;
                $(for source in &self.$list {
                    let reaches = source.lights().map(|light| end_of(light.falloff));
                    let reach = reaches.reduce(|one, other| Some(one?.max(other?))).flatten()?;
                    let core = source.core();
                    core.ball()?; // lines have none
                    let (low, high) = core.bounds();
                    bounds.join(low - reach, high + reach);
                })*
                bounds.low.cmple(bounds.high).all().then_some([bounds.low, bounds.high])
            }
        }
    };
}
for_each_kind!(define_extent);

impl Scene {
    /// Returns how far from the eye what the camera looks at is, world units.
    pub(super) fn focus(&self) -> f64 {
        self.extent().focus(&self.camera)
    }

    /// Returns the length of every ray, `|E - S|`, world units: the camera's, or where it names none one that passes
    /// all sources. That is, measured from the projection plane, 5 times as far as the target (of matrices: the middle
    /// of all sources) and the cores of sources without a reach, and no less far than the light of those with one; at
    /// most 1e9. Cores are taken by the box around them, cylinders and beams by the point or tip that they name.
    #[must_use]
    pub fn ray_length(&self) -> f64 {
        let camera = &self.camera;
        camera
            .ray_length
            .unwrap_or_else(|| self.extent().ray_length(camera))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Beam, Cylinder, Layer, LightPath, Sphere, Torus};

    /// From 4 before the origin, the plane at 1.
    fn scene() -> Scene {
        Scene::new(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO))
    }

    #[test]
    fn rays_pass_all_sources_and_a_reach_ends_them() {
        let mut scene = scene();
        assert_eq!(scene.ray_length(), 15.0);
        scene.spheres.push(Sphere {
            center: DVec3::new(0.0, -1.0, 0.0),
            ..Sphere::default()
        });
        assert_eq!(scene.ray_length(), 15.0, "the target is farther");
        scene.spheres[0].center.y = 16.0;
        assert_eq!(scene.ray_length(), 95.0);
        scene.spheres[0].reach = Some(3.0);
        let corner = DVec3::new(3.0, 23.0, 3.0);
        assert_eq!(scene.ray_length(), corner.length() - 1.0);
        let layer = |reach| Layer {
            reach,
            ..Layer::default()
        };
        scene.spheres[0].layers = vec![layer(None), layer(Some(4.0))];
        let corner = DVec3::new(4.0, 24.0, 4.0);
        assert_eq!(scene.ray_length(), corner.length() - 1.0);
        scene.spheres[0].reach = None;
        assert_eq!(scene.ray_length(), 95.0, "a layer has no reach");
        scene.camera.ray_length = Some(2.0);
        assert_eq!(scene.ray_length(), 2.0);
    }

    #[test]
    fn rings_count_whole_and_lines_by_their_point() {
        let mut scene = scene();
        scene.tori.push(Torus::new(3.0));
        let expected = 5.0 * (DVec3::new(3.0, 7.0, 0.0).length() - 1.0);
        assert!((scene.ray_length() - expected).abs() < 1e-12);
        scene.tori.clear();
        let point = 10.0 * DVec3::Y;
        scene.cylinders.push(Cylinder {
            point,
            ..Cylinder::new(DVec3::X)
        });
        assert_eq!(scene.ray_length(), 65.0);
        scene.cylinders.clear();
        scene.beams.push(Beam {
            tip: point,
            ..Beam::new(DVec3::Y)
        });
        assert_eq!(scene.ray_length(), 65.0);
        for points in [vec![], vec![DVec3::ONE]] {
            let mut broken = scene.clone();
            broken.paths.push(LightPath::new(points)); // a fault, but none of this
            assert_eq!(broken.ray_length(), 65.0);
        }
        scene.beams[0].tip.y = f64::NAN;
        assert_eq!(scene.ray_length(), 15.0);
        scene.beams[0].tip.y = 1e9;
        assert_eq!(scene.ray_length(), 1e9);
    }
}
