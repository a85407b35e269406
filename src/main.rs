//! The program `energywave`: see `energywave --help` and README.md.
#![cfg_attr(test, allow(clippy::unwrap_used))]

mod cli;

use std::process::ExitCode;

#[allow(unsafe_code)] // one call that must come before everything else
fn main() -> ExitCode {
    // SAFETY: nothing has started a thread yet.
    let warnings = unsafe { energywave::suit_pocl() };
    cli::run(&warnings)
}
