//! Keeps a panic of the decoder from passing.

use std::any::Any;
use std::thread::{Builder, scope};

use super::Outcome;

/// The name of the thread on which files are decoded. A panic there is caught and ends in an error: a program that
/// hears of panics (`std::panic::set_hook`) need not tell of it.
pub const DECODER_THREAD: &str = "energywave: decoding";

/// Does the work on a thread of its own, whose panic is a reason.
pub(super) fn guarded<T: Send>(work: impl FnOnce() -> Outcome<T> + Send) -> Outcome<T> {
    scope(|scope| {
        let thread = Builder::new()
            .name(DECODER_THREAD.to_owned())
            .spawn_scoped(scope, work)
            .map_err(|error| format!("no thread to read it: {error}"))?;
        thread.join().unwrap_or_else(|panic| {
            Err(format!("damaged: the decoder gave up: {}", words(&*panic)))
        })
    })
}

/// Returns the first line of what a panic says.
fn words(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    text.and_then(|text| text.lines().next())
        .unwrap_or("no reason")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_reason_and_a_result_passes() {
        assert_eq!(guarded(|| Ok(1)), Ok(1));
        assert_eq!(
            guarded(|| Err::<(), _>("no".to_owned())),
            Err("no".to_owned())
        );
        let index = std::hint::black_box(3);
        let reason = guarded(|| Ok([1, 2][index])).unwrap_err();
        assert!(reason.contains("gave up: index out of bounds"), "{reason}");
    }
}
