//! Depths of clip space: what a rasteriser leaves in its depth buffer ends rays where they meet its surfaces, by every
//! sort of projection.

use crate::common::engines::{Engine, SIZE, engine};
use crate::common::{self, difference, meets, renderer};
use energywave::image::{ClipDepth, DepthAlong, DepthImage};
use energywave::scene::{Method, Sampling, Torus};
use energywave::{Scene, reference};
use fastrand::Rng;
use glam::{DVec2, DVec3};

/// How far a depth may be off, as a share of the ray's; float32 depths between planes hold no more.
const OFF: f64 = 1e-5;

/// Surfaces lie no farther than so many times the near plane: float32 holds few depths beyond.
const FARTHEST: f64 = 30.0;

/// A plane across the view and a ball before it, in the space of an engine's camera.
struct Surfaces {
    center: DVec3,
    radius: f64,
    wall: DVec3,
    normal: DVec3,
}

impl Surfaces {
    /// Places them where float32 can tell depths; the wall hides half of the picture.
    fn before(engine: &Engine) -> Self {
        let plane = engine.scene().view_plane();
        let reach = if plane.is_parallel {
            4.0
        } else {
            FARTHEST * plane.near
        };
        let side = DVec2::new(SIZE.width.into(), SIZE.height.into());
        let at = |place: DVec2, ahead: f64| {
            let steps = plane.column_step * place.x + plane.row_step * place.y;
            let growth = if plane.is_parallel {
                1.0
            } else {
                ahead / plane.near
            };
            let across = plane.first_pixel + steps - plane.forward * plane.near;
            plane.eye + plane.forward * ahead + across * growth
        };
        let ahead = plane.near + 0.4 * reach;
        let pixel = (at(side * 0.5, ahead) - at(side * 0.5 - DVec2::X, ahead)).length();
        Self {
            center: at(0.4 * side, ahead),
            radius: (4.0 * pixel).min(0.2 * reach),
            wall: at(0.5 * side, plane.near + 0.9 * reach),
            normal: (plane.forward + 0.3 * plane.column_step.normalize()).normalize(),
        }
    }

    /// Returns the first point of a line from a point on that lies on them; the wall ends at the picture's middle.
    fn met(&self, from: DVec3, direction: DVec3, has_wall: bool) -> Option<DVec3> {
        let to_center = self.center - from;
        let nearest = to_center.dot(direction);
        let half2 = self.radius.powi(2) - (to_center - direction * nearest).length_squared();
        if half2 > 0.0 {
            return Some(from + direction * (nearest - half2.sqrt()));
        }
        let ahead = (self.wall - from).dot(self.normal) / direction.dot(self.normal);
        (has_wall && ahead > 0.0).then(|| from + direction * ahead)
    }
}

/// What a rasteriser has for each pixel: the depth in its buffer, as NDC, and the point there.
fn rasterised(engine: &Engine, surfaces: &Surfaces) -> Vec<(f32, Option<DVec3>)> {
    let clip = ClipDepth::new(engine.projection, engine.range).unwrap();
    let matrix = engine.projection * engine.view;
    let pixels = (0..SIZE.height).flat_map(|row| (0..SIZE.width).map(move |column| (column, row)));
    let pixel = |(column, row): (u32, u32)| {
        let place = DVec2::new(column.into(), row.into());
        let (from, to) = (engine.point_at(place, 0.0), engine.point_at(place, 0.5));
        let met = surfaces.met(from, (to - from).normalize(), column < 12);
        let depth = met.map_or(clip.far_depth(), |point| matrix.project_point3(point).z);
        (depth as f32, met)
    };
    pixels.map(pixel).collect()
}

/// Returns how far the ends of rays are from the surfaces, at most, as shares of the depth.
fn worst(scene: &Scene, expected: &[(f32, Option<DVec3>)]) -> f64 {
    let plane = scene.view_plane();
    let depth = scene.depth.as_ref().unwrap();
    let mut worst: f64 = 0.0;
    for (index, (_, met)) in expected.iter().enumerate() {
        let value = depth.as_slice()[index];
        let Some(point) = met else {
            assert_eq!(value, f32::INFINITY, "a cleared pixel hides something");
            continue;
        };
        let ray = plane.ray(index as u32 % SIZE.width, index as u32 / SIZE.width);
        let end = ray.at(plane.end(&ray, value, depth.along()));
        let from = if plane.is_parallel {
            ray.origin
        } else {
            plane.eye
        };
        let whole = point.distance(from).max(plane.near.abs());
        worst = worst.max(end.distance(*point) / whole);
    }
    worst
}

#[test]
fn rays_end_where_a_rasteriser_met_a_surface() {
    let mut random = Rng::with_seed(21);
    for round in 0..56 {
        let engine = engine(&mut random, round % 14);
        let surfaces = Surfaces::before(&engine);
        let expected = rasterised(&engine, &surfaces);
        assert!(expected.iter().filter(|(_, met)| met.is_none()).count() > 50);
        let mut scene = engine.scene();
        scene.camera.ray_length = Some(1e3);
        let clip = scene.camera.matrices.unwrap().clip_depth().unwrap();
        let values: Vec<f32> = expected.iter().map(|(depth, _)| *depth).collect();
        let image = DepthImage::from_clip(SIZE, DepthAlong::Ndc, &clip, values.clone()).unwrap();
        scene.depth = Some(image);
        let found = worst(&scene, &expected);
        assert!(found <= OFF, "{}: {found}", engine.name);

        let low = clip.range().low() as f32;
        let held = values
            .iter()
            .map(|value| (value - low) / (1.0 - low))
            .collect();
        let image = DepthImage::from_clip(SIZE, DepthAlong::Buffer, &clip, held).unwrap();
        scene.depth = Some(image);
        let found = worst(&scene, &expected);
        assert!(found <= 3.0 * OFF, "{}: {found}", engine.name); // rounded once more

        // Behind another near plane the same depths are elsewhere.
        let mut other = engine.projection;
        other.w_axis.z += 0.1
            * (if clip.is_orthographic() {
                1.0
            } else {
                other.w_axis.z
            });
        let clip = ClipDepth::new(other, Some(clip.range())).unwrap();
        let wrong = values.iter().map(|value| value.clamp(low, 1.0)).collect();
        scene.depth = Some(DepthImage::from_clip(SIZE, DepthAlong::Ndc, &clip, wrong).unwrap());
        let is_far = |(depth, met): &(f32, Option<DVec3>)| met.is_none() || *depth >= 1.0;
        if !expected.iter().any(is_far) || !clip.is_orthographic() {
            let found = worst(&scene, &expected);
            assert!(found > 1e3 * OFF, "{}: {found}", engine.name);
        }
    }
}

#[test]
fn a_picture_behind_them_is_that_of_the_reference() {
    let mut random = Rng::with_seed(22);
    let mut renderer = renderer(common::device().lanes, "");
    for sort in [2, 5, 10] {
        let engine = engine(&mut random, sort);
        let surfaces = Surfaces::before(&engine);
        let mut scene = engine.scene();
        scene.integration.method = Method::Exact {
            tolerance: 1e-3,
            sampling: Sampling::Tiles,
        };
        scene.tori.push(Torus {
            center: surfaces.center,
            ..Torus::new(2.0 * surfaces.radius)
        });
        let open = renderer.render(&scene).unwrap();
        let values = rasterised(&engine, &surfaces)
            .into_iter()
            .map(|(depth, _)| depth);
        let clip = scene.camera.matrices.unwrap().clip_depth().unwrap();
        let image = DepthImage::from_clip(SIZE, DepthAlong::Ndc, &clip, values.collect()).unwrap();
        scene.depth = Some(image);
        let drawn = renderer.render(&scene).unwrap();
        let found = difference(&drawn, &reference::render(&scene).unwrap());
        assert!(meets(&found, 1e-3), "{}: {found:?}", engine.name);
        assert!(
            difference(&open, &drawn).max > 0.1,
            "{}: nothing is hidden",
            engine.name
        );
    }
}
