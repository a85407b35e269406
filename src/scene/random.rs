//! Random numbers that are functions of what they belong to: the mixer of SplitMix64 (Steele, Lea, Flood 2014) over the
//! words that name a number.

/// 2^-53: words of 53 bits become numbers in [0,1).
const UNIT: f64 = 1.0 / (1_u64 << 53) as f64;

/// Returns the random word that these words name.
pub(super) fn word(words: impl IntoIterator<Item = u64>) -> u64 {
    words.into_iter().fold(0, |state, word| {
        let mut z = (state ^ word).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}

/// Returns the number in [0,1) that these words name.
pub(super) fn unit(words: impl IntoIterator<Item = u64>) -> f64 {
    (word(words) >> 11) as f64 * UNIT
}
