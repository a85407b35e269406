//! Responses, and scenes at the edge of what is possible.

use super::*;

#[test]
fn what_accelerates_lets_particles_in_and_pushes_them_out() {
    let scene = changed(|wave| {
        wave.response = Response::Accelerate;
        wave.speed = 4.0;
        wave.acceleration = crate::scene::Acceleration::new([1.5, 0.0], [1.5, 0.0]);
    });
    let all = states(&scene, 200, |_| {});
    let last = all.last().unwrap();
    let deepest = all.iter().flat_map(|it| &it.bodies);
    let deepest = deepest.map(|body| body.position.x).fold(0.0, f64::max);
    let (mut through, mut back) = (0.0, 0.0);
    for body in last
        .bodies
        .iter()
        .filter(|body| body.phase == Phase::Circular)
    {
        match body.position.x > 8.0 {
            true => through += 1.0,
            false => back += 1.0,
        }
    }
    let share = through / (through + back);
    println!(
        "as deep as {deepest}; {share} of {} are through",
        through + back
    );
    // Measured with another program: 64 % pass at this speed.
    assert!(deepest > 16.0 && (0.45..0.8).contains(&share));
    let slow = changed(|wave| {
        wave.response = Response::Accelerate;
        wave.speed = 2.0;
    });
    let all = states(&slow, 100, |_| {});
    let out = all
        .last()
        .unwrap()
        .bodies
        .iter()
        .filter(|it| it.phase == Phase::Circular);
    let speeds: Vec<f64> = out.map(|it| it.velocity.length()).collect();
    let most = speeds.iter().copied().fold(0.0, f64::max);
    assert!(speeds.len() > 100 && most > 3.0 && most < 12.0, "{most}");
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
        count(&Scene::new(Camera::new(DVec3::X, DVec3::ZERO)), 70),
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
