//! What frames are written to: a file for each, one for all, or a flipbook.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use energywave::image::{
    Alpha, AnimationFormat, Display, FlipbookLayout, FrameRate, ImageFormat, ImageSize,
};
use energywave::{Error, shown};

use super::arguments::{AnimateArguments, FramesFormat, Range};
use super::names::{FOLDER, Names};

/// Where frames go.
#[derive(Debug)]
pub enum Target {
    /// A file for each.
    Files { names: Names, format: ImageFormat },
    /// One that has them one after the other; of none the path is standard output.
    Animation {
        path: Option<PathBuf>,
        format: AnimationFormat,
    },
    /// One that has them side by side.
    Flipbook {
        path: PathBuf,
        format: ImageFormat,
        grid: ImageSize,
        padding: u32,
    },
}

impl Target {
    /// Understands what was typed; looks at no file but for whether it is a folder or a pipe.
    ///
    /// # Errors
    /// [`Error::Output`], [`Error::Unsupported`] for what does not go together.
    pub fn of(arguments: &AnimateArguments) -> Result<Self, Error> {
        let path = &arguments.output;
        let is_stdout = path == Path::new("-");
        if path.is_dir() {
            return Err(Error::output(path, FOLDER));
        }
        let format = match arguments.format {
            Some(format) => format,
            None => format_of(path)?,
        };
        let one_file = |what: &str| match arguments.shard {
            Some(_) => Err(Error::Unsupported(format!(
                "--shard: {what} needs all frames; write them as .png or .exr, which machines can share"
            ))),
            None => Ok(()),
        };
        let image_format = match format {
            FramesFormat::Png => Some(ImageFormat::Png),
            FramesFormat::Exr => Some(ImageFormat::Exr),
            FramesFormat::Apng | FramesFormat::Y4m => None,
        };
        if let Some(grid) = arguments.flipbook {
            one_file("a flipbook")?;
            return match image_format {
                Some(format) if !is_stdout => Ok(Self::Flipbook {
                    path: path.clone(),
                    format,
                    grid,
                    padding: arguments.padding.unwrap_or(0),
                }),
                _ => Err(Error::Unsupported(
                    "--flipbook: it is a .png or an .exr, in a file that a JSON is beside"
                        .to_owned(),
                )),
            };
        }
        if let Some(format) = image_format {
            if is_stdout {
                let message =
                    "frames are numbered files; standard output takes them as --format y4m or apng";
                return Err(Error::Unsupported(message.to_owned()));
            }
            let names = Names::of(path)?;
            return Ok(Self::Files { names, format });
        }
        one_file("one file")?;
        if arguments.json && is_stdout {
            let message =
                "--json: its report would stand between the frames on standard output; name a file";
            return Err(Error::Unsupported(message.to_owned()));
        }
        let format = match format {
            FramesFormat::Apng => AnimationFormat::Apng,
            _ => AnimationFormat::Y4m,
        };
        format.check_rate(arguments.fps)?;
        let path = (!is_stdout).then(|| path.clone());
        Ok(Self::Animation { path, format })
    }

    /// Returns the name of its format.
    pub fn format(&self) -> String {
        match self {
            Self::Files { format, .. } | Self::Flipbook { format, .. } => format!("{format:?}"),
            Self::Animation { format, .. } => format!("{format:?}"),
        }
    }

    /// Makes sure that it can hold what `display` asks for.
    ///
    /// # Errors
    /// [`Error::Scene`] with the key.
    pub fn check(&self, display: &Display) -> Result<(), Error> {
        match self {
            Self::Files { format, .. } => format.check(display),
            Self::Animation { format, .. } => format.check(display),
            // Whose alpha is premultiplied in a PNG, too.
            Self::Flipbook { format, .. } if display.alpha == Alpha::Additive => {
                format.check(&Display {
                    alpha: Alpha::Luminance,
                    ..display.clone()
                })
            }
            Self::Flipbook { format, .. } => format.check(display),
        }
    }

    /// Returns how frames of a size are laid side by side: of what is no flipbook, a single one.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if there are more frames than cells, or it is too large.
    pub fn layout(&self, frame: ImageSize, range: Range) -> Result<FlipbookLayout, Error> {
        let Self::Flipbook { grid, padding, .. } = self else {
            return Ok(FlipbookLayout {
                columns: 1,
                rows: 1,
                padding: 0,
                frame,
            });
        };
        let layout = FlipbookLayout {
            columns: grid.width,
            rows: grid.height,
            padding: *padding,
            frame,
        };
        let fault = |message: String| Error::Unsupported(format!("--flipbook: {message}"));
        layout.size().map_err(|error| fault(error.to_string()))?;
        if range.count() > layout.cells() {
            return Err(fault(format!(
                "{} frames, and {}x{} cells are {}; ask for more cells, or for fewer frames by --frames or --fps",
                range.count(),
                layout.columns,
                layout.rows,
                layout.cells()
            )));
        }
        Ok(layout)
    }

    /// Says which frames are drawn, and what they are called.
    pub fn frames_line(&self, range: Range, share: usize, rate: FrameRate) -> String {
        let Range { first, last } = range;
        let name = |frame: u32| match self {
            Self::Files { names, .. } => shown(&names.path(frame).to_string_lossy()),
            _ => frame.to_string(),
        };
        let of = match share == range.count() as usize {
            true => String::new(),
            false => format!(", of which this share has {share}"),
        };
        format!(
            "frames: {} to {}, {} at {rate} a second{of}",
            name(first),
            name(last),
            range.count()
        )
    }
}

/// Chooses a format by what a path ends with, or by what it is.
fn format_of(path: &Path) -> Result<FramesFormat, Error> {
    let ending = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    let is_stream = || std::fs::metadata(path).is_ok_and(|meta| !meta.is_file() && !meta.is_dir());
    match ending.to_ascii_lowercase().as_str() {
        "png" => Ok(FramesFormat::Png),
        "exr" => Ok(FramesFormat::Exr),
        "apng" => Ok(FramesFormat::Apng),
        "y4m" => Ok(FramesFormat::Y4m),
        _ if path == Path::new("-") || is_stream() => Ok(FramesFormat::Y4m),
        _ => Err(Error::Unsupported(format!(
            "{}: unknown ending of frames; use .png or .exr (a file for each), .apng or .y4m (one for all)",
            shown(&path.to_string_lossy())
        ))),
    }
}
