//! The host's memory, where the system reports it (Linux): the machine's, what a container grants of it (cgroups), and
//! what the process may address (`ulimit -v`).

mod cgroup;

use std::path::Path;

/// Returns the memory in bytes: the machine's, or the container's if it has less.
pub(crate) fn total_bytes() -> Option<u64> {
    let root = Path::new("/");
    let machine = entry(root, "proc/meminfo", "MemTotal:");
    let granted = cgroup::limits(root).into_iter().map(|it| it.most_bytes);
    machine.into_iter().chain(granted).min()
}

/// Returns the memory that can be taken without swapping and beyond no limit, in bytes.
#[cfg(feature = "files")]
pub(crate) fn available_bytes() -> Option<u64> {
    Some(available(Path::new("/"))?.bytes)
}

/// Fewer bytes are not asked for: looking takes longer than making a frame of a small scene.
const LITTLE: u64 = 1 << 20;

/// Says, where so many bytes are not to be had, how many are, and what limits them.
pub(crate) fn shortage(needed: u64) -> Option<String> {
    if needed < LITTLE {
        return None;
    }
    let available = available(Path::new("/"))?;
    (needed > available.bytes).then(|| available.too_little_for(needed))
}

/// Memory that can be taken.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Available {
    bytes: u64,
    /// What limits it, if it is not the machine.
    limit: Option<String>,
}

impl Available {
    fn too_little_for(&self, needed: u64) -> String {
        let limit = match &self.limit {
            Some(limit) => format!(" ({limit})"),
            None => String::new(),
        };
        let needed = needed.div_ceil(1 << 20);
        format!(
            "{needed} MiB needed, {} MiB available{limit}",
            self.bytes >> 20
        )
    }
}

/// Returns the least of what the machine, every cgroup and the process' own limit leave; `root` is `/` but in tests.
fn available(root: &Path) -> Option<Available> {
    let machine =
        entry(root, "proc/meminfo", "MemAvailable:").map(|bytes| Available { bytes, limit: None });
    let granted = cgroup::limits(root).into_iter().map(|it| Available {
        bytes: it.most_bytes.saturating_sub(it.used_bytes),
        limit: Some(format!(
            "the container grants {} MiB, of which {} are in use: {}",
            it.most_bytes >> 20,
            it.used_bytes.div_ceil(1 << 20),
            it.file
        )),
    });
    let addressed = address_space(root).map(|(most, used)| Available {
        bytes: most.saturating_sub(used),
        limit: Some(format!(
            "the process may address {} MiB, of which {} are in use: ulimit -v",
            most >> 20,
            used.div_ceil(1 << 20)
        )),
    });
    let all = machine.into_iter().chain(granted).chain(addressed);
    all.min_by_key(|it| it.bytes)
}

/// Returns how much the process may address and does, bytes; `None` where there is no limit.
fn address_space(root: &Path) -> Option<(u64, u64)> {
    let limits = std::fs::read_to_string(root.join("proc/self/limits")).ok()?;
    let line = limits
        .lines()
        .find_map(|it| it.strip_prefix("Max address space"))?;
    let most = line.split_whitespace().next()?.parse().ok()?;
    let used = entry(root, "proc/self/status", "VmSize:")?;
    Some((most, used))
}

/// Reads an entry in KiB of a table of the system's, as bytes.
fn entry(root: &Path, file: &str, name: &str) -> Option<u64> {
    let table = std::fs::read_to_string(root.join(file)).ok()?;
    let line = table.lines().find_map(|line| line.strip_prefix(name))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    kibibytes.checked_mul(1 << 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Makes a root folder of these files.
    pub(super) fn root(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (path, text) in files {
            let path = folder.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        folder
    }

    const MACHINE: (&str, &str) = (
        "proc/meminfo",
        "MemTotal: 8192000 kB\nMemAvailable: 4096000 kB\n",
    );

    #[test]
    fn the_least_limit_counts_and_is_named() {
        let free = root(&[MACHINE]);
        let found = available(free.path()).unwrap();
        assert_eq!(
            found,
            Available {
                bytes: 4_096_000 << 10,
                limit: None
            }
        );
        assert_eq!(
            found.too_little_for(5 << 30),
            "5120 MiB needed, 4000 MiB available"
        );

        let limits = "Limit Soft Hard\nMax address space  2097152000  unlimited  bytes\n";
        let status = "Name:\tx\nVmSize:\t  102400 kB\n";
        let limited = [
            MACHINE,
            ("proc/self/limits", limits),
            ("proc/self/status", status),
        ];
        let found = available(root(&limited).path()).unwrap();
        assert_eq!(found.bytes, 1900 << 20);
        assert_eq!(
            found.too_little_for(2 << 30),
            "2048 MiB needed, 1900 MiB available (the process may address 2000 MiB, of which 100 are in use: ulimit -v)"
        );
        let unlimited = limits.replace("2097152000", "unlimited");
        let unlimited = [
            MACHINE,
            ("proc/self/limits", unlimited.as_str()),
            ("proc/self/status", status),
        ];
        assert_eq!(available(root(&unlimited).path()).unwrap().limit, None);

        let grouped = [
            &limited[..],
            &[
                ("proc/self/cgroup", "0::/\n"),
                (
                    "proc/self/mountinfo",
                    "31 23 0:28 / /sys/fs/cgroup rw - cgroup2 cgroup2 rw\n",
                ),
                ("sys/fs/cgroup/memory.max", "1048576000\n"),
                ("sys/fs/cgroup/memory.current", "524288000\n"),
                (
                    "sys/fs/cgroup/memory.stat",
                    "anon 1\ninactive_file 104857600\n",
                ),
            ],
        ];
        let found = available(root(&grouped.concat()).path()).unwrap();
        assert_eq!(found.bytes, 600 << 20);
        assert_eq!(
            found.limit.unwrap(),
            "the container grants 1000 MiB, of which 400 are in use: /sys/fs/cgroup/memory.max"
        );
        assert_eq!(available(root(&[]).path()), None);
    }

    #[test]
    #[cfg(feature = "files")]
    fn this_machine_tells_its_memory() {
        if !Path::new("/proc/meminfo").exists() {
            return;
        }
        let (total, available) = (total_bytes().unwrap(), available_bytes().unwrap());
        assert!(available > 0 && available <= total.max(available));
        assert!(shortage(1).is_none());
        assert!(shortage(u64::MAX).unwrap().contains("MiB available"));
    }
}
