//! Comparison of two images in linear radiance. The worst pixel is what counts: a mean hides faults.

use super::RadianceImage;
use crate::error::Result;

/// Relative differences of the pixels of an image from those of a reference.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Difference {
    /// Of the worst pixel.
    pub max: f64,
    /// Column and row of the worst pixel.
    pub worst: (u32, u32),
    /// 99.9 % of the pixels are within this.
    pub p999: f64,
    /// Root of the mean square.
    pub rms: f64,
}

/// Compares the colour of two images of one size; a pixel's difference is that of its worst channel, relative to the
/// reference's value there. Two zeros agree; NaN differs infinitely from everything. `None` if the sizes differ.
#[must_use]
pub fn compare(image: &RadianceImage, reference: &RadianceImage) -> Option<Difference> {
    if image.size() != reference.size() {
        return None;
    }
    let pixels = image.as_slice().chunks_exact(4);
    let references = reference.as_slice().chunks_exact(4);
    let differences: Vec<f64> = pixels
        .zip(references)
        .map(|(pixel, reference)| {
            let channels = pixel[..3].iter().zip(&reference[..3]);
            channels.map(|(a, b)| relative(*a, *b)).fold(0.0, f64::max)
        })
        .collect();
    let width = image.size().width as usize;
    let (at, max) = differences
        .iter()
        .copied()
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut sorted = differences.clone();
    sorted.sort_by(f64::total_cmp);
    let within = (0.999 * sorted.len() as f64).ceil() as usize;
    let squares: f64 = differences.iter().map(|d| d * d).sum();
    Some(Difference {
        max,
        worst: ((at % width) as u32, (at / width) as u32),
        p999: sorted[within.clamp(1, sorted.len()) - 1],
        rms: (squares / differences.len() as f64).sqrt(),
    })
}

/// Returns the relative error of each channel of each pixel, as [`compare`] has them, in an image of alpha 1; `None` if
/// the sizes differ.
///
/// # Errors
/// [`Error::OutOfMemory`](crate::Error::OutOfMemory) as [`RadianceImage::new`].
pub fn relative_errors(
    image: &RadianceImage,
    reference: &RadianceImage,
) -> Result<Option<RadianceImage>> {
    if image.size() != reference.size() {
        return Ok(None);
    }
    let mut errors = RadianceImage::new(image.size())?;
    let pixels = image.as_slice().chunks_exact(4);
    let pixels = pixels.zip(reference.as_slice().chunks_exact(4));
    for (error, (pixel, truth)) in errors.as_mut_slice().chunks_exact_mut(4).zip(pixels) {
        for channel in 0..3 {
            error[channel] = relative(pixel[channel], truth[channel]) as f32;
        }
        error[3] = 1.0;
    }
    Ok(Some(errors))
}

fn relative(value: f32, reference: f32) -> f64 {
    let (value, reference) = (f64::from(value), f64::from(reference));
    if value == reference {
        return 0.0;
    }
    let difference = (value - reference).abs() / reference.abs();
    if difference.is_nan() {
        f64::INFINITY
    } else {
        difference
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::ImageSize;

    #[test]
    fn the_worst_pixel_is_found_and_nan_is_no_match() {
        let size = ImageSize {
            width: 3,
            height: 2,
        };
        let mut reference = RadianceImage::new(size).unwrap();
        reference.as_mut_slice().fill(2.0);
        let mut image = reference.clone();
        assert_eq!(compare(&image, &reference).unwrap().max, 0.0);
        image.as_mut_slice()[4 * 4 + 1] = 3.0;
        let difference = compare(&image, &reference).unwrap();
        assert_eq!((difference.max, difference.worst), (0.5, (1, 1)));
        image.as_mut_slice()[0] = f32::NAN;
        assert_eq!(compare(&image, &reference).unwrap().worst, (0, 0));
        let errors = relative_errors(&image, &reference).unwrap().unwrap();
        assert_eq!(errors.pixel(0, 0), Some([f32::INFINITY, 0.0, 0.0, 1.0]));
        assert_eq!(errors.pixel(1, 1), Some([0.0, 0.5, 0.0, 1.0]));
        assert_eq!(errors.pixel(2, 1), Some([0.0, 0.0, 0.0, 1.0]));
        let other = RadianceImage::new(ImageSize {
            width: 2,
            height: 3,
        });
        let other = other.unwrap();
        assert_eq!(compare(&other, &reference), None);
        assert_eq!(relative_errors(&other, &reference).unwrap(), None);
    }
}
