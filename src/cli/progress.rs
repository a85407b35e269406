//! A progress bar on standard error, for work that takes longer than a second; and Ctrl-C.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C ask the work to stop, so that it can tidy up.
pub fn catch_interrupts() {
    // Without a handler Ctrl-C still ends the program, at once.
    let _ = ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed));
}

/// Returns whether Ctrl-C was pressed.
pub fn was_interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// Hears the finished share of the work.
pub struct Progress {
    begun: Instant,
    is_shown: bool,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// Makes a bar that appears after a second, unless `quiet` is set or there is no terminal (indicatif sees to that).
    pub fn new(quiet: bool) -> Self {
        Self {
            begun: Instant::now(),
            is_shown: !quiet,
            bar: None,
        }
    }

    /// Shows the finished share, 0 to 1; breaks after Ctrl-C.
    pub fn report(&mut self, share: f32) -> ControlFlow<()> {
        if self.is_shown && self.begun.elapsed() > Duration::from_secs(1) {
            let begun = self.begun;
            let bar = self.bar.get_or_insert_with(|| new_bar(begun));
            bar.set_position((share * 1000.0) as u64);
        }
        if was_interrupted() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn new_bar(begun: Instant) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} % {elapsed}, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(1000)
        .with_style(style)
        .with_elapsed(begun.elapsed())
}
