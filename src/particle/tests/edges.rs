//! Responses, and scenes at the edge of what is possible.

use super::*;

#[test]
fn what_accelerates_lets_particles_in_and_pushes_them_out() {
    /// The greatest depth, and the speeds of those that came back and of those that went through.
    fn ends(speed: f64) -> (f64, [Vec<f64>; 2]) {
        let scene = changed(|wave| {
            (wave.response, wave.speed) = (Response::Accelerate, speed);
            wave.acceleration = crate::scene::Acceleration::new([1.5, 0.0], [1.5, 0.0]);
        });
        let all = states(&scene, 160, |_| {});
        let bodies = all.iter().flat_map(|state| &state.bodies);
        let deepest = bodies.map(|body| body.position.x).fold(0.0, f64::max);
        let mut speeds = [Vec::new(), Vec::new()];
        let last = all.last().unwrap().bodies.iter();
        for body in last.filter(|body| body.phase == Phase::Circular) {
            speeds[usize::from(body.position.x > 8.0)].push(body.velocity.length());
        }
        (deepest, speeds)
    }
    for (speed, passes) in [(2.0, false), (4.0, false), (16.0, true)] {
        let (deepest, [back, through]) = ends(speed);
        let ideal = speed * speed / (2.0 * 1.5);
        let range = |it: &[f64]| {
            it.iter()
                .fold((f64::MAX, 0.0_f64), |(a, b), v| (a.min(*v), b.max(*v)))
        };
        println!(
            "speed {speed}: {deepest:.1} deep, ideally {ideal:.1}; back {} at {:?}, through {} at {:?}",
            back.len(),
            range(&back),
            through.len(),
            range(&through)
        );
        assert_eq!(!through.is_empty(), passes);
        assert!(deepest > 0.5 * ideal && back.len() + through.len() > 300);
        // They have no speed of their own, as those have that are replaced.
        let (least, most) = range(&[back, through].concat());
        assert!(most > 1.8 && most - least > 1.0);
    }
}

#[test]
fn scenes_at_the_edge_of_what_is_possible_are_simulated() {
    let count = |scene: &Scene, frame: u32| {
        let mut simulation = Simulation::new(scene).unwrap();
        let contacts = simulation.contacts(0..=frame).unwrap();
        let light = simulation.light(f64::from(frame) + 0.5).unwrap();
        for element in &light {
            let numbers = match element {
                LightElement::Ball { center, light, .. } => [*center, *light, DVec3::ZERO],
                LightElement::Streak { ends, light, .. } => [ends[0], ends[1], *light],
            };
            assert!(numbers.iter().all(|it| it.is_finite()), "{element:?}");
        }
        (contacts.len(), light.len())
    };
    // No wave, no collider, no particle, one particle.
    assert_eq!(
        count(&Scene::new(Camera::new(4.0 * DVec3::X, DVec3::ZERO)), 70),
        (0, 0)
    );
    let mut bare = base();
    bare.colliders.clear();
    assert_eq!(count(&bare, 300).0, 0);
    assert!(
        (3900..=4010).contains(&count(&bare, 300).1),
        "the flight has a limit"
    );
    assert_eq!(count(&changed(|wave| wave.rate = 0.0.into()), 70), (0, 0));
    assert_eq!(
        count(&changed(|wave| wave.rate = (1.0 / 70.0).into()), 110),
        (1, 1)
    );
    // All particles at one place, at no speed, with nothing that pushes.
    assert!(count(&changed(|wave| wave.radius = 0.0), 60).0 > 600);
    assert_eq!(count(&changed(|wave| wave.speed = 0.0), 60).0, 0);
    let inert = changed(|wave| (wave.spring, wave.damper, wave.repulsion) = (0.0, 0.0, 0.0));
    assert!(count(&inert, 60).0 > 600);
    let stopped = crate::scene::Acceleration::new([0.0, 0.0], [0.0, 0.0]);
    assert!(count(&changed(|wave| wave.acceleration = stopped), 60).0 > 600);
    // Emitters in a box, on its face, and within all that lies behind a plane.
    assert_eq!(
        count(
            &changed(|wave| wave.origin = DVec3::new(8.0, 0.0, 0.0).into()),
            60
        )
        .0,
        0
    );
    let on_face = changed(|wave| {
        wave.origin = DVec3::ZERO.into();
        wave.circular = 0.5;
        wave.control = vec![ControlPoint::new(DVec3::new(-10.0, 0.0, 0.0))];
    });
    assert!(count(&on_face, 60).0 >= 1200);
    let mut buried = base();
    buried
        .colliders
        .push(Collider::plane(100.0 * DVec3::Z, DVec3::Z));
    assert!(count(&buried, 60).0 > 600);
    // Solids that share a face, and one in another.
    let mut twice = base();
    let same = twice.colliders[0].clone();
    twice.colliders.push(same);
    assert!(count(&twice, 60).0 > 600);
}

#[test]
fn a_particle_that_touches_two_solids_enters_neither() {
    // A groove of two planes, its edge along y.
    let mut scene = changed(|wave| wave.radius = 0.0);
    scene.colliders.clear();
    for normal in [DVec3::new(-1.0, 0.0, 1.0), DVec3::new(-1.0, 0.0, -1.0)] {
        scene.colliders.push(Collider::plane(DVec3::ZERO, normal));
    }
    let found = velocities(&states(&scene, 60, |_| {}));
    let worst = found
        .iter()
        .map(|it| (it.x + it.z.abs()).max(0.0))
        .fold(0.0, f64::max);
    println!(
        "{} contacts in the groove, the worst enters by {worst:e}",
        found.len()
    );
    assert!(found.len() > 600 && worst < 1e-12);
    let wide = {
        let mut scene = scene.clone();
        scene.waves[0].radius = 6.0;
        scene
    };
    assert_eq!(within(&wide, 120, Rule::CORRECTED).1, 0);
}

#[test]
fn no_solids_of_any_shape_and_place_let_particles_in() {
    let (mut hits, mut again) = (0, 0);
    for seed in 0..20 {
        // Numbers in [-1,1), one after another.
        let mut count = 0;
        let mut next = || {
            count += 1;
            let [unit, ..] = random::units(seed, count, 9, random::Purpose::Emission);
            2.0 * unit - 1.0
        };
        let mut vector = |size: f64| size * DVec3::new(next(), next(), next());
        let mut scene = base();
        scene.colliders.clear();
        for _ in 0..6 {
            let (center, half) = (vector(18.0), vector(9.0).abs() + 0.1);
            scene.colliders.push(Collider::sphere(center, half.x));
            scene.colliders.push(Collider::new(ColliderShape::Box {
                center: vector(18.0),
                half,
                rotation: (half.y > 3.0).then(|| Rotation {
                    axis: vector(1.0),
                    angle: vector(180.0).x,
                }),
            }));
        }
        let below = vector(0.1) + DVec3::Z;
        scene
            .colliders
            .push(Collider::plane(-20.0 * DVec3::Z, below));
        scene.waves.clear();
        for _ in 0..3 {
            let mut origin = vector(1.0).normalize_or(DVec3::Z) * 45.0;
            origin.z = origin.z.abs() + 10.0;
            let mut wave = EmittedWave::new(origin, vector(10.0) - origin);
            wave.radius = 8.0;
            wave.speed = vector(20.0).x.abs();
            scene.waves.push(wave);
        }
        let (_, inside) = within(&scene, 70, Rule::CORRECTED);
        assert_eq!(inside, 0, "scene {seed}");
        let contacts = Simulation::new(&scene).unwrap().contacts(0..=69).unwrap();
        hits += contacts.len();
        again += contacts.iter().filter(|it| !it.is_first).count();
    }
    println!("{hits} contacts, of which {again} are not the first of their particle");
    assert!(hits > 50_000 && again > 10_000);
}
