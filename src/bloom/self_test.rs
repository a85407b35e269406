//! The first use of freshly built kernels: a small picture whose bloom the host knows. Some drivers miscompile kernels.

use super::Spreader;
use super::kernels::Kernels;
use crate::error::{Error, Result};
use crate::image::{Bloom, ImageSize, RadianceImage};
use crate::opencl::{Compute, Film, FilmFormat, Pixel, Program, RendererOptions};

/// No multiple of a piece or a group, with levels of odd and even sizes.
const SIZE: ImageSize = ImageSize {
    width: 87,
    height: 46,
};

/// The error that a channel may have, relative to itself: what float32 loses, and what half floats do.
const LIMIT: f32 = 1e-5;
const HALF_LIMIT: f32 = 1e-3;

/// Tests kernels, unless that was done on this device before.
///
/// # Errors
/// [`Error::SelfTest`] if they compute wrong.
pub(super) fn self_test(
    compute: &Compute,
    format: FilmFormat,
    options: &RendererOptions,
    (kernels, program): (Kernels, &Program),
) -> Result<Kernels> {
    let is_experiment = options.skips_self_test || compute.device().is_simulator;
    if is_experiment || program.was_tested() {
        return Ok(kernels);
    }
    // On a queue of its own: the renderer's may wait for a host.
    let compute = &compute.sibling()?;
    let mut tester = Spreader::new(options);
    tester.kernels.insert(format, kernels);
    let bloom = Bloom {
        strength: 0.5,
        radius: 0.2,
    };
    let before = known_picture()?;
    let expected = before.bloomed(&bloom)?;
    let mut film = Film::in_format(compute, format, SIZE.width, SIZE.height)?;
    film.write(compute, pixels_of(&before))?;
    tester.spread(compute, &mut film, SIZE, &bloom)?;
    let mut found = vec![[0.0; 4]; SIZE.pixels()];
    film.read(compute, &mut found)?;
    tester.settle(compute)?;
    let limit = match format {
        FilmFormat::Halves => HALF_LIMIT,
        FilmFormat::Floats | FilmFormat::Image { .. } => LIMIT,
    };
    let is_right = |(found, expected): (&Pixel, &Pixel)| {
        let mut pairs = found.iter().zip(expected);
        // Which no NaN is.
        pairs.all(|(found, expected)| (found - expected).abs() <= limit * expected.abs())
    };
    let expected = pixels_of(&expected);
    if let Some(index) = found.iter().zip(expected).position(|pair| !is_right(pair)) {
        let device = compute.device();
        return Err(Error::SelfTest {
            device: device.name.clone(),
            driver: format!("{} {}", device.platform, device.driver),
            reason: format!(
                "pixel {index} of the test's bloom is {:?}, not {:?}",
                found[index], expected[index]
            ),
        });
    }
    program.mark_tested();
    tester
        .kernels
        .remove(&format)
        .ok_or_else(|| Error::Unsupported("the bloom's kernels were lost in their test".to_owned()))
}

/// Sparks on a glow that grows to the right and down.
fn known_picture() -> Result<RadianceImage> {
    let mut image = RadianceImage::new(SIZE)?;
    for (index, pixel) in image.as_mut_slice().chunks_exact_mut(4).enumerate() {
        let glow = 0.1 + index as f32 / SIZE.pixels() as f32;
        let spark = if index % 101 == 7 { 50.0 } else { 0.0 };
        pixel.copy_from_slice(&[glow + spark, 0.5 * glow, 0.1 + 0.3 * spark, 1.0]);
    }
    Ok(image)
}

fn pixels_of(image: &RadianceImage) -> &[Pixel] {
    image.as_slice().as_chunks().0
}
