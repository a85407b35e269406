//! Cuts a frame into launches short enough for a desktop's watchdog and for Ctrl-C, by measured time.

use std::ops::Range;
use std::time::Duration;

use super::pack::layout::Launch;
use crate::opencl::DeviceType;
use crate::scene::kinds::KIND_COUNT;

/// How many sources there are of each kind, in the order of the table.
pub(super) type Counts = [u64; KIND_COUNT];

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

/// How many samples of fields a launch may take.
#[derive(Debug)]
pub(super) struct Pace {
    target: Duration,
    samples: f64,
    kinds: [bool; KIND_COUNT],
}

impl Pace {
    pub(super) fn new(device: DeviceType) -> Self {
        Self {
            target: match device {
                DeviceType::Gpu => TARGET_ON_GPU,
                _ => TARGET_ELSEWHERE,
            },
            samples: FIRST_SAMPLES,
            kinds: [false; KIND_COUNT],
        }
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
            self.samples = possible.clamp(LEAST_SAMPLES, MOST_GROWTH * self.samples);
        }
    }

    /// How many of the next `left` pixels to launch: as many as the pace allows with all sources that a launch may
    /// take, but not too few.
    pub(super) fn pixels(&self, work: &Work, left: u32) -> u32 {
        let sources = work.source_count.clamp(1, work.most_sources);
        let samples = f64::from(work.node_count) * sources as f64;
        let affordable = self.samples / samples;
        let pixels = match f64::from(left) <= 2.0 * affordable {
            true => left,
            false => affordable as u32,
        };
        let grains = pixels.max(work.fewest_pixels).div_ceil(work.grain);
        let pixels = grains.saturating_mul(work.grain);
        pixels.min(work.most_pixels()).min(left)
    }

    /// Sees to it that a frame whose launches are all enqueued at once has not too many, also before anything was
    /// measured.
    pub(super) fn begin_unwatched(&mut self, work: &Work, pixels: u32) {
        let all = f64::from(work.node_count) * work.source_count as f64 * f64::from(pixels);
        self.samples = self.samples.max(all / MOST_LAUNCHES);
    }

    /// The next launch on some pixels, from a source on.
    pub(super) fn part(&self, work: &Work, pixels: &Range<u32>, source: u64) -> Part {
        let left = work.source_count - source;
        Part {
            pixels: pixels.clone(),
            sources: source..source + self.sources(work, pixels.len() as u32, left),
        }
    }

    /// How many of the next `left` sources to launch on so many pixels: up to twice the pace, rather than a second
    /// launch for a small rest.
    fn sources(&self, work: &Work, pixels: u32, left: u64) -> u64 {
        let affordable = self.samples / (f64::from(work.node_count) * f64::from(pixels));
        let left = left.min(work.most_sources);
        if left as f64 <= 2.0 * affordable {
            left
        } else {
            (affordable as u64).clamp(1, left)
        }
    }
}

/// Launches of a frame that nobody watches, about, at most.
const MOST_LAUNCHES: f64 = 256.0;

impl Work {
    /// Pixels of a launch at most.
    pub(super) fn most_pixels(&self) -> u32 {
        (self.most_pixels / self.grain)
            .max(1)
            .saturating_mul(self.grain)
    }
}

/// A part of the work: consecutive pixels, and a range of the sources, counted over all kinds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Part {
    pub pixels: Range<u32>,
    pub sources: Range<u64>,
}

impl Part {
    /// Samples of fields that it takes.
    pub(super) fn samples(&self, work: &Work) -> f64 {
        let sources = (self.sources.end - self.sources.start) as f64;
        self.pixels.len() as f64 * sources * f64::from(work.node_count)
    }
}

/// What every pixel of a frame costs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Work {
    /// Nodes of the quadrature, or about as many Simpson samples as its cost is worth.
    pub node_count: u32,
    /// Sources of all kinds.
    pub source_count: u64,
    /// Below this many pixels a launch leaves the device idle.
    pub fewest_pixels: u32,
    /// Pixels of a launch are a multiple of this, but for the last one's.
    pub grain: u32,
    /// Above this many pixels, and this many sources, a launch takes too much memory.
    pub most_pixels: u32,
    pub most_sources: u64,
}

/// Sources of each kind in a part, as ranges of the lists.
fn ranges(part: &Part, counts: &Counts) -> [Range<u32>; KIND_COUNT] {
    let mut begin_of_kind = 0;
    counts.map(|count| {
        let clip =
            |at: u64| (at.clamp(begin_of_kind, begin_of_kind + count) - begin_of_kind) as u32;
        let range = clip(part.sources.start)..clip(part.sources.end);
        begin_of_kind += count;
        range
    })
}

/// Words of 32 sources that hold a bit for each source of a part; each kind begins with a new word.
pub(super) fn word_count(part: &Part, counts: &Counts) -> u32 {
    let words = |range: &Range<u32>| (range.len() as u32).div_ceil(32);
    ranges(part, counts).iter().map(words).sum()
}

/// Which sources of each kind a part takes.
pub(super) fn launch(part: &Part, counts: &Counts) -> Launch {
    let ranges = ranges(part, counts);
    Launch {
        begin: ranges.each_ref().map(|range| range.start),
        end: ranges.each_ref().map(|range| range.end),
        first_count: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every launch of a frame, at a device that does `rate` samples a second.
    fn frame(pixels: u32, work: &Work, rate: f64) -> Vec<Part> {
        let mut pace = Pace::new(DeviceType::Gpu);
        let mut parts = Vec::new();
        let mut pixel = 0;
        while pixel < pixels {
            let end = pixel + pace.pixels(work, pixels - pixel);
            let mut source = 0;
            loop {
                let part = pace.part(work, &(pixel..end), source);
                let samples = part.samples(work);
                pace.measured(samples, Duration::from_secs_f64(samples / rate));
                source = part.sources.end;
                parts.push(part);
                if source >= work.source_count {
                    break;
                }
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
    fn a_range_of_sources_falls_into_its_kinds() {
        let mut counts = [0; KIND_COUNT];
        (counts[0], counts[3], counts[4]) = (3, 2, 4);
        let part = Part {
            pixels: 7..9,
            sources: 2..6,
        };
        let Launch { begin, end, .. } = launch(&part, &counts);
        let range = |kind: usize| (begin[kind], end[kind]);
        assert_eq!((range(0), range(1), range(2)), ((2, 3), (0, 0), (0, 0)));
        assert_eq!((range(3), range(4)), ((0, 2), (0, 1)));
    }
}
