//! The tree of a grid: a root, nodes of 32^3 and 16^3 children, leaves of 8^3 cells. First come all masks and tiles,
//! then the values of the leaves. A mask of active cells, numbers for the others, and zip or Blosc make values small.

use exr::prelude::f16;
use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;

use super::super::Read;
use super::blosc;
use super::cursor::Cursor;

const ZIP: u32 = 1;
const ACTIVE: u32 = 2;
const BLOSC: u32 = 4;

/// The ways to make values small that are read.
pub(super) const KNOWN: u32 = ZIP | ACTIVE | BLOSC;

/// Children along an edge, as powers of 2, of nodes from the root down; and cells along an edge of such a child.
const LEVELS: [(u32, i64); 2] = [(5, 128), (4, 8)];

/// Cells of a leaf.
const CELLS: usize = 512;

/// Cells that are active: of one value, or some of a leaf.
pub(super) enum Piece<'a> {
    Tile {
        origin: [i64; 3],
        edge: i64,
        value: [f32; 3],
    },
    Leaf {
        origin: [i64; 3],
        mask: &'a [u8],
    },
}

/// A grid's tree, from where it begins in the file.
#[derive(Clone)]
pub(super) struct Tree<'a> {
    pub cursor: Cursor<'a>,
    pub compression: u32,
    pub is_half: bool,
    pub channels: usize,
    /// Of cells that are not there; known once the root was read.
    pub background: [f32; 3],
}

impl<'a> Tree<'a> {
    /// Reads which cells are active, and the values of tiles; goes on to the leaves' values.
    pub(super) fn topology(&mut self, visit: &mut dyn FnMut(Piece<'a>)) -> Read<()> {
        let buffers = self.cursor.word()?;
        if buffers != 1 {
            let message = format!("{buffers} buffers for each leaf; 1 is read");
            return Err(self.cursor.fault(&message));
        }
        self.background = self.value()?;
        let (tiles, children) = (self.cursor.word()?, self.cursor.word()?);
        for _ in 0..tiles {
            let (origin, value) = (self.origin()?, self.value()?);
            let [is_active] = self.cursor.number()?;
            if is_active != 0 {
                let edge = 4096;
                visit(Piece::Tile {
                    origin,
                    edge,
                    value,
                });
            }
        }
        for _ in 0..children {
            let origin = self.origin()?;
            self.node(origin, 0, visit)?;
        }
        Ok(())
    }

    fn origin(&mut self) -> Read<[i64; 3]> {
        let mut origin = [0; 3];
        for axis in &mut origin {
            *axis = i64::from(i32::from_le_bytes(self.cursor.number()?));
        }
        Ok(origin)
    }

    /// Reads a value that is never half.
    fn value(&mut self) -> Read<[f32; 3]> {
        match self.channels {
            1 => self.cursor.floats().map(|[value]| [value; 3]),
            _ => self.cursor.floats(),
        }
    }

    fn node(
        &mut self,
        origin: [i64; 3],
        level: usize,
        visit: &mut dyn FnMut(Piece<'a>),
    ) -> Read<()> {
        let (bits, edge) = LEVELS[level];
        let count = 1_usize << (3 * bits);
        let children = self.cursor.take(count / 8)?;
        let active = self.cursor.take(count / 8)?;
        let values = self.values(count, active)?;
        let place = |number: usize| {
            let along = |shift: u32| (number >> shift) as i64 & ((1 << bits) - 1);
            let at = [along(2 * bits), along(bits), along(0)];
            [0, 1, 2].map(|axis| origin[axis] + at[axis] * edge)
        };
        for number in (0..count).filter(|it| is_on(active, *it) && !is_on(children, *it)) {
            let mut value = [values[number * self.channels]; 3];
            value[..self.channels]
                .copy_from_slice(&values[number * self.channels..][..self.channels]);
            visit(Piece::Tile {
                origin: place(number),
                edge,
                value,
            });
        }
        for number in (0..count).filter(|it| is_on(children, *it)) {
            if level + 1 < LEVELS.len() {
                self.node(place(number), level + 1, visit)?;
            } else {
                let mask = self.cursor.take(CELLS / 8)?;
                visit(Piece::Leaf {
                    origin: place(number),
                    mask,
                });
            }
        }
        Ok(())
    }

    /// Reads the values of the next leaf, and gives each active cell's.
    pub(super) fn leaf(&mut self, put: &mut dyn FnMut([i64; 3], &[f32])) -> Read<()> {
        let active = self.cursor.take(CELLS / 8)?;
        let values = self.values(CELLS, active)?;
        for number in (0..CELLS).filter(|it| is_on(active, *it)) {
            let place = [number >> 6, number >> 3 & 7, number & 7].map(|it| it as i64);
            put(place, &values[number * self.channels..][..self.channels]);
        }
        Ok(())
    }

    /// Reads the values of a node. Those of cells that are not active are of no use here, and stay 0 where the file has
    /// no number for each.
    fn values(&mut self, count: usize, active: &[u8]) -> Read<Vec<f32>> {
        let [kind] = self.cursor.number()?;
        // What stands for inactive values: up to two of them, and a mask that selects one.
        let (numbers, has_mask) = match kind {
            0 | 1 | 6 => (0, false),
            2 => (1, false),
            3 => (0, true),
            4 => (1, true),
            5 => (2, true),
            other => {
                let message = format!("damaged: {other} for inactive values");
                return Err(self.cursor.fault(&message));
            }
        };
        for _ in 0..numbers {
            self.value()?;
        }
        if has_mask {
            self.cursor.take(count / 8)?;
        }
        let is_sparse = self.compression & ACTIVE != 0 && kind != 6;
        if !is_sparse {
            return self.numbers(count);
        }
        let there: usize = active.iter().map(|it| it.count_ones() as usize).sum();
        let few = self.numbers(there)?;
        let mut values = vec![0.0; count * self.channels];
        let on = (0..count).filter(|it| is_on(active, *it));
        for (number, value) in on.zip(few.chunks_exact(self.channels)) {
            values[number * self.channels..][..self.channels].copy_from_slice(value);
        }
        Ok(values)
    }

    fn numbers(&mut self, count: usize) -> Read<Vec<f32>> {
        let numbers = count * self.channels;
        let bytes = numbers * if self.is_half { 2 } else { 4 };
        if count == 0 && self.is_half {
            return Ok(Vec::new());
        }
        let unpacked;
        let bytes = match self.compression & (ZIP | BLOSC) {
            0 => self.cursor.take(bytes)?,
            _ => {
                unpacked = self.unpacked(bytes)?;
                &unpacked[..]
            }
        };
        Ok(match self.is_half {
            true => {
                let halves = bytes.as_chunks::<2>().0.iter();
                halves.map(|it| f16::from_le_bytes(*it).to_f32()).collect()
            }
            false => {
                let floats = bytes.as_chunks::<4>().0.iter();
                floats.map(|it| f32::from_le_bytes(*it)).collect()
            }
        })
    }

    /// Reads so many bytes that were made fewer; a length below 0 says that they were not.
    fn unpacked(&mut self, bytes: usize) -> Read<Vec<u8>> {
        let length = self.cursor.long()?.cast_signed();
        let packed = self.cursor.take(length.unsigned_abs() as usize)?;
        let unpacked = match length {
            ..=0 => Ok(packed.to_vec()),
            _ if self.compression & BLOSC != 0 => blosc::unpacked(packed, bytes),
            _ => decompress_to_vec_zlib_with_limit(packed, bytes)
                .map_err(|error| format!("its zip is damaged: {error}")),
        };
        match unpacked {
            Ok(unpacked) if unpacked.len() == bytes => Ok(unpacked),
            Ok(unpacked) => {
                let message = format!("damaged: {} bytes in place of {bytes}", unpacked.len());
                Err(self.cursor.fault(&message))
            }
            Err(message) => Err(self.cursor.fault(&message)),
        }
    }
}

fn is_on(mask: &[u8], number: usize) -> bool {
    mask[number / 8] >> (number % 8) & 1 == 1
}

/// The box around what is active.
#[derive(Default)]
pub(super) struct Bounds(Option<[[i64; 3]; 2]>);

impl Bounds {
    pub(super) fn take(&mut self, piece: Piece<'_>) {
        match piece {
            Piece::Tile { origin, edge, .. } => self.add(origin, origin.map(|it| it + edge)),
            Piece::Leaf { origin, mask } => {
                for number in (0..CELLS).filter(|it| is_on(mask, *it)) {
                    let at = [number >> 6, number >> 3 & 7, number & 7];
                    let cell = [0, 1, 2].map(|axis| origin[axis] + at[axis] as i64);
                    self.add(cell, cell.map(|it| it + 1));
                }
            }
        }
    }

    fn add(&mut self, low: [i64; 3], high: [i64; 3]) {
        let [all_low, all_high] = self.0.get_or_insert([low, high]);
        for axis in 0..3 {
            all_low[axis] = all_low[axis].min(low[axis]);
            all_high[axis] = all_high[axis].max(high[axis]);
        }
    }

    /// Returns the lowest cell, and the one behind the highest.
    pub(super) fn found(&self) -> Option<[[i64; 3]; 2]> {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use miniz_oxide::deflate::compress_to_vec_zlib;

    #[test]
    fn leaves_whose_active_values_are_zipped_are_read_and_damaged_ones_are_not() {
        // Every fifth cell is active; the others are one of two numbers by a mask.
        let is_there = |number: usize| number.is_multiple_of(5);
        let mut mask = [0_u8; 64];
        (0..CELLS)
            .filter(|it| is_there(*it))
            .for_each(|it| mask[it / 8] |= 1 << (it % 8));
        let there = (0..CELLS).filter(|it| is_there(*it));
        let values: Vec<u8> = there.flat_map(|it| (it as f32).to_le_bytes()).collect();
        let zipped = compress_to_vec_zlib(&values, 6);
        let mut bytes = mask.to_vec();
        bytes.push(5);
        bytes.extend([0; 8]);
        bytes.extend([0; 64]);
        bytes.extend((zipped.len() as u64).to_le_bytes());
        bytes.extend(&zipped);
        let read = |bytes: &[u8]| {
            let mut tree = Tree {
                cursor: Cursor::new(bytes, "zipped"),
                compression: ZIP | ACTIVE,
                is_half: false,
                channels: 1,
                background: [0.0; 3],
            };
            let mut found = Vec::new();
            let outcome =
                tree.leaf(&mut |[x, y, z], value| found.push((x * 64 + y * 8 + z, value[0])));
            outcome.is_ok().then_some(found)
        };
        let expected = (0..CELLS).filter(|it| is_there(*it));
        let expected: Vec<_> = expected.map(|it| (it as i64, it as f32)).collect();
        assert_eq!(read(&bytes), Some(expected));
        assert_eq!(read(&bytes[..bytes.len() - 1]), None);
        // A zip of more than there is room for.
        bytes[0] ^= 1;
        assert_eq!(read(&bytes), None);
    }
}
