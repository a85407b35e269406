//! The functions that the layer stands before: each counts, may fail, and else calls the driver.

use std::ffi::c_void;
use std::mem::transmute;
use std::ptr;
use std::sync::OnceLock;

use crate::state::Effect::{self, Creates, Enqueues, Finishes, Nothing, Releases, Retains, Waits};
use crate::state::{Failure, Kind, state};
use crate::target;

/// Any pointer: the layer looks behind none but those for an error code.
pub type Handle = *mut c_void;

/// As many places of the loader's table as the layer knows: up to OpenCL 2.0's queues.
pub const PLACES: usize = 124;

/// The table of the functions below this layer, and the layer's own.
pub struct Tables {
    pub target: Vec<*const c_void>,
    pub own: Vec<*const c_void>,
}

// SAFETY: both hold addresses of functions and never change.
unsafe impl Send for Tables {}
// SAFETY: as for Send.
unsafe impl Sync for Tables {}

pub static TABLES: OnceLock<Tables> = OnceLock::new();

/// A call that answers with a status.
fn status(place: usize, effect: Effect, driver: impl FnOnce() -> i32) -> i32 {
    let fault = state().begin(place);
    // However these end on a lost device, the work is over and the object is gone: the driver must know.
    let must_go_on = matches!(effect, Releases(_) | Waits | Finishes(_));
    let answer = match (fault, &effect) {
        (
            Some(Failure {
                code,
                is_late: true,
            }),
            &Enqueues(queue, 0, event),
        ) if !event.is_null() => take_and_fail(queue, event, code),
        (Some(Failure { code, .. }), _) if !must_go_on => return code,
        _ => driver(),
    };
    if answer == 0 {
        state().done(&effect);
    }
    match fault {
        Some(Failure { code, .. }) if must_go_on => code,
        _ => answer,
    }
}

/// A call that answers with an object or an address, and with a status behind `error`.
fn object(
    place: usize,
    effect: Effect,
    error: *mut i32,
    driver: impl FnOnce() -> Handle,
) -> Handle {
    if let Some(Failure { code, .. }) = state().begin(place) {
        if !error.is_null() {
            // SAFETY: OpenCL's interface has a place for the status here.
            unsafe { *error = code };
        }
        return ptr::null_mut();
    }
    let answer = driver();
    if !answer.is_null() {
        state().done(&effect);
    }
    answer
}

/// Takes a command as a driver does, but for an event of its own, which has failed, instead of the work.
fn take_and_fail(queue: Handle, event: Handle, code: i32) -> i32 {
    const QUEUE_CONTEXT: u32 = 0x1090;
    type QueueInfo = unsafe extern "C" fn(P, u32, usize, *mut P, P) -> i32;
    type CreateUserEvent = unsafe extern "C" fn(P, *mut i32) -> P;
    type SetUserEventStatus = unsafe extern "C" fn(P, i32) -> i32;
    let (mut context, mut status) = (ptr::null_mut(), 0);
    // SAFETY: functions of these types at their places in the table, the caller's queue and its place for an event.
    unsafe {
        let info = transmute::<*const c_void, QueueInfo>(target(12));
        let create = transmute::<*const c_void, CreateUserEvent>(target(84));
        let set = transmute::<*const c_void, SetUserEventStatus>(target(85));
        info(
            queue,
            QUEUE_CONTEXT,
            size_of::<P>(),
            &mut context,
            ptr::null_mut(),
        );
        let failed = create(context, &mut status);
        if status == 0 {
            status = set(failed, code);
            *event.cast::<P>() = failed;
        }
    }
    status
}

/// Writes the functions and the list of them. A row: the place in the loader's table (the order of `cl_icd.h`), the
/// function, and how it answers and what it does.
macro_rules! functions {
    ($($place:literal $name:ident($($value:ident: $type:ty),*) -> $answer:ty {
        $way:ident($($how:expr),*)
    })*) => {
        $(
            #[allow(non_snake_case)] // OpenCL's names
            unsafe extern "C" fn $name($($value: $type),*) -> $answer {
                let driver = || {
                    type Function = unsafe extern "C" fn($($type),*) -> $answer;
                    // SAFETY: the function of that place in the table, which has this type.
                    let function = unsafe { transmute::<*const c_void, Function>(target($place)) };
                    // SAFETY: what the caller gave goes on as it came.
                    unsafe { function($($value),*) }
                };
                $way($place, $($how,)* driver)
            }
        )*

        /// Place, name and address of each.
        pub const FUNCTIONS: &[(usize, &str, *const c_void)] =
            &[$(($place, stringify!($name), $name as *const c_void)),*];
    };
}

type P = Handle;

functions! {
    4 clCreateContext(properties: P, count: u32, devices: P, notify: P, data: P, error: *mut i32) -> P {
        object(Creates(Kind::Context), error)
    }
    6 clRetainContext(context: P) -> i32 { status(Retains(Kind::Context)) }
    7 clReleaseContext(context: P) -> i32 { status(Releases(Kind::Context)) }
    9 clCreateCommandQueue(context: P, device: P, properties: u64, error: *mut i32) -> P {
        object(Creates(Kind::Queue), error)
    }
    123 clCreateCommandQueueWithProperties(context: P, device: P, properties: P, error: *mut i32) -> P {
        object(Creates(Kind::Queue), error)
    }
    10 clRetainCommandQueue(queue: P) -> i32 { status(Retains(Kind::Queue)) }
    11 clReleaseCommandQueue(queue: P) -> i32 { status(Releases(Kind::Queue)) }
    14 clCreateBuffer(context: P, flags: u64, size: usize, host: P, error: *mut i32) -> P {
        object(Creates(Kind::Memory), error)
    }
    82 clCreateSubBuffer(buffer: P, flags: u64, kind: u32, region: P, error: *mut i32) -> P {
        object(Creates(Kind::Memory), error)
    }
    96 clCreateImage(context: P, flags: u64, format: P, size: P, host: P, error: *mut i32) -> P {
        object(Creates(Kind::Memory), error)
    }
    17 clRetainMemObject(object: P) -> i32 { status(Retains(Kind::Memory)) }
    18 clReleaseMemObject(object: P) -> i32 { status(Releases(Kind::Memory)) }
    26 clCreateProgramWithSource(context: P, count: u32, texts: P, lengths: P, error: *mut i32) -> P {
        object(Creates(Kind::Program), error)
    }
    27 clCreateProgramWithBinary(context: P, count: u32, devices: P, lengths: P, binaries: P, states: P, error: *mut i32) -> P {
        object(Creates(Kind::Program), error)
    }
    28 clRetainProgram(program: P) -> i32 { status(Retains(Kind::Program)) }
    29 clReleaseProgram(program: P) -> i32 { status(Releases(Kind::Program)) }
    30 clBuildProgram(program: P, count: u32, devices: P, options: P, notify: P, data: P) -> i32 { status(Nothing) }
    32 clGetProgramInfo(program: P, name: u32, size: usize, value: P, needed: P) -> i32 { status(Nothing) }
    33 clGetProgramBuildInfo(program: P, device: P, name: u32, size: usize, value: P, needed: P) -> i32 { status(Nothing) }
    34 clCreateKernel(program: P, name: P, error: *mut i32) -> P { object(Creates(Kind::Kernel), error) }
    36 clRetainKernel(kernel: P) -> i32 { status(Retains(Kind::Kernel)) }
    37 clReleaseKernel(kernel: P) -> i32 { status(Releases(Kind::Kernel)) }
    38 clSetKernelArg(kernel: P, index: u32, size: usize, value: P) -> i32 { status(Nothing) }
    39 clGetKernelInfo(kernel: P, name: u32, size: usize, value: P, needed: P) -> i32 { status(Nothing) }
    40 clGetKernelWorkGroupInfo(kernel: P, device: P, name: u32, size: usize, value: P, needed: P) -> i32 { status(Nothing) }
    41 clWaitForEvents(count: u32, events: P) -> i32 { status(Waits) }
    42 clGetEventInfo(event: P, name: u32, size: usize, value: P, needed: P) -> i32 { status(Nothing) }
    43 clRetainEvent(event: P) -> i32 { status(Retains(Kind::Event)) }
    44 clReleaseEvent(event: P) -> i32 { status(Releases(Kind::Event)) }
    84 clCreateUserEvent(context: P, error: *mut i32) -> P { object(Creates(Kind::Event), error) }
    45 clGetEventProfilingInfo(event: P, name: u32, size: usize, value: P, needed: P) -> i32 { status(Nothing) }
    46 clFlush(queue: P) -> i32 { status(Nothing) }
    47 clFinish(queue: P) -> i32 { status(Finishes(queue)) }
    48 clEnqueueReadBuffer(queue: P, buffer: P, blocking: u32, offset: usize, size: usize, host: P, count: u32, waits: P, event: P) -> i32 {
        status(Enqueues(queue, blocking, event))
    }
    86 clEnqueueReadBufferRect(
        queue: P, buffer: P, blocking: u32, buffer_origin: P, host_origin: P, region: P, buffer_row: usize, buffer_slice: usize,
        host_row: usize, host_slice: usize, host: P, count: u32, waits: P, event: P
    ) -> i32 {
        status(Enqueues(queue, blocking, event))
    }
    49 clEnqueueWriteBuffer(queue: P, buffer: P, blocking: u32, offset: usize, size: usize, host: P, count: u32, waits: P, event: P) -> i32 {
        status(Enqueues(queue, blocking, event))
    }
    87 clEnqueueWriteBufferRect(
        queue: P, buffer: P, blocking: u32, buffer_origin: P, host_origin: P, region: P, buffer_row: usize, buffer_slice: usize,
        host_row: usize, host_slice: usize, host: P, count: u32, waits: P, event: P
    ) -> i32 {
        status(Enqueues(queue, blocking, event))
    }
    50 clEnqueueCopyBuffer(queue: P, from: P, to: P, from_offset: usize, to_offset: usize, size: usize, count: u32, waits: P, event: P) -> i32 {
        status(Enqueues(queue, 0, event))
    }
    88 clEnqueueCopyBufferRect(
        queue: P, from: P, to: P, from_origin: P, to_origin: P, region: P, from_row: usize, from_slice: usize, to_row: usize,
        to_slice: usize, count: u32, waits: P, event: P
    ) -> i32 {
        status(Enqueues(queue, 0, event))
    }
    102 clEnqueueFillBuffer(
        queue: P, buffer: P, pattern: P, pattern_size: usize, offset: usize, size: usize, count: u32, waits: P, event: P
    ) -> i32 {
        status(Enqueues(queue, 0, event))
    }
    51 clEnqueueReadImage(
        queue: P, image: P, blocking: u32, origin: P, region: P, row: usize, slice: usize, host: P, count: u32, waits: P, event: P
    ) -> i32 {
        status(Enqueues(queue, blocking, event))
    }
    52 clEnqueueWriteImage(
        queue: P, image: P, blocking: u32, origin: P, region: P, row: usize, slice: usize, host: P, count: u32, waits: P, event: P
    ) -> i32 {
        status(Enqueues(queue, blocking, event))
    }
    53 clEnqueueCopyImage(queue: P, from: P, to: P, from_origin: P, to_origin: P, region: P, count: u32, waits: P, event: P) -> i32 {
        status(Enqueues(queue, 0, event))
    }
    54 clEnqueueCopyImageToBuffer(queue: P, from: P, to: P, origin: P, region: P, offset: usize, count: u32, waits: P, event: P) -> i32 {
        status(Enqueues(queue, 0, event))
    }
    55 clEnqueueCopyBufferToImage(queue: P, from: P, to: P, offset: usize, origin: P, region: P, count: u32, waits: P, event: P) -> i32 {
        status(Enqueues(queue, 0, event))
    }
    56 clEnqueueMapBuffer(
        queue: P, buffer: P, blocking: u32, flags: u64, offset: usize, size: usize, count: u32, waits: P, event: P, error: *mut i32
    ) -> P {
        object(Enqueues(queue, blocking, event), error)
    }
    57 clEnqueueMapImage(
        queue: P, image: P, blocking: u32, flags: u64, origin: P, region: P, row: P, slice: P, count: u32, waits: P, event: P, error: *mut i32
    ) -> P {
        object(Enqueues(queue, blocking, event), error)
    }
    58 clEnqueueUnmapMemObject(queue: P, object: P, pointer: P, count: u32, waits: P, event: P) -> i32 { status(Enqueues(queue, 0, event)) }
    59 clEnqueueNDRangeKernel(
        queue: P, kernel: P, dimensions: u32, offset: P, global: P, local: P, count: u32, waits: P, event: P
    ) -> i32 {
        status(Enqueues(queue, 0, event))
    }
    60 clEnqueueTask(queue: P, kernel: P, count: u32, waits: P, event: P) -> i32 { status(Enqueues(queue, 0, event)) }
    62 clEnqueueMarker(queue: P, event: P) -> i32 { status(Enqueues(queue, 0, event)) }
    63 clEnqueueWaitForEvents(queue: P, count: u32, events: P) -> i32 { status(Nothing) }
    64 clEnqueueBarrier(queue: P) -> i32 { status(Nothing) }
    104 clEnqueueMigrateMemObjects(queue: P, object_count: u32, objects: P, flags: u64, count: u32, waits: P, event: P) -> i32 {
        status(Enqueues(queue, 0, event))
    }
    105 clEnqueueMarkerWithWaitList(queue: P, count: u32, waits: P, event: P) -> i32 { status(Enqueues(queue, 0, event)) }
    106 clEnqueueBarrierWithWaitList(queue: P, count: u32, waits: P, event: P) -> i32 { status(Enqueues(queue, 0, event)) }
    71 clEnqueueAcquireGLObjects(queue: P, object_count: u32, objects: P, count: u32, waits: P, event: P) -> i32 { status(Enqueues(queue, 0, event)) }
    72 clEnqueueReleaseGLObjects(queue: P, object_count: u32, objects: P, count: u32, waits: P, event: P) -> i32 { status(Enqueues(queue, 0, event)) }
}
