//! A chain of straight pieces on the device (`cl/wave/source/path.h`).

use glam::DVec3;

use super::layout::Falloff;
use super::{Anchor, PackInto, Row, Rows, device_struct, falloff, fine, scene};
use crate::scene::{Light, LightAlong, PathLevel, PathPiece};

device_struct! {
    /// A chain of light.
    LightPath [48] {
        emission: [f32; 4] = 0,
        row: u32 = 16,
        level_count: u32 = 20,
        padding_0: u32 = 24,
        padding_1: u32 = 28,
        falloff: Falloff = 32,
    }
}

/// Groups of pieces have at least so many, and there are so many groups at most: kernels have a bit for each.
const LEAST_GROUP: usize = 4;
const MOST_GROUPS: usize = 256;

/// How far straight pieces may be off a curve, times the tolerance: a share of the distance that a ray passes it at.
const OF_DISTANCE: f64 = 0.3;

/// The same where light changes along the core, and jumps with the nearest part.
const OF_DISTANCE_WHERE_LIGHT_JUMPS: f64 = 0.01;

/// How far they may be off in pixels, times the tolerance; and at most.
const OF_PIXEL: f64 = 5.0;
const MOST_PIXELS: f64 = 0.008;

/// How far they may be off as a share of a piece's size where there are no pixels, times the tolerance; and at least.
const OF_SIZE: f64 = 1e-3;
const LEAST_OF_SIZE: f64 = 1e-8;

/// The share by which float32 may make a ball too small.
const BALL_MARGIN: f64 = 1e-5;

impl PackInto<LightPath> for scene::LightPath {
    fn pack_into(
        &self,
        list: &mut Vec<LightPath>,
        light: &Light,
        anchor: &Anchor,
        rows: &mut Rows,
    ) {
        let levels = self.levels(|piece| flatness(piece, anchor));
        let along = self.along(light);
        list.extend(along.iter().map(|along| pack_levels(&levels, along, anchor, rows)));
    }
}

fn pack_levels(
    levels: &[PathLevel],
    (light, knots): &LightAlong,
    anchor: &Anchor,
    rows: &mut Rows,
) -> LightPath {
    let of_distance = match knots.is_empty() {
        true => OF_DISTANCE,
        false => OF_DISTANCE_WHERE_LIGHT_JUMPS,
    };
    let row = rows.list.len();
    rows.has_series |= !knots.is_empty();
    rows.list.resize(row + 2 * levels.len(), [0.0; 4]);
    for (k, level) in levels.iter().enumerate() {
        let first = rows.list.len();
        let corners = lit_corners(&level.corners, knots);
        let count = corners.len();
        let group_size = count.div_ceil(MOST_GROUPS).max(LEAST_GROUP);
        push_level(&corners, group_size, anchor, rows);
        let sizes = [count, count.div_ceil(group_size), group_size, first];
        rows.list[row + 2 * k] = sizes.map(|size| f32::from_bits(size as u32));
        let from = level.off / (of_distance * anchor.tolerance);
        rows.list[row + 2 * k + 1] = [(from * from) as f32, level.off as f32, 0.0, 0.0];
    }
    LightPath {
        emission: anchor.emission(light.coefficient, light.color),
        row: row as u32,
        level_count: levels.len() as u32,
        padding_0: 0,
        padding_1: 0,
        falloff: falloff(light.falloff),
    }
}

/// Gives every corner what the light is multiplied with there, and makes a corner of every knot.
fn lit_corners(corners: &[DVec3], knots: &[(f64, f64)]) -> Vec<(DVec3, f64)> {
    if knots.is_empty() {
        return corners.iter().map(|corner| (*corner, 1.0)).collect();
    }
    let lengths = corners.windows(2).map(|pair| pair[0].distance(pair[1]));
    let whole: f64 = lengths.sum();
    let value = |share: f64| {
        let after = knots.partition_point(|(s, _)| *s <= share).clamp(1, knots.len() - 1);
        let ((s0, v0), (s1, v1)) = (knots[after - 1], knots[after]);
        v0 + (v1 - v0) * ((share - s0) / (s1 - s0)).clamp(0.0, 1.0)
    };
    let mut lit = vec![(corners[0], value(0.0))];
    let mut share = 0.0;
    for pair in corners.windows(2) {
        let next = share + pair[0].distance(pair[1]) / whole;
        let between = knots.iter().filter(|(s, _)| *s > share + 1e-9 && *s < next - 1e-9);
        lit.extend(between.map(|(s, v)| (pair[0].lerp(pair[1], (s - share) / (next - share)), *v)));
        lit.push((pair[1], value(next)));
        share = next;
    }
    lit
}

/// Packs a chain of straight lines.
fn push_level(corners: &[(DVec3, f64)], group_size: usize, anchor: &Anchor, rows: &mut Rows) {
    // A piece belongs to the group in which it begins.
    for first in (0..corners.len()).step_by(group_size) {
        let end = (first + group_size + 1).min(corners.len());
        rows.list.push(ball(anchor, &corners[first..end]));
    }
    for (k, (corner, value)) in corners.iter().enumerate() {
        let to_next = corners.get(k + 1).map_or(DVec3::ZERO, |(next, _)| next - corner);
        let position = anchor.position(*corner);
        let direction = fine(to_next.normalize_or_zero());
        let [x, y, z, _] = position.value;
        let [rest_x, rest_y, rest_z, _] = position.rest;
        rows.list.push([x, y, z, to_next.length() as f32]);
        rows.list.push([rest_x, rest_y, rest_z, *value as f32]);
        rows.list.extend([direction.value, direction.rest]);
    }
}

/// Returns how far chords may be off a piece.
fn flatness(piece: &PathPiece, anchor: &Anchor) -> f64 {
    let (center, radius) = piece.ball();
    let pixel = anchor.pixel * (center.distance(anchor.origin) - radius).max(0.0);
    let off = match anchor.pixel {
        0.0 => OF_SIZE * anchor.tolerance * radius,
        _ => (OF_PIXEL * anchor.tolerance).min(MOST_PIXELS) * pixel,
    };
    off.max(LEAST_OF_SIZE * radius)
}

/// Packs a ball around points: its centre, and its radius.
fn ball(anchor: &Anchor, corners: &[(DVec3, f64)]) -> Row {
    let points: Vec<DVec3> = corners.iter().map(|(corner, _)| *corner).collect();
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
    use crate::scene::{HasLight, LightPath, PathShape};

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
            pixel: 1e-3,
            tolerance: 1e-2,
            reduction: crate::scene::Reduction::Sum,
        };
        let mut rows = Rows::default();
        rows.list.push([7.0; 4]);
        let light = path.lights().next().unwrap();
        let mut list = Vec::new();
        path.pack_into(&mut list, &light, &anchor, &mut rows);
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
