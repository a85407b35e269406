//! Holds tone maps of colours to their published constants, written down anew in float64 as the shaders have them, and
//! every tone map to what all must do: black stays black, more light is no darker, nothing leaves `[0,1]`.

use energywave::RadianceImage;
use energywave::glam::{DMat3, DVec3};
use energywave::image::{Display, Exposure, ImageSize, ToneMap};

const ALL: [ToneMap; 6] = [
    ToneMap::Clamp,
    ToneMap::Exponential,
    ToneMap::Reinhard,
    ToneMap::Aces,
    ToneMap::Agx,
    ToneMap::KhronosNeutral,
];

/// Half a step of eight bits is for rounding.
const WITHIN: f64 = 0.5 / 255.0;

/// Dark, bright, hot and saturated light of many hues, linear RGB.
const COLORS: [[f32; 3]; 26] = [
    [0.0, 0.0, 0.0],
    [1e-6, 1e-6, 1e-6],
    [0.001, 0.002, 0.004],
    [0.01, 0.01, 0.01],
    [0.05, 0.02, 0.3],
    [0.07, 0.5, 0.9],
    [0.09, 0.5, 0.9],
    [0.18, 0.18, 0.18],
    [0.5, 0.5, 0.5],
    [0.79, 0.6, 0.2],
    [0.8, 0.8, 0.8],
    [1.0, 1.0, 1.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.15, 0.35, 1.0],
    [1.2, 2.8, 8.0],
    [2.4, 5.6, 16.0],
    [9.0, 0.9, 0.1],
    [0.2, 12.0, 0.4],
    [7.0, 0.3, 5.0],
    [16.0, 16.0, 16.0],
    [40.0, 1.0, 1.0],
    [0.0, 0.0, 200.0],
    [1000.0, 700.0, 30.0],
    [1e6, 1e6, 1e6],
];

/// three.js's `AgXToneMapping`. Its matrices are given by their columns.
fn agx(color: DVec3) -> DVec3 {
    let to_rec2020 = DMat3::from_cols(
        DVec3::new(0.6274, 0.0691, 0.0164),
        DVec3::new(0.3293, 0.9195, 0.0880),
        DVec3::new(0.0433, 0.0113, 0.8956),
    );
    let from_rec2020 = DMat3::from_cols(
        DVec3::new(1.6605, -0.1246, -0.0182),
        DVec3::new(-0.5876, 1.1329, -0.1006),
        DVec3::new(-0.0728, -0.0083, 1.1187),
    );
    let inset = DMat3::from_cols(
        DVec3::new(0.856627153315983, 0.137318972929847, 0.11189821299995),
        DVec3::new(0.0951212405381588, 0.761241990602591, 0.0767994186031903),
        DVec3::new(0.0482516061458583, 0.101439036467562, 0.811302368396859),
    );
    let outset = DMat3::from_cols(
        DVec3::new(
            1.1271005818144368,
            -0.1413297634984383,
            -0.14132976349843826,
        ),
        DVec3::new(
            -0.11060664309660323,
            1.157823702216272,
            -0.11060664309660294,
        ),
        DVec3::new(
            -0.016493938717834573,
            -0.016493938717834257,
            1.2519364065950405,
        ),
    );
    let (least, most) = (-12.47393, 4.026069);
    let light = (inset * (to_rec2020 * color)).max(DVec3::splat(1e-10));
    let x = (light.map(f64::log2) - least) / (most - least);
    let x = x.clamp(DVec3::ZERO, DVec3::ONE);
    let (x2, x4) = (x * x, x * x * x * x);
    let y =
        15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x
            - 0.00232;
    let y = (outset * y).max(DVec3::ZERO).powf(2.2);
    (from_rec2020 * y).clamp(DVec3::ZERO, DVec3::ONE)
}

/// The GLSL of Khronos's specification.
fn neutral(mut color: DVec3) -> DVec3 {
    let start_compression = 0.8 - 0.04;
    let x = color.min_element();
    color -= if x < 0.08 { x - 6.25 * x * x } else { 0.04 };
    let peak = color.max_element();
    if peak < start_compression {
        return color;
    }
    let d = 1.0 - start_compression;
    let new_peak = 1.0 - d * d / (peak + d - start_compression);
    color *= new_peak / peak;
    let g = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
    color.lerp(DVec3::splat(new_peak), g)
}

fn encoded(linear: f64) -> f64 {
    match linear <= 0.0031308 {
        true => 12.92 * linear,
        false => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
    }
}

fn shown(map: ToneMap, color: [f32; 3]) -> DVec3 {
    DVec3::from(map.apply(color).map(f64::from))
}

/// The largest difference over the table from what a map should give, as a screen shows it.
fn off(map: ToneMap, expected: fn(DVec3) -> DVec3) -> f64 {
    let differences = COLORS.map(|color| {
        let expected = expected(DVec3::from(color.map(f64::from))).map(encoded);
        (shown(map, color).map(encoded) - expected)
            .abs()
            .max_element()
    });
    differences.into_iter().fold(0.0, f64::max)
}

#[test]
fn agx_and_khronos_neutral_are_their_published_shaders_on_a_table_of_colours() {
    let found = [
        off(ToneMap::Agx, agx),
        off(ToneMap::KhronosNeutral, neutral),
    ];
    println!("{found:?} of 1");
    assert!(found.iter().all(|off| *off < WITHIN), "{found:?}");
    // What the specification says in words: colours to 0.8 lose 0.04, and no more.
    let kept = shown(ToneMap::KhronosNeutral, [0.79, 0.5, 0.2]) - DVec3::new(0.75, 0.46, 0.16);
    assert!(kept.length() < 1e-6);
    // AgX's middle grey is encoded 0.5 by the power 2.2, within the error of its polynomial.
    let grey = shown(ToneMap::Agx, [0.18; 3]).x.powf(1.0 / 2.2);
    assert!((grey - 0.5).abs() < 0.03, "{grey}");
    // Others than these are not taken for them.
    for other in [ToneMap::Aces, ToneMap::KhronosNeutral, ToneMap::Exponential] {
        assert!(off(other, agx) > 4.0 * WITHIN);
    }
    assert!(off(ToneMap::Agx, neutral) > 4.0 * WITHIN);
}

/// The angle of a colour around the greys, radians, in a plane of equal hue for the eye (IPT's P and T; Ebner and
/// Fairchild 1998).
fn hue(linear: DVec3) -> f64 {
    let lms = DMat3::from_cols(
        DVec3::new(0.3139, 0.1552, 0.0177),
        DVec3::new(0.6395, 0.7572, 0.1095),
        DVec3::new(0.0465, 0.0867, 0.8727),
    ) * linear;
    let lms = lms.powf(0.43);
    let p = 4.4550 * lms.x - 4.8510 * lms.y + 0.3960 * lms.z;
    let t = 0.8056 * lms.x + 0.3572 * lms.y - 1.1628 * lms.z;
    t.atan2(p)
}

/// How white light of many hues comes out six stops over 1, as its least channel of what is shown, and how far a hue
/// moves at most on the way while it is seen, radians.
fn way_to_white(map: ToneMap) -> (f64, f64) {
    let (mut whitest, mut moved) = (1.0_f64, 0.0_f64);
    for color in [
        [1.0, 0.1, 0.1],
        [0.1, 1.0, 0.15],
        [0.15, 0.35, 1.0],
        [1.0, 0.35, 0.05],
        [0.6, 0.1, 1.0],
    ] {
        let of = |stops: f32| shown(map, color.map(|channel: f32| channel * stops.exp2()));
        whitest = whitest.min(of(6.0).map(encoded).min_element());
        for stops in 0..16 {
            let found = of(0.25 * stops as f32);
            let chroma = found.max_element() - found.min_element();
            if chroma > 0.1 {
                let turn = (hue(found) - hue(DVec3::from(color.map(f64::from)))).abs();
                moved = moved.max(turn.min(std::f64::consts::TAU - turn));
            }
        }
    }
    (whitest, moved)
}

#[test]
fn hot_saturated_light_goes_to_white_and_keeps_its_hue_by_agx() {
    let [agx, neutral, clamp, exponential, aces] = [
        ToneMap::Agx,
        ToneMap::KhronosNeutral,
        ToneMap::Clamp,
        ToneMap::Exponential,
        ToneMap::Aces,
    ]
    .map(way_to_white);
    println!(
        "agx {agx:?}, neutral {neutral:?}, clamp {clamp:?}, exponential {exponential:?}, aces {aces:?}"
    );
    assert!(agx.0 > 0.8 && agx.1 < 0.3);
    for other in [clamp, exponential, aces] {
        assert!(other.1 > 2.0 * agx.1, "{other:?}");
    }
}

#[test]
fn every_tone_map_rises_from_black_to_at_most_white() {
    for map in ALL {
        assert_eq!(map.apply([0.0; 3]), [0.0; 3], "{map:?}");
        assert_eq!(map.apply([-1.0; 3]), [0.0; 3], "{map:?}");
        let mut before = 0.0;
        for i in 0..400 {
            let [red, green, blue] = map.apply([1.05_f32.powi(i) * 1e-3; 3]);
            assert!(red >= before && red <= 1.0, "{map:?} {i}: {red}");
            assert!(
                (red - green).abs() < 0.004 && (red - blue).abs() < 0.004,
                "{map:?} {i}"
            );
            before = red;
        }
        assert!(before > 0.99, "{map:?}: {before}");
        for endless in [
            [f32::INFINITY; 3],
            [f32::INFINITY, 0.0, 0.0],
            [f32::NAN, 1.0, f32::MAX],
        ] {
            assert!(
                map.apply(endless)
                    .iter()
                    .all(|channel| (0.0..=1.0).contains(channel)),
                "{map:?}"
            );
        }
    }
    assert!((ToneMap::Exponential.apply([1.0; 3])[0] - 0.632_120_6).abs() < 1e-6);
    assert!((ToneMap::Reinhard.apply([3.0; 3])[0] - 0.75).abs() < 1e-6);
}

#[test]
fn a_picture_has_each_pixels_colour_mapped_within_a_step() {
    let size = ImageSize {
        width: COLORS.len() as u32,
        height: 1,
    };
    let mut image = RadianceImage::new(size).unwrap();
    for (pixel, color) in image.as_mut_slice().chunks_exact_mut(4).zip(COLORS) {
        // Two stops of exposure make the table's colours.
        pixel.copy_from_slice(&[color[0] / 4.0, color[1] / 4.0, color[2] / 4.0, 1.0]);
    }
    let picture = image.tone_map(&Display {
        exposure: Exposure::Stops(2.0),
        ..Display::default()
    });
    for (bytes, color) in picture.as_slice().chunks_exact(3).zip(COLORS) {
        let expected = 255.0 * agx(DVec3::from(color.map(f64::from))).map(encoded);
        let found = DVec3::new(bytes[0].into(), bytes[1].into(), bytes[2].into());
        assert!(
            (found - expected).abs().max_element() <= 1.001,
            "{color:?}: {found} {expected}"
        );
    }
}
