//! What a call comes back with, and what is kept of the last failure of a thread.

use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

use energywave::{Error, ErrorKind};

use crate::border::{self, Versioned};

/// What a call comes back with. The numbers never change; new ones may come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum Status {
    /// It did what was asked.
    Ok = 0,
    /// A value of the scene cannot be drawn; file, line, column and key where they are known.
    Scene = 1,
    /// An input file cannot be read.
    Input = 2,
    /// The device, or this build of the library, lacks what is asked for.
    Unsupported = 3,
    /// No device answers to the choice, or more than one.
    NoSuchDevice = 4,
    /// The device's compiler refused the kernels; its log is in the message.
    Build = 5,
    /// Kernels gave a wrong answer where the right one is known.
    SelfTest = 6,
    /// A call to OpenCL failed.
    Device = 7,
    /// Something of the host's OpenCL does not fit; nothing was enqueued.
    Host = 8,
    /// Device or host have too little memory.
    OutOfMemory = 9,
    /// The name of an output says no known format.
    OutputFormat = 10,
    /// An output cannot be written; nothing is left behind.
    Output = 11,
    /// The work was stopped.
    Interrupted = 12,
    /// A failure that has no number yet; its code has a name.
    Other = 13,
    /// An argument is NULL where it may not be, has a wrong size or alignment, or is no UTF-8.
    BadArgument = 100,
    /// A handle was freed, is of another kind, or is none.
    BadHandle = 101,
    /// A struct, or the header, is of another version than this library understands.
    BadVersion = 102,
    /// A fault of the library itself. A renderer that it happened in is of no use any more.
    Internal = 103,
}

/// Why a call failed.
#[derive(Debug)]
pub enum Failure {
    /// The library said so.
    Library(Error),
    /// What C handed over is wrong.
    Call(Status, String),
}

/// The result of what a call does.
pub type Outcome<T = ()> = Result<T, Failure>;

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Library(error)
    }
}

/// Makes the failure of an argument.
pub fn bad_argument(name: &str, reason: &str) -> Failure {
    Failure::Call(Status::BadArgument, format!("{name}: {reason}"))
}

/// What is known of a failure.
struct Report {
    status: Status,
    code: CString,
    message: CString,
    path: CString,
    key: CString,
    remedy: CString,
    line: u32,
    column: u32,
}

thread_local! {
    static LAST: RefCell<Option<Report>> = const { RefCell::new(None) };
}

/// What is known of the last call of this thread that failed. Texts are UTF-8, never NULL, empty where nothing is
/// known, and stay until the next call of this thread that fails.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct ErrorInfo {
    /// `sizeof` of this struct, set by the caller.
    pub struct_size: usize,
    /// What that call came back with; ENERGYWAVE_STATUS_OK if none has failed.
    pub status: Status,
    /// The line in the scene's text, from 1; 0: not known.
    pub line: u32,
    /// The column in it, from 1; 0: not known.
    pub column: u32,
    /// 0.
    pub reserved: u32,
    /// The name of the status, such as `no-such-device`; it never changes.
    pub code: *const c_char,
    /// What went wrong, where, why, and what to do.
    pub message: *const c_char,
    /// The file at fault.
    pub path: *const c_char,
    /// The key of the scene at fault, such as `torus[1].axis`.
    pub key: *const c_char,
    /// What to do, alone.
    pub remedy: *const c_char,
}

// SAFETY: it begins with its size, and every pattern of bits is a value of its fields but for the status, which is
// written and never read.
unsafe impl Versioned for ErrorInfo {}

/// Does the work of a call: a failure is kept for the thread, and a panic is one.
pub fn guarded(work: impl FnOnce() -> Outcome) -> Status {
    // What a panic leaves behind is not looked at again: renderers and scenes are behind locks, which it poisons.
    let outcome = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let what = match (panic.downcast_ref::<&str>(), panic.downcast_ref::<String>()) {
            (Some(text), _) => (*text).to_owned(),
            (_, Some(text)) => text.clone(),
            _ => "unknown".to_owned(),
        };
        // A value that panics when it is dropped would do so again, across the border.
        std::mem::forget(panic);
        let message = format!("a fault of the library: {what}; please report it");
        Err(Failure::Call(Status::Internal, message))
    });
    let Err(failure) = outcome else {
        return Status::Ok;
    };
    let report = report(failure);
    let status = report.status;
    // A thread that ends keeps nothing any more.
    let _ = LAST.try_with(|last| last.replace(Some(report)));
    status
}

/// Tells about the last call of this thread that failed. `error` has its `struct_size` set.
///
/// # Safety
/// `error` points to so many bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_last_error(error: *mut ErrorInfo) -> Status {
    let fill = || {
        LAST.with_borrow(|last| {
            let empty = c"".as_ptr();
            let info = match last {
                Some(report) => ErrorInfo {
                    struct_size: 0,
                    status: report.status,
                    line: report.line,
                    column: report.column,
                    reserved: 0,
                    code: report.code.as_ptr(),
                    message: report.message.as_ptr(),
                    path: report.path.as_ptr(),
                    key: report.key.as_ptr(),
                    remedy: report.remedy.as_ptr(),
                },
                None => ErrorInfo {
                    struct_size: 0,
                    status: Status::Ok,
                    line: 0,
                    column: 0,
                    reserved: 0,
                    code: c"ok".as_ptr(),
                    message: empty,
                    path: empty,
                    key: empty,
                    remedy: empty,
                },
            };
            // SAFETY: the caller's promise.
            unsafe { border::write_struct(error, "error", info) }
        })
    };
    // Its own failure is not kept: it would end the texts that it is asked for.
    match catch_unwind(AssertUnwindSafe(fill)) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(Failure::Call(status, _))) => status,
        Ok(Err(Failure::Library(_))) | Err(_) => Status::Internal,
    }
}

fn report(failure: Failure) -> Report {
    match failure {
        Failure::Library(error) => library_report(&error),
        Failure::Call(status, message) => Report {
            status,
            code: text(code_of(status)),
            remedy: text(remedy_in(&message)),
            message: text(&message),
            path: CString::default(),
            key: CString::default(),
            line: 0,
            column: 0,
        },
    }
}

fn library_report(error: &Error) -> Report {
    let (mut path, mut key, mut place) = (None, "", None);
    match error {
        Error::Scene(fault) => {
            path = fault.path.as_deref();
            key = &fault.key;
            place = fault.position;
        }
        Error::Input { path: at, .. } | Error::Output { path: at, .. } => path = Some(at),
        Error::OutputFormat(at) => path = Some(at),
        _ => {}
    }
    let message = error.to_string();
    let (line, column) = place.unwrap_or_default();
    let number = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    Report {
        status: status_of(error.kind()),
        code: text(error.code()),
        remedy: text(match error {
            Error::Device { advice, .. } => advice,
            Error::Build { .. } => "update the driver, or choose another device",
            Error::NoSuchDevice(_) => "choose one of those that energywave_devices gives",
            Error::Input { .. } if !message.contains("; ") => {
                "check the path, and what the file holds"
            }
            _ => remedy_in(&message),
        }),
        message: text(&message),
        path: text(&path.map(|path| path.to_string_lossy()).unwrap_or_default()),
        key: text(key),
        line: number(line),
        column: number(column),
    }
}

/// Returns what messages say last: behind "what is wrong; ".
fn remedy_in(message: &str) -> &str {
    message.rsplit_once("; ").map_or("", |(_, remedy)| remedy)
}

/// Returns a text for C, which ends at a NUL.
pub fn text(text: &str) -> CString {
    CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default()
}

fn status_of(kind: ErrorKind) -> Status {
    match kind {
        ErrorKind::Scene => Status::Scene,
        ErrorKind::Input => Status::Input,
        ErrorKind::Unsupported => Status::Unsupported,
        ErrorKind::NoSuchDevice => Status::NoSuchDevice,
        ErrorKind::Build => Status::Build,
        ErrorKind::SelfTest => Status::SelfTest,
        ErrorKind::Device => Status::Device,
        ErrorKind::Host => Status::Host,
        ErrorKind::OutOfMemory => Status::OutOfMemory,
        ErrorKind::OutputFormat => Status::OutputFormat,
        ErrorKind::Output => Status::Output,
        ErrorKind::Interrupted => Status::Interrupted,
        _ => Status::Other,
    }
}

/// Returns the name of a status that is of this library's C side; of others, errors know it.
fn code_of(status: Status) -> &'static str {
    match status {
        Status::BadHandle => "bad-handle",
        Status::BadVersion => "bad-version",
        Status::Internal => "internal",
        _ => "bad-argument",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn last() -> (Status, String) {
        LAST.with_borrow(|last| {
            let report = last.as_ref().unwrap();
            (report.status, report.message.to_str().unwrap().to_owned())
        })
    }

    #[test]
    fn a_panic_becomes_a_status() {
        assert_eq!(guarded(|| panic!("planted")), Status::Internal);
        assert_eq!(last().0, Status::Internal);
        assert!(last().1.contains("planted"), "{}", last().1);
    }

    #[test]
    fn a_success_keeps_the_failure_before_it() {
        let fail = || Err(bad_argument("width", "0; it must be at least 1"));
        assert_eq!(guarded(fail), Status::BadArgument);
        assert_eq!(guarded(|| Ok(())), Status::Ok);
        assert_eq!(last().1, "width: 0; it must be at least 1");
        assert_eq!(remedy_in(&last().1), "it must be at least 1");
    }

    #[test]
    fn a_text_ends_at_its_end() {
        assert_eq!(text("a\0b").to_str().unwrap(), "a\u{fffd}b");
    }
}
