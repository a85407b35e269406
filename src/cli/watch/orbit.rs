//! A camera that is turned about what it looks at.

use energywave::Scene;
use energywave::glam::{DQuat, DVec3};

/// How far from straight above or below the view stays, radians.
const LEAST_ANGLE: f64 = 0.02;

/// A turn about the camera's target, and a step towards it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// To the right about the direction that is up, radians.
    pub around: f64,
    /// Upwards, radians.
    pub over: f64,
    /// What the distance is multiplied with.
    pub distance: f64,
}

impl Default for Orbit {
    fn default() -> Self {
        Self {
            around: 0.0,
            over: 0.0,
            distance: 1.0,
        }
    }
}

impl Orbit {
    /// Turns the camera of a scene, unless that is one of matrices. Depths are those of another view then: nothing
    /// hides light.
    pub fn turn(&self, scene: &mut Scene) {
        if *self == Self::default() || scene.camera.matrices.is_some() {
            return;
        }
        let camera = &mut scene.camera;
        camera.eye = camera.target + self.turned(camera.eye - camera.target, camera.up);
        scene.depth = None;
    }

    fn turned(&self, arm: DVec3, up: DVec3) -> DVec3 {
        let up = up.normalize_or(DVec3::Z);
        let arm = DQuat::from_axis_angle(up, self.around) * arm;
        let from_up = arm.angle_between(up);
        let wanted = (from_up - self.over).clamp(LEAST_ANGLE, std::f64::consts::PI - LEAST_ANGLE);
        let right = up.cross(arm).normalize_or(DVec3::X);
        self.distance * (DQuat::from_axis_angle(right, wanted - from_up) * arm)
    }
}

#[cfg(test)]
mod tests {
    use energywave::scene::Camera;

    use super::*;

    fn eye(orbit: Orbit) -> DVec3 {
        let mut scene = Scene::new(Camera::new(
            DVec3::new(3.0, 0.0, 1.0),
            DVec3::new(1.0, 0.0, 1.0),
        ));
        orbit.turn(&mut scene);
        scene.camera.eye
    }

    #[test]
    fn the_eye_goes_around_over_and_closer_and_stops_above() {
        let none = Orbit::default();
        let quarter = std::f64::consts::FRAC_PI_2;
        let is_at = |orbit: Orbit, place: [f64; 3]| {
            let found = eye(orbit);
            assert!(
                found.distance(place.into()) < 0.05,
                "{found}, not {place:?}"
            );
        };
        is_at(none, [3.0, 0.0, 1.0]);
        is_at(
            Orbit {
                around: quarter,
                ..none
            },
            [1.0, 2.0, 1.0],
        );
        for over in [quarter, 5.0] {
            is_at(Orbit { over, ..none }, [1.0, 0.0, 3.0]);
        }
        is_at(
            Orbit {
                over: -quarter / 2.0,
                distance: 0.5,
                ..none
            },
            [1.0 + 0.5_f64.sqrt(), 0.0, 1.0 - 0.5_f64.sqrt()],
        );
    }
}
