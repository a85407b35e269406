//! Light of a size that was halved, in rows that compilers find easy.

use glam::Vec4;

use super::axis::{Axis, around};
use crate::threads;

/// Light of a coarser size, by rows, 4 values a pixel; the fourth is of no use.
#[derive(Default)]
pub(super) struct Level {
    pub width: usize,
    pub light: Vec<f32>,
}

/// Pixels without light before and after a row.
const MARGIN: usize = 2;

impl Level {
    /// Makes the half of light that is twice as wide and high, 4 values a pixel. Light without end is not spread.
    pub(super) fn halved(fine: &[f32], across: &Axis, down: &Axis) -> Self {
        let (width, height) = (across.weights.len(), down.weights.len());
        let fine_row = 4 * across.fine;
        let mut light = vec![0.0; 4 * width * height];
        threads::for_each_chunk(&mut light, 4 * width, |row, pixels| {
            // Where a weight is 0 there may be no row, and any will do.
            let weights = down.weights[row];
            let rows = [0, 1, 2, 3, 4].map(|tap| {
                let number = if weights[tap] > 0.0 {
                    2 * row + tap - 2
                } else {
                    2 * row
                };
                &fine[number * fine_row..(number + 1) * fine_row]
            });
            let mut sums = vec![0.0; fine_row + 8 * MARGIN];
            let middle = &mut sums[4 * MARGIN..][..fine_row];
            for (at, sum) in middle.iter_mut().enumerate() {
                *sum = weights[0] * rows[0][at]
                    + weights[1] * rows[1][at]
                    + weights[2] * rows[2][at]
                    + weights[3] * rows[3][at]
                    + weights[4] * rows[4][at];
            }
            for (column, sum) in middle.chunks_exact_mut(4).enumerate() {
                if !Vec4::from_slice(sum).is_finite() {
                    let lights = rows.map(|row| Vec4::from_slice(&row[4 * column..]));
                    let finite = lights.map(|it| if it.is_finite() { it } else { Vec4::ZERO });
                    let parts = weights.into_iter().zip(finite);
                    let all: Vec4 = parts.map(|(weight, light)| weight * light).sum();
                    all.write_to_slice(sum);
                }
            }
            for ((pixel, weights), begin) in pixels
                .chunks_exact_mut(4)
                .zip(&across.weights)
                .zip((0..).step_by(8))
            {
                let sum = |tap: usize| weights[tap] * Vec4::from_slice(&sums[begin + 4 * tap..]);
                (sum(0) + sum(1) + sum(2) + sum(3) + sum(4)).write_to_slice(pixel);
            }
        });
        Self { width, light }
    }

    /// Calls `each` with the pixels of a row of twice the size, and what each has of this; never where there is no
    /// light at all.
    pub(super) fn doubled(&self, row: usize, pixels: &mut [f32], each: impl Fn(&mut [f32], Vec4)) {
        if self.light.is_empty() {
            return;
        }
        let pitch = 4 * self.width;
        let rows = around(row, self.light.len() / pitch);
        let rows = rows.map(|(row, weight)| (&self.light[row * pitch..(row + 1) * pitch], weight));
        let [(before, a), (near, b), (after, c)] = rows;
        let mut sums = vec![0.0; pitch];
        for (at, sum) in sums.iter_mut().enumerate() {
            *sum = a * before[at] + b * near[at] + c * after[at];
        }
        let sum = |column: usize| Vec4::from_slice(&sums[4 * column..]);
        let mut last = sum(0);
        for (column, pair) in pixels.chunks_mut(8).enumerate() {
            let (near, after) = (sum(column), sum((column + 1).min(self.width - 1)));
            let (even, odd) = pair.split_at_mut(4);
            each(even, 0.125 * (last + after) + 0.75 * near);
            if !odd.is_empty() {
                each(odd, 0.5 * (near + after));
            }
            last = near;
        }
    }
}
