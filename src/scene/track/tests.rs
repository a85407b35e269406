use super::*;

fn number(value: &TrackValue) -> f64 {
    match value {
        TrackValue::Number(number) => *number,
        TrackValue::List(_) => panic!("{value:?}"),
    }
}

fn at(track: &Track, time: f64) -> f64 {
    number(&track.at(time))
}

fn with(interpolation: Interpolation, times: &[f64], values: &[f64]) -> Track {
    let track = Track {
        times: times.to_vec(),
        values: values
            .iter()
            .map(|value| TrackValue::from(*value))
            .collect(),
        interpolation,
        ..Track::constant(0.0)
    };
    track.check().unwrap();
    track
}

#[test]
fn cubic_is_the_formula_of_gltf() {
    // Keys 1 s and 3 s: values 2 and 5, tangents out 4 and in -1. At 1.5 s, s = 1/4 and dt = 2:
    // 27/32 2 + 2 9/64 4 + 5/32 5 + 2 (-3/64) (-1) = 1.6875 + 1.125 + 0.78125 + 0.09375.
    let track = with(
        Interpolation::Cubic,
        &[1.0, 3.0],
        &[9.0, 2.0, 4.0, -1.0, 5.0, 9.0],
    );
    assert_eq!(at(&track, 1.5), 3.6875);
    // At 2 s: (2 + 5) / 2 + 2/8 (4 + 1).
    assert_eq!(at(&track, 2.0), 4.75);
    assert_eq!(
        [0.0, 1.0, 3.0, 9.0].map(|t| at(&track, t)),
        [2.0, 2.0, 5.0, 5.0]
    );
    // The outer tangents have no say, the inner ones have.
    for (index, counts) in [(0, false), (2, true), (3, true), (5, false)] {
        let mut other = track.clone();
        other.values[index] = 7.0.into();
        assert_eq!(at(&other, 1.5) != 3.6875, counts, "{index}");
    }
}

#[test]
fn steps_and_lines_meet_their_keys() {
    let (times, values) = ([0.1, 0.4, 0.7], [3.0, -1.0, 0.3]);
    for way in [
        Interpolation::Step,
        Interpolation::Linear,
        Interpolation::Smooth,
    ] {
        let track = with(way, &times, &values);
        assert_eq!(times.map(|time| at(&track, time)), values, "{way:?}");
        assert_eq!(
            [-5.0, 5.0].map(|time| at(&track, time)),
            [3.0, 0.3],
            "{way:?}"
        );
    }
    assert_eq!(at(&with(Interpolation::Step, &times, &values), 0.399), 3.0);
    assert_eq!(
        at(&with(Interpolation::Linear, &[0.0, 4.0], &[1.0, 3.0]), 1.0),
        1.5
    );
}

#[test]
fn smooth_has_no_kink_and_overshoots_nothing() {
    let times = [0.0, 1.0, 1.5, 4.0, 5.0, 6.0];
    let values = [0.0, 1.0, 1.1, 9.0, 9.0, 2.0];
    let track = with(Interpolation::Smooth, &times, &values);
    let linear = with(Interpolation::Linear, &times, &values);
    let slope = |track: &Track, time: f64| (at(track, time + 1e-6) - at(track, time - 1e-6)) / 2e-6;
    for (index, time) in times.iter().enumerate().take(5).skip(1) {
        let sides = |track: &Track| slope(track, time - 1e-4) - slope(track, time + 1e-4);
        assert!(sides(&track).abs() < 2e-2, "{index}: {}", sides(&track));
        assert!(
            sides(&linear).abs() > 0.5,
            "{index}: the straight one has kinks"
        );
    }
    for step in 0..600 {
        let time = f64::from(step) / 100.0;
        let key = times.iter().rposition(|key| *key <= time).unwrap();
        let (low, high) = (
            values[key].min(values[key + 1]),
            values[key].max(values[key + 1]),
        );
        let value = at(&track, time);
        assert!(
            (low - 1e-12..=high + 1e-12).contains(&value),
            "{time}: {value}"
        );
    }
    // By hand: keys 0, 1, 2 with 0, 1, 4. The tangent at 1 is 6 / (3 / 1 + 3 / 3) = 1.5, at 0 the parabola's 0.
    // Half-way: 1/2 + (0 - 1.5) / 8.
    let track = with(Interpolation::Smooth, &[0.0, 1.0, 2.0], &[0.0, 1.0, 4.0]);
    assert_eq!(at(&track, 0.5), 0.3125);
    // A track that repeats has no kink where it begins again.
    let mut track = with(
        Interpolation::Smooth,
        &[0.0, 1.0, 2.0, 3.0],
        &[0.0, 1.0, -1.0, 0.0],
    );
    let open = slope(&track, 1e-4) - slope(&track, 3.0 - 1e-4);
    track.looping = TrackLoop::Repeat;
    let closed = slope(&track, 1e-4) - slope(&track, 3.0 - 1e-4);
    assert!(closed.abs() < 1e-2 && open.abs() < 1e-2, "{closed} {open}");
    let mut track = with(
        Interpolation::Smooth,
        &[0.0, 1.0, 3.0, 4.0],
        &[0.0, 1.0, -1.0, 0.0],
    );
    track.values[1] = 2.0.into();
    let open = slope(&track, 1e-4) - slope(&track, 4.0 - 1e-4);
    track.looping = TrackLoop::Repeat;
    let closed = slope(&track, 1e-4) - slope(&track, 4.0 - 1e-4);
    assert!(closed.abs() < 1e-2 && open.abs() > 0.3, "{closed} {open}");
}

#[test]
fn tracks_end_repeat_or_go_back() {
    let mut track = with(Interpolation::Linear, &[1.0, 3.0], &[10.0, 30.0]);
    let mut seen = |looping, phase, times: [f64; 5]| {
        (track.looping, track.phase) = (looping, phase);
        times.map(|time| at(&track, time))
    };
    let times = [-1.0, 0.5, 2.0, 3.5, 5.5];
    assert_eq!(
        seen(TrackLoop::Once, 0.0, times),
        [10.0, 10.0, 20.0, 30.0, 30.0]
    );
    assert_eq!(
        seen(TrackLoop::Once, 0.25, times),
        [10.0, 10.0, 25.0, 30.0, 30.0]
    );
    assert_eq!(
        seen(TrackLoop::Repeat, 0.0, times),
        [10.0, 25.0, 20.0, 15.0, 15.0]
    );
    assert_eq!(
        seen(TrackLoop::Repeat, 0.25, times),
        [15.0, 10.0, 25.0, 20.0, 20.0]
    );
    assert_eq!(
        seen(TrackLoop::PingPong, 0.0, times),
        [30.0, 15.0, 20.0, 25.0, 15.0]
    );
    assert_eq!(
        seen(TrackLoop::PingPong, 0.5, times),
        [10.0, 25.0, 20.0, 15.0, 25.0]
    );
    // The end is the beginning, also a tiny time before it.
    assert_eq!(
        seen(TrackLoop::Repeat, 0.0, [1.0 - 1e-30, 3.0, 5.0, 7.0, 1.0]),
        [10.0; 5]
    );
}

#[test]
fn vectors_and_lists_change_number_by_number() {
    let track = Track::new([
        (0.0, [[1.0, 2.0], [3.0, 4.0]]),
        (1.0, [[3.0, 2.0], [3.0, 0.0]]),
    ]);
    assert_eq!(track.at(0.5), [[2.0, 2.0], [3.0, 2.0]].into());
}

fn noisy(frequency: f64, seed: u32, octaves: u32) -> Track {
    let mut noise = TrackNoise::new(0.25, frequency, seed);
    noise.octaves = octaves;
    let track = Track {
        noise: Some(noise),
        ..Track::constant(3.0)
    };
    track.check().unwrap();
    track
}

#[test]
fn noise_is_bounded_stateless_and_of_its_seed() {
    for octaves in [1, 4, 8] {
        let (track, other) = (noisy(3.0, 1, octaves), noisy(3.0, 2, octaves));
        let times = (-2000..2000).map(|step| f64::from(step) * 0.0137);
        let values: Vec<f64> = times.clone().map(|time| at(&track, time)).collect();
        let again: Vec<f64> = times.clone().rev().map(|time| at(&track, time)).collect();
        assert!(values.iter().eq(again.iter().rev()));
        assert!(values.iter().all(|value| (value - 3.0).abs() <= 0.25));
        let most = values
            .iter()
            .map(|value| (value - 3.0).abs())
            .fold(0.0, f64::max);
        assert!(most > 0.15, "{octaves}: {most}");
        let differing = times
            .zip(&values)
            .filter(|(time, value)| at(&other, *time) != **value);
        assert_eq!(differing.count(), values.len());
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        assert!((mean - 3.0).abs() < 0.02, "{mean}");
    }
}

#[test]
fn numbers_of_a_vector_have_noise_of_their_own_each_with_its_amplitude() {
    let mut track = Track::constant([0.0, 0.0, 0.0]);
    track.noise = Some(TrackNoise::new([1.0, 1.0, 0.0], 2.0, 7));
    track.check().unwrap();
    let TrackValue::List(items) = track.at(0.3) else {
        panic!();
    };
    let items: Vec<f64> = items.iter().map(number).collect();
    assert!(items[0] != items[1] && items[2] == 0.0, "{items:?}");
}

#[test]
fn noise_of_a_scene_that_begins_again_does_so_to_the_bit() {
    for (frequency, period) in [(3.0, 2.0), (2.3, 1.75), (0.01, 4.0)] {
        let track = noisy(frequency, 5, 3);
        let value = |time, period| number(&track.at_in(time, period));
        for step in 0..100 {
            // An eighth of the period is exact, and so are times that are whole numbers of it.
            let time = f64::from(step % 8) * period / 8.0;
            let later = time + period * f64::from(step / 8);
            assert_eq!(
                value(wrapped(later, period), Some(period)),
                value(time, Some(period))
            );
        }
        // No jump where it begins again, which noise without a period has.
        let jump = |at| (value(0.0, at) - value(period * (1.0 - 1e-9), at)).abs();
        assert!(jump(Some(period)) < 1e-6, "{}", jump(Some(period)));
        assert!(jump(None) > 1e-3, "{}", jump(None));
    }
}

#[test]
fn noise_has_its_power_below_its_frequency() {
    // Power of 64 s at 4 numbers a second, below and above 4 1/s.
    let share_above = |octaves: u32| {
        let track = noisy(4.0, 9, octaves);
        let count = 2048;
        let values: Vec<f64> = (0..count)
            .map(|k| number(&track.at_in(64.0 * f64::from(k) / f64::from(count), Some(64.0))) - 3.0)
            .collect();
        let power = |wave: i32| {
            let sums = values
                .iter()
                .enumerate()
                .fold((0.0, 0.0), |(re, im), (k, value)| {
                    let turn =
                        f64::from(wave) * k as f64 / f64::from(count) * std::f64::consts::TAU;
                    (re + value * turn.cos(), im + value * turn.sin())
                });
            sums.0 * sums.0 + sums.1 * sums.1
        };
        let powers: Vec<f64> = (1..1024).map(power).collect();
        let (below, above) = powers.split_at(64 * 4);
        let above: f64 = above.iter().sum();
        above / (below.iter().sum::<f64>() + above)
    };
    let (one, four) = (share_above(1), share_above(4));
    assert!(one < 0.02 && four > 0.03 && four < 0.3, "{one} {four}");
}

#[test]
fn what_is_no_track_is_refused() {
    let fault = |track: Track| track.check().unwrap_err();
    let track = |times: &[f64], values: &[f64]| Track {
        times: times.to_vec(),
        values: values.iter().map(|value| (*value).into()).collect(),
        ..Track::constant(0.0)
    };
    let nan = Track::new([(0.0, f64::NAN), (1.0, 2.0)]);
    assert!(nan.at(0.0).all(&f64::is_nan) && track(&[1.0, 0.0], &[]).at(0.5).all(&f64::is_nan));
    let error = nan.validate().unwrap_err().to_string();
    assert!(error.starts_with("scene: track.values[0]: "), "{error}");
    for (wrong, key) in [
        (track(&[0.0, 1.0, 1.0], &[1.0; 3]), "times[2]"),
        (track(&[0.0, f64::INFINITY], &[1.0; 2]), "times[1]"),
        (track(&[0.0, 1.0], &[1.0; 3]), "values"),
        (track(&[0.0], &[1.0]), "times"),
        (track(&[], &[]), "values"),
        (nan, "values[0]"),
    ] {
        assert_eq!(fault(wrong).key(), key);
    }
    let cubic = Track {
        interpolation: Interpolation::Cubic,
        ..track(&[0.0, 1.0], &[1.0; 2])
    };
    assert!(fault(cubic.clone()).message().contains("three for each"));
    for (amplitude, frequency, octaves, key) in [
        (-1.0, 1.0, 1, "noise.amplitude"),
        (f64::NAN, 1.0, 1, "noise.amplitude"),
        (1.0, -1.0, 1, "noise.frequency"),
        (1.0, 1e7, 1, "noise.frequency"),
        (1.0, 1.0, 0, "noise.octaves"),
        (1.0, 1.0, 1000, "noise.octaves"),
    ] {
        let mut noise = TrackNoise::new(amplitude, frequency, 0);
        noise.octaves = octaves;
        let wrong = Track {
            noise: Some(noise),
            ..Track::constant(1.0)
        };
        assert_eq!(fault(wrong).key(), key);
    }
}
