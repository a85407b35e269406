//! Sources whose cores are known: where a point of them is, which way they run there, and planes that they lie in.

use energywave::Scene;
use energywave::scene::{Beam, BeamEnd, Curve, Cylinder, Profile, Segment, Sphere, Torus};
use glam::DVec3;

use super::dice::Dice;

/// The kinds of source; curves with a local intensity are one of their own, and all kinds together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Sphere,
    Cylinder,
    Beam,
    Torus,
    Curve,
    Weighted,
    Segment,
    All,
}

/// A point of a source's core, and what lies there.
#[derive(Debug, Clone, Copy)]
pub struct Core {
    /// A point of the core.
    pub point: DVec3,
    /// Which way the core runs there, a unit vector.
    pub tangent: DVec3,
    /// The normal of a plane through the point that means something to the source: a ring's, a curve's, a beam's tip's.
    pub level: DVec3,
    /// The middle of the source.
    pub middle: DVec3,
    /// How large the source is, world units.
    pub size: f64,
}

/// Shapes of curves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    Bent,
    Symmetric,
    Straight,
    Uneven,
    Folded,
    Closed,
    NearlyStraight,
    NearlyFolded,
    Cusp,
    Point,
}

/// All shapes of curves but the usual one.
pub const ODD_SHAPES: [Shape; 9] = [
    Shape::Symmetric,
    Shape::Straight,
    Shape::Uneven,
    Shape::Folded,
    Shape::Closed,
    Shape::NearlyStraight,
    Shape::NearlyFolded,
    Shape::Cusp,
    Shape::Point,
];

/// Local intensities of curves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weights {
    Even,
    Any,
    DarkEnd,
    DarkMiddle,
    Stripes,
    Decades,
    Zero,
    Signs,
}

/// What a source is made of, beyond its kind.
#[derive(Debug, Clone, Copy)]
pub struct Recipe {
    pub size: f64,
    pub coefficient: f64,
    pub profile: Profile,
    pub shape: Shape,
    pub weights: Weights,
    /// Where the source is.
    pub place: DVec3,
}

impl Recipe {
    /// Makes the recipe of a usual source.
    pub fn of(dice: &mut Dice, kind: Kind) -> Self {
        let weights = [Weights::Any, Weights::DarkEnd, Weights::DarkMiddle];
        Self {
            size: dice.spread(0.3, 2.0),
            coefficient: 1.0,
            profile: dice.of(&[Profile::Inverse, Profile::InverseSquare]),
            shape: dice.of(&[Shape::Bent, Shape::Bent, Shape::Symmetric]),
            weights: match kind {
                Kind::Weighted | Kind::All => dice.of(&weights),
                _ => Weights::Even,
            },
            place: dice.point(0.5),
        }
    }
}

/// Adds a source to a scene and returns its core; for all kinds together the core of one of them.
pub fn add(dice: &mut Dice, kind: Kind, recipe: Recipe, scene: &mut Scene) -> Core {
    let Recipe {
        size,
        coefficient,
        profile,
        place,
        ..
    } = recipe;
    let direction = dice.direction();
    let line = |dice: &mut Dice, point: DVec3| Core {
        point,
        tangent: direction,
        level: direction,
        middle: point + direction * dice.slight(),
        size,
    };
    match kind {
        Kind::Sphere => {
            scene.spheres.push(Sphere {
                center: place,
                coefficient,
                profile,
                ..Sphere::default()
            });
            line(dice, place)
        }
        Kind::Cylinder => {
            scene.cylinders.push(Cylinder {
                point: place,
                coefficient,
                profile,
                ..Cylinder::new(direction)
            });
            line(dice, place)
        }
        Kind::Beam => {
            let end = match dice.below(4) {
                0 => BeamEnd::Cap(None),
                1 => BeamEnd::Cap(Some(dice.of(&[0.0, 0.3, 2.0]))),
                _ => BeamEnd::Taper(size * dice.spread(1e-2, 4.0)),
            };
            let mut beam = Beam {
                tip: place,
                coefficient,
                profile,
                end,
                ..Beam::new(direction)
            };
            beam.sphere_coefficient = dice.of(&[0.0, 0.0, 0.3]);
            let behind = match end {
                BeamEnd::Taper(length) => length,
                BeamEnd::Cap(_) => 0.0,
            };
            scene.beams.push(beam);
            let at = dice.of(&[0.0, 0.0, 0.5 * size, -behind]);
            line(dice, place + direction * at)
        }
        Kind::Segment => {
            let to = place + direction * size;
            scene.segments.push(Segment {
                coefficient,
                profile,
                ..Segment::new(place, to)
            });
            let at = dice.of(&[0.0, 0.5, 1.0]);
            line(dice, place + (to - place) * at)
        }
        Kind::Torus => {
            scene.tori.push(Torus {
                center: place,
                axis: direction,
                coefficient,
                profile,
                ..Torus::new(size)
            });
            let outward = dice.beside(direction);
            Core {
                point: place + outward * size,
                tangent: direction.cross(outward),
                level: direction,
                middle: place,
                size,
            }
        }
        Kind::Curve | Kind::Weighted => add_curve(dice, recipe, scene),
        Kind::All => {
            let kinds = [
                Kind::Sphere,
                Kind::Cylinder,
                Kind::Beam,
                Kind::Torus,
                Kind::Weighted,
                Kind::Segment,
            ];
            let chosen = dice.below(kinds.len());
            let mut core = None;
            for (index, kind) in kinds.into_iter().enumerate() {
                let mut recipe = recipe;
                if index != chosen {
                    recipe.place += dice.point(1.5);
                }
                // Mixed scenes share one program: all have a square.
                if kind == Kind::Sphere {
                    recipe.profile = Profile::InverseSquare;
                }
                let found = add(dice, kind, recipe, scene);
                if index == chosen {
                    core = Some(found);
                }
            }
            core.unwrap_or_else(|| line(dice, place))
        }
    }
}

fn add_curve(dice: &mut Dice, recipe: Recipe, scene: &mut Scene) -> Core {
    let size = recipe.size;
    let across = dice.direction();
    let along = dice.beside(across);
    let slight = size * dice.spread(1e-7, 1e-2);
    let beyond = dice.of(&[-0.5, 1.2, 1.5, 3.0]);
    let lift = dice.of(&[0.3, 1.0, 2.0]);
    // Two coordinates of each control point, in units of the size.
    let flat: [[f64; 2]; 3] = match recipe.shape {
        Shape::Bent => {
            let mut number = || 2.0 * dice.share() - 1.0;
            [
                [-1.0, number()],
                [number(), 1.0 + number()],
                [1.0, number()],
            ]
        }
        Shape::Symmetric => [[-1.0, 0.0], [0.0, lift], [1.0, 0.0]],
        Shape::Straight => [[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]],
        Shape::Uneven => [[-1.0, 0.0], [dice.of(&[-1.0, 0.25, 0.7]), 0.0], [1.0, 0.0]],
        Shape::Folded => [[-1.0, 0.0], [2.0 * beyond - 1.0, 0.0], [1.0, 0.0]],
        Shape::Closed => [[0.0, 0.0], [0.0, lift], [0.0, 0.0]],
        Shape::NearlyStraight => [[-1.0, 0.0], [0.1, slight / size], [1.0, 0.0]],
        Shape::NearlyFolded => [[-1.0, 0.0], [2.0 * beyond - 1.0, slight / size], [1.0, 0.0]],
        Shape::Cusp => [[-slight / size, 0.0], [0.0, lift], [slight / size, 0.0]],
        Shape::Point => [[0.0, 0.0]; 3],
    };
    let place = recipe.place;
    let points = flat.map(|[x, y]| place + size * (along * x + across * y));
    let intensity = weights(dice, recipe.weights);
    scene.curves.push(Curve {
        coefficient: recipe.coefficient,
        profile: recipe.profile,
        intensity,
        ..Curve::new(points)
    });
    let t = dice.of(&[0.0, 0.25, 0.5, 0.5, 1.0]);
    let [a, b, c] = points;
    let tangent = (b - a).lerp(c - b, t).try_normalize().unwrap_or(along);
    let normal = along.cross(across);
    Core {
        point: a.lerp(b, t).lerp(b.lerp(c, t), t),
        tangent,
        level: dice.of(&[normal, normal, tangent]),
        middle: place,
        size,
    }
}

fn weights(dice: &mut Dice, weights: Weights) -> Option<Vec<f64>> {
    let count = dice.of(&[3, 4, 5, 8]);
    let mut list = |value: &mut dyn FnMut(&mut Dice, usize) -> f64| {
        Some((0..count).map(|k| value(dice, k)).collect())
    };
    match weights {
        Weights::Even => None,
        Weights::Any => list(&mut |dice, _| dice.share()),
        Weights::DarkEnd => {
            let mut series = vec![0.0; count];
            let lit = dice.of(&[1, 1, 2]);
            for k in 0..lit {
                series[count - 1 - k] = dice.spread(0.1, 2.0);
            }
            if dice.one_in(2) {
                series.reverse();
            }
            Some(series)
        }
        Weights::DarkMiddle => {
            let mut series = vec![0.0; count + 2];
            series[0] = dice.spread(0.01, 2.0);
            series[count + 1] = dice.spread(0.01, 2.0);
            Some(series)
        }
        Weights::Stripes => {
            let stripes = dice.of(&[5, 10, 20, 40]);
            Some((0..stripes).map(|k| f64::from(k % 2)).collect())
        }
        Weights::Decades => list(&mut |dice, _| dice.spread(1e-6, 1.0)),
        Weights::Zero => Some(vec![0.0; count]),
        Weights::Signs => list(&mut |dice, k| (dice.share() + 0.2) * [1.0, -1.0][k % 2]),
    }
}
