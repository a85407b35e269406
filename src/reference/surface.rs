//! Surfaces of metaballs in float64, by another method than the kernels': the summed field is sampled 256 times a
//! radius wherever a ray meets any, and where it crosses the threshold the interval is halved. Also maxima between
//! samples are sought where they come close to the threshold.

use glam::DVec3;

use crate::error::Result;
use crate::image::{DepthAlong, DepthImage};
use crate::scene::{
    AMBIENT, LAMP, MetaballKernel, MetaballShading, Metaballs, Scene, SeenSurfaces, ViewPlane,
};
use crate::threads;

/// Samples in a radius.
const SAMPLES: f64 = 256.0;

/// A maximum between samples is sought where they come within this share of the threshold: a sample misses less.
const CLOSE: f64 = 1e-3;

/// Halvings of an interval, down to what float64 tells apart.
const HALVINGS: u32 = 60;

/// Rays across and down in a square of which the particles near it are listed once.
const SQUARE: usize = 16;

/// What a ray finds of a surface.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceRay {
    /// From where depths begin to the surface, world units; infinite: it is not met.
    pub length: f64,
    /// Out of the surface, of length 1.
    pub normal: DVec3,
    /// The greatest field that the ray meets, or where it meets the surface the greatest of the hump that it enters.
    pub most: f64,
}

impl SurfaceRay {
    const NONE: Self = Self {
        length: f64::INFINITY,
        normal: DVec3::ZERO,
        most: 0.0,
    };
}

/// A particle as a field in float64.
#[derive(Debug, Clone, Copy)]
struct Ball {
    center: DVec3,
    radius: f64,
    weight: f64,
}

/// A ray from where depths begin.
#[derive(Debug, Clone, Copy)]
struct Line {
    begin: DVec3,
    direction: DVec3,
}

/// The stretch of a ray within a ball's radius.
#[derive(Debug, Clone, Copy)]
struct Chord {
    ball: Ball,
    enter: f64,
    leave: f64,
}

fn balls(metaballs: &Metaballs) -> Vec<Ball> {
    let list = &metaballs.points;
    let ball = |(index, position): (usize, &DVec3)| {
        let size = list.sizes().map(|sizes| sizes[index]);
        Ball {
            center: position + metaballs.translate,
            radius: size.map_or(metaballs.radius, |size| size.radius),
            weight: size.map_or(1.0, |size| size.weight),
        }
    };
    list.positions().iter().enumerate().map(ball).collect()
}

impl Ball {
    fn field(&self, kernel: MetaballKernel, place: DVec3) -> f64 {
        let share = place.distance(self.center) / self.radius;
        let left = match kernel {
            _ if share >= 1.0 => 0.0,
            MetaballKernel::Smooth => (1.0 - share * share).powi(3),
            MetaballKernel::Cone => (1.0 - share).powi(2),
        };
        self.weight * left
    }

    fn gradient(&self, kernel: MetaballKernel, place: DVec3) -> DVec3 {
        let from = place - self.center;
        let (distance, h) = (from.length(), self.radius);
        if distance >= h || distance == 0.0 {
            return DVec3::ZERO;
        }
        let slope = match kernel {
            MetaballKernel::Smooth => {
                -6.0 * distance / (h * h) * (1.0 - distance * distance / (h * h)).powi(2)
            }
            MetaballKernel::Cone => -2.0 / h * (1.0 - distance / h),
        };
        self.weight * slope / distance * from
    }
}

/// A ray and the balls that it meets.
struct Passage<'a> {
    line: Line,
    kernel: MetaballKernel,
    threshold: f64,
    /// In the order in which they are entered.
    chords: &'a [Chord],
}

impl Passage<'_> {
    fn at(&self, s: f64) -> DVec3 {
        self.line.begin + s * self.line.direction
    }

    fn field(&self, s: f64) -> f64 {
        let place = self.at(s);
        let meets = self
            .chords
            .iter()
            .filter(|chord| chord.enter <= s && s <= chord.leave);
        meets
            .map(|chord| chord.ball.field(self.kernel, place))
            .sum()
    }

    /// Finds where the field reaches the threshold, between a place before that and one after it.
    fn crossing(&self, mut before: f64, mut after: f64) -> f64 {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (before + after);
            match self.field(middle) >= self.threshold {
                true => after = middle,
                false => before = middle,
            }
        }
        after
    }

    /// Finds the maximum of a hump, by thirds: its place, and the field there.
    fn maximum(&self, mut low: f64, mut high: f64) -> (f64, f64) {
        for _ in 0..HALVINGS {
            let third = (high - low) / 3.0;
            match self.field(low + third) < self.field(high - third) {
                true => low += third,
                false => high -= third,
            }
        }
        let place = 0.5 * (low + high);
        (place, self.field(place))
    }

    /// Returns the first place where the threshold is reached, and the greatest field up to there.
    fn first(&self) -> (Option<f64>, f64) {
        let mut most = self.field(0.0);
        if most >= self.threshold {
            return (Some(0.0), most);
        }
        let mut begin = 0.0;
        let mut next = 0;
        while next < self.chords.len() {
            // A stretch in which some field is met everywhere.
            let from = self.chords[next].enter.max(begin);
            let (mut to, mut step) = (from, f64::INFINITY);
            while next < self.chords.len() && self.chords[next].enter <= to {
                to = to.max(self.chords[next].leave);
                step = step.min(self.chords[next].ball.radius / SAMPLES);
                next += 1;
            }
            let (found, greatest) = self.first_between(from, to, step);
            most = most.max(greatest);
            if found.is_some() {
                return (found, most);
            }
            begin = to;
        }
        (None, most)
    }

    fn first_between(&self, from: f64, to: f64, step: f64) -> (Option<f64>, f64) {
        let count = ((to - from) / step).ceil().max(1.0) as u64;
        let place = |number: u64| from + (to - from) * number as f64 / count as f64;
        let (mut before, mut field) = (0.0, self.field(from));
        let mut most = field;
        for number in 1..=count {
            let next = self.field(place(number));
            if next >= self.threshold {
                return (
                    Some(self.crossing(place(number - 1), place(number))),
                    most.max(next),
                );
            }
            let is_hump = number > 1 && field >= before && field >= next;
            if is_hump && self.threshold - field < CLOSE * self.threshold {
                let (top, greatest) = self.maximum(place(number - 2), place(number));
                most = most.max(greatest);
                if greatest >= self.threshold {
                    return (Some(self.crossing(place(number - 2), top)), most);
                }
            }
            most = most.max(next);
            (before, field) = (field, next);
        }
        (None, most)
    }

    fn trace(&self) -> SurfaceRay {
        let (found, mut most) = self.first();
        let Some(length) = found else {
            return SurfaceRay {
                most,
                ..SurfaceRay::NONE
            };
        };
        // On to the top of the hump.
        let step = self
            .chords
            .iter()
            .map(|chord| chord.ball.radius)
            .fold(f64::INFINITY, f64::min)
            / SAMPLES;
        let mut place = length;
        let mut field = self.field(place);
        loop {
            let next = self.field(place + step);
            if next <= field {
                most = most.max(self.maximum((place - step).max(0.0), place + step).1);
                break;
            }
            (place, field) = (place + step, next);
        }
        let place = self.at(length);
        let gradient: DVec3 = self
            .chords
            .iter()
            .map(|chord| chord.ball.gradient(self.kernel, place))
            .sum();
        SurfaceRay {
            length,
            normal: -gradient.normalize_or_zero(),
            most,
        }
    }
}

/// Returns the ray of a place of a grid, from where depths begin.
fn line(plane: &ViewPlane, column: usize, row: usize) -> Line {
    let ray = plane.ray(column as u32, row as u32);
    let direction = ray.span.normalize();
    let before = plane.before_plane(ray.origin - plane.eye);
    Line {
        begin: ray.origin - before * direction,
        direction,
    }
}

/// Returns the balls that may meet the rays of a square, by its middle ray and its corners.
fn near_square(balls: &[Ball], middle: Line, corners: &[Line]) -> Vec<Ball> {
    let apart = |get: fn(&Line) -> DVec3| {
        let distances = corners
            .iter()
            .map(|corner| get(corner).distance(get(&middle)));
        distances.fold(0.0, f64::max)
    };
    let (begins, directions) = (apart(|line| line.begin), apart(|line| line.direction));
    let is_near = |ball: &&Ball| {
        let to = ball.center - middle.begin;
        let beside = (to - to.dot(middle.direction) * middle.direction).length();
        beside <= 1.001 * (ball.radius + begins + directions * (to.length() + ball.radius))
    };
    balls.iter().filter(is_near).copied().collect()
}

/// Traces a ray to a surface of some balls.
fn trace(metaballs: &Metaballs, balls: &[Ball], line: Line, chords: &mut Vec<Chord>) -> SurfaceRay {
    chords.clear();
    for ball in balls {
        let to = ball.center - line.begin;
        let middle = to.dot(line.direction);
        let half2 = ball.radius * ball.radius - (to - middle * line.direction).length_squared();
        let half = half2.max(0.0).sqrt();
        if half > 0.0 && middle + half > 0.0 {
            chords.push(Chord {
                ball: *ball,
                enter: (middle - half).max(0.0),
                leave: middle + half,
            });
        }
    }
    chords.sort_by(|a, b| a.enter.total_cmp(&b.enter));
    let passage = Passage {
        line,
        kernel: metaballs.kernel,
        threshold: metaballs.threshold,
        chords,
    };
    passage.trace()
}

/// Traces the rays of a grid, so many across a pixel, to a surface; by rows from the top left.
#[doc(hidden)]
#[must_use]
pub fn surface_rays(scene: &Scene, metaballs: &Metaballs, across: u32) -> Vec<SurfaceRay> {
    let (grid, plane) = scene.ray_grid(across);
    let (width, height) = (grid.width as usize, grid.height as usize);
    let (columns, rows) = (width.div_ceil(SQUARE), height.div_ceil(SQUARE));
    let balls = balls(metaballs);
    let mut squares = vec![SurfaceRay::NONE; columns * rows * SQUARE * SQUARE];
    threads::for_each_chunk(&mut squares, SQUARE * SQUARE, |square, found| {
        let (left, top) = (square % columns * SQUARE, square / columns * SQUARE);
        let line = |column: usize, row: usize| line(&plane, left + column, top + row);
        let last = SQUARE - 1;
        let corners = [line(0, 0), line(last, 0), line(0, last), line(last, last)];
        let near = near_square(&balls, line(SQUARE / 2, SQUARE / 2), &corners);
        let mut chords = Vec::new();
        for (index, ray) in found.iter_mut().enumerate() {
            let (column, row) = (index % SQUARE, index / SQUARE);
            if left + column < width && top + row < height {
                *ray = trace(metaballs, &near, line(column, row), &mut chords);
            }
        }
    });
    let place = |index: usize| {
        let (column, row) = (index % width, index / width);
        let square = row / SQUARE * columns + column / SQUARE;
        square * SQUARE * SQUARE + row % SQUARE * SQUARE + column % SQUARE
    };
    (0..width * height)
        .map(|index| squares[place(index)])
        .collect()
}

/// Returns the radiance of a surface with a normal.
fn shade(metaballs: &Metaballs, normal: DVec3, plane: &ViewPlane) -> DVec3 {
    match metaballs.shading {
        MetaballShading::Normals => 0.5 * (normal + 1.0) * metaballs.color,
        MetaballShading::Lit => {
            let (right, down) = (plane.column_step.normalize(), plane.row_step.normalize());
            let lamp = LAMP.x * right + LAMP.y * down + LAMP.z * plane.forward;
            let facing = normal.dot(lamp.normalize()).max(0.0);
            (AMBIENT + (1.0 - AMBIENT) * facing) * metaballs.color
        }
    }
}

/// Finds all surfaces of a scene along the rays of its picture, exactly, whatever their method.
pub(crate) fn see_surfaces(scene: &Scene) -> Result<SeenSurfaces> {
    let across = scene.rays_across();
    let (grid, plane) = scene.ray_grid(across);
    let along = scene
        .depth
        .as_ref()
        .map_or(DepthAlong::Ray, |depth| match depth.along() {
            DepthAlong::Ray => DepthAlong::Ray,
            _ => DepthAlong::Axis,
        });
    let width = grid.width as usize;
    let given = |index: usize| match &scene.depth {
        None => f32::INFINITY,
        Some(depth) => {
            let step = width / depth.size().width as usize;
            let (column, row) = (index % width, index / width);
            depth.as_slice()[row / step * depth.size().width as usize + column / step]
        }
    };
    let mut depths: Vec<f32> = (0..grid.pixels()).map(given).collect();
    let mut colors = vec![DVec3::ZERO; grid.pixels()];
    for metaballs in scene.metaballs.iter() {
        let rays = surface_rays(scene, metaballs, across);
        for (index, ray) in rays.iter().enumerate() {
            let to_plane = plane.before_plane(
                plane
                    .ray((index % width) as u32, (index / width) as u32)
                    .origin
                    - plane.eye,
            );
            let limit = plane.distance(depths[index], along, to_plane);
            if ray.length < limit {
                // A depth of 1 stands for this distance.
                depths[index] = (ray.length / plane.distance(1.0, along, to_plane)) as f32;
                colors[index] = shade(metaballs, ray.normal, &plane);
            }
        }
    }
    let mut light = vec![0.0_f32; 4 * scene.image.pixels()];
    let (image_width, across) = (scene.image.width as usize, across as usize);
    let share = 1.0 / (across * across) as f64;
    for (index, pixel) in light.as_chunks_mut::<4>().0.iter_mut().enumerate() {
        let (column, row) = (index % image_width * across, index / image_width * across);
        let rows = (row..row + across).map(|row| &colors[row * width + column..][..across]);
        let sum: DVec3 = rows.map(|row| row.iter().sum::<DVec3>()).sum();
        let [red, green, blue] = (share * sum).as_vec3().to_array();
        *pixel = [red, green, blue, 1.0];
    }
    Ok(SeenSurfaces {
        depth: DepthImage::new(grid, along, depths)?,
        light: light.into(),
        lit: None,
    })
}
