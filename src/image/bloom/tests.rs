//! No light is lost, points are spread round and smoothly, and pictures have it.

use super::*;
use crate::image::{Display, ToneMap};

fn image(width: u32, height: u32, light: impl Fn(usize) -> [f32; 4]) -> RadianceImage {
    let mut image = RadianceImage::new(ImageSize { width, height }).unwrap();
    for (i, pixel) in image.data.chunks_exact_mut(4).enumerate() {
        pixel.copy_from_slice(&light(i));
    }
    image
}

fn bloom(radius: f64) -> Bloom {
    Bloom {
        strength: 1.0,
        radius,
    }
}

fn sums(image: &RadianceImage) -> [f64; 3] {
    let of = |channel| image.data.iter().skip(channel).step_by(4);
    [0, 1, 2].map(|channel| of(channel).map(|light| f64::from(*light)).sum())
}

#[test]
fn no_light_is_lost_or_made_at_any_size_and_border() {
    for (width, height) in [
        (1, 1),
        (1, 7),
        (2, 2),
        (3, 5),
        (97, 61),
        (128, 64),
        (333, 2),
    ] {
        let last = (width * height) as usize - 1;
        // Sparks in the corners and within, on a wide glow.
        let before = image(width, height, |i| match i {
            0 => [1e3, 0.0, 7.0, 1.0],
            i if i == last => [0.0, 2e3, 7.0, 1.0],
            i if i % 31 == 5 => [0.0, 50.0, 90.0, 0.5],
            i => [0.01 * (i % 13) as f32, 0.0, 0.5, 1.0],
        });
        for radius in [1e-9, 0.01, 0.05, 0.3, 1.0] {
            let after = before.bloomed(&bloom(radius)).unwrap();
            for (before, after) in sums(&before).into_iter().zip(sums(&after)) {
                let off = (after - before).abs();
                assert!(
                    off <= 1e-5 * before,
                    "{width}x{height} {radius}: {before} {after}"
                );
            }
            let alphas = |image: &RadianceImage| -> Vec<f32> {
                image.data.iter().skip(3).step_by(4).copied().collect()
            };
            assert_eq!(alphas(&before), alphas(&after));
        }
        // What is equal everywhere stays.
        let flat = image(width, height, |_| [0.3, 2.0, 5.0, 1.0]);
        let after = flat.bloomed(&bloom(0.2)).unwrap();
        for (before, after) in flat.data.iter().zip(&after.data) {
            assert!((before - after).abs() < 1e-5 * before, "{before} {after}");
        }
    }
}

#[test]
fn each_row_gives_all_of_its_light() {
    let axis = Axis::halving(&[1.0; 61]);
    // What row 0 and row 60 and all between give to the halves.
    let worst = |weights: &[[f32; 5]]| {
        let mut given = [0.0; 61];
        for (coarse, taps) in weights.iter().enumerate() {
            for (tap, weight) in taps.iter().enumerate() {
                let row = (2 * coarse + tap).checked_sub(2);
                if let Some(given) = row.and_then(|row| given.get_mut(row)) {
                    *given += f64::from(*weight) * axis.masses[coarse];
                }
            }
        }
        given
            .iter()
            .fold(0.0_f64, |worst, given| worst.max((given - 1.0).abs()))
    };
    assert!(worst(&axis.weights) < 1e-6);
    // The control: the same weights everywhere, as if beyond a border all were black.
    let plain = vec![[0.0625, 0.25, 0.375, 0.25, 0.0625]; axis.weights.len()];
    assert!(worst(&plain) > 0.1);
}

/// A point of light on a square of 257 pixels, spread; by what is across and down from there.
fn spread(column: i32, row: i32, radius: f64) -> impl Fn(i32, i32) -> f64 {
    let point = image(257, 257, |i| match i as i32 == 257 * row + column {
        true => [1.0, 0.0, 0.0, 1.0],
        false => [0.0, 0.0, 0.0, 1.0],
    });
    let after = point.bloomed(&bloom(radius)).unwrap();
    move |across, down| {
        let pixel = after.pixel((column + across) as u32, (row + down) as u32);
        f64::from(pixel.unwrap()[0])
    }
}

/// Light on a circle, between pixels of the four around.
fn circle(light: &impl Fn(i32, i32) -> f64, distance: f64) -> Vec<f64> {
    let angles = (0..48).map(|k| f64::from(k) * std::f64::consts::TAU / 48.0);
    let at = |angle: f64| {
        let (x, y) = (distance * angle.cos(), distance * angle.sin());
        let (column, row) = (x.floor() as i32, y.floor() as i32);
        let (u, v) = (x - x.floor(), y - y.floor());
        let above = (1.0 - u) * light(column, row) + u * light(column + 1, row);
        let below = (1.0 - u) * light(column, row + 1) + u * light(column + 1, row + 1);
        (1.0 - v) * above + v * below
    };
    angles.map(at).collect()
}

/// How far lines of equal light are from circles, as a share of their radius, and how far light is from smooth: the
/// steepest slope of its logarithm by that of the distance. Light that falls off with its square has 0 and 2.
fn shape(light: &impl Fn(i32, i32) -> f64) -> (f64, f64) {
    let (mut oval, mut steep) = (0.0_f64, 0.0_f64);
    for distance in [6.0, 10.0, 16.0, 24.0] {
        let mean = |distance| circle(light, distance).iter().sum::<f64>() / 48.0;
        let slope = (mean(distance / 1.1) / mean(distance * 1.1)).ln() / (2.0 * 1.1_f64.ln());
        let ring = circle(light, distance).into_iter();
        let off = ring.map(|light| (light / mean(distance)).ln().abs() / slope);
        oval = off.fold(oval, f64::max);
    }
    for x in 6..30 {
        for (here, next) in [
            (light(x, 0), light(x + 1, 0)),
            (light(-x, 0), light(-x - 1, 0)),
            (light(0, x), light(0, x + 1)),
            (light(0, -x), light(0, -x - 1)),
        ] {
            let slope = (here / next).ln() / (f64::from(x + 1) / f64::from(x)).ln();
            steep = steep.max(slope.abs());
        }
    }
    (oval, steep)
}

#[test]
fn a_point_is_spread_round_and_smoothly() {
    for (column, row) in [(128, 128), (127, 128), (121, 130), (115, 125)] {
        let (oval, steep) = shape(&spread(column, row, 0.1));
        assert!(oval < 0.1, "{column} {row}: {oval}");
        assert!(steep < 5.0, "{column} {row}: {steep}");
    }
    // The control: every level spread evenly over its own pixel, in squares.
    let (column, row) = (121, 130);
    let squares = |across: i32, down: i32| -> f64 {
        let is_one =
            |k: i32| (column + across) >> k == column >> k && (row + down) >> k == row >> k;
        (1..8)
            .filter(|k| is_one(*k))
            .map(|k| 0.25_f64.powi(k))
            .sum()
    };
    let (oval, steep) = shape(&squares);
    assert!(oval > 0.5 && steep > 20.0, "{oval} {steep}");
}

#[test]
fn a_wider_bloom_has_more_levels_and_all_of_the_light() {
    let size = ImageSize {
        width: 1920,
        height: 1080,
    };
    let mut before = 0.0;
    for radius in [0.001, 0.01, 0.05, 0.2, 1.0] {
        let shares = bloom(radius).shares(size);
        assert!((shares.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        let levels = shares.iter().zip(1..);
        let variance: f64 = levels
            .map(|(share, k)| f64::from(*share) * (4.0_f64.powi(k) - 1.0) * 2.0 / 3.0)
            .sum();
        assert!(variance > before, "{radius}: {variance}");
        before = variance;
    }
    // The widest of three levels has the radius as its deviation, (4^3 - 1) 2 / 3 square pixels.
    let shares = bloom(42.0_f64.sqrt() / 1080.0).shares(size);
    assert_eq!(shares.len(), 3);
    assert!(shares.iter().all(|share| (share - 1.0 / 3.0).abs() < 1e-6));
    // And it is the deviation of what is drawn.
    let light = spread(128, 128, 42.0_f64.sqrt() / 257.0);
    let all = (-60..=60).flat_map(|y| (-60..=60).map(move |x| (x, y)));
    let variance: f64 = all.map(|(x, y)| f64::from(x * x) * light(x, y)).sum();
    let expected = (2.0 + 10.0 + 42.0) / 3.0;
    assert!((variance / expected - 1.0).abs() < 0.1, "{variance}");
}

#[test]
fn pictures_have_it_and_light_without_end_is_not_spread() {
    let light = image(64, 48, |i| match i {
        1000 => [9.0, 5.0, 1.0, 1.0],
        2000 => [f32::INFINITY, f32::NAN, 0.0, 1.0],
        _ => [0.0, 0.0, 0.0, 1.0],
    });
    let some = Bloom::new(0.4);
    let without = Display {
        tone_map: ToneMap::Clamp,
        bits: Some(16),
        ..Display::default()
    };
    let with = Display {
        bloom: Some(some),
        ..without.clone()
    };
    let spread = light.bloomed(&some).unwrap();
    assert_eq!(light.tone_map(&with), spread.tone_map(&without));
    assert_ne!(light.tone_map(&with), light.tone_map(&without));
    let all = spread.data.iter().filter(|light| !light.is_finite());
    assert_eq!(all.count(), 2);
    let none = light.bloomed(&Bloom::new(0.0)).unwrap();
    assert_eq!(none.tone_map(&without), light.tone_map(&without));
}
