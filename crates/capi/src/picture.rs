//! Rows of pixels in the caller's memory, and what is made of their light: pictures of 8 bits, and files.

use std::ffi::c_char;

use energywave::image::{Alpha, Display, ImageSize};
use energywave::{RadianceImage, Scene};

use crate::border;
use crate::renderer::flag;
use crate::scene::{SceneHandle, scene_of};
use crate::status::{Outcome, Status, bad_argument, guarded};

/// Rows of pixels, as values of some type.
#[derive(Debug, Clone, Copy)]
pub struct Rows {
    /// All values of the memory.
    pub values: usize,
    /// Values of a row.
    pub row: usize,
    /// Values from the beginning of a row to that of the next.
    pub stride: usize,
}

impl Rows {
    /// Checks that an image has its place in so many bytes. Its rows begin `stride` bytes after each other; 0: without
    /// a gap.
    pub fn new<T>(
        size: ImageSize,
        channels: usize,
        (bytes, stride): (usize, usize),
        name: &str,
    ) -> Outcome<Self> {
        let row = channels * size.width as usize * size_of::<T>();
        let stride = if stride == 0 { row } else { stride };
        if stride < row || !stride.is_multiple_of(size_of::<T>()) {
            let multiple = match size_of::<T>() {
                1 => String::new(),
                bytes => format!("a multiple of {bytes} and "),
            };
            let reason =
                format!("row_stride of {stride} bytes; it must be {multiple}at least {row}");
            return Err(bad_argument(name, &reason));
        }
        let before_last = (size.height as usize)
            .saturating_sub(1)
            .saturating_mul(stride);
        let needed = before_last.saturating_add(row);
        if bytes < needed {
            let (width, height) = (size.width, size.height);
            let reason = format!(
                "{bytes} bytes; {width}x{height} pixels in rows {stride} apart need {needed}"
            );
            return Err(bad_argument(name, &reason));
        }
        Ok(Self {
            values: needed / size_of::<T>(),
            row: row / size_of::<T>(),
            stride: stride / size_of::<T>(),
        })
    }

    /// Returns whether its rows have no gap.
    pub fn is_tight(&self) -> bool {
        self.row == self.stride
    }

    /// Copies rows without gaps into those.
    pub fn fill<T: Copy>(&self, target: &mut [T], source: &[T]) {
        let rows = target.chunks_mut(self.stride);
        for (target, source) in rows.zip(source.chunks_exact(self.row)) {
            target[..self.row].copy_from_slice(source);
        }
    }
}

/// Copies the caller's light, linear RGBA, into an image.
///
/// # Safety
/// `light` points to so many bytes, or is NULL.
unsafe fn image_of(
    scene: &Scene,
    light: *const f32,
    (bytes, stride): (usize, usize),
) -> Outcome<RadianceImage> {
    let rows = Rows::new::<f32>(scene.image, 4, (bytes, stride), "rgba")?;
    // SAFETY: the caller's promise.
    let light = unsafe { border::values(light, rows.values, "rgba") }?;
    let mut image = RadianceImage::new(scene.image)?;
    let targets = image.as_mut_slice().chunks_exact_mut(rows.row);
    for (target, source) in targets.zip(light.chunks(rows.stride)) {
        target.copy_from_slice(&source[..rows.row]);
    }
    Ok(image)
}

/// Returns a scene's display, for light that may have its bloom.
fn display_of(scene: &Scene, has_bloom: u32) -> Outcome<Display> {
    let mut display = scene.display.clone();
    if flag(has_bloom, "has_bloom")? {
        display.bloom = None;
    }
    Ok(display)
}

/// Makes of light, linear RGBA in float32, a picture of 8-bit sRGB by the scene's display: bloom, exposure, tone
/// mapping, background. `channels` is 3, or 4 with a straight alpha, which is 255 unless the scene's display asks for
/// `alpha = "luminance"`. `has_bloom` is 1 if the renderer has spread it. Strides are bytes from row to row; 0: no gap.
///
/// # Safety
/// `rgba` points to `rgba_bytes` bytes, `picture` to `picture_bytes`, and they do not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_tone_map(
    scene: *const SceneHandle,
    rgba: *const f32,
    rgba_bytes: usize,
    rgba_row_stride: usize,
    has_bloom: u32,
    picture: *mut u8,
    picture_bytes: usize,
    picture_row_stride: usize,
    channels: u32,
) -> Status {
    guarded(|| {
        let scene = scene_of(scene)?;
        let mut display = display_of(&scene, has_bloom)?;
        display.bits = None;
        match channels {
            3 => display.alpha = Alpha::Opaque,
            4 => {}
            other => {
                let reason = format!("{other}; it must be 3 or 4");
                return Err(bad_argument("channels", &reason));
            }
        }
        let (channels, place) = (channels as usize, (picture_bytes, picture_row_stride));
        let rows = Rows::new::<u8>(scene.image, channels, place, "picture")?;
        // SAFETY: the caller's promise, twice.
        let (image, target) = unsafe {
            let image = image_of(&scene, rgba, (rgba_bytes, rgba_row_stride))?;
            (image, border::values_mut(picture, rows.values, "picture")?)
        };
        let made = image.tone_map(&display);
        if made.channels() == channels {
            rows.fill(target, made.as_slice());
            return Ok(());
        }
        let opaque = made.as_slice().chunks_exact(3);
        let with_alpha: Vec<u8> = opaque.flat_map(|it| [it[0], it[1], it[2], 255]).collect();
        rows.fill(target, &with_alpha);
        Ok(())
    })
}

/// Writes light, linear RGBA in float32, to a file: `.exr` as it is, `.png`, `.jpg` or `.webp` by the scene's display.
/// It is written to a temporary file and renamed. `has_bloom` is 1 if the renderer has spread it.
///
/// # Safety
/// `rgba` points to `rgba_bytes` bytes; `path` ends with a 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_save(
    scene: *const SceneHandle,
    rgba: *const f32,
    rgba_bytes: usize,
    rgba_row_stride: usize,
    has_bloom: u32,
    path: *const c_char,
) -> Status {
    guarded(|| {
        let scene = scene_of(scene)?;
        let display = display_of(&scene, has_bloom)?;
        // SAFETY: the caller's promise, twice.
        let (path, image) = unsafe {
            let path = border::file(path, "path")?;
            (path, image_of(&scene, rgba, (rgba_bytes, rgba_row_stride))?)
        };
        Ok(image.save(path, &display)?)
    })
}
