//! VTK image data (the VTK XML formats, docs.vtk.org): cells, appended as they are.

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
    let extent = format!("0 {x} 0 {y} 0 {z}");
    let origin = numbers(grid.bounds()[0], " ");
    let cell = grid.cell();
    let notes: String = notes
        .iter()
        .map(|(name, value)| format!("{name}: {value}\n").replace("--", "- -"))
        .collect();
    let channels = stored.channels();
    let name = if channels < 3 { "density" } else { "emission" };
    let header = format!(
        "<?xml version=\"1.0\"?>\n<!--\n{notes}-->\n<VTKFile type=\"ImageData\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<ImageData WholeExtent=\"{extent}\" Origin=\"{origin}\" \
         Spacing=\"{cell} {cell} {cell}\">\n<Piece Extent=\"{extent}\">\n<CellData Scalars=\"{name}\">\n<DataArray \
         type=\"Float32\" Name=\"{name}\" NumberOfComponents=\"{channels}\" format=\"appended\" offset=\"0\"/>\n\
         </CellData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_"
    );
    sink.write_all(header.as_bytes())?;
    let bytes = 4 * channels as u64 * grid.cells().map(u64::from).iter().product::<u64>();
    sink.write_all(&bytes.to_le_bytes())?;
    write_dense(sink, volume, stored)?;
    sink.write_all(b"\n</AppendedData>\n</VTKFile>\n")
}
