//! Copies to the device that are under way, each with the memory that it reads.

use opencl3::error_codes::ClError;
use opencl3::event::{CL_COMPLETE, Event};

use super::Compute;
use super::failure::failed;
use super::handle::Handle;
use crate::error::Result;

/// What is copied must neither change nor be freed before its copy is over.
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

    /// Lets go of what is over, without waiting.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if a copy failed.
    pub(super) fn reap(&mut self, compute: &Compute) -> Result<()> {
        let mut outcome = Ok(());
        self.0
            .retain(|(event, _)| match event.command_execution_status() {
                Ok(status) if status.0 < CL_COMPLETE => {
                    outcome = Err(ClError(status.0));
                    false
                }
                Ok(status) => status.0 != CL_COMPLETE,
                Err(code) => {
                    outcome = Err(code);
                    true // the question failed: the copy may go on
                }
            });
        outcome.map_err(failed(&compute.device.name, "clEnqueueWriteBuffer"))
    }

    /// Waits for all of them. Once a launch that reads what was copied is over, this costs nothing.
    ///
    /// # Errors
    /// As [`Copies::reap`].
    pub(super) fn wait(&mut self, compute: &Compute) -> Result<()> {
        let mut outcome = Ok(());
        for (event, _) in self.0.drain(..) {
            outcome = outcome.and(event.wait());
        }
        outcome.map_err(failed(&compute.device.name, "clEnqueueWriteBuffer"))
    }
}

/// Whether a command is over; an error if it failed.
pub(super) fn state(event: &Event) -> std::result::Result<bool, ClError> {
    match event.command_execution_status()?.0 {
        CL_COMPLETE => Ok(true),
        code @ ..0 => Err(ClError(code)),
        _ => Ok(false),
    }
}

impl<T> Drop for Copies<T> {
    fn drop(&mut self) {
        for (event, _) in &self.0 {
            // However it ends: afterwards nobody reads the data.
            let _ = event.wait();
        }
    }
}
