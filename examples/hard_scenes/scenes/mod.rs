//! Hard scenes, the same for the same seed and number: families of scenes that are meant to break the promise that a
//! tolerance is met.

mod dice;
mod source;
mod view;

use energywave::Scene;
use energywave::scene::{BeamEnd, Decay, Segment};
use glam::DVec3;

use dice::Dice;
use source::{Core, ODD_SHAPES, Recipe, Weights, add};
use view::{VIEWS, View, cut, empty, hide, look, odd};

pub use source::Kind;

/// A scene that is meant to be hard.
#[derive(Debug, Clone)]
pub struct HardScene {
    /// Its family.
    pub family: &'static str,
    /// Its kind of source.
    pub kind: Kind,
    /// The scene, by the method `exact`.
    pub scene: Scene,
    /// Distance from the eye to the core, or the size of the source where that is larger, world units: coordinates are
    /// good to float32's rounding of this.
    pub scale: f64,
    /// Whether the source is larger than float32 resolves as finely as the view.
    is_large: bool,
    /// Whether planes of the source are such as float64 meets exactly.
    pub is_exact: bool,
}

impl HardScene {
    /// Returns whether float64 alone decides what rays see: no weighted curve has a sheet across which its light jumps,
    /// and no source is so large that distances have too few digits.
    pub fn is_sharp(&self) -> bool {
        let mut curves = self.scene.curves.iter();
        !self.is_large && curves.all(|curve| curve.intensity.is_none())
    }
}

type Make = fn(&mut Dice, Kind) -> (Scene, Core);

struct Family {
    name: &'static str,
    kinds: &'static [Kind],
    make: Make,
}

const EVERY: &[Kind] = &[
    Kind::Torus,
    Kind::Curve,
    Kind::Weighted,
    Kind::Beam,
    Kind::Segment,
    Kind::Sphere,
    Kind::Cylinder,
    Kind::All,
];
const CURVES: &[Kind] = &[Kind::Curve, Kind::Weighted];
const ADAPTIVE: &[Kind] = &[Kind::Torus, Kind::Curve, Kind::Weighted];

const FAMILIES: [Family; 17] = [
    family("aligned", EVERY, |dice, kind| {
        viewed(dice, kind, View::Along)
    }),
    family("level", EVERY, |dice, kind| viewed(dice, kind, View::Level)),
    family("down", EVERY, |dice, kind| viewed(dice, kind, View::Down)),
    family("inside", EVERY, |dice, kind| {
        viewed(dice, kind, View::Inside)
    }),
    family("free", CURVES, |dice, kind| viewed(dice, kind, View::Free)),
    family("through", EVERY, through),
    family("cut", EVERY, cut_at_a_core),
    family("extreme decay", ADAPTIVE, extreme_decay),
    family("extreme rays", EVERY, extreme_rays),
    family("extreme sizes", EVERY, extreme_sizes),
    family("odd curves", CURVES, odd_curves),
    family("dark weights", &[Kind::Weighted], dark_weights),
    family("small weighted curves", &[Kind::Weighted], small_curves),
    family("zeros", EVERY, zeros),
    family("opposite signs", EVERY, opposite_signs),
    family("softened", EVERY, softened),
    family(
        "depths",
        &[Kind::Torus, Kind::Weighted, Kind::Beam, Kind::All],
        with_depths,
    ),
];

const fn family(name: &'static str, kinds: &'static [Kind], make: Make) -> Family {
    Family { name, kinds, make }
}

/// Returns the names of all families.
pub fn families() -> Vec<&'static str> {
    FAMILIES.iter().map(|family| family.name).collect()
}

/// Makes the scene of a number. Families and kinds take turns.
pub fn hard_scene(seed: u64, number: u64) -> HardScene {
    let family = &FAMILIES[number as usize % FAMILIES.len()];
    let turn = number as usize / FAMILIES.len();
    let kind = family.kinds[turn % family.kinds.len()];
    let mut dice = Dice::new(seed, number);
    loop {
        let (scene, core) = (family.make)(&mut dice, kind);
        // What is too bright for float32, or has no direction, is refused.
        if scene.validate().is_ok() {
            let distance = core.point.distance(scene.camera.eye);
            let is_axis = core
                .level
                .to_array()
                .into_iter()
                .filter(|x| *x != 0.0)
                .count()
                == 1;
            let mut hard = HardScene {
                family: family.name,
                kind,
                scale: distance.max(core.size),
                is_large: core.size > 300.0 * distance,
                is_exact: is_axis,
                scene,
            };
            hard.is_exact &= hard.is_sharp();
            return hard;
        }
    }
}

/// One source of a kind, seen in a way.
fn viewed(dice: &mut Dice, kind: Kind, view: View) -> (Scene, Core) {
    let recipe = Recipe::of(dice, kind);
    made(dice, kind, recipe, view)
}

fn made(dice: &mut Dice, kind: Kind, recipe: Recipe, view: View) -> (Scene, Core) {
    let mut scene = empty(dice);
    let core = add(dice, kind, recipe, &mut scene);
    look(dice, &mut scene, &core, view);
    if !dice.one_in(4) {
        odd(&mut scene);
    }
    (scene, core)
}

fn anywhere(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let view = dice.of(&VIEWS);
    viewed(dice, kind, view)
}

fn through(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let (mut scene, core) = viewed(dice, kind, View::Through);
    odd(&mut scene);
    (scene, core)
}

fn cut_at_a_core(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let view = dice.of(&[View::Through, View::Along, View::Level]);
    let (mut scene, core) = viewed(dice, kind, view);
    odd(&mut scene);
    cut(dice, &mut scene, &core);
    (scene, core)
}

fn extreme_decay(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let (mut scene, core) = anywhere(dice, kind);
    scene.decay = Some(Decay::new(dice.spread(1e-3, 10.0), dice.spread(1e-6, 1e2)));
    (scene, core)
}

fn extreme_rays(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let (mut scene, core) = anywhere(dice, kind);
    let distance = scene.camera.eye.distance(core.point).max(1e-3);
    scene.camera.near = distance * dice.spread(1e-4, 1.0);
    scene.camera.ray_length = Some(distance * dice.spread(1e-2, 1e3));
    scene.camera.fov_y = dice.of(&[1.5, 5.0, 45.0, 150.0]);
    (scene, core)
}

fn extreme_sizes(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let mut recipe = Recipe::of(dice, kind);
    recipe.size = dice.spread(1e-3, 1e3);
    let view = dice.of(&VIEWS);
    let mut scene = empty(dice);
    let core = add(dice, kind, recipe, &mut scene);
    // The view is as large as the source, or as it would be if that were of the usual size.
    let mut seen = core;
    seen.size = dice.of(&[core.size, 1.0, 0.1 * core.size]);
    look(dice, &mut scene, &seen, view);
    (scene, core)
}

fn odd_curves(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let mut recipe = Recipe::of(dice, kind);
    recipe.shape = dice.of(&ODD_SHAPES);
    let view = dice.of(&VIEWS);
    made(dice, kind, recipe, view)
}

fn dark_weights(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let mut recipe = Recipe::of(dice, kind);
    recipe.weights = dice.of(&[Weights::DarkEnd, Weights::DarkMiddle, Weights::Stripes]);
    let view = dice.of(&[View::Free, View::Free, View::Inside, View::Through]);
    made(dice, kind, recipe, view)
}

fn small_curves(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let mut recipe = Recipe::of(dice, kind);
    recipe.size = dice.spread(1e-3, 1e-1);
    recipe.weights = dice.of(&[Weights::Decades, Weights::DarkEnd, Weights::DarkMiddle]);
    let mut scene = empty(dice);
    let core = add(dice, kind, recipe, &mut scene);
    let seen = Core { size: 1.0, ..core };
    let view = dice.of(&[View::Free, View::Through, View::Level]);
    look(dice, &mut scene, &seen, view);
    (scene, core)
}

/// Weights, caps, coefficients, tapers and lengths that are nothing or next to it.
fn zeros(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let mut recipe = Recipe::of(dice, kind);
    recipe.coefficient = dice.of(&[1.0, 1.0, 1.0, 0.0]);
    if kind == Kind::Weighted {
        recipe.weights = dice.of(&[Weights::Zero, Weights::DarkEnd, Weights::DarkMiddle]);
    }
    let view = dice.of(&VIEWS);
    let (mut scene, core) = made(dice, kind, recipe, view);
    let taper = core.size * dice.spread(1e-9, 1.0);
    let end = dice.of(&[BeamEnd::Cap(Some(0.0)), BeamEnd::Taper(taper.max(1e-9))]);
    for beam in scene.beams.iter_mut() {
        beam.end = end;
        beam.sphere_coefficient = 0.0;
    }
    let length = dice.of(&[0.0, 1e-9, 1e-5, 1.0]);
    for segment in scene.segments.iter_mut() {
        let to = segment.from.lerp(segment.to, length);
        *segment = Segment {
            to,
            ..segment.clone()
        };
    }
    (scene, core)
}

fn opposite_signs(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let mut recipe = Recipe::of(dice, kind);
    if kind == Kind::Weighted && dice.one_in(2) {
        recipe.weights = Weights::Signs;
    }
    let view = dice.of(&[View::Free, View::Level, View::Through, View::Down]);
    let (mut scene, core) = made(dice, kind, recipe, view);
    recipe.coefficient = -dice.of(&[1.0, 1.0, 0.5, 1e-3]);
    recipe.place += dice.of(&[DVec3::ZERO, DVec3::X, DVec3::new(0.3, 0.1, -0.2)]);
    recipe.size *= dice.of(&[0.5, 0.9, 1.0]);
    add(dice, kind, recipe, &mut scene);
    (scene, core)
}

fn softened(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let (mut scene, core) = anywhere(dice, kind);
    scene.integration.softening = core.size * dice.spread(1e-6, 1.0);
    (scene, core)
}

fn with_depths(dice: &mut Dice, kind: Kind) -> (Scene, Core) {
    let (mut scene, core) = anywhere(dice, kind);
    hide(dice, &mut scene, &core);
    (scene, core)
}
