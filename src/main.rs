//! The program `energywave`: see `energywave --help` and README.md.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run()
}
