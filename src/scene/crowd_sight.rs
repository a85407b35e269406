//! How a crowd of points is seen: the axes of the image, a square grid of pixels around it, and which points are part
//! of the crowd.

use glam::DVec3;

use super::{Crowd, Method, Points, Profile, Reduction, Scene, Segment, Sphere};
use crate::error::{Error, Result};
use crate::image::ImageSize;

/// A point of more than this share of a crowd's light is not part of it.
pub(super) const SHARE_OF_ONE: f64 = 1.0 / 500.0;

/// The highest cells have at most this width, as a slope; and so many levels there are at most.
const WIDEST: f64 = 0.4;
const MOST_LEVELS: u32 = 7;

/// Cells of the highest level in a row, and how many of them an image may have: points beyond the cells are then far
/// from all pixels.
const ACROSS: [(u32, u32); 2] = [(8, 4), (16, 12)];

/// Of narrow lenses lower cells are the highest, if of so many points that are asked one in so many is beside them.
const ASKED: usize = 1000;
const PER_ONE_BESIDE: usize = 64;

/// Cells up to this wide need no depths, a slope: rays begin no nearer or farther from one side to the other.
const WIDTH_WITHOUT_DEPTH: f64 = 0.016;

/// From so far before the plane where rays begin to so far behind it, in its distances from the eye, points are drawn
/// by themselves, as far as they are seen: their light changes fast with their depth. What is nearer still is smooth.
const BEFORE_PLANE: f64 = 0.6;
pub(crate) const NEAREST: f64 = 1.2;

/// So many points are slow where each is drawn by itself.
const MANY: usize = 10_000;

/// Below this tolerance float32 has no digits to spare.
const LEAST_TOLERANCE: f64 = 5e-5;

/// The eye, the axes of the image, and a grid of pixels: a square of highest cells, each of `8 * 2^top` pixels
/// a side.
#[derive(Debug, Clone)]
pub(crate) struct CrowdSight {
    pub eye: DVec3,
    pub right: DVec3,
    pub down: DVec3,
    pub forward: DVec3,
    /// Slope at the corner of the grid, and from a pixel to the next.
    pub first: [f64; 2],
    pub step: [f64; 2],
    pub near: f64,
    pub ray_length: f64,
    /// The highest level, and how many of its cells are in a row.
    pub top: u32,
    pub across: u32,
    /// Where in the grid the image begins, pixels.
    pub left: u32,
    pub above: u32,
    pub image: ImageSize,
}

impl CrowdSight {
    /// # Errors
    /// [`Error::Unsupported`] for a camera, or an image, that has no such grid.
    pub(crate) fn new(scene: &Scene) -> Result<Self> {
        let refuse = |what: &str| Error::Unsupported(format!("crowds of points: {what}"));
        let plane = scene.view_plane();
        let (right, down) = (plane.column_step.normalize(), plane.row_step.normalize());
        let leans = |a: DVec3, b: DVec3| a.dot(b).abs() > 1e-6;
        if plane.is_parallel {
            return Err(refuse("rays are parallel"));
        }
        if leans(right, down) || leans(right, plane.forward) || leans(down, plane.forward) {
            return Err(refuse("the projection has a shear"));
        }
        let step = [plane.column_step, plane.row_step].map(|step| step.length() / plane.near);
        let is_narrow = |top: &u32| f64::from(8_u32 << top) * step[0].max(step[1]) <= WIDEST;
        let top = (0..=MOST_LEVELS).rev().find(is_narrow);
        let top = top.ok_or_else(|| refuse("pixels are too wide"))?;
        let ImageSize { width, height } = scene.image;
        let first = |axis: DVec3, step: f64, begin: u32| {
            plane.first_pixel.dot(axis) / plane.near - step * (f64::from(begin) + 0.5)
        };
        let grid = |top: u32| {
            let is_wide_enough = |(_, most): &&(u32, u32)| width.max(height) <= (most * 8) << top;
            let (across, _) = *ACROSS.iter().find(is_wide_enough)?;
            let middle = (across * 4) << top;
            let [left, above] = [width, height].map(|size| (middle - size.div_ceil(2)) & !7);
            Some(Self {
                eye: plane.eye,
                first: [first(right, step[0], left), first(down, step[1], above)],
                right,
                down,
                forward: plane.forward,
                step,
                near: plane.near,
                ray_length: plane.ray_length,
                top,
                across,
                left,
                above,
                image: scene.image,
            })
        };
        // Of a narrow lens lower ones take less memory and time, where hardly a point is beside their grid.
        let crowd = || scene.points.iter().filter(|it| it.may_be_crowd());
        let is_enough =
            |it: &Self| it.across == ACROSS[0].0 && crowd().all(|points| it.holds(points));
        let least = (0..top).filter_map(grid).find(is_enough);
        let grid = least.or_else(|| grid(top));
        grid.ok_or_else(|| refuse("the image is too wide"))
    }
}

impl CrowdSight {
    /// Returns whether hardly a point is beside the grid, as far as some of them tell. Those that are take time.
    fn holds(&self, points: &Points) -> bool {
        let count = points.points.len();
        let step = count.div_ceil(ASKED).max(1);
        let side = f64::from((8 * self.across) << self.top);
        let is_beside = |index: &usize| {
            let [x, y, z] = self.seen(points.points.position(*index));
            let is_within = |place: f64, axis: usize| {
                (0.0..side).contains(&((place / z - self.first[axis]) / self.step[axis]))
            };
            !(z > 0.0 && is_within(x, 0) && is_within(y, 1))
        };
        let beside = (0..count).step_by(step).filter(is_beside).count();
        beside * PER_ONE_BESIDE <= count.div_ceil(step)
    }

    /// Returns the lowest level whose cells need depths, where tiles look at so many of them on each side by their
    /// sources.
    pub(crate) fn base(&self, block: u32) -> u32 {
        let pixel = (self.step[0] * self.step[1]).sqrt();
        let widest = WIDTH_WITHOUT_DEPTH * 3.0 / f64::from(2 * block + 1);
        let is_deep = |level: &u32| f64::from(8_u32 << level) * pixel > widest;
        (0..self.top).find(is_deep).unwrap_or(self.top)
    }

    /// Returns where a point is as the eye sees it: right, down and ahead.
    #[inline]
    pub(crate) fn seen(&self, point: DVec3) -> [f64; 3] {
        let way = point - self.eye;
        [
            way.dot(self.right),
            way.dot(self.down),
            way.dot(self.forward),
        ]
    }

    /// Returns whether depths from one to another are about where rays begin.
    pub(super) fn meets_plane(&self, nearest: f64, farthest: f64) -> bool {
        nearest < NEAREST * self.near && farthest >= BEFORE_PLANE * self.near
    }

    /// Returns whether a point, as the eye sees it, is where rays begin that are seen, or near there.
    pub(crate) fn is_at_plane(&self, [x, y, z]: [f64; 3]) -> bool {
        let is_there = |place: f64, first: f64, step: f64, begin: u32, size: u32| {
            let pixel = (place / z - first) / step - f64::from(begin);
            let margin = f64::from(8_u32 << self.top);
            (-margin..f64::from(size) + margin).contains(&pixel)
        };
        let ImageSize { width, height } = self.image;
        self.meets_plane(z, z)
            && is_there(x, self.first[0], self.step[0], self.left, width)
            && is_there(y, self.first[1], self.step[1], self.above, height)
    }
}

/// Points as sources of their own.
#[derive(Debug, Default)]
pub(super) struct Apart {
    pub spheres: Vec<Sphere>,
    pub segments: Vec<Segment>,
}

impl Points {
    /// Returns whether they may be part of a crowd. Of `1/d^2` cores of the single points would show that light that is
    /// spread is taken of; what `1/sqrt(d^2 + radius^2)` is spread over has no end.
    fn may_be_crowd(&self) -> bool {
        let is_part =
            !self.is_spread() || self.points.has_trails() || self.profile == Profile::Smeared;
        is_part
            && self.reach.is_none()
            && self.points.least_light() * self.coefficient >= 0.0
            && self.coefficient >= 0.0
            && (self.points.has_lights() || self.color.min_element() >= 0.0)
    }

    /// Returns whether some of them may be around the plane where rays begin.
    pub(super) fn is_around_plane(&self, sight: &CrowdSight) -> bool {
        let (low, high) = self.points.bounds();
        let (low, high) = (low - sight.eye, high - sight.eye);
        let (one, other) = (low * sight.forward, high * sight.forward);
        let [nearest, farthest] = [one.min(other), one.max(other)].map(DVec3::element_sum);
        let around = self.greatest_spread();
        sight.meets_plane(nearest - around, farthest + around)
    }

    /// Returns the light of all, and of the brightest: of each the brightest channel.
    fn total(&self) -> (f64, f64) {
        let (sum, most) = self.points.total_light();
        let of_all = match self.points.has_lights() {
            true => self.coefficient,
            false => self.coefficient * self.color.max_element(),
        };
        (of_all * sum, of_all * most)
    }
}

impl Scene {
    /// Returns the light of the brightest channel above which a point is not part of the crowd of a profile.
    pub(crate) fn crowd_limit(&self, profile: Profile) -> f64 {
        let crowd = self
            .points
            .iter()
            .filter(|it| it.crowd_profile() == profile);
        SHARE_OF_ONE * crowd.map(|it| it.total().0).sum::<f64>()
    }

    /// Adds those of its points as sources of their own that are brighter than the limit of their crowd, or where rays
    /// begin.
    fn add_points_apart(&self, sight: &CrowdSight, apart: &mut Apart) {
        for points in self.points.iter() {
            let limit = self.crowd_limit(points.crowd_profile());
            let (is_near, is_bright) = (points.is_around_plane(sight), points.total().1 > limit);
            if !is_near && !is_bright {
                continue;
            }
            for index in 0..points.points.len() {
                let is_bright = is_bright && points.light(index).max_element() > limit;
                if is_bright || is_near && points.is_at_plane(index, sight) {
                    points.add_apart(index, apart);
                }
            }
        }
    }

    /// Returns whether points may be drawn as crowds at all.
    fn allows_crowds(&self) -> bool {
        let integration = &self.integration;
        let is_exact = matches!(integration.method, Method::Exact { tolerance, .. } if tolerance >= LEAST_TOLERANCE);
        let is_plain = integration.softening == 0.0 && integration.reduction == Reduction::Sum;
        let may = integration.crowd == Crowd::Auto && is_exact && is_plain;
        may && self.fading().is_none() && CrowdSight::new(self).is_ok()
    }

    /// Returns the first table of many points that are no crowd and were to be one, and how many they are.
    pub(super) fn many_points_apart(&self) -> Option<(usize, usize)> {
        let is_wanted = self.integration.crowd == Crowd::Auto;
        let may_be = self.allows_crowds();
        let is_slow = |it: &Points| it.points.len() >= MANY && !(may_be && it.may_be_crowd());
        let index = self.points.iter().position(|it| is_wanted && is_slow(it))?;
        Some((index, self.points[index].points.len()))
    }

    /// Returns the scene with those of its points as sources of their own that are not part of a crowd: all, unless
    /// `has_crowds` allows others and the scene does; `None`: there are none.
    pub(crate) fn with_crowds(&self, has_crowds: bool) -> Option<Self> {
        let has_crowds = has_crowds && self.allows_crowds();
        let sight = has_crowds.then(|| CrowdSight::new(self).ok()).flatten();
        let is_crowd = |it: &&Points| it.may_be_crowd() && sight.is_some();
        let (crowd, apart): (Vec<&Points>, Vec<&Points>) = self.points.iter().partition(is_crowd);
        let mut added = Apart::default();
        for points in &apart {
            (0..points.points.len()).for_each(|index| points.add_apart(index, &mut added));
        }
        let is_all = apart.iter().all(|it| it.points.is_empty());
        let mut scene = Self {
            points: crowd.into_iter().cloned().collect(),
            ..self.clone()
        };
        if let Some(sight) = &sight {
            scene.add_points_apart(sight, &mut added);
        }
        if is_all && added.spheres.is_empty() && added.segments.is_empty() {
            return None;
        }
        scene.spheres.extend(added.spheres);
        scene.segments.extend(added.segments);
        Some(scene)
    }
}
