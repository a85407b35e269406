//! What light that waves cast obeys: it is smooth past the ends of cores, parts add up to the whole, capsules stand for
//! cores from afar; and what is asked wrongly is refused.

use energywave::light::proxies;
use energywave::scene::{Beam, Camera, Curve, Cylinder, Lighting, Segment, Sphere, Torus};
use energywave::{Error, Renderer, Scene, reference};
use glam::DVec3;

use super::common::device;

/// How far a second difference along a way past an end may be off the reference's, of the greatest light: float32.
const ROUGH: f64 = 2e-4;

/// How far the parts of a core may be off the whole: what the rules leave of curves and of parts of rings.
const PARTS: f64 = 5e-3;

/// How far capsules may be off from afar: cores are no points.
const PROXIES: f64 = 0.02;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn scene() -> Scene {
    let mut scene = Scene::new(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO));
    scene.lighting = Some(Lighting::default());
    scene
}

#[test]
fn light_is_smooth_along_a_core_and_past_its_end() {
    let mut renderer = Renderer::new(&device()).unwrap();
    let mut scene = scene();
    scene
        .segments
        .push(Segment::new(v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0)));
    for (way, normal) in [
        (v(0.01, 0.0, 0.0), DVec3::Z),
        (v(0.01, 0.0, 0.0), -DVec3::X),
    ] {
        let points: Vec<DVec3> = (0..200)
            .map(|k| v(0.0, 0.0, -0.05) + f64::from(k) * way)
            .collect();
        let normals = vec![normal; points.len()];
        let found = renderer.irradiance(&scene, &points, &normals).unwrap();
        let truth = reference::irradiance(&scene, &points, &normals).unwrap();
        let most = truth.iter().map(|it| it[0]).fold(0.0, f64::max);
        let second = |at: &dyn Fn(usize) -> f64, k: usize| at(k - 1) - 2.0 * at(k) + at(k + 1);
        let (mut rough, mut bend): (f64, f64) = (0.0, 0.0);
        for k in 1..points.len() - 1 {
            let own = second(&|k| f64::from(found[k][0]), k);
            let other = second(&|k| truth[k][0], k);
            rough = rough.max((own - other).abs() / most);
            bend = bend.max(other.abs() / most);
        }
        println!("second differences up to {bend:.1e} of the light, off by {rough:.1e}");
        assert!(rough < ROUGH && bend < 0.05);
    }
}

#[test]
fn parts_of_a_core_add_up_to_it() {
    let mut renderer = Renderer::new(&device()).unwrap();
    let mut random = fastrand::Rng::with_seed(5);
    let mut any = || DVec3::from([0; 3].map(|_| 2.0 * random.f64() - 1.0));
    let (points, normals): (Vec<DVec3>, Vec<DVec3>) = (0..60).map(|_| (1.5 * any(), any())).unzip();
    let controls = [v(-1.0, 0.2, 0.1), v(0.3, 1.4, -0.6), v(0.9, -0.5, 0.4)];
    let (from, to) = (v(-1.0, 0.3, 0.2), v(0.8, -0.1, 0.4));
    let mut pairs = Vec::new();
    let (mut whole, mut parts) = (scene(), scene());
    whole.segments.push(Segment::new(from, to));
    for k in 0..5 {
        let at = |k: i32| from.lerp(to, f64::from(k) / 5.0);
        parts.segments.push(Segment::new(at(k), at(k + 1)));
    }
    pairs.push(("segments", whole, parts));
    let (mut whole, mut parts) = (scene(), scene());
    whole.tori.push(Torus::new(0.8));
    for k in 0..4 {
        parts.tori.push(Torus {
            sweep: Some([90.0 * f64::from(k), 90.0 * f64::from(k + 1)]),
            ..Torus::new(0.8)
        });
    }
    pairs.push(("rings", whole, parts));
    let (mut whole, mut parts) = (scene(), scene());
    whole.curves.push(Curve::new(controls));
    // De Casteljau's halves.
    let [a, b, c] = controls;
    let (ab, bc) = (0.5 * (a + b), 0.5 * (b + c));
    let middle = 0.5 * (ab + bc);
    parts.curves.push(Curve::new([a, ab, middle]));
    parts.curves.push(Curve::new([middle, bc, c]));
    pairs.push(("curves", whole, parts));
    let (mut whole, mut parts) = (scene(), scene());
    whole.cylinders.push(Cylinder {
        point: from,
        ..Cylinder::new(to)
    });
    for direction in [to, -to] {
        parts.beams.push(Beam {
            tip: from,
            ..Beam::new(direction)
        });
    }
    pairs.push(("lines", whole, parts));
    for (name, mut whole, mut parts) in pairs {
        let radius = Some(1e-3);
        whole.lighting.as_mut().unwrap().radius = radius;
        parts.lighting.as_mut().unwrap().radius = radius;
        let all = renderer.irradiance(&whole, &points, &normals).unwrap();
        let sum = renderer.irradiance(&parts, &points, &normals).unwrap();
        let most = all.iter().map(|it| it[0]).fold(0.0, f32::max);
        for (all, sum) in all.iter().zip(&sum) {
            let off = f64::from((all[0] - sum[0]).abs());
            let allowed = PARTS * f64::from(all[0].max(1e-3 * most));
            assert!(off <= allowed, "{name}: {all:?} and {sum:?}");
        }
        // One less is told.
        parts.segments.pop();
        parts.tori.pop();
        parts.curves.pop();
        parts.beams.pop();
        let less = renderer.irradiance(&parts, &points, &normals).unwrap();
        let missing = all
            .iter()
            .zip(&less)
            .any(|(all, less)| less[0] < 0.9 * all[0]);
        assert!(missing, "{name}");
    }
}

#[test]
fn capsules_light_from_afar_as_cores_do() {
    let mut scene = scene();
    let color = v(1.0, 0.5, 0.25);
    scene.spheres.push(Sphere {
        center: v(0.3, 0.0, 0.2),
        color,
        ..Sphere::default()
    });
    scene.segments.push(Segment {
        colors: Some(vec![v(1.0, 0.0, 0.0), v(0.0, 0.0, 1.0)]),
        ..Segment::new(v(-0.5, 0.0, 0.0), v(0.5, 0.2, 0.0))
    });
    scene.tori.push(Torus {
        coefficient: 2.0,
        ..Torus::new(0.4)
    });
    let controls = [v(-0.4, 0.0, 0.1), v(0.1, 0.5, -0.2), v(0.4, -0.2, 0.1)];
    scene.curves.push(Curve::new(controls));
    let capsules = proxies(&scene).unwrap();
    assert_eq!(capsules.len(), 1 + 4 + 24 + 8);
    let points = [v(8.0, 1.0, 3.0), v(-2.0, 9.0, -3.0), v(1.0, -3.0, 9.0)];
    let normals = points.map(|point| -point + v(1.0, 2.0, 1.0));
    let truth = reference::irradiance(&scene, &points, &normals).unwrap();
    for ((point, normal), truth) in points.iter().zip(normals).zip(truth) {
        let of_one = |it: &energywave::light::CapsuleLight| {
            let y = 0.5 * (it.a + it.b) - *point;
            it.color * it.intensity * y.dot(normal.normalize()) / y.length().powi(3)
        };
        let sum: DVec3 = capsules.iter().map(of_one).sum();
        let off = (sum - DVec3::from(truth)).abs().max_element() / truth[0];
        assert!(off < PROXIES, "{sum} and {truth:?}");
    }
    // Lines without end are cut.
    scene.cylinders.push(Cylinder::new(DVec3::X));
    let capsules = proxies(&scene).unwrap();
    let longest = capsules
        .iter()
        .map(|it| it.a.distance(it.b))
        .fold(0.0, f64::max);
    assert!(
        (longest / (2.0 * scene.ray_length()) - 1.0).abs() < 1e-9,
        "{longest}"
    );
}

#[test]
fn what_is_asked_wrongly_is_refused() {
    let mut scene = scene();
    scene.spheres.push(Sphere::default());
    for device in [device(), energywave::Device::reference()] {
        let mut renderer = Renderer::new(&device).unwrap();
        let mut ask =
            |points: &[DVec3], normals: &[DVec3]| renderer.irradiance(&scene, points, normals);
        assert_eq!(ask(&[], &[]).unwrap(), Vec::<[f32; 3]>::new());
        let (up, one) = (DVec3::Z, -2.0 * DVec3::Z);
        assert!(ask(&[one], &[5.0 * up]).unwrap()[0][0] > 0.2);
        let told = ask(&[one, one], &[up]).unwrap_err();
        assert!(matches!(told, Error::Unsupported(_)), "{told}");
        for (points, normals, key) in [
            ([one, one], [up, DVec3::ZERO], "normal 1"),
            ([one, one], [up * f64::NAN, up], "normal 0"),
            ([one, one * f64::INFINITY], [up, up], "point 1"),
        ] {
            let told = ask(&points, &normals).unwrap_err().to_string();
            assert!(told.contains(key), "{told}");
        }
    }
}
