//! Numbers that kernels count up while they work.

use opencl3::event::Event;

use super::failure::failed;
use super::handle::Handle;
use super::{Argument, Compute, DeviceBuffer};
use crate::error::Result;

/// A list of numbers on the device, set to 0 before kernels run and read back after them, both without waiting.
#[derive(Debug, Default)]
pub struct Counters<const LEN: usize> {
    buffer: Option<DeviceBuffer<u32>>,
}

/// Numbers that are on their way to the host.
#[derive(Debug)]
pub struct Counted<const LEN: usize> {
    values: Box<[u32; LEN]>,
    event: Handle<Event>,
    is_over: bool,
}

impl<const LEN: usize> Counters<LEN> {
    /// Sets all numbers to 0 before the next command of the queue begins. Kernels that count on from old numbers draw a
    /// wrong image: whether the event of that went well must be asked for.
    pub(crate) fn reset(&mut self, compute: &Compute) -> Result<Handle<Event>> {
        let buffer = match self.buffer.take() {
            Some(buffer) => buffer,
            None => DeviceBuffer::new(compute, "the counts", LEN)?,
        };
        let zeros: &'static [u32; LEN] = const { &[0; LEN] };
        // SAFETY: constants stay.
        unsafe { self.buffer.insert(buffer).begin_write(compute, zeros) }
    }

    /// Reads the numbers after all earlier commands of the queue; `None` if there are none.
    pub(crate) fn fetch(&self, compute: &Compute) -> Result<Option<Counted<LEN>>> {
        let Some(buffer) = &self.buffer else {
            return Ok(None);
        };
        let mut values = Box::new([0; LEN]);
        // SAFETY: `Counted` neither reads nor frees the numbers before the event is over.
        let event = unsafe { buffer.begin_read(compute, values.as_mut_slice()) }?;
        Ok(Some(Counted {
            values,
            event,
            is_over: false,
        }))
    }

    /// The list, for kernels.
    pub(crate) fn argument(&self) -> &dyn Argument {
        &self.buffer
    }
}

impl<const LEN: usize> Counted<LEN> {
    /// Waits for the numbers.
    pub(crate) fn wait(mut self, compute: &Compute) -> Result<[u32; LEN]> {
        wait(compute, &self.event, "clEnqueueReadBuffer")?;
        self.is_over = true;
        Ok(*self.values)
    }
}

impl<const LEN: usize> Drop for Counted<LEN> {
    fn drop(&mut self) {
        // The copy writes to `values`: it must be over before they are freed, however it ended.
        if !self.is_over {
            let _ = self.event.wait();
        }
    }
}

/// Waits for a copy.
pub(crate) fn wait(compute: &Compute, event: &Event, call: &'static str) -> Result<()> {
    event.wait().map_err(failed(&compute.device().name, call))
}
