//! NRRD 5 (teem.sourceforge.net/nrrd/format.html): lines of text, then the cells.

use std::io;

use super::{Stored, numbers, write_dense};
use crate::output::Sink;
use crate::volume::Volume;

pub(super) fn write(
    sink: &mut dyn Sink,
    volume: &Volume,
    stored: Stored,
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
    let (axes, channels, none, kind) = match stored.channels() {
        1 => (3, String::new(), "", ""),
        3 => (4, "3 ".to_owned(), "none ", "RGB-color "),
        other => (4, format!("{other} "), "none ", "list "),
    };
    let header = format!(
        "NRRD0005\ntype: float\ndimension: {axes}\nspace dimension: 3\nsizes: {channels}{x} {y} {z}\nspace \
         directions: {none}({cell},0,0) (0,{cell},0) (0,0,{cell})\nspace origin: ({origin})\nkinds: {kind}domain \
         domain domain\nendian: little\nencoding: raw\n{notes}\n"
    );
    sink.write_all(header.as_bytes())?;
    write_dense(sink, volume, stored)
}
