//! Notices a first launch that does not end: some drivers compile for minutes, a few never come back.

use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use super::OpenClDevice;

/// Who is told when kernels that are new have not finished a launch after this time, and in which words: once, from
/// another thread, while the work goes on.
#[derive(Debug, Clone, Copy)]
pub struct SlowStart {
    /// How long building and a first launch may take.
    pub after: Duration,
    /// Hears one line, which names device and driver and says what to do.
    pub tell: fn(&str),
}

impl PartialEq for SlowStart {
    fn eq(&self, other: &Self) -> bool {
        self.after == other.after && std::ptr::fn_addr_eq(self.tell, other.tell)
    }
}

/// Waits beside the work until it is dropped. Its thread ends with it.
#[derive(Debug)]
pub(crate) struct Watch {
    /// Closed to end the wait.
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// Begins to watch a device; does nothing where no thread is to be had.
    pub(crate) fn begin(device: &OpenClDevice, slow_start: SlowStart) -> Self {
        let SlowStart { after, tell } = slow_start;
        let message = format!(
            "{} (driver {}, {}): new kernels have not finished a first launch after {} s; some drivers compile for \
             minutes, and rusticl of Mesa before 25 never ends: update the driver, or choose another device",
            device.name,
            device.platform,
            device.driver,
            after.as_secs_f64()
        );
        let begun = Instant::now();
        let (end, ended) = mpsc::channel();
        let wait = move || {
            // Also where the start was over before this thread began, if it took too long.
            let left = after.saturating_sub(begun.elapsed());
            if ended.recv_timeout(left) == Err(RecvTimeoutError::Timeout)
                || begun.elapsed() >= after
            {
                tell(&message);
            }
        };
        Self {
            end: Some(end),
            thread: Builder::new().name("watch".to_owned()).spawn(wait).ok(),
        }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.end = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join(); // if `tell` panicked, that was told
        }
    }
}
