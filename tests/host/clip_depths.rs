//! Depths of clip space in a host's own memory end rays where the scene's depth does, and where lengths do, by every
//! sort of projection.
#![allow(unsafe_code)] // hosts call OpenCL

use crate::common;
use crate::frames::{Frames, OFF, SIZE, difference, image_of, lengths, limit, scene, spoiled};
use energywave::image::{ClipDepth, ClipRange, DepthAlong, DepthImage};
use energywave::scene::Sampling;
use energywave::{HostDepth, RendererOptions};
use glam::DMat4;

/// Projections whose depths are normal, reversed, of an infinite far plane, of both ranges, and orthographic.
fn projections() -> Vec<(&'static str, ClipDepth)> {
    use ClipRange::{MinusOneToOne, ZeroToOne};
    let perspective = |z: f64, w: f64| {
        let mut matrix = DMat4::from_diagonal((1.3, 1.7, z, 0.0).into());
        (matrix.z_axis.w, matrix.w_axis.z) = (-1.0, w);
        matrix
    };
    let across = |z: f64, w: f64| {
        let mut matrix = DMat4::from_diagonal((0.2, 0.2, z, 1.0).into());
        matrix.w_axis.z = w;
        matrix
    };
    // z and w of the third row: -(f + n) / (f - n) and -2 f n / (f - n), or likewise; n = 1, f = 500, or 20 of
    // an orthographic one, whose depths are as coarse everywhere.
    let (span, short) = (499.0, 19.0);
    vec![
        ("0..1", perspective(-500.0 / span, -500.0 / span), ZeroToOne),
        (
            "0..1 reversed",
            perspective(1.0 / span, 500.0 / span),
            ZeroToOne,
        ),
        ("0..1 infinite", perspective(-1.0, -1.0), ZeroToOne),
        ("0..1 reversed infinite", perspective(0.0, 1.0), ZeroToOne),
        (
            "-1..1",
            perspective(-501.0 / span, -1000.0 / span),
            MinusOneToOne,
        ),
        (
            "-1..1 reversed",
            perspective(501.0 / span, 1000.0 / span),
            MinusOneToOne,
        ),
        ("-1..1 infinite", perspective(-1.0, -2.0), MinusOneToOne),
        (
            "-1..1 reversed infinite",
            perspective(1.0, 2.0),
            MinusOneToOne,
        ),
        (
            "orthographic",
            across(-1.0 / short, -1.0 / short),
            ZeroToOne,
        ),
        (
            "orthographic reversed",
            across(1.0 / short, 20.0 / short),
            ZeroToOne,
        ),
        (
            "orthographic -1..1",
            across(-2.0 / short, -21.0 / short),
            MinusOneToOne,
        ),
    ]
    .into_iter()
    .map(|(name, matrix, range)| (name, ClipDepth::new(matrix, Some(range)).unwrap()))
    .collect()
}

/// The same with its planes a tenth elsewhere.
fn elsewhere(clip: &ClipDepth) -> ClipDepth {
    let mut matrix = clip.projection();
    matrix.w_axis.z *= 1.1;
    ClipDepth::new(matrix, Some(clip.range())).unwrap()
}

/// Depths of clip space of lengths along the axis: a + b / d of a perspective, a + b d of an orthographic projection.
fn clip_of(clip: &ClipDepth, length: f32) -> f32 {
    if length == f32::INFINITY {
        return clip.far_depth() as f32;
    }
    let length = f64::from(length).max(1.0); // the near plane
    let point = clip.projection() * glam::DVec4::new(0.0, 0.0, -length, 1.0);
    (point.z / point.w) as f32
}

/// What float32 loses of a depth at 5 from the eye behind a near plane at 1, and light of that.
const ROUNDED: f32 = 1e-5;

fn clip_depths(frames: &mut Frames, limit: f32) {
    let scene = scene(Sampling::Pixels);
    let lengths = lengths();
    let behind_lengths = frames.expected(&scene, image_of(&lengths, DepthAlong::Axis));
    for (name, clip) in projections() {
        let ndc: Vec<f32> = lengths
            .iter()
            .map(|length| clip_of(&clip, *length))
            .collect();
        let low = clip.range().low() as f32;
        let held: Vec<f32> = ndc
            .iter()
            .map(|depth| (depth - low) / (1.0 - low))
            .collect();
        for (along, values) in [(DepthAlong::Ndc, &ndc), (DepthAlong::Buffer, &held)] {
            let what = format!("{name}, {along:?}");
            let depth = DepthImage::from_clip(SIZE, along, &clip, values.clone()).unwrap();
            let expected = frames.expected(&scene, depth);
            let buffer = frames.host.floats(values);
            let found = frames.behind(&scene, &HostDepth::from_clip(&buffer, along, &clip));
            let off = difference(&found, &expected);
            assert!(off <= limit, "{what}: {off:e}");
            let off = difference(&found, &behind_lengths);
            assert!(off <= ROUNDED, "{what}, beside lengths: {off:e}");
            let other = elsewhere(&clip);
            let depth = HostDepth::from_clip(&buffer, along, &other);
            let off = difference(&frames.behind(&scene, &depth), &expected);
            assert!(off > 1e-2, "{what}: by another projection, {off:e}");
        }
    }
}

#[test]
fn depths_of_clip_space_give_the_picture_of_lengths() {
    clip_depths(&mut Frames::new(), limit());
}

#[test]
fn without_float64_they_give_it_within_the_digits_of_a_quotient() {
    let options = common::compiled_with(&RendererOptions::default(), "-D NO_DOUBLES");
    clip_depths(&mut Frames::with(&options), OFF);
}

#[test]
fn what_the_scene_would_refuse_hides_nothing() {
    let (nan, infinity) = (f32::NAN, f32::INFINITY);
    let mut frames = Frames::new();
    let scene = scene(Sampling::Tiles);
    for (name, clip) in projections() {
        let along = DepthAlong::Ndc;
        let ndc: Vec<f32> = lengths()
            .iter()
            .map(|length| clip_of(&clip, *length))
            .collect();
        let values = spoiled(
            &ndc,
            &[nan, 1.001, clip.range().low() as f32 - 0.001, infinity],
        );
        assert!(DepthImage::from_clip(SIZE, along, &clip, values.clone()).is_err());
        let open = spoiled(&ndc, &[infinity]);
        let expected = DepthImage::from_clip(SIZE, along, &clip, open).unwrap();
        let expected = frames.expected(&scene, expected);
        let buffer = frames.host.floats(&values);
        let found = frames.behind(&scene, &HostDepth::from_clip(&buffer, along, &clip));
        let off = difference(&found, &expected);
        assert!(off <= limit(), "{name}: {off:e}");
    }
}

/// How far the picture is from that of the same depths in the scene, behind a near plane a thousandth from the eye:
/// there float32 loses nearly all digits of differences of depths.
fn off_by_digits(options: &RendererOptions) -> energywave::Result<f32> {
    let scene = scene(Sampling::Pixels);
    let mut matrix = DMat4::from_diagonal((1.3, 1.7, -500.0 / 499.999, 0.0).into());
    (matrix.z_axis.w, matrix.w_axis.z) = (-1.0, -0.5 / 499.999);
    let clip = ClipDepth::new(matrix, Some(ClipRange::ZeroToOne)).unwrap();
    let at = |length: &f32| clip_of(&clip, *length);
    let ndc: Vec<f32> = lengths().iter().map(at).collect();
    let mut frames = Frames::with(options);
    let buffer = frames.host.floats(&ndc);
    let depth = HostDepth::from_clip(&buffer, DepthAlong::Ndc, &clip);
    let target = (&frames.target).into();
    // SAFETY: target and depths live until the read is over.
    let event = unsafe { frames.renderer.enqueue_behind(&scene, target, &depth, &[]) }?;
    let found = frames.host.read(target, SIZE, &[&event]);
    let depth = DepthImage::from_clip(SIZE, DepthAlong::Ndc, &clip, ndc).unwrap();
    Ok(difference(&found, &frames.expected(&scene, depth)))
}

#[test]
fn a_kernel_that_loses_digits_draws_another_picture_and_is_refused() {
    let compiled = |flags| common::compiled_with(&RendererOptions::default(), flags);
    assert!(off_by_digits(&compiled("")).unwrap() <= limit());
    assert!(off_by_digits(&compiled("-D NO_DOUBLES")).unwrap() <= OFF);
    let mut spoiled = compiled("-D NO_DOUBLES -D SHORT_PAIRS");
    let error = off_by_digits(&spoiled).unwrap_err();
    assert_eq!(error.kind(), energywave::ErrorKind::SelfTest);
    let words = "the depth 0.99999 of a host is";
    assert!(error.to_string().contains(words), "{error}");
    spoiled.skips_self_test = true;
    let off = off_by_digits(&spoiled).unwrap();
    assert!(off > 10.0 * OFF, "{off:e}");
}
