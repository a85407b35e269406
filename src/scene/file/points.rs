//! Where particles are, of a scene file: listed, in a file, or in a lattice.

use std::path::Path;
use std::sync::OnceLock;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::error::SceneError;
use crate::scene::values::{Fault, read_pair};
use crate::scene::{Lattice, PointList};

/// A lattice as a file describes it.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LatticeTable {
    #[serde(default = "columns_2008", deserialize_with = "read_pair")]
    columns: [f64; 2],
    count: u32,
    spacing: f64,
    #[serde(default)]
    jitter: f64,
    #[serde(default)]
    seed: u32,
}

// What is read of `lattice`.
keys! { pub(in crate::scene) LATTICE_KEYS;
    columns: PAIR, NONE, Value("[24, 24]"), "particles along x and along y, whole numbers";
    count: WHOLE, NONE, Required, "how many there are in all layers";
    spacing: POSITIVE, WORLD, Required, "from one to the next";
    jitter: from_to(0.0, 1.0), NONE, Value("0"), "by which share of the spacing each is moved, along every axis";
    seed: WHOLE, NONE, Value("0"), "which moves";
}

fn columns_2008() -> [f64; 2] {
    Lattice::new(0, 1.0).columns.map(f64::from)
}

impl LatticeTable {
    fn lattice(&self) -> Result<Lattice, Fault> {
        let is_count = |it: &f64| it.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(it);
        if !self.columns.iter().all(is_count) {
            let [across, along] = self.columns;
            let message = format!("{across} by {along}; both are whole numbers, 1 or more");
            return Err(Fault::new("columns", message));
        }
        let lattice = Lattice {
            columns: self.columns.map(|it| it as u32),
            count: self.count,
            spacing: self.spacing,
            jitter: self.jitter,
            seed: self.seed,
        };
        lattice.check()?;
        Ok(lattice)
    }

    pub(super) fn of(lattice: &Lattice) -> Self {
        Self {
            columns: lattice.columns.map(f64::from),
            count: lattice.count,
            spacing: lattice.spacing,
            jitter: lattice.jitter,
            seed: lattice.seed,
        }
    }
}

/// What a table says of where its particles are.
pub(super) struct NamedPoints<'a> {
    pub points: &'a [DVec3],
    /// From the folder of the scene.
    pub file: Option<&'a Path>,
    pub lattice: Option<&'a LatticeTable>,
    /// The particles, once they were read.
    pub list: &'a OnceLock<PointList>,
}

impl NamedPoints<'_> {
    /// Reads the particles of a table, unless that was done.
    pub(super) fn open(&self, table: &str, folder: &Path) -> Result<PointList, SceneError> {
        let named = [
            ("points", !self.points.is_empty()),
            ("file", self.file.is_some()),
            ("lattice", self.lattice.is_some()),
        ];
        let mut named = named.into_iter().filter(|(_, is_there)| *is_there);
        if let (Some((first, _)), Some((second, _))) = (named.next(), named.next()) {
            let message =
                format!("`{first}` says already where the particles are; write one of both");
            return Err(SceneError::value(format!("{table}.{second}"), message));
        }
        if let Some(list) = self.list.get() {
            return Ok(list.clone());
        }
        let list = self.read(folder).map_err(|fault| SceneError {
            key: format!("{table}.{}", fault.key),
            ..fault
        })?;
        Ok(self.list.get_or_init(|| list).clone())
    }

    fn read(&self, folder: &Path) -> Result<PointList, SceneError> {
        let list = match (self.file, self.lattice) {
            (Some(file), _) => PointList::from_file(folder.join(file)),
            (None, Some(table)) => {
                let lattice = table.lattice().map_err(|fault| fault.of("lattice"))?;
                PointList::lattice(&lattice)
            }
            (None, None) => PointList::new(self.points.to_vec()),
        };
        list.map_err(|error| match error {
            crate::Error::Scene(fault) => fault,
            other => SceneError::value("file", other.to_string()),
        })
    }
}
