//! Who encodes frames, and writes them.

use std::io::{IsTerminal, stdout};
use std::iter;
use std::num::NonZero;
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;

use energywave::image::{AnimationFile, FlipbookLayout, ImageFile, ImageFormat, Playback};
use energywave::{Device, Error, Scene};

use super::flipbook::Files;
use super::names::Names;
use super::source::Fingerprints;
use super::target::Target;
use super::work::{Encoder, Inbox};
use crate::cli::render::noted;

/// More threads than that find little to encode.
const MOST_ENCODERS: usize = 16;

/// What is written to, known to be writable.
pub enum Sink<'a> {
    Files(&'a Names, ImageFormat),
    Animation(AnimationFile),
    Flipbook(Files, FlipbookLayout),
}

/// What files say of frames, and where is counted how many are written.
#[derive(Clone, Copy)]
pub struct Written<'a> {
    pub scene: &'a Path,
    pub first: &'a Scene,
    pub devices: &'a [Device],
    pub fingerprints: &'a Fingerprints,
    pub done: &'a AtomicU32,
}

impl<'a> Sink<'a> {
    /// Makes sure that all can be written; of files for each frame, that the first can.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn open(target: &'a Target, layout: FlipbookLayout, first: u32) -> Result<Self, Error> {
        Ok(match target {
            Target::Flipbook { path, format, .. } => {
                Self::Flipbook(Files::create(path, *format)?, layout)
            }
            Target::Files { names, format } => {
                drop(ImageFile::create_as(names.path(first), *format)?);
                Self::Files(names, *format)
            }
            Target::Animation { path, format } => Self::Animation(match path {
                Some(path) => AnimationFile::create_as(path, *format)?,
                None if stdout().is_terminal() => {
                    let reason = "it is a terminal; name a file, or send it to a program";
                    return Err(Error::output("standard output", reason));
                }
                None => AnimationFile::stdout(*format),
            }),
        })
    }

    /// Returns those who encode, each to run on a thread of its own.
    pub fn encoders(
        self,
        written: Written<'a>,
        playback: Playback,
        first: u32,
    ) -> Vec<Encoder<'a>> {
        let count = move || {
            written.done.fetch_add(1, Ordering::Relaxed);
        };
        match self {
            Self::Files(names, format) => {
                let encode = move |inbox: &Inbox<'_>| {
                    while let Some(frame) = inbox.next()? {
                        let file = ImageFile::create_as(names.path(frame.number), format)?;
                        let file = file.fingerprint(written.fingerprints.of(frame.number));
                        noted(file, written.scene, written.first, written.devices)
                            .write(&frame.image, &frame.display)?;
                        inbox.give_back(frame);
                        count();
                    }
                    Ok(())
                };
                let threads = thread::available_parallelism().map_or(1, NonZero::get);
                let threads = threads.min(MOST_ENCODERS).min(playback.count as usize);
                (0..threads)
                    .map(|_| Box::new(encode) as Encoder<'a>)
                    .collect()
            }
            Self::Animation(file) => vec![Box::new(move |inbox| {
                let pictures = iter::from_fn(|| {
                    let frame = match inbox.next() {
                        Ok(frame) => frame?,
                        Err(error) => return Some(Err(error)),
                    };
                    let picture = frame.image.tone_map(&frame.display);
                    inbox.give_back(frame);
                    count();
                    Some(Ok(picture))
                });
                file.write(playback, pictures)
            })],
            Self::Flipbook(files, layout) => vec![Box::new(move |inbox| {
                files.write(inbox, layout, first, playback, count)
            })],
        }
    }
}
