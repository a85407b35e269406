//! Several lights of one core are, to the bit, as many sources: on the device and in the reference, for every kind.

use energywave::image::ImageSize;
use energywave::scene::{
    Curve, Layer, LightPath, List, Measure, Method, PathShape, Profile, Segment, Sphere,
};
use energywave::{Scene, reference};
use glam::DVec3;

use crate::common::{self, difference, meets, renderer};

const SIZE: u32 = 32;

/// A white core, a coloured halo that ends, and one that takes its profile from its source.
fn layers() -> Vec<Layer> {
    let none = Layer::default();
    vec![
        Layer {
            peak: Some(2.0),
            color: Some(DVec3::ONE),
            profile: Some(Profile::Gaussian),
            radius: Some(0.05),
            ..none.clone()
        },
        Layer {
            peak: Some(0.7),
            radius: Some(0.2),
            reach: Some(0.9),
            ..none.clone()
        },
        Layer {
            coefficient: Some(0.1),
            ..none
        },
    ]
}

macro_rules! for_each_list {
    ($then:ident) => {
        $then!(spheres, cylinders, beams, tori, curves, segments, paths)
    };
}

/// Gives every source of a scene layers, and a peak that some take from it.
fn layered(mut scene: Scene) -> Scene {
    macro_rules! set {
        ($($list:ident),*) => {$(for source in scene.$list.iter_mut() {
            source.profile = Profile::InverseSquare;
            (source.radius, source.peak) = (0.1, Some(0.4));
            source.layers = layers();
        })*};
    }
    for_each_list!(set);
    scene
}

/// Writes every layer as a source of its own.
fn apart(scene: &Scene) -> Scene {
    let mut apart = scene.clone();
    macro_rules! split {
        ($($list:ident),*) => {$(
            apart.$list = List::new();
            for source in &scene.$list {
                for layer in &source.layers {
                    let mut one = source.clone();
                    one.layers.clear();
                    one.color = layer.color.unwrap_or(one.color);
                    one.profile = layer.profile.unwrap_or(one.profile);
                    one.radius = layer.radius.unwrap_or(one.radius);
                    one.reach = layer.reach.or(one.reach);
                    if let Some(coefficient) = layer.coefficient {
                        (one.coefficient, one.peak) = (coefficient, None);
                    }
                    one.peak = layer.peak.or(one.peak);
                    apart.$list.push(one);
                }
            }
        )*};
    }
    for_each_list!(split);
    apart
}

/// Every kind, all of whose lights are packed one after another: beams with a cap and with a taper, a curve with a
/// series.
fn every_kind() -> Scene {
    let mut scene = common::full_scene(SIZE, SIZE);
    scene.curves.truncate(2);
    let (from, to) = (DVec3::new(-1.0, 0.2, 0.1), DVec3::new(0.8, -0.3, 0.6));
    scene.segments.push(Segment::new(from, to));
    let bends = [DVec3::new(-0.2, 0.4, 0.9), DVec3::new(0.3, 0.1, -0.5)];
    scene.paths.push(LightPath {
        shape: PathShape::Spline,
        ..LightPath::new(vec![from, bends[0], bends[1], to])
    });
    scene.integration.method = Method::default();
    scene.integration.measure = Measure::Length;
    scene.decay = None;
    layered(scene)
}

#[test]
fn layers_are_as_many_sources_to_the_bit() {
    let scene = every_kind();
    let apart = apart(&scene);
    assert_eq!(apart.source_count(), 3 * scene.source_count());
    let mut renderer = renderer(common::device().lanes, "");
    let image = renderer.render(&scene).unwrap();
    let cost = renderer.last_cost();
    assert!(image == renderer.render(&apart).unwrap());
    assert_eq!(cost.integrals, renderer.last_cost().integrals);
    let expected = reference::render(&scene).unwrap();
    assert!(expected == reference::render(&apart).unwrap());
    let found = difference(&image, &expected);
    assert!(meets(&found, 1e-3), "{found:?}");
    let mut spoiled = common::renderer(8, common::BROKEN_FIELDS);
    let broken = difference(&spoiled.render(&scene).unwrap(), &expected);
    assert!(!meets(&broken, 1e-3), "spoiled fields pass: {broken:?}");
}

#[test]
fn no_layer_of_any_kind_is_lost() {
    let mut scene = every_kind();
    (scene.image.width, scene.image.height) = (6, 5);
    let image = reference::render(&scene).unwrap();
    macro_rules! lose {
        ($($list:ident),*) => {$(for lost in 0..3 {
            let mut other = scene.clone();
            other.$list[0].layers.remove(lost);
            let other = reference::render(&other).unwrap();
            assert!(other != image, "layer {lost} of {}", stringify!($list));
        })*};
    }
    for_each_list!(lose);
}

#[test]
fn layers_of_opposite_signs_are_taken_at_every_pixel() {
    let mut scene = common::empty_scene(SIZE, SIZE);
    scene.integration.method = Method::default();
    let light = |coefficient| Layer {
        coefficient: Some(coefficient),
        ..Layer::default()
    };
    let points = common::CURVE_SHAPES[0].map(DVec3::from);
    scene.spheres.push(Sphere {
        layers: vec![light(1.0), light(0.5)],
        ..Sphere::default()
    });
    scene.curves.push(Curve {
        layers: vec![light(1.0), light(0.25)],
        ..Curve::new(points)
    });
    assert_eq!(scene.sampling(), energywave::scene::Sampling::Tiles);
    scene.curves[0].layers[1] = light(-0.25);
    assert_eq!(scene.sampling(), energywave::scene::Sampling::Pixels);
    let mut renderer = renderer(common::device().lanes, "");
    let image = renderer.render(&scene).unwrap();
    let ImageSize { width, height } = scene.image;
    let lights = 4 * u64::from(width * height);
    assert_eq!(renderer.last_cost().integrals, lights);
    let found = difference(&image, &reference::render(&scene).unwrap());
    assert!(meets(&found, 1e-3), "{found:?}");
}
