//! The environment variables of the program: what of them counts for nothing is said.

use energywave::{KernelCache, shown};

use super::warn;

/// Those that there are. What those of tests are called has a word of its own.
const KNOWN: [&str; 5] = [
    "ENERGYWAVE_BUILD_OPTIONS",
    "ENERGYWAVE_CACHE",
    "ENERGYWAVE_CACHE_DIR",
    "ENERGYWAVE_DEVICE",
    "ENERGYWAVE_FORM",
];
const OF_TESTS: &str = "ENERGYWAVE_TEST_";

/// Warns of variables that are of no use: with an unknown name, or an unknown value.
pub fn check() {
    for (name, _) in std::env::vars_os() {
        let name = name.to_string_lossy();
        let is_ours = name.starts_with("ENERGYWAVE_") && !name.starts_with(OF_TESTS);
        if is_ours && !KNOWN.contains(&&*name) {
            warn(&format!(
                "{}: no such environment variable; there are {}",
                shown(&name),
                KNOWN.join(", ")
            ));
        }
    }
    for fault in KernelCache::environment_faults() {
        warn(&fault);
    }
}
