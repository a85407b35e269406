//! How long a scene moves, what it is made of, and the exposure that fits all of its times.

use std::fmt::Write;
use std::path::PathBuf;

use super::animated::AnimatedScene;
use super::display::ExposureKey;
use super::document::Motion;
use super::*;
use crate::scene::Track;

/// How long a scene moves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SceneSpan {
    /// From 0 s until then, seconds, from 0 on.
    pub seconds: f64,
    /// Whether the scene is then as it is at 0 s, to begin again.
    pub loops: bool,
}

/// At so many times, evenly from the first to the last, the exposure is to fit that a moving scene gets.
const EXPOSED_TIMES: u32 = 33;

/// How long noise is looked at that has no end, seconds.
const NOISE_SECONDS: f64 = 1.0;

impl AnimatedScene {
    /// Returns how long it moves: a turn of its loop; of a scene without one, a cycle if all tracks have the same, else
    /// until the last key of a track that ends, or the end of a first cycle. `None` if it does not move, or if all that
    /// moves is noise, which has no end.
    #[must_use]
    pub fn span(&self) -> Option<SceneSpan> {
        let Document { file, motion } = &self.document;
        motion.span(file)
    }

    /// Returns the text that it was read from; empty if it was made in code.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.document.motion.text
    }

    /// Returns the files that it names: a depth image, a background, meshes, and those of particles and volumes.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        let Document { file, motion } = &self.document;
        let depth = file.depth.as_ref().map(DepthTable::file);
        let surfaces = file.metaballs.iter().filter_map(MetaballsTable::file);
        let lights = file.particles.iter().filter_map(ParticlesTable::file);
        let lit = file.points.iter().filter_map(PointsTable::file);
        let images = depth.into_iter().chain(file.display.background_file());
        let named = images.chain(surfaces).chain(lights).chain(lit);
        let named = named.map(|file| motion.folder.join(file));
        let meshes = file.mesh.iter();
        let meshes = meshes.flat_map(|mesh| mesh.files(&motion.folder));
        let hit = file.collider.iter();
        let hit = hit.flat_map(|collider| collider.files(&motion.folder));
        let cells = file.volume.iter();
        let cells = cells.flat_map(|volume| volume.files(&motion.folder));
        named.chain(meshes).chain(hit).chain(cells).collect()
    }

    /// Returns the paths with `*` in their names whose pictures are slices of volumes: files may be added there.
    #[must_use]
    pub fn slices(&self) -> Vec<PathBuf> {
        let Document { file, motion } = &self.document;
        let volumes = file.volume.iter();
        volumes
            .filter_map(|volume| volume.slices(&motion.folder))
            .collect()
    }
}

impl Motion<'_> {
    fn span(&self, file: &SceneFile) -> Option<SceneSpan> {
        if self.moving.is_empty() {
            return None;
        }
        if let Some(seconds) = file.period() {
            return Some(SceneSpan {
                seconds,
                loops: true,
            });
        }
        let (mut ends, mut cycles) = (Vec::new(), Vec::new());
        self.for_each_track(&mut |_, track| {
            ends.extend(track.end());
            cycles.push(track.cycle().filter(|_| track.noise.is_none()));
        });
        if let Some(&Some(seconds)) = cycles.first()
            && cycles.iter().all(|cycle| *cycle == Some(seconds))
        {
            return Some(SceneSpan {
                seconds,
                loops: true,
            });
        }
        let seconds = ends.into_iter().reduce(f64::max)?.max(0.0);
        Some(SceneSpan {
            seconds,
            loops: false,
        })
    }

    /// Calls `visit` with every track and its key.
    fn for_each_track(&self, visit: &mut impl FnMut(&str, &Track)) {
        let moving = &self.moving;
        if let Some(singles) = &moving.singles {
            singles.for_each_track(&mut String::new(), visit);
        }
        let whole = &mut |key: &str, track: &Track| visit(&moving.whole_key(key), track);
        moving.units.for_each_track(&mut String::new(), whole);
    }

    /// Says which track is in the middle of its cycle where the scene begins again, so that something jumps.
    pub(super) fn seam(&self, file: &SceneFile) -> Option<SceneError> {
        let seconds = file.period()?;
        let (mut first, mut more) = (None, 0);
        self.for_each_track(&mut |key, track| match track.unfinished_cycle(seconds) {
            Some(_) if first.is_some() => more += 1,
            Some(cycle) => first = Some((key.to_owned(), cycle)),
            None => {}
        });
        let (key, cycle) = first?;
        let fitting = seconds / (seconds / cycle).round().max(1.0);
        let mut message = format!(
            "begins again every {cycle} s, and jumps where the scene does after {seconds} s; a cycle of {fitting} s \
             fits in"
        );
        if more > 0 {
            let _ = write!(message, " ({more} more tracks jump there)");
        }
        Some(self.found(SceneError::value(key, message)))
    }

    /// Returns the exposure of a scene that moves and names none: the one that fits its brightest moment, at all times,
    /// so that no frame is overexposed, and light that swells or fades is not levelled out.
    pub(super) fn exposure(&self, file: &SceneFile) -> Option<ExposureKey> {
        if self.moving.is_empty() || file.display.exposure.is_some() {
            return None;
        }
        let stops = *self.fitting.get_or_init(|| self.fitting_exposure(file));
        Some(ExposureKey(stops.into()))
    }

    fn fitting_exposure(&self, file: &SceneFile) -> f64 {
        let seconds = self.span(file).map_or(NOISE_SECONDS, |span| span.seconds);
        let times =
            (0..EXPOSED_TIMES).map(|step| seconds * f64::from(step) / f64::from(EXPOSED_TIMES - 1));
        let fitting = times.filter_map(|time| {
            let (mut file, moment) = (file.clone(), self.moment(file, time));
            // What is wrong at a time is told to who draws it.
            self.go_to(&mut file, moment).ok()?;
            file.exposure_of_brightest()
        });
        fitting.reduce(f64::min).unwrap_or(0.0)
    }
}
