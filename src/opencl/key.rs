//! What a built program depends on, as one hash.

use std::fmt;

use sha2::{Digest, Sha256};

use super::OpenClDevice;

/// The hash of everything that a built program depends on; `Display` gives it in hexadecimal digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProgramKey(pub(super) [u8; 32]);

impl ProgramKey {
    pub(super) fn new(device: &OpenClDevice, source: &str, options: &str) -> Self {
        let mut hash = Sha256::new();
        for part in [
            env!("CARGO_PKG_VERSION"),
            source,
            options,
            &device.platform,
            &device.platform_version,
            &device.name,
            &device.version,
            &device.driver,
            // Machines that share a folder may give their processors the same name though one has wider vectors.
            &device.lanes.to_string(),
        ] {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        }
        Self(hash.finalize().into())
    }
}

impl fmt::Display for ProgramKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::opencl::discover;

    #[test]
    fn the_key_changes_with_each_of_its_parts() {
        let device = discover().devices.swap_remove(0);
        let key = |change: fn(&mut OpenClDevice), source: &str, options: &str| {
            let mut device = device.clone();
            change(&mut device);
            ProgramKey::new(&device, source, options)
        };
        let keys = [
            key(|_| (), "ab", "c"),
            key(|_| (), "a", "bc"),
            key(|_| (), "ab", "d"),
            key(|_| (), "b", "c"),
            key(|device| device.platform.push('+'), "ab", "c"),
            key(|device| device.platform_version.push('+'), "ab", "c"),
            key(|device| device.name.push('+'), "ab", "c"),
            key(|device| device.version.push('+'), "ab", "c"),
            key(|device| device.driver.push('+'), "ab", "c"),
            key(|device| device.lanes += 1, "ab", "c"),
        ];
        for (index, key) in keys.iter().enumerate() {
            assert!(!keys[..index].contains(key), "part {index}");
        }
        assert_eq!(keys[0], key(|_| (), "ab", "c"));
        assert_eq!(keys[0].to_string().len(), 64);
    }
}
