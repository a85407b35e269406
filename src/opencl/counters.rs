//! Numbers that kernels count up while they work.

use opencl3::event::Event;

use super::failure::failed;
use super::handle::Handle;
use super::{Argument, Compute, DeviceBuffer};
use crate::error::Result;

/// A list of numbers on the device, set to 0 before kernels run and read back after them, both without waiting.
#[derive(Debug)]
pub struct Counters<const LEN: usize> {
    buffer: Option<DeviceBuffer<u32>>,
    /// Where the copy under way goes to.
    values: Box<[u32; LEN]>,
    under_way: Option<Handle<Event>>,
    /// Resets: kernels that count on from old numbers draw a wrong image.
    resetting: Vec<Handle<Event>>,
}

impl<const LEN: usize> Default for Counters<LEN> {
    fn default() -> Self {
        Self {
            buffer: None,
            values: Box::new([0; LEN]),
            under_way: None,
            resetting: Vec::new(),
        }
    }
}

impl<const LEN: usize> Counters<LEN> {
    /// Sets all numbers to 0 before the next command of the queue begins.
    pub(crate) fn reset(&mut self, compute: &Compute) -> Result<()> {
        self.wait_for_numbers(compute)?;
        let buffer = match self.buffer.take() {
            Some(buffer) => buffer,
            None => DeviceBuffer::new(compute, "the counts", LEN)?,
        };
        let zeros: &'static [u32; LEN] = const { &[0; LEN] };
        // SAFETY: constants stay.
        let event = unsafe { self.buffer.insert(buffer).begin_write(compute, zeros) }?;
        self.resetting.push(event);
        Ok(())
    }

    /// Reads the numbers after all earlier commands of the queue.
    pub(crate) fn fetch(&mut self, compute: &Compute) -> Result<()> {
        self.wait_for_numbers(compute)?;
        if let Some(buffer) = &self.buffer {
            // SAFETY: `values` has room for the buffer's numbers; it is neither read nor freed before the event is over.
            let event = unsafe { buffer.begin_read(compute, self.values.as_mut_slice()) }?;
            self.under_way = Some(event);
        }
        Ok(())
    }

    /// Waits for what is under way: the numbers last fetched.
    pub(crate) fn settle(&mut self, compute: &Compute) -> Result<&[u32; LEN]> {
        self.wait_for_numbers(compute)?;
        let mut outcome = Ok(());
        for event in self.resetting.drain(..) {
            outcome = outcome.and(wait(compute, Some(event), "clEnqueueWriteBuffer"));
        }
        outcome.map(|()| &*self.values)
    }

    /// The resets since then, for who does not wait.
    pub(crate) fn take_resets(&mut self) -> Vec<Handle<Event>> {
        std::mem::take(&mut self.resetting)
    }

    fn wait_for_numbers(&mut self, compute: &Compute) -> Result<()> {
        wait(compute, self.under_way.take(), "clEnqueueReadBuffer")
    }

    /// The list, for kernels.
    pub(crate) fn argument(&self) -> &dyn Argument {
        &self.buffer
    }
}

fn wait(compute: &Compute, event: Option<Handle<Event>>, call: &'static str) -> Result<()> {
    match event {
        Some(event) => event.wait().map_err(failed(&compute.device().name, call)),
        None => Ok(()),
    }
}

impl<const LEN: usize> Drop for Counters<LEN> {
    fn drop(&mut self) {
        if let Some(event) = self.under_way.take() {
            // The copy writes to `values`: it must be over before they are freed, however it ended.
            let _ = event.wait();
        }
    }
}
