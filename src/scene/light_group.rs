//! Groups of lights: sources whose light is also drawn by itself, for a program that mixes it anew.

use glam::DVec3;

use super::kinds::for_each_kind;
use super::source::HasLight;
use super::values::{Checked, Fault};
use super::{Lighting, List, Scene};
use crate::shown::shown;

/// A longer name, with that of a channel, is more than some programs read.
const LONGEST: usize = 60;

/// Checks the name of a group of lights, which becomes a part of channels' names.
pub(super) fn check_light_group(name: &str) -> Checked {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, ' ' | '_' | '-');
    let is_good = !name.trim().is_empty() && name.len() <= LONGEST && name.chars().all(is_plain);
    if is_good {
        return Ok(());
    }
    let message = format!(
        "`{}`; a name has 1 to {LONGEST} of the letters a to z, digits, spaces, - and _",
        shown(name)
    );
    Err(Fault::new("light_group", message))
}

macro_rules! define_light_groups {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        impl Scene {
            /// Calls `see` with the group of lights of every source.
            fn for_each_light_group<'a>(&'a self, see: &mut dyn FnMut(Option<&'a str>)) {
                $(self.$list.iter().for_each(|source| see(source.shared().light_group));)*
            }

            /// Returns the scene with the sources of one group of lights alone, or with `None` those of no group, seen
            /// along the same rays. Surfaces hide the light of all groups, and shine in that of no group. Light adds:
            /// the images of all groups, and of none, add up to that of the scene.
            #[must_use]
            pub fn of_light_group(&self, group: Option<&str>) -> Self {
                let mut scene = Self::new(self.camera.clone());
                scene.camera.ray_length = Some(self.ray_length());
                (scene.image, scene.decay, scene.absorption) = (self.image, self.decay, self.absorption);
                (scene.integration, scene.display) = (self.integration, self.display.clone());
                scene.depth = self.depth.clone();
                scene.lighting = self.lighting.map(|lighting| match group {
                    Some(_) => Lighting { ambient: DVec3::ZERO, sun: None, ..lighting },
                    None => lighting,
                });
                scene.meshes = self.meshes.clone();
                scene.metaballs = self.metaballs.clone();
                if group.is_some() {
                    scene.metaballs.iter_mut().for_each(|surface| surface.color = DVec3::ZERO);
                    if self.lighting.is_none() {
                        scene.meshes.iter_mut().for_each(|mesh| mesh.albedo = DVec3::ZERO);
                    }
                }
                scene.colliders = self.colliders.clone();
                match group {
                    Some(_) => scene.colliders.iter_mut().for_each(|it| {
                        let is_lit = self.lighting.is_some() && it.is_seen_mesh();
                        it.color *= f64::from(u8::from(is_lit));
                    }),
                    None => {
                        scene.volumes = self.volumes.clone();
                        scene.particles = self.particles.clone();
                        scene.points = self.points.clone();
                        scene.light_elements = self.light_elements.clone();
                        (scene.waves, scene.simulation) = (self.waves.clone(), self.simulation);
                    }
                }
                $(scene.$list = kept(&self.$list, group);)*
                scene
            }
        }
    };
}
for_each_kind!(define_light_groups);

fn kept<T: HasLight + Clone>(list: &List<T>, group: Option<&str>) -> List<T> {
    let is_of_it = |source: &&T| source.shared().light_group == group;
    list.iter().filter(is_of_it).cloned().collect()
}

impl Scene {
    /// Returns the names of its groups of lights, in the order of the alphabet.
    #[must_use]
    pub fn light_groups(&self) -> Vec<&str> {
        let mut names = std::collections::BTreeSet::new();
        self.for_each_light_group(&mut |group| names.extend(group));
        names.into_iter().collect()
    }

    /// Returns whether there is light of no group: of sources, of particles, or of surfaces.
    #[must_use]
    pub fn has_ungrouped_light(&self) -> bool {
        let mut has = !self.metaballs.is_empty() || !self.meshes.is_empty() || self.has_particles();
        has |= !self.volumes.is_empty() || self.has_points();
        has |= self.colliders.iter().any(|collider| collider.visible);
        self.for_each_light_group(&mut |group| has |= group.is_none());
        has
    }
}
