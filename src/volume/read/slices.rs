//! Pictures of slices, painted one by one (asked for in Sakai 2006, section 6): sorted by name, the first that of the
//! lowest z.

use std::fs;
use std::path::{Path, PathBuf};

use super::super::texture::{Storage, Texture, TextureOrigin, check_cells, check_room, count};
use crate::error::{Error, Result, SceneError};
use crate::image::{ImageSize, RadianceImage};
use crate::shown::shown;

pub(super) fn open(pattern: &Path) -> Result<Texture> {
    let fault = |message: String| Error::Scene(SceneError::value("slices", message));
    let files = named(pattern).map_err(fault)?;
    let mut size: Option<ImageSize> = None;
    let mut values: [Vec<f32>; 3] = Default::default();
    for file in &files {
        let image = read(file)?;
        let ImageSize { width, height } = *size.get_or_insert(image.size());
        let name = file.display().to_string();
        if image.size() != (ImageSize { width, height }) {
            let other = image.size();
            return Err(fault(format!(
                "{} has {}x{} pixels, those before it {width}x{height}: all are to have one size",
                shown(&name),
                other.width,
                other.height
            )));
        }
        let cells = [width, height, files.len() as u32];
        if values[0].is_empty() {
            check_cells(cells).map_err(fault)?;
            check_room(cells, 6)?;
            values.iter_mut().for_each(|it| it.reserve(count(cells)));
        }
        // Rows of pictures run down, y upwards.
        for row in image.as_slice().chunks_exact(4 * width as usize).rev() {
            for (channel, values) in values.iter_mut().enumerate() {
                values.extend(row.as_chunks::<4>().0.iter().map(|pixel| pixel[channel]));
            }
        }
    }
    let ImageSize { width, height } = size.unwrap_or_default();
    let texture = Texture::checked(
        [width, height, files.len() as u32],
        values.concat(),
        Storage::Emission,
    );
    let texture = texture.map_err(fault)?;
    Ok(texture.with_origin(TextureOrigin::Slices(full(pattern))))
}

/// Reads a picture: RGB that its alpha is multiplied with.
fn read(file: &Path) -> Result<RadianceImage> {
    let is_exr = file
        .extension()
        .is_some_and(|it| it.eq_ignore_ascii_case("exr"));
    let image = match is_exr {
        true => RadianceImage::open(file),
        false => RadianceImage::open_picture(file),
    };
    image.map_err(|error| match error {
        Error::OutOfMemory(_) => error,
        other => Error::Scene(SceneError::value("slices", other.to_string())),
    })
}

/// Returns the files whose names fit a path with one `*` in its name, sorted.
pub(super) fn named(pattern: &Path) -> std::result::Result<Vec<PathBuf>, String> {
    let name = pattern.file_name().unwrap_or_default().to_string_lossy();
    let text = pattern.display().to_string();
    let Some((before, after)) = name.split_once('*') else {
        return Err(format!(
            "{}: the names of slices have a * where they differ, such as \"slices/*.png\"",
            shown(&text)
        ));
    };
    let folder = pattern.parent().unwrap_or(Path::new(""));
    let here = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    let entries = fs::read_dir(here).map_err(|error| {
        format!(
            "{}: cannot read: {error}",
            shown(&here.display().to_string())
        )
    })?;
    let fits = |name: &str| {
        let has_room = name.len() >= before.len() + after.len();
        has_room && name.starts_with(before) && name.ends_with(after)
    };
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|name| fits(name)).collect();
    names.sort();
    match names.is_empty() {
        true => Err(format!("{}: no file has such a name", shown(&text))),
        false => Ok(names.into_iter().map(|name| folder.join(name)).collect()),
    }
}

/// Returns the pattern from the root.
fn full(pattern: &Path) -> PathBuf {
    let folder = pattern.parent().unwrap_or(Path::new(""));
    let here = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    match (fs::canonicalize(here), pattern.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => pattern.to_owned(),
    }
}
