//! The pace: how much a launch may take, by measured time; short enough for a desktop's watchdog and for Ctrl-C.

use std::ops::Range;
use std::time::Duration;

use super::partition::{Counts, Part, Place, TILE_SHARES, Work};
use crate::opencl::DeviceForm;
use crate::scene::kinds::KIND_COUNT;

/// Samples of a launch that is enqueued before anything was measured: 40 ms on a device of 1e9 a second.
const FIRST_UNWATCHED: f64 = 4e7;

/// A launch may be longer than the pace by so much, rather than leave a small rest to a second one.
const MOST_REST: f64 = 1.25;

/// What a launch aims at: on a GPU, since desktop systems reset one after a launch of seconds and draw nothing
/// meanwhile; elsewhere, where each launch costs about 55 us (PoCL 3.1) and only Ctrl-C waits for it.
const TARGET_ON_GPU: Duration = Duration::from_millis(40);
const TARGET_ELSEWHERE: Duration = Duration::from_millis(125);

/// Samples of the first launch, before anything was measured: some milliseconds on one slow core.
const FIRST_SAMPLES: f64 = 4e6;

/// Less is never aimed at.
const LEAST_SAMPLES: f64 = 1e4;

/// Growth of the launches from one to the next.
const MOST_GROWTH: f64 = 16.0;

/// How many samples of fields a launch may take. It parts the work, and the bits of a pixel do not depend on it: by
/// pixels a launch goes on with the sum where the one before stopped, and by tiles it takes some of the tiles, each
/// with all of its sources.
#[derive(Debug)]
pub(super) struct Pace {
    target: Duration,
    samples: f64,
    is_measured: bool,
    kinds: [bool; KIND_COUNT],
    forced: Option<Split>,
}

/// Launches of so much at most, whatever the pace: for tests.
#[derive(Debug, Clone, Copy)]
pub struct Split {
    /// Pixels, rounded up to what kernels take side by side.
    pub pixels: u32,
    /// Sources, by pixels and along listed rays.
    pub sources: u64,
    /// The share of the tiles of each pass, of [`TILE_SHARES`].
    pub shares: u32,
}

impl Pace {
    pub(super) fn new(form: DeviceForm) -> Self {
        Self {
            target: match form {
                DeviceForm::Gpu => TARGET_ON_GPU,
                DeviceForm::Cpu => TARGET_ELSEWHERE,
            },
            samples: FIRST_SAMPLES,
            is_measured: false,
            kinds: [false; KIND_COUNT],
            forced: None,
        }
    }

    /// Parts the work in this way from now on; `None`: by time.
    pub(super) fn force(&mut self, split: Option<Split>) {
        self.forced = split;
    }

    /// Goes on as if the device had taken seconds for little.
    pub(super) fn slow_down(&mut self) {
        self.samples = LEAST_SAMPLES;
    }

    /// Begins a frame: what was measured holds for scenes of the same kinds of sources.
    pub(super) fn begin(&mut self, counts: &Counts) {
        let kinds = counts.map(|count| count > 0);
        if kinds != self.kinds {
            self.samples = self.samples.min(FIRST_SAMPLES);
            self.is_measured = false;
            self.kinds = kinds;
        }
    }

    /// Learns from a launch.
    pub(super) fn measured(&mut self, samples: f64, time: Duration) {
        let possible = samples * self.target.as_secs_f64() / time.as_secs_f64().max(1e-6);
        if samples == 0.0 {
            return;
        }
        // A launch much below the pace says more about the overhead than about the device, unless it took too long.
        if samples > 0.1 * self.samples || time > self.target {
            self.is_measured = true;
            self.samples = possible.clamp(LEAST_SAMPLES, MOST_GROWTH * self.samples);
        }
    }

    /// How many of the next `left` pixels to launch: as many as the pace allows with all sources that a launch may
    /// take, but not too few.
    pub(super) fn pixels(&self, work: &Work, left: u32) -> u32 {
        let sources = work.source_count.clamp(1, work.most_sources);
        let samples = f64::from(work.node_count) * sources as f64;
        let affordable = self.samples / samples;
        let pixels = match (&self.forced, f64::from(left) <= MOST_REST * affordable) {
            (Some(split), _) => split.pixels,
            (None, true) => left.max(work.fewest_pixels),
            (None, false) => (affordable as u32).max(work.fewest_pixels),
        };
        let pixels = pixels.div_ceil(work.grain).saturating_mul(work.grain);
        pixels.min(work.most_pixels()).min(left)
    }

    /// Sees to it that a frame whose launches are all enqueued at once has not too many, also before anything was
    /// measured. Even on a device ten times slower than it seems none takes half a second in the form of a GPU, as long
    /// as the frame takes no more than ten minutes.
    pub(super) fn begin_unwatched(&mut self, work: &Work, pixels: u32) {
        let all = f64::from(work.node_count) * work.source_count as f64 * f64::from(pixels);
        if !self.is_measured {
            self.samples = self.samples.max(FIRST_UNWATCHED);
        }
        self.samples = self.samples.max(all / MOST_LAUNCHES);
    }

    /// The next launch on some pixels, from a place on.
    pub(super) fn part(&self, work: &Work, pixels: &Range<u32>, place: Place) -> Part {
        let Place {
            source,
            pass,
            share,
        } = place;
        let left = (work.source_count - source).min(work.most_sources);
        let samples = f64::from(work.node_count) * f64::from(pixels.len() as u32);
        let part = |sources, passes, shares| Part {
            pixels: pixels.clone(),
            sources: source..source + sources,
            passes,
            shares,
        };
        let passes = work.passes();
        if passes == 0 {
            let sources = self.sources(samples, left);
            return part(sources, 0..0, 0..TILE_SHARES);
        }
        let samples = samples * left as f64;
        let is_whole = samples <= MOST_REST * self.samples && self.forced.is_none();
        if is_whole && pass == 0 && share == 0 {
            return part(left, 0..passes, 0..TILE_SHARES);
        }
        let shares_left = TILE_SHARES - share;
        let affordable = self.samples / (samples * work.weight(pass)) * f64::from(TILE_SHARES);
        let shares = match &self.forced {
            Some(split) => split.shares.min(shares_left),
            None if f64::from(shares_left) <= MOST_REST * affordable => shares_left,
            None => (affordable as u32).clamp(1, shares_left),
        };
        part(left, pass..pass + 1, share..share + shares)
    }

    /// How many of the next `left` sources to launch that take so many samples each: up to a quarter
    /// more than the pace, rather than a second launch for a small rest.
    fn sources(&self, samples: f64, left: u64) -> u64 {
        let affordable = self.samples / samples;
        match &self.forced {
            Some(split) => split.sources.min(left),
            None if left as f64 <= MOST_REST * affordable => left,
            None => (affordable as u64).clamp(1, left),
        }
    }
}

/// Launches of a frame that nobody watches, about, at most.
const MOST_LAUNCHES: f64 = 16384.0;

#[cfg(test)]
mod tests {
    use super::*;

    /// Every launch of a frame, at a device that does `rate` samples a second.
    fn frame(pixels: u32, work: &Work, rate: f64) -> Vec<Part> {
        let mut pace = Pace::new(DeviceForm::Gpu);
        let mut parts = Vec::new();
        let mut pixel = 0;
        while pixel < pixels {
            let end = pixel + pace.pixels(work, pixels - pixel);
            let mut next = Some(Place::default());
            while let Some(place) = next {
                let part = pace.part(work, &(pixel..end), place);
                let samples = part.samples(work);
                pace.measured(samples, Duration::from_secs_f64(samples / rate));
                next = part.next(work);
                parts.push(part);
            }
            pixel = end;
        }
        parts
    }

    #[test]
    fn launches_cover_every_pixel_and_source_once_and_stay_short() {
        for (pixels, node_count, source_count, rate) in [
            (1, 3, 0, 1e9),
            (512 * 512, 201, 1, 3e9),
            (16384 * 16384, 201, 3, 1e12),
            (4097, 65537, 5000, 1e9),
            (300_000, 201, 1_000_000, 1e11),
        ] {
            let work = Work {
                node_count,
                source_count,
                fewest_pixels: 1024,
                grain: 1,
                most_pixels: u32::MAX,
                most_sources: u64::MAX,
                first_tile_size: 0,
            };
            let parts = frame(pixels, &work, rate);
            let covered: f64 = parts
                .iter()
                .map(|part| {
                    part.pixels.len() as f64 * (part.sources.end - part.sources.start) as f64
                })
                .sum();
            assert_eq!(covered, f64::from(pixels) * source_count as f64);
            let last = parts.last().unwrap();
            assert_eq!((last.pixels.end, last.sources.end), (pixels, source_count));
            let longest = parts
                .iter()
                .map(|part| part.samples(&work) / rate)
                .fold(0.0, f64::max);
            let one_source = f64::from(work.node_count * 1024.min(pixels)) / rate;
            assert!(
                longest <= (0.1_f64).max(one_source),
                "{pixels} {source_count}: {longest} s"
            );
        }
    }

    #[test]
    fn no_launch_of_a_hosts_frame_takes_half_a_second_on_a_device_ten_times_slower_than_it_seemed()
    {
        for (source_count, first_tile_size, most_sources) in [
            (1, 0, u64::MAX),
            (4096, 0, u64::MAX),
            (4096, 256, 3936),
            (100_000, 256, 3936),
        ] {
            let work = Work {
                node_count: 32,
                source_count,
                fewest_pixels: 20_000,
                grain: if first_tile_size == 0 { 16 } else { 256 * 3840 },
                most_pixels: 1 << 23,
                most_sources,
                first_tile_size,
            };
            for seemed in [None, Some(1e9), Some(1e11)] {
                let mut pace = Pace::new(DeviceForm::Gpu);
                for _ in 0..10 {
                    if let Some(rate) = seemed {
                        pace.measured(pace.samples, Duration::from_secs_f64(pace.samples / rate));
                    }
                }
                let rate = seemed.unwrap_or(1e9) / 10.0;
                let pixels = 3840 * 2160;
                // Frames of hours come in launches that are longer than that.
                let all = 32.0 * source_count as f64 * f64::from(pixels);
                let longest = 0.5001_f64.max(MOST_REST * all / MOST_LAUNCHES / rate);
                pace.begin_unwatched(&work, pixels);
                let first = 0..pace.pixels(&work, pixels);
                let mut next = Some(Place::default());
                while let Some(place) = next {
                    let part = pace.part(&work, &first, place);
                    let time = part.samples(&work) / rate;
                    assert!(
                        time <= longest,
                        "{seemed:?}, {source_count}: {time} s, {part:?}"
                    );
                    next = part.next(&work);
                }
            }
        }
    }

    #[test]
    fn every_pass_over_tiles_takes_all_shares_in_order() {
        let work = Work {
            node_count: 32,
            source_count: 5000,
            fewest_pixels: 1024,
            grain: 64 * 512,
            most_pixels: u32::MAX,
            most_sources: 3936,
            first_tile_size: 64,
        };
        for rate in [1e7, 1e9, 1e13] {
            let parts = frame(512 * 512, &work, rate);
            let mut place = (0, 0, 0, 0);
            for part in &parts {
                let begin = (part.pixels.start, part.sources.start);
                assert_eq!(
                    (begin.0, begin.1, part.passes.start, part.shares.start),
                    place
                );
                assert_eq!(part.pixels.len() % (64 * 512), 0);
                place = match part.next(&work) {
                    Some(next) => (begin.0, next.source, next.pass, next.share),
                    None => (part.pixels.end, 0, 0, 0),
                };
                assert!([0, 3936].contains(&place.1), "{part:?}");
            }
            assert_eq!(place, (512 * 512, 0, 0, 0));
            let is_cut = |part: &Part| part.shares.len() < TILE_SHARES as usize;
            assert!(parts.iter().any(is_cut), "{rate:e}");
            // A fast device takes all passes at once in the end.
            let last = parts.last().unwrap();
            assert_eq!(last.passes == (0..4), rate > 1e12, "{last:?}");
        }
    }
}
