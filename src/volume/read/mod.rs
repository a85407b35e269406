//! Reads volumes from files, with distrust: sizes are held against the file's length and the memory that there is
//! before anything is made. A fault is said from behind the file's name on.

mod bytes;
mod nrrd;
#[cfg(feature = "json")]
mod raw;
mod slices;
mod vdb;
mod vti;

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::texture::{Storage, Texture, TextureOrigin, check_cells, check_room, count};
use crate::error::{Error, Result, SceneError};
use crate::shown::shown;

/// What files of volumes there are.
const ENDINGS: &str = ".vdb, .nrrd, .vti or .raw";

/// What is wrong with a file, or what there is too little of.
pub(super) enum Fault {
    Wrong(String),
    Other(Error),
}

impl From<String> for Fault {
    fn from(message: String) -> Self {
        Self::Wrong(message)
    }
}

impl From<&str> for Fault {
    fn from(message: &str) -> Self {
        Self::Wrong(message.to_owned())
    }
}

pub(super) type Read<T> = std::result::Result<T, Fault>;

/// Cells as files have them.
pub(super) struct Dense {
    pub cells: [u32; 3],
    /// Of a cell, side by side: one, RGB, or RGB and alpha; of reciprocals also 2 or 6, with as many of a rest.
    pub channels: usize,
    pub values: Vec<f32>,
    /// The lowest corner of the box and the edges of a cell, world space.
    pub place: Option<[DVec3; 2]>,
    pub storage: Storage,
    /// What all of them are multiplied with.
    pub color: DVec3,
}

impl Dense {
    fn texture(self) -> Read<Texture> {
        let has_rest = matches!(self.channels, 2 | 6);
        if has_rest && self.storage == Storage::Emission {
            let message = format!(
                ": {} channels; light has 1, 3 or 4, reciprocals also 2 or 6",
                self.channels
            );
            return Err(message.into());
        }
        let own = if has_rest {
            self.channels / 2
        } else {
            self.channels.min(3)
        };
        check_room(self.cells, self.channels as u64).map_err(Fault::Other)?;
        let channel = |channel: usize| {
            let cells = self.values.chunks_exact(self.channels);
            cells.map(move |cell| match cell {
                [red, green, blue, alpha] => alpha * [red, green, blue][channel],
                cell => cell[channel],
            })
        };
        let values: Vec<f32> = (0..own).flat_map(channel).collect();
        let wrong = |wrong: String| format!(": {wrong}");
        let mut texture = Texture::checked(self.cells, values, self.storage).map_err(wrong)?;
        if has_rest {
            let rest = (own..self.channels).flat_map(channel).collect();
            texture = texture
                .checked_with_rest(rest)
                .map_err(|it| format!(": the rest: {it}"))?;
        }
        let texture = texture.in_color(self.color);
        Ok(match self.place {
            None => texture,
            Some([low, cell]) => {
                let size = cell * DVec3::from(self.cells.map(f64::from));
                texture.placed(low + 0.5 * size, size)
            }
        })
    }
}

impl Texture {
    /// Reads the file of a volume: .vdb, .nrrd, .vti, or .raw with a .json beside it.
    ///
    /// # Errors
    /// [`Error::Scene`] with the key `file` if the file cannot be read or holds no volume; [`Error::OutOfMemory`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let name = shown(&path.display().to_string()).to_string();
        let texture = open(path).map_err(|fault| match fault {
            Fault::Wrong(message) => {
                Error::Scene(SceneError::value("file", format!("{name}{message}")))
            }
            Fault::Other(error) => error,
        })?;
        let full = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        Ok(texture.with_origin(TextureOrigin::File(full)))
    }

    /// Reads pictures of slices, whose names fit a path with `*` in its name, sorted by name: PNG, sRGB, whose alpha
    /// is the density, or OpenEXR, linear, whose colours hold it already. The first is that of the lowest z, x grows to
    /// the right, and y upwards.
    ///
    /// # Errors
    /// [`Error::Scene`] with the key `slices` if there are none, one cannot be read, or they differ in size;
    /// [`Error::OutOfMemory`].
    pub fn open_slices(pattern: impl AsRef<Path>) -> Result<Self> {
        slices::open(pattern.as_ref())
    }

    /// Returns the pictures of slices that there are.
    pub(crate) fn slice_files(pattern: &Path) -> Vec<PathBuf> {
        slices::named(pattern).unwrap_or_default()
    }
}

fn open(path: &Path) -> Read<Texture> {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let ending = ending.to_lowercase();
    if !["vdb", "nrrd", "vti", "raw"].contains(&ending.as_str()) {
        return Err(format!(": volumes are in files that end in {ENDINGS}").into());
    }
    let bytes = fs::read(path).map_err(|error| format!(": cannot read: {error}"))?;
    match ending.as_str() {
        "vdb" => vdb::read(&bytes)?.texture(),
        "nrrd" => nrrd::read(&bytes)?.texture(),
        "vti" => vti::read(&bytes)?.texture(),
        #[cfg(feature = "json")]
        _ => raw::read(path, &bytes)?.texture(),
        #[cfg(not(feature = "json"))]
        _ => Err(": the .json beside it is not read without the feature \"json\"".into()),
    }
}

/// Takes the storage out of what a file says of itself.
pub(super) fn storage_of(storage: Option<&str>, power: Option<&str>) -> Read<Storage> {
    match (storage, power) {
        (None | Some("emission"), _) => Ok(Storage::Emission),
        (Some("reciprocal"), Some("1")) => Ok(Storage::Reciprocal { power: 1 }),
        (Some("reciprocal"), Some("2")) => Ok(Storage::Reciprocal { power: 2 }),
        (Some(other), power) => Err(format!(
            ": it stores \"{}\" of power {}; known are \"emission\", and \"reciprocal\" of power 1 or 2",
            shown(other),
            shown(power.unwrap_or("none"))
        )
        .into()),
    }
}

/// Takes the colour of all cells out of what a file says of itself: white where it says none.
pub(super) fn color_of(color: Option<&str>) -> Read<DVec3> {
    let Some(text) = color else {
        return Ok(DVec3::ONE);
    };
    let numbers = text.split_whitespace().map(|it| it.parse().ok());
    let numbers: Option<Vec<f64>> = numbers.collect();
    match numbers.as_deref() {
        Some(&[red, green, blue])
            if [red, green, blue].iter().all(|it| (0.0..=1e6).contains(it)) =>
        {
            Ok(DVec3::new(red, green, blue))
        }
        _ => Err(format!(
            ": its colour is \"{}\"; a colour is three numbers, 0 or more",
            shown(text)
        )
        .into()),
    }
}

/// Checks that cells of a file are as many as a volume may have and as its bytes hold; returns their values' bytes.
pub(super) fn check_size(cells: [u32; 3], bytes_a_cell: usize, bytes: &[u8]) -> Read<&[u8]> {
    check_cells(cells).map_err(|wrong| format!(": {wrong}"))?;
    let needed = count(cells) * bytes_a_cell;
    match bytes.get(..needed) {
        Some(bytes) => Ok(bytes),
        None => Err(format!(
            ": cut short: {needed} bytes of cells are needed, {} are there",
            bytes.len()
        )
        .into()),
    }
}
