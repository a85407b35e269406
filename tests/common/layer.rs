//! A test's side of the OpenCL layer in `tests/layer/`: injects faults into this process' calls to OpenCL, and counts
//! calls and live objects.
//!
//! ```text
//! // Within with_layer(|| { .. }), the body of a test:
//! let layer = Layer::new();
//! layer.fail("clEnqueueNDRangeKernel", 2, -5);         // the second next launch fails, once
//! layer.fail_work("clEnqueueWriteBuffer", 1, -5);      // or: the next copy is taken, and fails in the queue
//! layer.lose_device(7, -36);                           // or: from the seventh next call on all fail
//! assert_eq!(layer.disarm(), 1);                       // the device is well again: so many calls have failed
//! let before = layer.calls("clEnqueue*");              // of any function of that beginning
//! assert_eq!(layer.live().events, 0);
//! assert_eq!(layer.finishes(queue), 0);                // `clFinish` on a queue of the test's own
//! ```
#![allow(unsafe_code)] // calls into the layer's C interface; each block says why it is sound

use std::any::type_name_of_val;
use std::ffi::{CStr, CString, c_char, c_int, c_void};

/// The environment variable that tells loaders which layers to load.
pub const LAYERS: &str = "OPENCL_LAYERS";

/// Runs a test in a process of its own, in which the loader of OpenCL takes the layer in; see [`super::apart::apart`].
#[track_caller]
pub fn with_layer<Test: FnOnce()>(test: Test) {
    super::apart::run(type_name_of_val(&test), &[(LAYERS, &path())], test);
}

/// Live OpenCL objects of this process: those made, and retains, less releases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Live {
    pub contexts: i64,
    pub queues: i64,
    pub buffers: i64,
    pub programs: i64,
    pub kernels: i64,
    pub events: i64,
}

/// The layer in this process. The fault ends with it.
pub struct Layer {
    library: *mut c_void,
}

impl Layer {
    /// Finds the layer that the loader took in.
    pub fn new() -> Self {
        let path = path();
        energywave::internals::discover(); // wakes the loader
        let name = CString::new(path.as_str()).unwrap();
        // SAFETY: a library of this repository, which the loader has loaded before: the same path is the same library.
        let library = unsafe { dlopen(name.as_ptr(), LOAD_NOW) };
        assert!(!library.is_null(), "{path} is no library");
        let layer = Self { library };
        // SAFETY: the layer's own signature.
        let is_loaded: extern "C" fn() -> bool = unsafe { layer.symbol(c"layer_is_loaded") };
        assert!(
            is_loaded(),
            "the OpenCL loader took no layer in: these tests need one that has layers (ocl-icd from 2.3.0 on, Khronos'), and \
             with_layer around each test"
        );
        layer
    }

    /// Lets the `nth` next call of a function fail with an OpenCL error code, once. `*` at the end of the name stands
    /// for any further letters: "clEnqueue*". A wait, `clFinish` or a release does its work and then answers with the
    /// code; any other call that fails does nothing. A new fault takes the place of the one before.
    pub fn fail(&self, function: &str, nth: u64, code: i32) {
        self.arm(function, nth, code, false, false);
    }

    /// Lets the command that the `nth` next call of a function enqueues fail with an OpenCL error code: the call goes
    /// well, the work is not done, and its event says so to who asks. Blocking calls, and those without an event, fail
    /// at once.
    pub fn fail_work(&self, function: &str, nth: u64, code: i32) {
        self.arm(function, nth, code, true, false);
    }

    /// Lets the `nth` next call of any function that the layer knows fail, and all after it.
    pub fn lose_device(&self, nth: u64, code: i32) {
        self.arm("*", nth, code, false, true);
    }

    /// Ends the fault: how many calls have failed since it was armed.
    pub fn disarm(&self) -> u64 {
        // SAFETY: the layer's own signature.
        let disarm: extern "C" fn() -> u64 = unsafe { self.symbol(c"layer_disarm") };
        disarm()
    }

    /// Calls of a function so far, named as in [`Layer::fail`].
    pub fn calls(&self, function: &str) -> u64 {
        // SAFETY: the layer's own signature.
        let calls: unsafe extern "C" fn(*const c_char) -> u64 =
            unsafe { self.symbol(c"layer_calls") };
        let name = CString::new(function).unwrap();
        // SAFETY: a C string.
        unsafe { calls(name.as_ptr()) }
    }

    pub fn live(&self) -> Live {
        // SAFETY: the layer's own signature.
        let live: extern "C" fn(usize) -> i64 = unsafe { self.symbol(c"layer_live") };
        let [contexts, queues, buffers, programs, kernels, events] =
            std::array::from_fn(|kind| live(kind));
        Live {
            contexts,
            queues,
            buffers,
            programs,
            kernels,
            events,
        }
    }

    /// Calls of `clFinish` on a queue so far.
    pub fn finishes(&self, queue: *mut c_void) -> u64 {
        // SAFETY: the layer's own signature.
        let finishes: extern "C" fn(*const c_void) -> u64 =
            unsafe { self.symbol(c"layer_finishes") };
        finishes(queue)
    }

    fn arm(&self, function: &str, nth: u64, code: i32, is_late: bool, stays: bool) {
        // SAFETY: the layer's own signature.
        let arm: unsafe extern "C" fn(*const c_char, u64, i32, bool, bool) -> usize =
            unsafe { self.symbol(c"layer_arm") };
        let name = CString::new(function).unwrap();
        // SAFETY: a C string.
        let known = unsafe { arm(name.as_ptr(), nth, code, is_late, stays) };
        assert!(known > 0, "the layer knows no function {function}");
    }

    /// # Safety
    /// `T` is the type of the layer's function of that name.
    unsafe fn symbol<T>(&self, name: &CStr) -> T {
        // SAFETY: the library is never closed.
        let symbol = unsafe { dlsym(self.library, name.as_ptr()) };
        assert!(!symbol.is_null(), "the layer has no {name:?}: it is old");
        // SAFETY: the caller's promise; an address is what a function pointer is.
        unsafe { std::mem::transmute_copy(&symbol) }
    }
}

impl Drop for Layer {
    fn drop(&mut self) {
        self.disarm();
    }
}

/// The layer's library: cargo builds examples beside the tests.
pub fn path() -> String {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    let test = std::env::current_exe().unwrap();
    let folder = test.parent().unwrap().parent().unwrap().join("examples");
    let path = folder.join(format!("{DLL_PREFIX}opencl_layer{DLL_SUFFIX}"));
    let path = path.to_str().unwrap();
    assert!(
        std::fs::exists(path).unwrap(),
        "there is no {path}; build it: cargo build --release --example opencl_layer"
    );
    path.to_owned()
}

const LOAD_NOW: c_int = 2; // RTLD_NOW

// The C library's own; every Rust program on a unix has them.
unsafe extern "C" {
    fn dlopen(path: *const c_char, flags: c_int) -> *mut c_void;
    fn dlsym(library: *mut c_void, name: *const c_char) -> *mut c_void;
}
