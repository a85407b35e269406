//! Stamps: small values that are equal only where the scenes are, so that nobody has to look at every source again.

use super::kinds::{KIND_COUNT, for_each_kind};
use super::{Camera, Decay, Integration, Scene};
use crate::image::{DepthImage, Display, ImageSize};

/// The revisions of a scene's lists, in the order of the table of kinds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SourcesStamp([u64; KIND_COUNT]);

/// Everything of a scene, its lists by their revisions and its depths by their place in memory.
#[derive(Debug, Clone)]
pub(crate) struct SceneStamp {
    camera: Camera,
    image: ImageSize,
    decay: Option<Decay>,
    integration: Integration,
    display: Display,
    depth: Option<DepthImage>,
    sources: SourcesStamp,
}

impl PartialEq for SceneStamp {
    fn eq(&self, other: &Self) -> bool {
        let is_same_depth = match (&self.depth, &other.depth) {
            (Some(depth), Some(other)) => {
                depth.shares_values(other)
                    && (depth.size(), depth.along()) == (other.size(), other.along())
            }
            (depth, other) => depth.is_none() && other.is_none(),
        };
        is_same_depth
            && self.sources == other.sources
            && self.camera == other.camera
            && self.image == other.image
            && self.decay == other.decay
            && self.integration == other.integration
            && self.display == other.display
    }
}

macro_rules! define_stamps {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        impl Scene {
            pub(crate) fn sources_stamp(&self) -> SourcesStamp {
                SourcesStamp([$(self.$list.revision()),*])
            }
        }
    };
}
for_each_kind!(define_stamps);

impl Scene {
    pub(crate) fn stamp(&self) -> SceneStamp {
        SceneStamp {
            camera: self.camera.clone(),
            image: self.image,
            decay: self.decay,
            integration: self.integration,
            display: self.display,
            depth: self.depth.clone(),
            sources: self.sources_stamp(),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::image::DepthAlong;
    use crate::scene::Sphere;

    #[test]
    fn a_stamp_changes_with_each_part_of_the_scene() {
        let mut scene = Scene::new(Camera::new(DVec3::X, DVec3::ZERO));
        scene.spheres.push(Sphere::default());
        let before = scene.stamp();
        assert!(before == scene.clone().stamp());
        let changes: [fn(&mut Scene); 8] = [
            |scene| scene.camera.near = 0.5,
            |scene| scene.image.width = 7,
            |scene| {
                scene.decay = Some(Decay {
                    alpha: 1.0,
                    beta: 1.0,
                });
            },
            |scene| scene.integration.softening = 0.1,
            |scene| scene.display.exposure = 1.0,
            |scene| scene.spheres[0].coefficient = 2.0,
            |scene| scene.curves.clear(),
            |scene| {
                let values = vec![1.0; scene.image.pixels()];
                scene.depth = DepthImage::new(scene.image, DepthAlong::Ray, values).ok();
            },
        ];
        for (number, change) in changes.into_iter().enumerate() {
            let mut other = scene.clone();
            change(&mut other);
            assert!(before != other.stamp(), "change {number}");
        }
    }
}
