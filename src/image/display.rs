//! Linear radiance to an sRGB picture: bloom, background, exposure, tone mapping, alpha, sRGB encoding, dither.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::bloom::Glow;
use super::srgb::srgb_encode;
use super::{Background, Bloom, DisplayImage, Exposure, RadianceImage, ToneMap};
#[cfg(feature = "files")]
use crate::error::Result;
use crate::threads;

/// How linear radiance becomes a picture. Structs may get further fields: write `..Display::default()`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Display {
    /// What radiance is multiplied with.
    pub exposure: Exposure,
    /// The curve that brings radiance into `[0,1]`.
    pub tone_map: ToneMap,
    /// What the light hides of what is behind it, and what a file's alpha says of that.
    pub alpha: Alpha,
    /// What is behind the light; a file then holds both, and is opaque.
    pub background: Option<Background>,
    /// Light that is spread around what is bright; of the scene's light alone, not of a background's, and of none that
    /// [has a bloom](RadianceImage::bloom) already.
    pub bloom: Option<Bloom>,
    /// Bits of a channel: 8 or 16 of a PNG, 16 or 32 (floats) of an EXR. `None`: 8, and 32 of an EXR.
    pub bits: Option<u32>,
    /// How well a JPEG is encoded, 1 to 100. `None`: 90.
    pub quality: Option<u32>,
}

/// What light hides of what is behind it, and what a file says of that.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Alpha {
    /// Light adds to a background. Files have no background behind them: alpha is 1.
    #[default]
    Opaque,
    /// Light adds to what it is laid over: alpha is 0, colour is not. Only EXR can say that.
    Additive,
    /// Light hides what is behind it as far as it is bright: alpha is the greatest channel of the exposed, tone-mapped
    /// light, still linear, so that over black the picture is the opaque one.
    Luminance,
}

/// A pixel on its way to a screen: linear colour in `[0,1]`, times alpha, and alpha.
type Shown = ([f32; 3], f32);

impl RadianceImage {
    /// Makes the picture for a screen, dithered where it has 8 bits so that wide glows do not band; black stays black
    /// and white stays white. It has an alpha channel, straight, where `display` asks for [`Alpha::Luminance`] and has
    /// no background.
    #[must_use]
    pub fn tone_map(&self, display: &Display) -> DisplayImage {
        let has_alpha = display.has_alpha() && display.alpha == Alpha::Luminance;
        self.picture(display, has_alpha, stored)
    }

    /// Makes the picture whose colour is that of the light, encoded, and whose alpha is what it hides: none, all, or
    /// what [`Alpha::Additive`] and [`Alpha::Luminance`] say where there is no background.
    #[cfg(feature = "files")]
    pub(super) fn tone_map_premultiplied(&self, display: &Display) -> DisplayImage {
        let hides_nothing = display.alpha == Alpha::Additive;
        self.picture(display, display.has_alpha(), |(color, alpha), white| {
            let alpha = if hides_nothing { 0.0 } else { alpha };
            premultiplied((color, alpha), white)
        })
    }

    fn picture(
        &self,
        display: &Display,
        has_alpha: bool,
        stored: impl Fn(Shown, f32) -> [f32; 4] + Send + Sync,
    ) -> DisplayImage {
        let (channels, bits) = (3 + usize::from(has_alpha), display.bits.unwrap_or(8));
        let bytes = usize::from(bits == 16) + 1;
        let film = Film::new(self, display);
        let white = if bytes == 1 { 255.0 } else { 65535.0 };
        let store = |(column, row): (usize, usize), values: [f32; 4], pixel: &mut [u8]| match bytes
        {
            1 => {
                let threshold = gradient_noise(column, row);
                for (byte, value) in pixel.iter_mut().zip(values) {
                    *byte = (value + threshold) as u8;
                }
            }
            _ => {
                for (pair, value) in pixel.chunks_exact_mut(2).zip(values) {
                    pair.copy_from_slice(&((value + 0.5) as u16).to_ne_bytes());
                }
            }
        };
        // Where there is no light, which is most of many pictures, nothing has to be worked out.
        let nothing = || stored(film.shown(0, [0.0; 3], white), white);
        let is_black =
            display.background.is_none() && nothing()[..channels] == [0.0; 4][..channels];
        let width = self.size.width as usize;
        let pixel_bytes = bytes * channels;
        let mut data = vec![0_u8; pixel_bytes * self.size.pixels()];
        threads::for_each_chunk(&mut data, pixel_bytes * width, |row, pixels| {
            let light = film.row(row);
            let pixels = pixels.chunks_exact_mut(pixel_bytes);
            for (column, (pixel, light)) in pixels.zip(light.chunks_exact(4)).enumerate() {
                let light = [light[0], light[1], light[2]];
                if is_black && light == [0.0; 3] {
                    continue; // as it was made
                }
                let shown = film.shown(row * width + column, light, white);
                store((column, row), stored(shown, white), pixel);
            }
        });
        DisplayImage {
            size: self.size,
            channels,
            bits: 8 * bytes as u32,
            data,
        }
    }
}

/// An image, and what a display makes of it.
pub(super) struct Film<'a> {
    image: Cow<'a, RadianceImage>,
    display: &'a Display,
    gain: f32,
    glow: Option<Glow>,
}

impl<'a> Film<'a> {
    pub(super) fn new(image: &'a RadianceImage, display: &'a Display) -> Self {
        let bloom = display.bloom_of(image);
        Self {
            image: Cow::Borrowed(image),
            display,
            gain: display.exposure.stops(image).exp2() as f32,
            glow: bloom.map(|bloom| Glow::new(image.size, &image.data, &bloom)),
        }
    }

    /// Spreads the light of all pixels at once, for [`pixel`](Self::pixel).
    #[cfg(feature = "files")]
    pub(super) fn with_bloom(image: &'a RadianceImage, display: &'a Display) -> Result<Self> {
        Ok(Self {
            image: match display.bloom_of(image) {
                Some(bloom) => Cow::Owned(image.bloomed(&bloom)?),
                None => Cow::Borrowed(image),
            },
            display,
            gain: display.exposure.stops(image).exp2() as f32,
            glow: None,
        })
    }

    /// Returns linear RGBA before exposure and tone mapping: colour times alpha, over the background if there is one. A
    /// bloom the image has already.
    #[cfg(feature = "files")]
    pub(super) fn pixel(&self, index: usize) -> [f32; 4] {
        let [red, green, blue, alpha] = [0, 1, 2, 3].map(|it| self.image.data[4 * index + it]);
        let light = [red, green, blue];
        let hidden = match self.display.alpha {
            Alpha::Luminance => most(self.map(light)),
            Alpha::Opaque | Alpha::Additive => 0.0,
        };
        let ([red, green, blue], alpha) = match (&self.display.background, self.display.alpha) {
            (Some(background), _) => (
                over(light, hidden, background.linear(self.image.size, index)),
                1.0,
            ),
            (None, Alpha::Opaque) => (light, alpha),
            (None, _) => (light, hidden),
        };
        [red, green, blue, alpha]
    }

    /// Returns whether a screen shows more than a part of white where there is such light.
    #[cfg(feature = "files")]
    pub(super) fn is_lit(&self, light: [f32; 3], part: f32) -> bool {
        most(self.map(light)) > part
    }

    /// Exposes light and maps it to the screen.
    fn map(&self, light: [f32; 3]) -> [f32; 3] {
        self.display
            .tone_map
            .apply(light.map(|channel| self.gain * channel))
    }

    /// Returns the light of a row, 4 values a pixel.
    fn row(&self, row: usize) -> Cow<'_, [f32]> {
        let values = 4 * self.image.size.width as usize;
        let light = &self.image.data[row * values..(row + 1) * values];
        match &self.glow {
            Some(glow) => {
                let mut light = light.to_vec();
                glow.give(row, &mut light);
                light.into()
            }
            None => light.into(),
        }
    }

    /// Tone-maps a pixel, over its background: light before its exposure where that is light, too. What it hides is a
    /// whole number of steps, of which `white` make 1: so a picture is what a file without a background gives over it.
    fn shown(&self, index: usize, light: [f32; 3], white: f32) -> Shown {
        let color = self.map(light);
        let hidden = match self.display.alpha {
            Alpha::Luminance => (white * most(color)).ceil() / white,
            Alpha::Opaque | Alpha::Additive => 0.0,
        };
        match &self.display.background {
            None if self.display.alpha == Alpha::Luminance => (color, hidden),
            None => (color, 1.0),
            Some(background) => {
                let behind = background.linear(self.image.size, index);
                let color = match background.is_light() {
                    true => self.map(over(light, hidden, behind)),
                    false => over(color, hidden, behind).map(|l| l.min(1.0)),
                };
                (color, 1.0)
            }
        }
    }
}

impl Display {
    /// Returns the bloom that an image is still to have.
    pub(super) fn bloom_of(&self, image: &RadianceImage) -> Option<Bloom> {
        let is_due = |bloom: &Bloom| bloom.strength > 0.0 && image.bloom.is_none();
        self.bloom.filter(is_due)
    }

    /// Returns whether a file says how much its light hides.
    pub(super) fn has_alpha(&self) -> bool {
        self.alpha != Alpha::Opaque && self.background.is_none()
    }
}

/// Lays light over what is behind it, of which it hides a share.
fn over(light: [f32; 3], hidden: f32, behind: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|channel| light[channel] + (1.0 - hidden) * behind[channel])
}

fn most(color: [f32; 3]) -> f32 {
    color.into_iter().fold(0.0, f32::max)
}

/// Returns a pixel's values, 0 to `white`, before they are rounded, and its alpha. Colour is divided by the alpha that
/// is stored: so dark light is as exact over black as opaque light is.
fn stored((color, alpha): Shown, white: f32) -> [f32; 4] {
    let values = |color: [f32; 3], alpha: f32| {
        let [red, green, blue] = color.map(|channel| white * srgb_encode(channel));
        [red, green, blue, alpha]
    };
    match alpha {
        1.0 => values(color, white),
        alpha if alpha > 0.0 => values(color.map(|it| it / alpha), (alpha * white).round()),
        _ => [0.0; 4],
    }
}

/// Returns a pixel's values, 0 to `white`, before they are rounded, and its alpha: colour is that of the light.
#[cfg(feature = "files")]
fn premultiplied((color, alpha): Shown, white: f32) -> [f32; 4] {
    let [red, green, blue] = color.map(|channel| white * srgb_encode(channel));
    [red, green, blue, (alpha * white).round()]
}

/// Returns interleaved gradient noise in [0,1) (Jimenez 2014), a dither threshold whose error the eye averages away.
fn gradient_noise(column: usize, row: usize) -> f32 {
    let phase = 0.067_110_56 * column as f64 + 0.005_837_15 * row as f64;
    (fraction(52.982_918_9 * fraction(phase)) as f32).min(0.999)
}

/// Returns a positive number without its whole part, without the call that this is on processors of the base line.
fn fraction(value: f64) -> f64 {
    value - value as i64 as f64
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
            tone_map: ToneMap::Clamp,
            ..Display::default()
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
    fn where_there_is_no_light_a_picture_is_as_where_there_is_less() {
        let size = ImageSize {
            width: 9,
            height: 7,
        };
        let mut image = RadianceImage::new(size).unwrap();
        let maps = [
            ToneMap::Agx,
            ToneMap::Clamp,
            ToneMap::Exponential,
            ToneMap::KhronosNeutral,
        ];
        for (tone_map, alpha) in maps
            .into_iter()
            .flat_map(|map| [(map, Alpha::Opaque), (map, Alpha::Luminance)])
        {
            let display = Display {
                tone_map,
                alpha,
                ..Display::default()
            };
            let mut picture = |light: f32| {
                image.as_mut_slice().fill(light);
                image.tone_map(&display)
            };
            // Below 0 light is none, and is worked out.
            assert_eq!(picture(0.0), picture(-1.0), "{display:?}");
            assert_ne!(picture(0.0), picture(0.1), "{display:?}");
        }
    }
}
