//! `energywave animate`: the frames of a scene that moves, each a function of its time alone.

mod arguments;
mod flipbook;
mod frames;
mod names;
mod report;
mod sink;
mod source;
mod target;
mod work;

use std::io;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};

use energywave::image::{Exposure, ImageFile, Playback};
use energywave::{Device, Error, Renderer, Scene};

use super::progress::{Progress, catch_interrupts, was_interrupted};
use super::{Failure, Outcome, choose_devices, names as names_of, note, print_json, tell_depths};
pub use arguments::{AnimateArguments, Range, range};
pub use names::Names;
use report::Report;
use sink::Sink;
use source::Source;
use target::Target;
use work::work;

pub fn run(arguments: &AnimateArguments) -> Outcome {
    let target = Target::of(arguments)?;
    let source = Source::open(arguments, &target)?;
    let range = frames::range(arguments, &source.scene)?;
    let frames = frames::share(range, arguments.shard);
    let first = source.at(range.first)?;
    let layout = target.layout(first.image, range)?;
    source.warn_of(range.first)?;
    // Waits for the reader of a pipe: before Ctrl-C is caught.
    let sink = Sink::open(&target, layout, range.first)?;
    catch_interrupts();
    for frame in &frames {
        if was_interrupted() {
            return Err(Error::Interrupted.into());
        }
        source.at(*frame)?;
    }
    tell_depths(&first);
    note(&target.frames_line(range, frames.len(), arguments.fps));
    let mut report = Report::new(&arguments.scene, range, frames.len());
    let work = Work {
        arguments,
        target: &target,
        range,
        first: &first,
    };
    let outcome = work.draw(source, frames, sink, &mut report);
    report.end(&outcome);
    if arguments.json {
        print_json(&report)?;
    }
    match outcome {
        Ok(()) => {
            note(&report.line());
            Ok(())
        }
        Err(error) => Err(failure(error, &target, &report)),
    }
}

/// What is drawn, and to where.
struct Work<'a> {
    arguments: &'a AnimateArguments,
    target: &'a Target,
    range: Range,
    first: &'a Scene,
}

impl Work<'_> {
    /// Draws frames, but for those that are there.
    fn draw(
        &self,
        mut source: Source<'_>,
        mut frames: Vec<u32>,
        sink: Sink<'_>,
        report: &mut Report,
    ) -> Result<(), Error> {
        let mut opened = None;
        if self.first.display.exposure == Exposure::Auto {
            let (_, renderer) = opened.insert(self.open()?);
            source.fit_exposure(renderer, self.range, &mut stop)?;
        }
        let fingerprints = source.fingerprints()?;
        if let (Target::Files { names, .. }, false) = (self.target, self.arguments.overwrite) {
            let count = frames.len();
            frames.retain(|frame| {
                let there = ImageFile::fingerprint_of(names.path(*frame));
                there.is_none_or(|there| there != fingerprints.of(*frame))
            });
            report.skip(count - frames.len());
        }
        if frames.is_empty() {
            return Ok(());
        }
        let (devices, mut renderer) = match opened {
            Some(opened) => opened,
            None => self.open()?,
        };
        renderer.spread_bloom(true);
        let done = AtomicU32::new(0);
        let written = sink::Written {
            scene: &self.arguments.scene,
            first: self.first,
            devices: &devices,
            fingerprints: &fingerprints,
            done: &done,
        };
        let playback = Playback {
            count: frames.len() as u32,
            rate: self.arguments.fps,
            loops: source.scene.span().is_some_and(|span| span.loops),
        };
        let encoders = sink.encoders(written, playback, self.range.first);
        let count = encoders.len();
        let mut progress = Progress::of_frames(playback.count);
        let (times, outcome) = work(
            &frames,
            self.first.image,
            encoders,
            |frame, image, has_failed| {
                let mut stop = || {
                    has_failed()?;
                    progress.report_frames(done.load(Ordering::Relaxed))
                };
                source.draw(&mut renderer, frame, image, &mut stop)
            },
        );
        drop(progress);
        report.add(names_of(&devices), count, done.into_inner(), times);
        outcome
    }

    /// Opens what draws.
    fn open(&self) -> Result<(Vec<Device>, Renderer), Error> {
        let device = &self.arguments.device;
        let devices = choose_devices(device.device.as_deref())?;
        let renderer = Renderer::on_devices(&devices, &device.options())?;
        Ok((devices, renderer))
    }
}

/// Stops after Ctrl-C.
fn stop() -> ControlFlow<()> {
    match was_interrupted() {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    }
}

/// Says what was done before the work stopped.
fn failure(error: Error, target: &Target, report: &Report) -> Failure {
    match target {
        Target::Animation { .. } if is_unread(&error) => Failure::Unread,
        Target::Files { .. } => match error {
            Error::Interrupted => Failure::Interrupted(report.interrupted()),
            error => {
                note(&report.line());
                error.into()
            }
        },
        _ => error.into(),
    }
}

/// Returns whether the reader of a pipe has left.
fn is_unread(error: &Error) -> bool {
    let Error::Output {
        source: Some(cause),
        ..
    } = error
    else {
        return false;
    };
    let cause = cause.downcast_ref::<io::Error>();
    cause.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}
