//! The sRGB transfer function (IEC 61966-2-1).

/// Encodes a linear value of `[0,1]`.
pub(crate) fn srgb_encode(linear: f32) -> f32 {
    match linear {
        l if l <= 0.003_130_8 => 12.92 * l,
        l if l < 1.0 => 1.055 * l.powf(1.0 / 2.4) - 0.055,
        _ => 1.0,
    }
}

/// Decodes a value of `[0,1]`.
#[cfg(feature = "files")]
pub(crate) fn srgb_decode(encoded: f32) -> f32 {
    match encoded <= 0.04045 {
        true => encoded / 12.92,
        false => ((encoded + 0.055) / 1.055).powf(2.4),
    }
}
