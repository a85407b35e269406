//! Motion blur: the mean of the light while a shutter is open, over moments that `moments.rs` chooses.

use std::ops::{ControlFlow, Range};

use super::moments::{Gap, LAST_LEVEL, LEAST_LEVEL, count, nodes};
use super::one::DeviceRenderer;
use super::{Renderer, RendererBackend, whole};
use crate::cost::FrameCost;
use crate::error::{Error, Result};
use crate::image::{ImageSize, RadianceImage, kept_image};
#[cfg(feature = "files")]
use crate::scene::AnimatedScene;
use crate::scene::Scene;

/// Light that is less than this share of the picture's mean is compared with that.
const DARK: f64 = 1e-3;

/// What is kept from one mean to the next.
#[derive(Debug, Default)]
pub(super) struct Shutter {
    /// The sum of a level's frames.
    level: Option<RadianceImage>,
    differences: Vec<f32>,
}

/// Frames that are added up.
struct Frames<'a> {
    times: &'a Range<f64>,
    scene_at: &'a mut dyn FnMut(f64) -> Result<Scene>,
    size: ImageSize,
    drawn: u32,
    /// Of those that were drawn.
    cost: FrameCost,
    /// How many there will be, about.
    expected: u32,
    /// The share that was told last.
    told: f32,
}

impl Renderer {
    /// Renders the mean of the light of a scene that moves, from one time to another in seconds, as a film sees it
    /// while its shutter is open: of frames at 7 to 1023 moments, as many as it takes until their mean is about within
    /// the tolerance of the scene (1e-3 of methods that have none) for 99.9 % of the pixels, and within ten times that
    /// for all; pixels darker than a thousandth of the picture's mean count as that bright. What comes and goes within
    /// a seventh of the time may be missed. Where nothing moves, or the time is empty, it is the frame at its begin, to
    /// the bit.
    ///
    /// A bloom ([`Renderer::spread_bloom`]) is that of the mean, by the display at the begin. Memory is kept from call
    /// to call.
    ///
    /// # Errors
    /// As [`Renderer::render`] and `scene_at`; [`Error::Unsupported`] if the times are not finite, or the image changes
    /// its size.
    pub fn render_mean(
        &mut self,
        times: Range<f64>,
        mut scene_at: impl FnMut(f64) -> Result<Scene>,
    ) -> Result<RadianceImage> {
        let nothing = &mut |_: f32| ControlFlow::Continue(());
        self.render_mean_with_progress(times, &mut scene_at, nothing)
    }

    /// Renders as [`Renderer::render_mean`] does what [`AnimatedScene::open_at`] says of a frame.
    ///
    /// ```no_run
    /// # fn main() -> energywave::Result<()> {
    /// # use energywave::scene::AnimatedScene;
    /// # let mut renderer = energywave::Renderer::new(&energywave::Device::best()?)?;
    /// let scene = AnimatedScene::from_file("shot.toml")?; // says [time] shutter
    /// let rate = 24.0;
    /// for frame in 0..48 {
    ///     let light = renderer.render_shutter(&scene, scene.open_at(f64::from(frame) / rate, rate))?;
    /// }
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Renderer::render_mean`] and [`AnimatedScene::at`].
    #[cfg(feature = "files")]
    pub fn render_shutter(
        &mut self,
        scene: &AnimatedScene,
        times: Range<f64>,
    ) -> Result<RadianceImage> {
        self.render_mean(times, |time| scene.at(time))
    }

    /// Renders as [`Renderer::render_mean`] does; `progress` is told the finished share of the work, about, and may
    /// stop it.
    ///
    /// # Errors
    /// As [`Renderer::render_mean`], and [`Error::Interrupted`] if `progress` stopped the work.
    pub fn render_mean_with_progress(
        &mut self,
        times: Range<f64>,
        scene_at: &mut dyn FnMut(f64) -> Result<Scene>,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<RadianceImage> {
        if !times.start.is_finite() || !times.end.is_finite() {
            return Err(Error::Unsupported(format!(
                "a mean from {} to {} s; both are finite",
                times.start, times.end
            )));
        }
        let first = scene_at(times.start)?;
        if times.is_empty() || !moves(&first, &times, scene_at)? {
            return self.render_with_progress(&first, progress);
        }
        self.check(&first)?;
        let mut image = RadianceImage::new(first.image)?;
        let mut frames = Frames {
            times: &times,
            scene_at,
            size: first.image,
            drawn: 0,
            cost: FrameCost::default(),
            expected: count(LEAST_LEVEL),
            told: 0.0,
        };
        let mut kept = std::mem::take(&mut self.shutter);
        let tolerance = first.integration.method.tolerance();
        let drawn = self.add_up(&mut frames, tolerance, &mut image, &mut kept, progress);
        self.shutter = kept;
        drawn?;
        self.moments = frames.drawn;
        let bloom = self.bloom_of(&first);
        if let Some(bloom) = &bloom {
            self.spread(first.image, image.as_mut_slice(), bloom)?;
        }
        image.mark_bloomed(bloom);
        Ok(image)
    }

    /// Returns at how many moments the last frame was drawn: 1, or those of a mean over time.
    #[must_use]
    pub fn last_moments(&self) -> u32 {
        self.moments
    }

    /// Adds up frames, level by level, until their mean is good enough.
    fn add_up(
        &mut self,
        frames: &mut Frames<'_>,
        tolerance: f64,
        image: &mut RadianceImage,
        kept: &mut Shutter,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        let mut sum = Sum {
            light: image.as_mut_slice(),
            weight: 0.0,
            dark: 0.0,
        };
        let mut last = None;
        let level_sum = kept_image(&mut kept.level, frames.size)?.as_mut_slice();
        for level in 0..=LAST_LEVEL {
            frames.expected = frames.expected.max(count(level));
            level_sum.fill(0.0);
            let weight = self.add_level(level, frames, level_sum, progress)?;
            let gap = sum.take(level_sum, weight, &mut kept.differences);
            let Some(gap) = gap else { continue };
            if level >= LEAST_LEVEL && gap.error(last) <= tolerance {
                break;
            }
            let levels = level + gap.levels_to(last, tolerance);
            frames.expected = count(levels.clamp(LEAST_LEVEL, LAST_LEVEL));
            last = Some(gap);
        }
        sum.divide();
        Ok(())
    }

    /// Adds the frames of a level, each scene once where several moments show the same; returns their weight.
    fn add_level(
        &mut self,
        level: u32,
        frames: &mut Frames<'_>,
        sum: &mut [f32],
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<f64> {
        let mut all = 0.0;
        let mut waiting: Option<(Scene, f64, u32)> = None;
        for (share, weight) in nodes(level) {
            let scene = frames.scene(share)?;
            all += weight;
            if let Some((before, of_it, moments)) = &mut waiting
                && *before == scene
            {
                (*of_it, *moments) = (*of_it + weight, *moments + 1);
                continue;
            }
            if let Some(before) = waiting.replace((scene, weight, 1)) {
                self.add_frame(&before, frames, sum, progress)?;
            }
        }
        if let Some(last) = waiting {
            self.add_frame(&last, frames, sum, progress)?;
        }
        Ok(all)
    }

    /// Adds the light of a frame, so many times, which stands for some moments.
    fn add_frame(
        &mut self,
        (scene, weight, moments): &(Scene, f64, u32),
        frames: &mut Frames<'_>,
        sum: &mut [f32],
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        scene.validate_again(&mut self.checked)?;
        self.cost_before = frames.cost;
        let progress = &mut |share: f32| progress(frames.share(share * *moments as f32));
        self.has_light = true;
        let is_put_together = scene.has_stage() || self.has_layers(scene)?;
        let weight = *weight as f32;
        if let (RendererBackend::OpenCl(renderer), false) = (&mut self.backend, is_put_together) {
            renderer.add_light(scene, weight, sum, progress)?;
        } else {
            let mut frame = self.kept.take();
            let light = kept_image(&mut frame, scene.image)?.as_mut_slice();
            let drawn = self.draw(scene, whole(scene, light, None), progress);
            add(light, weight, sum);
            self.kept = frame;
            drawn?;
        }
        frames.cost = self.last_cost();
        frames.drawn += moments;
        Ok(())
    }
}

impl Frames<'_> {
    /// Returns the scene after a share of the time.
    fn scene(&mut self, share: f64) -> Result<Scene> {
        let time = at(self.times, share);
        let scene = (self.scene_at)(time)?;
        if scene.image == self.size {
            return Ok(scene);
        }
        Err(Error::Unsupported(format!(
            "a mean over time of images of {}x{} and, at {time} s, {}x{} pixels; they must be equal",
            self.size.width, self.size.height, scene.image.width, scene.image.height
        )))
    }

    /// Returns the finished share of the work, which never falls.
    fn share(&mut self, more: f32) -> f32 {
        let share = (self.drawn as f32 + more) / self.expected as f32;
        self.told = self.told.max(share.min(1.0));
        self.told
    }
}

fn at(times: &Range<f64>, share: f64) -> f64 {
    times.start + share * (times.end - times.start)
}

/// Returns whether a scene is another one at any of the moments that are looked at in any case.
fn moves(
    first: &Scene,
    times: &Range<f64>,
    scene_at: &mut dyn FnMut(f64) -> Result<Scene>,
) -> Result<bool> {
    for (share, _) in (0..=LEAST_LEVEL).flat_map(nodes) {
        if scene_at(at(times, share))? != *first {
            return Ok(true);
        }
    }
    Ok(false)
}

/// The weighted sum of all frames so far.
struct Sum<'a> {
    light: &'a mut [f32],
    weight: f64,
    /// What darker light is compared with.
    dark: f32,
}

impl Sum<'_> {
    /// Adds the sum of a level; returns how far their means are apart, unless this is the first.
    fn take(&mut self, level: &[f32], weight: f64, differences: &mut Vec<f32>) -> Option<Gap> {
        let of_old = if self.weight > 0.0 {
            1.0 / self.weight
        } else {
            0.0
        };
        let (of_old, of_new) = (of_old as f32, (1.0 / weight) as f32);
        let is_first = self.weight == 0.0;
        self.weight += weight;
        let of_all = (1.0 / self.weight) as f32;
        let mut sum = 0.0_f64;
        differences.clear();
        let (pixels, _) = self.light.as_chunks_mut::<4>();
        differences.reserve_exact(pixels.len());
        for (all, new) in pixels.iter_mut().zip(level.as_chunks::<4>().0) {
            let mut most = 0.0_f32;
            for channel in 0..3 {
                let (old, new) = (all[channel], new[channel]);
                all[channel] = old + new;
                let value = (of_all * (old + new)).abs();
                sum += f64::from(value);
                let difference = (of_old * old - of_new * new).abs();
                if difference > 0.0 {
                    most = most.max(difference / (value + self.dark));
                }
            }
            differences.push(most);
        }
        self.dark = (DARK * sum / (3 * pixels.len()).max(1) as f64) as f32;
        (!is_first).then(|| Gap::of(differences))
    }

    /// Makes it the mean.
    fn divide(self) {
        let share = (1.0 / self.weight) as f32;
        for pixel in self.light.as_chunks_mut::<4>().0 {
            pixel[..3].iter_mut().for_each(|light| *light *= share);
            pixel[3] = 1.0;
        }
    }
}

/// Adds light to a sum, so many times.
fn add(light: &[f32], weight: f32, sum: &mut [f32]) {
    for (sum, light) in sum.iter_mut().zip(light) {
        *sum += weight * light;
    }
}

impl DeviceRenderer {
    /// Adds the light of all rows of a valid scene to a sum, so many times, from where the device has it.
    fn add_light(
        &mut self,
        scene: &Scene,
        weight: f32,
        sum: &mut [f32],
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        let plan = self.plan(scene)?;
        let grain = self.grain_rows(scene) * scene.image.width;
        self.draw_bands(
            &plan,
            0..scene.image.pixels() as u32,
            grain,
            None,
            &mut |film, compute, band| {
                let light = film.map(compute, band.len())?;
                add(&light, weight, &mut sum[4 * band.start..4 * band.end]);
                Ok(())
            },
            progress,
        )?;
        Ok(())
    }
}
