//! Built kernels on disk, for drivers that keep none: some compile for seconds at every start.
//!
//! An entry is a file `KEY.KIND` in a folder that only the user can write to. Its body follows a seal, the hash of
//! everything that must fit together; an entry with another seal counts as missing, because a driver may accept a
//! damaged binary and compute wrong results.

use std::fs::{self, DirBuilder, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use etcetera::BaseStrategy;
use sha2::{Digest, Sha256};

use super::{OpenClDevice, ProgramKey};
use crate::shown::{shown, shown_path};

/// Environment variable that replaces the default choice, [`KernelCache::WhereMissing`]: `always` or `never`.
const CHOICE_VARIABLE: &str = "ENERGYWAVE_CACHE";

/// Environment variable with another folder for the entries.
const FOLDER_VARIABLE: &str = "ENERGYWAVE_CACHE_DIR";

/// Platforms whose drivers cache what they compile: PoCL, NVIDIA, Mesa, Intel GPU (two names), Apple.
const KEEP_THEIR_OWN: [&str; 6] = [
    "Portable Computing Language",
    "NVIDIA CUDA",
    "rusticl",
    "Intel(R) OpenCL Graphics",
    "Intel(R) OpenCL HD Graphics",
    "Apple",
];

/// How an entry begins; the last byte is the version of the format.
const FORMAT: &[u8; 8] = b"ewcache\x01";

/// The size of all entries together; beyond it those that were unused for longest are removed. One has 1 to 3 MB.
const MOST_BYTES: u64 = 256 << 20;

/// Whether built kernels are kept on disk for the next start: in the folder that the environment variable
/// `ENERGYWAVE_CACHE_DIR` names, else in `energywave` in the user's folder for caches. A folder that is not the user's
/// own, or that others can write to, is not used. A fault of the folder or its files is no error: the kernels are built
/// again.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum KernelCache {
    /// For drivers that are not known to keep a cache of their own, unless the environment variable `ENERGYWAVE_CACHE`
    /// is `always` or `never`.
    #[default]
    WhereMissing,
    /// For every driver but a simulator's.
    Always,
    /// For none.
    Never,
}

impl KernelCache {
    /// Returns the folder for a device's kernels, if they are to be kept.
    pub(super) fn folder(self, device: &OpenClDevice) -> Option<Folder> {
        let variable = std::env::var(CHOICE_VARIABLE).unwrap_or_default();
        let keeps = self.keeps(&variable, device.platform.trim()) && !device.is_simulator;
        keeps.then(Folder::of_user).flatten()
    }

    /// Says what the environment asks for that cannot be done, and is not: one text for each variable at fault.
    #[must_use]
    pub fn environment_faults() -> Vec<String> {
        let choice = std::env::var_os(CHOICE_VARIABLE).unwrap_or_default();
        let folder = std::env::var_os(FOLDER_VARIABLE).unwrap_or_default();
        let (choice, folder) = (choice.to_string_lossy(), Path::new(&folder));
        let mut faults = Vec::new();
        if !["", "always", "never"].contains(&&*choice) {
            faults.push(format!(
                "{CHOICE_VARIABLE}: \"{}\" is no choice and counts for nothing; write always or never",
                shown(&choice)
            ));
        }
        if folder.exists() && !is_private(folder) {
            faults.push(format!(
                "{FOLDER_VARIABLE}: {} is no folder of your own that others cannot write to; no kernel is kept there",
                shown_path(folder)
            ));
        }
        faults
    }

    fn keeps(self, variable: &str, platform: &str) -> bool {
        match (self, variable) {
            (Self::Always, _) | (Self::WhereMissing, "always") => true,
            (Self::Never, _) | (Self::WhereMissing, "never") => false,
            (Self::WhereMissing, _) => !KEEP_THEIR_OWN.contains(&platform),
        }
    }
}

/// A folder of entries. It is made when the first is written.
#[derive(Debug)]
pub(super) struct Folder(PathBuf);

impl Folder {
    /// Returns the user's folder: the one named by the environment, else the usual one.
    pub(super) fn of_user() -> Option<Self> {
        let named = std::env::var_os(FOLDER_VARIABLE).filter(|name| !name.is_empty());
        let usual = || Some(etcetera::choose_base_strategy().ok()?.cache_dir());
        named
            .map(PathBuf::from)
            .or_else(|| Some(usual()?.join("energywave")))
            .map(Self)
    }

    /// Reads the body of an entry; `None` if there is none that fits.
    pub(super) fn read(&self, key: ProgramKey, kind: &str) -> Option<Vec<u8>> {
        if !is_private(&self.0) {
            return None;
        }
        let path = self.path(key, kind);
        let bytes = fs::read(&path).ok()?;
        let (found, body) = bytes.strip_prefix(FORMAT)?.split_at_checked(32)?;
        if *found != seal(key, kind, body) {
            return None;
        }
        let _ = touch(&path); // else it is only removed sooner
        Some(body.to_vec())
    }

    /// Writes an entry beside its place and moves it there.
    ///
    /// # Errors
    /// If the folder is another's or cannot be made, or the file cannot be written; then nothing is left behind.
    pub(super) fn write(&self, key: ProgramKey, kind: &str, body: &[u8]) -> io::Result<()> {
        create_private(&self.0)?;
        if !is_private(&self.0) {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        let mut file = tempfile::Builder::new()
            .prefix(&format!("{key}."))
            .suffix(".tmp")
            .tempfile_in(&self.0)?; // which no other user can read
        for part in [FORMAT, &seal(key, kind, body)[..], body] {
            file.write_all(part)?;
        }
        let path = self.path(key, kind);
        let _ = fs::remove_dir(&path); // an empty folder would stand in the way
        file.persist(path).map_err(|error| error.error)?;
        self.remove_oldest(MOST_BYTES);
        Ok(())
    }

    fn path(&self, key: ProgramKey, kind: &str) -> PathBuf {
        self.0.join(format!("{key}.{kind}"))
    }

    fn remove_oldest(&self, most_bytes: u64) {
        let files = fs::read_dir(&self.0).into_iter().flatten();
        let mut entries: Vec<(SystemTime, u64, PathBuf)> = files
            .filter_map(io::Result::ok)
            .filter(|file| is_entry(file.file_name().as_encoded_bytes()))
            .filter_map(|file| {
                let found = file.metadata().ok()?;
                Some((found.modified().ok()?, found.len(), file.path()))
            })
            .collect();
        entries.sort_unstable();
        let mut total = 0;
        for (_, length, path) in entries.iter().rev() {
            total += length;
            if total > most_bytes {
                let _ = fs::remove_file(path); // another process may have been faster
            }
        }
    }
}

/// Returns the hash of all that must fit together in an entry.
fn seal(key: ProgramKey, kind: &str, body: &[u8]) -> [u8; 32] {
    let mut hash = Sha256::new();
    hash.update(FORMAT);
    hash.update(key.0);
    hash.update((kind.len() as u64).to_le_bytes());
    hash.update(kind);
    hash.update(body);
    hash.finalize().into()
}

/// Returns whether a file is ours, if only begun; others in the folder are left alone.
fn is_entry(name: &[u8]) -> bool {
    name.len() > 64 && name[64] == b'.' && name[..64].iter().all(u8::is_ascii_hexdigit)
}

fn touch(path: &Path) -> io::Result<()> {
    let file = File::options().write(true).open(path)?;
    file.set_modified(SystemTime::now())
}

pub(super) fn create_private(folder: &Path) -> io::Result<()> {
    let mut builder = DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.recursive(true).create(folder)
}

/// Returns whether a folder exists, is the user's own, and is not writable by others: whoever writes entries runs code
/// here.
#[cfg(unix)]
pub(super) fn is_private(folder: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let user = rustix::process::geteuid().as_raw();
    fs::metadata(folder)
        .is_ok_and(|found| found.is_dir() && found.uid() == user && found.mode() & 0o022 == 0)
}

#[cfg(not(unix))]
pub(super) fn is_private(folder: &Path) -> bool {
    folder.is_dir()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::opencl::discover;

    const KEY: ProgramKey = ProgramKey([7; 32]);

    /// Returns a folder that is not made yet, in one that is removed with the first value.
    fn folder() -> (tempfile::TempDir, Folder) {
        let parent = tempfile::tempdir().unwrap();
        let folder = Folder(parent.path().join("of caches/energywave"));
        (parent, folder)
    }

    #[test]
    fn drivers_with_a_cache_of_their_own_need_none() {
        use KernelCache::{Always, Never, WhereMissing};
        let (with, without) = ("Portable Computing Language", "Intel(R) OpenCL");
        assert!(WhereMissing.keeps("", without) && !WhereMissing.keeps("", with));
        assert!(WhereMissing.keeps("always", with) && !WhereMissing.keeps("never", without));
        assert!(Always.keeps("never", with) && !Never.keeps("always", without));
        let mut device = discover().devices.swap_remove(0);
        assert!(Always.folder(&device).is_some());
        device.is_simulator = true;
        assert!(Always.folder(&device).is_none());
    }

    #[test]
    fn an_entry_is_read_as_it_was_written_under_its_key_and_kind_only() {
        let (_parent, folder) = folder();
        assert_eq!(folder.read(KEY, "bin"), None);
        for body in [&b"first"[..], b"the second is longer", b""] {
            folder.write(KEY, "bin", body).unwrap();
            assert_eq!(folder.read(KEY, "bin").unwrap(), body);
        }
        let other = ProgramKey([8; 32]);
        fs::copy(folder.path(KEY, "bin"), folder.path(other, "bin")).unwrap();
        fs::copy(folder.path(KEY, "bin"), folder.path(KEY, "tested")).unwrap();
        assert_eq!(folder.read(other, "bin"), None);
        assert_eq!(folder.read(KEY, "tested"), None);
    }

    #[test]
    fn an_entry_with_any_byte_flipped_or_cut_off_or_added_counts_as_missing() {
        let (_parent, folder) = folder();
        folder.write(KEY, "bin", b"body").unwrap();
        let path = folder.path(KEY, "bin");
        let right = fs::read(&path).unwrap();
        let mut wrong: Vec<Vec<u8>> = (0..right.len()).map(|at| right[..at].to_vec()).collect();
        wrong.push([&right[..], b"+"].concat());
        for bit in 0..8 * right.len() {
            let mut bytes = right.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            wrong.push(bytes);
        }
        for bytes in wrong {
            fs::write(&path, &bytes).unwrap();
            assert_eq!(folder.read(KEY, "bin"), None, "{bytes:?}");
        }
        fs::write(&path, &right).unwrap();
        assert_eq!(folder.read(KEY, "bin").unwrap(), b"body");
    }

    #[test]
    fn no_folder_can_be_made_below_a_file() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let folder = Folder(file.path().join("energywave"));
        assert!(folder.write(KEY, "bin", b"body").is_err());
        assert_eq!(folder.read(KEY, "bin"), None);
    }

    #[cfg(unix)]
    #[test]
    fn a_write_that_fails_midway_leaves_nothing() {
        const FULL: &str = "ENERGYWAVE_TEST_FULL_DISK";
        if let Some(path) = std::env::var_os(FULL) {
            let written = Folder(path.into()).write(KEY, "bin", &[0; 100_000]);
            println!("as on a full disk: {:?}", written.map_err(|e| e.kind()));
            return;
        }
        let (_parent, folder) = folder();
        // A limit on the size of files stands for a full disk: it too stops a write after some kilobytes.
        let output = std::process::Command::new("sh")
            .args(["-c", "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\""])
            .arg(std::env::current_exe().unwrap())
            .args(["--nocapture", "a_write_that_fails_midway_leaves_nothing"])
            .env(FULL, &folder.0)
            .output()
            .unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains("disk: Err(FileTooLarge)"), "{said}");
        assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 0);
    }

    #[test]
    fn writers_and_readers_at_once_see_whole_entries() {
        let (_parent, folder) = folder();
        let bodies: Vec<Vec<u8>> = (0..4).map(|byte| vec![byte; 100_000]).collect();
        std::thread::scope(|scope| {
            for body in &bodies {
                scope.spawn(|| {
                    for _ in 0..50 {
                        folder.write(KEY, "bin", body).unwrap();
                        assert!(bodies.contains(&folder.read(KEY, "bin").unwrap()));
                    }
                });
            }
        });
        assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 1);
    }

    #[test]
    fn the_entries_unused_for_longest_go_first_and_other_files_stay() {
        let (_parent, folder) = folder();
        let keys: Vec<ProgramKey> = (0..4).map(|byte| ProgramKey([byte; 32])).collect();
        for (age, key) in (1..).zip(&keys) {
            folder.write(*key, "bin", &[0; 1000]).unwrap();
            let file = File::options().write(true).open(folder.path(*key, "bin"));
            let time = SystemTime::now() - Duration::from_secs(100 * age);
            file.unwrap().set_modified(time).unwrap();
        }
        let other = folder.0.join("notes.txt");
        fs::write(&other, [0; 5000]).unwrap();
        assert!(folder.read(keys[3], "bin").is_some()); // now the youngest
        folder.remove_oldest(2500);
        let is_left = |key: &ProgramKey| folder.read(*key, "bin").is_some();
        let left: Vec<bool> = keys.iter().map(is_left).collect();
        assert_eq!(left, [true, false, false, true]);
        assert!(other.exists());
    }

    #[cfg(unix)]
    #[test]
    fn folder_and_entries_are_the_users_alone_and_no_other_folder_is_used() {
        use std::os::unix::fs::{PermissionsExt, chown};
        let (_parent, folder) = folder();
        folder.write(KEY, "bin", b"body").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode(&folder.0), 0o700);
        assert_eq!(mode(&folder.path(KEY, "bin")), 0o600);
        for mode in [0o720, 0o702, 0o777] {
            fs::set_permissions(&folder.0, PermissionsExt::from_mode(mode)).unwrap();
            assert_eq!(folder.read(KEY, "bin"), None);
            assert!(folder.write(KEY, "bin", b"other").is_err());
        }
        fs::set_permissions(&folder.0, PermissionsExt::from_mode(0o755)).unwrap();
        assert_eq!(folder.read(KEY, "bin").unwrap(), b"body");
        // Only root can give a folder away; for others root's will do.
        match chown(&folder.0, Some(12345), None) {
            Ok(()) => assert!(folder.write(KEY, "bin", b"other").is_err()),
            Err(_) => assert!(!is_private(Path::new("/usr"))),
        }
    }
}
