//! An OpenCL layer for tests: it stands between the loader and the driver, counts calls and live objects, and lets
//! calls fail on command. `tests/common/layer.rs` is a test's side of it.
//!
//! The loader (ocl-icd from 2.3.0 on, Khronos') loads the libraries that `OPENCL_LAYERS` names, hands each the table of
//! functions below it, and calls those of the table that it gets back.
#![cfg(unix)]
#![allow(unsafe_code)] // a C interface; each block says why it is sound

mod functions;
mod state;

use std::ffi::{CStr, c_char, c_void};
use std::ptr;

use functions::{FUNCTIONS, PLACES, TABLES, Tables};
use state::{Failure, Fault, state};

const SUCCESS: i32 = 0;
const INVALID_VALUE: i32 = -30;
const LAYER_API_VERSION: u32 = 0x4240;
const LAYER_API_VERSION_100: u32 = 100;

/// Asked by the loader: the version of this interface.
///
/// # Safety
/// `value` is null or has `size` bytes, `size_ret` is null or a place for a size.
#[unsafe(no_mangle)]
unsafe extern "C" fn clGetLayerInfo(
    name: u32,
    size: usize,
    value: *mut c_void,
    size_ret: *mut usize,
) -> i32 {
    let needed = size_of::<u32>();
    if name != LAYER_API_VERSION || (!value.is_null() && size < needed) {
        return INVALID_VALUE;
    }
    // SAFETY: of the places that are not null, the first is large enough and the second is a size's.
    unsafe {
        if !value.is_null() {
            value.cast::<u32>().write_unaligned(LAYER_API_VERSION_100);
        }
        if !size_ret.is_null() {
            *size_ret = needed;
        }
    }
    SUCCESS
}

/// Called by the loader once: takes the table of functions below, gives back this layer's.
///
/// # Safety
/// `target` has `count` functions; the other two are places for a count and a table.
#[unsafe(no_mangle)]
unsafe extern "C" fn clInitLayer(
    count: u32,
    target: *const *const c_void,
    count_ret: *mut u32,
    table_ret: *mut *const *const c_void,
) -> i32 {
    // SAFETY: the loader's own table, of so many pointers.
    let target = unsafe { std::slice::from_raw_parts(target, count as usize) }.to_vec();
    if target.len() < PLACES {
        return INVALID_VALUE;
    }
    let mut own = target.clone();
    for (place, _, function) in FUNCTIONS {
        own[*place] = *function;
    }
    let tables = TABLES.get_or_init(|| Tables { target, own });
    // SAFETY: the loader's places; the table is never freed.
    unsafe {
        *count_ret = tables.own.len() as u32;
        *table_ret = tables.own.as_ptr();
    }
    SUCCESS
}

/// Whether a loader has taken the layer in.
#[unsafe(no_mangle)]
extern "C" fn layer_is_loaded() -> bool {
    TABLES.get().is_some()
}

/// Lets the `nth` next call of these functions fail with a code, and if it `stays` all their later ones too; if
/// `is_late`, what was enqueued fails, not the call. It takes the place of an earlier fault. How many functions have
/// the name; `*` at its end stands for any further letters.
///
/// # Safety
/// `names` is a C string.
#[unsafe(no_mangle)]
unsafe extern "C" fn layer_arm(
    names: *const c_char,
    nth: u64,
    code: i32,
    is_late: bool,
    stays: bool,
) -> usize {
    // SAFETY: the caller's promise.
    let places = unsafe { places(names) };
    let count = places.len();
    state().arm(Fault {
        places,
        nth,
        failure: Failure { code, is_late },
        stays,
    });
    count
}

/// Ends all faults: how many calls have failed since one was armed.
#[unsafe(no_mangle)]
extern "C" fn layer_disarm() -> u64 {
    state().disarm()
}

/// Calls of these functions so far, named as in [`layer_arm`].
///
/// # Safety
/// `names` is a C string.
#[unsafe(no_mangle)]
unsafe extern "C" fn layer_calls(names: *const c_char) -> u64 {
    // SAFETY: the caller's promise.
    let places = unsafe { places(names) };
    state().calls(&places)
}

/// Live objects of a kind, in the order of [`state::Kind`]: those made, and retains, less releases.
#[unsafe(no_mangle)]
extern "C" fn layer_live(kind: usize) -> i64 {
    state().live(kind)
}

/// Calls of `clFinish` on a queue so far.
#[unsafe(no_mangle)]
extern "C" fn layer_finishes(queue: *const c_void) -> u64 {
    state().finishes(queue.addr())
}

/// # Safety
/// `names` is a C string.
unsafe fn places(names: *const c_char) -> Vec<usize> {
    // SAFETY: the caller's promise.
    let names = unsafe { CStr::from_ptr(names) }.to_str().unwrap_or("");
    let fits = |name: &str| match names.strip_suffix('*') {
        Some(beginning) => name.starts_with(beginning),
        None => name == names,
    };
    let fitting = FUNCTIONS.iter().filter(|(_, name, _)| fits(name));
    fitting.map(|(place, _, _)| *place).collect()
}

/// A function below this layer, by its place in the table.
fn target(place: usize) -> *const c_void {
    TABLES
        .get()
        .map_or(ptr::null(), |tables| tables.target[place])
}
