//! Device functions one at a time against float64, on every lane width.

use crate::common;
use crate::common::lane_widths;
use energywave::internals::b_spline;
use energywave::internals::pack::{Anchor, Pixel, Sources};
use energywave::internals::{self, Argument, Compute, DeviceBuffer, KINDS, Program};
use glam::DVec3;

const FUNCTIONS: &str = include_str!("../cl/functions.cl");
const DISTANCE: &str = include_str!("../cl/distance.cl");

/// The functions that are the same for all kinds of source, and the distance to the core of each kind.
fn text() -> String {
    let distance = |kind: &str| {
        let type_name = match kind {
            "path" => "LightPath".to_owned(),
            _ => kind[..1].to_uppercase() + &kind[1..],
        };
        DISTANCE.replace("KIND", kind).replace("TYPE", &type_name)
    };
    let distances: String = KINDS.iter().map(|kind| distance(kind)).collect();
    format!("{FUNCTIONS}\n{distances}")
}

/// Four Newton steps leave a few roundings of float32.
const CUBE_ROOT_ERROR: f64 = 5e-7;

/// The minimax polynomials' own errors, below 1e-7, and the rounding of their terms.
const ELEMENTARY_ERROR: f64 = 2.5e-7;

/// The minimax polynomial's own error, 1.6e-7, and the rounding of its terms.
const THIRD_ERROR: f64 = 4e-7;

/// Relative to the scale of the roots: roundings of p and h, which near a double root move it by their square root.
const ROOT_ERROR: f64 = 2e-6;
const DOUBLE_ROOT_ERROR: f64 = 2e-3;

/// Splines of weights up to 1: a few roundings.
const SPLINE_ERROR: f64 = 4e-7;

pub struct Bench {
    compute: Compute,
    program: Program,
}

impl Bench {
    pub fn new(lanes: u32, extra: &str) -> Self {
        let compute = common::compute();
        let options = common::options(lanes, extra);
        let program =
            internals::build_text(&compute, "functions.cl", &text(), &KINDS, &options).unwrap();
        Self { compute, program }
    }

    fn upload(&self, values: &[f32]) -> DeviceBuffer<f32> {
        let mut buffer = DeviceBuffer::new(&self.compute, "values", values.len()).unwrap();
        buffer.write(&self.compute, values).unwrap();
        buffer
    }

    /// Runs a kernel on lists of 16 n values, by their parameters' names; the `results` are written.
    #[allow(unsafe_code)]
    pub fn run(
        &self,
        kernel: &str,
        inputs: &[(&str, &[f32])],
        count: usize,
        results: &[&str],
    ) -> Vec<Vec<f32>> {
        assert_eq!(count % 16, 0);
        let uploaded: Vec<_> = inputs
            .iter()
            .map(|(_, values)| self.upload(values))
            .collect();
        let outputs: Vec<_> = results
            .iter()
            .map(|_| self.upload(&vec![f32::NAN; count]))
            .collect();
        let names = inputs.iter().map(|(name, _)| name).chain(results);
        let arguments: Vec<(&str, &dyn Argument)> = names
            .zip(uploaded.iter().chain(&outputs))
            .map(|(name, buffer)| (*name, buffer as &dyn Argument))
            .collect();
        let items = count / self.program.lanes as usize;
        // SAFETY: each work-item takes and gives LANES values of lists of `count`.
        unsafe { internals::run(&self.compute, &self.program, kernel, &arguments, items, 1) }
            .unwrap();
        let read = |buffer: &DeviceBuffer<f32>| {
            let mut values = vec![0.0; count];
            buffer.read(&self.compute, &mut values).unwrap();
            values
        };
        outputs.iter().map(read).collect()
    }
}

/// Where the sources of these tests are seen from.
pub const ANCHOR: Anchor = Anchor {
    origin: DVec3::ZERO,
    reach: 20.0,
    measure: 1.0,
    pixel: Pixel::None,
    tolerance: 1e-3,
    reduction: energywave::scene::Reduction::Sum,
};

/// Worst relative error of the inverse cube root over 60 powers of ten.
fn cube_root_error(bench: &Bench) -> f64 {
    let values: Vec<f32> = (0..960)
        .map(|i| 10_f32.powf(i as f32 / 16.0 - 30.0))
        .collect();
    let found = &bench.run("cube_root", &[("a", &values)], values.len(), &["result"])[0];
    let error = |(a, y): (&f32, &f32)| (f64::from(*y) * f64::from(*a).cbrt() - 1.0).abs();
    values.iter().zip(found).map(error).fold(0.0, f64::max)
}

#[test]
fn the_inverse_cube_root_is_within_a_few_roundings() {
    for lanes in lane_widths() {
        let error = cube_root_error(&Bench::new(lanes, ""));
        assert!(error < CUBE_ROOT_ERROR, "{lanes} lanes: {error:e}");
    }
    let spoiled = cube_root_error(&Bench::new(8, "-DCUBE_ROOT_STEPS=2"));
    assert!(
        spoiled > CUBE_ROOT_ERROR,
        "the spoiled build passed: {spoiled:e}"
    );
}

#[test]
fn powers_of_two_and_logarithms_are_within_a_few_roundings() {
    let powers: Vec<f32> = (0..1600).map(|i| i as f32 * 0.15 - 119.9).collect();
    let values: Vec<f32> = powers.iter().map(|x| x.exp2()).collect();
    for lanes in lane_widths() {
        let bench = Bench::new(lanes, "");
        let found = &bench.run("powers", &[("x", &powers)], powers.len(), &["result"])[0];
        for (x, value) in powers.iter().zip(found) {
            let error = (f64::from(*value) / f64::from(*x).exp2() - 1.0).abs();
            assert!(error < ELEMENTARY_ERROR, "{lanes} lanes, 2^{x}: {error:e}");
        }
        let found = &bench.run("logarithms", &[("x", &values)], values.len(), &["result"])[0];
        for (x, value) in values.iter().zip(found) {
            let expected = f64::from(*x).log2();
            let error = (f64::from(*value) - expected).abs() / expected.abs().max(1.0);
            assert!(
                error < ELEMENTARY_ERROR,
                "{lanes} lanes, log {x:e}: {error:e}"
            );
        }
    }
}

#[test]
fn the_arctangent_is_within_a_few_roundings() {
    let values: Vec<f32> = (0..1600).map(|i| i as f32 / 1599.0).collect();
    for lanes in lane_widths() {
        let bench = Bench::new(lanes, "");
        let found = &bench.run("arctangents", &[("x", &values)], values.len(), &["result"])[0];
        for (x, value) in values.iter().zip(found) {
            let error = (f64::from(*value) - f64::from(*x).atan()).abs();
            assert!(error < ELEMENTARY_ERROR, "{lanes} lanes, {x}: {error:e}");
        }
    }
}

#[test]
fn the_cosine_of_a_third_of_the_angle_is_within_its_polynomials_error() {
    let values: Vec<f32> = (0..1600)
        .map(|i| (i as f32 / 799.5 - 1.0).clamp(-1.0, 1.0))
        .collect();
    for lanes in lane_widths() {
        let found =
            &Bench::new(lanes, "").run("third", &[("x", &values)], values.len(), &["result"])[0];
        for (x, cosine) in values.iter().zip(found) {
            let expected = (f64::from(*x).acos() / 3.0).cos();
            let error = (f64::from(*cosine) - expected).abs();
            assert!(
                error < THIRD_ERROR,
                "{lanes} lanes, x = {x}: {cosine}, not {expected}"
            );
        }
    }
}

/// Least and greatest real root of u^3 + 3 p u + 2 h, by bisection between bounds of all roots.
fn roots(p: f64, h: f64) -> (f64, f64) {
    let cubic = |u: f64| (u * u + 3.0 * p) * u + 2.0 * h;
    let bound = 1.0 + (3.0 * p).abs() + (2.0 * h).abs();
    let turn = (-p).max(0.0).sqrt();
    let bisect = |mut low: f64, mut high: f64| {
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if cubic(middle) <= 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    };
    if h * h + p * p * p > 0.0 {
        let root = bisect(-bound, bound);
        (root, root)
    } else {
        (bisect(-bound, -turn), bisect(turn, bound))
    }
}

#[test]
fn the_cubics_outer_roots_match_bisection() {
    let mut random = fastrand::Rng::with_seed(3);
    let mut value = || {
        let magnitude = 10_f64.powf(6.0 * random.f64() - 3.0);
        (if random.bool() { magnitude } else { -magnitude }) as f32
    };
    let mut ps: Vec<f32> = (0..960).map(|_| value()).collect();
    let mut hs: Vec<f32> = (0..960).map(|_| value()).collect();
    // Triple root, double roots on either side, h = 0.
    ps.extend([
        0.0, -1.0, -1.0, -4.0, 1.0, -1.0, 1e-6, -1e-6, 0.0, 0.0, 3.0, 3.0, -2.0, -2.0, 1e6, 1e6,
    ]);
    hs.extend([
        0.0, 1.0, -1.0, 8.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0, 1e-5, -1e-5, 1e-5, -1e-5, 1.0, -1.0,
    ]);
    for lanes in lane_widths() {
        let found = Bench::new(lanes, "").run(
            "cubic",
            &[("ps", &ps), ("hs", &hs)],
            ps.len(),
            &["least", "greatest"],
        );
        for (i, (p, h)) in ps.iter().zip(&hs).enumerate() {
            let (p, h) = (f64::from(*p), f64::from(*h));
            let (least, greatest) = roots(p, h);
            let distance_from_double =
                (h * h + p * p * p).abs() / (h * h + p.abs().powi(3) + 1e-30);
            let scale = p
                .abs()
                .sqrt()
                .max(h.abs().cbrt())
                .max(least.abs())
                .max(1e-6);
            let limit = if distance_from_double < 1e-4 {
                DOUBLE_ROOT_ERROR
            } else {
                ROOT_ERROR
            };
            let allowed = limit * scale / distance_from_double.sqrt().clamp(0.1, 1.0);
            let (low, high) = (f64::from(found[0][i]), f64::from(found[1][i]));
            // At a double root float32 may see one root for two: then either outer root is an answer.
            let is_either = |u: f64| (u - least).abs().min((u - greatest).abs()) <= allowed;
            assert!(
                is_either(low) && is_either(high),
                "{lanes} lanes, p {p} h {h}: {low} {high}, not {least} {greatest}"
            );
            if distance_from_double > 1e-4 {
                assert!(
                    (low - least).abs() <= allowed && (high - greatest).abs() <= allowed,
                    "{lanes} lanes, p {p} h {h}: {low} {high}, not {least} {greatest}"
                );
            }
        }
    }
}

#[test]
fn the_spline_matches_de_boor() {
    let ts: Vec<f32> = (0..160).map(|i| i as f32 / 159.0).collect();
    for lanes in lane_widths() {
        let bench = Bench::new(lanes, "");
        for series in [
            vec![1.0, 0.6, 0.2, 0.4, 0.8, 0.6, 1.0],
            vec![0.1, 0.9, 0.5],
            vec![0.0; 4],
        ] {
            let mut scene = common::empty_scene(1, 1);
            scene
                .curves
                .push(common::curve(common::CURVE_SHAPES[0], Some(series.clone())));
            let pieces = Sources::new(&scene, &ANCHOR).rows.list;
            // The pieces have a greatest weight of 1.
            let most = series.iter().copied().fold(0.0, f64::max);
            let scale = if most > 0.0 { 1.0 / most } else { 1.0 };
            let count = [pieces.len() as f32];
            let pieces = bytemuck::cast_slice(&pieces);
            let inputs = [("pieces", pieces), ("count", &count), ("ts", ts.as_slice())];
            let found = &bench.run("spline", &inputs, ts.len(), &["result"])[0];
            for (t, value) in ts.iter().zip(found) {
                let expected = scale * b_spline(&series, f64::from(*t));
                let error = (f64::from(*value) - expected).abs();
                assert!(
                    error < SPLINE_ERROR,
                    "{lanes} lanes, {series:?} at {t}: {value}, not {expected}"
                );
            }
        }
    }
}
