//! The weights by which rows, or columns, are halved and doubled.

/// The weights by which rows, or columns, are halved.
#[derive(Debug)]
pub(crate) struct Axis {
    /// How many there are.
    pub fine: usize,
    /// For each coarse one those of the five fine ones from twice its number, less 2, on; together 1.
    pub weights: Vec<[f32; 5]>,
    /// How many of the picture's rows or columns each coarse one stands for.
    pub masses: Vec<f64>,
}

impl Axis {
    /// Halves this many rows or columns of a picture.
    pub(crate) fn of_picture(count: u32) -> Self {
        Self::halving(&vec![1.0; count as usize])
    }

    /// Halves what was halved.
    pub(crate) fn next(&self) -> Self {
        Self::halving(&self.masses)
    }

    pub(super) fn halving(fine: &[f64]) -> Self {
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
            fine: fine.len(),
            weights: each
                .map(|(taps, mass)| taps.map(|tap| (tap / mass) as f32))
                .collect(),
            masses,
        }
    }
}

/// Returns the coarse ones around a fine one, and what each counts, together 1; beyond a border counts the last.
pub(super) fn around(fine: usize, count: usize) -> [(usize, f32); 3] {
    let near = fine / 2;
    let (before, after) = (near.saturating_sub(1), (near + 1).min(count - 1));
    match fine % 2 {
        0 => [(before, 0.125), (near, 0.75), (after, 0.125)],
        _ => [(near, 0.25), (near, 0.25), (after, 0.5)],
    }
}
