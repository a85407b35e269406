//! Tone mapping: the curves that bring exposed linear light, of the primaries of Rec. 709, into `[0,1]`, still linear.
//!
//! AgX is Troy Sobotka's, in the form that three.js has from Filament and that from Blender: its inset and outset in
//! Rec. 2020, Benjamin Wrensch's polynomial of the sixth degree for its sigmoid ("Minimal AgX Implementation", 2023).
//! three.js, `tonemapping_pars_fragment.glsl.js`, `AgXToneMapping` has the constants.

use serde::{Deserialize, Serialize};

/// A tone-mapping curve. The first four take each channel for itself, and light of one hue may become another's; the
/// others take a colour.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ToneMap {
    /// `min(L, 1)`.
    Clamp,
    /// `1 - exp(-L)`.
    Exponential,
    /// `L / (1 + L)` (Reinhard et al. 2002).
    Reinhard,
    /// The rational fit to the ACES filmic curve by Narkowicz 2015.
    Aces,
    /// AgX (Sobotka 2022), in the form of three.js: light of every hue goes to white as film does, from 4 stops over
    /// 1 on.
    #[default]
    Agx,
    /// The Khronos PBR Neutral Tone Mapper (Khronos Group 2024): colours up to 0.8 stay as they are, less 0.04, and
    /// brighter ones lose their saturation.
    KhronosNeutral,
}

/// Of more light nothing changes any more.
const MOST: f32 = 1e9;

impl ToneMap {
    /// Brings exposed radiance, linear RGB, into `[0,1]`, linear RGB; negative radiance is black.
    #[must_use]
    pub fn apply(self, radiance: [f32; 3]) -> [f32; 3] {
        let light = radiance.map(|channel| match channel > 0.0 {
            true => channel.min(MOST),
            false => 0.0,
        });
        let shown = match self {
            Self::Clamp => light,
            Self::Exponential => light.map(|l| -(-l).exp_m1()),
            Self::Reinhard => light.map(|l| l / (1.0 + l)),
            Self::Aces => light.map(|l| {
                let l = l.min(1e4);
                l * (2.51 * l + 0.03) / (l * (2.43 * l + 0.59) + 0.14)
            }),
            Self::Agx => agx(light),
            Self::KhronosNeutral => khronos_neutral(light),
        };
        shown.map(|channel| channel.clamp(0.0, 1.0))
    }
}

type Matrix = [[f32; 3]; 3];

/// Linear Rec. 709 to Rec. 2020 (ITU-R BT.2407), and back.
const TO_WIDE: Matrix = [
    [0.6274, 0.3293, 0.0433],
    [0.0691, 0.9195, 0.0113],
    [0.0164, 0.0880, 0.8956],
];
const FROM_WIDE: Matrix = [
    [1.6605, -0.5876, -0.0728],
    [-0.1246, 1.1329, -0.0083],
    [-0.0182, -0.1006, 1.1187],
];

/// What takes some saturation from all light, so that no channel is alone, and what gives it back.
const INSET: Matrix = [
    [0.856_627_14, 0.095_121_24, 0.048_251_606],
    [0.137_318_97, 0.761_242, 0.101_439_04],
    [0.111_898_21, 0.076_799_42, 0.811_302_4],
];
const OUTSET: Matrix = [
    [1.127_100_6, -0.110_606_64, -0.016_493_939],
    [-0.141_329_76, 1.157_823_7, -0.016_493_939],
    [-0.141_329_76, -0.110_606_64, 1.251_936_4],
];

/// The range of light, stops from 1: 10 below to 6.5 above a middle grey of 0.18.
const LEAST_STOPS: f32 = -12.473_93;
const MOST_STOPS: f32 = 4.026_069;

fn times(matrix: &Matrix, color: [f32; 3]) -> [f32; 3] {
    let [red, green, blue] = color;
    matrix.map(|row| row[0] * red + row[1] * green + row[2] * blue)
}

fn agx(light: [f32; 3]) -> [f32; 3] {
    let inset = times(&INSET, times(&TO_WIDE, light));
    let formed = inset.map(|l| {
        let stops = l.max(1e-10).log2().clamp(LEAST_STOPS, MOST_STOPS);
        sigmoid((stops - LEAST_STOPS) / (MOST_STOPS - LEAST_STOPS))
    });
    let encoded = times(&OUTSET, formed);
    times(&FROM_WIDE, encoded.map(|l| l.max(0.0).powf(2.2)))
}

/// Returns the contrast curve's value, encoded by the power 1/2.2, at a share of the range of stops.
fn sigmoid(x: f32) -> f32 {
    const TERMS: [f32; 7] = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232];
    TERMS.iter().fold(0.0, |sum, term| sum * x + term)
}

/// Returns what the specification of Khronos's tone mapper gives, by its constants.
fn khronos_neutral(light: [f32; 3]) -> [f32; 3] {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let least = light.into_iter().fold(f32::INFINITY, f32::min);
    let offset = match least < 0.08 {
        true => least - 6.25 * least * least,
        false => 0.04,
    };
    let color = light.map(|l| l - offset);
    let peak = color.into_iter().fold(0.0, f32::max);
    if peak < START {
        return color;
    }
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let kept = 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    color.map(|l| l * (new_peak / peak) * kept + new_peak * (1.0 - kept))
}
