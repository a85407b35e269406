//! What is said of the work when it is over: a line, or JSON for schedulers.

use std::path::Path;
use std::time::Duration;

use energywave::Error;
use serde::Serialize;

use super::arguments::Range;
use super::work::Times;

/// What was done, as `--json` prints it.
#[derive(Debug, Serialize)]
pub struct Report {
    version: &'static str,
    scene: String,
    /// What draws; `null` where nothing was to be drawn.
    device: Option<String>,
    /// The first and the last frame of all shares.
    first: u32,
    last: u32,
    /// How many frames of them are this share's: drawn and written, there already, and neither.
    frames: u32,
    done: u32,
    skipped: u32,
    failed: u32,
    /// Why the work ended before its end.
    error: Option<String>,
    /// How long the work took, which is shorter than its parts together: they are done side by side.
    seconds: f64,
    frames_per_second: Option<f64>,
    mean_seconds: Option<f64>,
    drawing_seconds: f64,
    /// Of all encoders together.
    encoding_seconds: f64,
    encoders: u32,
}

impl Report {
    pub fn new(scene: &Path, range: Range, frames: usize) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            scene: scene.to_string_lossy().into_owned(),
            device: None,
            first: range.first,
            last: range.last,
            frames: frames as u32,
            done: 0,
            skipped: 0,
            failed: 0,
            error: None,
            seconds: 0.0,
            frames_per_second: None,
            mean_seconds: None,
            drawing_seconds: 0.0,
            encoding_seconds: 0.0,
            encoders: 0,
        }
    }

    /// Adds how many frames are there already.
    pub fn skip(&mut self, count: usize) {
        self.skipped = count as u32;
    }

    /// Adds what was done, and how long that took.
    pub fn add(&mut self, device: String, encoders: usize, done: u32, times: Times) {
        self.device = Some(device);
        self.encoders = encoders as u32;
        self.done = done;
        let mean = |time: Duration| (done > 0).then(|| time.as_secs_f64() / f64::from(done));
        self.seconds = times.all.as_secs_f64();
        self.mean_seconds = mean(times.all);
        self.frames_per_second = self.mean_seconds.map(f64::recip);
        self.drawing_seconds = times.drawing.as_secs_f64();
        self.encoding_seconds = times.encoding.as_secs_f64();
    }

    /// Adds why the work did not go on.
    pub fn end(&mut self, outcome: &Result<(), Error>) {
        if let Err(error) = outcome {
            self.failed = self.frames - self.done - self.skipped;
            self.error = Some(error.to_string());
        }
    }

    /// Says what there is after Ctrl-C.
    pub fn interrupted(&self) -> String {
        format!(
            "interrupted; {} of {} frames are there and whole, the same command draws the others",
            self.done + self.skipped,
            self.frames
        )
    }

    /// Says it in a line.
    pub fn line(&self) -> String {
        let skipped = match self.skipped {
            0 => String::new(),
            skipped => format!(" and {skipped} were there"),
        };
        let Some(rate) = self.frames_per_second else {
            return format!("frames: {} of {} drawn{skipped}", self.done, self.frames);
        };
        let done = f64::from(self.done.max(1));
        format!(
            "drawn: {} of {} frames{skipped}; {:.2} s on {}, {rate:.2} frames a second; a frame took {:.1} ms to draw \
             and {:.1} ms to encode, side by side",
            self.done,
            self.frames,
            self.seconds,
            self.device.as_deref().unwrap_or_default(),
            1e3 * self.drawing_seconds / done,
            1e3 * self.encoding_seconds / done,
        )
    }
}
