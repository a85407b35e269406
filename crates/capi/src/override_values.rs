//! What takes the place of values of a scene's text.

use std::ffi::c_char;

use energywave::image::ImageSize;
use energywave::scene::{Antialias, Method, MethodKeys, Sampling, Scene};

use crate::border::{self, Versioned};
use crate::status::{Outcome, bad_argument};

/// What takes the place of values of a scene's text; what is 0 or NULL leaves them.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Overrides {
    /// `sizeof` of this struct.
    pub struct_size: usize,
    /// Width of the image, pixels; with a height.
    pub width: u32,
    /// Height of the image, pixels.
    pub height: u32,
    /// `exact`, `simpson` or `jittered`.
    pub method: *const c_char,
    /// `tiles` or `pixels`; asks for `exact` where no method is named.
    pub sampling: *const c_char,
    /// `footprint` or `none`.
    pub antialias: *const c_char,
    /// The relative error that `exact` aims at; asks for it where no method is named.
    pub tolerance: f64,
    /// Divisions of `simpson` (even) or `jittered`; asks for a sum where no method is named.
    pub divisions: u32,
    /// 0.
    pub reserved: u32,
}

// SAFETY: it begins with its size, and its fields are numbers and addresses.
unsafe impl Versioned for Overrides {}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum MethodName {
    Exact,
    Simpson,
    Jittered,
}

/// The same, understood.
#[derive(Debug, Clone, Copy, Default)]
pub struct Values {
    size: Option<ImageSize>,
    method: Option<MethodName>,
    sampling: Option<Sampling>,
    antialias: Option<Antialias>,
    tolerance: Option<f64>,
    divisions: Option<u32>,
}

impl Overrides {
    /// # Safety
    /// Its texts are NULL, or end with a 0.
    pub unsafe fn read(&self) -> Outcome<Values> {
        let size = match (self.width, self.height) {
            (0, 0) => None,
            (width, height) if width > 0 && height > 0 => Some(ImageSize { width, height }),
            (width, height) => {
                let reason = format!("{width}x{height} pixels; give both, or 0 for both");
                return Err(bad_argument("overrides.width", &reason));
            }
        };
        let methods = [
            ("exact", MethodName::Exact),
            ("simpson", MethodName::Simpson),
            ("jittered", MethodName::Jittered),
        ];
        let samplings = [("tiles", Sampling::Tiles), ("pixels", Sampling::Pixels)];
        let looks = [
            ("footprint", Antialias::Footprint),
            ("none", Antialias::None),
        ];
        // SAFETY: the caller's promise, three times.
        let (method, sampling, antialias) = unsafe {
            (
                word(self.method, "overrides.method", &methods)?,
                word(self.sampling, "overrides.sampling", &samplings)?,
                word(self.antialias, "overrides.antialias", &looks)?,
            )
        };
        let is_sum = matches!(method, Some(MethodName::Simpson | MethodName::Jittered));
        if is_sum && sampling == Some(Sampling::Tiles) {
            let reason = "tiles is for the method exact; the others take every pixel";
            return Err(bad_argument("overrides.sampling", reason));
        }
        Ok(Values {
            size,
            method,
            sampling,
            antialias,
            tolerance: (self.tolerance != 0.0).then_some(self.tolerance),
            divisions: (self.divisions != 0).then_some(self.divisions),
        })
    }
}

/// # Safety
/// The pointer is NULL, or points to a text that ends with a 0.
unsafe fn word<T: Copy>(
    pointer: *const c_char,
    name: &str,
    words: &[(&str, T)],
) -> Outcome<Option<T>> {
    // SAFETY: the caller's promise.
    let Some(given) = unsafe { border::optional_text(pointer, name) }? else {
        return Ok(None);
    };
    match words.iter().find(|(word, _)| *word == given) {
        Some((_, value)) => Ok(Some(*value)),
        None => {
            let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            let given = energywave::shown(given);
            let reason = format!("\"{given}\" is none; use {}", known.join(", "));
            Err(bad_argument(name, &reason))
        }
    }
}

impl Values {
    /// Puts the values into a scene; `keys` is what its text says of all methods.
    pub fn apply(&self, scene: &mut Scene, keys: &MethodKeys) {
        scene.image = self.size.unwrap_or(scene.image);
        scene.integration.antialias = self.antialias.unwrap_or(scene.integration.antialias);
        scene.integration.method = self.method(scene.integration.method, keys);
    }

    fn method(&self, of_scene: Method, keys: &MethodKeys) -> Method {
        let asks_sum = self.divisions.is_some();
        let asks_exact = self.tolerance.is_some() || self.sampling.is_some();
        let of_scene = match of_scene {
            Method::Simpson { .. } => MethodName::Simpson,
            Method::Jittered { .. } => MethodName::Jittered,
            _ => MethodName::Exact,
        };
        let name = match self.method {
            Some(name) => name,
            // Naming divisions asks for a sum of so many; naming a tolerance asks for it to be met.
            None if asks_sum == asks_exact => of_scene,
            None if asks_exact => MethodName::Exact,
            None if of_scene == MethodName::Exact => MethodName::Simpson,
            None => of_scene,
        };
        let divisions = self.divisions.unwrap_or(keys.divisions);
        match name {
            MethodName::Simpson => Method::Simpson { divisions },
            MethodName::Jittered => Method::Jittered {
                divisions,
                seed: keys.seed,
            },
            MethodName::Exact => Method::Exact {
                tolerance: self.tolerance.unwrap_or(keys.tolerance),
                sampling: self.sampling.unwrap_or(keys.sampling),
            },
        }
    }
}
