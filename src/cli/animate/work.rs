//! Frames are drawn on one thread while others encode those before: a frame's memory goes from one to the other and
//! back, and there is only so much of it, so that nobody runs ahead.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use energywave::image::{Display, ImageSize};
use energywave::{Error, RadianceImage};

/// A frame that was drawn, and what its display makes of it.
pub struct Frame {
    pub number: u32,
    pub image: RadianceImage,
    pub display: Display,
}

/// What comes to those who encode.
enum Message {
    Drawn(Frame),
    /// No further frame comes: the work has stopped.
    Stopped,
}

/// Where an encoder takes frames from.
pub struct Inbox<'a> {
    drawn: &'a Mutex<Receiver<Message>>,
    free: Sender<RadianceImage>,
    waited: &'a AtomicU64,
}

impl Inbox<'_> {
    /// Waits for the next frame; none comes after the last.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if there would have been one, and it is not drawn.
    pub fn next(&self) -> Result<Option<Frame>, Error> {
        let begun = Instant::now();
        let message = {
            let drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
            drawn.recv()
        };
        let waited = begun.elapsed().as_nanos() as u64;
        self.waited.fetch_add(waited, Ordering::Relaxed);
        match message {
            Ok(Message::Drawn(frame)) => Ok(Some(frame)),
            Ok(Message::Stopped) => Err(Error::Interrupted),
            Err(_) => Ok(None),
        }
    }

    /// Gives the memory of a frame back, for another one.
    pub fn give_back(&self, frame: Frame) {
        let _ = self.free.send(frame.image); // or nobody draws any more
    }
}

/// Encodes frames until there is none.
pub type Encoder<'a> = Box<dyn FnOnce(&Inbox<'_>) -> Result<(), Error> + Send + 'a>;

/// How long the parts of the work took.
#[derive(Debug, Clone, Copy, Default)]
pub struct Times {
    /// In which frames were drawn.
    pub drawing: Duration,
    /// In which frames were encoded and written, by all threads together.
    pub encoding: Duration,
    /// From the first to the last.
    pub all: Duration,
}

/// Draws frames, and has each encoded by one of some encoders while the next ones are drawn. `draw` may ask whether an
/// encoder has failed, and is to stop then.
///
/// # Errors
/// That of `draw`, else the first one of an encoder.
pub fn work(
    frames: &[u32],
    size: ImageSize,
    encoders: Vec<Encoder<'_>>,
    mut draw: impl FnMut(
        u32,
        &mut RadianceImage,
        &dyn Fn() -> ControlFlow<()>,
    ) -> Result<Display, Error>,
) -> (Times, Result<(), Error>) {
    let begun = Instant::now();
    let (failed, waited) = (AtomicBool::new(false), AtomicU64::new(0));
    let (to_encoders, drawn) = channel();
    let (free, freed) = channel();
    let (drawn, count) = (Mutex::new(drawn), encoders.len());
    let has_failed = || match failed.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let mut drawing = Duration::ZERO;
    let (outcome, encoding) = thread::scope(|scope| {
        let spawn = |encode| {
            let inbox = Inbox {
                drawn: &drawn,
                free: free.clone(),
                waited: &waited,
            };
            let failed = &failed;
            scope.spawn(move || {
                let begun = Instant::now();
                let encode: Encoder<'_> = encode;
                let outcome = encode(&inbox);
                failed.fetch_or(outcome.is_err(), Ordering::Relaxed);
                (outcome, begun.elapsed())
            })
        };
        let threads: Vec<_> = encoders.into_iter().map(spawn).collect();
        drop(free);
        let mut memory = Memory::new(size, count + 1, freed);
        let outcome = frames.iter().try_for_each(|&number| {
            let mut image = memory.next()?;
            let begun = Instant::now();
            let display = draw(number, &mut image, &has_failed);
            drawing += begun.elapsed();
            let frame = Frame {
                number,
                image,
                display: display?,
            };
            let _ = to_encoders.send(Message::Drawn(frame)); // or all have failed
            Ok(())
        });
        for _ in threads.iter().filter(|_| outcome.is_err()) {
            let _ = to_encoders.send(Message::Stopped);
        }
        drop((to_encoders, memory));
        let mut ended = (outcome, Duration::ZERO);
        for thread in threads {
            match thread.join() {
                Ok((outcome, took)) => ended = (first_of(ended.0, outcome), ended.1 + took),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        ended
    });
    let waited = Duration::from_nanos(waited.into_inner());
    let times = Times {
        drawing,
        encoding: encoding.saturating_sub(waited),
        all: begun.elapsed(),
    };
    (times, outcome)
}

/// The memory of so many frames, made when it is needed first.
struct Memory {
    size: ImageSize,
    made: usize,
    most: usize,
    freed: Receiver<RadianceImage>,
}

/// Less lets nothing be drawn beside what is encoded.
const LEAST_FRAMES: usize = 2;

impl Memory {
    fn new(size: ImageSize, most: usize, freed: Receiver<RadianceImage>) -> Self {
        Self {
            size,
            made: 0,
            most,
            freed,
        }
    }

    /// Returns that of a frame which was encoded; makes another, or waits where there are enough, or there is no more.
    fn next(&mut self) -> Result<RadianceImage, Error> {
        if let Ok(image) = self.freed.try_recv() {
            return Ok(image);
        }
        if self.made < self.most {
            match RadianceImage::new(self.size) {
                Ok(image) => {
                    self.made += 1;
                    return Ok(image);
                }
                Err(error) if self.made < LEAST_FRAMES => return Err(error),
                Err(_) => self.most = self.made,
            }
        }
        // Nobody gives any back who has failed.
        self.freed.recv().map_err(|_| Error::Interrupted)
    }
}

/// Returns the first fault; that the work was stopped is one only where nothing else is.
fn first_of(one: Result<(), Error>, other: Result<(), Error>) -> Result<(), Error> {
    match (one, other) {
        (Ok(()), other) => other,
        (Err(Error::Interrupted), Err(other)) => Err(other),
        (one, _) => one,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicU32;

    use super::*;

    const SIZE: ImageSize = ImageSize {
        width: 1,
        height: 1,
    };

    /// Draws frames whose only pixel is their number, and returns what encoders saw of them.
    fn run(
        frames: u32,
        fail_drawing: u32,
        fail_encoding: u32,
    ) -> (Vec<u32>, usize, Result<(), Error>) {
        let (seen, out) = (Mutex::new(Vec::new()), AtomicU32::new(0));
        let mut memory = std::collections::HashSet::new();
        let encode = |inbox: &Inbox<'_>| {
            while let Some(frame) = inbox.next()? {
                assert_eq!(frame.image.as_slice()[0], frame.number as f32);
                if frame.number == fail_encoding {
                    return Err(Error::output("a file", "the disk is full"));
                }
                seen.lock().unwrap().push(frame.number);
                out.fetch_sub(1, Ordering::Relaxed);
                inbox.give_back(frame);
            }
            Ok(())
        };
        let encoders: Vec<Encoder<'_>> = vec![Box::new(encode), Box::new(encode)];
        let numbers: Vec<u32> = (0..frames).collect();
        let (_, outcome) = work(&numbers, SIZE, encoders, |number, image, has_failed| {
            memory.insert(image.as_slice().as_ptr());
            // Of the three one is drawn.
            assert!(out.fetch_add(1, Ordering::Relaxed) <= 2 || fail_encoding < frames);
            image.as_mut_slice().fill(number as f32);
            if number == fail_drawing {
                return Err(Error::Unsupported("it cannot be drawn".to_owned()));
            }
            if has_failed().is_break() {
                return Err(Error::Interrupted);
            }
            Ok(Display::default())
        });
        let mut seen = seen.into_inner().unwrap();
        seen.sort_unstable();
        (seen, memory.len(), outcome)
    }

    #[test]
    fn each_frame_is_encoded_once_in_the_memory_of_three() {
        let (seen, memory, outcome) = run(1000, u32::MAX, u32::MAX);
        assert!(seen.into_iter().eq(0..1000) && outcome.is_ok());
        assert!(memory <= 3, "{memory}");
    }

    #[test]
    fn what_fails_ends_the_work_and_frames_before_it_are_whole() {
        let (seen, _, outcome) = run(1000, 500, u32::MAX);
        assert!(seen.into_iter().eq(0..500));
        assert!(matches!(outcome, Err(Error::Unsupported(_))));
        let (seen, _, outcome) = run(1000, u32::MAX, 500);
        assert!(seen.len() < 1000 && !seen.contains(&500));
        assert!(matches!(outcome, Err(Error::Output { .. })));
    }
}
