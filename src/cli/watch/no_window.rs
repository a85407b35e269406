//! A program without windows.

use energywave::Error;

use super::WatchArguments;
use crate::cli::Outcome;

pub fn run(_: WatchArguments) -> Outcome {
    let message = "watch: this program was built without windows (cargo install --features window); name an image to \
                   write: -o FILE";
    Err(Error::Unsupported(message.to_owned()).into())
}
