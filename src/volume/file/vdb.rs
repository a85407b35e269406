//! OpenVDB files, version 224 (Museth 2013; `openvdb/io` of OpenVDB 10): trees of nodes of 32^3 and 16^3 children over
//! leaves of 8^3 cells, uncompressed. A grid's cell (0,0,0) is the volume's, at the middle of that cell. A colour that
//! is the same everywhere is in active tiles, one for each leaf of the density.

use std::io::{self, SeekFrom};

use exr::prelude::f16;
use glam::DVec3;

use crate::output::Sink;
use crate::volume::{BRICK, Brick, Volume};

const MAGIC: u64 = 0x5644_4220;
const FILE_VERSION: u32 = 224;
const LIBRARY: [u32; 2] = [10, 0];

/// Says that all values of a node follow, active or not.
const ALL_VALUES: u8 = 6;

/// Cells, or children, along an edge of a leaf and of the nodes above, as powers of 2.
const LEAF: u32 = 3;
const LOWER: u32 = 4;
const UPPER: u32 = 5;

/// What a grid of the file holds of a cell's emission.
#[derive(Clone, Copy)]
enum Part {
    /// The largest channel.
    Density,
    /// All, of the largest.
    Color,
}

impl Part {
    fn name(self) -> &'static str {
        match self {
            Self::Density => "density",
            Self::Color => "color",
        }
    }

    fn tree(self, half: bool) -> &'static str {
        match (self, half) {
            (Self::Density, false) => "Tree_float_5_4_3",
            (Self::Density, true) => "Tree_float_5_4_3_HalfFloat",
            (Self::Color, false) => "Tree_vec3s_5_4_3",
            (Self::Color, true) => "Tree_vec3s_5_4_3_HalfFloat",
        }
    }

    fn channels(self) -> usize {
        match self {
            Self::Density => 1,
            Self::Color => 3,
        }
    }

    fn of(self, emission: [f32; 3]) -> [f32; 3] {
        let most =
            emission.into_iter().fold(
                0.0,
                |most, it| if it.abs() > f32::abs(most) { it } else { most },
            );
        match self {
            Self::Density => [most; 3],
            Self::Color if most == 0.0 => [0.0; 3],
            Self::Color => emission.map(|channel| channel / most),
        }
    }
}

/// A leaf and its place, in leaves.
type Leaf<'a> = ([u32; 3], &'a Brick);

pub(super) fn write(
    sink: &mut dyn Sink,
    volume: &Volume,
    (half, color): (bool, Option<DVec3>),
    notes: &[(String, String)],
) -> io::Result<()> {
    let mut leaves: Vec<Leaf<'_>> = volume.bricks().collect();
    // As the trees have them: by their upper node's place, x first, then by their lower's.
    leaves.sort_by_key(|(place, _)| (child(*place, LOWER, UPPER), child(*place, 0, LOWER)));
    let color = color.map(|color| color.as_vec3().to_array());
    let mut to = Writer { sink, half, color };
    to.bytes(&MAGIC.to_le_bytes())?;
    to.word(FILE_VERSION)?;
    LIBRARY.into_iter().try_for_each(|number| to.word(number))?;
    to.bytes(&[1])?; // grids have offsets
    to.bytes(b"00000000-0000-4000-8000-000000000000")?;
    to.word(0)?; // no metadata of the file
    to.word(2)?; // grids
    for part in [Part::Density, Part::Color] {
        to.grid(part, volume, &leaves, notes)?;
    }
    Ok(())
}

/// Returns the number of the child of a node, of `1 << node` along an edge, in which a leaf is; a child has `1 <<
/// below` leaves along an edge.
fn child(place: [u32; 3], below: u32, node: u32) -> u32 {
    let [x, y, z] = place.map(|it| it >> below & ((1 << node) - 1));
    x << (2 * node) | y << node | z
}

struct Writer<'a> {
    sink: &'a mut dyn Sink,
    half: bool,
    /// That of all cells.
    color: Option<[f32; 3]>,
}

impl Writer<'_> {
    fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sink.write_all(bytes)
    }

    fn word(&mut self, word: u32) -> io::Result<()> {
        self.bytes(&word.to_le_bytes())
    }

    fn text(&mut self, text: &str) -> io::Result<()> {
        self.word(text.len() as u32)?;
        self.bytes(text.as_bytes())
    }

    fn numbers(&mut self, numbers: [f64; 3]) -> io::Result<()> {
        numbers
            .into_iter()
            .try_for_each(|number| self.bytes(&number.to_le_bytes()))
    }

    fn values(&mut self, part: Part, values: [f32; 3]) -> io::Result<()> {
        for value in &values[..part.channels()] {
            match self.half {
                true => self.bytes(&f16::from_f32(*value).to_le_bytes())?,
                false => self.bytes(&value.to_le_bytes())?,
            }
        }
        Ok(())
    }

    fn mask(&mut self, bits: &[u8]) -> io::Result<()> {
        self.bytes(bits)
    }

    fn grid(
        &mut self,
        part: Part,
        volume: &Volume,
        leaves: &[Leaf<'_>],
        notes: &[(String, String)],
    ) -> io::Result<()> {
        self.text(part.name())?;
        self.text(part.tree(self.half))?;
        self.text("")?; // no instance of another
        let offsets = self.sink.stream_position()?;
        self.bytes(&[0; 24])?;
        let begin = self.sink.stream_position()?;
        self.word(0)?; // uncompressed
        self.metadata(part, notes)?;
        self.transform(volume)?;
        self.topology(part, leaves)?;
        let blocks = self.sink.stream_position()?;
        let tile = self.tile(part);
        for (_, brick) in leaves.iter().filter(|_| tile.is_none()) {
            self.leaf(part, brick)?;
        }
        let end = self.sink.stream_position()?;
        self.sink.seek(SeekFrom::Start(offsets))?;
        [begin, blocks, end]
            .into_iter()
            .try_for_each(|place| self.bytes(&place.to_le_bytes()))?;
        self.sink.seek(SeekFrom::Start(end))?;
        Ok(())
    }

    fn metadata(&mut self, part: Part, notes: &[(String, String)]) -> io::Result<()> {
        // NanoVDB takes no fog but of single numbers.
        let class = match part {
            Part::Density => "fog volume",
            Part::Color => "unknown",
        };
        let own = [("class", class), ("name", part.name())];
        let notes = notes
            .iter()
            .map(|(name, value)| (name.as_str(), value.as_str()));
        let texts: Vec<(&str, &str)> = own.into_iter().chain(notes).collect();
        self.word(texts.len() as u32 + 1)?;
        for (name, value) in texts {
            self.text(name)?;
            self.text("string")?;
            self.text(value)?;
        }
        self.text("is_saved_as_half_float")?;
        self.text("bool")?;
        self.word(1)?;
        self.bytes(&[u8::from(self.half)])
    }

    fn transform(&mut self, volume: &Volume) -> io::Result<()> {
        let cell = volume.grid().cell();
        self.text("UniformScaleTranslateMap")?;
        self.numbers(volume.grid().middle([0; 3]).to_array())?;
        for scale in [cell, cell, 1.0 / cell, 1.0 / (cell * cell), 0.5 / cell] {
            self.numbers([scale; 3])?;
        }
        Ok(())
    }

    /// Writes which nodes and cells there are.
    fn topology(&mut self, part: Part, leaves: &[Leaf<'_>]) -> io::Result<()> {
        self.word(1)?; // buffers of a leaf
        self.bytes(&[0; 12][..4 * part.channels()])?; // the background, never half
        self.word(0)?; // tiles of the root
        // A grid of 2048 cells along an edge lies in one child of the root, which has 4096.
        self.word(u32::from(!leaves.is_empty()))?;
        if leaves.is_empty() {
            return Ok(());
        }
        self.bytes(&[0; 12])?; // where it begins
        let lowers = || leaves.chunk_by(|(one, _), (next, _)| lower(*one) == lower(*next));
        let children = lowers().map(|leaves| lower(leaves[0].0));
        self.node(part, UPPER, (children, None))?;
        let tile = self.tile(part);
        for leaves in lowers() {
            let children = leaves.iter().map(|(place, _)| child(*place, 0, LOWER));
            self.node(part, LOWER, (children, tile))?;
            for (_, brick) in leaves.iter().filter(|_| tile.is_none()) {
                self.mask(&active(brick))?;
            }
        }
        Ok(())
    }

    /// Returns the value of tiles that stand for leaves.
    fn tile(&self, part: Part) -> Option<[f32; 3]> {
        self.color.filter(|_| matches!(part, Part::Color))
    }

    /// Writes a node of `1 << edge` children along an edge, of which it has some, or tiles of one value in their place.
    fn node(
        &mut self,
        part: Part,
        edge: u32,
        (children, tile): (impl Iterator<Item = u32>, Option<[f32; 3]>),
    ) -> io::Result<()> {
        let count = 1_usize << (3 * edge);
        let (mut there, none) = (vec![0_u8; count / 8], vec![0_u8; count / 8]);
        children.for_each(|child| there[child as usize / 8] |= 1 << (child % 8));
        let (nodes, tiles) = match tile {
            None => (&there, &none),
            Some(_) => (&none, &there),
        };
        self.mask(nodes)?;
        self.mask(tiles)?;
        self.bytes(&[ALL_VALUES])?;
        for child in 0..count {
            let is_tile = tiles[child / 8] >> (child % 8) & 1 == 1;
            self.values(part, tile.filter(|_| is_tile).unwrap_or_default())?;
        }
        Ok(())
    }

    fn leaf(&mut self, part: Part, brick: &Brick) -> io::Result<()> {
        self.mask(&active(brick))?;
        self.bytes(&[ALL_VALUES])?;
        for [x, y, z] in places() {
            self.values(part, part.of(brick.at([x, y, z])))?;
        }
        Ok(())
    }
}

/// Returns the child of the upper node in which a leaf is.
fn lower(place: [u32; 3]) -> u32 {
    child(place, LOWER, UPPER)
}

/// Returns the places of a leaf's cells in the order of its values, z fastest.
fn places() -> impl Iterator<Item = [u32; 3]> {
    let edge = BRICK;
    (0..1 << (3 * LEAF))
        .map(move |number| [number / edge / edge, number / edge % edge, number % edge])
}

/// Returns the mask of a leaf's cells that glow.
fn active(brick: &Brick) -> [u8; 64] {
    let mut mask = [0; 64];
    for (number, place) in places().enumerate() {
        let glows = brick.at(place) != [0.0; 3];
        mask[number / 8] |= u8::from(glows) << (number % 8);
    }
    mask
}
