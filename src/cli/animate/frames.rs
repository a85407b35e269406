//! Which frames are drawn.

use energywave::Error;
use energywave::image::FrameRate;
use energywave::scene::{AnimatedScene, SceneSpan};

use super::arguments::{AnimateArguments, LAST_FRAME, Range, Shard};
use crate::cli::warn;

/// So far from a whole number of frames a loop may end, as a part of a frame, before its seam is seen.
const SEAM: f64 = 1e-3;

/// Returns the frames that were typed, else those in which the scene moves: a turn of its loop without the frame that
/// is the first again, or until its last track ends.
///
/// # Errors
/// [`Error::Unsupported`] if nothing was typed and the scene does not say.
pub fn range(arguments: &AnimateArguments, scene: &AnimatedScene) -> Result<Range, Error> {
    if let Some(range) = arguments.frames {
        return Ok(range);
    }
    let Some(span) = scene.span() else {
        return Err(Error::Unsupported(match scene.is_animated() {
            true => "--frames A..B is needed: all that moves in the scene is noise, which has no end, or waves of \
                     particles; or give it a [time] loop"
                .to_owned(),
            false => "--frames A..B is needed: nothing moves in the scene, no value is a track; energywave render \
                      draws one picture"
                .to_owned(),
        }));
    };
    let last = last_frame(span, arguments.fps);
    if last > f64::from(LAST_FRAME) {
        return Err(Error::Unsupported(format!(
            "the scene moves for {} s, {last} frames at {} a second; name fewer by --frames A..B",
            span.seconds, arguments.fps
        )));
    }
    Ok(Range {
        first: 0,
        last: last as u32,
    })
}

/// Returns the last frame in which a scene moves; warns where a loop is not of whole frames.
fn last_frame(span: SceneSpan, rate: FrameRate) -> f64 {
    let frames = rate.frames_in(span.seconds);
    let whole = frames.round();
    let is_whole = (frames - whole).abs() <= SEAM;
    match (span.loops, is_whole) {
        (false, true) => whole,
        (false, false) => frames.floor(),
        (true, true) => (whole - 1.0).max(0.0),
        (true, false) => {
            warn(&format!(
                "the loop of {} s is {frames:.2} frames at {rate} a second; it begins again before its last one is \
                 over, which may be seen",
                span.seconds
            ));
            frames.floor()
        }
    }
}

/// Returns a share of frames: every N-th, so that all shares take about as long.
pub fn share(range: Range, shard: Option<Shard>) -> Vec<u32> {
    let all = range.first..=range.last;
    match shard {
        None => all.collect(),
        Some(Shard { share, count }) => all.filter(|frame| frame % count == share).collect(),
    }
}

/// Returns up to so many frames, evenly from the first to the last.
pub fn spread(range: Range, most: u32) -> Vec<u32> {
    let count = range.count().min(most);
    let steps = (count - 1).max(1);
    let at = |step: u32| u64::from(range.last - range.first) * u64::from(step) / u64::from(steps);
    (0..count)
        .map(|step| range.first + at(step) as u32)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_all_frames_once() {
        let range = Range { first: 3, last: 20 };
        let mut all: Vec<u32> = (0..4)
            .flat_map(|share| self::share(range, Some(Shard { share, count: 4 })))
            .collect();
        all.sort_unstable();
        assert!(all.into_iter().eq(3..=20));
        assert!(share(range, None).into_iter().eq(3..=20));
        let more = Shard {
            share: 30,
            count: 40,
        };
        assert!(share(range, Some(more)).is_empty());
        assert_eq!(spread(range, 3), [3, 11, 20]);
        assert_eq!(spread(Range { first: 5, last: 5 }, 9), [5]);
        assert_eq!(spread(Range { first: 0, last: 2 }, 9), [0, 1, 2]);
    }

    #[test]
    fn a_loop_lacks_the_frame_that_is_its_first_again() {
        let scene = |text: &str| {
            let camera = "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n";
            AnimatedScene::from_toml(format!("{camera}{text}")).unwrap()
        };
        let last = |text: &str| last_frame(scene(text).span().unwrap(), FrameRate::default());
        let torus = |more: &str| {
            format!("[[torus]]\nmajor_radius = {{ times = [1, 2], values = [1, 2]{more} }}\n")
        };
        assert_eq!(last(&torus("")), 60.0);
        assert_eq!(last(&torus(", phase = 0.5")), 45.0);
        assert_eq!(last(&torus(", loop = \"repeat\"")), 29.0);
        assert_eq!(last(&torus(", loop = \"ping-pong\"")), 59.0);
        // A track that ends is beside one that does not.
        let both = torus(", loop = \"repeat\"") + &torus("");
        assert_eq!(last(&both), 60.0);
        assert_eq!(last(&format!("[time]\nloop = 4\n{}", torus(""))), 119.0);
        // 0.1 s are no whole number of frames to the last bit, and 0.13 s are none at all.
        assert_eq!(last(&format!("[time]\nloop = 0.1\n{}", torus(""))), 2.0);
        assert_eq!(last(&format!("[time]\nloop = 0.13\n{}", torus(""))), 3.0);
        let noise = "noise = { amplitude = 0.1, frequency = 2 }";
        let only_noise = format!("[[torus]]\nmajor_radius = {{ value = 1, {noise} }}\n");
        assert_eq!(scene(&only_noise).span(), None);
        assert_eq!(scene("[[torus]]\nmajor_radius = 1\n").span(), None);
        // Noise does not begin again with the track that it is added to.
        assert_eq!(last(&torus(&format!(", loop = \"repeat\", {noise}"))), 60.0);
    }
}
