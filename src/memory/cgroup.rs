//! What control groups grant: Linux' cgroup v2 and v1, of which containers are made. A process may be in one that has
//! no limit, in others that have: every level counts.

use std::path::{Path, PathBuf};

/// A limit of one group.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Limit {
    pub most_bytes: u64,
    /// By all processes of the group, but for the cache of files that can be dropped.
    pub used_bytes: u64,
    /// The file that says so.
    pub file: String,
}

/// The names of a version's files.
struct Version {
    /// Beyond these a process is killed, or slowed down until it stands.
    limits: &'static [&'static str],
    used: &'static str,
    /// The entry of `memory.stat` with the cache of files not used lately.
    droppable: &'static str,
}

const V2: Version = Version {
    limits: &["memory.max", "memory.high"],
    used: "memory.current",
    droppable: "inactive_file",
};

const V1: Version = Version {
    limits: &["memory.limit_in_bytes"],
    used: "memory.usage_in_bytes",
    droppable: "total_inactive_file",
};

/// v1 writes the largest number of whole pages for no limit at all.
const NO_LIMIT: u64 = 1 << 62;

/// Returns the limits of all groups that the process is in, of both versions, up to the root that it sees.
pub(super) fn limits(root: &Path) -> Vec<Limit> {
    let read = |file: &str| std::fs::read_to_string(root.join(file)).unwrap_or_default();
    let (groups, mounts) = (read("proc/self/cgroup"), read("proc/self/mountinfo"));
    let mut found = Vec::new();
    for mount in mounts.lines().filter_map(Mount::of) {
        let Some(group) = groups.lines().find_map(|line| mount.group(line)) else {
            continue;
        };
        for folder in mount.folders(group) {
            found.extend(limits_in(root, &folder, mount.version));
        }
    }
    found
}

/// A mounted tree of groups that may limit memory.
struct Mount {
    version: &'static Version,
    /// The group at its root, as `/proc/self/cgroup` names it.
    top: String,
    folder: String,
}

impl Mount {
    /// Reads a line of `/proc/self/mountinfo`: number, parent, device, root, folder, options - type, source, options.
    fn of(line: &str) -> Option<Self> {
        let (mount, kind) = line.split_once(" - ")?;
        let mut mount = mount.split(' ').skip(3);
        let (top, folder) = (unescaped(mount.next()?), unescaped(mount.next()?));
        let mut kind = kind.split(' ');
        let version = match kind.next()? {
            "cgroup2" => &V2,
            "cgroup" if kind.nth(1)?.split(',').any(|option| option == "memory") => &V1,
            _ => return None,
        };
        Some(Self {
            version,
            top,
            folder,
        })
    }

    /// Returns the process' group in this tree by a line of `/proc/self/cgroup`: number, controllers, path.
    fn group<'b>(&self, line: &'b str) -> Option<&'b str> {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?);
        let is_here = match self.version.used == V2.used {
            true => controllers.is_empty(),
            false => controllers.split(',').any(|it| it == "memory"),
        };
        is_here.then_some(path)
    }

    /// Returns the folders of a group and of all above it that are mounted. In a container the group's own name may
    /// not be seen: then the mounted root stands for it.
    fn folders(&self, group: &str) -> Vec<PathBuf> {
        let top = Path::new(&self.folder);
        let inside = Path::new(group)
            .strip_prefix(&self.top)
            .unwrap_or(Path::new(""));
        let own = top.join(inside);
        let ancestors = own.ancestors().take_while(|folder| folder.starts_with(top));
        ancestors.map(Path::to_owned).collect()
    }
}

fn limits_in(root: &Path, folder: &Path, version: &Version) -> Vec<Limit> {
    let inside = root.join(folder.strip_prefix("/").unwrap_or(folder));
    let read = |name: &str| std::fs::read_to_string(inside.join(name)).ok();
    let number = |name: &str| read(name)?.trim().parse::<u64>().ok();
    let limit = |name: &&str| {
        let most_bytes = number(name).filter(|bytes| *bytes < NO_LIMIT)?;
        let stat = read("memory.stat").unwrap_or_default();
        let droppable = stat.lines().find_map(|line| {
            let (name, value) = line.split_once(' ')?;
            (name == version.droppable).then(|| value.trim().parse::<u64>().ok())?
        });
        let used = number(version.used).unwrap_or(0);
        Some(Limit {
            most_bytes,
            used_bytes: used.saturating_sub(droppable.unwrap_or(0)),
            file: folder.join(name).to_string_lossy().into_owned(),
        })
    };
    version.limits.iter().filter_map(limit).collect()
}

/// Returns a path of `mountinfo`, which writes a space as `\040`, and the like.
fn unescaped(path: &str) -> String {
    let mut parts = path.split('\\');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let code = part
            .get(..3)
            .and_then(|code| u8::from_str_radix(code, 8).ok());
        match code {
            Some(code) => {
                text.push(code.into());
                text += &part[3..];
            }
            None => {
                text.push('\\');
                text += part;
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::tests::root;
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<(String, u64, u64)> {
        let root = root(files);
        let limits = limits(root.path()).into_iter();
        limits
            .map(|it| (it.file, it.most_bytes, it.used_bytes))
            .collect()
    }

    const V2_MOUNT: (&str, &str) = (
        "proc/self/mountinfo",
        "20 1 8:1 / / rw - ext4 /dev/sda1 rw\n31 20 0:28 / /sys/fs/cgroup rw,nosuid shared:9 - cgroup2 cgroup2 rw\n",
    );

    #[test]
    fn every_level_of_v2_counts_and_cache_that_can_be_dropped_does_not() {
        let all = found(&[
            V2_MOUNT,
            ("proc/self/cgroup", "0::/user.slice/job\n"),
            ("sys/fs/cgroup/user.slice/job/memory.max", "max\n"),
            ("sys/fs/cgroup/user.slice/job/memory.high", "3000\n"),
            ("sys/fs/cgroup/user.slice/job/memory.current", "1000\n"),
            (
                "sys/fs/cgroup/user.slice/job/memory.stat",
                "file 5\ninactive_file 400\nactive_file 1\n",
            ),
            ("sys/fs/cgroup/user.slice/memory.max", "5000\n"),
            ("sys/fs/cgroup/user.slice/memory.high", "max\n"),
            ("sys/fs/cgroup/user.slice/memory.current", "4500\n"),
            ("sys/fs/cgroup/other/memory.max", "1\n"),
        ]);
        let expected = [
            ("/sys/fs/cgroup/user.slice/job/memory.high", 3000, 600),
            ("/sys/fs/cgroup/user.slice/memory.max", 5000, 4500),
        ];
        assert_eq!(
            all,
            expected.map(|(file, most, used)| (file.to_owned(), most, used))
        );
    }

    #[test]
    fn a_container_of_v1_sees_its_own_group_as_the_root() {
        let group = "12:cpu,cpuacct:/docker/abc\n9:memory:/docker/abc\n0::/system.slice\n";
        let mounts = "40 20 0:30 /docker/abc /sys/fs/cgroup/memory ro - cgroup cgroup rw,memory\n\
                      41 20 0:31 /docker/abc /sys/fs/cgroup/cpu,cpuacct ro - cgroup cgroup rw,cpu,cpuacct\n";
        let all = found(&[
            ("proc/self/cgroup", group),
            ("proc/self/mountinfo", mounts),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "4000\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "3000\n"),
            (
                "sys/fs/cgroup/memory/memory.stat",
                "inactive_file 1\ntotal_inactive_file 2500\n",
            ),
            ("sys/fs/cgroup/cpu,cpuacct/memory.limit_in_bytes", "1\n"),
        ]);
        assert_eq!(
            all,
            [(
                "/sys/fs/cgroup/memory/memory.limit_in_bytes".to_owned(),
                4000,
                500
            )]
        );
    }

    #[test]
    fn the_greatest_number_is_no_limit_and_no_group_has_none() {
        let files = |limit: &'static str| {
            [
                ("proc/self/cgroup", "4:memory:/a\n"),
                (
                    "proc/self/mountinfo",
                    "35 31 0:32 / /mnt/a\\040b rw - cgroup cgroup rw,memory\n",
                ),
                ("mnt/a b/a/memory.limit_in_bytes", limit),
            ]
        };
        assert_eq!(found(&files("9223372036854771712\n")), []);
        assert_eq!(
            found(&files("7000\n")),
            [("/mnt/a b/a/memory.limit_in_bytes".to_owned(), 7000, 0)]
        );
        assert_eq!(found(&[]), []);
        assert_eq!(found(&[V2_MOUNT]), []);
        assert_eq!(unescaped("a\\040b\\011\\x"), "a b\t\\x");
    }
}
