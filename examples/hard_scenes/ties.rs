//! Curves with weights as rounding may see them: where several points of a curve are as near as float32 can tell, any
//! of their weights is right.

use energywave::Scene;
use energywave::internals::{CurveField, Field, Sample, Source, b_spline, sources};
use energywave::scene::{Curve, Ray};
use glam::DVec3;

/// The digits of coordinates, of the distance from the eye or of the source's size.
const OF_FLOAT32: f64 = 1e-7;

/// A curve that shines everywhere with the least, or the greatest, of the weights that rounding may see.
#[derive(Debug)]
struct Tied {
    curve: CurveField,
    weights: Vec<f64>,
    eye: DVec3,
    size: f64,
    is_most: bool,
}

impl Tied {
    fn new(curve: &Curve, eye: DVec3, is_most: bool) -> Option<Self> {
        let [first, middle, last] = curve.control_points;
        Some(Self {
            curve: CurveField::new(curve),
            weights: curve.intensity.clone()?,
            eye,
            size: first.distance(middle).max(middle.distance(last)),
            is_most,
        })
    }
}

impl Field for Tied {
    fn sample(&self, point: DVec3) -> Sample {
        let reach = OF_FLOAT32 * point.distance(self.eye).max(self.size);
        let distance2 = self.curve.nearest(point).1;
        let within2 = (distance2.sqrt() + 3.0 * reach).powi(2);
        let mut intensity = None;
        let steps = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        for step in steps.into_iter().flat_map(|step| [step, -step]) {
            let beside = point + reach * step;
            self.curve.for_each_stationary(beside, &mut |t, distance2| {
                if distance2 <= within2 {
                    let weight = b_spline(&self.weights, t);
                    let known: f64 = intensity.unwrap_or(weight);
                    let chosen = if self.is_most {
                        known.max(weight)
                    } else {
                        known.min(weight)
                    };
                    intensity = Some(chosen);
                }
            });
        }
        Sample {
            distance2,
            intensity: intensity.unwrap_or_default(),
        }
    }

    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        self.curve.breaks(ray, breaks);
    }
}

/// Returns the sources of a scene that has weighted curves, these as dark or as bright as rounding may see them; `None`
/// if it has none.
pub fn tied_sources(scene: &Scene, is_most: bool) -> Option<Vec<Source>> {
    let mut others = scene.clone();
    others.curves.retain(|curve| curve.intensity.is_none());
    if others.curves.len() == scene.curves.len() {
        return None;
    }
    let mut all = sources(&others);
    for curve in &scene.curves {
        let alone = Scene {
            curves: vec![curve.clone()].into(),
            ..Scene::new(scene.camera.clone())
        };
        for mut source in sources(&alone) {
            let is_bright = is_most == (source.emission.x > 0.0);
            if let Some(tied) = Tied::new(curve, scene.camera.eye, is_bright) {
                source.field = Box::new(tied);
                all.push(source);
            }
        }
    }
    Some(all)
}
