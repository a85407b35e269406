//! Surfaces as a picture sees them: the grid of their rays, and what is made of a scene that lies behind them.

use std::ops::Range;
use std::sync::Arc;

use super::{List, Scene, ViewPlane};
use crate::image::{DepthImage, ImageSize};
use crate::threads;

/// Rays across and down in a pixel whose edges are smooth, and in one of a large picture: 33 million rays of a picture
/// of 1920 by 1080 would take half a gigabyte, and at that size a pixel is small.
const FINE: u32 = 4;
const COARSE: u32 = 2;
const LARGE: usize = 1 << 20;

/// Pictures of more pixels have one ray a pixel: no buffer holds more.
const HUGE: usize = 1 << 26;

/// What is seen of surfaces.
#[derive(Debug)]
pub(crate) struct SeenSurfaces {
    /// How far each ray sees; as many rays as the grid has, and the scene's depths included.
    pub depth: DepthImage,
    /// The mean radiance of each pixel's rays, RGBA by rows.
    pub light: Arc<Vec<f32>>,
    /// Columns and rows of pixels beside which there is no light; `None`: not known.
    pub lit: Option<[Range<usize>; 2]>,
}

impl Scene {
    /// Returns how many rays to surfaces lie side by side in a pixel: as many as the scene has depths there, if they
    /// are finer than its pixels.
    pub(crate) fn rays_across(&self) -> u32 {
        let depth = self.depth.as_ref();
        match depth.map(|depth| depth.size().width / self.image.width.max(1)) {
            Some(across) if across > 1 => across,
            _ if !self.integration.has_footprints() || self.image.pixels() > HUGE => 1,
            _ if self.image.pixels() > LARGE => COARSE,
            _ => FINE,
        }
    }

    /// Returns the grid of so many rays across a pixel.
    pub(crate) fn ray_grid(&self, across: u32) -> (ImageSize, ViewPlane) {
        let grid = ImageSize {
            width: across * self.image.width,
            height: across * self.image.height,
        };
        let mut camera = self.camera.clone();
        camera.jitter *= f64::from(across); // it is in pixels
        (grid, ViewPlane::new(&camera, grid, 1.0))
    }
}

impl Scene {
    /// Returns the scene that lies behind its meshes, up to which rays go so far.
    pub(crate) fn behind_meshes(&self, depth: &DepthImage) -> Self {
        Self {
            depth: Some(depth.clone()),
            meshes: List::new(),
            ..self.clone()
        }
    }
}

impl SeenSurfaces {
    /// Makes surfaces that give no light, up to which rays go so far.
    pub(crate) fn dark(scene: &Scene, depth: DepthImage) -> Self {
        let mut light = vec![0.0; 4 * scene.image.pixels()];
        light.iter_mut().skip(3).step_by(4).for_each(|it| *it = 1.0);
        Self {
            depth,
            light: light.into(),
            lit: Some([0..0, 0..0]),
        }
    }

    /// Adds the light of further surfaces of the same picture, whose alpha is the same.
    pub(crate) fn brighten(&mut self, more: &[f32]) {
        self.lit = None;
        let light = Arc::make_mut(&mut self.light).as_chunks_mut::<4>().0;
        for (to, from) in light.iter_mut().zip(more.as_chunks::<4>().0) {
            (0..3).for_each(|channel| to[channel] += from[channel]);
        }
    }

    /// Returns the light of a scene that surfaces leave: they are gone, but hide what is behind them, if they do.
    pub(crate) fn left_of(&self, scene: &Scene) -> Scene {
        Scene {
            depth: match scene.integration.hidden_surfaces {
                true => Some(self.depth.clone()),
                false => scene.depth.clone(),
            },
            meshes: List::new(),
            metaballs: List::new(),
            ..scene.clone()
        }
    }

    /// Writes rows of the surfaces into `target`, RGBA by rows `stride` values apart.
    pub(crate) fn put(
        &self,
        scene: &Scene,
        rows: Range<u32>,
        (target, stride): (&mut [f32], usize),
    ) {
        for (to, from) in self.rows(scene, rows).zip_rows(target, stride) {
            to.copy_from_slice(from);
        }
    }

    /// Adds rows of the surfaces to the light of what they leave.
    pub(crate) fn add(
        &self,
        scene: &Scene,
        rows: Range<u32>,
        (target, stride): (&mut [f32], usize),
    ) {
        let (first, width) = (rows.start as usize, scene.image.width as usize);
        let all = || [0..width, 0..scene.image.height as usize];
        let [columns, lit_rows] = self.lit.clone().unwrap_or_else(all);
        let light = self.light.as_chunks::<4>().0;
        threads::for_each_part(target, stride, |begin, to| {
            let row = first + begin / stride;
            if row < rows.end as usize && lit_rows.contains(&row) {
                let from = &light[row * width..(row + 1) * width][columns.clone()];
                let to = &mut to.as_chunks_mut::<4>().0[columns.clone()];
                for (to, from) in to.iter_mut().zip(from) {
                    (0..3).for_each(|channel| to[channel] += from[channel]);
                }
            }
        });
    }

    fn rows(&self, scene: &Scene, rows: Range<u32>) -> Rows<'_> {
        let row = 4 * scene.image.width as usize;
        Rows {
            light: &self.light[rows.start as usize * row..rows.end as usize * row],
            row,
        }
    }
}

/// Rows of light, side by side.
struct Rows<'a> {
    light: &'a [f32],
    row: usize,
}

impl<'a> Rows<'a> {
    fn zip_rows<'b>(
        self,
        target: &'b mut [f32],
        stride: usize,
    ) -> impl Iterator<Item = (&'b mut [f32], &'a [f32])> {
        let row = self.row;
        let targets = target.chunks_mut(stride).map(move |to| &mut to[..row]);
        targets.zip(self.light.chunks_exact(row))
    }
}
