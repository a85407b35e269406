//! The scene: what glows, who looks, and how the light is summed. Plain data, buildable in code, readable from TOML or
//! JSON (`Scene::from_file`), checked once ([`Scene::validate`]).
//!
//! All vectors are world space, right-handed; lengths in world units; angles in degrees; colours linear RGB. Structs
//! may get further fields: write `..Torus::new(0.9)` and the like.

/// Makes a table of keys: `name: form, unit, what holds without it, a line of help;`.
macro_rules! keys {
    ($visibility:vis $TABLE:ident; $($name:ident: $form:expr, $unit:expr, $absent:expr, $help:expr;)*) => {
        #[cfg(feature = "files")]
        $visibility const $TABLE: &[$crate::scene::keys::Key] = {
            #[allow(unused_imports, reason = "not every table needs every word")]
            use $crate::scene::keys::words::*;
            &[$(key(stringify!($name), $form, $unit, $absent, $help)),*]
        };
    };
}

mod camera;
pub(crate) mod chain;
mod colors;
mod crowd_sight;
mod depth_layers;
#[cfg(feature = "files")]
mod depth_report;
mod emitter;
mod exposure;
mod extent;
#[cfg(feature = "files")]
mod file;
mod group;
mod in_view;
mod integration;
#[cfg(feature = "files")]
pub mod keys;
pub(crate) mod kinds;
mod light_element;
mod light_group;
mod lighting;
mod list;
mod lit_points;
mod mesh;
mod metaballs;
mod one_color;
mod particles;
mod points;
#[cfg(feature = "files")]
mod preset;
mod random;
mod ray;
mod reduction;
mod seen;
mod simulation;
mod source;
mod spread;
mod stamp;
mod track;
mod validate;
mod values;
mod volume;
mod warnings;

use glam::DVec3;

pub use camera::{Camera, CameraMatrices, ClipY};
pub(crate) use chain::Piece;
pub use chain::{Dashes, ElectricArc};
pub(crate) use crowd_sight::{CrowdSight, NEAREST};
pub(crate) use depth_layers::DepthLayers;
#[cfg(feature = "files")]
pub use depth_report::DepthReport;
pub(crate) use emitter::{Emitter, EmitterCore};
#[cfg(feature = "files")]
pub use file::{AnimatedScene, MethodKeys, MethodName, Overrides, SceneSpan};
pub use group::{Group, Repeat, Rotation};
pub use integration::{
    Absorption, Antialias, CORE_FLOOR, Decay, Integration, Measure, Method, Reduction, Sampling,
    VolumeMethod,
};
pub use light_element::LightElement;
pub use lighting::{Lighting, Sun};
pub use list::List;
pub use lit_points::{Crowd, Points};
pub(crate) use mesh::{Halves, Triangle};
pub use mesh::{Mesh, TriangleList};
pub(crate) use metaballs::{AMBIENT, LAMP};
pub use metaballs::{MetaballKernel, MetaballMethod, MetaballSampling, MetaballShading, Metaballs};
pub use particles::Particles;
pub(crate) use points::PointRows;
pub use points::{Lattice, PointList, PointSize};
#[cfg(feature = "files")]
pub use preset::Preset;
pub(crate) use ray::point_fault;
pub use ray::{Ray, ViewPlane};
pub(crate) use seen::SeenSurfaces;
pub(crate) use simulation::LAST_FRAME;
pub use simulation::{
    Acceleration, Collider, ColliderShape, ControlPoint, EmittedWave, Mixture, ParticleShape,
    Response, Signs, SimulationSettings, Varied, Varying,
};
pub use source::*;
pub(crate) use spread::Spreading;
pub(crate) use stamp::SourcesStamp;
pub use track::{Interpolation, Track, TrackLoop, TrackNoise, TrackValue};
pub(crate) use validate::CheckedSources;
pub use volume::{Volume, VolumeInterpolation, VolumeShape};

use crate::image::{DepthImage, Display, ImageSize};
use kinds::for_each_kind;

macro_rules! define_scene {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// A complete scene: camera, image size, the way of integrating, what hides the light, and the sources of
        /// light.
        #[derive(Debug, Clone, PartialEq)]
        pub struct Scene {
            /// Who looks, and along which rays.
            pub camera: Camera,
            /// Size of the image.
            pub image: ImageSize,
            /// How light fades along a ray; `None`: it does not (zeta = 1).
            pub decay: Option<Decay>,
            /// What space absorbs along a ray; `None`: nothing.
            pub absorption: Option<Absorption>,
            /// How the integral along a ray is computed.
            pub integration: Integration,
            /// How radiance becomes an 8-bit picture.
            pub display: Display,
            /// How far each pixel's ray sees; `None`: nothing hides the light. Of the size of the image, or 2 to 8
            /// times as many depths across and down: pixels at the edges of things are then the mean of the light
            /// before each surface.
            pub depth: Option<DepthImage>,
            /// How surfaces are lit; `None`: meshes by a lamp beside the eye, the waves cast no light.
            pub lighting: Option<Lighting>,
            /// How waves of particles are simulated; `None`: by the defaults.
            pub simulation: Option<SimulationSettings>,
            /// Waves of particles, which [`crate::particle::Simulation`] moves; their light is drawn.
            pub waves: List<EmittedWave>,
            /// What they hit.
            pub colliders: List<Collider>,
            /// Triangles, which hide the light behind them too.
            pub meshes: List<Mesh>,
            /// Surfaces, which hide the light behind them too.
            pub metaballs: List<Metaballs>,
            /// Particles that shine.
            pub particles: List<Particles>,
            /// Points of light in any number.
            pub points: List<Points>,
            /// Light that cells give off.
            pub volumes: List<Volume>,
            /// Balls and streaks of light, given one by one; files have none. They do not lengthen the rays.
            pub light_elements: List<LightElement>,
            $($(#[$doc])* pub $list: List<$Type>,)*
        }

        impl Scene {
            /// Makes a scene without sources, which is black: 512x512 pixels, no decay, everything else at its default.
            #[must_use]
            pub fn new(camera: Camera) -> Self {
                Self {
                    camera,
                    image: ImageSize::default(),
                    decay: None,
                    absorption: None,
                    integration: Integration::default(),
                    display: Display::default(),
                    depth: None,
                    lighting: None,
                    simulation: None,
                    waves: List::new(),
                    colliders: List::new(),
                    meshes: List::new(),
                    metaballs: List::new(),
                    particles: List::new(),
                    points: List::new(),
                    volumes: List::new(),
                    light_elements: List::new(),
                    $($list: List::new(),)*
                }
            }

            /// Returns the number of sources of all kinds.
            #[must_use]
            pub fn source_count(&self) -> usize {
                0 $(+ self.$list.len())*
            }

            /// Returns the number of their lights: a source has one, or one a layer.
            pub(crate) fn light_count(&self) -> usize {
                0 $(+ self.$list.iter().map(|source| source.shared().light_count()).sum::<usize>())*
            }

            /// Calls `add` with the emission of all parts of all sources.
            pub(crate) fn for_each_emission(&self, add: &mut dyn FnMut(DVec3)) {
                $(self.$list.iter().for_each(|source| source.for_each_emission(add));)*
            }

            /// Returns whether any light falls off in such a way.
            pub(crate) fn any_falloff(&self, is_such: impl Fn(Falloff) -> bool) -> bool {
                $(self.$list.iter().any(|source| source.lights().any(|light| is_such(light.falloff))))||*
            }
        }
    };
}
for_each_kind!(define_scene);

/// How light fades along a ray in another way than by the decay of 2015.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fading {
    /// The power of the decay; 0: there is none.
    pub power: u32,
    /// Absorption, per world unit.
    pub kappa: f64,
}

impl Scene {
    /// Returns the projection plane, from which every pixel has its ray.
    #[must_use]
    pub fn view_plane(&self) -> ViewPlane {
        ViewPlane::new(&self.camera, self.image, self.ray_length())
    }

    /// Returns how light fades where the decay of 2015, or none, does not tell it all.
    pub(crate) fn fading(&self) -> Option<Fading> {
        let fading = Fading {
            power: self.decay.map_or(0, |decay| decay.power),
            kappa: self.absorption.map_or(0.0, |absorption| absorption.kappa),
        };
        let is_plain = matches!(fading.power, 0 | 2) && fading.kappa == 0.0;
        (!is_plain).then_some(fading)
    }

    /// Returns where a device takes this scene's integrals, see [`Sampling`].
    #[must_use]
    pub fn sampling(&self) -> Sampling {
        match self.integration.method.sampling() {
            Sampling::Tiles if self.has_light_of_both_signs() => Sampling::Pixels,
            sampling => sampling,
        }
    }

    /// Returns whether sources of opposite signs may cancel.
    pub(crate) fn has_light_of_both_signs(&self) -> bool {
        self.signs_of_light() == (true, true)
    }

    /// Returns whether there are sources of negative light, and of positive light.
    pub(crate) fn signs_of_light(&self) -> (bool, bool) {
        let (mut low, mut high) = (DVec3::ZERO, DVec3::ZERO);
        self.for_each_emission(&mut |light| (low, high) = (low.min(light), high.max(light)));
        (low.cmplt(DVec3::ZERO).any(), high.cmpgt(DVec3::ZERO).any())
    }
}
