//! PoCL's threads, one to a core.

/// Asks PoCL to keep each of its threads on a core of its own (`POCL_AFFINITY`), unless the user has chosen. On two
/// cores one run in four otherwise has both threads on one core for good, and small frames take twice as long.
///
/// # Safety
/// It changes the environment: no other thread may run yet. Call it first in `main`.
pub unsafe fn keep_pocl_threads_apart() {
    const VARIABLE: &str = "POCL_AFFINITY";
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    if std::env::var_os(VARIABLE).is_none() && may_use_first_cores(&status) {
        // SAFETY: the caller promises that no other thread runs.
        unsafe { std::env::set_var(VARIABLE, "1") };
    }
}

/// Returns whether the process may use the cores from 0 to some number: PoCL counts them from 0 and fails on one that
/// it may not use.
fn may_use_first_cores(status: &str) -> bool {
    let list = status
        .lines()
        .find_map(|line| line.strip_prefix("Cpus_allowed_list:"));
    list.is_some_and(|list| list.trim().starts_with("0-") && !list.contains(','))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_pinned_only_where_the_first_cores_are_ours() {
        let allowed =
            |list: &str| may_use_first_cores(&format!("Name:\tx\nCpus_allowed_list:\t{list}\n"));
        assert!(allowed("0-1") && allowed("0-63"));
        assert!(!allowed("2-3") && !allowed("0-1,4-5") && !allowed("0,2") && !allowed("0"));
        assert!(!may_use_first_cores(""));
    }
}
