//! `[[particles]]` of a scene file: light, and where its particles are.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::points::{LatticeTable, NamedPoints};
use crate::error::SceneError;
use crate::scene::colors::read_color;
use crate::scene::values::{read_vector, read_vectors};
use crate::scene::{MetaballKernel, Particles, PointList};

/// Of particles that name none, world units.
const RADIUS: f64 = 0.5;

/// Particles as a file describes them.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ParticlesTable {
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
    coefficient: f64,
    #[serde(deserialize_with = "read_color")]
    color: DVec3,
    kernel: MetaballKernel,
    #[serde(deserialize_with = "read_vector")]
    translate: DVec3,
    /// Its particles, once they were read; the tables of all times share them as long as they name the same.
    #[serde(skip)]
    list: Arc<OnceLock<PointList>>,
}

// What is read of `[[particles]]`.
keys! { pub(in crate::scene) PARTICLES_KEYS;
    points: Vectors(0, None), WORLD, Otherwise("file or lattice"), "where the particles are";
    file: File, NONE, Otherwise("points or lattice"), "particles: .csv, .f32 (raw float32), .npy, .ply";
    lattice: Table("lattice"), NONE, Otherwise("points or file"), "particles in layers, one on the other";
    radius: POSITIVE, WORLD, Value("0.5"), "of particles that have none of their own: beyond it there is no light";
    coefficient: NOT_NEGATIVE, NONE, Value("1"), "what the light of a particle is multiplied with";
    color: Color, NONE, Value("[1, 1, 1]"), "of the light";
    kernel: Word(&["cone", "smooth"]), NONE, Value("\"cone\""), "the light: (1 - r/h)^2, or (1 - r^2/h^2)^3";
    translate: VECTOR, WORLD, Value("[0, 0, 0]"), "what is added to every position";
}

impl Default for ParticlesTable {
    fn default() -> Self {
        Self {
            points: Vec::new(),
            file: None,
            lattice: None,
            radius: RADIUS,
            coefficient: 1.0,
            color: DVec3::ONE,
            kernel: MetaballKernel::default(),
            translate: DVec3::ZERO,
            list: Arc::default(),
        }
    }
}

impl ParticlesTable {
    /// Returns the file of its particles, if it names one, from the folder of the scene.
    pub(super) fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Makes particles as they are written; `None` if they have sizes and are in no file.
    pub(super) fn of(particles: &Particles) -> Option<Self> {
        let list = &particles.points;
        let lattice = list.made_of().map(LatticeTable::of);
        let file = list.file().map(Path::to_owned);
        let is_elsewhere = lattice.is_some() || file.is_some();
        if list.sizes().is_some() && !is_elsewhere {
            return None;
        }
        Some(Self {
            points: match is_elsewhere {
                true => Vec::new(),
                false => list.positions().to_vec(),
            },
            file,
            lattice,
            radius: particles.radius,
            coefficient: particles.coefficient,
            color: particles.color,
            kernel: particles.kernel,
            translate: particles.translate,
            list: Arc::default(),
        })
    }

    /// Takes the particles that another table has read, if it names the same.
    pub(super) fn share(&mut self, other: &Self) {
        if self.points == other.points && self.file == other.file && self.lattice == other.lattice {
            self.list = Arc::clone(&other.list);
        }
    }

    /// Makes the particles; their file is from `folder`.
    pub(super) fn open(&self, index: usize, folder: &Path) -> Result<Particles, SceneError> {
        let table = format!("particles[{index}]");
        let named = NamedPoints {
            points: &self.points,
            file: self.file.as_deref(),
            lattice: self.lattice.as_ref(),
            list: &self.list,
        };
        let particles = Particles {
            points: named.open(&table, folder)?,
            radius: self.radius,
            coefficient: self.coefficient,
            color: self.color,
            kernel: self.kernel,
            translate: self.translate,
        };
        particles.check().map_err(|fault| fault.of(&table))?;
        Ok(particles)
    }
}
