//! Whether any source is where rays may meet its core: a field reaches everywhere, but glows next to its core.

use super::Scene;
use super::source::Core;
use crate::error::SceneError;

/// Why the core of a source is in no ray's way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unseen {
    Behind,
    BeforePlane,
    Beyond,
}

impl Scene {
    /// Says that no core is where a ray might meet it: then at most the glow around cores is seen.
    pub(super) fn out_of_view(&self) -> Option<SceneError> {
        let plane = self.view_plane();
        let (forward, eye) = (plane.forward, plane.eye.dot(plane.forward));
        let reach = plane.farthest_pixel(self.image) + plane.ray_length;
        let unseen = |core: &Core| match core.reach(forward) - eye {
            ahead if ahead <= plane.near.min(0.0) => Some(Unseen::Behind),
            ahead if ahead < plane.near => Some(Unseen::BeforePlane),
            _ if core.least_distance(plane.eye) > reach => Some(Unseen::Beyond),
            _ => None,
        };
        let mut first: Option<(String, Unseen)> = None;
        let mut is_mixed = false;
        let mut is_seen = false;
        self.all_sources(&mut |source| {
            if source.light == (0.0, 0.0) {
                return true;
            }
            match (unseen(&source.core), &first) {
                (None, _) => is_seen = true,
                (Some(why), None) => first = Some((source.key(), why)),
                (Some(why), Some((_, before))) => is_mixed |= why != *before,
            }
            !is_seen
        });
        let (key, why) = first.filter(|_| !is_seen)?;
        let (length, has_matrices) = (plane.ray_length, self.camera.matrices.is_some());
        let (place, advice) = match why {
            _ if is_mixed => (
                "behind the projection plane or beyond the end of the rays".to_owned(),
                match has_matrices {
                    true => "see to camera.view, camera.near and camera.ray_length",
                    false => "see to camera.eye, camera.target, camera.near and camera.ray_length",
                },
            ),
            Unseen::Behind => (
                "behind the eye".to_owned(),
                match has_matrices {
                    true => "turn the camera, by camera.view",
                    false => "turn the camera, by camera.target",
                },
            ),
            Unseen::BeforePlane => (
                format!(
                    "between the eye and the projection plane, where rays begin (camera.near = {})",
                    plane.near
                ),
                "make camera.near smaller",
            ),
            Unseen::Beyond => (
                format!("beyond the end of the rays (camera.ray_length = {length})"),
                "make camera.ray_length larger",
            ),
        };
        let message = format!(
            "lies {place}, as all sources do: at most the glow around them is seen, and the picture may be black; \
             {advice}"
        );
        Some(SceneError::value(key, message))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::warnings::tests::{expect, scene, sphere};
    use super::*;
    use crate::scene::{Beam, Cylinder, Segment, Sphere, Torus};

    #[test]
    fn cores_behind_the_eye_or_beyond_the_rays_are_told_and_those_in_view_are_not() {
        let with = |change: &dyn Fn(&mut Scene)| {
            let mut scene = scene();
            change(&mut scene);
            scene
        };
        let x = DVec3::X;
        expect(
            &with(&|it| it.spheres.push(sphere(-5.0))),
            "sphere[0]",
            "behind the eye, as all",
        );
        expect(
            &with(&|it| it.spheres.push(sphere(-3.5))),
            "sphere[0]",
            "make camera.near smaller",
        );
        expect(
            &with(&|it| it.spheres.push(sphere(20.0))),
            "sphere[0]",
            "beyond the end of the rays",
        );
        let mixed = with(&|it| {
            it.spheres.push(sphere(-5.0));
            it.tori.push(Torus {
                center: DVec3::new(0.0, 50.0, 0.0),
                ..Torus::new(1.0)
            });
        });
        expect(&mixed, "sphere[0]", "or beyond the end");
        let back = DVec3::new(0.0, -6.0, 0.0);
        expect(
            &with(&|it| {
                it.beams.push(Beam {
                    tip: back,
                    ..Beam::new(-DVec3::Y)
                })
            }),
            "beam[0]",
            "behind the eye",
        );
        expect(
            &with(&|it| {
                it.cylinders.push(Cylinder {
                    point: back,
                    ..Cylinder::new(x)
                })
            }),
            "cylinder[0]",
            "behind the eye",
        );
        expect(
            &with(&|it| it.segments.push(Segment::new(back, back + x))),
            "segment[0]",
            "behind the eye",
        );
        expect(
            &with(&|it| {
                it.tori.push(Torus {
                    center: back,
                    ..Torus::new(1.0)
                })
            }),
            "torus[0]",
            "behind the eye",
        );
        for seen in [
            with(&|it| it.spheres.push(sphere(0.0))),
            with(&|it| it.spheres.extend([sphere(-5.0), sphere(50.0), sphere(3.0)])),
            with(&|it| {
                it.beams.push(Beam {
                    tip: back,
                    ..Beam::new(DVec3::Y)
                })
            }),
            with(&|it| {
                it.cylinders.push(Cylinder {
                    point: back,
                    ..Cylinder::new(x + DVec3::Y)
                })
            }),
            with(&|it| it.segments.push(Segment::new(back, -back))),
            with(&|it| {
                it.tori.push(Torus {
                    center: back,
                    ..Torus::new(4.0)
                })
            }),
            with(&|it| {
                it.spheres.extend([
                    Sphere {
                        coefficient: 0.0,
                        ..sphere(-5.0)
                    },
                    sphere(0.0),
                ])
            }),
        ] {
            assert_eq!(seen.warnings(), [], "{seen:?}");
        }
    }
}
