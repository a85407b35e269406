//! Reads a scene from TOML or JSON; every fault is reported with file, line, column and key.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::locate::{KeyMap, line_and_column};
use super::{
    Beam, Camera, Curve, Cylinder, Decay, Display, ImageSize, Integration, Scene, Sphere, Torus,
};
use crate::error::{Error, Result, SceneError};
use crate::image::{DepthAlong, DepthImage};

/// A scene as a file has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    camera: Camera,
    #[serde(default)]
    image: ImageSize,
    #[serde(default)]
    decay: Option<Decay>,
    #[serde(default)]
    integration: Integration,
    #[serde(default)]
    display: Display,
    #[serde(default)]
    depth: Option<DepthFile>,
    #[serde(default)]
    sphere: Vec<Sphere>,
    #[serde(default)]
    cylinder: Vec<Cylinder>,
    #[serde(default)]
    beam: Vec<Beam>,
    #[serde(default)]
    torus: Vec<Torus>,
    #[serde(default)]
    curve: Vec<Curve>,
}

/// Changes a scene between its reading and its check.
type Adjust<'a> = &'a mut dyn FnMut(&mut Scene) -> Result<()>;

/// A depth image in a file of its own.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DepthFile {
    /// From the folder of the scene.
    file: PathBuf,
    #[serde(default)]
    along: DepthAlong,
}

impl SceneFile {
    /// Checks the scene, lets `adjust` change it, reads a depth image unless it has given one, and checks it again.
    fn into_scene(self, folder: &Path, adjust: Adjust<'_>) -> Result<Scene> {
        let mut scene = Scene {
            camera: self.camera,
            image: self.image,
            decay: self.decay,
            integration: self.integration,
            display: self.display,
            depth: None,
            spheres: self.sphere,
            cylinders: self.cylinder,
            beams: self.beam,
            tori: self.torus,
            curves: self.curve,
        };
        scene.check()?;
        adjust(&mut scene)?;
        if let (Some(depth), None) = (&self.depth, &scene.depth) {
            let image = DepthImage::open(folder.join(&depth.file), depth.along)
                .map_err(|error| SceneError::value("depth.file", error.to_string()))?;
            scene.depth = Some(image);
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
        Self::from_file_with(path, |_| Ok(()))
    }

    /// Like [`Scene::from_file`]; `adjust` may change the scene, which is then checked again. A depth image that it gives takes the
    /// place of the file's, which is then not read.
    ///
    /// # Errors
    /// As [`Scene::from_file`], and those of `adjust`.
    pub fn from_file_with(
        path: impl AsRef<Path>,
        mut adjust: impl FnMut(&mut Self) -> Result<()>,
    ) -> Result<Self> {
        let path = path.as_ref();
        let text = read_text(path)?;
        let is_json = path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
        let folder = path.parent().unwrap_or(Path::new(""));
        let scene = match is_json {
            true => from_json(&text, folder, &mut adjust),
            false => from_toml(&text, folder, &mut adjust),
        };
        scene.map_err(|error| name_file(error, path))
    }

    /// Reads and validates a scene in TOML; a depth image's path is from the working folder.
    ///
    /// # Errors
    /// [`Error::Scene`] with line, column and key.
    pub fn from_toml(text: &str) -> Result<Self> {
        from_toml(text, Path::new(""), &mut |_| Ok(()))
    }

    /// Reads and validates a scene in JSON, of the same structure as the TOML.
    ///
    /// # Errors
    /// [`Error::Scene`] with the key; faults of the syntax have line and column too.
    pub fn from_json(text: &str) -> Result<Self> {
        from_json(text, Path::new(""), &mut |_| Ok(()))
    }
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

fn from_json(text: &str, folder: &Path, adjust: Adjust<'_>) -> Result<Scene> {
    let text = text.trim_start_matches('\u{feff}');
    if text.trim().is_empty() {
        return Err(empty_file().into());
    }
    let mut reader = serde_json::Deserializer::from_str(text);
    let file: SceneFile = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let key = match error.path().to_string() {
            unknown if unknown == "." || unknown == "?" => String::new(),
            key => key,
        };
        let inner = error.inner();
        let message = plain_words(without_position(&inner.to_string()));
        let (key, message) = name_missing(key, message);
        SceneError {
            path: None,
            position: (inner.line() > 0).then(|| (inner.line(), inner.column())),
            key,
            message,
        }
    })?;
    reader.end().map_err(|error| SceneError {
        path: None,
        position: Some((error.line(), error.column())),
        key: String::new(),
        message: plain_words(without_position(&error.to_string())),
    })?;
    file.into_scene(folder, adjust)
}

fn read_text(path: &Path) -> Result<String> {
    let fail = |reason: String| Error::Input {
        path: path.to_owned(),
        reason,
    };
    let bytes = std::fs::read(path).map_err(|error| fail(format!("cannot read: {error}")))?;
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

/// A fault of syntax, type or key name, as the TOML reader found it.
fn toml_fault(text: &str, error: &toml::de::Error) -> SceneError {
    if text.trim().is_empty() {
        return empty_file();
    }
    let span = error.span().unwrap_or(0..0);
    let offset = span.start;
    let key = KeyMap::new(text).path_at(&span).unwrap_or("").to_owned();
    let (key, mut message) = name_missing(key, plain_words(error.message()));
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

/// "missing field `x`" in table `key` becomes a fault of `key.x`.
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

/// serde speaks of Rust types; a scene's author thinks of numbers.
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

/// serde_json ends its messages with a position that stands at the front of ours.
fn without_position(message: &str) -> &str {
    message.split(" at line ").next().unwrap_or(message)
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

/// Exactly three numbers; some formats would let a fourth pass unread.
pub(super) fn vector<'de, D: Deserializer<'de>>(reader: D) -> std::result::Result<DVec3, D::Error> {
    let numbers = Vec::<f64>::deserialize(reader)?;
    let found = numbers.len();
    let numbers: [f64; 3] = numbers
        .try_into()
        .map_err(|_| D::Error::custom(format!("expected three numbers, found {found}")))?;
    Ok(numbers.into())
}

/// Exactly three control points.
pub(super) fn three_points<'de, D: Deserializer<'de>>(
    reader: D,
) -> std::result::Result<[DVec3; 3], D::Error> {
    #[derive(Deserialize)]
    struct Point(#[serde(deserialize_with = "vector")] DVec3);
    let points = Vec::<Point>::deserialize(reader)?;
    let found = points.len();
    let points: Vec<DVec3> = points.into_iter().map(|point| point.0).collect();
    points.try_into().map_err(|_| {
        D::Error::custom(format!(
            "a quadratic curve has three control points, found {found}"
        ))
    })
}
