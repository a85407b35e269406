//! Exposure: a number of stops, or the one that fits what was drawn.

use super::RadianceImage;

/// How much radiance is multiplied with before it is tone-mapped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exposure {
    /// By `2^stops`, -100 to 100.
    Stops(f64),
    /// By what brings the 99th percentile of the lit pixels' luminance to 4, which tone maps show as nearly white: see
    /// [`RadianceImage::auto_exposure`].
    Auto,
}

/// What `auto` makes of the luminance that so great a share of the lit pixels does not exceed.
const AUTO_LUMINANCE: f64 = 4.0;
const AUTO_SHARE: f64 = 0.99;

/// A pixel is lit that has more than this of the brightest one's luminance.
const LIT: f32 = 1e-6;

/// The shares of red, green and blue in luminance (Rec. 709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

impl Default for Exposure {
    fn default() -> Self {
        Self::Stops(0.0)
    }
}

impl From<f64> for Exposure {
    fn from(stops: f64) -> Self {
        Self::Stops(stops)
    }
}

impl Exposure {
    /// Returns the stops for an image.
    #[must_use]
    pub fn stops(self, image: &RadianceImage) -> f64 {
        match self {
            Self::Stops(stops) => stops,
            Self::Auto => image.auto_exposure(),
        }
    }
}

impl RadianceImage {
    /// Returns the stops that bring the 99th percentile of the luminance of lit pixels to 4: one pixel in a hundred is
    /// brighter. Lit are those that have more than a millionth of the luminance of the brightest. 0 stops where no
    /// pixel is.
    #[must_use]
    pub fn auto_exposure(&self) -> f64 {
        let of = |pixel: &[f32]| {
            pixel
                .iter()
                .zip(LUMINANCE)
                .map(|(l, share)| l * share)
                .sum()
        };
        let all = self.data.chunks_exact(4).map(of);
        let finite = all.filter(|luminance: &f32| luminance.is_finite());
        let brightest = finite.clone().fold(0.0, f32::max);
        let mut lit: Vec<f32> = finite.filter(|l| *l > LIT * brightest).collect();
        if lit.is_empty() {
            return 0.0;
        }
        let rank = (AUTO_SHARE * lit.len() as f64).ceil() as usize - 1;
        let (_, luminance, _) = lit.select_nth_unstable_by(rank, f32::total_cmp);
        let stops = (AUTO_LUMINANCE / f64::from(*luminance)).log2();
        stops.clamp(-100.0, 100.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::ImageSize;

    fn image(width: u32, luminance: impl Fn(usize) -> f32) -> RadianceImage {
        let mut image = RadianceImage::new(ImageSize { width, height: 1 }).unwrap();
        for (i, pixel) in image.data.chunks_exact_mut(4).enumerate() {
            pixel.copy_from_slice(&[luminance(i), luminance(i), luminance(i), 1.0]);
        }
        image
    }

    #[test]
    fn one_lit_pixel_in_a_hundred_is_brighter_than_what_becomes_four() {
        // 1000 lit pixels of 1 to 1000, in no order, among as many dark ones.
        let lit = |i: usize| match i % 2 {
            0 => ((i / 2 * 7) % 1000 + 1) as f32,
            _ => 1e-9,
        };
        let stops = image(2000, lit).auto_exposure();
        assert!((990.0 * stops.exp2() - 4.0).abs() < 1e-3, "{stops}");
        // Light of any scale comes out alike.
        let brighter = image(2000, |i| 1e6 * lit(i)).auto_exposure();
        assert!((stops - brighter - 1e6_f64.log2()).abs() < 1e-4);
        assert_eq!(Exposure::Auto.stops(&image(2000, lit)), stops);
        assert_eq!(Exposure::from(-2.0).stops(&image(2000, lit)), -2.0);
    }

    #[test]
    fn what_has_no_light_and_what_has_endless_light_are_exposed_by_a_number() {
        assert_eq!(image(10, |_| 0.0).auto_exposure(), 0.0);
        assert_eq!(image(10, |_| -1.0).auto_exposure(), 0.0);
        assert_eq!(image(10, |_| f32::NAN).auto_exposure(), 0.0);
        let stops = image(10, |i| [f32::INFINITY, 2.0][i % 2]).auto_exposure();
        assert!((stops - 1.0).abs() < 1e-6, "{stops}");
        assert_eq!(image(10, |_| f32::MIN_POSITIVE).auto_exposure(), 100.0);
    }
}
