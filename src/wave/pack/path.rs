//! A chain of straight pieces on the device (`cl/wave/source/path.h`).

use glam::DVec3;

use super::layout::Falloff;
use super::{Anchor, PackInto, Row, Rows, device_struct, falloff, fine, scene, vector};
use crate::scene::chain::{Corner, Level, LightAlong, LitChain, Piece, Run, series_at};

device_struct! {
    /// A chain of light.
    LightPath [48] {
        emission: [f32; 4] = 0,
        row: u32 = 16,
        level_count: u32 = 20,
        is_even: u32 = 24,
        most_bend: f32 = 28,
        falloff: Falloff = 32,
    }
}

/// Groups of pieces have at least so many, and there are so many groups at most: kernels have a bit for each.
const LEAST_GROUP: usize = 4;
const MOST_GROUPS: usize = 256;

/// How far straight pieces may be off a curve, times the tolerance: a share of the distance that a ray passes it at.
const OF_DISTANCE: f64 = 0.3;

/// The same where light changes along the core, and jumps with the nearest part.
const OF_DISTANCE_WHERE_LIGHT_JUMPS: f64 = 0.05;

/// There float32 loses more by shorter pieces than a tolerance below this gains.
const LEAST_TOLERANCE_WHERE_LIGHT_JUMPS: f64 = 1e-4;

/// How far light may be off a straight line in the middle of a stretch, times the tolerance.
const OF_LIGHT: f64 = 1.0;

/// How far they may be off in pixels, times the tolerance; and at most.
const OF_PIXEL: f64 = 5.0;
const MOST_PIXELS: f64 = 0.008;

/// How far they may be off as a share of a piece's size where there are no pixels, times the tolerance; and at least.
const OF_SIZE: f64 = 1e-3;
const LEAST_OF_SIZE: f64 = 1e-8;

/// The share by which float32 may make a ball too small.
const BALL_MARGIN: f64 = 1e-5;

/// Always a chain.
impl PackInto<LightPath> for scene::LightPath {}

/// Packs a chain with each of its lights.
pub(crate) fn pack_chain(lit: &LitChain, list: &mut Vec<LightPath>, anchor: &Anchor, rows: &mut Rows) {
    let most = match lit.is_even() {
        true => f64::INFINITY,
        false => off_where_light_jumps(anchor) * lit.chain.size(),
    };
    let levels = lit.chain.levels(|piece| flatness(piece, anchor).min(most));
    let pack = |along| pack_levels(&lit.chain.runs, &levels, along, anchor, rows);
    list.extend(lit.lights.iter().map(pack));
}

/// Returns how far straight pieces may be off, as a share of the distance.
fn off_where_light_jumps(anchor: &Anchor) -> f64 {
    OF_DISTANCE_WHERE_LIGHT_JUMPS * anchor.tolerance.max(LEAST_TOLERANCE_WHERE_LIGHT_JUMPS)
}

fn pack_levels(
    runs: &[Run],
    levels: &[Level],
    along: &LightAlong,
    anchor: &Anchor,
    rows: &mut Rows,
) -> LightPath {
    let has_fades = runs.iter().any(|run| run.fade != [1.0; 2]);
    let is_even = along.values.is_empty() && along.radii.is_empty() && !has_fades;
    let of_distance = match is_even {
        true => OF_DISTANCE * anchor.tolerance,
        false => off_where_light_jumps(anchor),
    };
    let row = rows.list.len();
    rows.has_series |= !is_even;
    rows.list.resize(row + 2 * levels.len(), [0.0; 4]);
    for (k, level) in levels.iter().enumerate() {
        let first = rows.list.len();
        let lit = runs.iter().zip(&level.runs);
        let corners: Vec<LitCorner> = lit
            .flat_map(|(run, corners)| lit_corners(run, corners, along))
            .collect();
        let count = corners.len();
        let group_size = count.div_ceil(MOST_GROUPS).max(LEAST_GROUP);
        push_level(&corners, group_size, anchor, rows);
        if !is_even {
            push_tangents(&corners, rows);
        }
        let sizes = [count, count.div_ceil(group_size), group_size, first];
        rows.list[row + 2 * k] = sizes.map(|size| f32::from_bits(size as u32));
        let from = level.off / of_distance;
        rows.list[row + 2 * k + 1] = [(from * from) as f32, level.off as f32, 0.0, 0.0];
    }
    let light = anchor.reduced(along.light);
    LightPath {
        emission: anchor.emission(light.coefficient, light.color),
        row: row as u32,
        level_count: levels.len() as u32,
        is_even: u32::from(is_even),
        most_bend: (OF_LIGHT * anchor.tolerance) as f32,
        falloff: falloff(light.falloff),
    }
}

/// A corner, with what light is multiplied with there and how thick the core is.
#[derive(Debug, Clone, Copy)]
struct LitCorner {
    corner: Corner,
    value: f64,
    radius: f64,
    is_first: bool,
    is_last: bool,
}

/// Knots this close to a corner, in shares of a run, are that corner.
const LEAST_STEP: f64 = 1e-9;

/// Gives every corner of a run what light and thickness are there, and makes a corner of every knot of theirs.
fn lit_corners(run: &Run, corners: &[Corner], along: &LightAlong) -> Vec<LitCorner> {
    let lit = |corner: Corner, own: f64| {
        let share = run.share(own);
        LitCorner {
            corner,
            value: run.fade(own) * series_at(&along.values, share, 1.0),
            radius: series_at(&along.radii, share, 0.0),
            is_first: false,
            is_last: false,
        }
    };
    let [begin, end] = run.shares;
    let knots = along.values.iter().chain(&along.radii).map(|(share, _)| *share);
    let mut knots: Vec<f64> = knots.map(|share| (share - begin) / (end - begin)).collect();
    knots.sort_by(f64::total_cmp);
    let length = |pair: &[Corner]| pair[0].at.distance(pair[1].at);
    let whole: f64 = corners.windows(2).map(length).sum();
    let mut found = vec![lit(corners[0], 0.0)];
    let mut own = 0.0;
    for pair in corners.windows(2) {
        let next = own + length(pair) / whole;
        let mut last = own;
        for &knot in &knots {
            if knot > last + LEAST_STEP && knot < next - LEAST_STEP {
                found.push(lit(between(pair, (knot - own) / (next - own)), knot));
                last = knot;
            }
        }
        found.push(lit(pair[1], next));
        own = next;
    }
    if let [first, ..] = &mut found[..] {
        first.is_first = true;
    }
    if let [.., last] = &mut found[..] {
        last.is_last = true;
    }
    found
}

/// Returns a point of a chord.
fn between(pair: &[Corner], share: f64) -> Corner {
    let along = pair[0].leaves.lerp(pair[1].arrives, share).normalize_or_zero();
    Corner {
        at: pair[0].at.lerp(pair[1].at, share),
        arrives: along,
        leaves: along,
    }
}

/// Packs chains of straight lines.
fn push_level(corners: &[LitCorner], group_size: usize, anchor: &Anchor, rows: &mut Rows) {
    // A piece belongs to the group in which it begins.
    for first in (0..corners.len()).step_by(group_size) {
        let end = (first + group_size + 1).min(corners.len());
        rows.list.push(ball(anchor, &corners[first..end]));
    }
    for (k, corner) in corners.iter().enumerate() {
        let to_next = match (corner.is_last, corners.get(k + 1)) {
            (false, Some(next)) => next.corner.at - corner.corner.at,
            _ => DVec3::ZERO,
        };
        let position = anchor.position(corner.corner.at);
        let direction = fine(to_next.normalize_or_zero());
        let with = |[x, y, z, _]: Row, last: f64| [x, y, z, last as f32];
        rows.list.push(with(position.value, to_next.length()));
        rows.list.push(with(position.rest, corner.value));
        rows.list.push(with(direction.value, corner.radius));
        rows.list.push(direction.rest);
    }
}

/// The cosine of the greatest angle by which a smooth core turns at a corner.
const LEAST_SMOOTH: f64 = 0.999;

/// Packs where the core goes at every corner.
fn push_tangents(corners: &[LitCorner], rows: &mut Rows) {
    for it in corners {
        let [x, y, z, _] = vector(it.corner.arrives);
        rows.list.push(vector(it.corner.leaves));
        let is_smooth = it.corner.arrives.dot(it.corner.leaves) > LEAST_SMOOTH;
        let joint = match (it.is_first, is_smooth) {
            (true, _) => 0.0,
            (false, true) => 2.0,
            (false, false) => 1.0,
        };
        rows.list.push([x, y, z, joint]);
    }
}

/// Returns how far chords may be off a piece.
fn flatness(piece: &Piece, anchor: &Anchor) -> f64 {
    let (center, radius) = piece.ball();
    let nearest = (center.distance(anchor.origin) - radius).max(0.0);
    let off = match anchor.pixel.at(nearest) {
        None => OF_SIZE * anchor.tolerance * radius,
        Some(pixel) => (OF_PIXEL * anchor.tolerance).min(MOST_PIXELS) * pixel,
    };
    off.max(LEAST_OF_SIZE * radius)
}

/// Packs a ball around points: its centre, and its radius.
fn ball(anchor: &Anchor, corners: &[LitCorner]) -> Row {
    let points: Vec<DVec3> = corners.iter().map(|it| it.corner.at).collect();
    let (center, radius) = ball_of(&points);
    let position = anchor.position(center);
    let rounded = 1e-6 * center.distance(anchor.origin);
    let [x, y, z, _] = position.value;
    [x, y, z, (radius * (1.0 + BALL_MARGIN) + rounded) as f32]
}

/// Returns the centre of the box around points, and how far from it they lie.
fn ball_of(points: &[DVec3]) -> (DVec3, f64) {
    let low = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let high = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
    let center = 0.5 * (low + high);
    let distances = points.iter().map(|point| point.distance(center));
    (center, distances.fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{LightPath, PathShape, SourceKind};

    #[test]
    fn balls_hold_the_pieces_of_their_groups_and_rows_lie_as_the_kernel_reads_them() {
        let mut random = fastrand::Rng::with_seed(3);
        let points = (0..50).map(|_| DVec3::from([0; 3].map(|_| random.f64())));
        let path = LightPath {
            shape: PathShape::Spline,
            ..LightPath::new(points.collect())
        };
        let anchor = Anchor {
            origin: DVec3::new(0.3, -5.0, 0.2),
            reach: 20.0,
            measure: 1.0,
            pixel: crate::wave::pack::Pixel::OfDistance(1e-3),
            tolerance: 1e-2,
            reduction: crate::scene::Reduction::Sum,
        };
        let mut rows = Rows::default();
        rows.list.push([7.0; 4]);
        let mut list = Vec::new();
        pack_chain(&path.as_chains().unwrap()[0], &mut list, &anchor, &mut rows);
        let packed = list[0];
        assert!(packed.level_count > 3);
        for level in 0..packed.level_count as usize {
            let at = packed.row as usize + 2 * level;
            let [corners, groups, group_size, balls] =
                rows.list[at].map(|size| size.to_bits() as usize);
            assert!(groups <= MOST_GROUPS && corners >= 50);
            let first = balls + groups;
            let corner = |k: usize| {
                let [x, y, z, length] = rows.list[first + 4 * k];
                (glam::Vec3::new(x, y, z), length)
            };
            for k in 0..corners {
                let [x, y, z, radius] = rows.list[balls + k / group_size];
                let center = glam::Vec3::new(x, y, z);
                let (at, length) = corner(k);
                assert!(at.distance(center) <= radius);
                if k + 1 == corners {
                    assert_eq!(length, 0.0);
                    continue;
                }
                let (next, _) = corner(k + 1);
                assert!(next.distance(center) <= radius);
                assert!((next.distance(at) - length).abs() < 1e-5);
            }
        }
    }
}
