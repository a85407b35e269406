//! The one error type of the crate: what failed, where, why, and what to do.

use std::path::PathBuf;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Everything that can go wrong. `Display` gives one message for people: what, where, why, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene holds a value that cannot be drawn, or its file cannot be understood.
    #[error("{0}")]
    Scene(SceneError),

    /// An input file cannot be read.
    #[error("{}: {reason}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// Why it cannot be read.
        reason: String,
    },

    /// The chosen device lacks what the scene asks for.
    #[error("{0}")]
    Unsupported(String),

    /// No device answers to the choice, or more than one where one is meant.
    #[error("{0}")]
    NoSuchDevice(String),

    /// The device's compiler refused the kernels.
    #[error("{device}: building the kernels failed ({code}){}", log_lines(log))]
    Build {
        /// Name of the device.
        device: String,
        /// OpenCL's name of the error.
        code: String,
        /// The compiler's log; places are `cl/FILE:LINE`.
        log: String,
    },

    /// Kernels gave a wrong answer where the right one is known: the driver compiled them wrongly, or the device is broken.
    #[error(
        "{device} computes wrong (driver {driver}): {reason}; update the driver, choose another device with --device, or insist on this one with --no-self-test (BuildOptions::skips_self_test)"
    )]
    SelfTest {
        /// Name of the device.
        device: String,
        /// Platform and version of the driver.
        driver: String,
        /// What was found and what was expected.
        reason: String,
    },

    /// A call to OpenCL failed.
    #[error("{device}: {call} failed ({code}); {advice}")]
    Device {
        /// Name of the device.
        device: String,
        /// The OpenCL function.
        call: &'static str,
        /// OpenCL's name of the error.
        code: String,
        /// What to try.
        advice: &'static str,
    },

    /// Something of a host's OpenCL does not fit. Nothing was enqueued.
    #[error("the host's {object}: {reason}")]
    Host {
        /// What: context, queue, buffer, image or wait list.
        object: &'static str,
        /// Why, and what would fit.
        reason: String,
    },

    /// The device or the host has too little memory.
    #[error("{0}")]
    OutOfMemory(String),

    /// The name of the output says no known format.
    #[error("{}: unknown output ending; use .png (8-bit sRGB) or .exr (32-bit linear)", .0.display())]
    OutputFormat(PathBuf),

    /// The output cannot be written. Nothing is left behind.
    #[error("{}: cannot write: {reason}", path.display())]
    Output {
        /// The file that was asked for.
        path: PathBuf,
        /// Why it cannot be written.
        reason: String,
    },

    /// The caller's progress function asked to stop.
    #[error("interrupted; nothing was written")]
    Interrupted,
}

/// A value at fault in a scene: where it stands and what is wrong with it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneError {
    /// The scene file, if the scene came from one.
    pub path: Option<PathBuf>,
    /// Line and column, both counted from 1, if known.
    pub position: Option<(usize, usize)>,
    /// The key at fault, such as `torus[1].axis` (items are counted from 0); empty where no key is at fault.
    pub key: String,
    /// What is wrong and what is right.
    pub message: String,
}

impl SceneError {
    /// A fault of a value in a scene that may not come from a file.
    pub(crate) fn value(key: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            path: None,
            position: None,
            key: key.into(),
            message: message.into(),
        }
    }
}

impl std::fmt::Display for SceneError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.path {
            Some(path) => write!(f, "{}:", path.display())?,
            None => write!(f, "scene:")?,
        }
        if let Some((line, column)) = self.position {
            write!(f, "{line}:{column}:")?;
        }
        if !self.key.is_empty() {
            write!(f, " {}:", self.key)?;
        }
        write!(f, " {}", self.message)
    }
}

impl From<SceneError> for Error {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

/// The compiler's log, indented below the message; a hint where the driver gave none.
fn log_lines(log: &str) -> String {
    let log = log.trim();
    if log.is_empty() {
        return "; the driver gave no log: update it, or choose another device".to_owned();
    }
    log.lines().map(|line| format!("\n    {line}")).collect()
}
