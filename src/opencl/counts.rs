//! What kernels count while they work.

use std::ptr;

use opencl3::event::Event;
use opencl3::types::cl_mem;

use super::failure::failed;
use super::handle::Handle;
use super::{Compute, DeviceBuffer, tiles};
use crate::error::Result;

/// Tiles: integrals, pairs of a ray and a source.
pub(super) const INTEGRALS: usize = 0;
/// Method exact, if the kernels are built to count them: nodes of quadratures.
pub(super) const NODES: usize = 1;
/// Tiles that a pass left open; a number for each pass.
const OPEN_TILES: usize = NODES + 1;
const LEN: usize = OPEN_TILES + tiles::MOST_PASSES;

/// The numbers' places, for the kernels' compiler.
pub(super) fn definitions() -> String {
    format!(
        "-D COUNT_INTEGRALS={INTEGRALS} -D COUNT_NODES_TAKEN={NODES} -D COUNT_OPEN_TILES={OPEN_TILES}"
    )
}

/// A list of numbers on the device, set to 0 before kernels run and read back after them, both without waiting.
#[derive(Debug, Default)]
pub(super) struct Counts {
    buffer: Option<DeviceBuffer<u32>>,
    /// Where the copy under way goes to.
    values: Box<[u32; LEN]>,
    under_way: Option<Handle<Event>>,
    /// The last reset: kernels that count on from old numbers draw a wrong image.
    resetting: Option<Handle<Event>>,
}

impl Counts {
    /// Sets all numbers to 0 before the next command of the queue begins.
    pub(super) fn reset(&mut self, compute: &Compute) -> Result<()> {
        self.wait_for_numbers(compute)?;
        let buffer = match self.buffer.take() {
            Some(buffer) => buffer,
            None => DeviceBuffer::new(compute, "the counts", LEN)?,
        };
        const ZEROS: &[u32; LEN] = &[0; LEN];
        // SAFETY: constants stay.
        let event = unsafe { self.buffer.insert(buffer).begin_write(compute, ZEROS) }?;
        self.resetting = Some(event);
        Ok(())
    }

    /// Reads the numbers after all earlier commands of the queue.
    pub(super) fn fetch(&mut self, compute: &Compute) -> Result<()> {
        self.wait_for_numbers(compute)?;
        if let Some(buffer) = &self.buffer {
            // SAFETY: `values` has room for the buffer's numbers; it is neither read nor freed before the event is over.
            let event = unsafe { buffer.begin_read(compute, self.values.as_mut_slice()) }?;
            self.under_way = Some(event);
        }
        Ok(())
    }

    /// Waits for what is under way: the numbers last fetched.
    pub(super) fn settle(&mut self, compute: &Compute) -> Result<&[u32; LEN]> {
        self.wait_for_numbers(compute)?;
        wait(compute, self.resetting.take(), "clEnqueueWriteBuffer")?;
        Ok(&self.values)
    }

    fn wait_for_numbers(&mut self, compute: &Compute) -> Result<()> {
        wait(compute, self.under_way.take(), "clEnqueueReadBuffer")
    }

    pub(super) fn handle(&self) -> cl_mem {
        self.buffer
            .as_ref()
            .map_or(ptr::null_mut(), DeviceBuffer::handle)
    }
}

fn wait(compute: &Compute, event: Option<Handle<Event>>, call: &'static str) -> Result<()> {
    match event {
        Some(event) => event.wait().map_err(failed(&compute.device.name, call)),
        None => Ok(()),
    }
}

impl Drop for Counts {
    fn drop(&mut self) {
        if let Some(event) = self.under_way.take() {
            // The copy writes to `values`: it must be over before they are freed, however it ended.
            let _ = event.wait();
        }
    }
}
