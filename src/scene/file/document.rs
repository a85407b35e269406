//! A scene file that was read, and what takes it to another time.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::moving::Moving;
use super::tracks::read;
use super::tree::Moment;
use super::words::Language;
use super::*;
use crate::scene::track::wrapped;

/// A scene file that was read: as it is at 0 s, and what of it changes.
#[derive(Debug, Clone)]
pub(super) struct Document<'a> {
    pub file: SceneFile,
    pub motion: Motion<'a>,
}

/// What takes a file to another time.
#[derive(Debug, Clone)]
pub(super) struct Motion<'a> {
    pub moving: Moving,
    pub language: Language,
    /// The text of the file; of a scene that was made in code, none.
    pub text: Cow<'a, str>,
    /// What errors call it.
    pub name: Option<PathBuf>,
    /// Where files are that it names.
    pub folder: PathBuf,
    /// The exposure of all times, where the file names none.
    pub fitting: OnceLock<f64>,
}

impl<'a> Document<'a> {
    /// Reads a text, whose errors are called by `name`.
    pub(super) fn read(
        is_json: bool,
        text: impl Into<Cow<'a, str>>,
        name: Option<&Path>,
        folder: &Path,
    ) -> Result<Self> {
        let text = text.into();
        let (language, read) = match is_json {
            true => (json::LANGUAGE, json::read(&text)),
            false => (Language::Toml, toml::read(&text)),
        };
        let (file, moving) = read.map_err(|error| match name {
            Some(name) => name_file(error, name),
            None => error,
        })?;
        let motion = Motion {
            moving,
            language,
            text,
            name: name.map(Path::to_owned),
            folder: folder.to_owned(),
            fitting: OnceLock::new(),
        };
        Ok(Self { file, motion })
    }

    /// Makes the scene at a time, and its warnings.
    pub(super) fn into_frame(self, time: f64, adjust: Adjust<'_>) -> Result<Read> {
        let (motion, file) = (self.motion, self.file);
        let seam = motion.seam(&file);
        let ((scene, warnings), moment) =
            motion.frame(file, time, |file| file.into_scene(&motion.folder, adjust))?;
        let placed = |warning| motion.placed(warning, moment);
        let warnings = warnings.into_iter().map(placed);
        Ok((scene, warnings.chain(seam).collect()))
    }
}

impl Motion<'_> {
    /// Makes of a file as it is at 0 s what `make` makes of the file at a time.
    pub(super) fn frame<T>(
        &self,
        mut file: SceneFile,
        time: f64,
        make: impl FnOnce(SceneFile) -> Result<T>,
    ) -> Result<(T, Moment)> {
        if !time.is_finite() {
            let message = format!("{time} is no time; it is a finite number of seconds");
            return Err(SceneError::value("", message).into());
        }
        let moment = self.moment(&file, time);
        let exposure = self.exposure(&file);
        self.go_to(&mut file, moment)?;
        file.play(moment.time);
        file.display.exposure = file.display.exposure.or(exposure);
        match make(file) {
            Ok(made) => Ok((made, moment)),
            Err(Error::Scene(fault)) => Err(self.placed(fault, moment).into()),
            Err(other) => Err(other),
        }
    }

    /// Returns when a time is in the scene's loop.
    pub(super) fn moment(&self, file: &SceneFile, time: f64) -> Moment {
        let period = file.period();
        Moment {
            time: period.map_or(time, |period| wrapped(time, period)),
            period,
        }
    }

    /// Reads again what changes.
    pub(super) fn go_to(&self, file: &mut SceneFile, moment: Moment) -> Result<()> {
        let moving = &self.moving;
        if moving.is_empty() || moment.time == 0.0 {
            return Ok(());
        }
        let fault = |(key, message): (String, String)| {
            self.placed(SceneError::value(moving.whole_key(&key), message), moment)
        };
        if let Some(singles) = &moving.singles {
            file.replace_singles(read(singles, moment, self.language).map_err(fault)?);
        }
        let units: SourceTables = read(&moving.units, moment, self.language).map_err(fault)?;
        file.replace(units, &moving.indices);
        Ok(())
    }

    /// Says where a fault is, and when, if it is where something changes.
    pub(super) fn placed(&self, mut fault: SceneError, moment: Moment) -> SceneError {
        let key = fault.key.as_str();
        let changes = |track: &String| track.starts_with(key) || key.starts_with(track.as_str());
        if !key.is_empty() && self.moving.keys.iter().any(changes) {
            fault.message += &format!(" (at {} s)", moment.time);
        }
        self.found(fault)
    }

    /// Says where a fault is.
    pub(super) fn found(&self, mut fault: SceneError) -> SceneError {
        if self.language == Language::Toml && !self.text.is_empty() {
            fault.position = Some(toml::place_of(&self.text, &fault));
        }
        fault.path.clone_from(&self.name);
        fault
    }
}

fn name_file(error: Error, path: &Path) -> Error {
    match error {
        Error::Scene(mut fault) => {
            fault.path = Some(PathBuf::from(path));
            Error::Scene(fault)
        }
        other => other,
    }
}
