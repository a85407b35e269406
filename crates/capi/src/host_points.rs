//! Points of light in a host's OpenCL buffers.

use std::ffi::c_char;
use std::mem::offset_of;

use energywave::HostPoints;
use energywave::scene::Profile;

use crate::border::{self, Versioned};
use crate::host::ClMem;
use crate::status::{Outcome, bad_argument};

/// Points of light in a host's own buffers, in any number: a particle system lives there. They are drawn as the same
/// `[[points]]` of a scene, to the bit.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Points {
    /// `sizeof` of this struct.
    pub struct_size: usize,
    /// A buffer of float4, one for each point: x, y and z, world units; the fourth is not looked at.
    pub positions: *mut ClMem,
    /// A buffer of float4, one for each point: linear red, green and blue; the fourth is not looked at. NULL: all have
    /// `color`.
    pub lights: *mut ClMem,
    /// How many points there are, from the beginning of the buffers.
    pub count: usize,
    /// What the light of each is multiplied with; it has no other value than what is given, and 0 is no light.
    pub coefficient: f64,
    /// Linear red, green and blue of points that have no lights of their own.
    pub color: [f64; 3],
    /// How their light falls off: `inverse`, `inverse-square` or `smeared`; NULL: `inverse-square`.
    pub profile: *const c_char,
    /// A buffer of float4, one for each point: where it was. Its light lies evenly along the way from there, as of a
    /// spark that flies, and falls off by `inverse`, without a radius; the fourth is not looked at. NULL: points have
    /// not moved.
    pub previous: *mut ClMem,
    /// How thick they are, world units: of `smeared`, which needs one, the standard deviation of a ball of light. Of
    /// the others each is then drawn by itself, which is slow for many; 0: they are points.
    pub radius: f64,
}

// SAFETY: it begins with its size, and its fields are numbers and addresses.
unsafe impl Versioned for Points {
    const FIRST: usize = offset_of!(Points, previous);
}

impl Points {
    /// # Safety
    /// `profile` is NULL, or ends with a 0.
    unsafe fn of_host(&self, name: &str) -> Outcome<HostPoints> {
        let mut points = HostPoints::new(self.positions.cast(), self.count);
        let optional = |buffer: *mut ClMem| (!buffer.is_null()).then_some(buffer.cast());
        points.lights = optional(self.lights);
        points.previous = optional(self.previous);
        (points.coefficient, points.radius) = (self.coefficient, self.radius);
        points.color = self.color.into();
        let name = format!("{name}.profile");
        // SAFETY: the caller's promise.
        let profile = unsafe { border::optional_text(self.profile, &name) }?;
        points.profile = match profile.unwrap_or("inverse-square") {
            "inverse" => Profile::Inverse,
            "inverse-square" => Profile::InverseSquare,
            "smeared" => Profile::Smeared,
            other => {
                let other = energywave::shown(other);
                let reason = format!("\"{other}\" is none; use inverse, inverse-square, smeared");
                return Err(bad_argument(&name, &reason));
            }
        };
        Ok(points)
    }
}

/// Returns what the library is told of points.
///
/// # Safety
/// `points` is NULL, or points to so many structs, each of as many bytes as it says; their texts end with a 0.
pub unsafe fn points_of(points: *const Points, count: u32, name: &str) -> Outcome<Vec<HostPoints>> {
    // SAFETY: the caller's promise.
    let all = unsafe { border::read_structs(points, count, name) }?;
    let of_host = |(index, points): (usize, &Points)| {
        // SAFETY: the same.
        unsafe { points.of_host(&format!("{name}[{index}]")) }
    };
    all.iter().enumerate().map(of_host).collect()
}
