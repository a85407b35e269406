//! Cameras of engines, by every sort of projection that glam makes.

use energywave::Scene;
use energywave::image::{ClipDepth, ClipRange, ImageSize};
use energywave::scene::{Antialias, Camera};
use fastrand::Rng;
use glam::dcamera as camera;
use glam::{DMat4, DVec2, DVec3};

/// The size of their pictures.
pub const SIZE: ImageSize = ImageSize {
    width: 24,
    height: 16,
};

/// A view, a projection, and what was said of it where the matrix cannot tell.
pub struct Engine {
    pub name: &'static str,
    pub view: DMat4,
    pub projection: DMat4,
    pub range: Option<ClipRange>,
    pub y_is_down: bool,
    pub near: f64,
}

impl Engine {
    pub fn camera(&self) -> Camera {
        match self.range {
            Some(range) => Camera::from_clip(self.view, self.projection, range),
            None => Camera::from_matrices(self.view, self.projection),
        }
    }

    pub fn scene(&self) -> Scene {
        let mut scene = Scene::new(self.camera());
        scene.image = SIZE;
        scene.integration.antialias = Antialias::None;
        scene
    }

    /// Returns column and row of a point, 0 in the middle of the first pixel, as glam projects it.
    pub fn place_of(&self, point: DVec3) -> DVec2 {
        let ndc = self
            .projection
            .project_point3(self.view.transform_point3(point));
        let down = if self.y_is_down { ndc.y } else { -ndc.y };
        let size = DVec2::new(SIZE.width.into(), SIZE.height.into());
        0.5 * (DVec2::new(ndc.x, down) + 1.0) * size - 0.5
    }

    /// Returns the point at a place of the picture, at a share of the way from the near plane to the far one.
    pub fn point_at(&self, place: DVec2, share: f64) -> DVec3 {
        let back = (self.projection * self.view).inverse();
        let size = DVec2::new(SIZE.width.into(), SIZE.height.into());
        let clip = 2.0 * (place + 0.5) / size - 1.0;
        let y = if self.y_is_down { clip.y } else { -clip.y };
        let depth = ClipDepth::new(self.projection, self.range).unwrap();
        let near = if depth.is_reversed() {
            1.0
        } else {
            depth.range().low()
        };
        let ndc = near + share * (depth.far_depth() - near);
        back.project_point3(DVec3::new(clip.x, y, ndc))
    }
}

/// An engine's camera somewhere, by one of fourteen sorts of projection.
pub fn engine(random: &mut Rng, sort: usize) -> Engine {
    let mut number = |from: f64, to: f64| from + (to - from) * random.f64();
    let mut point = |reach: f64| DVec3::from([0; 3].map(|_| number(-reach, reach)));
    let (eye, target, up) = (point(50.0), point(5.0), point(1.0));
    let (near, far) = (number(0.05, 1.0), number(20.0, 500.0));
    let (fov, aspect) = (number(0.3, 1.8), number(0.7, 2.0));
    let (left, right) = (-number(0.2, 1.0), number(0.2, 1.0));
    let (bottom, top) = (-number(0.2, 1.0), number(0.2, 1.0));
    let rh = camera::rh::view::look_at_mat4(eye, target, up);
    let lh = camera::lh::view::look_at_mat4(eye, target, up);
    let gl = Some(ClipRange::MinusOneToOne);
    let side = 20.0;
    let (l, r, b, t) = (side * left, side * right, side * bottom, side * top);
    let (l1, r1, b1, t1) = (near * left, near * right, near * bottom, near * top);
    use camera::lh::proj as lhp;
    use camera::rh::proj as rhp;
    let (name, view, projection, range) = match sort {
        0 => (
            "rh",
            rh,
            rhp::directx::perspective(fov, aspect, near, far),
            None,
        ),
        1 => (
            "lh",
            lh,
            lhp::directx::perspective(fov, aspect, near, far),
            None,
        ),
        2 => (
            "gl",
            rh,
            rhp::opengl::perspective(fov, aspect, near, far),
            gl,
        ),
        3 => (
            "vulkan",
            rh,
            rhp::vulkan::perspective(fov, aspect, near, far),
            None,
        ),
        4 => (
            "infinite",
            rh,
            rhp::directx::perspective_infinite(fov, aspect, near),
            None,
        ),
        5 => (
            "reversed",
            rh,
            rhp::directx::perspective_infinite_reverse(fov, aspect, near),
            None,
        ),
        6 => (
            "reversed lh",
            lh,
            lhp::vulkan::perspective_infinite_reverse(fov, aspect, near),
            None,
        ),
        7 => (
            "reversed finite",
            rh,
            rhp::directx::perspective(fov, aspect, far, near),
            None,
        ),
        8 => (
            "off-centre",
            rh,
            rhp::directx::frustum(l1, r1, b1, t1, near, far),
            None,
        ),
        9 => (
            "off-centre gl",
            lh,
            lhp::opengl::frustum(l1, r1, b1, t1, near, far),
            gl,
        ),
        10 => (
            "orthographic",
            rh,
            rhp::directx::orthographic(l, r, b, t, near, far),
            None,
        ),
        11 => (
            "orthographic lh",
            lh,
            lhp::directx::orthographic(l, r, b, t, near, far),
            None,
        ),
        12 => (
            "orthographic gl",
            rh,
            rhp::opengl::orthographic(l, r, b, t, near, far),
            None,
        ),
        _ => (
            "orthographic reversed",
            rh,
            rhp::vulkan::orthographic(l, r, b, t, far, near),
            None,
        ),
    };
    let y_is_down = matches!(sort, 3 | 6 | 13..);
    Engine {
        name,
        view,
        projection,
        range,
        y_is_down,
        near,
    }
}
