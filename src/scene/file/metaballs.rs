//! `[[metaballs]]` of a scene file: a surface, and where its particles are.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::points::{LatticeTable, NamedPoints};
use crate::error::SceneError;
use crate::scene::colors::read_color;
use crate::scene::metaballs::{MOST_SAMPLES, THRESHOLD_2008};
use crate::scene::values::{Fault, read_vector, read_vectors};
use crate::scene::{
    MetaballKernel, MetaballMethod, MetaballSampling, MetaballShading, Metaballs, PointList,
};

/// The radius of 2008, world units.
const RADIUS_2008: f64 = 0.61;

/// A surface as a file describes it. Keys of all methods may stand there, whichever is chosen.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct MetaballsTable {
    #[serde(
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "read_vectors"
    )]
    points: Vec<DVec3>,
    /// From the folder of the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lattice: Option<LatticeTable>,
    radius: f64,
    threshold: f64,
    kernel: MetaballKernel,
    shading: MetaballShading,
    method: MethodName,
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    refinements: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    interval: Option<f64>,
    #[serde(deserialize_with = "read_color")]
    color: DVec3,
    #[serde(deserialize_with = "read_vector")]
    translate: DVec3,
    /// Its particles, once they were read; the tables of all times share them as long as they name the same.
    #[serde(skip)]
    list: Arc<OnceLock<PointList>>,
}

// What is read of `[[metaballs]]`.
keys! { pub(in crate::scene) METABALLS_KEYS;
    points: Vectors(0, None), WORLD, Otherwise("file or lattice"), "where the particles are";
    file: File, NONE, Otherwise("points or lattice"), "particles: .csv, .f32 (raw float32), .npy, .ply";
    lattice: Table("lattice"), NONE, Otherwise("points or file"), "particles in layers, one on the other";
    radius: POSITIVE, WORLD, Value("0.61"), "of particles that have none of their own: beyond it there is no field";
    threshold: POSITIVE, NONE, Value("0.765625"), "the summed field on the surface";
    kernel: Word(&["cone", "smooth"]), NONE, Value("\"cone\""), "the field: (1 - r/h)^2, or (1 - r^2/h^2)^3";
    shading: Word(&["lit", "normals"]), NONE, Value("\"lit\""), "by a lamp at the upper left, or the normal as colour";
    method: Word(&["exact", "sampling"]), NONE, Value("\"exact\""), "without holes, or the samples of 2008";
    samples: Whole(1, MOST_SAMPLES), NONE, Value("32"), "sampling: samples of a ray, at most";
    refinements: Whole(0, MOST_SAMPLES), NONE, Value("1"), "sampling: how often the place is interpolated";
    interval: POSITIVE, WORLD, Otherwise("radius / 8"), "sampling: from one sample to the next";
    color: Color, NONE, Value("[1, 1, 1]"), "radiance of what faces the lamp";
    translate: VECTOR, WORLD, Value("[0, 0, 0]"), "what is added to every position";
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
enum MethodName {
    Exact,
    Sampling,
}

impl Default for MetaballsTable {
    fn default() -> Self {
        Self {
            points: Vec::new(),
            file: None,
            lattice: None,
            radius: RADIUS_2008,
            threshold: THRESHOLD_2008,
            kernel: MetaballKernel::default(),
            shading: MetaballShading::default(),
            method: MethodName::Exact,
            samples: None,
            refinements: None,
            interval: None,
            color: DVec3::ONE,
            translate: DVec3::ZERO,
            list: Arc::default(),
        }
    }
}

impl MetaballsTable {
    /// Returns the file of its particles, if it names one, from the folder of the scene.
    pub(super) fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Makes a surface as it is written; `None` if its particles have sizes and are in no file.
    pub(super) fn of(metaballs: &Metaballs) -> Option<Self> {
        let list = &metaballs.points;
        let lattice = list.made_of().map(LatticeTable::of);
        let file = list.file().map(Path::to_owned);
        let is_elsewhere = lattice.is_some() || file.is_some();
        if list.sizes().is_some() && !is_elsewhere {
            return None;
        }
        let sampling = match metaballs.method {
            MetaballMethod::Exact => None,
            MetaballMethod::Sampling(sampling) => Some(sampling),
        };
        Some(Self {
            points: match is_elsewhere {
                true => Vec::new(),
                false => list.positions().to_vec(),
            },
            file,
            lattice,
            radius: metaballs.radius,
            threshold: metaballs.threshold,
            kernel: metaballs.kernel,
            shading: metaballs.shading,
            method: sampling.map_or(MethodName::Exact, |_| MethodName::Sampling),
            samples: sampling.map(|it| it.samples),
            refinements: sampling.map(|it| it.refinements),
            interval: sampling.and_then(|it| it.interval),
            color: metaballs.color,
            translate: metaballs.translate,
            list: Arc::default(),
        })
    }

    /// Takes the particles that another table has read, if it names the same.
    pub(super) fn share(&mut self, other: &Self) {
        if self.points == other.points && self.file == other.file && self.lattice == other.lattice {
            self.list = Arc::clone(&other.list);
        }
    }

    /// Makes the surface; its file is from `folder`.
    pub(super) fn open(&self, index: usize, folder: &Path) -> Result<Metaballs, SceneError> {
        let table = format!("metaballs[{index}]");
        let of = |fault: Fault| fault.of(&table);
        let sampling = self.sampling();
        sampling.check().map_err(of)?; // also where it is not chosen
        let metaballs = Metaballs {
            points: self.named().open(&table, folder)?,
            radius: self.radius,
            threshold: self.threshold,
            kernel: self.kernel,
            shading: self.shading,
            method: match self.method {
                MethodName::Exact => MetaballMethod::Exact,
                MethodName::Sampling => MetaballMethod::Sampling(sampling),
            },
            color: self.color,
            translate: self.translate,
        };
        metaballs.check().map_err(of)?;
        Ok(metaballs)
    }

    fn named(&self) -> NamedPoints<'_> {
        NamedPoints {
            points: &self.points,
            file: self.file.as_deref(),
            lattice: self.lattice.as_ref(),
            list: &self.list,
        }
    }

    fn sampling(&self) -> MetaballSampling {
        let absent = MetaballSampling::default();
        MetaballSampling {
            interval: self.interval,
            samples: self.samples.unwrap_or(absent.samples),
            refinements: self.refinements.unwrap_or(absent.refinements),
        }
    }
}
