//! Reads a scene from TOML or JSON; every fault is reported with file, line, column and key.

mod animated;
mod collider;
mod depth;
mod display;
mod document;
mod groups;
mod integration;
#[cfg_attr(not(feature = "json"), path = "no_json.rs")]
mod json;
mod lit_points;
mod locate;
mod mesh;
mod metaballs;
mod moving;
mod numbers;
mod particles;
mod pieces;
mod piped;
mod points;
mod scan;
mod span;
mod text;
mod time;
mod toml;
mod tracks;
mod tree;
mod volume;
mod words;
mod write;

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::kinds::for_each_kind;
use super::lighting::read_lighting;
use super::*;
use crate::error::{Error, Result, SceneError};
use crate::memory;
pub use animated::AnimatedScene;
use collider::ColliderTable;
pub(super) use collider::{BOX_KEYS, COLLIDER_KEYS, PLANE_KEYS, SPHERE_KEYS};
pub(super) use depth::DEPTH_KEYS;
use depth::DepthTable;
use display::DisplayTable;
pub(super) use display::{BLOOM_KEYS, DISPLAY_KEYS};
use document::Document;
pub(super) use groups::GROUP_KEYS;
use groups::{GroupTable, Groups};
pub(super) use integration::INTEGRATION_KEYS;
use integration::IntegrationTable;
pub use integration::{MethodKeys, MethodName, Overrides};
pub(super) use lit_points::POINTS_KEYS;
use lit_points::PointsTable;
pub(super) use mesh::MESH_KEYS;
use mesh::MeshTable;
pub(super) use metaballs::METABALLS_KEYS;
use metaballs::MetaballsTable;
pub(super) use particles::PARTICLES_KEYS;
use particles::ParticlesTable;
pub(super) use points::LATTICE_KEYS;
use scan::UNIT_COUNT;
pub use span::SceneSpan;
use text::text_of;
pub(super) use time::TIME_KEYS;
use time::TimeTable;
use volume::VolumeTable;
pub(super) use volume::{LIGHT_BALL_KEYS, VOLUME_KEYS};

/// Changes a scene between its reading and its check.
type Adjust<'a> = &'a mut dyn FnMut(&mut Scene, &MethodKeys) -> Result<()>;

/// What a file holds: a scene, and its warnings.
type Read = (Scene, Vec<SceneError>);

macro_rules! define_scene_file {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// A scene as a file describes it.
        #[derive(Debug, Clone, Deserialize, Serialize)]
        #[serde(deny_unknown_fields)]
        struct SceneFile {
            camera: Camera,
            #[serde(default)]
            image: ImageSize,
            #[serde(default, skip_serializing_if = "Option::is_none")]
            decay: Option<Decay>,
            #[serde(default, skip_serializing_if = "Option::is_none")]
            absorption: Option<Absorption>,
            #[serde(default)]
            integration: IntegrationTable,
            #[serde(default)]
            display: DisplayTable,
            #[serde(default, skip_serializing_if = "Option::is_none")]
            depth: Option<DepthTable>,
            #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "read_lighting")]
            lighting: Option<Lighting>,
            #[serde(default, skip_serializing)]
            time: TimeTable,
            #[serde(default, skip_serializing_if = "Option::is_none")]
            simulation: Option<SimulationSettings>,
            #[serde(default, skip_serializing_if = "is_empty")]
            wave: List<EmittedWave>,
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            collider: Vec<ColliderTable>,
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            mesh: Vec<MeshTable>,
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            metaballs: Vec<MetaballsTable>,
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            particles: Vec<ParticlesTable>,
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            points: Vec<PointsTable>,
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            volume: Vec<VolumeTable>,
            $(#[serde(default, skip_serializing_if = "is_empty")] $kind: List<$Type>,)*
            #[serde(default, skip_serializing)]
            group: Vec<GroupTable>,
        }

        /// A run of sources of a file.
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct SourceTables {
            $(#[serde(default)] $kind: Vec<$Type>,)*
            #[serde(default)]
            group: Vec<GroupTable>,
        }

        impl SceneFile {
            /// Returns the scene without its depth image, and without surfaces and particles.
            fn scene(&mut self) -> Scene {
                Scene {
                    camera: self.camera.clone(),
                    image: self.image,
                    decay: self.decay,
                    absorption: self.absorption,
                    integration: self.integration.integration(),
                    display: self.display.display(),
                    depth: None,
                    lighting: self.lighting,
                    simulation: self.simulation,
                    waves: std::mem::take(&mut self.wave),
                    colliders: List::new(),
                    meshes: List::new(),
                    metaballs: List::new(),
                    particles: List::new(),
                    points: List::new(),
                    volumes: List::new(),
                    light_elements: List::new(),
                    $($list: std::mem::take(&mut self.$kind),)*
                }
            }

            /// Makes room for so many sources of each kind, in the order of the table, and groups.
            fn reserve(&mut self, counts: [usize; UNIT_COUNT]) {
                let mut counts = counts.into_iter();
                $(
                    let count = counts.next().unwrap_or(0);
                    if count > self.$kind.len() {
                        let more = count - self.$kind.len();
                        self.$kind.reserve_exact(more);
                    }
                )*
                let count = counts.next().unwrap_or(0);
                self.group.reserve_exact(count.saturating_sub(self.group.len()));
            }

            /// Adds the sources of a run of tables.
            fn add(&mut self, run: SourceTables) {
                $(
                    if !run.$kind.is_empty() {
                        self.$kind.extend(run.$kind);
                    }
                )*
                self.group.extend(run.group);
            }

            /// Replaces sources and groups by those of a run of tables, which have these places.
            fn replace(&mut self, run: SourceTables, indices: &[Vec<usize>; UNIT_COUNT]) {
                let mut indices = indices.iter();
                $(
                    let places = indices.next().into_iter().flatten();
                    if !run.$kind.is_empty() {
                        let list: &mut Vec<$Type> = &mut self.$kind;
                        for (index, source) in places.zip(run.$kind) {
                            list[*index] = source;
                        }
                    }
                )*
                for (index, group) in indices.next().into_iter().flatten().zip(run.group) {
                    self.group[*index] = group;
                }
            }

            /// Makes a file's scene as it is written.
            fn of(
                scene: &Scene,
                depth: Option<DepthTable>,
                display: DisplayTable,
                metaballs: Vec<MetaballsTable>,
                (particles, points): (Vec<ParticlesTable>, Vec<PointsTable>),
                volume: Vec<VolumeTable>,
            ) -> Self {
                Self {
                    camera: scene.camera.clone(),
                    image: scene.image,
                    decay: scene.decay,
                    absorption: scene.absorption,
                    integration: IntegrationTable::of(&scene.integration),
                    display,
                    depth,
                    lighting: scene.lighting,
                    time: TimeTable::default(),
                    simulation: scene.simulation,
                    wave: scene.waves.clone(),
                    collider: scene.colliders.iter().map(ColliderTable::of).collect(),
                    mesh: scene.meshes.iter().map(MeshTable::of).collect(),
                    metaballs,
                    particles,
                    points,
                    volume,
                    $($kind: scene.$list.clone(),)*
                    group: Vec::new(),
                }
            }
        }
    };
}
for_each_kind!(define_scene_file);

/// Says in the words of the reader what is wrong with a text: with its syntax, its keys and the types of its values.
#[cfg(all(test, feature = "json"))]
pub(super) fn raw_fault(text: &str) -> Option<String> {
    let fault = ::toml::from_str::<SceneFile>(text).err()?;
    Some(fault.message().to_owned())
}

/// Lets tables take what those before them have read.
fn shared<T>(mut new: Vec<T>, old: &[T], share: fn(&mut T, &T)) -> Vec<T> {
    let pairs = new.iter_mut().zip(old);
    pairs.for_each(|(new, old)| share(new, old));
    new
}

fn is_empty<T>(list: &List<T>) -> bool {
    list.len() == 0
}

impl SceneFile {
    /// Returns after how many seconds the scene begins again.
    fn period(&self) -> Option<f64> {
        self.time.period()
    }

    /// Replaces the tables of which a scene has one.
    fn replace_singles(&mut self, other: Self) {
        self.camera = other.camera;
        self.image = other.image;
        self.decay = other.decay;
        self.absorption = other.absorption;
        self.integration = other.integration;
        self.display = other.display;
        self.depth = other.depth;
        self.lighting = other.lighting;
        self.time = other.time;
        self.simulation = other.simulation;
        self.wave = other.wave;
        self.collider = shared(other.collider, &self.collider, ColliderTable::share);
        self.mesh = shared(other.mesh, &self.mesh, MeshTable::share);
        self.metaballs = shared(other.metaballs, &self.metaballs, MetaballsTable::share);
        self.particles = shared(other.particles, &self.particles, ParticlesTable::share);
        self.points = shared(other.points, &self.points, PointsTable::share);
        self.volume = shared(other.volume, &self.volume, VolumeTable::share);
    }

    /// Returns the exposure that fits the scene, if it names none and the brightness of its sources decides.
    fn exposure_of_brightest(mut self) -> Option<f64> {
        if !self.mesh.is_empty() || !self.metaballs.is_empty() || !self.particles.is_empty() {
            return None;
        }
        if !self.volume.is_empty() || !self.points.is_empty() {
            return None;
        }
        let mut scene = self.scene();
        Groups::add_to(&mut scene, std::mem::take(&mut self.group)).ok()?;
        scene.exposure_of_brightest()
    }

    /// Checks the scene, lets `adjust` change it, reads a depth image and a background unless it has given them, and
    /// checks it again.
    fn into_scene(self, folder: &Path, adjust: Adjust<'_>) -> Result<Read> {
        let (scene, groups) = self.into_checked(folder, adjust)?;
        let warnings = groups.warnings(&scene);
        Ok((scene, warnings))
    }

    /// Does the same without warnings.
    fn into_checked(mut self, folder: &Path, adjust: Adjust<'_>) -> Result<(Scene, Groups)> {
        let mut scene = self.scene();
        self.integration
            .check()
            .map_err(|fault| fault.of("integration"))?;
        self.time.check().map_err(|fault| fault.of("time"))?;
        scene.colliders = self.colliders(folder)?;
        let groups = Groups::add_to(&mut scene, std::mem::take(&mut self.group))?;
        groups.check(&scene)?;
        for (index, table) in self.mesh.iter().enumerate() {
            scene.meshes.push(table.open(index, folder)?);
        }
        for (index, table) in self.metaballs.iter().enumerate() {
            scene.metaballs.push(table.open(index, folder)?);
        }
        self.open_lights(folder, &mut scene)?;
        self.display.fit_exposure(&mut scene);
        adjust(&mut scene, &self.integration.keys())?;
        if let (Some(depth), None) = (&self.depth, &scene.depth) {
            scene.depth = Some(depth.open(folder, &scene)?);
        }
        self.display.read_background(folder, &mut scene)?;
        groups.check(&scene)?;
        Ok((scene, groups))
    }
}

impl Scene {
    /// Reads and validates a scene file; the ending chooses: `.json` is JSON, everything else TOML.
    ///
    /// # Errors
    /// [`Error::Input`] if the file cannot be read, [`Error::Scene`] if it does not hold a valid scene.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self> {
        Self::from_file_with(path, |_, _| Ok(()))
    }

    /// Like [`Scene::from_file`]; `adjust` may change the scene, which is then checked again. It is also told what the
    /// file says of the method that it does not choose. A depth image that it gives takes the place of the file's,
    /// which is then not read.
    ///
    /// # Errors
    /// As [`Scene::from_file`], and those of `adjust`.
    pub fn from_file_with(
        path: impl AsRef<Path>,
        adjust: impl FnMut(&mut Self, &MethodKeys) -> Result<()>,
    ) -> Result<Self> {
        Ok(Self::from_file_with_warnings(path, adjust)?.0)
    }

    /// Like [`Scene::from_file_with`]; also gives [`Scene::warnings`], with file and, of TOML, line and column.
    ///
    /// # Errors
    /// As [`Scene::from_file_with`].
    pub fn from_file_with_warnings(
        path: impl AsRef<Path>,
        mut adjust: impl FnMut(&mut Self, &MethodKeys) -> Result<()>,
    ) -> Result<(Self, Vec<SceneError>)> {
        open(path.as_ref())?.into_frame(0.0, &mut adjust)
    }

    /// Reads and validates a scene in TOML; a depth image's path is from the working folder.
    ///
    /// # Errors
    /// [`Error::Scene`] with line, column and key.
    pub fn from_toml(text: &str) -> Result<Self> {
        let document = Document::read(false, text, None, Path::new(""))?;
        Ok(document.into_frame(0.0, &mut |_, _| Ok(()))?.0)
    }

    /// Reads and validates a scene in JSON, of the same structure as the TOML.
    ///
    /// # Errors
    /// [`Error::Scene`] with the key; faults of the syntax have line and column too.
    #[cfg(feature = "json")]
    pub fn from_json(text: &str) -> Result<Self> {
        let document = Document::read(true, text, None, Path::new(""))?;
        Ok(document.into_frame(0.0, &mut |_, _| Ok(()))?.0)
    }
}

fn is_json(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
}

/// Bytes that what changes takes for each byte of a text that has tracks, besides.
const TRACKS_FACTOR: u64 = 16;

/// Checks that a text of so many bytes can be read in the memory that there is, of which each byte takes `factor`.
fn check_memory(what: &str, bytes: usize, factor: u64) -> Result<()> {
    let needed = (bytes as u64).saturating_mul(factor);
    match memory::shortage(needed) {
        Some(shortage) => Err(Error::OutOfMemory(format!(
            "reading {what}, {} MiB: {shortage}; make it smaller",
            bytes >> 20
        ))),
        None => Ok(()),
    }
}

/// Opens a scene file.
fn open(path: &Path) -> Result<Document<'static>> {
    let bytes = std::fs::read(path)
        .map_err(|error| Error::input(path, format!("cannot read: {error}")).caused_by(error))?;
    if piped::is_piped(path) {
        return piped::read(path, bytes);
    }
    let text = text_of(path, bytes)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    Document::read(is_json(path), text, Some(path), folder)
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
