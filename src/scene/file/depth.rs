//! `[depth]`: a depth image in a file of its own, and how it is read.

use std::path::{Path, PathBuf};

use glam::DMat4;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::error::SceneError;
use crate::image::{ClipDepth, ClipRange, DepthAlong, DepthImage, DepthOptions};
use crate::scene::Scene;
use crate::scene::camera::{read_matrix, write_matrix};
use crate::scene::values::{Fault, finite};

#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DepthTable {
    /// From the folder of the scene.
    file: PathBuf,
    #[serde(default)]
    along: DepthAlong,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    channel: Option<String>,
    #[serde(default = "one", skip_serializing_if = "is_one")]
    scale: f64,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_none",
        serialize_with = "write_none"
    )]
    none: Option<f64>,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_matrix",
        serialize_with = "write_matrix"
    )]
    projection: Option<DMat4>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    range: Option<ClipRange>,
}

// What is read of `[depth]`.
keys! { pub(in crate::scene) DEPTH_KEYS;
    file: File, NONE, Required, "EXR, 16-bit PNG, or raw float32 (.raw, .f32) of the image's size";
    along: Word(&["ray", "axis", "ndc", "buffer"]), NONE, Value("\"ray\""),
        "from the eye, along the view, or depths of clip space, -1 or 0 to 1";
    channel: Text, NONE, Otherwise("by its name"), "the channel's exact name, or \"part.channel\"";
    scale: ANY, NONE, Value("1"), "world units to a unit of the file, but 0";
    none: NumberOrNan, NONE, Otherwise("infinity alone"), "the file's value that means that nothing is there";
    projection: Matrix, NONE, Otherwise("the camera's"), "the matrix that made depths of clip space";
    range: Word(&["0..1", "-1..1"]), NONE, Otherwise("by the projection"), "the depths of clip space";
}

impl DepthTable {
    /// Returns its file, from the folder of the scene.
    pub(super) fn file(&self) -> &Path {
        &self.file
    }

    /// Names the file that an image was read from; `None` for one that was made in code.
    pub(super) fn of(image: &DepthImage) -> Option<Self> {
        let (file, options) = (image.file()?, image.options()?);
        Some(Self {
            file: file.to_owned(),
            along: options.along,
            channel: options.channel.clone(),
            scale: options.scale,
            none: options.none,
            projection: options.clip.map(|clip| clip.projection()),
            range: options.clip.map(|clip| clip.range()),
        })
    }

    /// Reads the image of a scene; its path is from `folder`.
    pub(super) fn open(&self, folder: &Path, scene: &Scene) -> Result<DepthImage, SceneError> {
        self.check_scale().map_err(|fault| fault.of("depth"))?;
        let clip = self.clip(scene).map_err(|fault| fault.of("depth"))?;
        let mut options = DepthOptions::from(self.along);
        options.channel.clone_from(&self.channel);
        options.scale = self.scale;
        options.none = self.none;
        options.clip = clip;
        options.size = Some(scene.image);
        DepthImage::open(folder.join(&self.file), options)
            .map_err(|error| SceneError::value("depth.file", error.to_string()))
    }

    /// Returns what depths are that are no lengths: by the projection of the table, or the camera's.
    fn clip(&self, scene: &Scene) -> Result<Option<ClipDepth>, Fault> {
        if self.along.is_length() {
            for (key, is_there) in [
                ("projection", self.projection.is_some()),
                ("range", self.range.is_some()),
            ] {
                if is_there {
                    let message = "it is for depths that are no lengths: along = \"ndc\" or along = \"buffer\"";
                    return Err(Fault::new(key, message));
                }
            }
            return Ok(None);
        }
        let (key, clip) = match (self.projection, &scene.camera.matrices) {
            (Some(projection), _) => ("projection", ClipDepth::read(projection, self.range)),
            (None, Some(matrices)) => ("range", matrices.read_clip(self.range)),
            (None, None) => {
                let message = "such depths are behind a projection, and the camera has none: give it here as \
                     `projection`, or the camera as `view` and `projection`";
                return Err(Fault::new("along", message));
            }
        };
        let clip = clip.map_err(|message| Fault::new(key, message))?;
        if clip.is_orthographic() != scene.view_plane().is_parallel {
            let message = "one of this projection and the camera is orthographic, the other is not";
            return Err(Fault::new("projection", message));
        }
        Ok(Some(clip))
    }

    fn check_scale(&self) -> Result<(), Fault> {
        finite("scale", self.scale)?;
        match self.scale == 0.0 {
            true => Err(Fault::new("scale", "must not be 0")),
            false => Ok(()),
        }
    }
}

fn one() -> f64 {
    1.0
}

#[allow(clippy::trivially_copy_pass_by_ref)] // as serde calls it
fn is_one(scale: &f64) -> bool {
    *scale == 1.0
}

/// A number, or "nan", which JSON has no number for.
#[derive(Deserialize, Serialize)]
#[serde(untagged)]
enum NumberOrNan {
    Number(f64),
    Nan(Nan),
}

#[derive(Deserialize, Serialize)]
enum Nan {
    #[serde(rename = "nan")]
    Nan,
}

fn read_none<'de, D: Deserializer<'de>>(reader: D) -> Result<Option<f64>, D::Error> {
    match NumberOrNan::deserialize(reader) {
        Ok(NumberOrNan::Number(number)) => Ok(Some(number)),
        Ok(NumberOrNan::Nan(Nan::Nan)) => Ok(Some(f64::NAN)),
        Err(_) => Err(serde::de::Error::custom("expected a number or \"nan\"")),
    }
}

fn write_none<S: Serializer>(none: &Option<f64>, writer: S) -> Result<S::Ok, S::Error> {
    match none {
        Some(number) if !number.is_nan() => writer.serialize_f64(*number),
        _ => writer.serialize_str("nan"),
    }
}
