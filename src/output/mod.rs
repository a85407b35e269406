//! Files that are written. What cannot be written is known before the work; what is there already stays until all of
//! the new is written; and nothing else is ever left, whatever ends the process.
//!
//! A plain file is made aside, without a name where the system has such files (Linux), and gets its name last. What is
//! no plain file (a pipe, a device, standard output) is written through; so is a file that must stay the one it is,
//! because it has other names, another owner, or is mounted.

mod stream;
mod text;
#[cfg(unix)]
mod unix;

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

use stream::{stream, write_through};
pub use text::TextFile;

/// What an encoder writes to.
pub(crate) trait Sink: Write + Seek {}
impl<T: Write + Seek> Sink for T {}

/// An output that is known to be writable.
#[derive(Debug)]
pub(crate) struct Output {
    /// As it was asked for.
    path: PathBuf,
    place: Place,
}

#[derive(Debug)]
enum Place {
    Stdout,
    Stderr,
    /// A pipe or a device.
    Stream(File),
    /// A plain file that must stay the one it is.
    Old(File),
    /// A plain file that takes its place when it is whole.
    Aside(Box<Aside>),
}

#[derive(Debug)]
struct Aside {
    target: PathBuf,
    folder: PathBuf,
    /// A file without a name in that folder, where the system has such files.
    unnamed: Option<File>,
    /// The file that it takes the place of.
    old: Option<(File, Metadata)>,
}

impl Output {
    /// Makes sure that `path` can be written, through links, and changes nothing. A pipe is waited for.
    ///
    /// # Errors
    /// [`Error::Output`] if it is a folder, the folder is missing, or it cannot be written for another reason.
    pub(crate) fn create(path: &Path) -> Result<Self> {
        let place = Place::of(path).map_err(|fault| match fault {
            Fault::Own(reason) => Error::output(path, reason),
            Fault::System(what, error) => {
                Error::output(path, format!("{what}{error}")).caused_by(error)
            }
        })?;
        let path = path.to_owned();
        Ok(Self { path, place })
    }

    /// Writes to standard output.
    pub(crate) fn stdout() -> Self {
        Self {
            path: PathBuf::from("standard output"),
            place: Place::Stdout,
        }
    }

    /// Lets `encode` write everything as it comes: to what is no file at once, so that it must not go back.
    ///
    /// # Errors
    /// As [`Output::write_with`].
    pub(crate) fn stream_with(
        self,
        encode: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
    ) -> Result<()> {
        let written = match self.place {
            Place::Stdout => stream(&mut io::stdout().lock(), encode),
            Place::Stderr => stream(&mut io::stderr().lock(), encode),
            Place::Stream(mut file) => stream(&mut file, encode),
            Place::Old(_) | Place::Aside(_) => return self.write_with(encode),
        };
        written.map_err(|error| Error::output(&self.path, error.to_string()).caused_by(error))
    }

    /// Lets `encode` write everything.
    ///
    /// # Errors
    /// [`Error::Output`] if it cannot be written.
    pub(crate) fn write_with(
        self,
        encode: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
    ) -> Result<()> {
        let is_kept = matches!(self.place, Place::Aside(_));
        let written = match self.place {
            Place::Stdout => write_through(&mut io::stdout().lock(), encode),
            Place::Stderr => write_through(&mut io::stderr().lock(), encode),
            Place::Stream(mut file) => write_through(&mut file, encode),
            Place::Old(file) => file.set_len(0).and_then(|()| write_file(&file, encode)),
            Place::Aside(aside) => aside.write(encode),
        };
        written.map_err(|error| {
            let rest = if is_kept { "; nothing was written" } else { "" };
            Error::output(&self.path, format!("{error}{rest}")).caused_by(error)
        })
    }
}

/// Why an output cannot be written: for a reason of our own, or the system's, after words of ours.
enum Fault {
    Own(String),
    System(String, io::Error),
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::System(String::new(), error)
    }
}

/// Returns whether a path is no plain file, and none that could become one.
pub(crate) fn is_stream(path: &Path) -> bool {
    let meta = fs::metadata(path);
    let is_other = meta.is_ok_and(|meta| !meta.is_file() && !meta.is_dir());
    is_other || is_descriptor(path)
}

/// Returns whether a path is one that the system has for a file that is open already.
fn is_descriptor(path: &Path) -> bool {
    let folders = ["/dev/fd", "/proc/self/fd"];
    let is_numbered = folders
        .iter()
        .any(|folder| path.parent() == Some(Path::new(folder)));
    cfg!(unix)
        && (is_numbered || path == Path::new("/dev/stdout") || path == Path::new("/dev/stderr"))
}

impl Place {
    fn of(path: &Path) -> std::result::Result<Self, Fault> {
        if is_descriptor(path) {
            return Self::of_descriptor(path);
        }
        let names_folder = path.as_os_str().as_encoded_bytes().ends_with(b"/");
        let folder = || Fault::Own("it is a folder".to_owned());
        match fs::metadata(path) {
            Ok(meta) if meta.is_dir() => Err(folder()),
            _ if names_folder => Err(folder()),
            Ok(meta) if !meta.is_file() => {
                Ok(Self::Stream(OpenOptions::new().write(true).open(path)?))
            }
            Ok(meta) => {
                let target = path.canonicalize()?;
                let old = OpenOptions::new()
                    .write(true)
                    .open(&target)
                    .map_err(|error| {
                        Fault::System("it is there and cannot be changed: ".to_owned(), error)
                    })?;
                match Aside::new(target, Some((old.try_clone()?, meta))) {
                    Ok(Some(aside)) => Ok(Self::Aside(Box::new(aside))),
                    _ => Ok(Self::Old(old)),
                }
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let aside = Aside::new(behind_links(path)?, None)?;
                aside
                    .map(|aside| Self::Aside(Box::new(aside)))
                    .ok_or_else(folder)
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Writes on where the process that opened it stopped.
    fn of_descriptor(path: &Path) -> std::result::Result<Self, Fault> {
        match path.file_name().and_then(|name| name.to_str()) {
            Some("stdout" | "1") => Ok(Self::Stdout),
            Some("stderr" | "2") => Ok(Self::Stderr),
            _ => Ok(Self::Stream(OpenOptions::new().append(true).open(path)?)),
        }
    }
}

/// Follows links to a file that is not there yet.
fn behind_links(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_owned();
    // The system refuses longer chains itself.
    for _ in 0..64 {
        match fs::read_link(&target) {
            Ok(link) => target = target.parent().unwrap_or(Path::new("")).join(link),
            Err(_) => break,
        }
    }
    Ok(target)
}

impl Aside {
    /// Makes sure that the folder takes a new file; `None` if the old one has to stay the one it is.
    fn new(
        target: PathBuf,
        old: Option<(File, Metadata)>,
    ) -> std::result::Result<Option<Self>, Fault> {
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        if !folder.is_dir() {
            let name = folder.display();
            return Err(Fault::Own(format!(
                "there is no folder {name}; create it first"
            )));
        }
        let in_folder = |error| Fault::System(format!("folder {}: ", folder.display()), error);
        let unnamed = match unnamed_in(&folder) {
            Some(file) => Some(file),
            // It has no name for longer than a moment.
            None => tempfile::tempfile_in(&folder)
                .map(|_| None)
                .map_err(in_folder)?,
        };
        #[cfg(unix)]
        if let Some((_, meta)) = &old
            && !unix::may_replace(meta, &folder, unnamed.as_ref())
        {
            return Ok(None);
        }
        Ok(Some(Self {
            target,
            folder,
            unnamed,
            old,
        }))
    }

    fn write(mut self, encode: impl FnOnce(&mut dyn Sink) -> io::Result<()>) -> io::Result<()> {
        match self.unnamed.take() {
            Some(file) => {
                write_file(&file, encode)?;
                self.give_name(file)
            }
            None => {
                let named = self.named()?;
                write_file(named.as_file(), encode)?;
                self.rename(named)
            }
        }
    }

    /// Makes a file with a name of its own, for the moment in which it is written.
    fn named(&self) -> io::Result<tempfile::NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".energywave-").suffix(".tmp");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666)); // less the user's umask
        }
        builder.tempfile_in(&self.folder)
    }

    /// Gives the new file the owner and the mode of the old one.
    fn like_the_old(&self, file: &File) -> io::Result<()> {
        #[cfg(unix)]
        if let Some((_, meta)) = &self.old {
            unix::own_like(file, meta)?;
            file.set_permissions(meta.permissions())?;
        }
        let _ = file;
        Ok(())
    }

    /// Gives a written file without a name that of the target.
    fn give_name(&self, mut file: File) -> io::Result<()> {
        if let Err(error) = self.like_the_old(&file) {
            return self.copy_over(&mut file, error);
        }
        #[cfg(unix)]
        match unix::link(&file, &self.folder, &self.target, self.old.is_some()) {
            unix::Linked::Done => return Ok(()),
            unix::Linked::NotMoved(error) => return self.copy_over(&mut file, error),
            unix::Linked::NotThere => {}
        }
        let mut named = self.named()?;
        file.rewind()?;
        io::copy(&mut file, named.as_file_mut())?;
        self.rename(named)
    }

    /// Gives a written file with another name that of the target.
    fn rename(&self, mut named: tempfile::NamedTempFile) -> io::Result<()> {
        if let Err(error) = self.like_the_old(named.as_file()) {
            return self.copy_over(named.as_file_mut(), error);
        }
        match named.persist(&self.target) {
            Ok(_) => Ok(()),
            Err(mut fault) => self.copy_over(fault.file.as_file_mut(), fault.error),
        }
    }

    /// Copies the written file into the old one, where it cannot take its place: that is mounted, or another's.
    fn copy_over(&self, file: &mut File, error: io::Error) -> io::Result<()> {
        let Some((old, _)) = &self.old else {
            return Err(error);
        };
        file.rewind()?;
        old.set_len(0)?;
        let mut target = old;
        io::copy(file, &mut target).map(drop)
    }
}

#[cfg(not(unix))]
fn unnamed_in(_: &Path) -> Option<File> {
    None
}
#[cfg(unix)]
use unix::unnamed_in;

fn write_file(file: &File, encode: impl FnOnce(&mut dyn Sink) -> io::Result<()>) -> io::Result<()> {
    let mut writer = BufWriter::new(file);
    encode(&mut writer)?;
    writer.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(sink: &mut dyn Sink) -> io::Result<()> {
        sink.write_all(b"___ is new")?;
        sink.rewind()?;
        sink.write_all(b"all")
    }

    #[test]
    fn what_cannot_take_the_place_of_the_old_file_is_copied_into_it() {
        let folder = tempfile::tempdir().unwrap();
        let old = folder.path().join("old");
        for has_unnamed in [true, false] {
            let aside = |is_there: bool| Aside {
                target: folder.path().join("none/old"), // to which nothing can be moved
                folder: folder.path().to_owned(),
                unnamed: unnamed_in(folder.path()).filter(|_| has_unnamed),
                old: is_there.then(|| {
                    let file = OpenOptions::new().write(true).open(&old).unwrap();
                    (file, fs::metadata(&old).unwrap())
                }),
            };
            fs::write(&old, "the old text was longer").unwrap();
            aside(true).write(write).unwrap();
            assert_eq!(fs::read(&old).unwrap(), b"all is new");
            assert!(aside(false).write(write).is_err());
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        }
    }

    #[test]
    fn a_new_file_and_one_with_another_name_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        Output::create(&path).unwrap(); // and not written
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        for _ in 0..2 {
            Output::create(&path).unwrap().write_with(write).unwrap();
            assert_eq!(fs::read(&path).unwrap(), b"all is new");
        }
        let fail = |_: &mut dyn Sink| Err(io::ErrorKind::StorageFull.into());
        let error = Output::create(&path).unwrap().write_with(fail).unwrap_err();
        assert!(error.to_string().contains("nothing was written"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"all is new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
