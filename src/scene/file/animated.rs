//! Scenes of which something is a function of time.

use std::borrow::Cow;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::document::{Document, Motion};
use super::groups::Groups;
use super::moving::Moving;
use super::tree::{Moment, Node};
use super::words::Language;
use super::*;
use crate::image::{Background, DepthImage};

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
    files: OnceLock<Files>,
}

/// The depth image and the background, if they are the same at all times, once they were read.
#[derive(Debug)]
struct Files {
    /// For which image; `None`: for any.
    size: Option<ImageSize>,
    depth: Option<DepthImage>,
    background: Option<Background>,
}

impl Files {
    /// Gives a scene what it lacks.
    fn give(&self, scene: &mut Scene) {
        if self.size.is_some_and(|size| size != scene.image) {
            return;
        }
        if scene.depth.is_none() {
            scene.depth.clone_from(&self.depth);
        }
        if scene.display.background.is_none() {
            scene.display.background.clone_from(&self.background);
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
        Self::from_json_in(text, "")
    }

    /// Reads a scene in JSON; files that it names are from a folder.
    ///
    /// # Errors
    /// As [`AnimatedScene::from_json`].
    #[cfg(feature = "json")]
    pub fn from_json_in(text: impl Into<String>, folder: impl AsRef<Path>) -> Result<Self> {
        Document::read(true, text.into(), None, folder.as_ref()).map(Self::of)
    }

    /// Reads a scene in JSON if it begins with `{`, else in TOML; files that it names are from a folder.
    ///
    /// ```
    /// # fn main() -> energywave::Result<()> {
    /// use energywave::scene::AnimatedScene;
    ///
    /// let text = "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n[depth]\nfile = 'z.exr'\n";
    /// let scene = AnimatedScene::from_text(text, "shots/7")?;
    /// let missing = scene.at(0.0).err().map(|error| error.to_string());
    /// assert!(missing.is_some_and(|message| message.contains("shots/7/z.exr")));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`Error::Scene`] with line, column and key.
    pub fn from_text(text: impl Into<String>, folder: impl AsRef<Path>) -> Result<Self> {
        let text = text.into();
        Document::read(piped::looks_like_json(&text), text, None, folder.as_ref()).map(Self::of)
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
            files: OnceLock::from(Files {
                size: None,
                depth,
                background,
            }),
        })
    }

    /// Makes the scene begin again after a positive number of seconds, as `[time] loop` of a file does.
    #[must_use]
    pub fn with_loop(mut self, seconds: f64) -> Self {
        self.document.file.time.r#loop = Some(seconds);
        self
    }

    /// Opens a shutter for such a share of a frame, 0 to 1, as `[time] shutter` of a file does.
    #[must_use]
    pub fn with_shutter(mut self, share: f64) -> Self {
        self.document.file.time.shutter = share;
        self
    }

    fn of(document: Document<'static>) -> Self {
        Self {
            document,
            files: OnceLock::new(),
        }
    }

    /// Returns whether it has a track, or waves of particles that are shown as they are at its time.
    #[must_use]
    pub fn is_animated(&self) -> bool {
        !self.document.motion.moving.is_empty() || self.document.file.plays()
    }

    /// Returns after how many seconds it begins again; `None` if it does not say.
    #[must_use]
    pub fn period(&self) -> Option<f64> {
        self.document.file.period()
    }

    /// Returns for which share of a frame the shutter is open, 0 to 1.
    #[must_use]
    pub fn shutter(&self) -> f64 {
        self.document.file.time.shutter
    }

    /// Returns from when to when the shutter is open in a frame that begins at a time, seconds, of which there are
    /// `rate` a second: it opens where the frame begins, so that frame n of a scene shows nothing before n / `rate`.
    /// Empty without a shutter, and where nothing moves.
    #[must_use]
    pub fn open_at(&self, time: f64, rate: f64) -> Range<f64> {
        match self.is_animated() {
            true => time..time + self.shutter() / rate,
            false => time..time,
        }
    }

    /// Returns the scene at a time, seconds, checked.
    ///
    /// # Errors
    /// As [`Scene::from_file`].
    pub fn at(&self, time: f64) -> Result<Scene> {
        self.at_with(time, |_, _| Ok(()))
    }

    /// Returns the scene at a time, which `adjust` may change as in [`Scene::from_file_with`].
    ///
    /// # Errors
    /// As [`Scene::from_file_with`].
    pub fn at_with(
        &self,
        time: f64,
        mut adjust: impl FnMut(&mut Scene, &MethodKeys) -> Result<()>,
    ) -> Result<Scene> {
        Ok(self.checked(time, &mut adjust)?.0)
    }

    /// Returns the same, and its warnings, as [`Scene::from_file_with_warnings`] does.
    ///
    /// # Errors
    /// As [`Scene::from_file_with`].
    pub fn at_with_warnings(
        &self,
        time: f64,
        mut adjust: impl FnMut(&mut Scene, &MethodKeys) -> Result<()>,
    ) -> Result<(Scene, Vec<SceneError>)> {
        let (scene, groups, moment) = self.checked(time, &mut adjust)?;
        let warnings = self.warnings(&scene, &groups, moment);
        Ok((scene, warnings))
    }

    fn warnings(&self, scene: &Scene, groups: &Groups, moment: Moment) -> Vec<SceneError> {
        let Document { file, motion } = &self.document;
        let warnings = groups.warnings(scene).into_iter();
        let placed = warnings.map(|warning| motion.placed(warning, moment));
        placed.chain(motion.seam(file)).collect()
    }

    /// Returns what `make` makes of the scene at a time, and the scene's warnings. A fault that `make` finds by a key
    /// of the scene, such as `sphere[3].profile`, stands where the file has it, as the scene's own faults do.
    ///
    /// # Errors
    /// As [`Scene::from_file`], and those of `make`.
    pub fn made_at<T>(
        &self,
        time: f64,
        make: impl FnOnce(&Scene) -> Result<T>,
    ) -> Result<(T, Vec<SceneError>)> {
        let (scene, groups, moment) = self.checked(time, &mut |_, _| Ok(()))?;
        let made = make(&scene).map_err(|error| match error {
            Error::Scene(fault) => {
                let named = groups.named(fault);
                self.document.motion.placed(named, moment).into()
            }
            other => other,
        })?;
        Ok((made, self.warnings(&scene, &groups, moment)))
    }

    fn checked(&self, time: f64, adjust: Adjust<'_>) -> Result<(Scene, Groups, Moment)> {
        let Document { file, motion } = &self.document;
        let mut adjusts = (false, false);
        let mut adjust = |scene: &mut Scene, keys: &MethodKeys| {
            adjust(scene, keys)?;
            adjusts = (scene.depth.is_some(), scene.display.background.is_some());
            if let Some(files) = self.files.get() {
                files.give(scene);
            }
            Ok(())
        };
        let make = |file: SceneFile| file.into_checked(&motion.folder, &mut adjust);
        let ((scene, groups), moment) = motion.frame(file.clone(), time, make)?;
        let changes = |table| {
            let mut keys = motion.moving.keys.iter();
            keys.any(|key| key.starts_with(table))
        };
        self.files.get_or_init(|| {
            let (has_depth, has_background) = adjusts;
            let is_length =
                |depth: &DepthImage| depth.options().is_some_and(|it| it.along.is_length());
            let stays = |depth: &DepthImage| {
                !has_depth && !changes("depth.") && (is_length(depth) || !changes("camera."))
            };
            let background = scene.display.background.clone();
            Files {
                size: Some(scene.image),
                depth: scene.depth.clone().filter(stays),
                background: background.filter(|_| !has_background),
            }
        });
        Ok((scene, groups, moment))
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
            adjust(scene, keys)?;
            if let Some(files) = &files {
                files.give(scene);
            }
            Ok(())
        })
    }
}
