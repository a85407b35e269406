//! The plan of a frame: the grid of rays, and for every surface slabs of depth with their cells.

use super::pack::{Sight, Slab, Surface, fine, middle, surface, vector, wider};
use crate::image::DepthAlong;
use crate::scene::{MetaballKernel, MetaballMethod, Metaballs, Scene, ViewPlane};

/// Rays across in the smallest cell.
const LEAST_CELL: f64 = 16.0;

/// Slabs of a surface, and cells of all, about: clouds far apart have thicker slabs, and larger cells.
const MOST_SLABS: f64 = 1000.0;
const MOST_CELLS: usize = 1 << 22;

/// Rectangles are so much wider than they need to be: rounding loses no particle.
const WIDER: f64 = 1.0001;

/// Rays across and down in a square of which is known which slabs matter, at least.
const LEAST_SQUARE: u32 = 32;

/// Which programs a frame needs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub(super) struct Variant {
    pub has_cones: bool,
    pub has_smooth: bool,
    pub has_sampling: bool,
}

/// What is to be drawn.
#[derive(Debug, Default)]
pub(super) struct Plan {
    pub variant: Variant,
    pub surfaces: Vec<Surface>,
    pub slabs: Vec<Slab>,
    pub cell_count: u32,
    pub square_count: u32,
}

/// Returns the grid of so many rays across a pixel, of which a work-item carries as many side by side as it has lanes.
/// Rows and columns are perpendicular to the view, whatever a projection's shear: matrices that are read have no other.
pub(super) fn sight(scene: &Scene, across: u32, lanes: u32) -> (Sight, ViewPlane) {
    let (grid, plane) = scene.ray_grid(across);
    let right = plane.column_step.normalize();
    let down = (plane.row_step - plane.row_step.dot(right) * right).normalize();
    let scale = if plane.is_parallel {
        1.0
    } else {
        1.0 / plane.near
    };
    let unit = match lanes {
        1 => across,
        4 => across * (8 / across).max(1),
        _ => across * (16 / across).max(1),
    };
    let square = unit * LEAST_SQUARE.div_ceil(unit);
    let along = scene.depth.as_ref().map(|depth| depth.along());
    let depth_step = scene
        .depth
        .as_ref()
        .map_or(1, |depth| grid.width / depth.size().width.max(1));
    (
        Sight {
            right: vector(right),
            down: vector(down),
            forward: vector(plane.forward),
            first_x: (scale * plane.first_pixel.dot(right)) as f32,
            first_y: (scale * plane.first_pixel.dot(down)) as f32,
            step_x: (scale * plane.column_step.length()) as f32,
            step_y: (scale * plane.row_step.dot(down)) as f32,
            skew_x: (scale * plane.row_step.dot(right)) as f32,
            width: grid.width,
            height: grid.height,
            across,
            unit,
            is_parallel: u32::from(plane.is_parallel),
            is_along_axis: u32::from(!matches!(along, None | Some(DepthAlong::Ray))),
            has_depth: u32::from(along.is_some()),
            depth_step,
            span_columns: grid.width.div_ceil(square),
            square,
            ..bytemuck::Zeroable::zeroed()
        },
        plane,
    )
}

impl Plan {
    /// Plans the surfaces of a valid scene.
    pub(super) fn new(scene: &Scene, sight: &Sight, plane: &ViewPlane) -> Self {
        let mut coarser = 1.0;
        loop {
            let plan = Self::with_cells(scene, sight, plane, coarser);
            if plan.cell_count as usize <= MOST_CELLS
                || coarser > f64::from(sight.width.max(sight.height))
            {
                return plan;
            }
            coarser *= 2.0;
        }
    }

    fn with_cells(scene: &Scene, sight: &Sight, plane: &ViewPlane, coarser: f64) -> Self {
        let mut plan = Self::default();
        let squares = sight.span_columns * sight.height.div_ceil(sight.square);
        let mut point_count = 0;
        for metaballs in scene.metaballs.iter() {
            let count = metaballs.points.len() as u32;
            let first_point = point_count;
            point_count += count;
            let variant = &mut plan.variant;
            match metaballs.kernel {
                MetaballKernel::Smooth => variant.has_smooth = true,
                MetaballKernel::Cone => variant.has_cones = true,
            }
            variant.has_sampling |= matches!(metaballs.method, MetaballMethod::Sampling(_));
            let mut surface = Surface {
                first_point,
                point_count: count,
                first_slab: plan.slabs.len() as u32,
                first_square: plan.surfaces.len() as u32 * squares,
                ..surface(metaballs)
            };
            let eye = plane.eye - middle(metaballs) - metaballs.translate;
            (surface.origin, surface.origin_rest) = fine(eye);
            plan.add_slabs(
                &mut surface,
                depths(metaballs, plane),
                sight,
                coarser * LEAST_CELL,
            );
            plan.surfaces.push(surface);
        }
        plan.square_count = squares;
        plan
    }

    /// Adds the slabs between two depths of particles, within whose radius rays may come.
    fn add_slabs(
        &mut self,
        surface: &mut Surface,
        (from, to): (f64, f64),
        sight: &Sight,
        least: f64,
    ) {
        let radius = f64::from(surface.radius);
        // Behind that no ray meets a particle's field; before it, there is none.
        let from = from.max(-radius) - radius;
        let length = (to + radius - from).max(radius);
        let thickness = radius.max(length / MOST_SLABS);
        surface.first_z = from as f32;
        surface.thickness = thickness as f32;
        surface.reach = (radius / thickness - 1e-3).ceil() as u32;
        surface.slab_count = (length / thickness).ceil() as u32 + 1;
        let step = f64::from(sight.step_x.min(sight.step_y));
        for number in 0..surface.slab_count {
            let begin = from + f64::from(number) * thickness;
            let rays = match sight.is_parallel {
                0 if begin < radius => None,
                0 => Some(radius / (begin * step)),
                _ => Some(radius / step),
            };
            // About two cells to a radius; their number may overflow only where another try follows.
            let width = rays.map_or(f64::INFINITY, |rays| {
                (0.5 * rays / least).max(1.0).log2().floor().exp2() * least
            });
            let cells = |rays: u32| match width.is_finite() {
                true => (f64::from(rays) / width).ceil() as u32 + 2,
                false => 1,
            };
            let [beside_x, beside_y] = [sight.step_x, sight.step_y]
                .map(|it| WIDER * rays.unwrap_or(0.0) * step / f64::from(it));
            // Rows above and below begin elsewhere.
            let leaning = f64::from(sight.skew_x.abs() / sight.step_x);
            let slab = Slab {
                first_cell: self.cell_count,
                columns: cells(sight.width),
                rows: cells(sight.height),
                inverse_width: (1.0 / width) as f32,
                beside_x: (beside_x + leaning * beside_y) as f32,
                beside_y: beside_y as f32,
            };
            self.cell_count = self.cell_count.saturating_add(slab.columns * slab.rows);
            self.slabs.push(slab);
        }
    }
}

/// Returns the least and the greatest depth of particles, from the eye along the view.
fn depths(metaballs: &Metaballs, plane: &ViewPlane) -> (f64, f64) {
    let (low, high) = metaballs.points.bounds();
    let eye = plane.eye - metaballs.translate;
    let middle = (0.5 * (low + high) - eye).dot(plane.forward);
    let half = (0.5 * (high - low)).dot(plane.forward.abs());
    // What float32 makes of it may lie beside it.
    let beside = 1e-6 * (middle.abs() + half) + 1e-3 * wider(metaballs) * metaballs.radius;
    (middle - half - beside, middle + half + beside)
}
