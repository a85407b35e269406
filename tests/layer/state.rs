//! What the layer counts, and the fault that it is to inject.

use std::collections::HashMap;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use crate::functions::{Handle, PLACES};

/// Kinds of OpenCL objects.
#[derive(Clone, Copy)]
pub enum Kind {
    Context,
    Queue,
    Memory,
    Program,
    Kernel,
    Event,
}

/// What a call does to the objects if it goes well.
pub enum Effect {
    Nothing,
    Creates(Kind),
    Retains(Kind),
    Releases(Kind),
    /// On a queue, blocking or not, with the place for an event or null.
    Enqueues(Handle, u32, Handle),
    Waits,
    Finishes(Handle),
}

/// A fault to come.
pub struct Fault {
    /// The functions' places in the table.
    pub places: Vec<usize>,
    /// How many of their calls until it comes, itself included.
    pub nth: u64,
    pub failure: Failure,
    /// Whether the calls after it fail too.
    pub stays: bool,
}

/// How a call fails.
#[derive(Clone, Copy)]
pub struct Failure {
    pub code: i32,
    /// Whether a command is taken and fails in the queue; calls that do not enqueue one, or wait for it, fail at once.
    pub is_late: bool,
}

pub struct State {
    calls: [u64; PLACES],
    live: [i64; 6],
    /// Calls of `clFinish`, by the queue's address.
    finishes: HashMap<usize, u64>,
    fault: Option<Fault>,
    /// Calls that failed since a fault was armed.
    failed: u64,
}

pub fn state() -> MutexGuard<'static, State> {
    static STATE: LazyLock<Mutex<State>> = LazyLock::new(|| {
        Mutex::new(State {
            calls: [0; PLACES],
            live: [0; 6],
            finishes: HashMap::new(),
            fault: None,
            failed: 0,
        })
    });
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

impl State {
    /// Counts a call that begins: how it is to fail, if it is.
    pub fn begin(&mut self, place: usize) -> Option<Failure> {
        self.calls[place] += 1;
        let fault = self.fault.as_mut()?;
        if !fault.places.contains(&place) {
            return None;
        }
        if fault.nth > 1 {
            fault.nth -= 1;
            return None;
        }
        let failure = fault.failure;
        if !fault.stays {
            self.fault = None;
        }
        self.failed += 1;
        Some(failure)
    }

    /// Notes what a call did that went well.
    pub fn done(&mut self, effect: &Effect) {
        match effect {
            Effect::Creates(kind) | Effect::Retains(kind) => self.live[*kind as usize] += 1,
            Effect::Releases(kind) => self.live[*kind as usize] -= 1,
            Effect::Enqueues(_, _, event) => {
                self.live[Kind::Event as usize] += i64::from(!event.is_null());
            }
            Effect::Finishes(queue) => *self.finishes.entry(queue.addr()).or_default() += 1,
            Effect::Nothing | Effect::Waits => {}
        }
    }

    pub fn arm(&mut self, fault: Fault) {
        self.fault = Some(fault);
        self.failed = 0;
    }

    pub fn disarm(&mut self) -> u64 {
        self.fault = None;
        std::mem::take(&mut self.failed)
    }

    pub fn calls(&self, places: &[usize]) -> u64 {
        places.iter().map(|place| self.calls[*place]).sum()
    }

    pub fn live(&self, kind: usize) -> i64 {
        self.live[kind]
    }

    pub fn finishes(&self, queue: usize) -> u64 {
        self.finishes.get(&queue).copied().unwrap_or(0)
    }
}
