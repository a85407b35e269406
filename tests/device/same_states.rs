//! Waves that hit triangles, on one device and on two: the same states of all particles, and the same pictures.

use energywave::particle::Simulation;
use energywave::scene::{Camera, Collider, EmittedWave, SimulationSettings};
use energywave::{Renderer, Scene};
use glam::DVec3;

use crate::common;
use crate::common::apart::apart;
use crate::several_devices::{POCL_DEVICES, draw, on};

/// A wave that hits a ball of triangles.
fn wave_at_a_mesh(seed: u32) -> Scene {
    let mut scene = common::empty_scene(72, 54);
    let mut wave = EmittedWave::new(DVec3::new(-30.0, 0.0, 0.0), DVec3::X);
    wave.samples = 5;
    scene.waves.push(wave);
    let mut mesh = common::meshes::ball(8);
    mesh.scale = 8.0;
    scene.colliders.push(Collider::mesh(mesh));
    scene.camera = Camera::new(DVec3::new(-40.0, -60.0, 20.0), DVec3::ZERO);
    let mut settings = SimulationSettings::default();
    settings.seed = seed;
    scene.simulation = Some(settings);
    scene
}

/// A number that differs if any bit of a particle does, in any frame up to the last that is drawn.
fn hash_of_states(renderer: &mut Renderer, scene: &Scene) -> (u64, Vec<Vec<f32>>) {
    let mut simulation = Simulation::new(scene).unwrap();
    let (mut hash, mut pictures) = (0_u64, Vec::new());
    for frame in [60, 12, 45, 59] {
        let mut shown = scene.clone();
        shown.simulation.as_mut().unwrap().time = Some(f64::from(frame));
        pictures.push(draw(renderer, &shown, 0));
        for particle in simulation.particles(frame).unwrap() {
            let hit = particle.hit.unwrap_or(DVec3::MAX);
            for vector in [particle.position, particle.velocity, hit] {
                for number in vector.to_array() {
                    hash = (hash ^ number.to_bits()).wrapping_mul(0x0100_0000_01b3);
                    hash = hash.rotate_left(23);
                }
            }
        }
    }
    (hash, pictures)
}

#[test]
fn a_wave_that_hits_a_mesh_has_the_same_states_on_one_device_and_on_two() {
    apart(&[POCL_DEVICES], || {
        let scene = wave_at_a_mesh(3);
        let expected = hash_of_states(&mut on(1), &scene);
        assert!(expected.1.iter().flatten().any(|value| *value > 0.5));
        assert!(hash_of_states(&mut on(2), &scene) == expected);
        let other = hash_of_states(&mut on(2), &wave_at_a_mesh(4));
        assert!(other.0 != expected.0 && other.1 != expected.1);
    });
}
