//! Depths finer than pixels: where several surfaces lie in one, its light is the mean of what is seen before each.
//!
//! A ray ends at one depth, so such an image is drawn once with the nearest depth of every pixel, and again with the
//! next ones where there are some. Everywhere else these hide all, which costs next to nothing.

use std::ops::Range;
use std::sync::Arc;

use super::Scene;
use crate::error::Result;
use crate::image::{DepthImage, ImageSize};

/// Depths of one pixel that differ by no more than this share are one surface.
const STEP: f32 = 0.02;

/// Surfaces in a pixel; where there are more, those next to each other are one.
const MOST_SURFACES: usize = 4;

/// Pixels across and down in one of the image's, at most.
pub(super) const FINEST: u32 = 8;

/// Returns how many depths lie side by side in a pixel; `None` if the sizes do not fit.
pub(super) fn depths_across(depth: ImageSize, image: ImageSize) -> Option<u32> {
    let across = depth.width / image.width.max(1);
    let fits = depth.width == across * image.width && depth.height == across * image.height;
    (fits && (1..=FINEST).contains(&across)).then_some(across)
}

/// Draws a scene into RGBA by rows so many values apart, after such a share of the work.
type Draw<'a> = dyn FnMut(&Scene, &mut [f32], usize, f32) -> Result<()> + 'a;

/// A fine depth image, taken apart.
#[derive(Debug)]
pub(crate) struct DepthLayers {
    /// Of what, and for which size.
    values: Arc<Vec<f32>>,
    size: ImageSize,
    layers: Vec<DepthLayer>,
}

/// A surface of some pixels, the first of all.
#[derive(Debug)]
struct DepthLayer {
    depth: DepthImage,
    /// Pixels that have further surfaces, in order, and which share of them this one covers.
    shares: Vec<(u32, f32)>,
}

impl DepthLayers {
    /// Takes a scene's depths apart, unless they are those of `last`; `None` if it has none that are finer than its
    /// pixels.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) never, of a valid scene.
    pub(crate) fn of(scene: &Scene, last: Option<Self>) -> Result<Option<Self>> {
        let size = scene.image;
        let Some(depth) = scene.depth.as_ref().filter(|depth| depth.size() != size) else {
            return Ok(None);
        };
        if let Some(last) =
            last.filter(|it| it.size == size && Arc::ptr_eq(&it.values, depth.shared_values()))
        {
            return Ok(Some(last));
        }
        let across = depths_across(depth.size(), size).unwrap_or(1);
        let mut found = vec![(Vec::with_capacity(size.pixels()), Vec::new())];
        let mut block = Vec::new();
        for pixel in 0..size.pixels() {
            block.clear();
            gather(
                depth,
                across as usize,
                (pixel % size.width as usize, pixel / size.width as usize),
                &mut block,
            );
            let surfaces = surfaces(&mut block);
            for (layer, surface) in surfaces.iter().enumerate() {
                if layer == found.len() {
                    found.push((Vec::new(), Vec::new()));
                }
                let (depths, shares) = &mut found[layer];
                depths.resize(pixel, 0.0);
                depths.push(surface.depth);
                if surfaces.len() > 1 {
                    shares.push((pixel as u32, surface.share));
                }
            }
        }
        let layers = found.into_iter().map(|(mut depths, shares)| {
            depths.resize(size.pixels(), 0.0);
            Ok(DepthLayer {
                depth: DepthImage::new(size, depth.along(), depths)?,
                shares,
            })
        });
        Ok(Some(Self {
            values: depth.shared_values().clone(),
            size,
            layers: layers.collect::<Result<_>>()?,
        }))
    }

    /// Draws rows of a scene into `target`, RGBA by rows `stride` values apart: `draw` gets scenes whose depths are
    /// as many as their pixels.
    pub(crate) fn draw(
        &self,
        scene: &Scene,
        rows: Range<u32>,
        (target, stride): (&mut [f32], usize),
        draw: &mut Draw<'_>,
    ) -> Result<()> {
        let width = self.size.width;
        let row = 4 * width as usize;
        let mut scene = scene.clone();
        let mut further = Vec::new();
        for (number, layer) in self.layers.iter().enumerate() {
            let shares = layer.in_rows(&rows, width);
            if number > 0 && shares.is_empty() {
                continue;
            }
            scene.depth = Some(layer.depth.clone());
            let done = number as f32 / self.layers.len() as f32;
            let place = |pixel: u32, stride: usize| {
                let (down, across) = (pixel / width - rows.start, pixel % width);
                down as usize * stride + 4 * across as usize
            };
            if number == 0 {
                draw(&scene, target, stride, done)?;
                for &(pixel, share) in shares {
                    let at = place(pixel, stride);
                    target[at..at + 3]
                        .iter_mut()
                        .for_each(|light| *light *= share);
                }
                continue;
            }
            further.resize(rows.len() * row, 0.0);
            draw(&scene, &mut further, row, done)?;
            for &(pixel, share) in shares {
                let (to, from) = (place(pixel, stride), place(pixel, row));
                for channel in 0..3 {
                    target[to + channel] += share * further[from + channel];
                }
            }
        }
        Ok(())
    }

    /// Returns scenes whose depths are as many as their pixels, and which share of each pixel shows them; `None`: all.
    pub(crate) fn parts<'a>(
        &'a self,
        scene: &'a Scene,
    ) -> impl Iterator<Item = (Scene, Option<Vec<f32>>)> + 'a {
        let part = |(number, layer): (usize, &'a DepthLayer)| {
            let before = Scene {
                depth: Some(layer.depth.clone()),
                ..scene.clone()
            };
            if number == 0 && layer.shares.is_empty() {
                return (before, None);
            }
            // Where there is one surface, the first layer has it.
            let mut shares = vec![if number == 0 { 1.0 } else { 0.0 }; self.size.pixels()];
            for &(pixel, share) in &layer.shares {
                shares[pixel as usize] = share;
            }
            (before, Some(shares))
        };
        self.layers.iter().enumerate().map(part)
    }

    /// Returns how many times something is drawn.
    pub(crate) fn count(&self) -> usize {
        self.layers.len()
    }
}

impl DepthLayer {
    fn in_rows(&self, rows: &Range<u32>, width: u32) -> &[(u32, f32)] {
        let before = |row: u32| {
            self.shares
                .partition_point(|(pixel, _)| *pixel < row * width)
        };
        &self.shares[before(rows.start)..before(rows.end)]
    }
}

/// Adds the depths of a pixel.
fn gather(depth: &DepthImage, across: usize, (column, row): (usize, usize), block: &mut Vec<f32>) {
    let width = depth.size().width as usize;
    for down in 0..across {
        let begin = (row * across + down) * width + column * across;
        block.extend_from_slice(&depth.as_slice()[begin..begin + across]);
    }
}

/// What lies in a pixel at about one depth, and its share of the pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Surface {
    depth: f32,
    share: f32,
}

/// Finds the surfaces of a pixel, the nearest first: its depths, sorted, are cut where the steps are largest.
fn surfaces(depths: &mut [f32]) -> Vec<Surface> {
    depths.sort_unstable_by(f32::total_cmp);
    let mut steps: Vec<(f32, usize)> = depths
        .windows(2)
        .enumerate()
        .filter(|(_, pair)| pair[1] > pair[0] * (1.0 + STEP))
        .map(|(before, pair)| (pair[1] / pair[0], before + 1))
        .collect();
    steps.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    steps.truncate(MOST_SURFACES - 1);
    let mut cuts: Vec<usize> = steps.into_iter().map(|(_, cut)| cut).collect();
    cuts.sort_unstable();
    cuts.push(depths.len());
    let mut begin = 0;
    cuts.into_iter()
        .map(|cut| {
            let part = &depths[begin..cut];
            begin = cut;
            let sum: f64 = part.iter().map(|depth| f64::from(*depth)).sum();
            Surface {
                depth: (sum / part.len() as f64) as f32,
                share: part.len() as f32 / depths.len() as f32,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_of_a_pixel_are_parted_at_their_largest_steps() {
        let of = |mut depths: Vec<f32>| -> Vec<(f32, f32)> {
            let found = surfaces(&mut depths);
            found.iter().map(|it| (it.depth, it.share)).collect()
        };
        assert_eq!(of(vec![3.0, 3.0, 3.0, 3.0]), [(3.0, 1.0)]);
        assert_eq!(
            of(vec![2.0, f32::INFINITY, 2.02, f32::INFINITY]),
            [(2.01, 0.5), (f32::INFINITY, 0.5)]
        );
        assert_eq!(
            of(vec![5.0, 0.0, 1.0, 1.0]),
            [(0.0, 0.25), (1.0, 0.5), (5.0, 0.25)]
        );
        let many = of(vec![
            1.0,
            2.0,
            4.0,
            4.2,
            9.0,
            20.0,
            f32::INFINITY,
            21.0,
            1.0,
        ]);
        assert_eq!(many.len(), MOST_SURFACES);
        assert_eq!(many[3], (f32::INFINITY, 1.0 / 9.0));
        // A slope is one surface, and its depth their mean.
        let slope: Vec<f32> = (0..16).map(|k| 10.0 + 0.1 * k as f32).collect();
        assert_eq!(of(slope), [(10.75, 1.0)]);
    }
}
