//! Volumes as other programs read them. All numbers are little-endian.

mod nrrd;
mod raw;
mod slices;
mod vdb;
mod vti;

use std::io;
use std::path::Path;

use glam::DVec3;

use super::{CellValue, Storage, Volume};
use crate::error::{Error, Result};
use crate::image::{Display, ImageFile, ImageFormat};
use crate::output::{Output, Sink, TextFile};
use crate::shown;

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumeFormat {
    /// `.vdb`, OpenVDB: a sparse grid `density`, the largest channel of the emission, and a sparse grid `color`, the
    /// emission divided by that, of tiles where all light has one. Float32 or, where `half` says so, half floats.
    Vdb {
        /// Whether values are halves.
        half: bool,
    },
    /// `.nrrd`, float32 RGB, or one number for light of one colour, dense; where a rest stands beside reciprocals, in
    /// each cell that follows.
    Nrrd,
    /// `.vti`, VTK image data: the cell data `emission`, float32 RGB, or `density`, one number for light of one colour,
    /// dense.
    Vti,
    /// `.exr`, the layers side by side in an image, for engines without volumes; a JSON beside it says how.
    Slices {
        /// Whether values are halves.
        half: bool,
    },
    /// `.raw`, float32 RGB, or one number for light of one colour, x fastest, then y, then z, dense; a JSON beside it
    /// says so.
    Raw,
}

impl VolumeFormat {
    /// Returns the format that the ending of a name says.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for other endings, and where halves are asked of a format that has none.
    pub fn of(path: &Path, half: bool) -> Result<Self> {
        let ending = path.extension().and_then(|ending| ending.to_str());
        let ending = ending.map(str::to_ascii_lowercase);
        let format = match ending.as_deref() {
            Some("vdb") => return Ok(Self::Vdb { half }),
            Some("exr") => return Ok(Self::Slices { half }),
            Some("nrrd") => Self::Nrrd,
            Some("vti") => Self::Vti,
            Some("raw") => Self::Raw,
            _ => {
                let name = shown(&path.display().to_string());
                return Err(Error::Unsupported(format!(
                    "{name}: a volume is a .vdb, .nrrd, .vti, .exr (of layers side by side) or .raw"
                )));
            }
        };
        match half {
            true => Err(Error::Unsupported(
                "half floats are of .vdb and .exr files: write one, or leave them out".to_owned(),
            )),
            false => Ok(format),
        }
    }
}

/// A file of a volume that is known to be writable before the work.
#[derive(Debug)]
pub struct VolumeFile {
    format: VolumeFormat,
    stored: Stored,
    target: Target,
    /// What stands beside it.
    beside: Option<TextFile>,
}

/// What is stored of a cell.
#[derive(Debug, Clone, Copy, Default)]
struct Stored {
    storage: Storage,
    /// That of all light, of which each cell then has its largest channel alone.
    color: Option<DVec3>,
    /// Whether the rest follows in each cell.
    has_rest: bool,
}

#[derive(Debug)]
enum Target {
    Bytes(Output),
    Image(ImageFile),
}

impl VolumeFile {
    /// Makes sure that `path`, and the JSON that may stand beside it, can be written, and changes nothing yet.
    ///
    /// # Errors
    /// [`Error::Output`] if it is a folder, its folder is missing, or it cannot be written; [`Error::Unsupported`] as
    /// [`VolumeFormat::of`].
    pub fn create(path: &Path, half: bool) -> Result<Self> {
        let format = VolumeFormat::of(path, half)?;
        let beside = || TextFile::create(path.with_extension("json")).map(Some);
        Ok(match format {
            VolumeFormat::Slices { .. } => Self {
                format,
                stored: Stored::default(),
                target: Target::Image(ImageFile::create_as(path, ImageFormat::Exr)?),
                beside: beside()?,
            },
            _ => Self {
                format,
                stored: Stored::default(),
                target: Target::Bytes(Output::create(path)?),
                beside: match format {
                    VolumeFormat::Raw => beside()?,
                    _ => None,
                },
            },
        })
    }

    /// Has cells stored in another way.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for reciprocals in formats that are for other programs.
    pub fn storing(self, storage: Storage) -> Result<Self> {
        let is_dense = matches!(
            self.format,
            VolumeFormat::Nrrd | VolumeFormat::Vti | VolumeFormat::Raw
        );
        match storage {
            Storage::Reciprocal { .. } if !is_dense => Err(Error::Unsupported(
                "reciprocals are of .nrrd, .vti and .raw files: other programs take the emission"
                    .to_owned(),
            )),
            storage => {
                let stored = Stored {
                    storage,
                    ..self.stored
                };
                Ok(Self { stored, ..self })
            }
        }
    }

    /// Says that all light has one colour, linear RGB, whose largest channel is 1 ([`Scene::one_color`]): cells get one
    /// number, their density, and the file says the colour once. Images of layers have all channels.
    ///
    /// [`Scene::one_color`]: crate::Scene::one_color
    #[must_use]
    pub fn in_one_color(self, color: Option<DVec3>) -> Self {
        let stored = Stored {
            color,
            ..self.stored
        };
        Self { stored, ..self }
    }

    /// Writes all, and puts the file in its place. `notes`, names and values, go into what the format has for them.
    ///
    /// # Errors
    /// [`Error::Output`] if it cannot be written; nothing is left behind then. [`Error::Unsupported`] for an image of
    /// layers with more than 32768 pixels along an edge; [`Error::OutOfMemory`] for one that does not fit.
    pub fn write(self, volume: &Volume, notes: &[(String, String)]) -> Result<()> {
        let stored = self.stored_as(volume);
        let notes: Vec<_> = facts(volume, stored)
            .into_iter()
            .chain(notes.to_vec())
            .collect();
        match (self.target, self.format) {
            (Target::Image(file), format) => {
                let display = Display {
                    bits: Some(if format == (VolumeFormat::Slices { half: true }) {
                        16
                    } else {
                        32
                    }),
                    ..Display::default()
                };
                file.write(&slices::image(volume)?, &display)?;
            }
            (Target::Bytes(output), format) => output.write_with(|sink| match format {
                VolumeFormat::Vdb { half } => {
                    vdb::write(sink, volume, (half, stored.color), &notes)
                }
                VolumeFormat::Nrrd => nrrd::write(sink, volume, stored, &notes),
                VolumeFormat::Vti => vti::write(sink, volume, stored, &notes),
                VolumeFormat::Raw | VolumeFormat::Slices { .. } => {
                    write_dense(sink, volume, stored)
                }
            })?,
        }
        let tiles = match self.format {
            VolumeFormat::Slices { .. } => Some(slices::layout(volume.grid())),
            _ => None,
        };
        match self.beside {
            Some(file) => file.write(&raw::json(volume, (tiles, stored.channels()), &notes)),
            None => Ok(()),
        }
    }
}

impl VolumeFile {
    /// Returns what its format stores.
    fn stored_as(&self, volume: &Volume) -> Stored {
        let color = match self.format {
            VolumeFormat::Slices { .. } => None,
            _ => self.stored.color,
        };
        Stored {
            color,
            has_rest: volume.rest_beside(self.stored.storage).is_some(),
            ..self.stored
        }
    }
}

impl Stored {
    /// Returns how many numbers a cell has.
    fn channels(self) -> usize {
        self.color.map_or(3, |_| 1) * if self.has_rest { 2 } else { 1 }
    }
}

/// Returns what every file says of itself.
fn facts(volume: &Volume, stored: Stored) -> Vec<(String, String)> {
    let values = match volume.value() {
        CellValue::Center | CellValue::Apart => "emission at the middle of each cell".to_owned(),
        CellValue::Mean(parts) => {
            format!("mean emission of each cell, of {parts}x{parts}x{parts} places")
        }
    };
    let note = |name: &str, value: String| (name.to_owned(), value);
    let mut facts = vec![
        note(
            "software",
            concat!("energywave ", env!("CARGO_PKG_VERSION")).to_owned(),
        ),
        note("values", values),
        note("unit", "linear RGB light a world unit of length".to_owned()),
    ];
    if stored.has_rest {
        let value = "emission of all sources but the strongest, behind what is stored of that";
        facts.push(note("rest", value.to_owned()));
    }
    if let Some(color) = stored.color {
        facts.push(note("color", numbers(color, " ")));
    }
    if let Storage::Reciprocal { power } = stored.storage {
        facts.push(note("storage", "reciprocal".to_owned()));
        facts.push(note("power", power.to_string()));
    }
    facts
}

/// Writes all cells, RGB after RGB or their densities, each with its rest if there is one, x fastest.
fn write_dense(sink: &mut dyn Sink, volume: &Volume, stored: Stored) -> io::Result<()> {
    let [columns, rows, layers] = volume.grid().cells();
    let mut row = vec![0.0; 3 * columns as usize];
    let mut of_rest = row.clone();
    let mut bytes = Vec::with_capacity(8 * row.len());
    let written = match stored.color {
        Some(color) => color.max_position()..color.max_position() + 1,
        None => 0..3,
    };
    let rest = volume.rest_beside(stored.storage);
    for z in 0..layers {
        for y in 0..rows {
            volume.read_stored_row(y, z, stored.storage, &mut row);
            if let Some(rest) = rest {
                rest.read_row(y, z, &mut of_rest);
            }
            bytes.clear();
            for (cell, rest_of_cell) in row.chunks_exact(3).zip(of_rest.chunks_exact(3)) {
                let rest_of_cell = rest.map_or(&[][..], |_| &rest_of_cell[written.clone()]);
                let values = cell[written.clone()].iter().chain(rest_of_cell);
                bytes.extend(values.flat_map(|value| value.to_le_bytes()));
            }
            sink.write_all(&bytes)?;
        }
    }
    Ok(())
}

/// Writes a point as three numbers.
fn numbers(point: DVec3, between: &str) -> String {
    point.to_array().map(|it| it.to_string()).join(between)
}
