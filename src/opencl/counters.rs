//! Numbers that kernels count up while they work.

use bytemuck::Pod;
use opencl3::event::Event;

use super::failure::failed;
use super::handle::Handle;
use super::{Argument, Compute, DeviceBuffer};
use crate::error::Result;

/// Launches that count before the host reads their numbers: a copy for each would cost as much as a small kernel.
const SETS: usize = 64;

/// Sets of numbers on the device, one for each launch, set to 0 before kernels run and read back after them, both
/// without waiting.
#[derive(Debug, Default)]
pub struct Counters<const LEN: usize> {
    buffer: Option<DeviceBuffer<[u32; LEN]>>,
    /// How many sets were taken.
    taken: usize,
}

/// Numbers that are on their way to the host.
#[derive(Debug)]
pub struct Counted<const LEN: usize> {
    sets: Box<[[u32; LEN]; SETS]>,
    event: Handle<Event>,
    is_over: bool,
}

impl<const LEN: usize> Counters<LEN>
where
    [u32; LEN]: Pod,
{
    /// Lets the next launch have the first set again.
    pub(crate) fn begin(&mut self) {
        self.taken = 0;
    }

    /// Whether no set is left.
    pub(crate) fn is_used_up(&self) -> bool {
        self.taken == SETS
    }

    /// Takes a set of zeros for the next launch; there must be one left. Returns the copy that set all sets to 0, if it
    /// was made now. Kernels that count on from old numbers draw a wrong image: whether it went well must be asked for.
    pub(crate) fn take(&mut self, compute: &Compute) -> Result<Option<Handle<Event>>> {
        let buffer = match self.buffer.take() {
            Some(buffer) => buffer,
            None => DeviceBuffer::new(compute, "the counts", SETS)?,
        };
        let buffer = self.buffer.insert(buffer);
        let zeros: &'static [[u32; LEN]; SETS] = const { &[[0; LEN]; SETS] };
        let reset = match self.taken {
            // SAFETY: constants stay.
            0 => Some(unsafe { buffer.begin_write(compute, zeros) }?),
            _ => None,
        };
        self.taken += 1;
        Ok(reset)
    }

    /// Returns the place of the last set's first number in the list.
    pub(crate) fn first(&self) -> u32 {
        (LEN * self.taken.saturating_sub(1)) as u32
    }

    /// Reads the numbers of all launches after all earlier commands of the queue; `None` if none counts.
    pub(crate) fn fetch(&self, compute: &Compute) -> Result<Option<Counted<LEN>>> {
        let (Some(buffer), 1..) = (&self.buffer, self.taken) else {
            return Ok(None);
        };
        let mut sets = Box::new([[0; LEN]; SETS]);
        // SAFETY: `Counted` neither reads nor frees the numbers before the event is over.
        let event = unsafe { buffer.begin_read(compute, sets.as_mut_slice()) }?;
        Ok(Some(Counted {
            sets,
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
    /// Waits for the numbers: the sum of all sets.
    pub(crate) fn wait(mut self, compute: &Compute) -> Result<[u64; LEN]> {
        wait(compute, &self.event, "clEnqueueReadBuffer")?;
        self.is_over = true;
        let mut sums = [0; LEN];
        for set in self.sets.iter() {
            for (sum, number) in sums.iter_mut().zip(set) {
                *sum += u64::from(*number);
            }
        }
        Ok(sums)
    }
}

impl<const LEN: usize> Drop for Counted<LEN> {
    fn drop(&mut self) {
        // The copy writes to `sets`: it must be over before they are freed, however it ended.
        if !self.is_over {
            let _ = self.event.wait();
        }
    }
}

/// Waits for a copy.
pub(crate) fn wait(compute: &Compute, event: &Event, call: &'static str) -> Result<()> {
    event.wait().map_err(failed(&compute.device().name, call))
}
