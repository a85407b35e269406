//! What Unix knows of files: owners, links, files without a name.

use std::fs::{File, Metadata};
use std::io;
use std::os::unix::fs::{MetadataExt, fchown};
use std::path::Path;

use rustix::process::geteuid;

/// What became of a file that was to get a name.
#[allow(dead_code)] // where no file is without a name, nothing is done
pub(super) enum Linked {
    Done,
    /// It could not take the place of the old one.
    NotMoved(io::Error),
    /// The system gives no name to a file that has none.
    NotThere,
}

/// Returns whether a new file may take the place of an old one: that has no other name, and its owner can be kept.
pub(super) fn may_replace(old: &Metadata, folder: &Path, new: Option<&File>) -> bool {
    const STICKY: u32 = 0o1000;
    let me = geteuid();
    let is_mine = |owner: u32| me.is_root() || owner == me.as_raw();
    let Ok(folder) = folder.metadata() else {
        return false;
    };
    let is_stuck = folder.mode() & STICKY != 0 && !is_mine(folder.uid());
    let keeps_owner = match new {
        Some(new) => own_like(new, old).is_ok(),
        None => is_mine(old.uid()),
    };
    old.nlink() == 1 && keeps_owner && (!is_stuck || is_mine(old.uid()))
}

/// Gives a file the owner and the group of another.
pub(super) fn own_like(file: &File, other: &Metadata) -> io::Result<()> {
    let now = file.metadata()?;
    match (now.uid(), now.gid()) == (other.uid(), other.gid()) {
        true => Ok(()),
        false => fchown(file, Some(other.uid()), Some(other.gid())),
    }
}

#[cfg(target_os = "linux")]
pub(super) use linux::{link, unnamed_in};

#[cfg(target_os = "linux")]
mod linux {
    use std::fs::{self, File, OpenOptions};
    use std::os::fd::AsRawFd;
    use std::os::unix::fs::OpenOptionsExt;
    use std::path::Path;

    use rustix::fs::{AtFlags, CWD, OFlags, linkat};
    use rustix::io::Errno;

    use super::Linked;

    /// Makes a file that has no name, which is gone with the process; `None` where the file system has none such.
    pub(in super::super) fn unnamed_in(folder: &Path) -> Option<File> {
        let mut options = OpenOptions::new();
        options.read(true).write(true).mode(0o666); // less the user's umask
        options.custom_flags(OFlags::TMPFILE.bits() as i32);
        options.open(folder).ok()
    }

    /// Gives a file that has no name that of `target`. Where there is an old one it has another name first, for the
    /// moment before it is renamed: no call does both.
    pub(in super::super) fn link(
        file: &File,
        folder: &Path,
        target: &Path,
        has_old: bool,
    ) -> Linked {
        let open = format!("/proc/self/fd/{}", file.as_raw_fd());
        let link = |name: &Path| linkat(CWD, open.as_str(), CWD, name, AtFlags::SYMLINK_FOLLOW);
        if !has_old {
            match link(target) {
                Ok(()) => return Linked::Done,
                Err(Errno::EXIST) => {} // since the work began
                Err(_) => return Linked::NotThere,
            }
        }
        for number in 0..1000 {
            let name = folder.join(format!(".energywave-{}-{number}.tmp", std::process::id()));
            match link(&name) {
                Ok(()) => {}
                Err(Errno::EXIST) => continue,
                Err(_) => return Linked::NotThere,
            }
            let Err(error) = fs::rename(&name, target) else {
                return Linked::Done;
            };
            let _ = fs::remove_file(&name); // it was made a moment ago
            return Linked::NotMoved(error);
        }
        Linked::NotThere
    }
}

#[cfg(not(target_os = "linux"))]
pub(super) fn unnamed_in(_: &Path) -> Option<File> {
    None
}

#[cfg(not(target_os = "linux"))]
pub(super) fn link(_: &File, _: &Path, _: &Path, _: bool) -> Linked {
    Linked::NotThere
}
