//! Buffers of Blosc 1 (its README_CHUNK_FORMAT): blocks of LZ4 streams (the LZ4 block format), whose bytes are sorted
//! by their places in numbers. Nothing is written beyond the length that is asked for.

const HEADER: usize = 16;
const LZ4: u8 = 1;

/// Streams of a block are as many as bytes of a number, unless they would be shorter than that.
const SHORTEST: usize = 128;
const MOST_STREAMS: usize = 16;

type Unpacked = Result<Vec<u8>, String>;

/// Unpacks a buffer that is to have such a length.
pub(super) fn unpacked(packed: &[u8], length: usize) -> Unpacked {
    let cut = || "its Blosc is cut short, or damaged".to_owned();
    let header: &[u8; HEADER] = packed.first_chunk().ok_or_else(cut)?;
    let word = |at: usize| -> Option<usize> {
        let bytes: &[u8; 4] = packed.get(at..)?.first_chunk()?;
        Some(u32::from_le_bytes(*bytes) as usize)
    };
    let (flags, size) = (header[2], usize::from(header[3]).max(1));
    let (bytes, block) = (word(4).unwrap_or(0), word(8).unwrap_or(0));
    if bytes != length || block == 0 {
        return Err(cut());
    }
    if flags & 2 != 0 {
        let copied = packed.get(HEADER..HEADER + length).ok_or_else(cut)?;
        return Ok(copied.to_vec());
    }
    if flags >> 5 != LZ4 || flags & 4 != 0 {
        return Err("its Blosc is not LZ4; write it with zip".to_owned());
    }
    let mut all = Vec::with_capacity(length);
    for (number, begin) in (0..length).step_by(block).enumerate() {
        let of_block = block.min(length - begin);
        let is_split = flags & 16 == 0
            && size <= MOST_STREAMS
            && block / size >= SHORTEST
            && of_block == block;
        let streams = if is_split { size } else { 1 };
        let mut at = word(HEADER + 4 * number).ok_or_else(cut)?;
        let mut sorted = Vec::with_capacity(of_block);
        for _ in 0..streams {
            let of_stream = of_block / streams;
            let packed_length = word(at).ok_or_else(cut)?;
            let end = (at + 4).checked_add(packed_length).ok_or_else(cut)?;
            let stream = packed.get(at + 4..end).ok_or_else(cut)?;
            match packed_length == of_stream {
                true => sorted.extend_from_slice(stream),
                false => lz4(stream, of_stream, &mut sorted).ok_or_else(cut)?,
            }
            at = end;
        }
        if sorted.len() != of_block {
            return Err(cut());
        }
        match flags & 1 != 0 && size > 1 {
            true => unsort(&sorted, size, &mut all),
            false => all.extend_from_slice(&sorted),
        }
    }
    Ok(all)
}

/// Puts the bytes of numbers side by side again; what is less than a number stays behind them.
fn unsort(sorted: &[u8], size: usize, all: &mut Vec<u8>) {
    let count = sorted.len() / size;
    for number in 0..count {
        all.extend((0..size).map(|byte| sorted[byte * count + number]));
    }
    all.extend_from_slice(&sorted[count * size..]);
}

/// Unpacks a stream of so many bytes behind what is there; `None`: it is damaged.
fn lz4(stream: &[u8], length: usize, to: &mut Vec<u8>) -> Option<()> {
    let begin = to.len();
    let mut bytes = stream.iter().copied();
    let long = |bytes: &mut dyn Iterator<Item = u8>, short: usize| -> Option<usize> {
        let mut length = short;
        if short == 15 {
            loop {
                let more = bytes.next()?;
                length = length.checked_add(usize::from(more))?;
                if more < 255 {
                    break;
                }
            }
        }
        Some(length)
    };
    while to.len() - begin < length {
        let token = bytes.next()?;
        let literals = long(&mut bytes, usize::from(token >> 4))?;
        if literals > length - (to.len() - begin) || literals > bytes.len() {
            return None;
        }
        to.extend(bytes.by_ref().take(literals));
        if bytes.len() == 0 {
            break;
        }
        let offset = usize::from(u16::from_le_bytes([bytes.next()?, bytes.next()?]));
        let copied = long(&mut bytes, usize::from(token & 15))?.checked_add(4)?;
        if offset == 0 || offset > to.len() - begin || copied > length - (to.len() - begin) {
            return None;
        }
        for _ in 0..copied {
            to.push(to[to.len() - offset]);
        }
    }
    (to.len() - begin == length).then_some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_repeat_what_they_had_and_never_more_than_is_asked_for() {
        // "abc", then 9 bytes from 3 before, then "x".
        let stream = [0x35, b'a', b'b', b'c', 3, 0, 0x10, b'x'];
        let mut to = vec![7];
        assert_eq!(lz4(&stream, 13, &mut to), Some(()));
        assert_eq!(to, b"\x07abcabcabcabcx");
        for length in [0, 3, 11, 14] {
            let mut to = Vec::new();
            assert!(lz4(&stream, length, &mut to).is_none() || length == 0);
            assert!(to.len() <= length);
        }
        assert_eq!(
            lz4(&[0x35, b'a', b'b', b'c', 4, 0], 13, &mut Vec::new()),
            None
        );
    }
}
