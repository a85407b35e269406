//! Reads a scene from TOML or JSON; every fault is reported with file, line, column and key.

mod depth;
#[cfg_attr(not(feature = "json"), path = "no_json.rs")]
mod json;
mod locate;
mod piped;
mod write;

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::integration::{check_divisions, check_tolerance};
use super::kinds::for_each_kind;
use super::values::{Fault, unnamed};
use super::*;
use crate::error::{Error, Result, SceneError};
use depth::DepthTable;
use locate::{KeyMap, line_and_column};

/// Changes a scene between its reading and its check.
type Adjust<'a> = &'a mut dyn FnMut(&mut Scene, &MethodKeys) -> Result<()>;

macro_rules! define_scene_file {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// A scene as a file describes it.
        #[derive(Deserialize, Serialize)]
        #[serde(deny_unknown_fields)]
        struct SceneFile {
            camera: Camera,
            #[serde(default)]
            image: ImageSize,
            #[serde(default, skip_serializing_if = "Option::is_none")]
            decay: Option<Decay>,
            #[serde(default)]
            integration: IntegrationTable,
            #[serde(default)]
            display: Display,
            #[serde(default, skip_serializing_if = "Option::is_none")]
            depth: Option<DepthTable>,
            $(#[serde(default, skip_serializing_if = "is_empty")] $kind: List<$Type>,)*
        }

        impl SceneFile {
            /// Returns the scene without its depth image.
            fn scene(&mut self) -> Scene {
                Scene {
                    camera: self.camera.clone(),
                    image: self.image,
                    decay: self.decay,
                    integration: self.integration.integration(),
                    display: self.display,
                    depth: None,
                    $($list: std::mem::take(&mut self.$kind),)*
                }
            }

            /// Makes a file's scene as it is written.
            fn of(scene: &Scene, depth: Option<DepthTable>) -> Self {
                Self {
                    camera: scene.camera.clone(),
                    image: scene.image,
                    decay: scene.decay,
                    integration: IntegrationTable::of(&scene.integration),
                    display: scene.display,
                    depth,
                    $($kind: scene.$list.clone(),)*
                }
            }
        }
    };
}
for_each_kind!(define_scene_file);

fn is_empty<T>(list: &List<T>) -> bool {
    list.len() == 0
}

/// `[integration]`: keys of both methods may stand there, whichever is chosen.
#[derive(Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
struct IntegrationTable {
    method: MethodName,
    #[serde(skip_serializing_if = "Option::is_none")]
    divisions: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sampling: Option<Sampling>,
    measure: Measure,
    softening: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
enum MethodName {
    Simpson,
    Exact,
}

impl Default for IntegrationTable {
    fn default() -> Self {
        let Integration {
            measure, softening, ..
        } = Integration::default();
        Self {
            method: MethodName::Exact,
            divisions: None,
            tolerance: None,
            sampling: None,
            measure,
            softening,
        }
    }
}

/// What `[integration]` of a file says of either method, whichever it chooses; the default where it says nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MethodKeys {
    /// Simpson: number of equal divisions.
    pub divisions: u32,
    /// Exact: relative error aimed at.
    pub tolerance: f64,
    /// Exact: where integrals are taken.
    pub sampling: Sampling,
}

impl IntegrationTable {
    fn keys(&self) -> MethodKeys {
        MethodKeys {
            divisions: self.divisions.unwrap_or(200),
            tolerance: self.tolerance.unwrap_or(1e-3),
            sampling: self.sampling.unwrap_or_default(),
        }
    }

    fn integration(&self) -> Integration {
        let keys = self.keys();
        Integration {
            method: match self.method {
                MethodName::Simpson => Method::Simpson {
                    divisions: keys.divisions,
                },
                MethodName::Exact => Method::Exact {
                    tolerance: keys.tolerance,
                    sampling: keys.sampling,
                },
            },
            measure: self.measure,
            softening: self.softening,
        }
    }

    fn of(integration: &Integration) -> Self {
        let keep = Self {
            measure: integration.measure,
            softening: integration.softening,
            ..Self::default()
        };
        match integration.method {
            Method::Simpson { divisions } => Self {
                method: MethodName::Simpson,
                divisions: Some(divisions),
                ..keep
            },
            Method::Exact {
                tolerance,
                sampling,
            } => Self {
                method: MethodName::Exact,
                tolerance: Some(tolerance),
                sampling: Some(sampling),
                ..keep
            },
        }
    }

    /// Checks what the scene does not hold: the keys of the method that was not chosen.
    fn check(&self) -> std::result::Result<(), Fault> {
        let keys = self.keys();
        check_divisions(keys.divisions)?;
        if self.method == MethodName::Simpson && self.sampling == Some(Sampling::Tiles) {
            let message = "tiles are for the method \"exact\"; Simpson's rule takes every pixel";
            return Err(Fault::new("sampling", message));
        }
        check_tolerance(keys.tolerance)
    }
}

impl SceneFile {
    /// Checks the scene, lets `adjust` change it, reads a depth image unless it has given one, and checks it again.
    fn into_scene(mut self, folder: &Path, adjust: Adjust<'_>) -> Result<Scene> {
        let mut scene = self.scene();
        self.integration
            .check()
            .map_err(|fault| fault.of("integration"))?;
        scene.check()?;
        adjust(&mut scene, &self.integration.keys())?;
        if let (Some(depth), None) = (&self.depth, &scene.depth) {
            scene.depth = Some(depth.open(folder)?);
        }
        scene.check()?;
        Ok(scene)
    }
}

impl Scene {
    /// Reads and validates a scene file; the ending chooses: `.json` is JSON, everything else TOML.
    ///
    /// # Errors
    /// [`Error::Input`] if the file cannot be read, [`Error::Scene`] if it does not hold a valid scene.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self> {
        Self::from_file_with(path, |_, _| Ok(()))
    }

    /// Like [`Scene::from_file`]; `adjust` may change the scene, which is then checked again. It is also told what the
    /// file says of the method that it does not choose. A depth image that it gives takes the place of the file's,
    /// which is then not read.
    ///
    /// # Errors
    /// As [`Scene::from_file`], and those of `adjust`.
    pub fn from_file_with(
        path: impl AsRef<Path>,
        mut adjust: impl FnMut(&mut Self, &MethodKeys) -> Result<()>,
    ) -> Result<Self> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|error| {
            Error::input(path, format!("cannot read: {error}")).caused_by(error)
        })?;
        if piped::is_piped(path) {
            return piped::read(path, bytes, &mut adjust);
        }
        let text = text_of(path, bytes)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        read_as(is_json(path), path, &text, folder, &mut adjust)
    }

    /// Reads and validates a scene in TOML; a depth image's path is from the working folder.
    ///
    /// # Errors
    /// [`Error::Scene`] with line, column and key.
    pub fn from_toml(text: &str) -> Result<Self> {
        from_toml(text, Path::new(""), &mut |_, _| Ok(()))
    }

    /// Reads and validates a scene in JSON, of the same structure as the TOML.
    ///
    /// # Errors
    /// [`Error::Scene`] with the key; faults of the syntax have line and column too.
    #[cfg(feature = "json")]
    pub fn from_json(text: &str) -> Result<Self> {
        json::read(text, Path::new(""), &mut |_, _| Ok(()))
    }
}

fn is_json(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
}

fn from_toml(text: &str, folder: &Path, adjust: Adjust<'_>) -> Result<Scene> {
    let locate = |key: &str| {
        let offset = KeyMap::new(text).offset_of(key);
        line_and_column(text, offset.unwrap_or(0))
    };
    let file: SceneFile = toml::from_str(text).map_err(|error| toml_fault(text, &error))?;
    file.into_scene(folder, adjust)
        .map_err(|error| match error {
            Error::Scene(mut fault) => {
                fault.position = Some(locate(&fault.key));
                Error::Scene(fault)
            }
            other => other,
        })
}

fn read_as(
    is_json: bool,
    name: &Path,
    text: &str,
    folder: &Path,
    adjust: Adjust<'_>,
) -> Result<Scene> {
    let scene = match is_json {
        true => json::read(text, folder, adjust),
        false => from_toml(text, folder, adjust),
    };
    scene.map_err(|error| name_file(error, name))
}

fn text_of(path: &Path, bytes: Vec<u8>) -> Result<String> {
    let fail = |reason: String| Error::input(path, reason);
    let no_text = match String::from_utf8(bytes) {
        Ok(text) => match text.find('\0') {
            None => return Ok(text),
            Some(at) => at,
        },
        Err(error) => error.utf8_error().valid_up_to(),
    };
    Err(fail(format!(
        "not a text file (byte {no_text}); a scene is TOML or JSON in UTF-8"
    )))
}

/// Makes the fault of syntax, type or key name that the TOML reader found.
fn toml_fault(text: &str, error: &toml::de::Error) -> SceneError {
    if text.trim().is_empty() {
        return empty_file();
    }
    let span = error.span().unwrap_or(0..0);
    let offset = span.start;
    let key = KeyMap::new(text).path_at(&span).unwrap_or("").to_owned();
    let words = plain_words(error.message());
    if let Some((field, message)) = unnamed(&words) {
        let key = format!("{key}.{field}");
        let offset = KeyMap::new(text).offset_of(&key).unwrap_or(offset);
        return SceneError {
            position: Some(line_and_column(text, offset)),
            ..SceneError::value(key, message)
        };
    }
    let (key, mut message) = name_missing(key, words);
    if let (Some(quoted), true) = (text.get(span), key.is_empty())
        && (1..40).contains(&quoted.len())
        && !quoted.contains(['\n', '`'])
    {
        message += &format!(" `{quoted}`");
    }
    SceneError {
        path: None,
        position: Some(line_and_column(text, offset)),
        key,
        message,
    }
}

fn empty_file() -> SceneError {
    SceneError {
        position: Some((1, 1)),
        ..SceneError::value(
            "camera",
            "the file is empty; a scene needs at least [camera] with eye and target",
        )
    }
}

/// Turns "missing field `x`" in table `key` into a fault of `key.x`.
fn name_missing(key: String, message: String) -> (String, String) {
    let field = message
        .strip_prefix("missing field `")
        .and_then(|rest| rest.strip_suffix('`'));
    let key = match field {
        // Only [camera] is required at the top, which has no key of its own.
        Some("camera") => "camera".to_owned(),
        Some(field) => format!("{key}.{field}"),
        None => return (key, message),
    };
    (key, "required, but missing".to_owned())
}

/// Puts a message into plain words: serde speaks of Rust types, a scene's author thinks of numbers.
fn plain_words(message: &str) -> String {
    message
        .trim()
        .replace("floating point `", "number `")
        .replace("expected f64", "expected a number")
        .replace(
            "expected u32",
            "expected a whole number from 0 to 4294967295",
        )
        .replace(
            "invalid type: map, expected a sequence",
            "there may be several: write double brackets, such as [[sphere]]",
        )
        .replace("expected struct ", "expected the table of ")
        .replace('\n', "; ")
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
