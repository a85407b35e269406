//! What is drawn: the scene of each frame, with what was typed, and what decides how it looks.

use std::ops::ControlFlow;
use std::path::Path;

use energywave::image::{Display, Exposure, FrameRate};
use energywave::scene::{AnimatedScene, MethodKeys};
use energywave::{Error, RadianceImage, Renderer, Scene};
use sha2::{Digest, Sha256};

use super::arguments::{AnimateArguments, Range};
use super::frames::spread;
use super::target::Target;
use crate::cli::{note, warn};

/// So many frames are drawn to find the exposure that fits all.
const EXPOSED_FRAMES: u32 = 9;

/// A scene that moves, and what was typed.
pub struct Source<'a> {
    pub scene: AnimatedScene,
    arguments: &'a AnimateArguments,
    target: &'a Target,
    /// That of all frames, if it was typed or is to fit what is drawn.
    exposure: Option<Exposure>,
}

impl<'a> Source<'a> {
    /// Reads a scene.
    pub fn open(arguments: &'a AnimateArguments, target: &'a Target) -> Result<Self, Error> {
        let scene = match arguments.scene == Path::new("-") {
            true => AnimatedScene::from_reader(std::io::stdin().lock(), "standard input"),
            false => AnimatedScene::from_file(&arguments.scene),
        }?;
        Ok(Self {
            scene,
            arguments,
            target,
            exposure: arguments.exposure,
        })
    }

    /// Returns the scene of a frame.
    pub fn at(&self, frame: u32) -> Result<Scene, Error> {
        self.at_time(self.arguments.fps.time_of(frame))
    }

    fn at_time(&self, time: f64) -> Result<Scene, Error> {
        self.scene
            .at_with(time, |scene, keys| self.adjust(scene, keys))
    }

    /// Says what the scene of a frame was hardly meant to say.
    pub fn warn_of(&self, frame: u32) -> Result<(), Error> {
        let time = self.arguments.fps.time_of(frame);
        let adjust = |scene: &mut Scene, keys: &MethodKeys| self.adjust(scene, keys);
        let (_, warnings) = self.scene.at_with_warnings(time, adjust)?;
        warnings
            .iter()
            .for_each(|warning| warn(&warning.to_string()));
        Ok(())
    }

    fn adjust(&self, scene: &mut Scene, keys: &MethodKeys) -> Result<(), Error> {
        let overrides = &self.arguments.overrides;
        overrides.apply(scene, keys)?;
        let display = &mut scene.display;
        display.bits = self.arguments.bits.or(display.bits);
        display.exposure = self.exposure.unwrap_or(display.exposure);
        self.target.check(display)
    }

    /// Draws a frame over an image, and returns what its display makes of that; `stop` may stop the work.
    pub fn draw(
        &self,
        renderer: &mut Renderer,
        frame: u32,
        image: &mut RadianceImage,
        stop: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Display, Error> {
        if stop().is_break() {
            return Err(Error::Interrupted);
        }
        let scene = self.at(frame)?;
        let rate = self.arguments.fps;
        let open = self.scene.open_at(rate.time_of(frame), rate.per_second());
        let mut report = |_| stop();
        match open.is_empty() {
            true => renderer.render_over(&scene, image, &mut report)?,
            false => {
                let mut scene_at = |time| self.at_time(time);
                *image = renderer.render_mean_with_progress(open, &mut scene_at, &mut report)?;
            }
        }
        Ok(scene.display)
    }

    /// Makes one exposure of all frames that are to fit theirs: that of the brightest of some, so that nothing
    /// flickers. They are of the whole range, so that all shares of it come to the same.
    pub fn fit_exposure(
        &mut self,
        renderer: &mut Renderer,
        range: Range,
        stop: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<(), Error> {
        let first = self.at(range.first)?;
        if first.display.exposure != Exposure::Auto {
            return Ok(());
        }
        let mut image = RadianceImage::new(first.image)?;
        let (mut least, frames) = (f64::INFINITY, spread(range, EXPOSED_FRAMES));
        // An exposure that fits is that of the light before its bloom.
        renderer.spread_bloom(false);
        for frame in &frames {
            self.draw(renderer, *frame, &mut image, stop)?;
            let is_lit = |pixel: &[f32]| pixel[..3].iter().any(|light| *light > 0.0);
            if image.as_slice().chunks_exact(4).any(is_lit) {
                least = least.min(image.auto_exposure());
            }
        }
        // Devices differ by less than the last digit.
        let stops = match least.is_finite() {
            true => (100.0 * least).floor() / 100.0,
            false => 0.0,
        };
        self.exposure = Some(stops.into());
        note(&format!(
            "exposure: {stops:.2} stops for all frames, by auto: it fits the brightest of {}",
            frames.len()
        ));
        Ok(())
    }

    /// Returns what tells the frames of this scene, as it was typed, from those of all others.
    ///
    /// # Errors
    /// [`Error::Input`] if a file that it names cannot be read.
    pub fn fingerprints(&self) -> Result<Fingerprints, Error> {
        let mut digest = Sha256::new();
        let mut add = |bytes: &[u8]| {
            digest.update((bytes.len() as u64).to_le_bytes());
            digest.update(bytes);
        };
        add(env!("CARGO_PKG_VERSION").as_bytes());
        add(self.scene.text().as_bytes());
        let AnimateArguments {
            overrides,
            bits,
            fps: rate,
            ..
        } = self.arguments;
        let (exposure, target) = (self.exposure, self.target.format());
        add(format!("{overrides:?} {bits:?} {rate} {exposure:?} {target:?}").as_bytes());
        let mut files = self.scene.files();
        files.extend(overrides.depth.clone());
        for file in files {
            let bytes = std::fs::read(&file)
                .map_err(|error| Error::input(&file, format!("cannot read: {error}")))?;
            add(&Sha256::digest(&bytes));
        }
        Ok(Fingerprints {
            digest,
            rate: *rate,
        })
    }
}

/// What tells frames from all others: a digest of all that decides how they look.
pub struct Fingerprints {
    digest: Sha256,
    rate: FrameRate,
}

impl Fingerprints {
    pub fn of(&self, frame: u32) -> String {
        let time = self.rate.time_of(frame).to_bits().to_le_bytes();
        let digest = self.digest.clone().chain_update(time).finalize();
        digest.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}
