//! Copies to the device that are under way, each with the memory that it reads.

use opencl3::event::{CL_COMPLETE, Event};

use super::Compute;
use super::failure::failed;
use super::handle::Handle;
use crate::error::Result;

/// Copies under way. What is copied must neither change nor be freed before its copy is over.
#[derive(Debug)]
pub(super) struct Copies<T>(Vec<(Handle<Event>, T)>);

impl<T> Copies<T> {
    pub(super) fn new() -> Self {
        Self(Vec::new())
    }

    /// Keeps `data` while the copy goes on.
    pub(super) fn keep(&mut self, event: Handle<Event>, data: T) {
        self.0.push((event, data));
    }

    /// Lets go of what is over, without waiting, and returns whether no copy failed.
    pub(super) fn reap(&mut self) -> bool {
        let mut is_well = true;
        self.0.retain(|(event, _)| {
            let is_over = state(event);
            is_well &= is_over.is_ok();
            // If the driver did not answer, the copy may still be going on.
            matches!(is_over, Ok(false) | Err(Unknown::Asking))
        });
        is_well
    }

    /// Waits for all of them. Once a launch that reads what was copied is over, this costs nothing.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if a copy failed.
    pub(super) fn wait(&mut self, compute: &Compute) -> Result<()> {
        let mut outcome = Ok(());
        for (event, _) in self.0.drain(..) {
            outcome = outcome.and(event.wait());
        }
        outcome.map_err(failed(&compute.device.name, "clEnqueueWriteBuffer"))
    }
}

/// Why nothing is known of what a command did.
pub(crate) enum Unknown {
    /// It failed.
    Command,
    /// The driver does not answer.
    Asking,
}

/// Returns whether a command is over.
pub(crate) fn state(event: &Event) -> std::result::Result<bool, Unknown> {
    match event.command_execution_status() {
        Ok(status) if status.0 < CL_COMPLETE => Err(Unknown::Command),
        Ok(status) => Ok(status.0 == CL_COMPLETE),
        Err(_) => Err(Unknown::Asking),
    }
}

impl<T> Drop for Copies<T> {
    fn drop(&mut self) {
        for (event, _) in &self.0 {
            // However the copy ends, nobody reads the data afterwards.
            let _ = event.wait();
        }
    }
}
