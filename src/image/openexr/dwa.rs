//! The sizes that a chunk of DWAA or DWAB claims: the decoder reserves what they say before it looks at the data.
//! Layout: eleven numbers of 8 bytes, Academy Software Foundation, OpenEXR 3, `internal_dwa_compressor.h`.

use super::Outcome;

/// Checks the sizes against the pixels that the chunk may hold: `size` pixels, `bytes` bytes of all channels.
pub(super) fn check(
    data: &[u8],
    size: (usize, usize),
    channels: usize,
    bytes: usize,
) -> Outcome<()> {
    let (numbers, _) = data.as_chunks::<8>();
    let Some(numbers) = numbers.get(..11) else {
        return Err("damaged: a chunk ends in its head".to_owned());
    };
    let blocks = (size.0.div_ceil(8) * size.1.div_ceil(8) * channels) as u64;
    let bytes = bytes as u64;
    // A run-length code takes at most a byte more for each 127; a block has 64 coefficients, one of them DC.
    let most = [
        (1, "unknown", bytes),
        (6, "run-length coded", 2 * bytes),
        (7, "plain", bytes),
        (8, "AC", 64 * blocks),
        (9, "DC", blocks),
    ];
    for (index, what, most) in most {
        let claimed = u64::from_le_bytes(numbers[index]);
        if claimed > most {
            return Err(format!(
                "damaged: a chunk claims {claimed} {what} values, {most} are the most that it can have"
            ));
        }
    }
    Ok(())
}
