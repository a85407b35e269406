//! Linear radiance to 8-bit sRGB: exposure, tone mapping, sRGB encoding, dither.

use serde::{Deserialize, Serialize};

use super::{DisplayImage, RadianceImage};
use crate::threads;

/// How linear radiance becomes an 8-bit picture.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Display {
    /// Exposure in stops: radiance times `2^exposure`.
    pub exposure: f64,
    /// The curve that brings radiance into `[0,1]`.
    pub tone_map: ToneMap,
}

/// A tone-mapping curve, applied to each channel `L` of exposed radiance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum ToneMap {
    /// `min(L, 1)`.
    Clamp,
    /// `1 - exp(-L)`.
    #[default]
    Exponential,
    /// `L / (1 + L)` (Reinhard et al. 2002).
    Reinhard,
    /// The rational fit to the ACES filmic curve by Narkowicz 2015.
    Aces,
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
            for (byte, light) in bytes.iter_mut().zip(&self.data[4 * i..]) {
                let shown = srgb_encode(display.tone_map.apply(light * gain));
                *byte = (shown * 255.0 + threshold) as u8;
            }
        });
        DisplayImage {
            size: self.size,
            data,
        }
    }
}

impl ToneMap {
    /// Brings exposed radiance of one channel into `[0,1]`; negative radiance is black.
    #[must_use]
    pub fn apply(self, radiance: f32) -> f32 {
        let l = radiance.max(0.0);
        let shown = match self {
            Self::Clamp => l,
            Self::Exponential => -(-l).exp_m1(),
            Self::Reinhard if l.is_infinite() => 1.0,
            Self::Reinhard => l / (1.0 + l),
            Self::Aces => {
                let l = l.min(1e4);
                l * (2.51 * l + 0.03) / (l * (2.43 * l + 0.59) + 0.14)
            }
        };
        shown.min(1.0)
    }
}

/// Encodes a linear value of `[0,1]` by the sRGB transfer function (IEC 61966-2-1).
fn srgb_encode(linear: f32) -> f32 {
    match linear {
        l if l <= 0.003_130_8 => 12.92 * l,
        l if l < 1.0 => 1.055 * l.powf(1.0 / 2.4) - 0.055,
        _ => 1.0,
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

    #[test]
    fn every_curve_rises_from_black_to_at_most_white() {
        let curves = [
            ToneMap::Clamp,
            ToneMap::Exponential,
            ToneMap::Reinhard,
            ToneMap::Aces,
        ];
        for curve in curves {
            assert_eq!(curve.apply(0.0), 0.0);
            assert_eq!(curve.apply(-1.0), 0.0);
            let mut before = 0.0;
            for i in 0..400 {
                let shown = curve.apply(1.05_f32.powi(i) * 1e-3);
                assert!(shown >= before && shown <= 1.0, "{curve:?} {i}: {shown}");
                before = shown;
            }
            assert!(curve.apply(f32::INFINITY) <= 1.0);
        }
        assert!((ToneMap::Exponential.apply(1.0) - 0.632_120_6).abs() < 1e-6);
        assert!((ToneMap::Reinhard.apply(3.0) - 0.75).abs() < 1e-6);
    }
}
