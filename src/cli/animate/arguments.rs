//! What can be typed after `animate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use energywave::image::{Exposure, FrameRate, ImageSize};

use crate::cli::args::{self, DeviceArgument, exposure};
use crate::cli::overrides::Overrides;

#[derive(Debug, Args)]
pub struct AnimateArguments {
    /// Scene file, TOML or (.json) JSON; - is standard input
    pub scene: PathBuf,
    /// Frames to write: f.png or f.exr (numbered: f.0000.png), f.####.png, f.%04d.png; all in one: f.apng, f.y4m;
    /// - is a video on standard output (Y4M)
    #[arg(short, long, value_name = "FRAMES")]
    pub output: PathBuf,
    /// Format of the frames [default: by the ending of their name; y4m on standard output]
    #[arg(long)]
    pub format: Option<FramesFormat>,
    /// First and last frame, both drawn [default: a turn of the scene's loop, else until its last track ends]
    #[arg(long, value_name = "A..B", value_parser = range, allow_hyphen_values = true)]
    pub frames: Option<Range>,
    /// Frames a second, such as 24, 23.976 or 30000/1001: frame n is at n / F seconds
    #[arg(
        long,
        value_name = "F",
        default_value = "30",
        allow_hyphen_values = true
    )]
    pub fps: FrameRate,
    /// Draw the I-th of N shares of the frames, from 1 on, for N machines: every N-th frame
    #[arg(long, value_name = "I/N", value_parser = shard, allow_hyphen_values = true)]
    pub shard: Option<Shard>,
    /// Draw frames anew that are there and are whole
    #[arg(long)]
    pub overwrite: bool,
    /// Lay all frames into one PNG or EXR, with a JSON beside it that says how to play them
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = grid, allow_hyphen_values = true)]
    pub flipbook: Option<ImageSize>,
    /// Empty pixels on each side of every frame of the flipbook [default: 0]
    #[arg(long, value_name = "N", value_parser = padding, requires = "flipbook", allow_hyphen_values = true)]
    pub padding: Option<u32>,
    /// Print a report as JSON: frames done, skipped and failed, and what took how long
    #[arg(long)]
    pub json: bool,
    /// Bits of a channel: 8 or 16 of a PNG, 16 or 32 of an EXR [default: the scene's, else 8, and 32]
    #[arg(long, value_name = "N")]
    pub bits: Option<u32>,
    /// Exposure of all frames in stops, or auto, which fits the brightest of nine [default: the scene's, else fits it]
    #[arg(long, value_name = "STOPS|auto", value_parser = exposure, allow_hyphen_values = true)]
    pub exposure: Option<Exposure>,
    #[command(flatten)]
    pub overrides: Overrides,
    #[command(flatten)]
    pub device: DeviceArgument,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FramesFormat {
    /// A file for each frame: sRGB, tone-mapped
    Png,
    /// A file for each frame: linear light
    Exr,
    /// One PNG that moves
    Apng,
    /// One video, uncompressed, for an encoder
    Y4m,
}

/// Frames from the first to the last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Range {
    pub first: u32,
    pub last: u32,
}

impl Range {
    pub fn count(self) -> u32 {
        self.last - self.first + 1
    }
}

/// The `share`-th of `count` shares, from 0 on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    pub share: u32,
    pub count: u32,
}

/// The greatest number of a frame.
pub const LAST_FRAME: u32 = 99_999_999;

pub fn range(text: &str) -> Result<Range, String> {
    let number = |text: &str| text.trim().parse().ok().filter(|n: &u32| *n <= LAST_FRAME);
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    match (number(first), number(last)) {
        (Some(first), Some(last)) if first > last => Err(format!(
            "frames run forwards: {last}..{first}, both ends included"
        )),
        (Some(first), Some(last)) => Ok(Range { first, last }),
        _ => Err(format!(
            "frames are numbers from 0 to {LAST_FRAME}, the first and the last of them, such as 0..239"
        )),
    }
}

fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/');
    let numbers = parts.map(|(share, count)| (share.parse::<u32>(), count.parse::<u32>()));
    match numbers {
        Some((Ok(share), Ok(count))) if (1..=count).contains(&share) => Ok(Shard {
            share: share - 1,
            count,
        }),
        _ => Err("a shard is one of N shares, from 1/N to N/N, such as 1/2 and 2/2".to_owned()),
    }
}

fn grid(text: &str) -> Result<ImageSize, String> {
    args::size(text).map_err(|_| "a flipbook has columns and rows, such as 8x8".to_owned())
}

fn padding(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(pixels @ 0..=1024) => Ok(pixels),
        _ => Err("a padding is a whole number of pixels from 0 to 1024".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_shards_are_read_or_refused() {
        let frames = |first, last| Ok(Range { first, last });
        assert_eq!(range("0..239"), frames(0, 239));
        assert_eq!(range("7"), frames(7, 7));
        assert_eq!(range("3..3"), frames(3, 3));
        for wrong in [
            "",
            "..",
            "1..",
            "..3",
            "-1..3",
            "5..4",
            "1.5..2",
            "0..=3",
            "0-3",
            "0..100000000",
            "nan",
        ] {
            assert!(range(wrong).is_err(), "{wrong}");
        }
        assert_eq!(shard("2/3"), Ok(Shard { share: 1, count: 3 }));
        for wrong in [
            "0/2", "3/2", "1/0", "0/0", "1", "", "/", "-1/2", "1/2/3", "1.5/2",
        ] {
            assert!(shard(wrong).is_err(), "{wrong}");
        }
    }
}
