//! What is behind the light: a colour, or an image.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{ImageSize, RadianceImage};
#[cfg(feature = "files")]
use crate::error::Result;

/// What is behind the light of a picture, opaque.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Background {
    /// A colour of the screen, linear RGB in `[0,1]`.
    Color([f64; 3]),
    /// An image of the picture's size.
    Image(Arc<BackgroundImage>),
}

/// An image behind the light: a picture for screens (PNG), over which tone-mapped light is laid, or light as the scene
/// has it (EXR), which is exposed and tone-mapped with it.
#[derive(Debug, PartialEq)]
pub struct BackgroundImage {
    file: Option<PathBuf>,
    image: RadianceImage,
    is_light: bool,
}

impl BackgroundImage {
    /// Makes a background of linear RGB. `is_light` says that it is light as the scene's is, before exposure and tone
    /// mapping; else it is a picture for screens, in `[0,1]`. Its alpha does not count.
    #[must_use]
    pub fn new(image: RadianceImage, is_light: bool) -> Self {
        Self {
            file: None,
            image,
            is_light,
        }
    }

    /// Reads an `.exr`, which is light, or a `.png` of 8 or 16 bits, a picture for screens. What is transparent in it
    /// is as over black.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) if the file cannot be read, or is another.
    #[cfg(feature = "files")]
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let is_light = path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
        let image = match is_light {
            true => RadianceImage::open(path)?,
            false => super::picture_file::open(path)?,
        };
        Ok(Self {
            file: Some(std::path::absolute(path).unwrap_or_else(|_| path.to_owned())),
            ..Self::new(image, is_light)
        })
    }

    /// Returns the file that it was opened from; `None` for one that was made in code.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Returns width and height in pixels.
    #[must_use]
    pub fn size(&self) -> ImageSize {
        self.image.size()
    }
}

impl Background {
    /// Returns the linear RGB behind a pixel of an image of this size; black where a background of another size has
    /// none.
    pub(super) fn linear(&self, size: ImageSize, index: usize) -> [f32; 3] {
        match self {
            Self::Color(color) => color.map(|channel| channel as f32),
            Self::Image(behind) => {
                let width = size.width.max(1) as usize;
                let (column, row) = ((index % width) as u32, (index / width) as u32);
                let [red, green, blue, _] = behind.image.pixel(column, row).unwrap_or_default();
                [red, green, blue]
            }
        }
    }

    /// Returns whether it is light as the scene's is.
    pub(super) fn is_light(&self) -> bool {
        matches!(self, Self::Image(behind) if behind.is_light)
    }
}
