//! What PoCL needs of a machine and does not ask for: it ends the process where `/sys` or a linker is missing, and
//! builds nothing where its cache cannot be written. So it is asked for nothing there, and a program may mend what an
//! environment can mend.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use super::affinity::keep_pocl_threads_apart;
use super::failure::fault_of;
use super::{DeviceType, OpenClDevice};
use crate::error::Result;

pub(super) const PLATFORM: &str = "Portable Computing Language";

/// Where linkers are on systems whose environment does not say so.
const USUAL_FOLDERS: [&str; 3] = ["/usr/bin", "/usr/local/bin", "/bin"];

/// Sets what PoCL needs, unless the user has chosen what works: its threads' cores ([`keep_pocl_threads_apart`]), the
/// folder of its linker in `PATH`, and with the feature `kernel-cache` a folder for its cache (`POCL_CACHE_DIR`) where
/// the usual one cannot be written. Returns what the user should know of it: one line for each choice of the user's
/// that does not work, or cannot be mended.
///
/// # Safety
/// It changes the environment: no other thread may run yet. Call it first in `main`.
#[must_use]
pub unsafe fn suit_pocl() -> Vec<String> {
    // SAFETY: the caller's promise.
    unsafe { keep_pocl_threads_apart() };
    let path = std::env::var_os("PATH").unwrap_or_default();
    if let Some(longer) = path_with_linker(&path) {
        // SAFETY: the caller promises that no other thread runs.
        unsafe { std::env::set_var("PATH", longer) };
    }
    #[cfg(feature = "kernel-cache")]
    {
        let choice = folder::choose(&|name| std::env::var_os(name));
        if let Some(folder) = choice.folder {
            // SAFETY: the caller promises that no other thread runs.
            unsafe { std::env::set_var(folder::VARIABLE, folder) };
        }
        choice.warning.into_iter().collect()
    }
    #[cfg(not(feature = "kernel-cache"))]
    Vec::new()
}

/// Returns the path with the folder of a linker, where it has none and there is one.
fn path_with_linker(path: &OsStr) -> Option<OsString> {
    if finds_linker(path) {
        return None;
    }
    let usual = USUAL_FOLDERS.into_iter().map(Path::new);
    let folder = usual
        .into_iter()
        .find(|folder| finds_linker(folder.as_os_str()))?;
    let folders = std::env::split_paths(path).filter(|it| !it.as_os_str().is_empty());
    std::env::join_paths(folders.chain([folder.to_owned()])).ok()
}

/// Returns whether a folder of the path has the linker.
fn finds_linker(path: &OsStr) -> bool {
    std::env::split_paths(path).any(|folder| folder.is_absolute() && folder.join("ld").is_file())
}

/// Checks that PoCL can link a kernel: else it would end the process.
///
/// # Errors
/// [`crate::Error::Device`] on a device of PoCL where no linker is to be found.
pub(super) fn check_linker(device: &OpenClDevice) -> Result<()> {
    let is_pocl = device.platform == PLATFORM && device.device_type == DeviceType::Cpu;
    let path = std::env::var_os("PATH").unwrap_or_default();
    if !cfg!(target_os = "linux") || !is_pocl || finds_linker(&path) {
        return Ok(());
    }
    Err(fault_of(
        &device.name,
        "clBuildProgram",
        "not called: PoCL links kernels by `ld`, which no folder of PATH has, and ends the process without".to_owned(),
        "install binutils (Debian, Ubuntu), or add the folder of ld to PATH",
    ))
}

/// Says why PoCL must not be asked for its devices; `None`: it may be.
pub(super) fn ends_process(root: &Path) -> Option<String> {
    let is_missing = |folder: &str| !root.join(folder).exists();
    let has_no_sys = is_missing("sys/devices/system/cpu") && is_missing("sys/bus/cpu");
    (cfg!(target_os = "linux") && has_no_sys).then(|| {
        "PoCL needs /sys, which is not mounted here, and would end the process: mount -t sysfs sys /sys".to_owned()
    })
}

/// Says why PoCL's cache, without which it builds nothing, cannot be written; `None`: it can, or nobody knows.
pub(super) fn cache_fault() -> Option<String> {
    #[cfg(feature = "kernel-cache")]
    return folder::fault_now();
    #[cfg(not(feature = "kernel-cache"))]
    None
}

#[cfg(feature = "kernel-cache")]
mod folder {
    use std::ffi::OsString;
    use std::io::Write;
    use std::path::{Path, PathBuf};

    use crate::opencl::cache::{create_private, is_private};
    use crate::shown::shown_path;

    pub(super) const VARIABLE: &str = "POCL_CACHE_DIR";

    /// What some kernels take, bytes: a folder with less room is full.
    const ROOM: usize = 4 << 20;

    /// Reads an environment variable.
    type Environment<'a> = &'a dyn Fn(&str) -> Option<OsString>;

    /// Another folder for PoCL's cache, if there is need and one, and what the user should know of it.
    #[derive(Debug, Default, PartialEq)]
    pub(super) struct Choice {
        pub folder: Option<PathBuf>,
        pub warning: Option<String>,
    }

    pub(super) fn choose(environment: Environment<'_>) -> Choice {
        let Some(fault) = fault(environment) else {
            return Choice::default();
        };
        let is_usable = |folder: &PathBuf| {
            create_private(folder).is_ok() && is_private(folder) && unwritable(folder).is_none()
        };
        let folder = others(environment).into_iter().find(is_usable);
        let is_chosen = named(environment, VARIABLE).is_some();
        let warning = match &folder {
            Some(folder) if is_chosen => Some(format!("its kernels go to {}", shown_path(folder))),
            Some(_) => None,
            None => Some(format!("set {VARIABLE} to a folder that can be written")),
        };
        let warning = warning.map(|what| format!("PoCL's cache: {fault}; {what}"));
        Choice { folder, warning }
    }

    pub(super) fn fault_now() -> Option<String> {
        let fault = fault(&|name| std::env::var_os(name))?;
        Some(format!(
            "{fault}; set {VARIABLE} to a folder that can be written"
        ))
    }

    /// Says why the folder that PoCL takes cannot be written.
    fn fault(environment: Environment<'_>) -> Option<String> {
        match usual(environment) {
            Some(folder) => {
                let fault = unwritable(&folder)?;
                Some(format!(
                    "{} cannot be written ({fault})",
                    shown_path(&folder)
                ))
            }
            None => Some("neither HOME nor XDG_CACHE_HOME names a folder".to_owned()),
        }
    }

    /// Returns the folder that PoCL takes by itself.
    fn usual(environment: Environment<'_>) -> Option<PathBuf> {
        let in_cache = || Some(named(environment, "XDG_CACHE_HOME")?.join("pocl/kcache"));
        let in_home = || Some(named(environment, "HOME")?.join(".cache/pocl/kcache"));
        named(environment, VARIABLE)
            .or_else(in_cache)
            .or_else(in_home)
    }

    /// Returns places that can mostly be written, the user's own first.
    fn others(environment: Environment<'_>) -> Vec<PathBuf> {
        #[cfg(unix)]
        let user = rustix::process::geteuid().as_raw();
        #[cfg(not(unix))]
        let user = 0;
        let name = format!("energywave-pocl-{user}");
        let own = named(environment, "XDG_RUNTIME_DIR");
        let usual = [std::env::temp_dir(), "/var/tmp".into(), "/dev/shm".into()];
        own.into_iter()
            .chain(usual)
            .map(|folder| folder.join(&name))
            .collect()
    }

    fn named(environment: Environment<'_>, name: &str) -> Option<PathBuf> {
        environment(name)
            .filter(|value| !value.is_empty())
            .map(PathBuf::from)
    }

    /// Says why nothing can be written to a folder, or to the one in which it would be made. Leaves nothing behind.
    fn unwritable(folder: &Path) -> Option<String> {
        let existing = folder.ancestors().find(|folder| folder.exists());
        let write = || {
            let mut file = tempfile::tempfile_in(existing.unwrap_or(folder))?;
            file.write_all(&vec![0; ROOM])
        };
        write().err().map(|error| error.to_string())
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn a_folder_that_can_be_written_is_kept_and_another_takes_the_place_of_one_that_cannot() {
            let parent = tempfile::tempdir().unwrap();
            let good = parent.path().join("good");
            let file = parent.path().join("file");
            std::fs::write(&file, "no folder").unwrap();
            let choose_with = |variables: &[(&str, &Path)]| {
                choose(&|name| {
                    let found = variables.iter().find(|(key, _)| *key == name)?;
                    Some(found.1.as_os_str().to_owned())
                })
            };
            for name in ["HOME", "XDG_CACHE_HOME", VARIABLE] {
                assert_eq!(choose_with(&[(name, &good)]), Choice::default());
                assert!(!good.exists(), "asking leaves nothing");
            }
            let runtime = ("XDG_RUNTIME_DIR", parent.path());
            let unset = choose_with(&[runtime]);
            let ours = unset.folder.unwrap();
            assert!(ours.starts_with(parent.path()) && is_private(&ours));
            assert_eq!(unset.warning, None);
            assert_eq!(
                choose_with(&[("HOME", &file), runtime]).folder,
                Some(ours.clone())
            );
            let chosen = choose_with(&[(VARIABLE, &file), runtime]);
            assert_eq!(chosen.folder, Some(ours.clone()));
            let warning = chosen.warning.unwrap();
            assert!(
                warning.contains("file cannot be written (") && warning.contains("go to"),
                "{warning}"
            );
            // Another's folder is not taken.
            #[cfg(unix)]
            {
                use std::os::unix::fs::PermissionsExt;
                std::fs::set_permissions(&ours, PermissionsExt::from_mode(0o777)).unwrap();
                let folder = choose_with(&[("HOME", &file), runtime]).folder;
                assert_ne!(folder, Some(ours));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_without_a_linker_gets_its_folder_and_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        let empty = folder.path().join("empty");
        std::fs::create_dir(&empty).unwrap();
        assert!(!finds_linker(OsStr::new("")) && !finds_linker(empty.as_os_str()));
        let own = folder.path().join("own");
        std::fs::create_dir(&own).unwrap();
        std::fs::write(own.join("ld"), "").unwrap();
        let both = std::env::join_paths([&empty, &own]).unwrap();
        assert!(finds_linker(&both));
        assert_eq!(path_with_linker(&both), None);
        let mended = path_with_linker(empty.as_os_str());
        if let Some(mended) = &mended {
            assert!(finds_linker(mended));
            assert_eq!(std::env::split_paths(mended).next(), Some(empty));
            assert_eq!(
                std::env::split_paths(&path_with_linker(OsStr::new("")).unwrap()).count(),
                1
            );
        }
        let has_any = USUAL_FOLDERS
            .iter()
            .any(|it| Path::new(it).join("ld").is_file());
        assert_eq!(mended.is_some(), has_any);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn without_sys_pocl_is_not_asked() {
        let root = tempfile::tempdir().unwrap();
        assert!(ends_process(root.path()).unwrap().contains("/sys"));
        std::fs::create_dir_all(root.path().join("sys/devices/system/cpu")).unwrap();
        assert_eq!(ends_process(root.path()), None);
    }
}
