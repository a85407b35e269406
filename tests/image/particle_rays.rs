//! Light of particles along single rays: against the pixels of the device, as a ray is given what its pixel shows, and,
//! along rays of all directions and lengths, against float64 by quadrature of the definition.

use std::ops::ControlFlow;

use energywave::scene::{
    Absorption, Antialias, Decay, LightElement, Measure, Particles, PointList, Sphere,
};
use energywave::{Device, Error, Ray, Renderer, Scene};
use fastrand::Rng;
use glam::DVec3;

use crate::common;
use crate::particles::{FAR, OF_PIXEL, OF_STREAK, cloud, renderer, splash, streaks};

/// What float32 leaves of a pixel besides its share, of the brightest.
const OF_BRIGHTEST: f64 = 2e-5;

/// Every so many pixels are compared.
const STEP: usize = 31;

/// Returns the rays through some pixels, moved aside by so many columns.
fn rays(scene: &Scene, columns: u32) -> Vec<Ray> {
    let plane = scene.view_plane();
    let width = scene.image.width;
    let through = |index: u32| plane.ray(index % width + columns, index / width);
    (0..scene.image.pixels() as u32)
        .step_by(STEP)
        .map(through)
        .collect()
}

/// Returns how many values of rays differ from those of their pixels, and how many are light.
fn differing(lights: &[[f64; 3]], pixels: &[f32]) -> (usize, usize) {
    let brightest = pixels
        .iter()
        .fold(0.0, |most, it| f64::max(most, (*it).into()));
    let pixels = pixels.chunks(4).step_by(STEP);
    let pairs = lights
        .iter()
        .zip(pixels)
        .flat_map(|(light, pixel)| light.iter().zip(&pixel[..3]));
    let off = |(light, pixel): &(&f64, &f32)| {
        (f64::from(**pixel) - **light).abs() > OF_STREAK * light.abs() + OF_BRIGHTEST * brightest
    };
    let lit = lights.iter().filter(|light| light[0] > 0.0).count();
    (pairs.filter(off).count(), lit)
}

#[test]
fn single_rays_are_given_the_light_of_their_pixels() {
    let mut device = renderer("");
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    let eye = DVec3::new(1.0, -7.0, 2.0);
    let mut wave = splash(40.0);
    wave.colliders[0].visible = false; // no surface hides light from single rays
    for (name, mut scene) in [
        ("balls", cloud(eye)),
        ("streaks", streaks(eye)),
        ("waves", wave),
    ] {
        scene.integration.antialias = Antialias::None;
        let shown = device.render(&scene).unwrap();
        for renderer in [&mut device, &mut reference] {
            let along = renderer.integrate(&scene, &rays(&scene, 0)).unwrap();
            let (off, lit) = differing(&along, shown.as_slice());
            assert!(off == 0 && lit > 5, "{name}: {off} differ, {lit} are lit");
        }
        // Of the pixels beside them the light is another.
        let beside = device.integrate(&scene, &rays(&scene, 1)).unwrap();
        assert!(differing(&beside, shown.as_slice()).0 > 5, "{name}");
    }
}

/// What float32 leaves of a ray's light besides its share, of the brightest that a single particle gives to any ray.
const OF_PARTICLE: f64 = 1e-6;

/// How many rays are compared.
const RAYS: usize = 300;

/// Returns rays of all directions through a ball around a place, that begin and end in it or outside of it, some
/// `length` away.
fn rays_around(place: DVec3, length: f64) -> Vec<Ray> {
    let mut random = Rng::with_seed(11);
    let mut vector = || loop {
        let v = DVec3::from([0; 3].map(|_| 2.0 * random.f64() - 1.0));
        if v.length() < 1.0 && v.length() > 0.1 {
            return v;
        }
    };
    let ray = |number: usize| {
        let (through, toward) = (place + 2.5 * vector(), vector().normalize());
        let [before, behind] = match number % 4 {
            0 => [0.7, 0.4],
            1 => [length, 1.0],
            2 => [0.3, length],
            _ => [length, 2.0 * length],
        };
        Ray::between(through - before * toward, through + behind * toward)
    };
    (0..RAYS).map(ray).collect()
}

/// Light along rays in float64, and the brightest of single particles.
struct Truth {
    rays: Vec<Ray>,
    lights: Vec<[f64; 3]>,
    brightest: f64,
}

impl Truth {
    fn of(scene: &Scene, rays: Vec<Ray>) -> Self {
        let mut exact = Renderer::new(&Device::reference()).unwrap();
        let lights = exact.integrate(scene, &rays).unwrap();
        let mut alone = scene.clone();
        let mut of_element = |particles: Option<Particles>, element: Option<LightElement>| {
            alone.particles = particles.into_iter().collect();
            alone.light_elements = element.into_iter().collect();
            let lights = exact.integrate(&alone, &rays).unwrap();
            lights.as_flattened().iter().copied().fold(0.0, f64::max)
        };
        // Some are enough: more could only be brighter.
        let elements = scene.light_elements.iter().step_by(7);
        let of_elements = elements.map(|element| of_element(None, Some(*element)));
        let mut brightest = of_elements.fold(0.0, f64::max);
        for particles in scene.particles.iter() {
            for position in particles.points.positions().iter().step_by(20) {
                let mut one = particles.clone();
                one.points = PointList::new(vec![*position]).unwrap();
                brightest = brightest.max(of_element(Some(one), None));
            }
        }
        Self {
            rays,
            lights,
            brightest,
        }
    }

    /// Returns the worst error of a device, as a share of what it may be.
    fn worst(&self, renderer: &mut Renderer, scene: &Scene, of_ray: f64) -> f64 {
        let found = renderer.integrate(scene, &self.rays).unwrap();
        let pairs = found.as_flattened().iter().zip(self.lights.as_flattened());
        let off = pairs.map(|(found, truth)| {
            (found - truth).abs() / (of_ray * truth.abs() + OF_PARTICLE * self.brightest)
        });
        off.fold(0.0, |worst, off| if off <= worst { worst } else { off })
    }
}

fn fading(mut scene: Scene, power: u32, beta: f64) -> Scene {
    let mut decay = Decay::new(0.2, beta);
    decay.power = power;
    scene.decay = Some(decay);
    scene
}

/// Scenes, and what their light may be off, of itself.
fn scenes() -> Vec<(&'static str, Scene, f64)> {
    let mut absorbed = fading(cloud(FAR), 1, 0.1);
    absorbed.absorption = Some(Absorption { kappa: 0.3 });
    let mut of_length = fading(streaks(FAR), 2, 0.1);
    of_length.integration.measure = Measure::Length;
    let mut both = streaks(FAR);
    both.particles = cloud(FAR).particles;
    vec![
        ("balls", cloud(FAR), OF_PIXEL),
        ("balls that decay", fading(cloud(FAR), 2, 0.02), OF_PIXEL),
        ("balls, power 3", fading(cloud(FAR), 3, 0.3), OF_PIXEL),
        ("balls, absorbed", absorbed, OF_PIXEL),
        ("streaks", streaks(FAR), OF_STREAK),
        ("streaks that decay", of_length, OF_STREAK),
        ("both", both, OF_STREAK),
    ]
}

#[test]
fn rays_of_all_directions_get_the_light_of_float64() {
    let mut renderer = renderer("");
    for (name, scene, of_ray) in scenes() {
        let truth = Truth::of(&scene, rays_around(DVec3::ZERO, 8.0));
        let lit = truth.lights.iter().filter(|it| it[2] > 0.0).count();
        let worst = truth.worst(&mut renderer, &scene, of_ray);
        println!("{name}: {worst:.2} of what it may be, {lit} rays are lit");
        assert!(worst < 1.0 && lit > RAYS / 3, "{name}: {worst}, {lit}");
        // Rays that begin a little farther on get another light.
        let mut moved = Truth::of(&scene, truth.rays.clone());
        moved.rays.iter_mut().for_each(|ray| ray.origin += 1e-3);
        let worst = moved.worst(&mut renderer, &scene, of_ray);
        assert!(worst > 10.0, "{name}: {worst}");
    }
}

/// Far from each other, so that their middle is far from all; and far from the origin of the world.
fn apart() -> (Scene, DVec3) {
    let place = DVec3::new(3e4, -2e4, 1e4);
    let mut scene = cloud(FAR);
    for mut particles in std::mem::take(&mut scene.particles).iter().cloned() {
        particles.translate += place;
        scene.particles.push(particles);
    }
    let beside = PointList::new(vec![place + DVec3::new(900.0, 700.0, -800.0)]).unwrap();
    scene.particles.push(Particles::new(beside, 0.5));
    (scene, place)
}

#[test]
fn rays_from_afar_lose_nothing() {
    let (scene, place) = apart();
    for length in [8.0, 3000.0] {
        let truth = Truth::of(&scene, rays_around(place, length));
        let worst = truth.worst(&mut renderer(""), &scene, OF_PIXEL);
        let spoiled = truth.worst(&mut renderer("-DSHORT_WAYS"), &scene, OF_PIXEL);
        println!("{length} long: {worst:.2}; without what float32 leaves: {spoiled:.1}");
        assert!(worst < 1.0 && spoiled > 3.0, "{length}: {worst} {spoiled}");
    }
}

#[test]
fn spoiled_builds_give_another_light_along_rays() {
    for (spoil, scene, of_ray) in [
        (
            "-DMOMENTS_EVERYWHERE",
            fading(cloud(FAR), 2, 0.02),
            OF_PIXEL,
        ),
        ("-DNEVER_CUT", cloud(FAR), OF_PIXEL),
        ("-DNARROW", streaks(FAR), OF_STREAK),
    ] {
        let truth = Truth::of(&scene, rays_around(DVec3::ZERO, 8.0));
        let worst = truth.worst(&mut renderer(spoil), &scene, of_ray);
        println!("{spoil}: {worst:.1}");
        assert!(worst > 1.0, "{spoil}: {worst}");
    }
}

#[test]
fn every_lane_width_gives_a_ray_the_same_light_whatever_is_beside_it() {
    let (_, scene, of_ray) = scenes().pop().unwrap();
    let truth = Truth::of(&scene, rays_around(DVec3::ZERO, 8.0));
    for lanes in common::lane_widths() {
        let mut renderer = common::renderer(lanes, "");
        let worst = truth.worst(&mut renderer, &scene, of_ray);
        assert!(worst < 1.0, "{lanes} lanes: {worst}");
        let together = renderer.integrate(&scene, &truth.rays).unwrap();
        for count in [1, 7] {
            let parts = truth.rays.chunks(count).take(40);
            let parts = parts.flat_map(|rays| renderer.integrate(&scene, rays).unwrap());
            let same = parts.zip(&together).all(|(one, other)| one == *other);
            assert!(same, "{lanes} lanes, {count} rays at once");
        }
    }
}

#[test]
fn along_rays_particles_add_to_the_wave_change_with_their_lists_and_can_be_stopped() {
    let mut renderer = renderer("");
    let rays = rays_around(DVec3::ZERO, 8.0);
    let mut scene = cloud(FAR);
    let particles = renderer.integrate(&scene, &rays).unwrap();
    scene.spheres.push(Sphere::default());
    let both = renderer.integrate(&scene, &rays).unwrap();
    scene.particles.clear();
    let wave = renderer.integrate(&scene, &rays).unwrap();
    for ((one, other), both) in particles.iter().zip(&wave).zip(&both) {
        let sum = DVec3::from(*one) + DVec3::from(*other);
        assert!((sum - DVec3::from(*both)).length() <= 1e-6 * sum.length());
    }
    // Others in their place, and the first ones again.
    let scene = cloud(FAR);
    let others = renderer.integrate(&streaks(FAR), &rays).unwrap();
    let again = renderer.integrate(&scene, &rays).unwrap();
    assert!(again == particles && others != particles);
    assert!(renderer.integrate(&scene, &[]).unwrap().is_empty());
    let mut heard = Vec::new();
    let stopped = renderer.integrate_with_progress(&scene, &rays, &mut |share| {
        heard.push(share);
        ControlFlow::Break(())
    });
    assert!(matches!(stopped, Err(Error::Interrupted)) && heard == [1.0]);
    assert!(renderer.integrate(&scene, &rays).unwrap() == particles);
}
