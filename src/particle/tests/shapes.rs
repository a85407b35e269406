//! The light that particles give off.

use super::*;

/// The light of elements, by the profile (1 - d/h)^2 integrated over space.
fn held(elements: &[LightElement]) -> f64 {
    let ball = |radius: f64| 2.0 * std::f64::consts::PI * radius.powi(3) / 15.0;
    let of = |element: &LightElement| match element {
        LightElement::Ball { radius, light, .. } => light.x * ball(*radius),
        LightElement::Streak { ends, radii, light } => {
            // A streak in thin slices across it, each pi h^2/6, and half a ball at each end.
            const SLICES: u32 = 1000;
            let length = (ends[1] - ends[0]).length();
            let slice = |index: u32| {
                let place = 2.0 * (f64::from(index) + 0.5) / f64::from(SLICES);
                let radius = match place < 1.0 {
                    true => radii[0] + (radii[1] - radii[0]) * place,
                    false => radii[1] + (radii[2] - radii[1]) * (place - 1.0),
                };
                std::f64::consts::PI * radius * radius / 6.0 * length / f64::from(SLICES)
            };
            let slices: f64 = (0..SLICES).map(slice).sum();
            light.x * (0.5 * (ball(radii[0]) + ball(radii[2])) + slices)
        }
    };
    elements.iter().map(of).sum()
}

#[test]
fn streaks_hold_the_light_of_the_sprites_whose_place_they_take() {
    let light = |shape: ParticleShape, continuous: f64| {
        let scene = changed(|wave| {
            (wave.shape, wave.continuous, wave.coefficient) = (shape, continuous, 0.5);
        });
        Simulation::new(&scene).unwrap().light(70.0).unwrap()
    };
    for continuous in [0.0, 0.3, 1.0] {
        let streaks = light(ParticleShape::Streaks, continuous);
        let sprites = light(ParticleShape::Sprites, continuous);
        let (one, other) = (held(&streaks), held(&sprites));
        println!(
            "{} streaks and balls hold {one}, {} balls {other}",
            streaks.len(),
            sprites.len()
        );
        assert!((one / other - 1.0).abs() < 1e-5 && sprites.len() > 6 * streaks.len());
    }
}

#[test]
fn rods_and_threads_are_as_long_and_as_thick_as_they_say() {
    let elements = |change: fn(&mut EmittedWave)| {
        let scene = changed(|wave| {
            wave.rate = (1.0 / 70.0).into();
            change(wave);
        });
        Simulation::new(&scene).unwrap().light(110.0).unwrap()
    };
    let LightElement::Streak { ends, radii, .. } = elements(|wave| wave.continuous = 0.0)[0] else {
        panic!("no rod");
    };
    assert!(((ends[1] - ends[0]).length() - 2.0 * 11.0 * 0.4).abs() < 1e-9);
    assert!((radii[0] / 1.2 - 6.5 / 12.0).abs() < 1e-12 && radii[1] == 1.2 && radii[2] == radii[0]);
    let LightElement::Streak { ends, radii, .. } = elements(|wave| wave.continuous = 1.0)[0] else {
        panic!("no thread");
    };
    assert!(ends[0].x.abs() < 1e-12 && ends[1].x < -1.0);
    assert_eq!(radii, [1.2, 0.6 * 1.2, 0.2 * 1.2]);
    let grains = elements(|wave| (wave.continuous, wave.samples) = (0.0, 1));
    assert!(matches!(
        grains[..],
        [LightElement::Ball { radius: 1.2, .. }]
    ));
    let balls = elements(|wave| {
        (wave.continuous, wave.shape) = (0.0, ParticleShape::Sprites);
    });
    let places: Vec<DVec3> = balls
        .iter()
        .map(|it| match it {
            LightElement::Ball { center, .. } => *center,
            LightElement::Streak { .. } => panic!("no ball"),
        })
        .collect();
    let sides = [0.0, 1.0, 2.0, 3.0].map(|steps| 0.4 * steps);
    for (index, far) in sides.into_iter().enumerate() {
        assert!(((places[index] - places[0]).length() - far).abs() < 1e-9);
    }
    assert!((places[1] - places[0]).dot(places[2] - places[0]) < 0.0);
}
