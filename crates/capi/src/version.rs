//! Versions: of the library, and of what the header says of it.

use std::ffi::{CString, c_char};
use std::sync::OnceLock;

use crate::status::{Failure, Status, guarded, text};

/// The version of this header. Calls and fields are added without changing it; what breaks callers does.
pub const ENERGYWAVE_ABI: u32 = 1;

/// Returns the version of the library, such as `0.1.0`. It is never freed.
#[unsafe(no_mangle)]
pub extern "C" fn energywave_version() -> *const c_char {
    static VERSION: OnceLock<CString> = OnceLock::new();
    let version = VERSION.get_or_init(|| text(env!("CARGO_PKG_VERSION")));
    version.as_ptr()
}

/// Checks that the library that was loaded keeps to the header that a program was compiled with: `abi` is
/// ENERGYWAVE_ABI. Call it once, first.
#[unsafe(no_mangle)]
pub extern "C" fn energywave_check_abi(abi: u32) -> Status {
    guarded(|| match abi {
        ENERGYWAVE_ABI => Ok(()),
        other => {
            let message = format!(
                "abi: the program's header has {other}, this library {ENERGYWAVE_ABI}; compile it again, or install \
                 the library that it was compiled for"
            );
            Err(Failure::Call(Status::BadVersion, message))
        }
    })
}

/// Sets in the environment what drivers need and lack: PoCL's threads, its linker, its cache. Call it first in `main`,
/// if at all: no other thread may run yet.
///
/// # Safety
/// No other thread runs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_suit_drivers() -> Status {
    guarded(|| {
        // SAFETY: the caller's promise. What cannot be mended shows when a device is opened.
        let _ = unsafe { energywave::suit_pocl() };
        Ok(())
    })
}
