//! The formats of image files, and what each can hold.

use std::path::Path;

use super::{Alpha, Display};
use crate::error::{Error, Result, SceneError};
use crate::output::is_stream;

/// A file format, chosen by the ending of a file's name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImageFormat {
    /// Floats of 32 or 16 bits, linear, before exposure and tone mapping; alpha is premultiplied.
    Exr,
    /// 8 or 16 bits, sRGB, after both, dithered where it has 8; alpha is straight.
    Png,
    /// 8 bits, sRGB, lossless; alpha is straight.
    #[cfg(feature = "webp")]
    WebP,
    /// 8 bits, sRGB, without alpha; loses what the eye hardly sees.
    #[cfg(feature = "jpeg")]
    Jpeg,
}

impl ImageFormat {
    /// Chooses the format by the ending of a file's name; PNG for a pipe or a device without a known one.
    ///
    /// # Errors
    /// [`Error::OutputFormat`] for any other ending.
    pub fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            #[cfg(feature = "webp")]
            Some("webp") => Ok(Self::WebP),
            #[cfg(feature = "jpeg")]
            Some("jpg" | "jpeg") => Ok(Self::Jpeg),
            _ if is_stream(path) => Ok(Self::Png),
            _ => Err(Error::OutputFormat(path.to_owned())),
        }
    }

    /// Makes sure that the format can hold what `display` asks for.
    ///
    /// # Errors
    /// [`Error::Scene`] with the key: `display.alpha` or `display.bits`.
    pub fn check(self, display: &Display) -> Result<()> {
        let (name, bits) = (self.name(), self.bits());
        if let Some(asked) = display.bits.filter(|asked| !bits.contains(asked)) {
            let bits = bits.map(|bits| bits.to_string());
            let bits = match bits.first() == bits.last() {
                true => bits[0].clone(),
                false => bits.join(" or "),
            };
            let message = format!("{asked} bits a channel; {name} has {bits}");
            return Err(SceneError::value("display.bits", message).into());
        }
        let message = match (display.has_alpha(), display.alpha) {
            (false, _) | (_, Alpha::Opaque) => return Ok(()),
            _ if self == Self::Exr => return Ok(()),
            (_, Alpha::Luminance) if self.is_straight() => return Ok(()),
            (_, Alpha::Additive) if self.is_straight() => format!(
                "additive light has colour where alpha is 0, which the straight alpha of {name} cannot say; write an \
                 .exr, or use \"luminance\" or a background"
            ),
            _ => format!("{name} has no alpha; write an .exr or .png, or name a background"),
        };
        Err(SceneError::value("display.alpha", message).into())
    }

    fn name(self) -> &'static str {
        match self {
            Self::Exr => "EXR",
            Self::Png => "PNG",
            #[cfg(feature = "webp")]
            Self::WebP => "WebP",
            #[cfg(feature = "jpeg")]
            Self::Jpeg => "JPEG",
        }
    }

    /// Returns the fewest and the most bits of a channel.
    fn bits(self) -> [u32; 2] {
        match self {
            Self::Exr => [16, 32],
            Self::Png => [8, 16],
            #[cfg(any(feature = "webp", feature = "jpeg"))]
            _ => [8, 8],
        }
    }

    /// Returns whether it has an alpha that colour is not multiplied with.
    fn is_straight(self) -> bool {
        match self {
            Self::Exr => false,
            #[cfg(feature = "jpeg")]
            Self::Jpeg => false,
            _ => true,
        }
    }
}
