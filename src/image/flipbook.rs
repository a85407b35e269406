//! All frames of an animation side by side in one image, as engines play them on a quad.

use super::display::Film;
use super::{Alpha, Display, DisplayImage, ImageSize, RadianceImage};
use crate::error::{Error, Result};

/// Where frames stand in a flipbook: by rows from the top left, each in the middle of a cell that is larger by twice
/// the padding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FlipbookLayout {
    /// Cells side by side.
    pub columns: u32,
    /// Cells one below the other.
    pub rows: u32,
    /// Empty pixels on each side of a frame.
    pub padding: u32,
    /// The size of a frame, pixels.
    pub frame: ImageSize,
}

impl FlipbookLayout {
    /// Returns how many frames there is room for.
    #[must_use]
    pub fn cells(&self) -> u32 {
        self.columns.saturating_mul(self.rows)
    }

    /// Returns the size of the flipbook.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if that is larger than an image can be, or nothing.
    pub fn size(&self) -> Result<ImageSize> {
        let side = |cells: u32, pixels: u32| {
            let cell = u64::from(pixels) + 2 * u64::from(self.padding);
            cell.saturating_mul(cells.into())
        };
        let width = side(self.columns, self.frame.width);
        let height = side(self.rows, self.frame.height);
        let limit = u64::from(ImageSize::LIMIT);
        if width.min(height) == 0 || width.max(height) > limit {
            return Err(Error::Unsupported(format!(
                "a flipbook of {}x{} frames of {}x{} pixels, {} around each, has {width}x{height}; an image has at \
                 most {limit}x{limit}: make frames smaller, or fewer",
                self.columns, self.rows, self.frame.width, self.frame.height, self.padding
            )));
        }
        Ok(ImageSize {
            width: width as u32,
            height: height as u32,
        })
    }
}

/// A flipbook that frames are laid into: light as an EXR has it, or a picture as a PNG has it but for its alpha, which
/// is premultiplied.
#[derive(Debug)]
pub struct Flipbook {
    layout: FlipbookLayout,
    pages: Pages,
    /// The rows and columns of a frame that have light in any: left, top, and those behind the last.
    lit: Option<[u32; 4]>,
}

#[derive(Debug)]
enum Pages {
    Light(RadianceImage),
    Picture(DisplayImage),
}

/// What is shown as this part of white, or less, is dark: half a step of 8 bits of sRGB.
const DARK: f32 = 0.5 / 255.0 / 12.92;

impl Flipbook {
    /// Makes one of linear light, float32, before exposure and tone mapping.
    ///
    /// # Errors
    /// As [`FlipbookLayout::size`], and [`Error::OutOfMemory`].
    pub fn of_light(layout: FlipbookLayout) -> Result<Self> {
        let pages = Pages::Light(RadianceImage::new(layout.size()?)?);
        Ok(Self::new(layout, pages))
    }

    /// Makes one of pictures for screens, as `display` makes them of light: sRGB, colour times alpha before it is
    /// encoded. It has an alpha channel where `display` has one.
    ///
    /// # Errors
    /// As [`Flipbook::of_light`].
    pub fn of_pictures(layout: FlipbookLayout, display: &Display) -> Result<Self> {
        let size = layout.size()?;
        let (channels, bits) = (
            3 + usize::from(display.has_alpha()),
            display.bits.unwrap_or(8),
        );
        let bytes = size.pixels() * channels * bits.div_ceil(8) as usize;
        let mut data = Vec::new();
        data.try_reserve_exact(bytes).map_err(|_| {
            let message = format!("a flipbook of {} MiB: make frames smaller", bytes >> 20);
            Error::OutOfMemory(message)
        })?;
        data.resize(bytes, 0);
        let picture = DisplayImage {
            size,
            channels,
            bits,
            data,
        };
        Ok(Self::new(layout, Pages::Picture(picture)))
    }

    fn new(layout: FlipbookLayout, pages: Pages) -> Self {
        Self {
            layout,
            pages,
            lit: None,
        }
    }

    /// Lays a frame into a cell, as `display` makes it; cells are counted by rows from 0.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if there is no such cell, or the frame has another size; [`Error::OutOfMemory`].
    pub fn lay(&mut self, cell: u32, image: &RadianceImage, display: &Display) -> Result<()> {
        let FlipbookLayout {
            columns,
            padding,
            frame,
            ..
        } = self.layout;
        if cell >= self.layout.cells() || image.size() != frame {
            return Err(Error::Unsupported(format!(
                "flipbook: frame {cell} of {}x{} pixels; it has {} of {}x{}",
                image.size().width,
                image.size().height,
                self.layout.cells(),
                frame.width,
                frame.height
            )));
        }
        let place = |count: u32, side: u32| (count * (side + 2 * padding) + padding) as usize;
        let left = place(cell % columns, frame.width);
        let top = place(cell / columns, frame.height);
        self.see(image, display);
        match &mut self.pages {
            Pages::Light(pages) => {
                let film = Film::with_bloom(image, display)?;
                let (across, width) = (pages.size.width as usize, frame.width as usize);
                for row in 0..frame.height as usize {
                    let begin = 4 * ((top + row) * across + left);
                    let target = &mut pages.data[begin..][..4 * width];
                    for (column, pixel) in target.chunks_exact_mut(4).enumerate() {
                        pixel.copy_from_slice(&film.pixel(row * width + column));
                    }
                }
            }
            Pages::Picture(pages) => {
                let picture = image.tone_map_premultiplied(display);
                let pixel = picture.channels * picture.bits as usize / 8;
                let (across, width) = (
                    pixel * pages.size.width as usize,
                    pixel * frame.width as usize,
                );
                for (row, line) in picture.data.chunks_exact(width).enumerate() {
                    let begin = (top + row) * across + pixel * left;
                    pages.data[begin..][..width].copy_from_slice(line);
                }
            }
        }
        Ok(())
    }

    /// Adds what is lit in a frame to what is lit in those before.
    fn see(&mut self, image: &RadianceImage, display: &Display) {
        let film = Film::new(image, display);
        let width = image.size().width;
        for (index, pixel) in (0..).zip(image.as_slice().chunks_exact(4)) {
            if !film.is_lit([pixel[0], pixel[1], pixel[2]], DARK) {
                continue;
            }
            let (column, row) = (index % width, index / width);
            let [left, top, right, bottom] = self.lit.unwrap_or([column, row, 0, 0]);
            self.lit = Some([
                left.min(column),
                top.min(row),
                right.max(column + 1),
                bottom.max(row + 1),
            ]);
        }
    }

    /// Returns the smallest part of a frame outside of which all frames are dark on a screen of 8 bits: its first
    /// column and row, its width and height, pixels. `None` where all are dark.
    #[must_use]
    pub fn bounds(&self) -> Option<[u32; 4]> {
        let [left, top, right, bottom] = self.lit?;
        Some([left, top, right - left, bottom - top])
    }

    /// Returns the light that was laid into it; `None` if it has pictures.
    #[must_use]
    pub fn light(&self) -> Option<&RadianceImage> {
        match &self.pages {
            Pages::Light(pages) => Some(pages),
            Pages::Picture(_) => None,
        }
    }

    /// Returns the pictures that were laid into it, with premultiplied alpha; `None` if it has light.
    #[must_use]
    pub fn picture(&self) -> Option<&DisplayImage> {
        match &self.pages {
            Pages::Light(_) => None,
            Pages::Picture(pages) => Some(pages),
        }
    }

    /// Returns what says how the file of [`Flipbook::light`] is to be written: as it is.
    #[must_use]
    pub fn display(bits: Option<u32>) -> Display {
        Display {
            alpha: Alpha::Opaque,
            bits,
            ..Display::default()
        }
    }
}
