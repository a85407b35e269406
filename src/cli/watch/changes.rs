//! Which files were saved: their folders are watched, since most editors put a new file in the place of the old one.

use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use energywave::Error;
use notify::event::{AccessKind, AccessMode};
use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};

/// What belongs to one change comes without such a pause.
const PAUSE: Duration = Duration::from_millis(4);

/// No longer than this is waited for a pause.
const LONGEST: Duration = Duration::from_millis(40);

/// Files whose changes are heard.
pub struct Changes {
    watcher: RecommendedWatcher,
    events: Receiver<notify::Result<Event>>,
    folders: BTreeSet<PathBuf>,
    names: BTreeSet<OsString>,
    are_there: bool,
}

impl Changes {
    /// Begins to hear changes of files.
    pub fn of(files: &[PathBuf]) -> Result<Self, Error> {
        let (sender, events) = channel();
        let hear = move |event| {
            let _ = sender.send(event); // nobody may be left to hear
        };
        let watcher = notify::recommended_watcher(hear)
            .map_err(|error| Error::Unsupported(format!("no changes can be heard: {error}")))?;
        let mut changes = Self {
            watcher,
            events,
            folders: BTreeSet::new(),
            names: BTreeSet::new(),
            are_there: false,
        };
        changes.add(files)?;
        Ok(changes)
    }

    /// Hears changes of further files, and of what they link to; a `*` in a name stands for whatever is there.
    pub fn add(&mut self, files: &[PathBuf]) -> Result<(), Error> {
        let links = files.iter().filter_map(|file| file.canonicalize().ok());
        for file in files.iter().cloned().chain(links) {
            let (Some(name), Some(folder)) = (file.file_name(), file.parent()) else {
                continue;
            };
            self.names.insert(name.to_owned());
            let folder = match folder == Path::new("") {
                true => Path::new("."),
                false => folder,
            };
            // One that is not there is a fault of the scene, which is told elsewhere.
            if !folder.is_dir() || !self.folders.insert(folder.to_owned()) {
                continue;
            }
            let watched = self.watcher.watch(folder, RecursiveMode::NonRecursive);
            watched.map_err(|error| {
                Error::input(folder, format!("its changes cannot be heard: {error}"))
            })?;
        }
        Ok(())
    }

    /// Returns whether there are any that nobody has taken.
    pub fn are_there(&mut self) -> bool {
        while let Ok(event) = self.events.try_recv() {
            self.are_there |= self.is_one(&event);
        }
        self.are_there
    }

    /// Waits for one, but not longer than `most`; says whether there is one.
    pub fn wait(&mut self, most: Duration) -> bool {
        let end = Instant::now() + most;
        while !self.are_there() {
            let left = end.saturating_duration_since(Instant::now());
            match self.events.recv_timeout(left) {
                Ok(event) => self.are_there |= self.is_one(&event),
                Err(_) => return false,
            }
        }
        true
    }

    /// Takes those that are there, and what belongs to them.
    pub fn take(&mut self) {
        let end = Instant::now() + LONGEST;
        while Instant::now() < end && self.events.recv_timeout(PAUSE).is_ok() {}
        self.are_there = false;
    }

    /// Returns whether something was written or replaced; that it was read is none.
    fn is_one(&self, event: &notify::Result<Event>) -> bool {
        let Ok(event) = event else {
            return true; // some were lost
        };
        let is_written = match event.kind {
            EventKind::Access(AccessKind::Close(AccessMode::Write)) => true,
            EventKind::Access(_) => false,
            _ => true,
        };
        let mut names = event.paths.iter().filter_map(|path| path.file_name());
        let is_heard = |name: &OsStr| self.names.iter().any(|known| is_one_of(known, name));
        is_written && (event.need_rescan() || names.any(is_heard))
    }
}

/// Returns whether a name is the known one, in which a `*` stands for whatever is there.
pub fn is_one_of(known: &OsStr, name: &OsStr) -> bool {
    let (known, name) = (known.to_string_lossy(), name.to_string_lossy());
    match known.split_once('*') {
        None => known == name,
        Some((before, after)) => {
            let has_room = name.len() >= before.len() + after.len();
            has_room && name.starts_with(before) && name.ends_with(after)
        }
    }
}
