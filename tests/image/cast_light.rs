//! Holds the light that waves cast on surfaces to its definition: sums of random places of each core, and the float64
//! reference.

use energywave::{Renderer, reference};
use glam::DVec3;

use super::cast_cases::{Case, RADIUS, cases};
use super::common::{device, outer_lane_widths, renderer};

/// Points of surfaces for each source.
const POINTS: usize = 200;

/// The error that light may have against sums of random places: the model's bar.
const MOST: f64 = 1e-2;

/// The standard error of such a sum.
const STANDARD_ERROR: f64 = 2e-3;

/// What is dark for both: a share of what would fall on a surface that faces each place of the core.
const DARK: f64 = 1e-4;

/// How far lanes beside it may change a point's light: they have as many nodes as the one that needs most.
const BY_LANES: f32 = 5e-3;

/// The error that the kernel may have against the reference: of one point in a hundred, and of all.
const USUAL: f64 = 5e-3;

fn direction(random: &mut fastrand::Rng) -> DVec3 {
    loop {
        let it = DVec3::from([0; 3].map(|_| 2.0 * random.f64() - 1.0));
        if it.length() < 1.0 && it.length() > 0.1 {
            return it.normalize();
        }
    }
}

/// Points around a core, each with a normal: anywhere, next to the core, in line with its ends, and such that the
/// horizon cuts it.
fn places(case: &Case) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut random = fastrand::Rng::with_seed(0x5eed);
    let mut points = Vec::new();
    let mut normals = Vec::new();
    for k in 0..POINTS {
        // Not where lines go to infinity.
        let place = |x: f64| (case.place)(0.05 + 0.9 * x, DVec3::ZERO).0;
        let (on_core, other) = (place(random.f64()), place(random.f64()));
        let way = direction(&mut random);
        let point = match k % 4 {
            0 => 2.0 * random.f64() * way,
            1 => on_core + 1e-3 * (0.5 + 2.0 * random.f64()) * way,
            2 => {
                // Beyond an end, in line with it.
                let (end, _) = (case.place)(case.end, DVec3::ZERO);
                let (inside, _) = (case.place)(case.end + 1e-4, DVec3::ZERO);
                end + (end - inside).normalize_or(way) * (0.02 + random.f64()) + 1e-4 * way
            }
            _ => on_core + 0.5 * random.f64() * way,
        };
        let normal = match k % 8 {
            0..4 => direction(&mut random),
            // The horizon goes through a place of the core.
            _ => (direction(&mut random))
                .cross(other - point)
                .normalize_or(way),
        };
        points.push(point);
        normals.push(normal);
    }
    (points, normals)
}

/// Returns the sum over random places of a core, one in each of many equal parts, and its standard error; and what
/// falls on a surface that faces each place.
fn random_sum(case: &Case, point: DVec3, normal: DVec3) -> (DVec3, DVec3, f64) {
    const SUMS: usize = 12;
    let mut random = fastrand::Rng::with_seed(7);
    let mut strata = 1000;
    loop {
        let (mut sums, mut facing) = (Vec::new(), 0.0);
        for _ in 0..SUMS {
            let mut sum = DVec3::ZERO;
            for k in 0..strata {
                let x = (f64::from(k) + random.f64()) / f64::from(strata);
                let (place, light) = (case.place)(x, point);
                let y = place - point;
                let distance2 = y.length_squared() + RADIUS * RADIUS;
                sum += light * y.dot(normal).max(0.0) / distance2.powf(1.5);
                facing += light.max_element() / distance2 / f64::from(strata);
            }
            sums.push(sum / f64::from(strata));
        }
        let count = SUMS as f64;
        let mean = sums.iter().copied().sum::<DVec3>() / count;
        let squares = sums
            .iter()
            .map(|sum| (*sum - mean).powf(2.0))
            .sum::<DVec3>();
        let error = (squares / (count * (count - 1.0))).powf(0.5);
        let most = (STANDARD_ERROR * mean).max(DVec3::splat(0.1 * DARK * facing / count));
        if error.cmple(most).all() {
            return (mean, error, facing / count);
        }
        strata *= 4;
        assert!(strata < 1 << 24, "{}: {error} of {mean}", case.name);
    }
}

/// Returns the errors of found light, relative to what is expected, dark places aside.
fn errors(found: &[[f32; 3]], expected: &[DVec3], facing: &[f64], dark: f64) -> Vec<f64> {
    let error = |((found, expected), facing): ((&[f32; 3], &DVec3), &f64)| {
        let found = DVec3::from(found.map(f64::from));
        let off = (found - *expected).abs() - DVec3::splat(dark * facing);
        (off / expected.max(DVec3::splat(1e-30)))
            .max_element()
            .max(0.0)
    };
    found.iter().zip(expected).zip(facing).map(error).collect()
}

fn worst(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |most, error| match *error <= most {
        true => most,
        false => *error, // or it is no number
    })
}

#[test]
fn every_core_casts_the_light_of_its_places() {
    let mut on_device = Renderer::new(&device()).unwrap();
    let mut spoiled =
        ["-DWITHOUT_COSINE", "-DWITHOUT_HORIZON"].map(|spoil| (spoil, renderer(1, spoil)));
    for case in cases() {
        let (points, normals) = places(&case);
        let sums = points
            .iter()
            .zip(&normals)
            .map(|(point, normal)| random_sum(&case, *point, *normal));
        let (expected, facing): (Vec<DVec3>, Vec<f64>) =
            sums.map(|(mean, _, facing)| (mean, facing)).unzip();
        let found = on_device
            .irradiance(&case.scene, &points, &normals)
            .unwrap();
        let of_sums = errors(&found, &expected, &facing, DARK);
        let truth = reference::irradiance(&case.scene, &points, &normals).unwrap();
        let truth: Vec<DVec3> = truth.into_iter().map(DVec3::from).collect();
        let of_truth = errors(&found, &truth, &facing, DARK);
        let mut fine = errors(&found, &truth, &facing, 0.01 * DARK);
        fine.sort_by(f64::total_cmp);
        let mut sorted = of_truth.clone();
        sorted.sort_by(f64::total_cmp);
        let single: Vec<[f32; 3]> = truth.iter().map(|it| it.as_vec3().to_array()).collect();
        let reference_off = worst(&errors(&single, &expected, &facing, DARK));
        println!(
            "{}: off random sums by {:.1e}, the reference by {reference_off:.1e}; off the reference by {:.1e} in the \
             middle, {:.1e} of 95 in 100, and by {:.1e} of 99, {:.1e} at most, but for what is dark",
            case.name,
            worst(&of_sums),
            fine[POINTS / 2],
            fine[POINTS * 95 / 100 - 1],
            sorted[POINTS * 99 / 100 - 1],
            worst(&of_truth)
        );
        assert!(reference_off < MOST, "{}", case.name);
        assert!(worst(&of_sums) < MOST, "{}", case.name);
        assert!(
            worst(&of_truth) < MOST && sorted[POINTS * 99 / 100 - 1] < USUAL,
            "{}",
            case.name
        );
        for (spoil, spoiled) in &mut spoiled {
            let found = spoiled.irradiance(&case.scene, &points, &normals).unwrap();
            let off = worst(&errors(&found, &expected, &facing, DARK));
            assert!(
                off >= MOST || off.is_nan(),
                "{}, {spoil}: {off:.1e}",
                case.name
            );
        }
    }
}

/// Returns by how much two lights of the same points differ, of the first one, or of a little of the greatest.
fn difference(one: &[[f32; 3]], other: &[[f32; 3]]) -> f32 {
    let most = one.iter().map(|it| it[0]).fold(0.0, f32::max);
    let pairs = one.iter().zip(other);
    let off = pairs.map(|(one, other)| (one[0] - other[0]).abs() / one[0].abs().max(1e-4 * most));
    off.fold(0.0, |most, off| if off <= most { most } else { off })
}

#[test]
fn light_is_the_same_on_one_lane_and_many() {
    let mut renderers: Vec<(u32, Renderer)> = (outer_lane_widths().into_iter())
        .map(|lanes| (lanes, renderer(lanes, "")))
        .collect();
    for case in cases() {
        let (points, normals) = places(&case);
        let (_, first) = &mut renderers[0];
        let expected = first.irradiance(&case.scene, &points, &normals).unwrap();
        for (lanes, renderer) in &mut renderers[1..] {
            let found = renderer.irradiance(&case.scene, &points, &normals).unwrap();
            let off = difference(&expected, &found);
            println!("{}, {lanes} lanes: {off:.1e}", case.name);
            assert!(off < BY_LANES, "{}, {lanes} lanes: {off:.1e}", case.name);
        }
        let turned: Vec<DVec3> = normals.iter().map(|normal| -*normal).collect();
        let behind = renderers[0]
            .1
            .irradiance(&case.scene, &points, &turned)
            .unwrap();
        assert!(difference(&expected, &behind) > BY_LANES, "{}", case.name);
    }
}
