//! Linear radiance to 8-bit sRGB: exposure, tone mapping, sRGB encoding, dither.

use super::srgb::srgb_encode;
use super::{DisplayImage, RadianceImage, ToneMap};
use crate::threads;

/// How linear radiance becomes an 8-bit picture.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Display {
    /// Exposure in stops: radiance times `2^exposure`.
    pub exposure: f64,
    /// The curve that brings radiance into `[0,1]`.
    pub tone_map: ToneMap,
}

impl RadianceImage {
    /// Makes the picture for a screen, dithered so that wide glows do not band; black stays black and white stays
    /// white.
    #[must_use]
    pub fn tone_map(&self, display: &Display) -> DisplayImage {
        let gain = display.exposure.exp2() as f32;
        let width = self.size.width as usize;
        let mut data = vec![0_u8; 3 * self.size.pixels()];
        threads::for_each_chunk(&mut data, 3, |i, bytes| {
            let threshold = gradient_noise(i % width, i / width);
            let light = [0, 1, 2].map(|channel| gain * self.data[4 * i + channel]);
            for (byte, shown) in bytes.iter_mut().zip(display.tone_map.apply(light)) {
                *byte = (srgb_encode(shown) * 255.0 + threshold) as u8;
            }
        });
        DisplayImage {
            size: self.size,
            data,
        }
    }
}

/// Returns interleaved gradient noise in [0,1) (Jimenez 2014), a dither threshold whose error the eye averages away.
fn gradient_noise(column: usize, row: usize) -> f32 {
    let phase = 0.067_110_56 * column as f64 + 0.005_837_15 * row as f64;
    ((52.982_918_9 * phase.fract()).fract() as f32).min(0.999)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::ImageSize;

    fn flat(radiance: f32) -> DisplayImage {
        let size = ImageSize {
            width: 64,
            height: 64,
        };
        let mut image = RadianceImage::new(size).unwrap();
        image.as_mut_slice().fill(radiance);
        image.tone_map(&Display {
            exposure: 0.0,
            tone_map: ToneMap::Clamp,
        })
    }

    #[test]
    fn black_and_white_are_not_dithered_and_greys_keep_their_mean() {
        assert!(flat(0.0).as_slice().iter().all(|byte| *byte == 0));
        assert!(flat(1.0).as_slice().iter().all(|byte| *byte == 255));
        let encoded = 255.0 * srgb_encode(0.2);
        let picture = flat(0.2);
        let sum: f32 = picture.as_slice().iter().map(|byte| f32::from(*byte)).sum();
        let mean = sum / picture.as_slice().len() as f32;
        assert!((mean - encoded).abs() < 0.02, "{mean} {encoded}");
    }
}
