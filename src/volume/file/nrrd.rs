//! NRRD 5 (teem.sourceforge.net/nrrd/format.html): lines of text, then the cells.

use std::io;

use super::{numbers, write_dense};
use crate::output::Sink;
use crate::volume::{Storage, Volume};

pub(super) fn write(
    sink: &mut dyn Sink,
    volume: &Volume,
    storage: Storage,
    notes: &[(String, String)],
) -> io::Result<()> {
    let grid = volume.grid();
    let [x, y, z] = grid.cells();
    let cell = grid.cell();
    let origin = numbers(grid.middle([0; 3]), ",");
    let notes: String = notes
        .iter()
        .map(|(name, value)| {
            format!(
                "{name}:={}\n",
                value.replace('\\', "\\\\").replace('\n', "\\n")
            )
        })
        .collect();
    let header = format!(
        "NRRD0005\ntype: float\ndimension: 4\nspace dimension: 3\nsizes: 3 {x} {y} {z}\nspace directions: none \
         ({cell},0,0) (0,{cell},0) (0,0,{cell})\nspace origin: ({origin})\nkinds: RGB-color domain domain domain\n\
         endian: little\nencoding: raw\n{notes}\n"
    );
    sink.write_all(header.as_bytes())?;
    write_dense(sink, volume, storage)
}
