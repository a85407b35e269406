//! The picture of a volume on a billboard, as games had it before volumes (Sakai 2006, section 2): what its cells give
//! off, seen from the side of its lowest y.

use super::Storage;
use super::texture::Texture;

impl Texture {
    /// Returns cells of one row: the mean emission of those behind each other along y, x to the right and z upwards.
    /// Copies of a texture share it.
    #[must_use]
    pub fn picture(&self) -> &Self {
        self.kept_picture()
            .get_or_init(|| self.made_picture().into())
            .as_ref()
    }

    fn made_picture(&self) -> Self {
        let mut sums = self.summed();
        if let Some(rest) = self.rest() {
            let others = rest.summed();
            let (count, of_rest) = (sums.len(), others.len());
            if of_rest > count {
                sums = sums.repeat(of_rest / count);
            }
            for (index, sum) in sums.iter_mut().enumerate() {
                *sum += others[index % of_rest];
            }
        }
        let [columns, _, layers] = self.cells();
        self.with_values([columns, 1, layers], sums, Storage::Emission)
    }

    /// Returns the mean emission of cells behind each other.
    fn summed(&self) -> Vec<f32> {
        let [columns, rows, layers] = self.cells().map(|it| it as usize);
        let power = self.storage().power() as i32;
        let emission = |stored: f32| match power {
            0 => stored,
            1 => 1.0 / stored.max(self.floor()),
            _ => stored.max(self.floor()).sqrt().recip(),
        };
        let mut sums = vec![0.0_f32; columns * layers * self.channels() as usize];
        let sheets = self.values().chunks_exact(columns * rows);
        for (sums, sheet) in sums.chunks_exact_mut(columns).zip(sheets) {
            for row in sheet.chunks_exact(columns) {
                for (sum, stored) in sums.iter_mut().zip(row) {
                    *sum += emission(*stored) / rows as f32;
                }
            }
        }
        sums
    }
}
