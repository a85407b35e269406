//! Progress on standard error, for work that takes longer than a second; and Ctrl-C.

use std::fmt::Write;
use std::io::{IsTerminal, stderr};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use super::is_quiet;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// The bar that is shown, if there is one: messages are written beside it.
static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Shorter work shows nothing.
const PATIENCE: Duration = Duration::from_secs(1);
const STEP: Duration = Duration::from_millis(100);

/// Makes Ctrl-C ask the work to stop, so that it can tidy up.
pub fn catch_interrupts() {
    // Without a handler Ctrl-C still ends the program, at once.
    let _ = ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed));
}

/// Returns whether Ctrl-C was pressed.
pub fn was_interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// Writes to standard error, where no bar is in the way.
pub fn beside(write: impl FnOnce()) {
    let shown = SHOWN.lock().unwrap_or_else(PoisonError::into_inner).clone();
    match shown {
        Some(bar) => bar.suspend(write),
        None => write(),
    }
}

/// A bar on the screen, until it is dropped.
struct Shown(ProgressBar);

impl Shown {
    fn new(bar: ProgressBar) -> Self {
        *SHOWN.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.clone());
        Self(bar)
    }
}

impl Drop for Shown {
    fn drop(&mut self) {
        *SHOWN.lock().unwrap_or_else(PoisonError::into_inner) = None;
        self.0.finish_and_clear();
    }
}

/// Hears the finished share of the work. Until then the device prepares itself, which is shown, too.
pub struct Progress {
    begun: Instant,
    is_shown: bool,
    preparing: Option<Preparing>,
    bar: Option<Shown>,
    /// How many frames the work is, if it is counted by them.
    frames: Option<u32>,
}

impl Progress {
    /// Begins to wait for the first share, unless nobody looks.
    pub fn new() -> Self {
        let begun = Instant::now();
        let is_shown = !is_quiet() && stderr().is_terminal();
        Self {
            begun,
            is_shown,
            preparing: is_shown.then(|| Preparing::begin(PATIENCE)).flatten(),
            bar: None,
            frames: None,
        }
    }

    /// Does the same for work that is counted by frames.
    pub fn of_frames(count: u32) -> Self {
        Self {
            frames: Some(count),
            ..Self::new()
        }
    }

    /// Shows how many frames are done; breaks after Ctrl-C.
    pub fn report_frames(&mut self, done: u32) -> ControlFlow<()> {
        self.show(|bar| bar.set_position(done.into()))
    }

    /// Shows the finished share, 0 to 1; breaks after Ctrl-C.
    pub fn report(&mut self, share: f32) -> ControlFlow<()> {
        self.show(|bar| bar.set_position((share * 1000.0) as u64))
    }

    fn show(&mut self, update: impl FnOnce(&ProgressBar)) -> ControlFlow<()> {
        self.preparing = None;
        if self.is_shown && self.begun.elapsed() > PATIENCE {
            let (begun, frames) = (self.begun, self.frames);
            let new = || Shown::new(new_bar(begun, frames));
            update(&self.bar.get_or_insert_with(new).0);
        }
        if was_interrupted() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// Says that the device builds its kernels, where that takes long; a thread that ends when this is dropped.
struct Preparing {
    stop: Sender<()>,
    thread: Option<JoinHandle<()>>,
}

impl Preparing {
    /// Begins to wait; without a thread nothing is said.
    fn begin(patience: Duration) -> Option<Self> {
        let (stop, stopped) = channel();
        let goes_on = move |time| stopped.recv_timeout(time) == Err(RecvTimeoutError::Timeout);
        let begun = Instant::now();
        let work = move || {
            if goes_on(patience) {
                let bar = Shown::new(new_spinner(begun));
                while goes_on(STEP) {
                    bar.0.tick();
                }
            }
        };
        let thread = thread::Builder::new().name("preparing".to_owned());
        let thread = Some(thread.spawn(work).ok()?);
        Some(Self { stop, thread })
    }
}

impl Drop for Preparing {
    fn drop(&mut self) {
        let _ = self.stop.send(()); // it may have ended
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn new_bar(begun: Instant, frames: Option<u32>) -> ProgressBar {
    let words = match frames {
        Some(_) => "{bar:40} {pos} of {len} frames, {rate} a second, {elapsed}, {eta} left",
        None => "{bar:40} {percent:>3} % {elapsed}, {eta} left",
    };
    let style =
        ProgressStyle::with_template(words).unwrap_or_else(|_| ProgressStyle::default_bar());
    let style = style.with_key("rate", |state: &ProgressState, text: &mut dyn Write| {
        let _ = write!(text, "{:.1}", state.per_sec()); // a text takes all
    });
    ProgressBar::new(frames.map_or(1000, u64::from))
        .with_style(style)
        .with_elapsed(begun.elapsed())
}

fn new_spinner(begun: Instant) -> ProgressBar {
    let words =
        "{spinner} the driver compiles kernels, which it keeps for the next time; {elapsed}";
    let style =
        ProgressStyle::with_template(words).unwrap_or_else(|_| ProgressStyle::default_spinner());
    ProgressBar::new_spinner()
        .with_style(style)
        .with_elapsed(begun.elapsed())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_shown() -> bool {
        SHOWN
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .is_some()
    }

    #[test]
    fn what_prepares_is_shown_until_the_work_begins_and_leaves_no_thread() {
        let mut progress = Progress::new();
        progress.preparing = Preparing::begin(Duration::ZERO);
        while !is_shown() {
            thread::yield_now();
        }
        let mut written = false;
        beside(|| written = true);
        assert!(written);
        assert!(progress.report(0.5).is_continue());
        assert!(progress.preparing.is_none() && !is_shown());
        let patient = Preparing::begin(Duration::from_secs(3600));
        drop(patient); // does not wait for it
        assert!(!is_shown());
    }
}
