//! OpenCL's error codes as errors with advice.

use opencl3::error_codes::{self as codes, ClError, error_text};

use super::host::unfit;
use crate::error::{Error, Result};

/// Turns the error code of a failed call into an error that names device, call and what to do.
pub(super) fn failed<'a>(
    device: &'a str,
    call: &'static str,
) -> impl FnOnce(ClError) -> Error + 'a {
    move |ClError(code)| Error::Device {
        device: device.to_owned(),
        call,
        code: code_name(code),
        advice: advice(code),
        source: Some(ClError(code).into()),
    }
}

/// Makes the error of a call that would have been wrong and was not made.
pub(super) fn fault(device: &str, call: &'static str, what: String) -> Error {
    fault_of(
        device,
        call,
        what,
        "a fault of this library: please report it",
    )
}

/// Makes the error of a call that was not made because it would have failed.
pub(super) fn fault_of(
    device: &str,
    call: &'static str,
    what: String,
    advice: &'static str,
) -> Error {
    Error::Device {
        device: device.to_owned(),
        call,
        code: what,
        advice,
        source: None,
    }
}

/// Turns the error code of a buffer of this many bytes that was refused into an error that says what it was for.
pub(super) fn refused<'a>(
    device: &'a str,
    what: &'a str,
    bytes: u64,
) -> impl FnOnce(ClError) -> Error + 'a {
    move |ClError(code)| {
        Error::OutOfMemory(format!(
            "{device}: {what}, {} KiB: clCreateBuffer failed ({}); {}",
            bytes.div_ceil(1 << 10),
            code_name(code),
            advice(code)
        ))
    }
}

/// Returns OpenCL's name of an error code, with the number.
pub(super) fn code_name(code: i32) -> String {
    format!("{}, {code}", error_text(code))
}

fn advice(code: i32) -> &'static str {
    match code {
        codes::CL_MEM_OBJECT_ALLOCATION_FAILURE
        | codes::CL_OUT_OF_RESOURCES
        | codes::CL_OUT_OF_HOST_MEMORY
        | codes::CL_INVALID_BUFFER_SIZE => {
            "the device ran out of memory or was lost: make the image or the scene smaller, or choose another device"
        }
        codes::CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST | codes::CL_INVALID_COMMAND_QUEUE => {
            "the device was lost during the work: try again, update its driver, or choose another device"
        }
        codes::CL_INVALID_PROGRAM | codes::CL_INVALID_PROGRAM_EXECUTABLE => {
            "the driver built no usable program: is its cache folder writable (PoCL: POCL_CACHE_DIR)?"
        }
        codes::CL_DEVICE_NOT_AVAILABLE => "the device is in use or switched off",
        _ => "update the device's driver, or choose another device",
    }
}

/// Turns the answer to a question about something of the host's into a result.
pub(super) fn asked<T>(object: &'static str, answer: std::result::Result<T, ClError>) -> Result<T> {
    answer.map_err(|ClError(code)| {
        let code = code_name(code);
        unfit(object, format_args!("OpenCL does not know it ({code})"))
    })
}
