//! The small scene of the self-test: what the kernels of a task are built for, and nothing else.

use glam::DVec3;

use super::kernels::{Rays, Task, Variant};
use crate::error::Result;
use crate::image::{DepthAlong, DepthImage};
use crate::scene::{
    Beam, Camera, Curve, Cylinder, Decay, ImageSize, Integration, Method, Profile, Sampling, Scene,
    Sphere, Torus,
};

const SIZE: ImageSize = ImageSize {
    width: 24,
    height: 16,
};

pub(super) fn known_scene(task: Task, integration: &Integration) -> Result<Scene> {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.4, -4.0, 1.7), DVec3::ZERO));
    scene.image = SIZE;
    scene.decay = Some(Decay {
        alpha: 0.1,
        beta: 0.1,
    });
    scene.integration = Integration {
        method: match task.method {
            Variant::Simpson => Method::Simpson,
            Variant::Exact { .. } => Method::Exact,
        },
        divisions: 64,
        tolerance: integration.tolerance,
        sampling: Some(match task.rays {
            Rays::Tiles => Sampling::Tiles,
            Rays::Pixels | Rays::Listed => Sampling::Pixels,
        }),
        ..Integration::default()
    };
    add_sources(&mut scene, task.kinds, Profile::Inverse);
    if task.has_squares {
        add_sources(&mut scene, task.kinds, Profile::InverseSquare);
    }
    if task.has_depth {
        let behind = |index: usize| 2.5 + 0.1 * (index % SIZE.width as usize) as f32;
        let values = (0..SIZE.pixels()).map(behind).collect();
        scene.depth = Some(DepthImage::new(SIZE, DepthAlong::Ray, values)?);
    }
    Ok(scene)
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
