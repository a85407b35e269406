//! Random numbers that are functions of what they belong to, so that no order of work changes them: Philox 4x32-10
//! (Salmon, Moraes, Dror, Shaw 2011). The key is the seed, the counter names particle, wave and purpose.

/// What random numbers are for: those of one purpose do not change with what another needs.
#[derive(Debug, Clone, Copy)]
#[repr(u32)]
pub(super) enum Purpose {
    /// Where on the disc and when in its frame a particle is emitted.
    Emission = 0,
    /// Which pattern it joins.
    Pattern = 1,
    /// How fast it flies away, and how long it lives.
    Motion = 2,
    /// Where around its control point it flies to.
    Target = 3,
}

/// 2^-24.
const UNIT: f64 = 1.0 / 16_777_216.0;

/// Returns four numbers in [0,1) of a particle of a wave.
pub(super) fn units(seed: u32, particle: u32, wave: u32, purpose: Purpose) -> [f64; 4] {
    let words = philox([particle, wave, purpose as u32, 0], [seed, 0]);
    words.map(|word| f64::from(word >> 8) * UNIT)
}

fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..10 {
        let [a, b, c, d] = counter;
        let (low_a, high_a) = product(0xd251_1f53, a);
        let (low_c, high_c) = product(0xcd9e_8d57, c);
        counter = [high_c ^ b ^ key[0], low_c, high_a ^ d ^ key[1], low_a];
        key = [
            key[0].wrapping_add(0x9e37_79b9),
            key[1].wrapping_add(0xbb67_ae85),
        ];
    }
    counter
}

/// Returns the low and the high word of a product.
fn product(a: u32, b: u32) -> (u32, u32) {
    let product = u64::from(a) * u64::from(b);
    (product as u32, (product >> 32) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn philox_gives_the_numbers_that_its_authors_publish() {
        // Random123, kat_vectors.
        for (counter, key, expected) in [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [u32::MAX; 4],
                [u32::MAX; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ] {
            assert_eq!(philox(counter, key), expected);
        }
    }
}
