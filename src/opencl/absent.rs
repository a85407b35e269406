//! Why a driver that is installed shows no device, and what to do: drivers say nothing of it themselves.

use std::path::{Path, PathBuf};

use super::pocl;
use crate::shown::{shown, shown_line, shown_path};

/// The least Mesa whose rusticl draws: in 22.3 the first launch of a kernel never ends.
const LEAST_MESA: u32 = 25;

pub(super) const RUSTICL: &str = "rusticl";

/// Says why a platform of this name has no usable device.
pub(super) fn reason(platform: &str) -> String {
    let name = platform.trim();
    if name == pocl::PLATFORM {
        let reason = pocl::ends_process(Path::new("/")).or_else(pocl::cache_fault);
        return reason.unwrap_or_else(|| {
            format!("{name} (PoCL) offers no usable device; is its cache folder, POCL_CACHE_DIR, writable?")
        });
    }
    match name {
        RUSTICL => match std::env::var("RUSTICL_ENABLE") {
            Ok(drivers) if !drivers.is_empty() => format!(
                "rusticl (Mesa) offers no usable device for RUSTICL_ENABLE={}; name the driver of a device that is \
                 here, such as radeonsi, iris or llvmpipe, and see that libclc is installed",
                shown(&drivers)
            ),
            _ => "rusticl (Mesa) shows no device unless RUSTICL_ENABLE names its driver; set it to radeonsi (AMD), \
                  iris (Intel) or llvmpipe (CPU)"
                .to_owned(),
        },
        "Clover" => "Clover (Mesa) offers no usable device; rusticl from Mesa 25 on takes its place".to_owned(),
        name => format!("{} offers no usable device; check its driver", shown(name)),
    }
}

/// Says why a device must not be trusted whatever it computes; `None`: nothing is known against it.
pub(super) fn known_fault(platform: &str, driver: &str) -> Option<String> {
    let driver = driver.trim().trim_start_matches("Mesa ");
    let major = driver.split('.').next()?.parse::<u32>().ok()?;
    (platform.trim() == RUSTICL && major < LEAST_MESA).then(|| {
        format!("Mesa {LEAST_MESA} is the least whose rusticl can draw; of older ones the first launch may never end")
    })
}

/// Says for every driver that the loader is told of and cannot load why that is.
pub(super) fn unloadable() -> Vec<String> {
    driver_files()
        .iter()
        .filter_map(|file| load_fault(file))
        .collect()
}

/// Returns the files that name drivers to the loader.
pub(super) fn driver_files() -> Vec<PathBuf> {
    let named = std::env::var_os("OCL_ICD_VENDORS").filter(|it| !it.is_empty());
    let vendors = named.map_or_else(|| PathBuf::from("/etc/OpenCL/vendors"), PathBuf::from);
    let mut files: Vec<PathBuf> = match std::fs::read_dir(&vendors) {
        Ok(entries) => entries
            .filter_map(|entry| Some(entry.ok()?.path()))
            .collect(),
        Err(_) => vec![vendors],
    };
    files.retain(|file| file.extension().is_some_and(|ending| ending == "icd"));
    files.sort();
    files
}

/// Says why the library that a file of the loader's names cannot be loaded.
fn load_fault(file: &Path) -> Option<String> {
    let text = std::fs::read_to_string(file).ok()?;
    let library = text.lines().map(str::trim).find(|line| !line.is_empty())?;
    let error = match dlopen2::raw::Library::open(library) {
        Ok(library) => {
            std::mem::forget(library); // a driver must not go while the loader uses it
            return None;
        }
        Err(dlopen2::Error::OpeningLibraryError(error)) => error.to_string(),
        Err(error) => error.to_string(),
    };
    let what = match error.contains("libtbb") {
        true => {
            "; it needs oneTBB: install libtbb12 (Debian, Ubuntu) or tbb (PyPI), and name its folder in LD_LIBRARY_PATH"
        }
        false => "; install what it needs, or the driver anew",
    };
    Some(format!(
        "{} names the driver {}, which cannot be loaded ({}){what}",
        shown_path(file),
        shown(library),
        shown_line(&error)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn platforms_without_devices_are_told_what_they_need() {
        assert!(reason("rusticl").contains("RUSTICL_ENABLE"));
        assert!(reason("Clover").contains("Mesa 25"));
        assert!(reason("Voodoo\u{1b}").contains(r"Voodoo\u{1b} offers no usable device"));
        assert!(!reason("Voodoo").contains("RUSTICL_ENABLE"));
    }

    #[test]
    fn rusticl_of_mesa_before_25_is_known_not_to_end() {
        let fault = |platform, driver| known_fault(platform, driver).is_some();
        assert!(fault("rusticl", "22.3.6") && fault("rusticl", "24.9.0-devel"));
        assert!(
            !fault("rusticl", "25.0.0") && !fault("rusticl", "26.2.1") && !fault("rusticl", "?")
        );
        assert!(!fault("Portable Computing Language", "3.1"));
    }

    #[test]
    fn a_driver_that_cannot_be_loaded_is_named_with_its_library_and_why() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("none.icd");
        std::fs::write(&file, "\n/nowhere/libdriver.so\n").unwrap();
        let found = load_fault(&file).unwrap();
        for words in ["none.icd", "/nowhere/libdriver.so", "No such file"] {
            assert!(found.contains(words), "{found}");
        }
        std::fs::write(&file, "").unwrap();
        assert_eq!(load_fault(&file), None);
        #[cfg(target_os = "linux")]
        {
            std::fs::write(&file, "libc.so.6").unwrap();
            assert_eq!(load_fault(&file), None);
        }
    }
}
