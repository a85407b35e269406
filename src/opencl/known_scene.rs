//! The small scenes of the self-test: what the kernels of a task are built for, and nothing else.

use glam::DVec3;

use super::kernels::{Rays, Task, Variant};
use crate::error::Result;
use crate::image::{DepthAlong, DepthImage};
use crate::scene::{
    Beam, Camera, Curve, Cylinder, Decay, ImageSize, Integration, Method, Profile, Sampling, Scene,
    Sphere, Torus,
};

/// Two tiles wide and high, with room for some that are smooth.
const SIZE: ImageSize = ImageSize {
    width: 76,
    height: 72,
};

/// One with decay and depths along the rays, one with softening and depths along the axis.
pub(super) fn known_scenes(task: Task) -> Result<[Scene; 2]> {
    let mut near = Scene::new(Camera::new(DVec3::new(0.4, -4.0, 1.7), DVec3::ZERO));
    near.decay = Some(Decay {
        alpha: 0.1,
        beta: 0.1,
    });
    let mut far = Scene::new(Camera::new(DVec3::new(-1.0, -9.0, 4.0), DVec3::ZERO));
    far.integration.softening = 0.05;
    for (scene, along) in [(&mut near, DepthAlong::Ray), (&mut far, DepthAlong::Axis)] {
        scene.image = SIZE;
        scene.integration = integration(task, scene.integration.softening);
        add_sources(scene, task.kinds, Profile::Inverse);
        if task.has_squares {
            add_sources(scene, task.kinds, Profile::InverseSquare);
        }
        if task.has_depth {
            let distance = scene.camera.eye.length();
            let depth = |index: usize| depth(index, distance);
            let values = (0..SIZE.pixels()).map(depth).collect();
            scene.depth = Some(DepthImage::new(SIZE, along, values)?);
        }
    }
    Ok([near, far])
}

/// The tolerance is the strictest that a task's kernels serve (see [`crate::pack::Rule`]), or one that float32 meets.
fn integration(task: Task, softening: f64) -> Integration {
    let tolerance = match task.method {
        Variant::Exact { nodes: ..=4, .. } => 0.1,
        Variant::Exact { .. } | Variant::Simpson => 1e-3,
    };
    Integration {
        method: match task.method {
            Variant::Simpson => Method::Simpson,
            Variant::Exact { .. } => Method::Exact,
        },
        divisions: 64,
        tolerance,
        sampling: Some(match task.rays {
            Rays::Tiles => Sampling::Tiles,
            Rays::Pixels | Rays::Listed => Sampling::Pixels,
        }),
        softening,
        ..Integration::default()
    }
}

/// A slope up to the sources, with a hole and an edge.
fn depth(index: usize, distance: f64) -> f32 {
    let (row, column) = (index / SIZE.width as usize, index % SIZE.width as usize);
    match row + column {
        ..50 => (distance * (0.8 + 0.004 * row as f64 + 0.002 * column as f64)) as f32,
        50..70 => f32::INFINITY,
        _ => (1.1 * distance) as f32,
    }
}

/// One source of each of some kinds, in the order of [`Task::kinds`].
fn add_sources(scene: &mut Scene, kinds: [bool; 5], profile: Profile) {
    let place = match profile {
        Profile::Inverse => DVec3::new(0.3, 0.2, 0.1),
        Profile::InverseSquare => DVec3::new(-0.4, 0.5, -0.2),
    };
    let [has_spheres, has_cylinders, has_beams, has_tori, has_curves] = kinds;
    if has_spheres {
        scene.spheres.push(Sphere {
            center: place,
            color: DVec3::new(1.0, 0.5, 0.2),
            profile,
            ..Sphere::default()
        });
    }
    if has_cylinders {
        scene.cylinders.push(Cylinder {
            point: 2.0 * place,
            color: DVec3::new(0.2, 1.0, 0.4),
            profile,
            ..Cylinder::new(DVec3::new(1.0, 0.3, 0.4))
        });
    }
    if has_beams {
        scene.beams.push(Beam {
            tip: -place,
            cap_coefficient: Some(0.7),
            color: DVec3::new(0.5, 0.2, 1.0),
            profile,
            ..Beam::new(DVec3::new(-1.0, 0.2, 0.6))
        });
    }
    if has_tori {
        scene.tori.push(Torus {
            center: place,
            axis: DVec3::new(0.1, 0.4, 1.0),
            color: DVec3::new(0.3, 0.6, 1.0),
            profile,
            ..Torus::new(1.1)
        });
    }
    if has_curves {
        let points = [(-1.3, 0.1), (0.2, 1.4), (1.1, -0.6)];
        scene.curves.push(Curve {
            color: DVec3::new(1.0, 0.3, 0.6),
            profile,
            ..Curve::new(points.map(|(x, z)| place + DVec3::new(x, 0.3 * z, z)))
        });
    }
}
