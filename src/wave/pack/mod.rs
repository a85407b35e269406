//! A scene as the kernels read it: float32, seen from the eye, where float32 resolves best.
//!
//! Light near a core depends on small differences of large coordinates: what float32 leaves of a number travels in a
//! field named `rest` (`cl/fine.h`).

mod ball;
pub mod layout;
mod view;

use glam::DVec3;

pub(super) use view::view_behind;
pub use view::{integrand, ray, view};

use crate::opencl::device_struct;
use crate::scene::kinds::{KIND_COUNT, for_each_kind};
use crate::scene::{
    self, Falloff, HasLight, Light, Profile, Reduction, Scene, SourceKind, SourcesStamp,
};

/// Where the float32 coordinates begin, how far the rays go from there, and what every emission is multiplied with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// World space.
    pub origin: DVec3,
    /// World units.
    pub reach: f64,
    /// `|E - S|` where light is measured by length, else 1; times a decay that is the same everywhere.
    pub measure: f64,
    /// How large a pixel is.
    pub pixel: Pixel,
    /// Relative error aimed at.
    pub tolerance: f64,
    /// What a pixel has of integrals.
    pub reduction: Reduction,
}

/// How large a pixel is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pixel {
    /// There are none.
    None,
    /// So large a share of the distance from the origin.
    OfDistance(f64),
    /// Of this size everywhere, world units: rays are parallel.
    Even(f64),
}

impl Pixel {
    fn of(scene: &Scene) -> Self {
        match scene.camera.pixel_at_1(scene.image) {
            (side, true) => Self::Even(side),
            (side, false) => Self::OfDistance(side),
        }
    }

    /// Returns the size at a distance from the origin, world units; `None` where there are none.
    fn at(self, distance: f64) -> Option<f64> {
        match self {
            Self::None => None,
            Self::OfDistance(share) => Some(share * distance),
            Self::Even(size) => Some(size),
        }
    }
}

impl Anchor {
    /// Makes the anchor at `origin`, for rays that stay within `reach` of it and are `ray_length` long.
    pub fn new(scene: &Scene, origin: DVec3, reach: f64, ray_length: f64) -> Self {
        Self {
            origin,
            reach,
            measure: scene.integration.scale(ray_length) * even_decay(scene),
            pixel: Pixel::of(scene),
            tolerance: scene.integration.method.tolerance(),
            reduction: scene.integration.reduction,
        }
    }

    fn position(&self, point: DVec3) -> Fine {
        fine(point - self.origin)
    }

    /// Returns a light as it is packed: where a root is taken, its coefficient stays outside in the colour, and a field
    /// whose square has a closed form is that square.
    fn reduced(&self, light: Light) -> Light {
        let mut falloff = light.falloff;
        if self.reduction == Reduction::Sum {
            return light;
        }
        if has_closed_square(falloff) {
            falloff.profile = Profile::InverseSquare;
        }
        Light {
            coefficient: 1.0,
            color: light.emission(),
            falloff,
        }
    }

    fn emission(&self, coefficient: f64, color: DVec3) -> [f32; 4] {
        vector(color * (coefficient * self.measure))
    }
}

/// Returns what a light has of the decay where that is the same everywhere, else 1.
pub fn even_decay(scene: &Scene) -> f64 {
    let even = scene.decay.filter(|decay| decay.power == 0);
    let decay = even.map_or(1.0, |decay| decay.alpha);
    scene.integration.reduction.of(decay)
}

/// Four numbers of a list to which sources refer.
pub type Row = [f32; 4];

/// What sources have more than their struct holds: pieces of series, corners of paths.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rows {
    /// Of all sources.
    pub list: Vec<Row>,
    /// Whether there are series among them.
    pub has_series: bool,
    /// Where the balls around every kind's sources begin; `None`: no light ends, and there are none.
    pub first_balls: Option<[u32; KIND_COUNT]>,
}

/// What the packing asks of every kind of source.
trait Pack {
    /// The kind's struct on the device.
    type Device;

    /// Packs the source with one of its lights; what its struct does not hold goes to `rows`.
    fn pack(&self, light: &Light, anchor: &Anchor, rows: &mut Rows) -> Self::Device;
}

/// The same for all lights of a source.
trait PackInto<Device> {
    /// Packs the source with all of its lights; nothing of a kind that is always drawn as a chain.
    fn pack_into(&self, _: &mut Vec<Device>, _: &Anchor, _: &mut Rows) {}
}

impl<Source: Pack + HasLight> PackInto<Source::Device> for Source {
    fn pack_into(&self, list: &mut Vec<Source::Device>, anchor: &Anchor, rows: &mut Rows) {
        let lights = self.lights().map(|light| anchor.reduced(light));
        list.extend(lights.map(|light| self.pack(&light, anchor, rows)));
    }
}

macro_rules! define_sources {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        $(pub mod $kind;)*

        /// A scene's sources as the kernels read them: one entry a light.
        #[derive(Debug, Clone, Default, PartialEq)]
        pub struct Sources {
            $($(#[$doc])* pub $list: Vec<$kind::$Type>,)*
            /// What they refer to.
            pub rows: Rows,
        }

        impl Sources {
            /// Packs all sources of a valid scene.
            pub fn new(scene: &Scene, anchor: &Anchor) -> Self {
                let mut packed = Self::default();
                packed.fill(scene, anchor);
                packed
            }

            /// Packs all sources of a valid scene in the place of those that were there.
            pub fn fill(&mut self, scene: &Scene, anchor: &Anchor) {
                let rows = &mut self.rows;
                rows.list.clear();
                rows.has_series = false;
                rows.first_balls = None;
                $(self.$list.clear();)*
                let has_ends = scene.any_falloff(|it| it.ends());
                let mut balls: [Vec<Row>; KIND_COUNT] = Default::default();
                $(for source in &scene.$list {
                    match source.as_chains() {
                        Some(chains) => {
                            for lit in &chains {
                                path::pack_chain(lit, &mut self.paths, anchor, &mut self.rows);
                                if has_ends {
                                    self.add_balls(Some(lit.chain.ball()), anchor, &mut balls);
                                }
                            }
                        }
                        None => {
                            source.pack_into(&mut self.$list, anchor, &mut self.rows);
                            if has_ends {
                                self.add_balls(source.core().ball(), anchor, &mut balls);
                            }
                        }
                    }
                })*
                if has_ends {
                    let first = self.rows.list.len();
                    self.rows.first_balls = Some(ball::first_balls(first, self.counts()));
                    self.rows.list.extend(balls.iter().flatten());
                }
            }

            /// Adds a ball for every entry that has none yet, around a core that lies in a ball.
            fn add_balls(
                &self,
                core: Option<(DVec3, f64)>,
                anchor: &Anchor,
                balls: &mut [Vec<Row>; KIND_COUNT],
            ) {
                let mut of_kinds = balls.iter_mut();
                $(if let Some(balls) = of_kinds.next() {
                    let new = self.$list[balls.len()..].iter();
                    balls.extend(new.map(|it| ball::ball(core, &it.falloff, anchor)));
                })*
            }

            /// Returns how many there are of each kind, in the order of the table.
            pub fn counts(&self) -> [u64; KIND_COUNT] {
                [$(self.$list.len() as u64),*]
            }
        }
    };
}
for_each_kind!(define_sources);

/// Sources that are packed again only if they changed, or are seen from elsewhere.
#[derive(Debug, Default)]
pub struct PackedSources {
    /// What was packed.
    pub sources: Sources,
    stamp: Option<PackStamp>,
    facts: SourceFacts,
}

/// Equal only where the packed sources are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PackStamp(SourcesStamp, Anchor);

impl PackedSources {
    /// Packs the sources of a valid scene.
    pub fn pack(&mut self, scene: &Scene, anchor: Anchor) -> PackStamp {
        let stamp = PackStamp(scene.sources_stamp(), anchor);
        if self.stamp != Some(stamp) {
            self.stamp = None;
            self.sources.fill(scene, &anchor);
            self.stamp = Some(stamp);
        }
        stamp
    }

    /// Returns the facts that the kernels depend on.
    pub fn facts(&mut self, scene: &Scene) -> &SourceFacts {
        self.facts.update(scene);
        &self.facts
    }
}

/// What only a look at every source can tell; they are looked at again only if they changed.
#[derive(Debug, Clone, Default)]
pub struct SourceFacts {
    stamp: Option<SourcesStamp>,
    /// Whether any falls off with the squared distance.
    pub has_squares: bool,
    /// Whether any has no closed form for how it falls off.
    pub has_shapes: bool,
    /// Whether any adds up the light of all points of its core.
    pub has_convolutions: bool,
    /// Whether any has a sharper peak than 1 over the distance.
    pub has_sharp_peaks: bool,
    /// Whether any takes light away.
    pub has_negative_light: bool,
    /// Whether some may cancel others.
    pub has_both_signs: bool,
    /// Whether the square of every field has a closed form.
    pub has_closed_squares: bool,
}

/// Returns whether the square of a field has a closed form.
fn has_closed_square(falloff: Falloff) -> bool {
    falloff.profile == Profile::Inverse && falloff.reach.is_none()
}

impl SourceFacts {
    /// Looks at the scene's sources if they changed.
    pub fn update(&mut self, scene: &Scene) {
        let stamp = Some(scene.sources_stamp());
        if self.stamp != stamp {
            let (has_negative, has_positive) = scene.signs_of_light();
            *self = Self {
                stamp,
                has_squares: scene.any_falloff(|it| it.profile == Profile::InverseSquare),
                has_shapes: scene.any_falloff(|it| it.is_shaped()),
                has_convolutions: scene.any_falloff(|it| it.profile == Profile::Convolution),
                has_sharp_peaks: scene.any_falloff(|it| it.is_sharp()),
                has_negative_light: has_negative,
                has_both_signs: has_negative && has_positive,
                has_closed_squares: !scene.any_falloff(|it| !has_closed_square(it)),
            };
        }
    }
}

/// Returns a line's point nearest to the eye, and its direction.
fn line(anchor: &Anchor, point: DVec3, direction: DVec3) -> (Fine, Fine) {
    let direction = direction.normalize();
    let to_eye = anchor.origin - point;
    let nearest_to_eye = point + direction * to_eye.dot(direction);
    (anchor.position(nearest_to_eye), fine(direction))
}

/// Packs how a field falls off.
fn falloff(falloff: Falloff) -> layout::Falloff {
    let Falloff {
        profile,
        radius,
        reach,
    } = falloff;
    let reach2 = reach.map_or(0.0, |reach| reach * reach);
    layout::Falloff {
        // As cl/wave/source/profile.h numbers them.
        profile: match profile {
            Profile::Inverse => 0,
            Profile::InverseSquare => 1,
            Profile::InverseCube => 2,
            Profile::Gaussian => 3,
            Profile::Smeared => 4,
            Profile::Convolution => 5,
        },
        radius2: (radius * radius) as f32,
        reach2: reach2 as f32,
        reach2_rest: rest(reach2),
    }
}

/// A vector as two of float32.
#[derive(Debug, Clone, Copy)]
struct Fine {
    value: [f32; 4],
    rest: [f32; 4],
}

fn fine(v: DVec3) -> Fine {
    let value = v.as_vec3();
    Fine {
        value: vector(v),
        rest: vector(v - value.as_dvec3()),
    }
}

/// Returns what float32 leaves of a number.
fn rest(value: f64) -> f32 {
    (value - f64::from(value as f32)) as f32
}

fn vector(v: DVec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}
