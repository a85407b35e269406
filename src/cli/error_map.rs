//! The picture of relative errors: viridis (van der Walt, Smith 2015) over their logarithm, and below it the scale.

use colorous::VIRIDIS;
use energywave::image::ImageSize;
use energywave::{DisplayImage, Error, RadianceImage};

/// Decades of the relative errors at the ends of the scale; what lies beyond has the colour of the end.
const LEAST: i32 = -7;
const GREATEST: i32 = -1;

/// Fewest pixels of the picture's width: seven labels fit. Smaller images are enlarged by a whole number.
const LEAST_WIDTH: usize = 288;

/// Sizes below the map, units of [`Canvas::unit`].
const MARGIN: usize = 10;
const BAR: (usize, usize) = (4, 10); // top and bottom
const LABEL_TOP: usize = 13;
const LEGEND: usize = 22;

const BACKGROUND: [u8; 3] = [24, 24, 24];
const INK: [u8; 3] = [224, 224, 224];

/// Rows of three pixels, the left one the highest bit.
type Glyph = [u8; 5];

/// Returns the characters of the labels, and nothing for others.
fn glyph(character: char) -> Glyph {
    match character {
        '1' => [0b010, 0b110, 0b010, 0b010, 0b111],
        '2' => [0b111, 0b001, 0b111, 0b100, 0b111],
        '3' => [0b111, 0b001, 0b111, 0b001, 0b111],
        '4' => [0b101, 0b101, 0b111, 0b001, 0b001],
        '5' => [0b111, 0b100, 0b111, 0b001, 0b111],
        '6' => [0b111, 0b100, 0b111, 0b101, 0b111],
        '7' => [0b111, 0b001, 0b001, 0b001, 0b001],
        'e' => [0b111, 0b101, 0b111, 0b100, 0b111],
        '-' => [0b000, 0b000, 0b111, 0b000, 0b000],
        _ => [0; 5],
    }
}

/// Draws the errors of the worst channel of each pixel, with a scale.
///
/// # Errors
/// [`Error::Unsupported`] if the picture is too large for an image.
pub fn picture(errors: &RadianceImage) -> Result<DisplayImage, Error> {
    let size = errors.size();
    let longer = size.width.max(size.height).max(1) as usize;
    let factor = LEAST_WIDTH.div_ceil(longer);
    let (width, height) = (size.width as usize * factor, size.height as usize * factor);
    let mut canvas = Canvas::new(width.max(LEAST_WIDTH), height);
    let left = (canvas.width - width) / 2;
    let pixels = errors.as_slice().chunks_exact(4);
    for (index, pixel) in pixels.enumerate() {
        let worst = pixel[..3].iter().copied().fold(0.0, f32::max);
        let (column, row) = (index % size.width as usize, index / size.width as usize);
        let place = (left + column * factor, row * factor);
        canvas.fill(place, (factor, factor), color(worst));
    }
    canvas.legend();
    canvas.into_picture()
}

/// Returns the colour of a relative error.
fn color(error: f32) -> [u8; 3] {
    let decades = f64::from(GREATEST - LEAST);
    let share = (f64::from(error).log10() - f64::from(LEAST)) / decades;
    VIRIDIS.eval_continuous(share.clamp(0.0, 1.0)).as_array()
}

/// The picture while it is drawn.
struct Canvas {
    width: usize,
    /// Where the legend begins.
    map_height: usize,
    /// Pixels of the side of a glyph's pixel.
    unit: usize,
    data: Vec<u8>,
}

impl Canvas {
    fn new(width: usize, map_height: usize) -> Self {
        let unit = (width / 480).max(2);
        let pixels = width * (map_height + LEGEND * unit);
        Self {
            width,
            map_height,
            unit,
            data: BACKGROUND.repeat(pixels),
        }
    }

    fn fill(&mut self, (left, top): (usize, usize), (width, height): (usize, usize), ink: [u8; 3]) {
        for row in top..top + height {
            let begin = 3 * (row * self.width + left);
            self.data[begin..begin + 3 * width].copy_from_slice(&ink.repeat(width));
        }
    }

    /// Draws the scale, a tick and a label for each decade.
    fn legend(&mut self) {
        let unit = self.unit;
        let (left, top) = (MARGIN * unit, self.map_height + BAR.0 * unit);
        let length = self.width - 2 * left;
        let decades = (GREATEST - LEAST) as usize;
        for column in 0..length {
            let share = column as f64 / (length - 1) as f64;
            let error = 10_f64.powf(f64::from(LEAST) + share * decades as f64);
            let height = (BAR.1 - BAR.0) * unit;
            self.fill((left + column, top), (1, height), color(error as f32));
        }
        for decade in 0..=decades {
            let middle = left + decade * (length - 1) / decades;
            let below = self.map_height + BAR.1 * unit;
            self.fill((middle - unit / 2, below), (unit, 2 * unit), INK);
            let label = format!("1e{}", LEAST + decade as i32);
            self.write(&label, middle);
        }
    }

    /// Writes a label, a pixel between its characters.
    fn write(&mut self, label: &str, middle: usize) {
        let unit = self.unit;
        let left = middle - (4 * label.len() - 1) * unit / 2;
        let top = self.map_height + LABEL_TOP * unit;
        for (place, character) in label.chars().enumerate() {
            for (row, bits) in glyph(character).into_iter().enumerate() {
                for column in (0..3).filter(|column| bits >> (2 - column) & 1 == 1) {
                    let x = left + (4 * place + column) * unit;
                    self.fill((x, top + row * unit), (unit, unit), INK);
                }
            }
        }
    }

    fn into_picture(self) -> Result<DisplayImage, Error> {
        let too_large =
            || Error::Unsupported("the error map is too large for a picture".to_owned());
        let height = self.map_height + LEGEND * self.unit;
        let (width, height) = (u32::try_from(self.width), u32::try_from(height));
        let (Ok(width), Ok(height)) = (width, height) else {
            return Err(too_large());
        };
        DisplayImage::from_rgb(ImageSize { width, height }, self.data).ok_or_else(too_large)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // tests fail by panicking
mod tests {
    use super::*;

    const DARKEST: [u8; 3] = [0x44, 0x01, 0x54]; // the first and the last of the published table
    const BRIGHTEST: [u8; 3] = [0xfd, 0xe7, 0x25];

    /// Between two neighbours of the table, to one of which a colour is rounded.
    const NEAR: u8 = 2;

    /// Returns a pixel of a picture.
    fn at(picture: &DisplayImage, column: usize, row: usize) -> [u8; 3] {
        let begin = 3 * (row * picture.size().width as usize + column);
        picture.as_slice()[begin..begin + 3].try_into().unwrap()
    }

    fn map(width: u32, height: u32, worst: &[f32]) -> DisplayImage {
        let mut errors = RadianceImage::new(ImageSize { width, height }).unwrap();
        for (pixel, worst) in errors.as_mut_slice().chunks_exact_mut(4).zip(worst) {
            pixel.copy_from_slice(&[0.5 * worst, *worst, 0.0, 1.0]);
        }
        picture(&errors).unwrap()
    }

    #[test]
    fn an_error_has_the_colour_that_the_scale_has_there() {
        let picture = map(3, 2, &[0.0, 1e-7, 1e-4, 1e-1, 2.0, f32::INFINITY]);
        assert_eq!(
            (picture.size().width, picture.size().height),
            (288, 192 + 44)
        );
        let pixel = |column: usize, row: usize| at(&picture, 96 * column + 48, 96 * row + 48);
        let are_near = |found: [u8; 3], expected: [u8; 3]| {
            let off = found.iter().zip(expected).map(|(a, b)| a.abs_diff(b));
            off.max() <= Some(NEAR)
        };
        let bar = |column: usize| at(&picture, column, 192 + 2 * 6);
        for dark in [pixel(0, 0), pixel(1, 0), bar(20)] {
            assert!(are_near(dark, DARKEST), "{dark:?}");
        }
        for bright in [pixel(0, 1), pixel(1, 1), pixel(2, 1), bar(267)] {
            assert!(are_near(bright, BRIGHTEST), "{bright:?}");
        }
        assert!(are_near(bar(20 + 3 * 247 / 6), pixel(2, 0)));
        assert!(!are_near(bar(20 + 4 * 247 / 6), pixel(2, 0)));
    }

    #[test]
    fn each_decade_has_a_tick_and_a_label_of_its_own() {
        let picture = map(288, 1, &[]);
        let mut labels = Vec::new();
        for decade in 0..=6 {
            let middle = 20 + decade * 247 / 6;
            assert_eq!(at(&picture, middle, 1 + 2 * 10), INK);
            let rows = 1 + 2 * LABEL_TOP..1 + 2 * (LABEL_TOP + 5);
            let label: Vec<[u8; 3]> = rows
                .flat_map(|row| (middle - 15..middle + 15).map(move |column| (column, row)))
                .map(|(column, row)| at(&picture, column, row))
                .collect();
            assert!(label.contains(&INK) && !labels.contains(&label), "{decade}");
            labels.push(label);
        }
    }

    #[test]
    fn small_and_narrow_images_are_enlarged_and_large_ones_are_not() {
        for (size, expected) in [
            ((1, 1), (288, 288)),
            ((1, 300), (288, 300)),
            ((960, 3), (960, 3)),
        ] {
            let picture = map(size.0, size.1, &[]);
            assert_eq!(picture.size().width, expected.0);
            assert_eq!(picture.size().height, expected.1 + 44);
        }
    }
}
