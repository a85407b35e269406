//! Colliders of triangles against those whose surface is a formula. Colliders without the place before what is hit have
//! to fail the same assertion.

use super::*;
use crate::scene::{Mesh, TriangleList};

const CUBE: [[u32; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

/// A box of triangles along the axes of the world; inside out, if it is told so.
fn cube(center: DVec3, half: DVec3, is_turned: bool) -> Mesh {
    let corner = |index: u32| {
        let side = |axis: u32| f64::from(index >> axis & 1) * 2.0 - 1.0;
        center + half * DVec3::new(side(0), side(1), side(2))
    };
    let triangles = CUBE
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    let turned = triangles.map(|[a, b, c]| if is_turned { [a, c, b] } else { [a, b, c] });
    Mesh::new(TriangleList::new((0..8).map(corner).collect(), turned.collect()).unwrap())
}

/// A cube whose faces are cut into squares that are blown up to a sphere about the origin.
fn ball(radius: f64, cuts: u32) -> Mesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let unit = cube(DVec3::ZERO, DVec3::ONE, false);
    for face in CUBE {
        let [a, b, _, d] = face.map(|corner| unit.triangles.vertices()[corner as usize]);
        let first = vertices.len() as u32;
        for index in 0..(cuts + 1) * (cuts + 1) {
            let part = |it: u32| f64::from(it) / f64::from(cuts);
            let place = a + part(index % (cuts + 1)) * (b - a) + part(index / (cuts + 1)) * (d - a);
            // Corners that faces share are to be the same to the bit.
            let place = (place * 1e6).round() / 1e6;
            vertices.push(radius * place.normalize());
        }
        for index in 0..cuts * cuts {
            let corner = first + index / cuts * (cuts + 1) + index % cuts;
            let across = corner + cuts + 1;
            triangles.push([corner, corner + 1, across + 1]);
            triangles.push([corner, across + 1, across]);
        }
    }
    Mesh::new(TriangleList::new(vertices, triangles).unwrap())
}

fn with(scene: &Scene, colliders: impl IntoIterator<Item = Collider>) -> Scene {
    let mut scene = scene.clone();
    scene.colliders = colliders.into_iter().collect();
    scene
}

#[test]
fn a_box_of_triangles_is_hit_where_a_box_is() {
    let (center, half) = (8.0 * DVec3::X, DVec3::new(8.0, 22.0, 22.0));
    let mut scene = base();
    scene.waves[0].radius = 30.0; // some fly past
    scene.waves[0].rate = 100.0.into();
    let contacts = |collider: Collider| {
        let mut simulation = Simulation::new(&with(&scene, [collider])).unwrap();
        simulation.contacts(0..=79).unwrap()
    };
    let expected = contacts(Collider::new_box(center, half));
    for is_turned in [false, true] {
        let found = contacts(Collider::mesh(cube(center, half, is_turned)));
        assert!(
            found.len() == expected.len() && found.len() > 2000,
            "{}",
            found.len()
        );
        let mut worst = 0.0_f64;
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(found.particle, expected.particle);
            assert!(found.normal == expected.normal && found.speed == expected.speed);
            worst = worst.max((found.point - expected.point).length());
            worst = worst.max((found.frame - expected.frame).abs());
        }
        println!("{} contacts, the worst differs by {worst:e}", found.len());
        assert!(worst < 1e-11);
    }
}

#[test]
fn a_ball_of_triangles_is_hit_where_a_ball_is_up_to_its_facets() {
    const RADIUS: f64 = 20.0;
    let mut scene = base();
    scene.waves[0].radius = 18.0;
    scene.waves[0].rate = 400.0.into();
    let contacts = |collider: Collider| {
        let mut simulation = Simulation::new(&with(&scene, [collider])).unwrap();
        let all = simulation.contacts(0..=59).unwrap();
        all.into_iter().filter(|it| it.is_first).collect::<Vec<_>>()
    };
    let expected = contacts(Collider::sphere(DVec3::ZERO, RADIUS));
    // An edge of a facet spans at most a quarter turn by so many.
    for (cuts, depth) in [(8_u32, 0.5), (32, 0.03)] {
        let found = contacts(Collider::mesh(ball(RADIUS, cuts)));
        let mut others = expected
            .iter()
            .map(|it| (it.particle, it))
            .collect::<std::collections::BTreeMap<_, _>>();
        let (mut worst, mut turned) = (0.0_f64, 0.0_f64);
        for contact in &found {
            let inside = RADIUS - contact.point.length();
            assert!((-1e-9..depth).contains(&inside), "{inside}");
            if let Some(other) = others.remove(&contact.particle) {
                worst = worst.max((contact.point - other.point).length());
                turned = turned.max(contact.normal.distance(other.normal));
            }
        }
        println!(
            "{} of {}: points within {worst:.4}, normals within {turned:.4}",
            found.len(),
            expected.len()
        );
        // Those that have flown 18 from the axis meet the ball at a slope of 1 in 2.
        assert!(found.len() > 5000 && worst < 3.0 * depth && turned < 3.0 / f64::from(cuts));
        assert!(found.len().abs_diff(expected.len()) < expected.len() / 100);
    }
}

/// How many particles there were, and how many times one was within a ball of triangles in a beam.
fn within_ball(spoil: impl FnOnce(&mut Laws)) -> (u64, usize) {
    let mut scene = base();
    scene.waves[0].radius = 15.0;
    scene.waves[0].rate = 300.0.into();
    // A bowl of balls: what flies off one hits others, and itself never.
    let ball = ball(12.0, 12);
    let moved = |x: f64, y: f64| Mesh {
        translate: DVec3::new(x, y, 0.0),
        ..ball.clone()
    };
    let together = moved(0.0, 0.0).triangles;
    let both = |lists: [Mesh; 2]| {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for mesh in lists {
            let first = vertices.len() as u32;
            vertices.extend(
                mesh.triangles
                    .vertices()
                    .iter()
                    .map(|it| *it + mesh.translate),
            );
            triangles.extend(
                mesh.triangles
                    .triangles()
                    .iter()
                    .map(|it| it.map(|corner| corner + first)),
            );
        }
        Mesh::new(TriangleList::new(vertices, triangles).unwrap())
    };
    assert!(together.is_closed());
    let pair = both([moved(0.0, 14.0), moved(0.0, -14.0)]);
    let scene = with(
        &scene,
        [Collider::mesh(pair), Collider::mesh(moved(-4.0, 0.0))],
    );
    let solids: Vec<_> = scene.colliders.iter().map(Solid::new).collect();
    let all = states(&scene, 70, spoil);
    let bodies = all.iter().flat_map(|state| state.alive().map(|it| it.0));
    // Triangles lie within the balls.
    let centers = [
        DVec3::new(0.0, 14.0, 0.0),
        DVec3::new(0.0, -14.0, 0.0),
        -4.0 * DVec3::X,
    ];
    let near = bodies.filter(|body| centers.iter().any(|it| it.distance(body.position) < 12.0));
    let inside = near.filter(|body| solids.iter().any(|it| it.distance(body.position) < -1e-9));
    let inside = inside.count();
    (all.last().unwrap().emitted[0].count, inside)
}

#[test]
fn none_is_ever_within_a_closed_mesh() {
    let (count, inside) = within_ball(|_| {});
    println!("{count} particles, {inside} times one was within");
    assert!(count > 20_000 && inside == 0);
    // By where steps end alone, many are; and some where rounding decides on which side of a facet they are put.
    let (_, stepped) = within_ball(|laws| laws.sweeps = false);
    let (_, rounded) = within_ball(|laws| laws.clearance = 0.0);
    println!("{stepped} by steps, {rounded} where particles are put to where they hit");
    assert!(stepped > 100);
}

#[test]
fn what_is_within_a_closed_mesh_stays_there() {
    let mut scene = with(&base(), [Collider::mesh(ball(20.0, 8))]);
    scene.waves[0].origin = DVec3::ZERO.into();
    scene.waves[0].lifetime = 100.0;
    let all = states(&scene, 120, |_| {});
    let last = all.last().unwrap();
    let farthest = last
        .alive()
        .map(|(body, _)| body.position.length())
        .fold(0.0, f64::max);
    println!("the farthest of {} is {farthest} away", last.bodies.len());
    assert!(last.bodies.len() > 1500 && farthest <= 20.0);
    let contacts = Simulation::new(&scene).unwrap().contacts(0..=119).unwrap();
    assert!(contacts.iter().any(|it| !it.is_first));
}

#[test]
fn distances_to_a_mesh_are_those_to_its_form() {
    let (center, half) = (DVec3::new(1.0, -2.0, 3.0), DVec3::new(2.0, 3.0, 4.0));
    let formula = Solid::new(&Collider::new_box(center, half));
    let mesh = Solid::new(&Collider::mesh(cube(center, half, true)));
    let mut worst = 0.0_f64;
    for id in 0..2000 {
        let [x, y, z, _] = random::units(7, id, 0, random::Purpose::Emission);
        let point = 12.0 * (DVec3::new(x, y, z) - 0.5);
        worst = worst.max((formula.distance(point) - mesh.distance(point)).abs());
    }
    println!("distances within {worst:e}");
    assert!(worst < 1e-12);
}

#[test]
fn a_hollow_of_triangles_pushes_from_all_its_sides() {
    // A groove whose edge is along y, hit right there.
    let corners = [-1.0, 1.0].into_iter().flat_map(|y| {
        let y = 30.0 * y;
        [
            DVec3::new(-30.0, y, 30.0),
            DVec3::new(0.0, y, 0.0),
            DVec3::new(-30.0, y, -30.0),
        ]
    });
    let triangles = vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    let groove = Mesh::new(TriangleList::new(corners.collect(), triangles).unwrap());
    let mut scene = with(&base(), [Collider::mesh(groove)]);
    scene.waves[0].radius = 0.0;
    let found = velocities(&states(&scene, 60, |_| {}));
    let worst = found
        .iter()
        .map(|it| it.x + it.z.abs())
        .fold(f64::MIN, f64::max);
    println!(
        "{} contacts in the groove, the worst enters by {worst:e}",
        found.len()
    );
    assert!(found.len() > 600 && worst < 1e-12);
    let fault = {
        scene.waves[0].response = Response::Accelerate;
        scene.validate().unwrap_err().to_string()
    };
    assert!(
        fault.contains("wave[0].response") && fault.contains("is open"),
        "{fault}"
    );
}

#[test]
fn frames_with_meshes_are_the_same_in_any_order() {
    let mut scene = crowded();
    scene.colliders.push(Collider::mesh(ball(6.0, 6)));
    let laws = Laws::new(&scene);
    let expected: Vec<u64> = states(&scene, 60, |_| {}).iter().map(hash).collect();
    let mut history = history::History::new(laws.waves.len());
    for frame in [60, 3, 59, 31, 32] {
        assert_eq!(hash(history.at(&laws, frame)), expected[frame as usize - 1]);
    }
    let other = crowded();
    assert_ne!(
        hash(states(&other, 60, |_| {}).last().unwrap()),
        expected[59]
    );
}
