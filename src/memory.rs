//! The host's memory, where the system reports it (Linux).

/// Returns the physical memory in bytes.
pub(crate) fn total_bytes() -> Option<u64> {
    entry("MemTotal:")
}

/// Returns the memory that can be taken without swapping, in bytes.
pub(crate) fn available_bytes() -> Option<u64> {
    entry("MemAvailable:")
}

fn entry(name: &str) -> Option<u64> {
    let table = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = table.lines().find(|line| line.starts_with(name))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes << 10)
}
