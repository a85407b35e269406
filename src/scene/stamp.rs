//! The stamp of a scene's sources: a small value that is equal only where the sources are, so that nobody has to look
//! at every source again.

use super::Scene;
use super::kinds::{KIND_COUNT, for_each_kind};

/// The revisions of a scene's lists, in the order of the table of kinds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SourcesStamp([u64; KIND_COUNT]);

macro_rules! define_stamp {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        impl Scene {
            pub(crate) fn sources_stamp(&self) -> SourcesStamp {
                SourcesStamp([$(self.$list.revision()),*])
            }
        }
    };
}
for_each_kind!(define_stamp);

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::scene::{Camera, Decay, Scene, Sphere};

    fn scene() -> Scene {
        let mut scene = Scene::new(Camera::new(4.0 * DVec3::X, DVec3::ZERO));
        scene.spheres.push(Sphere::default());
        scene
    }

    #[test]
    fn the_stamp_changes_with_the_sources_alone() {
        let scene = scene();
        let before = scene.sources_stamp();
        let after = |change: fn(&mut Scene)| {
            let mut other = scene.clone();
            change(&mut other);
            other.sources_stamp()
        };
        assert!(before == after(|scene| scene.camera.near = 0.5));
        assert!(before != after(|scene| scene.spheres[0].coefficient = 2.0));
        assert!(before != after(|scene| scene.curves.clear()));
    }

    #[test]
    fn faults_are_found_though_the_sources_were_right_before() {
        let mut checked = None;
        let mut scene = scene();
        scene.spheres[0].coefficient = 1e9;
        scene.validate_again(&mut checked).unwrap();
        let first = checked;
        scene.validate_again(&mut checked).unwrap();
        assert!(checked.is_some() && checked == first);
        let fault = |change: fn(&mut Scene)| {
            let (mut other, mut checked) = (scene.clone(), checked);
            change(&mut other);
            let error = other.validate_again(&mut checked).unwrap_err();
            error.to_string()
        };
        assert!(fault(|scene| scene.camera.near = -1.0).contains("camera.near"));
        assert!(fault(|scene| scene.spheres[0].center.x = f64::NAN).contains("sphere[0].center"));
        let bright = fault(|scene| {
            scene.decay = Some(Decay::new(1e9, 1e-4));
        });
        assert!(bright.contains("sphere[0].coefficient"), "{bright}");
    }
}
