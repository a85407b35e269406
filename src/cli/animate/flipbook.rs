//! A flipbook, and the JSON beside it.

use std::path::Path;

use energywave::image::{
    Alpha, Display, Flipbook, FlipbookLayout, ImageFile, ImageFormat, Playback,
};
use energywave::{Error, TextFile, shown};
use serde::Serialize;

use super::work::Inbox;

/// What an engine needs to play a flipbook.
#[derive(Debug, Serialize)]
struct Sheet {
    version: &'static str,
    image: String,
    fps: f64,
    r#loop: bool,
    frames: u32,
    first_frame: u32,
    columns: u32,
    rows: u32,
    frame_width: u32,
    frame_height: u32,
    /// Pixels on each side of every frame.
    padding: u32,
    width: u32,
    height: u32,
    /// Stops: one number, or one for each frame where it changes.
    exposure: Exposures,
    bounds: Option<Bounds>,
    blend_mode: &'static str,
    color_space: &'static str,
    alpha: &'static str,
}

/// The part of a frame outside of which all frames are dark, pixels.
#[derive(Debug, Serialize)]
struct Bounds {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Exposures {
    One(f64),
    Each(Vec<f64>),
}

/// A flipbook's files, known to be writable.
pub struct Files {
    image: ImageFile,
    sheet: TextFile,
    name: String,
}

impl Files {
    /// # Errors
    /// [`Error::Output`] if one cannot be written.
    pub fn create(path: &Path, format: ImageFormat) -> Result<Self, Error> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Ok(Self {
            image: ImageFile::create_as(path, format)?,
            sheet: TextFile::create(path.with_extension("json"))?,
            name: shown(&name),
        })
    }

    /// Lays frames into it as they come, and writes both when all are there. `laid` is told of each.
    ///
    /// # Errors
    /// That of what brings the frames; [`Error::Output`], [`Error::OutOfMemory`].
    pub fn write(
        self,
        inbox: &Inbox<'_>,
        layout: FlipbookLayout,
        first: u32,
        playback: Playback,
        laid: impl Fn(),
    ) -> Result<(), Error> {
        let mut kept: Option<(Flipbook, Display)> = None;
        let mut exposures = Vec::new();
        while let Some(frame) = inbox.next()? {
            let display = &frame.display;
            let (book, _) = match &mut kept {
                Some(kept) => kept,
                None => {
                    let book = match self.image.format() {
                        ImageFormat::Exr => Flipbook::of_light(layout),
                        _ => Flipbook::of_pictures(layout, display),
                    }?;
                    kept.insert((book, display.clone()))
                }
            };
            book.lay(frame.number - first, &frame.image, display)?;
            exposures.push(display.exposure.stops(&frame.image));
            inbox.give_back(frame);
            laid();
        }
        let Some((book, display)) = kept else {
            return Ok(());
        };
        let sheet = self.sheet_of(&book, &display, layout, first, playback, exposures)?;
        match (book.light(), book.picture()) {
            (Some(light), _) => self.image.write(light, &Flipbook::display(display.bits))?,
            (_, Some(picture)) => self.image.write_picture(picture)?,
            (None, None) => {}
        }
        self.sheet.write(&sheet)
    }

    fn sheet_of(
        &self,
        book: &Flipbook,
        display: &Display,
        layout: FlipbookLayout,
        first: u32,
        playback: Playback,
        exposures: Vec<f64>,
    ) -> Result<String, Error> {
        let size = layout.size()?;
        let is_light = self.image.format() == ImageFormat::Exr;
        let is_one = exposures.windows(2).all(|pair| pair[0] == pair[1]);
        let (blend_mode, alpha) = match (&display.background, display.alpha) {
            (Some(_), _) => ("opaque", "one"),
            (None, Alpha::Luminance) => ("premultiplied", "premultiplied"),
            (None, Alpha::Additive) => ("additive", "zero"),
            (None, _) => ("additive", "one"),
        };
        let sheet = Sheet {
            version: env!("CARGO_PKG_VERSION"),
            image: self.name.clone(),
            fps: playback.rate.per_second(),
            r#loop: playback.loops,
            frames: playback.count,
            first_frame: first,
            columns: layout.columns,
            rows: layout.rows,
            frame_width: layout.frame.width,
            frame_height: layout.frame.height,
            padding: layout.padding,
            width: size.width,
            height: size.height,
            exposure: match exposures.first() {
                Some(stops) if is_one => Exposures::One(*stops),
                _ => Exposures::Each(exposures),
            },
            bounds: book.bounds().map(|[x, y, width, height]| Bounds {
                x,
                y,
                width,
                height,
            }),
            blend_mode,
            color_space: if is_light { "linear" } else { "srgb" },
            alpha,
        };
        let text = serde_json::to_string_pretty(&sheet);
        text.map(|text| text + "\n")
            .map_err(|error| Error::output(&self.name, error.to_string()))
    }
}
