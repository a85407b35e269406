//! Control points, and what moves.

use super::*;

#[test]
fn arms_end_at_their_control_points() {
    let points = [
        DVec3::new(-40.0, 50.0, 10.0),
        DVec3::new(-20.0, -45.0, 35.0),
    ];
    let scene = changed(|wave| {
        wave.circular = 0.0;
        wave.control = points.map(ControlPoint::new).to_vec();
        wave.control[1].probability = 0.25;
    });
    // The wave flies along x, so that its right is -y.
    let ends = points.map(|it| DVec3::new(it.x, -it.y, it.z));
    let mut counts = [0.0_f64; 2];
    let mut worst: f64 = 0.0;
    for state in states(&scene, 200, |_| {}) {
        let now = f64::from(state.frame);
        for body in state
            .bodies
            .iter()
            .filter(|body| body.phase == Phase::Irregular)
        {
            assert!(body.until >= now);
            if body.until == now {
                let far = ends.map(|end| (body.position - end).length());
                counts[usize::from(far[1] < far[0])] += 1.0;
                worst = worst.max(far[0].min(far[1]));
            }
        }
    }
    let share = counts[1] / (counts[0] + counts[1]);
    println!(
        "{counts:?} arms, the worst ends {worst:e} beside its point; {share} of them at the second"
    );
    assert!(counts[0] > 1000.0 && worst < 1e-9 && (share - 0.2).abs() < 0.04);
}

#[test]
fn control_points_move_and_scatter() {
    let track = Track::new([(0.0, DVec3::ZERO), (2.0, DVec3::new(-60.0, 0.0, 0.0))]);
    let scene = changed(|wave| {
        wave.circular = 0.0;
        wave.control = vec![ControlPoint::new(track).with_range(DVec3::new(0.0, 3.0, 0.0))];
    });
    let mut sides: Vec<f64> = Vec::new();
    for state in states(&scene, 150, |_| {}) {
        let (now, frame) = (f64::from(state.frame), 1.0 / 60.0);
        for body in state
            .bodies
            .iter()
            .filter(|it| it.phase == Phase::Irregular && it.until == now)
        {
            // It was 40 frames, and the one of the contact, ago that it hit.
            let expected = -30.0 * (now - 41.0) * frame;
            assert!((body.position.x - expected).abs() < 1e-9);
            assert!(body.position.y.abs() <= 3.0 && body.position.z.abs() < 1e-9);
            sides.push(body.position.y);
        }
    }
    assert!(sides.iter().any(|it| *it > 2.5) && sides.iter().any(|it| *it < -2.5));
}

#[test]
fn shapes_change_no_position() {
    let positions = |change: fn(&mut EmittedWave)| -> Vec<DVec3> {
        let scene = changed(|wave| {
            wave.acceleration = crate::scene::Acceleration::new([2.0, 1.0], [2.0, 1.0]);
            change(wave);
        });
        let particles = Simulation::new(&scene).unwrap().particles(70).unwrap();
        particles.into_iter().map(|it| it.position).collect()
    };
    let plain = positions(|_| {});
    assert_eq!(positions(|wave| wave.samples = 1), plain);
    assert_eq!(positions(|wave| wave.roundness = 0.1), plain);
    assert_eq!(positions(|wave| wave.continuous = 1.0), plain);
    assert_eq!(positions(|wave| wave.shape = ParticleShape::Sprites), plain);
    assert_eq!(
        positions(|wave| wave.mixture = vec![crate::scene::Mixture::new(0.5, 3, 1.0)]),
        plain
    );
    assert_ne!(positions(|wave| wave.repulsion = 3.9), plain);
}

#[test]
fn emitters_move_and_pulse() {
    let scene = changed(|wave| {
        let way = [
            (0.0, DVec3::new(-50.0, -10.0, 0.0)),
            (1.0, DVec3::new(-50.0, 10.0, 0.0)),
        ];
        wave.origin = Track::new(way).into();
        wave.rate = Track::new([(0.0, 30.0), (0.5, 0.0)]).into();
        wave.radius = 0.0;
    });
    let contacts = Simulation::new(&scene).unwrap().contacts(0..=100).unwrap();
    // 30, 29, .. 0 a frame.
    assert_eq!(contacts.len(), 465);
    for contact in contacts {
        let begun = (contact.frame - 25.0).floor() / 60.0;
        assert!((contact.point.y - (20.0 * begun - 10.0)).abs() < 1e-9);
    }
}
