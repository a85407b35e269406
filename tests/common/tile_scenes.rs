//! Views and sources meant to fool a test of smoothness.

use energywave::Scene;
use energywave::image::ImageSize;
use energywave::scene::{BeamEnd, Method};
use glam::DVec3;

/// No multiple of any tile, more than one of the largest.
pub const SIZE: ImageSize = ImageSize {
    width: 130,
    height: 75,
};

pub fn view(eye: [f64; 3], target: [f64; 3]) -> Scene {
    let mut scene = super::empty_scene(SIZE.width, SIZE.height);
    (scene.camera.eye, scene.camera.target) = (eye.into(), target.into());
    scene.camera.ray_length = Some(super::far_beyond_target(&scene.camera));
    scene.integration.method = Method::default();
    scene
}

pub fn usual_view() -> Scene {
    view([0.0, -4.0, 2.0], [0.0; 3])
}

/// The point that shows at a place of the image, in pixels, so far behind the projection plane as that is from the eye
/// times `depth`.
pub fn point_at(scene: &Scene, column: f64, row: f64, depth: f64) -> [f64; 3] {
    let plane = scene.view_plane();
    let on_plane = plane.first_pixel + plane.column_step * column + plane.row_step * row;
    (plane.eye + on_plane * (1.0 + depth)).to_array()
}

pub fn direction(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    (DVec3::from(to) - DVec3::from(from)).to_array()
}

const ARCH: [[f64; 3]; 3] = [[-1.0, 0.0, 0.0], [0.0, 0.3, 1.5], [1.0, 0.0, 0.0]];

/// Each with what it is.
pub fn hard_scenes() -> Vec<(&'static str, Scene)> {
    let mut scenes = Vec::new();

    let mut scene = usual_view();
    for (column, row) in [(27.0, 27.5), (40.3, 70.0), (100.0, 31.0)] {
        let center = point_at(&scene, column, row, 3.0);
        scene
            .tori
            .push(super::torus(center, [0.0, 1.0, 1.0], 0.004));
    }
    scenes.push(("rings thinner than a pixel", scene));

    let mut scene = usual_view();
    for (column, row) in [(63.5, 63.5), (119.5, 15.5), (7.5, 71.5), (80.0, 40.0)] {
        let center = point_at(&scene, column, row, 3.0);
        scene.spheres.push(super::sphere(center, 1.0));
    }
    scenes.push(("points in the corners of tiles and on a pixel", scene));

    let mut scene = usual_view();
    let corner = point_at(&scene, 63.5, 63.5, 3.0);
    let other = point_at(&scene, 127.5, 0.0, 3.5);
    scene
        .cylinders
        .push(super::cylinder(corner, direction(corner, other)));
    scenes.push(("a line through a corner of tiles", scene));

    let mut scene = view([0.0, -3.0, 0.0], [0.0; 3]);
    scene
        .tori
        .push(super::torus([0.0; 3], [0.0, 0.0, 1.0], 0.9));
    scenes.push(("a ring seen edge-on", scene));

    let mut scene = view([0.003, -3.0, 0.002], [0.0; 3]);
    scene
        .tori
        .push(super::torus([0.0; 3], [0.002, 1.0, 0.0], 0.9));
    scenes.push(("along the axis of a ring", scene));

    let mut scene = view([0.01, -2.0, 1.6], [0.0, 0.0, 0.8]);
    let series = vec![1.0, 0.9, 0.3, 0.2];
    scene.curves.push(super::curve(ARCH, Some(series)));
    scenes.push(("a jump of the intensity, from beside its sheet", scene));

    let mut scene = usual_view();
    let series = vec![0.1, 1.0, 0.2, 0.2, 1.0, 0.1, 0.6];
    let folded = [[-1.0, -0.2, 0.0], [1.6, 0.3, 0.9], [-0.8, 0.2, 0.1]];
    scene.curves.push(super::curve(folded, Some(series)));
    scenes.push(("a jump of the intensity, from outside", scene));

    let mut scene = usual_view();
    for (column, row) in [(36.0, 36.0), (39.0, 37.0), (90.0, 50.0), (90.0, 51.0)] {
        let center = point_at(&scene, column, row, 3.0);
        scene.spheres.push(super::sphere(center, 1.0));
    }
    for row in [20.0, 23.0] {
        let (left, right) = (
            point_at(&scene, 0.0, row, 3.0),
            point_at(&scene, 129.0, row + 2.0, 3.0),
        );
        scene
            .cylinders
            .push(super::cylinder(left, direction(left, right)));
    }
    scenes.push(("two cores in one tile", scene));

    // A jump of the slope where the plane through the tip passes the rays' ends.
    let mut scene = view([-3.0, -3.0, 1.0], [0.0, 0.3, 0.0]);
    scene.image = ImageSize {
        width: 256,
        height: 256,
    };
    (scene.camera.near, scene.camera.ray_length) = (0.5, Some(4.0));
    scene.decay = None;
    let mut beam = super::beam([0.1, 0.2, -0.1], [2.0, 1.0, 0.5], None);
    (beam.end, beam.sphere_coefficient) = (BeamEnd::Cap(Some(0.0)), 0.05);
    scene.beams.push(beam);
    scenes.push(("a beam without a cap", scene));

    let mut scene = usual_view();
    for (column, row) in [(-1.5, 40.0), (130.5, 3.0), (70.0, 75.7)] {
        let center = point_at(&scene, column, row, 3.0);
        scene.spheres.push(super::sphere(center, 1.0));
    }
    let (left, right) = (
        point_at(&scene, 0.0, -2.0, 3.0),
        point_at(&scene, 129.0, -1.0, 2.0),
    );
    scene
        .cylinders
        .push(super::cylinder(left, direction(left, right)));
    scenes.push(("cores just outside the image", scene));

    let mut scene = view([0.85, 0.1, 0.05], [-0.9, 0.0, 0.0]);
    (scene.camera.near, scene.camera.ray_length) = (0.02, Some(4.0));
    scene
        .tori
        .push(super::torus([0.0; 3], [0.0, 0.1, 1.0], 0.9));
    scene.curves.push(super::curve(
        [[0.9, -0.4, 0.3], [0.8, 0.0, 0.0], [0.7, 0.9, 0.4]],
        None,
    ));
    scenes.push(("a camera inside the wave", scene));

    let mut scene = view([-0.13, 0.05, 0.03], [-0.03, 0.23, 0.19]);
    (scene.camera.near, scene.camera.ray_length) = (0.13, Some(10.0));
    scene.camera.fov_y = 110.0;
    scene.curves.push(super::curve(
        [
            [0.06, -0.08, 0.03],
            [-0.09, -0.1, -0.05],
            [-0.07, 0.06, -0.1],
        ],
        Some(vec![0.75, 0.27, 0.37]),
    ));
    scenes.push(("a wide view past a core behind it", scene));

    for (name, series) in [
        ("a stripe as wide as a short curve", vec![1.0, 0.2, 1.0]),
        ("a short curve with dark ends", vec![0.0, 1.0, 0.0]),
    ] {
        let mut scene = usual_view();
        scene.image.height = 130;
        let points = [88.0, 90.5, 93.0].map(|column| point_at(&scene, column, 20.0, 3.0));
        scene.curves.push(super::curve(points, Some(series)));
        scenes.push((name, scene));
    }

    for softening in [0.002, 0.03, 0.4] {
        let mut scene = usual_view();
        scene.integration.softening = softening;
        scene.spheres.push(super::sphere([0.4, 0.3, 0.5], 1.5));
        let (axis, radius) = ([0.1, 0.2, 2.0], 0.9);
        scene.tori.push(super::torus([0.0; 3], axis, radius));
        scene.curves.push(super::curve(ARCH, None));
        scenes.push(("softened cores", scene));
    }

    let mut scene = super::full_scene(SIZE.width, SIZE.height);
    scene.integration.method = Method::default();
    // No pixel looks at the origin, where two curves end.
    scene.camera.target = DVec3::new(0.05, 0.02, 0.03);
    scene.decay = None;
    scenes.push(("every kind, without decay", scene));
    scenes
}
