//! Bloom: light that a lens, or an eye, spreads around what is bright.
//!
//! The picture is halved again and again, and every half-size is brought back to the full size by the same weights, 1,
//! 4, 6, 4 and 1 (a Gaussian pyramid; Burt and Adelson 1983). Repeated, they make cubic B-splines, which are smooth and
//! nearly round, and do not lean to a side wherever a point lies. All levels have as much light, so it falls off with
//! about the square of the distance.
//!
//! Halving is the transpose of doubling, divided by how much of the picture a pixel stands for: whatever the size, and
//! at every border, no light is lost or made.

mod axis;
mod level;
#[cfg(test)]
mod tests;

pub(crate) use axis::Axis;
use glam::Vec4;
use level::Level;
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
    pub(crate) fn shares(&self, size: ImageSize) -> Vec<f32> {
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
    /// [`ImageFile::write`](super::ImageFile::write) do it where a [`Display`](super::Display) has a bloom, unless the
    /// image has [one already](Self::bloom). A pixel that is not finite keeps its light.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory) if the host has too little memory for another image.
    pub fn bloomed(&self, bloom: &Bloom) -> Result<Self> {
        let mut image = Self::new(self.size)?;
        let glow = Glow::new(self.size, &self.data, bloom);
        let row = 4 * self.size.width as usize;
        threads::for_each_chunk(&mut image.data, row, |number, pixels| {
            pixels.copy_from_slice(&self.data[number * row..(number + 1) * row]);
            glow.give(number, pixels);
        });
        image.bloom = Some(*bloom);
        Ok(image)
    }

    /// Returns the bloom that its light has: one of [`bloomed`](Self::bloomed), of
    /// [`Renderer::bloom`](crate::Renderer::bloom) or of a renderer that was told to
    /// [`spread_bloom`](crate::Renderer::spread_bloom). No display spreads it again.
    #[must_use]
    pub fn bloom(&self) -> Option<Bloom> {
        self.bloom
    }
}

/// Spreads the light of an image, 4 values a pixel, where it is.
pub(crate) fn spread_light(size: ImageSize, light: &mut [f32], bloom: &Bloom) {
    let glow = Glow::new(size, light, bloom);
    let row = 4 * size.width as usize;
    threads::for_each_chunk(light, row, |number, pixels| glow.give(number, pixels));
}

/// What an image spreads, at half its size.
pub(super) struct Glow {
    strength: f32,
    spread: Level,
}

impl Glow {
    pub(super) fn new(size: ImageSize, light: &[f32], bloom: &Bloom) -> Self {
        let mut across = Axis::of_picture(size.width);
        let mut down = Axis::of_picture(size.height);
        let shares = bloom.shares(size);
        let mut levels = vec![Level::halved(light, &across, &down)];
        for _ in 1..shares.len() {
            (across, down) = (across.next(), down.next());
            let finer = &levels[levels.len() - 1];
            levels.push(Level::halved(&finer.light, &across, &down));
        }
        let mut spread = Level::default();
        for (mut level, share) in levels.into_iter().zip(shares).rev() {
            threads::for_each_chunk(&mut level.light, 4 * level.width, |row, pixels| {
                pixels.iter_mut().for_each(|light| *light *= share);
                spread.doubled(row, pixels, |pixel, light| {
                    (Vec4::from_slice(pixel) + light).write_to_slice(pixel);
                });
            });
            spread = level;
        }
        Self {
            strength: bloom.strength as f32,
            spread,
        }
    }

    /// Gives a row of the image, 4 values a pixel, its light: what it keeps, and what comes from all around.
    pub(super) fn give(&self, row: usize, pixels: &mut [f32]) {
        let strength = self.strength;
        self.spread.doubled(row, pixels, |pixel, spread| {
            let light = Vec4::from_slice(pixel);
            if light.is_finite() {
                let given = (1.0 - strength) * light + strength * spread;
                given.truncate().write_to_slice(pixel);
            }
        });
    }
}
