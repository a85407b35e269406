//! The layers of a volume side by side in an image: textures of engines that have no volumes.

use crate::error::{Error, Result};
use crate::image::{ImageSize, RadianceImage};
use crate::volume::{Grid, Volume};

/// Longest edge of an image.
const MOST_PIXELS: u32 = 32768;

/// Returns how many layers lie side by side, and how many below each other: about as many.
pub(super) fn layout(grid: &Grid) -> [u32; 2] {
    let [columns, rows, layers] = grid.cells();
    let square = (f64::from(layers) * f64::from(rows) / f64::from(columns)).sqrt();
    let across = (square.round() as u32).clamp(1, layers);
    [across, layers.div_ceil(across)]
}

/// Lays all layers into an image, the first on the top left, then those beside it: linear RGB, and as alpha the
/// largest of them.
pub(super) fn image(volume: &Volume) -> Result<RadianceImage> {
    let [columns, rows, layers] = volume.grid().cells();
    let [across, down] = layout(volume.grid());
    let size = ImageSize {
        width: across * columns,
        height: down * rows,
    };
    if size.width.max(size.height) > MOST_PIXELS {
        let message = format!(
            "layers of {} cells side by side: {} by {} pixels are too many",
            volume.grid(),
            size.width,
            size.height
        );
        return Err(Error::Unsupported(message));
    }
    let mut image = RadianceImage::new(size)?;
    let pixels = image.as_mut_slice().as_chunks_mut::<4>().0;
    let mut row = vec![0.0; 3 * columns as usize];
    for (z, y) in (0..layers).flat_map(|z| (0..rows).map(move |y| (z, y))) {
        volume.read_row(y, z, &mut row);
        let begin = (z / across * rows + y) * size.width + z % across * columns;
        let pixels = &mut pixels[begin as usize..][..columns as usize];
        for (pixel, [red, green, blue]) in pixels.iter_mut().zip(row.as_chunks::<3>().0) {
            *pixel = [*red, *green, *blue, red.max(*green).max(*blue)];
        }
    }
    Ok(image)
}
