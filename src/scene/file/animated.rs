//! Scenes of which something is a function of time.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::moving::Moving;
use super::pieces::source_key;
use super::scan::UNITS;
use super::tracks::read;
use super::tree::{Moment, Node};
use super::words::Language;
use super::*;
use crate::image::{Background, DepthImage};
use crate::scene::track::wrapped;

/// A scene file that was read: as it is at 0 s, and what of it changes.
#[derive(Debug, Clone)]
pub(super) struct Document<'a> {
    pub(super) file: SceneFile,
    pub(super) motion: Motion<'a>,
}

/// What takes a file to another time.
#[derive(Debug, Clone)]
pub(super) struct Motion<'a> {
    pub(super) moving: Moving,
    language: Language,
    /// The text of the file; of a scene that was made in code, none.
    pub(super) text: Cow<'a, str>,
    /// What errors call it.
    name: Option<PathBuf>,
    /// Where files are that it names.
    pub(super) folder: PathBuf,
    /// The exposure of all times, where the file names none.
    pub(super) fitting: OnceLock<f64>,
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
        let ((scene, warnings), moment) =
            motion.frame(file, time, |file| file.into_scene(&motion.folder, adjust))?;
        let placed = |warning| motion.placed(warning, moment);
        Ok((scene, warnings.into_iter().map(placed).collect()))
    }
}

impl Motion<'_> {
    /// Makes of a file as it is at 0 s what `make` makes of the file at a time.
    fn frame<T>(
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
            let key = match source_key(&key) {
                Some((unit, index, rest)) => {
                    let whole = moving.indices[unit].get(index).copied().unwrap_or(index);
                    format!("{}[{whole}]{rest}", UNITS[unit])
                }
                None => key,
            };
            self.placed(SceneError::value(key, message), moment)
        };
        if let Some(singles) = &moving.singles {
            file.replace_singles(read(singles, moment, self.language).map_err(fault)?);
        }
        let units: SourceTables = read(&moving.units, moment, self.language).map_err(fault)?;
        file.replace(units, &moving.indices);
        Ok(())
    }

    /// Says where a fault is, and when, if it is where something changes.
    fn placed(&self, mut fault: SceneError, moment: Moment) -> SceneError {
        let key = fault.key.as_str();
        let changes = |track: &String| track.starts_with(key) || key.starts_with(track.as_str());
        if !key.is_empty() && self.moving.keys.iter().any(changes) {
            fault.message += &format!(" (at {} s)", moment.time);
        }
        if self.language == Language::Toml && !self.text.is_empty() {
            fault.position = Some(toml::place_of(&self.text, &fault));
        }
        fault.path.clone_from(&self.name);
        fault
    }
}

/// A scene of which something is a function of time, by [`Track`]s.
///
/// ```
/// # fn main() -> energywave::Result<()> {
/// use energywave::scene::AnimatedScene;
///
/// let scene = AnimatedScene::from_toml(
///     "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n[[torus]]\n\
///      major_radius = { times = [0, 2], values = [0.5, 1.5] }\n",
/// )?;
/// assert_eq!(scene.at(1.0)?.tori[0].major_radius, 1.0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct AnimatedScene {
    pub(super) document: Document<'static>,
    /// The depth image and the background, if they are the same at all times, once they were read.
    files: OnceLock<Files>,
}

type Files = (Option<DepthImage>, Option<Background>);

/// Gives a scene what was read already.
fn give_files(scene: &mut Scene, files: Option<&Files>) {
    if let Some((depth, background)) = files {
        scene.depth.clone_from(depth);
        if background.is_some() {
            scene.display.background.clone_from(background);
        }
    }
}

impl AnimatedScene {
    /// Reads a scene file, as [`Scene::from_file`] does. What is wrong with the scene at a time, [`AnimatedScene::at`]
    /// says.
    ///
    /// # Errors
    /// [`Error::Input`] if the file cannot be read, [`Error::Scene`] if it does not hold a scene.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self> {
        open(path.as_ref()).map(Self::of)
    }

    /// Reads a scene in TOML; files that it names are from the working folder.
    ///
    /// # Errors
    /// [`Error::Scene`] with line, column and key.
    pub fn from_toml(text: impl Into<String>) -> Result<Self> {
        Document::read(false, text.into(), None, Path::new("")).map(Self::of)
    }

    /// Reads a scene in JSON, of the same structure as the TOML.
    ///
    /// # Errors
    /// [`Error::Scene`] with the key; faults of the syntax have line and column too.
    #[cfg(feature = "json")]
    pub fn from_json(text: impl Into<String>) -> Result<Self> {
        Document::read(true, text.into(), None, Path::new("")).map(Self::of)
    }

    /// Reads what a pipe brings, as [`Scene::from_reader_with`] does.
    ///
    /// # Errors
    /// As [`AnimatedScene::from_file`].
    pub fn from_reader(reader: impl std::io::Read, name: impl AsRef<Path>) -> Result<Self> {
        piped::open(reader, name.as_ref()).map(Self::of)
    }

    /// Sets tracks in the place of values of a scene, each by the key that the value has in a file, such as
    /// `torus[0].color`. Depths, and a background, stay as they are.
    ///
    /// ```
    /// # fn main() -> energywave::Result<()> {
    /// use energywave::Scene;
    /// use energywave::glam::DVec3;
    /// use energywave::scene::{AnimatedScene, Camera, Torus, Track};
    ///
    /// let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 2.0), DVec3::ZERO));
    /// scene.tori.push(Torus::new(0.1));
    /// let radius = Track::new([(0.0, 0.1), (2.0, 1.5)]);
    /// let scene = AnimatedScene::new(scene, [("torus[0].major_radius", radius)])?;
    /// assert_eq!(scene.at(5.0)?.tori[0].major_radius, 1.5);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`Error::Scene`] if a key has no value that can change, or a track is none.
    pub fn new<K: AsRef<str>>(
        mut scene: Scene,
        tracks: impl IntoIterator<Item = (K, Track)>,
    ) -> Result<Self> {
        let depth = scene.depth.take();
        let background = match scene.display.background.take() {
            Some(Background::Image(image)) => Some(Background::Image(image)),
            color => {
                scene.display.background = color;
                None
            }
        };
        let text = scene.to_toml()?;
        let written = |error: ::toml::de::Error| Error::Unsupported(error.message().to_owned());
        let mut document: Node = ::toml::from_str(&text).map_err(written)?;
        let mut keys = Vec::new();
        for (key, track) in tracks {
            let key = key.as_ref();
            keys.push(key.to_owned());
            track.check().map_err(|fault| fault.of(key))?;
            document.put(key, track).ok_or_else(|| {
                SceneError::value(
                    key,
                    "the scene has no such key; keys are as in a file, such as torus[0].color",
                )
            })?;
        }
        let (file, moving) = match Moving::read_document(document, Language::Toml)? {
            Some(read) => read,
            None => (::toml::from_str(&text).map_err(written)?, Moving::default()),
        };
        if let Some(key) = keys.into_iter().find(|key| !moving.keys.contains(key)) {
            let message = "it is no number, vector or colour, and no list of such, of the scene";
            return Err(SceneError::value(key, message).into());
        }
        let motion = Motion {
            moving,
            language: Language::Toml,
            text: Cow::Borrowed(""),
            name: None,
            folder: PathBuf::new(),
            fitting: OnceLock::new(),
        };
        Ok(Self {
            document: Document { file, motion },
            files: OnceLock::from((depth, background)),
        })
    }

    /// Makes the scene begin again after a positive number of seconds, as `[time] loop` of a file does.
    #[must_use]
    pub fn with_loop(mut self, seconds: f64) -> Self {
        self.document.file.time = TimeTable {
            r#loop: Some(seconds),
        };
        self
    }

    fn of(document: Document<'static>) -> Self {
        Self {
            document,
            files: OnceLock::new(),
        }
    }

    /// Returns whether it has a track.
    #[must_use]
    pub fn is_animated(&self) -> bool {
        !self.document.motion.moving.is_empty()
    }

    /// Returns after how many seconds it begins again; `None` if it does not say.
    #[must_use]
    pub fn period(&self) -> Option<f64> {
        self.document.file.period()
    }

    /// Returns the scene at a time, seconds, checked.
    ///
    /// # Errors
    /// As [`Scene::from_file`].
    pub fn at(&self, time: f64) -> Result<Scene> {
        self.at_with(time, |_, _| Ok(()))
    }

    /// Like [`AnimatedScene::at`]; `adjust` may change the scene as that of [`Scene::from_file_with`] does.
    ///
    /// # Errors
    /// As [`Scene::from_file_with`].
    pub fn at_with(
        &self,
        time: f64,
        mut adjust: impl FnMut(&mut Scene, &MethodKeys) -> Result<()>,
    ) -> Result<Scene> {
        let Document { file, motion } = &self.document;
        let mut adjust = |scene: &mut Scene, keys: &MethodKeys| {
            give_files(scene, self.files.get());
            adjust(scene, keys)
        };
        let make = |file: SceneFile| file.into_checked(&motion.folder, &mut adjust);
        let ((scene, _), _) = motion.frame(file.clone(), time, make)?;
        let changes = |table| {
            let mut keys = motion.moving.keys.iter();
            keys.any(|key| key.starts_with(table))
        };
        if !["camera.", "image.", "depth."].into_iter().any(changes) {
            let is_image = |it: &Background| matches!(it, Background::Image(_));
            let background = scene.display.background.clone().filter(is_image);
            self.files.get_or_init(|| (scene.depth.clone(), background));
        }
        Ok(scene)
    }

    /// Returns the scene at a time as [`Scene::from_file_with_warnings`] returns that of a file: `adjust` may change
    /// it, and there are its warnings.
    ///
    /// # Errors
    /// As [`Scene::from_file_with`].
    pub fn into_frame(
        self,
        time: f64,
        mut adjust: impl FnMut(&mut Scene, &MethodKeys) -> Result<()>,
    ) -> Result<(Scene, Vec<SceneError>)> {
        let files = self.files.into_inner();
        self.document.into_frame(time, &mut |scene, keys| {
            give_files(scene, files.as_ref());
            adjust(scene, keys)
        })
    }
}
