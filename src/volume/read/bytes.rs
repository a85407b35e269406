//! Numbers of files, from bytes.

/// How a number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Byte,
    Short,
    Float,
    Double,
}

impl Number {
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::Byte => 1,
            Self::Short => 2,
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// Reads numbers that lie side by side; whole ones become shares of their greatest.
    pub(super) fn read(self, bytes: &[u8], is_big: bool) -> Vec<f32> {
        let ordered = |number: &[u8]| -> [u8; 8] {
            let mut ordered = [0; 8];
            ordered[..number.len()].copy_from_slice(number);
            if is_big {
                ordered[..number.len()].reverse();
            }
            ordered
        };
        let numbers = bytes.chunks_exact(self.bytes()).map(ordered);
        let value = |[a, b, c, d, e, f, g, h]: [u8; 8]| match self {
            Self::Byte => f32::from(a) / 255.0,
            Self::Short => f32::from(u16::from_le_bytes([a, b])) / 65535.0,
            Self::Float => f32::from_le_bytes([a, b, c, d]),
            Self::Double => f64::from_le_bytes([a, b, c, d, e, f, g, h]) as f32,
        };
        numbers.map(value).collect()
    }
}
