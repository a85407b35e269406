//! Bloom: light that a lens, or an eye, spreads around what is bright.
//!
//! The picture is halved again and again, and every half-size is brought back to the full size by the same weights, 1,
//! 4, 6, 4 and 1 (a Gaussian pyramid; Burt and Adelson 1983). Repeated, they make cubic B-splines, which are smooth and
//! nearly round, and do not lean to a side wherever a point lies. All levels have as much light, so it falls off with
//! about the square of the distance.
//!
//! Halving is the transpose of doubling, divided by how much of the picture a pixel stands for: whatever the size, and
//! at every border, no light is lost or made.

#[cfg(test)]
mod tests;

use glam::{Vec4, Vec4Swizzles};
use serde::{Deserialize, Serialize};

use super::{ImageSize, RadianceImage};
use crate::error::Result;
use crate::threads;

/// Light that is spread around what is bright; their sum stays.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Bloom {
    /// Which share of all light is spread, 0 to 1.
    pub strength: f64,
    /// How far: the standard deviation of the widest of its levels, as a share of the picture's height; above 0, up
    /// to 1.
    #[serde(default = "usual_radius")]
    pub radius: f64,
}

fn usual_radius() -> f64 {
    0.05
}

impl Bloom {
    /// Makes a bloom of a share of all light, with a radius of 0.05 of the picture's height.
    #[must_use]
    pub fn new(strength: f64) -> Self {
        Self {
            strength,
            radius: usual_radius(),
        }
    }

    /// Returns the share of each level in what is spread, from half the size on; together 1. A level of `2^-k` of the
    /// size has a variance of `(4^k - 1) 2 / 3` square pixels; the last has less light if the radius is between two.
    fn shares(&self, size: ImageSize) -> Vec<f32> {
        let radius = self.radius * f64::from(size.height);
        let depth = 0.5 * (1.5 * radius * radius + 1.0).log2();
        let most = f64::from(size.width.max(size.height)).log2().ceil();
        let depth = depth.min(most.max(1.0)).max(1e-3);
        let whole = depth.ceil();
        let last = depth - (whole - 1.0);
        let shares = (1..=whole as u32).map(|level| if level < whole as u32 { 1.0 } else { last });
        let sum = whole - 1.0 + last;
        shares.map(|share| (share / sum) as f32).collect()
    }
}

impl RadianceImage {
    /// Returns the image with its light spread; alpha stays. [`tone_map`](Self::tone_map) and
    /// [`ImageFile::write`](super::ImageFile::write) do it where a [`Display`](super::Display) has a bloom; this is for
    /// what shows light by other means. A pixel that is not finite keeps its light.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory) if the host has too little memory for another image.
    pub fn bloomed(&self, bloom: &Bloom) -> Result<Self> {
        let mut image = Self::new(self.size)?;
        let glow = Glow::new(self, bloom);
        threads::for_each_chunk(&mut image.data, 4, |index, pixel| {
            let [red, green, blue] = glow.light(self, index);
            pixel.copy_from_slice(&[red, green, blue, self.data[4 * index + 3]]);
        });
        Ok(image)
    }
}

/// What an image spreads, at half its size.
pub(super) struct Glow {
    strength: f32,
    spread: Level,
}

impl Glow {
    pub(super) fn new(image: &RadianceImage, bloom: &Bloom) -> Self {
        let size = image.size;
        let (width, height) = (size.width as usize, size.height as usize);
        let mut across = Axis::halving(&vec![1.0; width]);
        let mut down = Axis::halving(&vec![1.0; height]);
        let all = |column: usize, row: usize| {
            let begin = 4 * (row * width + column);
            let light = Vec4::from_slice(&image.data[begin..begin + 4]);
            if light.is_finite() { light } else { Vec4::ZERO }
        };
        let shares = bloom.shares(size);
        let mut levels = vec![Level::halved(all, &across, &down)];
        for _ in 1..shares.len() {
            across = Axis::halving(&across.masses);
            down = Axis::halving(&down.masses);
            let finer = &levels[levels.len() - 1];
            let next = Level::halved(|column, row| finer.pixel(column, row), &across, &down);
            levels.push(next);
        }
        let mut spread = Level::default();
        for (mut level, share) in levels.into_iter().zip(shares).rev() {
            let width = level.width;
            threads::for_each_chunk(&mut level.light, width, |row, pixels| {
                for (column, light) in pixels.iter_mut().enumerate() {
                    *light = share * *light + spread.doubled(column, row);
                }
            });
            spread = level;
        }
        Self {
            strength: bloom.strength as f32,
            spread,
        }
    }

    /// Returns the light of a pixel: what it keeps, and what comes from all around.
    pub(super) fn light(&self, image: &RadianceImage, index: usize) -> [f32; 3] {
        let light = Vec4::from_slice(&image.data[4 * index..4 * index + 4]);
        if !light.is_finite() {
            return light.xyz().to_array();
        }
        let width = image.size.width as usize;
        let spread = self.spread.doubled(index % width, index / width);
        ((1.0 - self.strength) * light + self.strength * spread)
            .xyz()
            .to_array()
    }
}

/// The weights by which rows, or columns, are halved.
struct Axis {
    /// For each coarse one those of the five fine ones from twice its number, less 2, on; together 1.
    weights: Vec<[f32; 5]>,
    /// How many of the picture's rows or columns each coarse one stands for.
    masses: Vec<f64>,
}

impl Axis {
    fn halving(fine: &[f64]) -> Self {
        let count = fine.len().div_ceil(2);
        let mut taps = vec![[0.0; 5]; count];
        for (number, mass) in fine.iter().enumerate() {
            for (coarse, weight) in around(number, count) {
                taps[coarse][number + 2 - 2 * coarse] += f64::from(weight) * mass;
            }
        }
        let masses: Vec<f64> = taps.iter().map(|taps| taps.iter().sum()).collect();
        let each = taps.iter().zip(&masses);
        Self {
            weights: each
                .map(|(taps, mass)| taps.map(|tap| (tap / mass) as f32))
                .collect(),
            masses,
        }
    }
}

/// Returns the coarse ones around a fine one, and what each counts, together 1; beyond a border counts the last.
fn around(fine: usize, count: usize) -> [(usize, f32); 3] {
    let near = fine / 2;
    let (before, after) = (near.saturating_sub(1), (near + 1).min(count - 1));
    match fine % 2 {
        0 => [(before, 0.125), (near, 0.75), (after, 0.125)],
        _ => [(near, 0.25), (near, 0.25), (after, 0.5)],
    }
}

/// Light of a coarser size, by rows; the fourth value is of no use.
#[derive(Default)]
struct Level {
    width: usize,
    light: Vec<Vec4>,
}

impl Level {
    /// Makes the half of what `fine` gives for a column and a row.
    fn halved(
        fine: impl Fn(usize, usize) -> Vec4 + Send + Sync,
        across: &Axis,
        down: &Axis,
    ) -> Self {
        let width = across.weights.len();
        let mut light = vec![Vec4::ZERO; width * down.weights.len()];
        threads::for_each_chunk(&mut light, width, |row, pixels| {
            // Where a weight is 0 there may be no row, and any will do.
            let rows = down.weights[row];
            let first = [0, 1, 2, 3, 4].map(|tap| match rows[tap] > 0.0 {
                true => 2 * row + tap - 2,
                false => 2 * row,
            });
            let sum = |column: usize| {
                let parts = first.map(|row| fine(column, row));
                rows[0] * parts[0]
                    + rows[1] * parts[1]
                    + rows[2] * parts[2]
                    + rows[3] * parts[3]
                    + rows[4] * parts[4]
            };
            // Each pixel shares three columns with the one before.
            let mut shared = [Vec4::ZERO, Vec4::ZERO, sum(0)];
            for (column, (pixel, weights)) in pixels.iter_mut().zip(&across.weights).enumerate() {
                let next = [1, 2].map(|tap| match weights[tap + 2] > 0.0 {
                    true => sum(2 * column + tap),
                    false => Vec4::ZERO,
                });
                *pixel = weights[0] * shared[0]
                    + weights[1] * shared[1]
                    + weights[2] * shared[2]
                    + weights[3] * next[0]
                    + weights[4] * next[1];
                shared = [shared[2], next[0], next[1]];
            }
        });
        Self { width, light }
    }

    fn pixel(&self, column: usize, row: usize) -> Vec4 {
        self.light[row * self.width + column]
    }

    /// Returns what a pixel of twice the size has; nothing where there is no light at all.
    fn doubled(&self, column: usize, row: usize) -> Vec4 {
        if self.light.is_empty() {
            return Vec4::ZERO;
        }
        let columns = around(column, self.width);
        let across = |row: usize| {
            let of = |(column, weight)| weight * self.pixel(column, row);
            of(columns[0]) + of(columns[1]) + of(columns[2])
        };
        let of = |(row, weight)| weight * across(row);
        let rows = around(row, self.light.len() / self.width);
        of(rows[0]) + of(rows[1]) + of(rows[2])
    }
}
