//! Errors of the library as exceptions: a code, a place, a remedy.

use energywave::{Error, ErrorKind, SceneError};
use pyo3::prelude::*;

/// Where the classes of exceptions are.
const CLASSES: &str = "energywave._errors";

/// An error, in the words that an exception has.
struct Words {
    code: &'static str,
    message: String,
    place: Option<String>,
    remedy: String,
}

/// Makes the exception of an error.
pub fn exception(py: Python<'_>, error: &Error) -> PyErr {
    make(py, &Words::of(error))
}

/// Makes the exception of an error in a scene that was no text: its key says where, and lines of JSON say nothing.
pub fn exception_of_object(py: Python<'_>, mut error: Error) -> PyErr {
    if let Error::Scene(fault) = &mut error {
        fault.position = None;
    }
    exception(py, &error)
}

/// Makes the exception of something that was given to a function and does not fit.
pub fn misuse(py: Python<'_>, place: &str, reason: &str, remedy: &str) -> PyErr {
    let code = ErrorKind::Unsupported.code();
    make(py, &Words::given(code, place, reason, remedy))
}

/// Makes the exception of something that no function takes: an unknown keyword, or what is no object of its kind.
pub fn mistype(py: Python<'_>, place: &str, reason: &str, remedy: &str) -> PyErr {
    make(py, &Words::given("bad-argument", place, reason, remedy))
}

/// Warns of something, in a class of warnings of ours.
pub fn warn(py: Python<'_>, class: &str, message: &str) -> PyResult<()> {
    let warn = py.import(CLASSES)?.getattr("warn")?;
    warn.call1((class, message))?;
    Ok(())
}

fn make(py: Python<'_>, words: &Words) -> PyErr {
    let made = py
        .import(CLASSES)
        .and_then(|classes| classes.getattr("make"))
        .and_then(|make| {
            let place = words.place.as_deref();
            make.call1((words.code, &words.message, place, &words.remedy))
        });
    match made {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}

impl Words {
    fn given(code: &'static str, place: &str, reason: &str, remedy: &str) -> Self {
        Self {
            code,
            message: format!("{place}: {reason}; {remedy}"),
            place: Some(place.to_owned()),
            remedy: remedy.to_owned(),
        }
    }

    fn of(error: &Error) -> Self {
        let message = error.to_string();
        let place = match error {
            Error::Scene(fault) => place_of(fault),
            Error::Input { path, .. } | Error::Output { path, .. } => {
                Some(path.display().to_string())
            }
            Error::OutputFormat(path) => Some(path.display().to_string()),
            Error::Build { device, .. }
            | Error::SelfTest { device, .. }
            | Error::Device { device, .. } => Some(device.clone()),
            Error::Host { object, .. } => Some((*object).to_owned()),
            _ => None,
        };
        let kind = error.kind();
        // What is said of devices is a list.
        let said = remedy_in(&message).filter(|_| kind != ErrorKind::NoSuchDevice);
        let remedy = said.unwrap_or_else(|| usual_remedy(kind).to_owned());
        Self {
            code: error.code(),
            message,
            place,
            remedy,
        }
    }
}

/// Returns file, line and column, else the key.
fn place_of(fault: &SceneError) -> Option<String> {
    let path = fault.path.as_ref().map(|path| path.display().to_string());
    match (path, fault.position) {
        (Some(path), Some((line, column))) => Some(format!("{path}:{line}:{column}")),
        (None, Some((line, column))) => Some(format!("{line}:{column}")),
        (Some(path), None) if fault.key.is_empty() => Some(path),
        (Some(path), None) => Some(format!("{path}: {}", fault.key)),
        (None, None) => (!fault.key.is_empty()).then(|| fault.key.clone()),
    }
}

/// Returns what a message says last: what to do.
fn remedy_in(message: &str) -> Option<String> {
    let (_, last) = message.lines().next()?.rsplit_once("; ")?;
    Some(last.to_owned())
}

fn usual_remedy(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::Scene => {
            "change the value; help(energywave.Scene) and the help of each table have all keys"
        }
        ErrorKind::Input => "check the path, and what the file holds",
        ErrorKind::Unsupported => "ask for something else, or of another device",
        ErrorKind::NoSuchDevice => "choose one of energywave.devices()",
        ErrorKind::Build | ErrorKind::SelfTest | ErrorKind::Device => {
            "choose another device: energywave.devices()"
        }
        ErrorKind::Host => "give an object of the renderer's own context",
        ErrorKind::OutOfMemory => "make the image smaller",
        ErrorKind::Output => "check the path, and what is left of the disk",
        _ => "",
    }
}
