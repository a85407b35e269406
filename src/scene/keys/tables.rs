//! All tables of a scene file, from those beside the types that are read.

use super::Key;
use super::words::*;
use crate::image::ImageSize;
use crate::scene::chain::{ARC_KEYS, DASHES_KEYS};
use crate::scene::file::{
    BLOOM_KEYS, BOX_KEYS, COLLIDER_KEYS, DEPTH_KEYS, DISPLAY_KEYS, GROUP_KEYS, INTEGRATION_KEYS,
    LATTICE_KEYS, LIGHT_BALL_KEYS, MESH_KEYS, METABALLS_KEYS, PARTICLES_KEYS, PLANE_KEYS,
    POINTS_KEYS, SPHERE_KEYS, TIME_KEYS, VOLUME_KEYS,
};
use crate::scene::group::{REPEAT_KEYS, ROTATION_KEYS};
use crate::scene::integration::{ABSORPTION_KEYS, DECAY_KEYS};
use crate::scene::kinds::for_each_kind;
use crate::scene::lighting::{LIGHTING_KEYS, SUN_KEYS};
use crate::scene::simulation::{
    ACCELERATION_KEYS, CONTROL_KEYS, MIXTURE_KEYS, SIMULATION_KEYS, WAVE_KEYS,
};
use crate::scene::source::{LAYER_KEYS, SHARED_KEYS, SourceKind, *};
use crate::scene::track::{NOISE_KEYS, TRACK_KEYS};

/// What is read of `[image]`, whose type knows no scene.
const IMAGE_KEYS: &[Key] = &[
    key(
        "width",
        Whole(1, ImageSize::LIMIT),
        PIXELS,
        Value("512"),
        "pixels across",
    ),
    key(
        "height",
        Whole(1, ImageSize::LIMIT),
        PIXELS,
        Value("512"),
        "pixels down",
    ),
];

/// How often a table stands in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Count {
    /// Once, and it must: `[camera]`.
    Required,
    /// Once at most: `[image]`.
    Once,
    /// As often as wanted: `[[torus]]`.
    Many,
    /// Within another table: `arc = { .. }`.
    Inside,
    /// As a list within another table: `layers = [{ .. }]`.
    ListInside,
}

/// A table of a scene file.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Table {
    /// What it is called, such as `camera`.
    pub name: &'static str,
    /// How often it stands in a file.
    pub count: Count,
    /// What it is about, in a line.
    pub about: String,
    /// Its keys.
    pub groups: Vec<KeyGroup>,
}

/// Keys of a table that belong together.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct KeyGroup {
    /// Which tables have them besides this one; empty for those that are its own.
    pub of: &'static str,
    /// The keys.
    pub keys: &'static [Key],
}

impl Table {
    fn new(name: &'static str, count: Count, about: &str, keys: &'static [Key]) -> Self {
        Self {
            name,
            count,
            about: about.to_owned(),
            groups: vec![KeyGroup { of: "", keys }],
        }
    }

    /// Makes that of a kind of source.
    fn of_kind<T: SourceKind>(name: &'static str, about: &str) -> Self {
        let about = about.trim().trim_end_matches('.');
        let mut table = Self::new(name, Count::Many, about, T::KEYS);
        if !T::ALONG.is_empty() {
            table.groups.push(KeyGroup {
                of: "cores along which light changes",
                keys: T::ALONG,
            });
        }
        table.groups.push(KeyGroup {
            of: "all sources",
            keys: SHARED_KEYS,
        });
        table
    }

    /// Returns all its keys.
    pub fn keys(&self) -> impl Iterator<Item = &'static Key> + '_ {
        self.groups.iter().flat_map(|group| group.keys)
    }

    /// Returns the key of the table that it stands in: the last part of its name.
    #[must_use]
    pub fn key(&self) -> &'static str {
        self.name.rsplit('.').next().unwrap_or(self.name)
    }

    /// Returns how it is written in TOML, such as `[[torus]]`.
    #[must_use]
    pub fn header(&self) -> String {
        let name = self.name;
        match self.count {
            Count::Required | Count::Once => format!("[{name}]"),
            Count::Many => format!("[[{name}]]"),
            Count::Inside => format!("{name} = {{ .. }}"),
            Count::ListInside => format!("{name} = [{{ .. }}]"),
        }
    }
}

macro_rules! define_kind_tables {
    ($($(#[doc = $doc:literal])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// The tables of all kinds of sources, and what they are about.
        fn kind_tables() -> Vec<Table> {
            vec![$(Table::of_kind::<$Type>(stringify!($kind), concat!($($doc),*))),*]
        }

        /// What stands in a group besides its own keys: a list of each kind, and groups.
        const PLACED: &[Key] = &[
            $(key(
                stringify!($kind), Tables(stringify!($kind)), NONE, Otherwise("none"),
                concat!("such sources as [[", stringify!($kind), "]] makes"),
            ),)*
            key("group", Tables("group"), NONE, Otherwise("none"), "groups within this one, at most 8 deep"),
        ];
    };
}
for_each_kind!(define_kind_tables);

/// Returns all tables of a scene file: those of which it has one, the sources, then those that stand within others.
#[must_use]
pub fn tables() -> Vec<Table> {
    use Count::{Inside, ListInside, Many, Once};
    let mut tables = vec![
        Table::new(
            "camera",
            Count::Required,
            "Who looks, and along which rays",
            crate::scene::camera::CAMERA_KEYS,
        ),
        Table::new("image", Once, "The size of the image", IMAGE_KEYS),
        Table::new(
            "decay",
            Once,
            "How light fades along a ray; without it, not at all",
            DECAY_KEYS,
        ),
        Table::new(
            "absorption",
            Once,
            "What space absorbs; without it, nothing",
            ABSORPTION_KEYS,
        ),
        Table::new(
            "integration",
            Once,
            "How the light along a ray is summed",
            INTEGRATION_KEYS,
        ),
        Table::new(
            "display",
            Once,
            "How linear radiance becomes a picture",
            DISPLAY_KEYS,
        ),
        Table::new(
            "depth",
            Once,
            "What hides the light; without it, nothing",
            DEPTH_KEYS,
        ),
        Table::new(
            "lighting",
            Once,
            "How meshes are lit, also by the waves; `lighting = true` stands for an empty one",
            LIGHTING_KEYS,
        ),
        Table::new(
            "time",
            Once,
            "When the scene begins again, and how motion is blurred, if anything moves",
            TIME_KEYS,
        ),
    ];
    tables.extend(kind_tables());
    let mut group = Table::new(
        "group",
        Many,
        "Sources that are placed together, once or often",
        GROUP_KEYS,
    );
    group.groups.push(KeyGroup {
        of: "what it places",
        keys: PLACED,
    });
    tables.push(group);
    tables.extend(simulated_tables());
    tables.push(Table::new(
        "mesh",
        Many,
        "A surface of triangles; it hides the light",
        MESH_KEYS,
    ));
    tables.push(Table::new(
        "metaballs",
        Many,
        "A surface where the summed field of particles reaches a threshold; it hides the light",
        METABALLS_KEYS,
    ));
    tables.push(Table::new(
        "particles",
        Many,
        "Particles that shine, each as far as its radius",
        PARTICLES_KEYS,
    ));
    tables.push(Table::new(
        "points",
        Many,
        "Points of light in any number, as many spheres",
        POINTS_KEYS,
    ));
    tables.push(Table::new(
        "volume",
        Many,
        "Light that the cells of a grid give off",
        VOLUME_KEYS,
    ));
    tables.push(Table::new(
        "light_ball",
        Inside,
        "The cells of a ball of three shells, as that of 2006",
        LIGHT_BALL_KEYS,
    ));
    tables.extend([
        Table::new(
            "bloom",
            Inside,
            "Light of a picture that is spread around what is bright",
            BLOOM_KEYS,
        ),
        Table::new(
            "lattice",
            Inside,
            "Particles in layers of columns and rows, one layer on the other, about the origin",
            LATTICE_KEYS,
        ),
        Table::new(
            "layers",
            ListInside,
            "Several lights of a source's core, 1 to 16",
            LAYER_KEYS,
        ),
        Table::new(
            "arc",
            Inside,
            "Kinks and branches of a core, as those of lightning",
            ARC_KEYS,
        ),
        Table::new("dashes", Inside, "Gaps that part a core", DASHES_KEYS),
        Table::new("sun", Inside, "A light from one direction", SUN_KEYS),
        Table::new(
            "rotate",
            Inside,
            "A turn of a group, or of a mesh, about its origin",
            ROTATION_KEYS,
        ),
        Table::new(
            "repeat",
            Inside,
            "Copies of what stands in a group",
            REPEAT_KEYS,
        ),
    ]);
    tables
}

/// Returns the tables of what is simulated.
fn simulated_tables() -> Vec<Table> {
    use Count::{Inside, ListInside, Many, Once};
    let table = Table::new;
    vec![
        table(
            "simulation",
            Once,
            "How waves of particles are simulated, and when they are shown",
            SIMULATION_KEYS,
        ),
        table(
            "wave",
            Many,
            "Waves of particles, which fly apart where they hit something",
            WAVE_KEYS,
        ),
        table("collider", Many, "What waves hit", COLLIDER_KEYS),
        table(
            "acceleration",
            Inside,
            "How fast particles fly away around the point that they hit",
            ACCELERATION_KEYS,
        ),
        table(
            "control",
            ListInside,
            "Points that particles fly to from where they hit",
            CONTROL_KEYS,
        ),
        table(
            "mixture",
            ListInside,
            "Further shapes of separate particles",
            MIXTURE_KEYS,
        ),
        table("collider.box", Inside, "A box that waves hit", BOX_KEYS),
        table(
            "collider.sphere",
            Inside,
            "A ball that waves hit",
            SPHERE_KEYS,
        ),
        table(
            "collider.plane",
            Inside,
            "A plane that waves hit from where it faces",
            PLANE_KEYS,
        ),
    ]
}

/// Returns what a track has, which may stand in the place of numbers, vectors, colours and lists of such
/// ([`Form::may_be_track`]), and what its noise has.
#[must_use]
pub fn track_tables() -> Vec<Table> {
    let table = |name, about, keys| Table::new(name, Count::Inside, about, keys);
    vec![
        table("track", "A value as a function of time", TRACK_KEYS),
        table("noise", "Noise that is added to a track", NOISE_KEYS),
    ]
}

/// Returns the table of this name.
#[must_use]
pub fn table(name: &str) -> Option<Table> {
    let mut tables = tables().into_iter().chain(track_tables());
    tables.find(|table| table.name == name)
}
