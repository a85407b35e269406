//! What can be drawn and was hardly meant: numbers in other units, and pictures that are black.

use std::fmt::Write;

use glam::DVec3;

use super::kinds::for_each_kind;
use super::source::Core;
use super::{Collider, ColliderShape, Scene, SourceKind};
use crate::error::SceneError;

/// A view of at most so many degrees may have been meant in radians, of which half a turn has 3.1.
const NARROWEST: f64 = 3.0;

/// Whole numbers from here on in a colour look like 0 to 255; light brighter than white is mostly not that bright.
const LEAST_BYTE: f64 = 16.0;

/// A source as the warnings see it.
pub(super) struct Seen {
    kind: &'static str,
    index: usize,
    /// The first of its colours that looks like 0 to 255, with the layer that names it.
    byte_color: Option<(Option<usize>, DVec3)>,
    pub core: Core,
    /// The least and the greatest light of its parts, of all channels.
    pub light: (f64, f64),
}

impl Seen {
    fn new(kind: &'static str, index: usize, source: &impl SourceKind) -> Self {
        let mut light = (0.0_f64, 0.0_f64);
        source.for_each_emission(&mut |emission| {
            light = (
                light.0.min(emission.min_element()),
                light.1.max(emission.max_element()),
            );
        });
        Self {
            kind,
            index,
            byte_color: source.shared().colors().find(|(_, color)| is_bytes(*color)),
            core: source.core(),
            light,
        }
    }

    pub(super) fn key(&self) -> String {
        format!("{}[{}]", self.kind, self.index)
    }
}

/// Returns whether a colour looks like 0 to 255.
fn is_bytes(color: DVec3) -> bool {
    let is_byte = |value: f64| (0.0..=255.0).contains(&value) && value.fract() == 0.0;
    color.to_array().into_iter().all(is_byte) && color.max_element() >= LEAST_BYTE
}

macro_rules! see_sources {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        impl Scene {
            /// Calls `visit` with every source, until it returns false.
            pub(super) fn all_sources(&self, visit: &mut dyn FnMut(&Seen) -> bool) {
                $(
                    for (index, source) in self.$list.iter().enumerate() {
                        if !visit(&Seen::new(stringify!($kind), index, source)) {
                            return;
                        }
                    }
                )*
            }
        }
    };
}
for_each_kind!(see_sources);

impl Scene {
    /// Returns what can be drawn and was hardly meant, each like a fault with key and message: an angle in radians,
    /// colours from 0 to 255, light that nobody can see. The order is that of the keys in the scene; of many sources at
    /// fault in the same way the first is named.
    ///
    /// The scene is to be valid ([`Scene::validate`]). Files tell the place too: [`Scene::from_file_with_warnings`].
    #[must_use]
    pub fn warnings(&self) -> Vec<SceneError> {
        let angle = self.narrow_view();
        let dark = self.darkness().or_else(|| self.out_of_view());
        angle
            .into_iter()
            .chain(self.byte_colors())
            .chain(dark)
            .chain(self.no_particles())
            .chain(self.slow_points())
            .chain(self.nothing_to_light())
            .chain(self.open_collider())
            .collect()
    }

    fn narrow_view(&self) -> Option<SceneError> {
        let fov_y = self.camera.fov_y;
        let looks = self.camera.matrices.is_none();
        (looks && fov_y <= NARROWEST).then(|| {
            let message = format!(
                "{fov_y} degrees are a narrow view; if radians were meant, write {:.1}",
                fov_y.to_degrees()
            );
            SceneError::value("camera.fov_y", message)
        })
    }

    fn byte_colors(&self) -> Option<SceneError> {
        let mut first: Option<SceneError> = None;
        let mut more = 0;
        self.all_sources(&mut |source| {
            let Some((layer, color)) = source.byte_color else {
                return true;
            };
            if first.is_some() {
                more += 1;
                return true;
            }
            let color = color.to_array();
            let [red, green, blue] = color.map(|value| (value / 255.0 * 1000.0).round() / 1000.0);
            let message = format!(
                "{color:?} looks like 0 to 255; colours are linear and 1 is white: write [{red:?}, {green:?}, {blue:?}]"
            );
            let layer = layer.map_or(String::new(), |index| format!(".layers[{index}]"));
            let key = format!("{}{layer}.color", source.key());
            first = Some(SceneError::value(key, message));
            true
        });
        if let (Some(first), 1..) = (&mut first, more) {
            let _ = write!(first.message, " ({more} more sources have such colours)");
        }
        first
    }

    /// Says that a surface, or light, is made of nothing.
    fn no_particles(&self) -> Option<SceneError> {
        let dark = self.particles.iter().position(|it| it.points.is_empty());
        if let Some(index) = dark {
            let message = "it has no particle: `points`, `file` or `lattice` says where they are";
            return Some(SceneError::value(format!("particles[{index}]"), message));
        }
        if let Some(index) = self.points.iter().position(|it| it.points.is_empty()) {
            let message = "it has no point: `positions` or `file` says where they are";
            return Some(SceneError::value(format!("points[{index}]"), message));
        }
        let index = self
            .metaballs
            .iter()
            .position(|metaballs| metaballs.points.is_empty())?;
        let message = "it has no particle, so there is no surface: `points`, `file` or `lattice` says where they are";
        Some(SceneError::value(format!("metaballs[{index}]"), message))
    }

    /// Says that many points are drawn each by itself.
    fn slow_points(&self) -> Option<SceneError> {
        let (index, count) = self.many_points_apart()?;
        let message = format!(
            "{count} points are drawn each by itself, which takes long: what no crowd has is in docs/scenes.md; if \
             that is meant, write crowd = \"never\" in [integration]"
        );
        Some(SceneError::value(format!("points[{index}]"), message))
    }

    /// Says that light is to be cast, and on nothing.
    fn nothing_to_light(&self) -> Option<SceneError> {
        let has_mesh = !self.meshes.is_empty() || self.colliders.iter().any(|it| it.is_seen_mesh());
        let is_idle = self.lighting.is_some() && !has_mesh;
        is_idle.then(|| {
            let message = "lights meshes, and there is no [[mesh]]: add one, or leave it out";
            SceneError::value("lighting", message)
        })
    }

    /// Says that waves meet a mesh which has no inside.
    fn open_collider(&self) -> Option<SceneError> {
        let is_open = |collider: &Collider| match &collider.shape {
            ColliderShape::Mesh(mesh) => !mesh.triangles.is_closed(),
            _ => false,
        };
        let index = self.colliders.iter().position(is_open)?;
        let message = "its mesh is open, so that it has no inside: particles turn back from the side that they \
            come from, and those that come through a gap are not pushed out; close its edges";
        let is_met = !self.waves.is_empty();
        is_met.then(|| SceneError::value(format!("collider[{index}].mesh"), message))
    }

    /// Says that nothing glows.
    fn darkness(&self) -> Option<SceneError> {
        let mut first = None;
        let mut light = (0.0_f64, 0.0_f64);
        self.all_sources(&mut |source| {
            first.get_or_insert_with(|| source.key());
            light = (light.0.min(source.light.0), light.1.max(source.light.1));
            light.1 <= 0.0
        });
        if self
            .metaballs
            .iter()
            .any(|metaballs| metaballs.color.max_element() > 0.0)
        {
            return None; // what is told of those is another matter
        }
        if self.has_particles()
            || self.has_points()
            || !self.volumes.is_empty()
            || !self.meshes.is_empty()
            || self.colliders.iter().any(|it| it.visible)
        {
            return None;
        }
        let Some(first) = first else {
            let message = "the scene has no source of light: the picture is black";
            return Some(SceneError::value("", message));
        };
        let message = match light {
            (_, most) if most > 0.0 => return None,
            (0.0, _) => {
                "gives no light, as all sources do: coefficient, color or intensity is 0, the picture is black"
            }
            _ => {
                "takes light away, as all sources do: coefficients or colours are negative, the picture is black"
            }
        };
        Some(SceneError::value(first, message))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::image::ImageSize;
    use crate::scene::{Camera, Curve, Layer, Sphere, Torus};

    /// From (0, -4, 0) along +y: the plane is at y = -3, the rays end 15 behind it.
    pub(in crate::scene) fn scene() -> Scene {
        let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO));
        scene.camera.ray_length = Some(15.0);
        scene.image = ImageSize {
            width: 8,
            height: 6,
        };
        scene
    }

    pub(in crate::scene) fn sphere(y: f64) -> Sphere {
        Sphere {
            center: DVec3::new(0.0, y, 0.0),
            ..Sphere::default()
        }
    }

    #[track_caller]
    pub(in crate::scene) fn expect(scene: &Scene, key: &str, words: &str) {
        scene.validate().unwrap();
        let found = scene.warnings();
        let [found] = found.as_slice() else {
            panic!("{key}: {found:?}");
        };
        assert_eq!(found.key, key, "{found}");
        assert!(found.message.contains(words), "{found}");
    }

    #[test]
    fn a_view_in_radians_and_colours_to_255_are_told() {
        let mut good = scene();
        good.spheres.push(sphere(0.0));
        assert_eq!(good.warnings(), []);
        let mut radians = good.clone();
        radians.camera.fov_y = 0.8;
        expect(
            &radians,
            "camera.fov_y",
            "if radians were meant, write 45.8",
        );
        let color = |color: [f64; 3]| {
            let mut scene = good.clone();
            scene.spheres[0].color = color.into();
            scene
        };
        expect(
            &color([255.0, 51.0, 0.0]),
            "sphere[0].color",
            "write [1.0, 0.2, 0.0]",
        );
        for bright in [
            [16.5, 20.0, 3.0],
            [12.0, 4.0, 1.0],
            [400.0, 1.0, 1.0],
            [-20.0, 30.0, 1.0],
            [1.0; 3],
        ] {
            assert_eq!(color(bright).warnings(), [], "{bright:?}");
        }
        let mut many = color([255.0, 0.0, 0.0]);
        for _ in 0..4 {
            let again = many.spheres[0].clone();
            many.spheres.push(again);
        }
        expect(
            &many,
            "sphere[0].color",
            "(4 more sources have such colours)",
        );
    }

    #[test]
    fn layers_are_warned_of_as_sources_are() {
        let layer = |coefficient, color: Option<DVec3>| Layer {
            coefficient: Some(coefficient),
            color,
            ..Layer::default()
        };
        let mut scene = scene();
        scene.spheres.push(Sphere {
            color: DVec3::new(255.0, 0.0, 0.0),
            layers: vec![layer(1.0, Some(DVec3::ONE)), layer(0.0, Some(DVec3::X))],
            ..sphere(0.0)
        });
        assert_eq!(
            scene.warnings(),
            [],
            "no light has the colour of the source"
        );
        scene.spheres[0].layers[1].color = Some(DVec3::new(0.0, 0.0, 255.0));
        expect(&scene, "sphere[0].layers[1].color", "write [0.0, 0.0, 1.0]");
        scene.spheres[0].layers[1].color = None;
        expect(&scene, "sphere[0].color", "write [1.0, 0.0, 0.0]");
        scene.spheres[0].layers = vec![layer(0.0, None), layer(0.0, Some(DVec3::X))];
        scene.spheres[0].color = DVec3::ONE;
        expect(&scene, "sphere[0]", "gives no light");
        scene.spheres[0].layers[1].coefficient = Some(1.0);
        assert_eq!(scene.warnings(), []);
    }

    #[test]
    fn a_scene_that_gives_no_light_is_told() {
        let mut dark = scene();
        expect(&dark, "", "no source of light");
        dark.spheres.push(Sphere {
            coefficient: 0.0,
            ..sphere(0.0)
        });
        dark.tori.push(Torus {
            color: DVec3::ZERO,
            ..Torus::new(1.0)
        });
        expect(&dark, "sphere[0]", "gives no light, as all sources do");
        dark.tori[0].color = DVec3::new(-1.0, 0.0, 0.0);
        expect(&dark, "sphere[0]", "takes light away");
        dark.tori[0].color = DVec3::new(-1.0, 0.0, 0.1);
        assert_eq!(dark.warnings(), []);
        let mut curve = scene();
        let points = [DVec3::ZERO, DVec3::X, DVec3::Z];
        curve.curves.push(Curve {
            intensity: Some(vec![0.0; 3]),
            ..Curve::new(points)
        });
        expect(&curve, "curve[0]", "gives no light");
    }
}
