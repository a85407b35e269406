//! `[[points]]` of a scene file: light, and where its points are.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use serde::{Deserialize, Deserializer, Serialize};

use crate::error::{Error, SceneError};
use crate::scene::colors::{read_color, read_some_colors};
use crate::scene::values::{Fault, read_vectors};
use crate::scene::{PointList, Points, Profile, Scene};

/// Points of light as a file describes them.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct PointsTable {
    #[serde(
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "read_vectors"
    )]
    positions: Vec<DVec3>,
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_some_colors"
    )]
    colors: Option<Vec<DVec3>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    coefficients: Option<Vec<f64>>,
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_previous"
    )]
    previous: Option<Vec<DVec3>>,
    /// From the folder of the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<PathBuf>,
    coefficient: f64,
    #[serde(deserialize_with = "read_color")]
    color: DVec3,
    profile: Profile,
    radius: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    reach: Option<f64>,
    /// Its points, once they were read; the tables of all times share them as long as they name the same.
    #[serde(skip)]
    list: Arc<OnceLock<PointList>>,
}

// What is read of `[[points]]`.
keys! { pub(in crate::scene) POINTS_KEYS;
    positions: Vectors(0, None), WORLD, Otherwise("file"), "where the points are";
    colors: Colors(1), NONE, Otherwise("color"), "of each point";
    coefficients: Numbers(1, None), NONE, Otherwise("1"), "what the light of each point is multiplied with";
    previous: Vectors(1, None), WORLD, Otherwise("no trails"), "where each point was; its light lies along the way";
    file: File, NONE, Otherwise("positions"), "points: .csv, .npy or .ply, also with colours, coefficients and radii";
    coefficient: ANY, NONE, Value("1"), "what the light of all points is multiplied with";
    color: Color, NONE, Value("[1, 1, 1]"), "of points that have none of their own";
    profile: PROFILE, NONE, Value("\"inverse-square\""),
        "how their light falls off: \"inverse\", \"inverse-square\" or \"smeared\"";
    radius: NOT_NEGATIVE, WORLD, Value("0"), "how thick points are that have no radius of their own";
    reach: POSITIVE, WORLD, Otherwise("no end"), "where the light of a point ends, smoothly";
}

impl Default for PointsTable {
    fn default() -> Self {
        Self {
            positions: Vec::new(),
            colors: None,
            coefficients: None,
            previous: None,
            file: None,
            coefficient: 1.0,
            color: DVec3::ONE,
            profile: Profile::default(),
            radius: 0.0,
            reach: None,
            list: Arc::default(),
        }
    }
}

impl super::SceneFile {
    /// Makes particles, points and volumes; their files are from `folder`.
    pub(super) fn open_lights(&self, folder: &Path, scene: &mut Scene) -> crate::error::Result<()> {
        for (index, table) in self.particles.iter().enumerate() {
            scene.particles.push(table.open(index, folder)?);
        }
        for (index, table) in self.points.iter().enumerate() {
            scene.points.push(table.open(index, folder)?);
        }
        for (index, table) in self.volume.iter().enumerate() {
            scene.volumes.push(table.open(index, folder)?);
        }
        Ok(())
    }
}

impl PointsTable {
    /// Returns the file of its points, if it names one, from the folder of the scene.
    pub(super) fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Makes points as they are written; `None` if they have sizes and are in no file.
    pub(super) fn of(points: &Points) -> Option<Self> {
        let list = &points.points;
        let file = list.file().map(Path::to_owned);
        if list.sizes().is_some() && file.is_none() {
            return None;
        }
        let light = |it: &[f32; 3]| DVec3::from(it.map(f64::from));
        let colors = list.lights().map(|it| it.iter().map(light).collect());
        let is_given = file.is_none();
        Some(Self {
            positions: match is_given {
                true => list.positions().to_vec(),
                false => Vec::new(),
            },
            colors: colors.filter(|_| is_given),
            coefficients: None,
            previous: list.previous().map(<[_]>::to_vec),
            file,
            coefficient: points.coefficient,
            color: points.color,
            profile: points.profile,
            radius: points.radius,
            reach: points.reach,
            list: Arc::default(),
        })
    }

    /// Takes the points that another table has read, if it names the same.
    pub(super) fn share(&mut self, other: &Self) {
        let own = (&self.positions, &self.colors, &self.coefficients);
        let is_same = own == (&other.positions, &other.colors, &other.coefficients)
            && self.previous == other.previous;
        if is_same && self.file == other.file && self.color == other.color {
            self.list = Arc::clone(&other.list);
        }
    }

    /// Makes the points; their file is from `folder`.
    pub(super) fn open(&self, index: usize, folder: &Path) -> Result<Points, SceneError> {
        let table = format!("points[{index}]");
        let list = match self.list.get() {
            Some(list) => list.clone(),
            None => {
                let list = self.read(folder).map_err(|fault| SceneError {
                    key: format!("{table}.{}", fault.key),
                    ..fault
                })?;
                self.list.get_or_init(|| list).clone()
            }
        };
        let points = Points {
            points: list,
            coefficient: self.coefficient,
            color: self.color,
            profile: self.profile,
            radius: self.radius,
            reach: self.reach,
        };
        points.check().map_err(|fault| fault.of(&table))?;
        Ok(points)
    }

    fn read(&self, folder: &Path) -> Result<PointList, SceneError> {
        let count = self.positions.len();
        let lists = [
            ("colors", self.colors.as_ref().map(Vec::len)),
            ("coefficients", self.coefficients.as_ref().map(Vec::len)),
            ("previous", self.previous.as_ref().map(Vec::len)),
        ];
        if let Some(file) = &self.file {
            let inline = [("positions", (count > 0).then_some(count))];
            let named = inline.into_iter().chain(lists).find(|(_, it)| it.is_some());
            if let Some((key, _)) = named {
                let message = "`file` says already what the points are; write one of both";
                return Err(SceneError::value(key, message));
            }
            return PointList::lit_from_file(folder.join(file)).map_err(|error| match error {
                Error::Scene(fault) => fault,
                other => SceneError::value("file", other.to_string()),
            });
        }
        for (key, found) in lists {
            if let Some(found) = found.filter(|found| *found != count || *found == 0) {
                let message = format!("{found} values for {count} positions; each point has one");
                return Err(Fault::new(key, message).of(""));
            }
        }
        let positions = self.positions.clone();
        let light = |index: usize| {
            let color = self.colors.as_ref().map_or(self.color, |it| it[index]);
            let coefficient = self.coefficients.as_ref().map_or(1.0, |it| it[index]);
            (coefficient * color).as_vec3().to_array()
        };
        let list = match self.colors.is_none() && self.coefficients.is_none() {
            true => PointList::new(positions),
            false => PointList::with_lights(positions, (0..count).map(light).collect()),
        };
        let list = list.map_err(|error| told("positions", error))?;
        match &self.previous {
            Some(previous) => list
                .with_previous(previous.clone())
                .map_err(|error| told("previous", error)),
            None => Ok(list),
        }
    }
}

fn read_previous<'de, D: Deserializer<'de>>(reader: D) -> Result<Option<Vec<DVec3>>, D::Error> {
    read_vectors(reader).map(Some)
}

/// Says what is wrong with a list.
fn told(key: &str, error: Error) -> SceneError {
    match error {
        Error::Scene(fault) => SceneError {
            key: key.to_owned(),
            ..fault
        },
        other => SceneError::value(key, other.to_string()),
    }
}
