//! What happens while the device works: Ctrl-C is looked for, and a function of the user's hears how far it is.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use energywave::{Error, Result};
use pyo3::prelude::*;

use crate::failure::{exception, mistype};

/// Python's lock is taken no more often.
const BETWEEN: Duration = Duration::from_millis(40);

/// Hears the finished share of the work, 0 to 1, and may stop it.
pub type Progress<'a> = dyn FnMut(f32) -> ControlFlow<()> + 'a;

struct Watch {
    told: Option<Py<PyAny>>,
    raised: Option<PyErr>,
    looked: Instant,
}

impl Watch {
    fn look(&mut self, share: f32) -> ControlFlow<()> {
        if self.raised.is_some() {
            return ControlFlow::Break(());
        }
        if self.looked.elapsed() < BETWEEN && (self.told.is_none() || share < 1.0) {
            return ControlFlow::Continue(());
        }
        self.looked = Instant::now();
        let outcome = Python::attach(|py| {
            py.check_signals()?;
            match &self.told {
                Some(told) => told.call1(py, (share,)).map(|_| ()),
                None => Ok(()),
            }
        });
        match outcome {
            Ok(()) => ControlFlow::Continue(()),
            Err(raised) => {
                self.raised = Some(raised);
                ControlFlow::Break(())
            }
        }
    }
}

/// Works without Python's lock; `told` hears how far it is, a number from 0 to 1. An exception in there, or Ctrl-C,
/// stops the work and goes on from here.
pub fn watched<T: Send>(
    py: Python<'_>,
    told: Option<Py<PyAny>>,
    work: impl FnOnce(&mut Progress<'_>) -> Result<T> + Send,
) -> PyResult<T> {
    if let Some(told) = told.as_ref().map(|it| it.bind(py))
        && !told.is_callable()
    {
        let shown = told.repr().map(|it| it.to_string()).unwrap_or_default();
        let reason = format!("{} is no function", energywave::shown(&shown));
        let remedy = "give one that takes the finished share, 0 to 1";
        return Err(mistype(py, "progress", &reason, remedy));
    }
    let mut watch = Watch {
        told,
        raised: None,
        looked: Instant::now(),
    };
    let outcome: std::result::Result<T, Error> = py.detach(|| work(&mut |share| watch.look(share)));
    match watch.raised {
        Some(raised) => Err(raised),
        None => outcome.map_err(|error| exception(py, &error)),
    }
}
