//! What takes the place of values of a scene's text.

use std::ffi::c_char;

use energywave::scene::{Antialias, MethodName, Overrides as Values, Sampling};

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

impl Overrides {
    /// # Safety
    /// Its texts are NULL, or end with a 0.
    pub unsafe fn read(&self) -> Outcome<Values> {
        let (width, height) = match (self.width, self.height) {
            (0, 0) => (None, None),
            (width, height) if width > 0 && height > 0 => (Some(width), Some(height)),
            (width, height) => {
                let reason = format!("{width}x{height} pixels; give both, or 0 for both");
                return Err(bad_argument("overrides.width", &reason));
            }
        };
        if self.reserved != 0 {
            let reason = format!("{}; it must be 0", self.reserved);
            return Err(bad_argument("overrides.reserved", &reason));
        }
        // SAFETY: the caller's promise, three times.
        let (method, sampling, antialias) = unsafe {
            (
                word(self.method, "overrides.method", &MethodName::WORDS)?,
                word(self.sampling, "overrides.sampling", &Sampling::WORDS)?,
                word(self.antialias, "overrides.antialias", &Antialias::WORDS)?,
            )
        };
        Ok(Values {
            width,
            height,
            method,
            sampling,
            antialias,
            tolerance: (self.tolerance != 0.0).then_some(self.tolerance),
            divisions: (self.divisions != 0).then_some(self.divisions),
            exposure: None,
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
