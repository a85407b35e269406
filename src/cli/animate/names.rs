//! The names of frames: a number in the place that was typed for it, else before the ending.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use energywave::Error;

/// What is said of the name of a folder.
pub const FOLDER: &str = "it is a folder; name the frames in it, such as f.png";

/// Digits of a number that has no place of its own.
const DIGITS: usize = 4;

/// A name of which a part is a frame's number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Names {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl Names {
    /// Finds the place of the number in the last part of a path: `####` or `%04d`; without one it is before the ending.
    ///
    /// # Errors
    /// [`Error::Output`] if it is a folder, or no text.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let names_folder = path.as_os_str().as_encoded_bytes().ends_with(b"/");
        let name = path.file_name().filter(|_| !names_folder);
        let Some(name) = name else {
            return Err(Error::output(path, FOLDER));
        };
        let Some(name) = name.to_str() else {
            return Err(Error::output(
                path,
                "its name is no UTF-8; numbers stand in text",
            ));
        };
        let (before, digits, after) = place(name).unwrap_or_else(|| {
            let ending = Path::new(name).extension().and_then(OsStr::to_str);
            let length = ending.map_or(0, |ending| ending.len() + 1);
            let (stem, ending) = name.split_at(name.len() - length);
            (format!("{stem}."), DIGITS, ending.to_owned())
        });
        Ok(Self {
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            before,
            digits,
            after,
        })
    }

    /// Returns the path of a frame.
    pub fn path(&self, frame: u32) -> PathBuf {
        let Self {
            before,
            digits,
            after,
            ..
        } = self;
        self.folder.join(format!("{before}{frame:0digits$}{after}"))
    }
}

/// Finds the last place for a number in a name: what is before it, its digits, and what is after it.
fn place(name: &str) -> Option<(String, usize, String)> {
    let parts = |begin: usize, end: usize, digits: usize| {
        (name[..begin].to_owned(), digits, name[end..].to_owned())
    };
    if let Some(last) = name.rfind('#') {
        let begin = name[..last].rfind(|c| c != '#').map_or(0, |at| {
            at + name[at..].chars().next().map_or(1, char::len_utf8)
        });
        return Some(parts(begin, last + 1, last + 1 - begin));
    }
    name.rmatch_indices('%').find_map(|(begin, _)| {
        let (digits, _) = name[begin + 1..].split_once('d')?;
        let width = match digits.strip_prefix('0') {
            Some(width) => width.parse().ok().filter(|width| (1..=9).contains(width))?,
            None if digits.is_empty() => 1,
            None => return None,
        };
        Some(parts(begin, begin + 2 + digits.len(), width))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_where_they_were_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        for (typed, first, large) in [
            ("f.exr", "f.0007.exr", "f.123456.exr"),
            ("a.b.png", "a.b.0007.png", "a.b.123456.png"),
            ("f", "f.0007", "f.123456"),
            ("f.####.exr", "f.0007.exr", "f.123456.exr"),
            ("f_##.exr", "f_07.exr", "f_123456.exr"),
            ("#.png", "7.png", "123456.png"),
            ("é#.png", "é7.png", "é123456.png"),
            ("f#1.###.png", "f#1.007.png", "f#1.123456.png"),
            ("f.%04d.exr", "f.0007.exr", "f.123456.exr"),
            ("f%d.exr", "f7.exr", "f123456.exr"),
            ("f%20.exr", "f%20.0007.exr", "f%20.123456.exr"),
            ("f%4d.exr", "f%4d.0007.exr", "f%4d.123456.exr"),
            ("50%%06d.png", "50%000007.png", "50%123456.png"),
        ] {
            let names = Names::of(&folder.path().join(typed)).unwrap();
            assert_eq!(names.path(7), folder.path().join(first));
            assert_eq!(names.path(123_456), folder.path().join(large));
        }
        for typed in ["none/", ".."] {
            assert!(Names::of(&folder.path().join(typed)).is_err(), "{typed}");
        }
        let inside = Names::of(Path::new("a#b/c.png")).unwrap();
        assert_eq!(inside.path(0), Path::new("a#b/c.0000.png"));
    }
}
