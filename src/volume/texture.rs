//! A volume as it is drawn: the values of all cells, dense, and what they are of the emission (the 3D texture of
//! Sakai 2006, whose array holds R, G, B and alpha: here alpha RGB, light a unit of length).

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use glam::DVec3;

use super::{LightBall, Volume};
use crate::error::{Error, Result};
use crate::memory;

/// Most cells along an edge.
pub const MOST_TEXELS: u32 = 4096;

/// What stands for no light in reciprocals.
pub const DARK: f32 = 1e30;

/// The greatest emission of a cell: sums of it along a ray stay finite in float32.
const BRIGHTEST: f32 = 1e30;

/// The distance to a core that is between cells may be below that of any cell; its square, by so much at most.
const BELOW_LEAST: f32 = 1.0 / 16.0;

/// What cells store of an emission psi.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Storage {
    /// psi itself.
    #[default]
    Emission,
    /// `min(1/psi^power, 1e30)`. The power is 2 for fields that fall off as 1/d, 1 for those with 1/d^2: near a core
    /// this is then the square of a distance, which cubic interpolation has exactly.
    Reciprocal {
        /// 1 or 2.
        power: u32,
    },
}

impl Storage {
    /// Returns what a cell with such an emission stores.
    #[must_use]
    pub fn stored(self, emission: f32) -> f32 {
        match self {
            Self::Emission => emission,
            Self::Reciprocal { power } => {
                let inverse = 1.0 / f64::from(emission.max(0.0));
                inverse.powi(power as i32).min(f64::from(DARK)) as f32
            }
        }
    }

    /// Returns the power, 0 for the emission itself.
    pub(crate) fn power(self) -> u32 {
        match self {
            Self::Emission => 0,
            Self::Reciprocal { power } => power,
        }
    }
}

/// Where the values of a texture come from, so that a scene can name it again.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub enum TextureOrigin {
    /// They were given.
    #[default]
    Values,
    /// The file of a volume.
    File(PathBuf),
    /// Pictures of slices: a path with `*` in its name.
    Slices(PathBuf),
    /// A light ball.
    LightBall(LightBall),
}

/// The values of all cells of a volume. Copies share them.
#[derive(Debug, Clone)]
pub struct Texture {
    cells: [u32; 3],
    channels: u32,
    storage: Storage,
    /// All of red, then green, then blue, or one for all; x fastest, then y, then z.
    values: Arc<Vec<f32>>,
    least: f32,
    color: DVec3,
    place: Option<[DVec3; 2]>,
    origin: TextureOrigin,
    /// What is added to the light of all cells.
    rest: Option<Box<Texture>>,
    /// What billboards show, once it was asked for.
    picture: Arc<OnceLock<Box<Texture>>>,
}

impl PartialEq for Texture {
    fn eq(&self, other: &Self) -> bool {
        let is_same = Arc::ptr_eq(&self.values, &other.values) || self.values == other.values;
        is_same
            && (self.cells, self.channels, self.storage, self.place)
                == (other.cells, other.channels, other.storage, other.place)
            && (self.color, &self.origin, &self.rest) == (other.color, &other.origin, &other.rest)
    }
}

impl Texture {
    /// Makes one of values: those of red for all cells, then green, then blue, or one for all three; x fastest, then y,
    /// then z.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for an edge without cells or with more than 4096, for values that are not as many as the
    /// cells (three times as many), and for those that are not finite, below 0, or as reciprocals 0.
    pub fn new(cells: [u32; 3], values: Vec<f32>, storage: Storage) -> Result<Self> {
        Self::checked(cells, values, storage).map_err(Error::Unsupported)
    }

    /// Does the same; a fault is what is wrong.
    pub(crate) fn checked(
        cells: [u32; 3],
        values: Vec<f32>,
        storage: Storage,
    ) -> std::result::Result<Self, String> {
        check_cells(cells)?;
        let count = count(cells);
        let channels = match values.len() {
            len if len == count => 1,
            len if len == 3 * count => 3,
            len => {
                return Err(format!(
                    "{len} values for {count} cells: one or three for each"
                ));
            }
        };
        let power = storage.power();
        let is_good = |value: &f32| match power {
            0 => (0.0..=BRIGHTEST).contains(value),
            _ => *value > 0.0 && *value <= DARK,
        };
        if let Some(index) = values.iter().position(|value| !is_good(value)) {
            let place = index % count;
            let [columns, rows, _] = cells.map(|it| it as usize);
            let cell = (
                place % columns,
                place / columns % rows,
                place / columns / rows,
            );
            let needs = match power {
                0 => "light is a finite number, 0 or more",
                _ => "reciprocals are finite numbers above 0",
            };
            return Err(format!("cell {cell:?} holds {}: {needs}", values[index]));
        }
        let least = values.iter().copied().fold(DARK, f32::min);
        let channels = match channels {
            3 if is_grey(&values) => 1,
            channels => channels,
        };
        let mut values = values;
        values.truncate(channels as usize * count);
        Ok(Self {
            cells,
            channels,
            storage,
            values: Arc::new(values),
            least,
            color: DVec3::ONE,
            place: None,
            origin: TextureOrigin::Values,
            rest: None,
            picture: Arc::default(),
        })
    }

    pub(super) fn kept_picture(&self) -> &OnceLock<Box<Self>> {
        &self.picture
    }

    /// Returns the same with other cells.
    pub(super) fn with_values(&self, cells: [u32; 3], values: Vec<f32>, storage: Storage) -> Self {
        Self {
            cells,
            storage,
            values: Arc::new(values),
            least: 0.0,
            rest: None,
            picture: Arc::default(),
            ..self.clone()
        }
    }

    /// Makes one of the cells of a volume, where they are; with the colour of all light ([`Scene::one_color`]) they
    /// have one channel. Reciprocals of one whose rest is apart are those of the strongest source; the rest is added.
    ///
    /// [`Scene::one_color`]: crate::Scene::one_color
    ///
    /// # Errors
    /// As [`Texture::new`]; [`Error::OutOfMemory`].
    pub fn of(volume: &Volume, storage: Storage, color: Option<DVec3>) -> Result<Self> {
        let grid = volume.grid();
        let (cells, [low, high]) = (grid.cells(), grid.bounds());
        let channels = match color {
            Some(color) => color.max_position()..color.max_position() + 1,
            None => 0..3,
        };
        let [columns, rows, layers] = cells;
        check_room(cells, channels.len() as u64)?;
        let mut values = Vec::with_capacity(channels.len() * count(cells));
        let mut row = vec![0.0; 3 * columns as usize];
        for channel in channels {
            for (z, y) in (0..layers).flat_map(|z| (0..rows).map(move |y| (z, y))) {
                volume.read_stored_row(y, z, storage, &mut row);
                values.extend(row.iter().skip(channel).step_by(3));
            }
        }
        let texture = Self::new(cells, values, storage)?
            .placed(0.5 * (low + high), high - low)
            .in_color(color.unwrap_or(DVec3::ONE));
        match volume.rest_beside(storage) {
            Some(rest) => {
                let rest = Self::of(rest, Storage::Emission, color)?;
                texture.with_rest(rest.values.to_vec())
            }
            None => Ok(texture),
        }
    }

    /// Has light added to that of all cells: of all red ones, then green, then blue, or one for all three.
    ///
    /// # Errors
    /// As [`Texture::new`].
    pub fn with_rest(self, light: Vec<f32>) -> Result<Self> {
        self.checked_with_rest(light).map_err(Error::Unsupported)
    }

    /// Does the same; a fault is what is wrong.
    pub(crate) fn checked_with_rest(self, light: Vec<f32>) -> std::result::Result<Self, String> {
        let rest = Self::checked(self.cells, light, Storage::Emission)?;
        Ok(Self {
            rest: Some(rest.into()),
            ..self
        })
    }

    /// Makes that of a light ball.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for radii that do not grow, light below 0, and no or more than 512 cells.
    pub fn light_ball(ball: &LightBall) -> Result<Self> {
        let wrong =
            |(key, message): (&str, String)| Error::Unsupported(format!("{key}: {message}"));
        ball.texture().map_err(wrong)
    }

    /// Returns how many cells there are along x, y and z.
    #[must_use]
    pub fn cells(&self) -> [u32; 3] {
        self.cells
    }

    /// Returns how many channels there are: one for red, green and blue, or one for each.
    #[must_use]
    pub fn channels(&self) -> u32 {
        self.channels
    }

    /// Returns what the values are of the emission.
    #[must_use]
    pub fn storage(&self) -> Storage {
        self.storage
    }

    /// Returns the values of all cells, of each channel in turn.
    #[must_use]
    pub fn values(&self) -> &Arc<Vec<f32>> {
        &self.values
    }

    /// Returns what is added to the light of all cells, before it is multiplied with the colour.
    #[must_use]
    pub fn rest(&self) -> Option<&Self> {
        self.rest.as_deref()
    }

    /// Returns what the light of all cells is multiplied with, linear RGB.
    #[must_use]
    pub fn color(&self) -> DVec3 {
        self.color
    }

    /// Returns where the values come from.
    #[must_use]
    pub fn origin(&self) -> &TextureOrigin {
        &self.origin
    }

    /// Returns the middle and the edges of the box that they say they fill, world space, if they do.
    #[must_use]
    pub fn place(&self) -> Option<[DVec3; 2]> {
        self.place
    }

    /// Returns what no interpolated reciprocal is taken below; 0 for the emission itself.
    #[must_use]
    pub fn floor(&self) -> f32 {
        match self.storage {
            Storage::Emission => 0.0,
            Storage::Reciprocal { .. } => (BELOW_LEAST * self.least).max(f32::MIN_POSITIVE),
        }
    }

    /// Says where they are, if nobody else does.
    #[must_use]
    pub fn placed(mut self, center: DVec3, size: DVec3) -> Self {
        self.place = Some([center, size]);
        self
    }

    /// Says what the light of all cells is multiplied with, linear RGB, 0 or more.
    #[must_use]
    pub fn in_color(mut self, color: DVec3) -> Self {
        self.color = color;
        self
    }

    /// Says where they come from.
    pub(crate) fn with_origin(mut self, origin: TextureOrigin) -> Self {
        self.origin = origin;
        self
    }

    /// Returns the file that it was read from.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        match &self.origin {
            TextureOrigin::File(path) => Some(path),
            _ => None,
        }
    }
}

/// Refuses numbers of cells that no texture has.
pub(crate) fn check_cells(cells: [u32; 3]) -> std::result::Result<(), String> {
    let [x, y, z] = cells;
    // Kernels count the cells of all channels in 32 bits.
    let all: u64 = cells.map(u64::from).iter().product();
    if all > u64::from(u32::MAX) / 3 {
        return Err(format!("{x}x{y}x{z} cells are more than devices count"));
    }
    match cells.iter().all(|it| (1..=MOST_TEXELS).contains(it)) {
        true => Ok(()),
        false => Err(format!(
            "{x}x{y}x{z} cells: a volume has 1 to {MOST_TEXELS} along each edge"
        )),
    }
}

/// Refuses a texture for which there is no memory, before it is read; `channels` of it are kept at a time.
pub(crate) fn check_room(cells: [u32; 3], channels: u64) -> Result<()> {
    let bytes = 4 * channels * cells.map(u64::from).iter().product::<u64>();
    let [x, y, z] = cells;
    match memory::shortage(bytes) {
        Some(shortage) => Err(Error::OutOfMemory(format!(
            "a volume of {x}x{y}x{z} cells: {shortage}"
        ))),
        None => Ok(()),
    }
}

pub(crate) fn count(cells: [u32; 3]) -> usize {
    cells.iter().map(|it| *it as usize).product()
}

fn is_grey(values: &[f32]) -> bool {
    let (red, others) = values.split_at(values.len() / 3);
    let (green, blue) = others.split_at(red.len());
    red == green && red == blue
}
