//! What a scene's depths come to: which channel, from where to where, and how many of them lie where nothing is drawn.
//! Depths in other units give a black picture, or one in which nothing is hidden, and no fault.

use super::{Scene, ViewPlane};
use crate::image::{DepthImage, ImageSize};
use crate::shown::shown;

/// Shares of the depths from which on it is likely that they are in other units. What lies before the plane is black:
/// no picture is meant to be so by half. A wall may stand behind all that glows.
const TOO_MANY_BEFORE: f64 = 0.5;
const TOO_MANY_BEYOND: f64 = 0.95;
/// World units from which on nothing is there: scenes reach up to it.
const NOWHERE: f64 = 1e9;

/// What a scene's depths come to. `Display` is one line for people.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DepthReport {
    /// The name of the file's channel; `None` for depths that were made in code.
    pub channel: Option<String>,
    /// The least and the greatest depth, world units; `None` if no pixel has one.
    pub range: Option<(f32, f32)>,
    /// The share of the pixels, 0 to 1, that have no depth: there nothing hides the light.
    pub without: f64,
    /// The share of the pixels, 0 to 1, whose depth lies before the projection plane: there nothing is drawn.
    pub before_plane: f64,
    /// The share of the pixels, 0 to 1, whose depth lies beyond the ray's end: there nothing is hidden.
    pub beyond_rays: f64,
    /// What is likely wrong with them, one line each.
    pub warnings: Vec<String>,
}

impl Scene {
    /// Looks at all depths of the scene; `None` if it has none. Takes a moment: about 10 ns a pixel.
    #[must_use]
    pub fn depth_report(&self) -> Option<DepthReport> {
        let depth = self.depth.as_ref()?;
        let plane = ViewPlane::new(&self.camera, depth.size(), self.ray_length());
        let counts = Counts::of(depth, &plane, depth.size());
        let share = |count: usize| count as f64 / counts.pixels.max(1) as f64;
        Some(DepthReport {
            channel: depth.channel().map(str::to_owned),
            range: (counts.with > 0).then_some((counts.nearest, counts.farthest)),
            without: share(counts.pixels - counts.with),
            before_plane: share(counts.before),
            beyond_rays: share(counts.beyond),
            warnings: warnings(depth, self, &counts),
        })
    }
}

impl std::fmt::Display for DepthReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(channel) = &self.channel {
            write!(f, "channel {}, ", shown(channel))?;
        }
        match self.range {
            Some((nearest, farthest)) => write!(f, "{nearest} to {farthest}, ")?,
            None => write!(f, "no pixel has a depth, ")?,
        }
        write!(
            f,
            "{} of the pixels without a depth, {} before the projection plane (nothing is drawn there), {} beyond the \
             rays (nothing is hidden there)",
            percent(self.without),
            percent(self.before_plane),
            percent(self.beyond_rays)
        )
    }
}

/// How many pixels have a depth, and where it lies.
struct Counts {
    pixels: usize,
    with: usize,
    zero: usize,
    before: usize,
    beyond: usize,
    nearest: f32,
    farthest: f32,
}

impl Counts {
    fn of(depth: &DepthImage, plane: &ViewPlane, image: ImageSize) -> Self {
        let mut counts = Self {
            pixels: depth.as_slice().len(),
            with: 0,
            zero: 0,
            before: 0,
            beyond: 0,
            nearest: f32::INFINITY,
            farthest: 0.0,
        };
        let rows = depth.as_slice().chunks(image.width.max(1) as usize);
        for (row, values) in rows.enumerate() {
            let mut pixel = plane.first_pixel + plane.row_step * row as f64;
            for &value in values {
                let to_plane = plane.before_plane(pixel);
                pixel += plane.column_step;
                if f64::from(value) >= NOWHERE {
                    continue;
                }
                let distance = plane.distance(value, depth.along(), to_plane);
                counts.with += 1;
                counts.zero += usize::from(value == 0.0);
                counts.before += usize::from(distance < to_plane);
                counts.beyond += usize::from(distance >= to_plane + plane.ray_length);
                counts.nearest = counts.nearest.min(value);
                counts.farthest = counts.farthest.max(value);
            }
        }
        counts
    }
}

fn warnings(depth: &DepthImage, scene: &Scene, counts: &Counts) -> Vec<String> {
    let camera = &scene.camera;
    let mut found = Vec::new();
    if let (Some(all), Some(channel)) = (depth.doubt(), depth.channel()) {
        found.push(format!(
            "channel {} is taken for the depth because of its name; name it as the depth's `channel` to be sure; {all}",
            shown(channel)
        ));
    }
    let others = counts.with - counts.zero;
    let is_over = |count: usize, share: f64| others > 0 && count as f64 >= share * others as f64;
    let before = counts.before - counts.zero;
    let is_before = is_over(before, TOO_MANY_BEFORE);
    let looks_farther = scene.focus() > 1.0;
    let is_everywhere = counts.with == counts.pixels && looks_farther;
    if others > 0 && counts.farthest <= 1.0 && (is_everywhere || is_before) {
        found.push(format!(
            "all depths lie between {} and {}: likely those of a z-buffer, which are no lengths, or in other units; \
             give `along = \"ndc\"` with a projection, or `scale`",
            counts.nearest, counts.farthest
        ));
    } else if is_before {
        found.push(format!(
            "{} of the depths lie before the projection plane, {} from the eye, where nothing is drawn: likely they \
             are in other units; give `scale`, or a smaller `near`",
            percent(before as f64 / others as f64),
            camera.near
        ));
    } else if is_over(counts.beyond, TOO_MANY_BEYOND) {
        found.push(format!(
            "{} of the depths lie beyond the ends of the rays, {} from the projection plane, so that they hide \
             nothing: likely they are in other units; give `scale`",
            percent(counts.beyond as f64 / others as f64),
            scene.ray_length()
        ));
    } else if counts.zero > 0 {
        found.push(format!(
            "{} of the pixels have depth 0, and nothing is drawn there; if 0 means that nothing is there, give \
             `none = 0`",
            percent(counts.zero as f64 / counts.pixels as f64)
        ));
    }
    found
}

/// Writes a share as whole percents, but never some as none or as all.
fn percent(share: f64) -> String {
    let whole = (100.0 * share).round();
    match whole as u32 {
        0 if share > 0.0 => "under 1 %".to_owned(),
        100 if share < 1.0 => "over 99 %".to_owned(),
        whole => format!("{whole} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::DepthAlong;
    use crate::scene::Camera;
    use glam::DVec3;

    /// Eye at 4 before the origin, plane at 1, rays of 8; what is said of depths of a function of the column, 0 to 99.
    fn report(depth: impl Fn(u32) -> f32) -> DepthReport {
        let mut camera = Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO);
        camera.ray_length = Some(8.0);
        let mut scene = Scene::new(camera);
        scene.image = ImageSize {
            width: 100,
            height: 100,
        };
        let values = (0..10_000).map(|pixel| depth(pixel % 100)).collect();
        scene.depth = Some(DepthImage::new(scene.image, DepthAlong::Axis, values).unwrap());
        scene.depth_report().unwrap()
    }

    #[test]
    fn shares_and_range_are_those_of_the_pixels() {
        let found = report(|column| match column {
            0..10 => 0.5,
            10..30 => f32::INFINITY,
            30..35 => 1e10,
            35 => 900.0,
            _ => 3.0,
        });
        assert_eq!(found.range, Some((0.5, 900.0)));
        let shares = [found.without, found.before_plane, found.beyond_rays];
        assert_eq!(shares, [0.25, 0.1, 0.01]);
        assert_eq!(found.warnings, Vec::<String>::new());
        let line = "0.5 to 900, 25 % of the pixels without a depth, 10 % before the projection plane (nothing is drawn \
                    there), 1 % beyond the rays (nothing is hidden there)";
        assert_eq!(found.to_string(), line);
        let open = report(|_| f32::INFINITY);
        assert_eq!((open.range, open.without), (None, 1.0));
        assert!(open.warnings.is_empty() && open.to_string().starts_with("no pixel has a depth"));
    }

    #[test]
    fn depths_in_other_units_and_of_z_buffers_are_told() {
        let told = |depth: fn(u32) -> f32, words: &str| {
            let found = report(depth).warnings;
            assert_eq!(found.len(), 1, "{words}: {found:?}");
            assert!(found[0].contains(words), "{found:?}");
        };
        told(
            |column| 300.0 + column as f32,
            "100 % of the depths lie beyond the ends",
        );
        told(
            |column| if column < 3 { 3.0 } else { 400.0 },
            "97 % of the depths lie beyond",
        );
        told(
            |column| 0.003 + 1e-5 * column as f32,
            "all depths lie between 0.003 and",
        );
        told(
            |column| if column < 45 { 3.0 } else { 0.4 },
            "55 % of the depths lie before the projection plane, 1 from",
        );
        told(
            |column| 0.9 + 0.001 * column as f32,
            "likely those of a z-buffer",
        );
        told(
            |column| if column < 50 { 0.0 } else { 0.3 },
            "likely those of a z-buffer",
        );
        told(
            |column| if column < 50 { 0.0 } else { 3.0 },
            "50 % of the pixels have depth 0",
        );
        told(|_| 0.0, "100 % of the pixels have depth 0");
        assert!(
            report(|column| 1.5 + 0.02 * column as f32)
                .warnings
                .is_empty()
        );
        assert!(
            report(|column| if column < 90 { f32::INFINITY } else { 3.0 })
                .warnings
                .is_empty()
        );
    }
}
