//! `[[volume]]` of a scene file: where its cells come from, and where they are put.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result, SceneError};
use crate::scene::colors::{read_color, read_some_colors};
use crate::scene::values::{read_some_vector, read_vector};
use crate::scene::{Volume, VolumeInterpolation, VolumeShape};
use crate::volume::{LightBall, Texture, TextureOrigin};

/// A volume as a file describes it.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct VolumeTable {
    /// From the folder of the scene, as the next one is.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    slices: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    light_ball: Option<BallTable>,
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_some_vector"
    )]
    center: Option<DVec3>,
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_some_vector"
    )]
    size: Option<DVec3>,
    #[serde(deserialize_with = "read_vector")]
    rotation: DVec3,
    coefficient: f64,
    #[serde(deserialize_with = "read_color")]
    color: DVec3,
    interpolation: VolumeInterpolation,
    method: VolumeShape,
    /// Its cells, once they were read; the tables of all times share them as long as they name the same.
    #[serde(skip)]
    texture: Arc<OnceLock<Texture>>,
}

/// A light ball as a file describes it.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
struct BallTable {
    #[serde(deserialize_with = "read_vector")]
    radii: DVec3,
    #[serde(deserialize_with = "read_some_colors")]
    colors: Option<Vec<DVec3>>,
    #[serde(deserialize_with = "read_vector")]
    alphas: DVec3,
    cells: u32,
}

// What is read of `[[volume]]`.
keys! { pub(in crate::scene) VOLUME_KEYS;
    file: File, NONE, Otherwise("slices or light_ball"), "cells: .vdb, .nrrd, .vti, or .raw with a .json beside it";
    slices: File, NONE, Otherwise("file or light_ball"),
        "pictures of slices, sorted by name, .png or .exr, such as \"slices/*.png\"";
    light_ball: Table("light_ball"), NONE, Otherwise("file or slices"), "a ball of three shells (2006)";
    center: VECTOR, WORLD, Otherwise("the file's, or the origin"), "the middle of its box";
    size: VECTOR, WORLD, Otherwise("the file's, or a longest edge of 2"), "the edges of its box";
    rotation: VECTOR, DEGREES, Value("[0, 0, 0]"), "turns of the box about x, then y, then z, through its middle";
    coefficient: NOT_NEGATIVE, NONE, Value("1"), "what its light is multiplied with";
    color: Color, NONE, Value("[1, 1, 1]"), "what its light is multiplied with, too";
    interpolation: Word(&["linear", "cubic"]), NONE, Value("\"cubic\""), "how cells are interpolated";
    method: Word(&["volume", "billboard"]), NONE, Value("\"volume\""),
        "what is drawn: its cells, or one picture of them that always faces the view";
}

// What is read of `light_ball`.
keys! { pub(in crate::scene) LIGHT_BALL_KEYS;
    radii: VECTOR, "cells", Value("[3, 6, 7]"), "where each shell ends";
    colors: Colors(3), NONE, Value("[[1, 1, 1], [0.3, 0.5, 1], [0.1, 0.2, 0.5]]"), "of each shell";
    alphas: VECTOR, NONE, Value("[0.9, 0.5, 0.1]"), "of each shell: light a world unit of length";
    cells: Whole(1, 512), NONE, Value("16"), "along each edge of the cube around it";
}

impl Default for VolumeTable {
    fn default() -> Self {
        Self {
            file: None,
            slices: None,
            light_ball: None,
            center: None,
            size: None,
            rotation: DVec3::ZERO,
            coefficient: 1.0,
            color: DVec3::ONE,
            interpolation: VolumeInterpolation::default(),
            method: VolumeShape::default(),
            texture: Arc::default(),
        }
    }
}

impl Default for BallTable {
    fn default() -> Self {
        Self::of(&LightBall::default())
    }
}

impl BallTable {
    fn of(ball: &LightBall) -> Self {
        Self {
            radii: ball.radii.into(),
            colors: Some(ball.colors.to_vec()),
            alphas: ball.alphas.into(),
            cells: ball.cells,
        }
    }

    fn texture(&self) -> Result<Texture> {
        let fault =
            |key: &str, message: String| SceneError::value(format!("light_ball.{key}"), message);
        let colors = self.colors.clone().unwrap_or_default();
        let count = colors.len();
        let Ok(colors) = colors.try_into() else {
            let message = format!("{count} colours; each of three shells has one");
            return Err(fault("colors", message).into());
        };
        let ball = LightBall {
            radii: self.radii.to_array(),
            colors,
            alphas: self.alphas.to_array(),
            cells: self.cells,
        };
        ball.texture()
            .map_err(|(key, message)| fault(key, message).into())
    }
}

impl VolumeTable {
    /// Returns the files of its cells, which are from `folder`.
    pub(super) fn files(&self, folder: &Path) -> Vec<PathBuf> {
        let file = self.file.as_ref().map(|file| folder.join(file));
        let raw = file
            .iter()
            .filter(|it| it.extension().is_some_and(|it| it == "raw"));
        let beside: Vec<PathBuf> = raw.map(|it| it.with_extension("json")).collect();
        let slices = self
            .slices(folder)
            .map_or(Vec::new(), |it| Texture::slice_files(&it));
        file.into_iter().chain(beside).chain(slices).collect()
    }

    /// Returns the path with `*` of its slices, which is from `folder`.
    pub(super) fn slices(&self, folder: &Path) -> Option<PathBuf> {
        self.slices.as_ref().map(|slices| folder.join(slices))
    }

    /// Makes a volume as it is written; `None` if its cells are in no file.
    pub(super) fn of(volume: &Volume) -> Option<Self> {
        let (mut file, mut slices, mut light_ball) = (None, None, None);
        match volume.texture.origin() {
            TextureOrigin::Values => return None,
            TextureOrigin::File(path) => file = Some(path.clone()),
            TextureOrigin::Slices(path) => slices = Some(path.clone()),
            TextureOrigin::LightBall(ball) => light_ball = Some(BallTable::of(ball)),
        }
        Some(Self {
            file,
            slices,
            light_ball,
            center: Some(volume.center),
            size: Some(volume.size),
            rotation: volume.rotation,
            coefficient: volume.coefficient,
            color: volume.color,
            interpolation: volume.interpolation,
            method: volume.shape,
            texture: Arc::default(),
        })
    }

    /// Takes the cells that another table has read, if it names the same.
    pub(super) fn share(&mut self, other: &Self) {
        let is_same = self.file == other.file
            && self.slices == other.slices
            && self.light_ball == other.light_ball;
        if is_same {
            self.texture = Arc::clone(&other.texture);
        }
    }

    /// Makes the volume; its files are from `folder`.
    pub(super) fn open(&self, index: usize, folder: &Path) -> Result<Volume> {
        let table = format!("volume[{index}]");
        let texture = match self.texture.get() {
            Some(texture) => texture.clone(),
            None => {
                let texture = self.read(folder).map_err(|error| match error {
                    Error::Scene(fault) => Error::Scene(SceneError {
                        key: format!("{table}.{}", fault.key),
                        ..fault
                    }),
                    other => other,
                })?;
                self.texture.get_or_init(|| texture).clone()
            }
        };
        let made = Volume::new(texture);
        let volume = Volume {
            center: self.center.unwrap_or(made.center),
            size: self.size.unwrap_or(made.size),
            rotation: self.rotation,
            coefficient: self.coefficient,
            color: self.color,
            interpolation: self.interpolation,
            shape: self.method,
            ..made
        };
        volume.check().map_err(|fault| fault.of(&table))?;
        Ok(volume)
    }

    fn read(&self, folder: &Path) -> Result<Texture> {
        match (&self.file, &self.slices, &self.light_ball) {
            (Some(file), None, None) => Texture::open(folder.join(file)),
            (None, Some(slices), None) => Texture::open_slices(folder.join(slices)),
            (None, None, Some(ball)) => ball.texture(),
            _ => {
                let message =
                    "`file`, `slices` or `light_ball`, one of them, says what its cells are";
                Err(SceneError::value("file", message).into())
            }
        }
    }
}
