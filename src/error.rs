//! The one error type of the crate: what failed, where, why, and what to do.

use std::path::PathBuf;

use crate::shown::{shown, shown_line, shown_path};

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// The cause of an error, where another library gave one.
pub type Cause = Box<dyn std::error::Error + Send + Sync>;

/// Everything that can go wrong. `Display` gives one message for people: what, where, why, and what to do;
/// [`Error::kind`] and [`ErrorKind::code`] are for programs. What a message repeats of a file or a path is escaped and
/// shortened, see [`crate::shown()`]; the fields hold it as it is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene holds a value that cannot be drawn, or its file cannot be understood.
    #[error("{0}")]
    Scene(SceneError),

    /// An input file cannot be read.
    #[error("{}: {}", shown_path(path), shown_line(reason))]
    #[non_exhaustive]
    Input {
        /// The file.
        path: PathBuf,
        /// Why it cannot be read.
        reason: String,
        /// What the system or the decoder said.
        #[source]
        source: Option<Cause>,
    },

    /// The chosen device, or this build of the library, lacks what the scene or the caller asks for.
    #[error("{0}")]
    Unsupported(String),

    /// No device answers to the choice, or more than one where one is meant.
    #[error("{0}")]
    NoSuchDevice(String),

    /// The device's compiler refused the kernels.
    #[error("{device}: building the kernels failed ({code}){}", log_lines(log))]
    #[non_exhaustive]
    Build {
        /// Name of the device.
        device: String,
        /// OpenCL's name of the error.
        code: String,
        /// The compiler's log; places are `cl/FILE:LINE`.
        log: String,
    },

    /// Kernels gave a wrong answer where the right one is known: the driver compiled them wrongly, or the device is
    /// broken. [`RendererOptions::skips_self_test`](crate::RendererOptions::skips_self_test) insists on the device.
    #[error(
        "{device} computes wrong (driver {driver}): {reason}; update the driver, or choose another device"
    )]
    #[non_exhaustive]
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
    #[non_exhaustive]
    Device {
        /// Name of the device.
        device: String,
        /// The OpenCL function.
        call: &'static str,
        /// OpenCL's name of the error.
        code: String,
        /// What to try.
        advice: &'static str,
        /// The number that the driver gave, as an error.
        #[source]
        source: Option<Cause>,
    },

    /// An OpenCL object that a host gave does not fit. Nothing was enqueued.
    #[error("the host's {object}: {reason}")]
    #[non_exhaustive]
    Host {
        /// What: context, queue, buffer, image, depth or wait list.
        object: &'static str,
        /// Why, and what would fit.
        reason: String,
    },

    /// The device or the host has too little memory.
    #[error("{0}")]
    OutOfMemory(String),

    /// The name of the output says no known format.
    #[error(
        "{}: unknown output ending; use .png (8-bit sRGB) or .exr (32-bit linear){}",
        shown_path(.0),
        other_endings()
    )]
    OutputFormat(PathBuf),

    /// The output cannot be written. Nothing is left behind.
    #[error("{}: cannot write: {}", shown_path(path), shown_line(reason))]
    #[non_exhaustive]
    Output {
        /// The file that was asked for.
        path: PathBuf,
        /// Why it cannot be written.
        reason: String,
        /// What the system or the encoder said.
        #[source]
        source: Option<Cause>,
    },

    /// The caller's progress function asked to stop.
    #[error("interrupted; nothing was written")]
    Interrupted,
}

/// What kind of thing went wrong; programs match on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// See [`Error::Scene`].
    Scene,
    /// See [`Error::Input`].
    Input,
    /// See [`Error::Unsupported`].
    Unsupported,
    /// See [`Error::NoSuchDevice`].
    NoSuchDevice,
    /// See [`Error::Build`].
    Build,
    /// See [`Error::SelfTest`].
    SelfTest,
    /// See [`Error::Device`].
    Device,
    /// See [`Error::Host`].
    Host,
    /// See [`Error::OutOfMemory`].
    OutOfMemory,
    /// See [`Error::OutputFormat`].
    OutputFormat,
    /// See [`Error::Output`].
    Output,
    /// See [`Error::Interrupted`].
    Interrupted,
}

impl ErrorKind {
    /// Returns the kind's name for other languages and for logs. It never changes.
    #[must_use]
    pub fn code(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Input => "input",
            Self::Unsupported => "unsupported",
            Self::NoSuchDevice => "no-such-device",
            Self::Build => "build",
            Self::SelfTest => "self-test",
            Self::Device => "device",
            Self::Host => "host",
            Self::OutOfMemory => "out-of-memory",
            Self::OutputFormat => "output-format",
            Self::Output => "output",
            Self::Interrupted => "interrupted",
        }
    }
}

impl Error {
    /// Returns what kind of thing went wrong.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Scene(_) => ErrorKind::Scene,
            Self::Input { .. } => ErrorKind::Input,
            Self::Unsupported(_) => ErrorKind::Unsupported,
            Self::NoSuchDevice(_) => ErrorKind::NoSuchDevice,
            Self::Build { .. } => ErrorKind::Build,
            Self::SelfTest { .. } => ErrorKind::SelfTest,
            Self::Device { .. } => ErrorKind::Device,
            Self::Host { .. } => ErrorKind::Host,
            Self::OutOfMemory(_) => ErrorKind::OutOfMemory,
            Self::OutputFormat(_) => ErrorKind::OutputFormat,
            Self::Output { .. } => ErrorKind::Output,
            Self::Interrupted => ErrorKind::Interrupted,
        }
    }

    /// Returns the stable name of its kind, see [`ErrorKind::code`].
    #[must_use]
    pub fn code(&self) -> &'static str {
        self.kind().code()
    }

    /// Makes the error of an input file that cannot be read, for a reason of our own.
    pub fn input(path: impl Into<PathBuf>, reason: impl Into<String>) -> Self {
        Self::Input {
            path: path.into(),
            reason: reason.into(),
            source: None,
        }
    }

    /// Makes the error of an output that cannot be written, for a reason of our own.
    pub fn output(path: impl Into<PathBuf>, reason: impl Into<String>) -> Self {
        Self::Output {
            path: path.into(),
            reason: reason.into(),
            source: None,
        }
    }

    /// Adds what another library or the system said.
    #[must_use]
    pub fn caused_by(mut self, cause: impl Into<Cause>) -> Self {
        if let Self::Input { source, .. }
        | Self::Output { source, .. }
        | Self::Device { source, .. } = &mut self
        {
            *source = Some(cause.into());
        }
        self
    }
}

/// A value at fault in a scene: where it stands and what is wrong with it.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
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
    /// Makes the fault of a value in a scene that may not come from a file.
    pub(crate) fn value(key: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            path: None,
            position: None,
            key: key.into(),
            message: message.into(),
        }
    }
}

impl std::error::Error for SceneError {}

impl std::fmt::Display for SceneError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.path {
            Some(path) => write!(f, "{}:", shown_path(path))?,
            None => write!(f, "scene:")?,
        }
        if let Some((line, column)) = self.position {
            write!(f, "{line}:{column}:")?;
        }
        if !self.key.is_empty() {
            write!(f, " {}:", shown(&self.key))?;
        }
        write!(f, " {}", shown_line(&self.message))
    }
}

impl From<SceneError> for Error {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

/// Returns the compiler's log, indented below the message; a hint where the driver gave none.
fn log_lines(log: &str) -> String {
    let log = log.trim();
    if log.is_empty() {
        return "; the driver gave no log: update it, or choose another device".to_owned();
    }
    log.lines().map(|line| format!("\n    {line}")).collect()
}

/// Returns the endings of the formats that this build has beside those of every build.
fn other_endings() -> &'static str {
    match (cfg!(feature = "webp"), cfg!(feature = "jpeg")) {
        (true, true) => ", also .webp and .jpg",
        (true, false) => ", also .webp",
        (false, true) => ", also .jpg",
        (false, false) => "",
    }
}
