//! Points whose light is spread, along a trail or over a Gaussian ball, in a crowd: each is as many single points as
//! its crowd needs, which lie evenly (Roberts 2018), those of one between those of the next. `erf(d / (sqrt(2) radius))
//! / d` is the potential of a Gaussian, and light adds up: nothing but the number of points is an approximation.

use std::ops::Range;
use std::sync::OnceLock;

use glam::DVec3;

use super::{CrowdSight, Points, Profile, Scene};

/// So many radii from its middle hardly anything of a ball is left.
const AROUND: f64 = 5.0;

/// So many points at most stand for one, and so many for each pixel that it is wide.
const MOST_PARTS: f64 = 4096.0;
const PARTS_PER_PIXEL: f64 = 8.0;

/// So many times the square root of a crowd's number, over its tolerance, stand for all of its light: of trails, and of
/// balls, whose points lie less evenly.
const OF_TRAILS: f64 = 0.5;
const OF_BALLS: f64 = 2.0;

/// The fractions of multiples of these lie evenly on a line, and in a cube: powers of the roots of `x^2 = x + 1` and
/// `x^4 = x + 1`.
const ON_LINE: f64 = 0.618_033_988_749_894_9;
const IN_CUBE: [f64; 3] = [
    0.819_172_513_396_164_4,
    0.671_043_606_703_789_3,
    0.549_700_477_901_970_3,
];

/// Places in a ball before they begin again.
const PLACES: usize = 1 << 14;

/// How many points stand for one, by its light.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spreading {
    per_light: f64,
    /// Points that are brighter are not part of the crowd.
    pub limit: f64,
}

impl Scene {
    /// Returns how many points stand for one in the crowd of a profile: so many that what each shows too much or too
    /// little next to it, from all points around, is within the tolerance of the light of all.
    pub(crate) fn spreading(&self, profile: Profile) -> Spreading {
        let crowd = || {
            self.points
                .iter()
                .filter(|it| it.crowd_profile() == profile)
        };
        let count: usize = crowd().map(|it| it.points.len()).sum();
        let limit = self.crowd_limit(profile);
        let tolerance = self.integration.method.tolerance();
        let all = limit / super::crowd_sight::SHARE_OF_ONE;
        Spreading {
            per_light: (count as f64).sqrt() / (tolerance * all.max(f64::MIN_POSITIVE)),
            limit,
        }
    }
}

impl Points {
    /// Returns the profile of the crowd that they may be part of.
    pub(crate) fn crowd_profile(&self) -> Profile {
        match self.profile {
            Profile::Smeared => Profile::Inverse,
            other => other,
        }
    }

    /// Returns whether light of theirs is spread.
    pub(crate) fn is_spread(&self) -> bool {
        self.radius > 0.0 || self.points.sizes().is_some() || self.points.has_trails()
    }

    /// Returns how far from its place the light of a point reaches that is spread, as far as that counts.
    pub(super) fn greatest_spread(&self) -> f64 {
        let greatest =
            |sizes: &[super::PointSize]| sizes.iter().map(|it| it.radius).fold(0.0, f64::max);
        AROUND * self.points.sizes().map_or(self.radius, greatest)
    }

    /// Returns whether a point is where rays begin that are seen, or near there, or a part of it is.
    pub(crate) fn is_at_plane(&self, index: usize, sight: &CrowdSight) -> bool {
        let place = self.points.position(index);
        if !self.is_spread() {
            return sight.is_at_plane(sight.seen(place));
        }
        let around = AROUND * self.radius(index);
        let depth = |place: DVec3| (place - sight.eye).dot(sight.forward);
        let own = depth(place);
        let other = self.points.previous_position(index).map_or(own, depth);
        sight.meets_plane(own.min(other) - around, own.max(other) + around)
    }

    /// Calls `visit` with place and light of each of the points that stand for some, but for those that are no part of
    /// the crowd.
    pub(crate) fn for_each_part(
        &self,
        range: Range<usize>,
        (sight, spreading): (&CrowdSight, Spreading),
        mut visit: impl FnMut(DVec3, DVec3),
    ) {
        let pixel = (sight.step[0] * sight.step[1]).sqrt();
        let places = places_in_ball();
        let caution = if self.points.has_trails() {
            OF_TRAILS
        } else {
            OF_BALLS
        };
        let per_light = caution * spreading.per_light;
        let is_near = self.is_around_plane(sight);
        for index in range {
            let light = self.light(index);
            let most = light.max_element();
            let is_apart = most > spreading.limit || is_near && self.is_at_plane(index, sight);
            if is_apart || most == 0.0 {
                continue;
            }
            let (place, radius) = (self.points.position(index), self.radius(index));
            let way = self
                .points
                .previous_position(index)
                .map_or(DVec3::ZERO, |it| it - place);
            let far = (place - sight.eye).dot(sight.forward).abs().max(sight.near);
            let pixels = (way.length() + 4.0 * radius) / (far * pixel);
            let wanted = (most * per_light).min(1.0 + PARTS_PER_PIXEL * pixels);
            let least = wanted.clamp(1.0, MOST_PARTS);
            // Conversions are quicker here than what rounds.
            let count = f64::from(least as u32 + u32::from(f64::from(least as u32) < least));
            let turns = index as f64 * ON_LINE;
            let begin = turns - f64::from(turns as u32);
            let first = index.wrapping_mul(count as usize);
            for part in 0..count as usize {
                let share = (part as f64 + begin) / count;
                let there = radius * places[(first + part) % PLACES];
                visit(place + share * way + there, light / count);
            }
        }
    }
}

/// Returns where points lie that stand for a ball of the radius 1, each beside the one that is opposite.
fn places_in_ball() -> &'static [DVec3] {
    static BALL: OnceLock<Vec<DVec3>> = OnceLock::new();
    BALL.get_or_init(|| {
        let place = |number: usize| {
            let step = (number / 2) as f64 + 0.5;
            let [turn, height, share] = IN_CUBE.map(|power| (step * power).fract());
            let (sine, cosine) = (std::f64::consts::TAU * turn).sin_cos();
            let z = 2.0 * height - 1.0;
            let across = (1.0 - z * z).sqrt();
            let place = gaussian_radius(share) * DVec3::new(across * cosine, across * sine, z);
            match number.is_multiple_of(2) {
                true => place,
                false => -place,
            }
        };
        (0..PLACES).map(place).collect()
    })
}

/// Returns the radius within which a share of a Gaussian ball of the standard deviation 1 lies.
fn gaussian_radius(share: f64) -> f64 {
    use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_SQRT_PI};
    let within = |r: f64| {
        let density = FRAC_2_SQRT_PI * FRAC_1_SQRT_2 * (-0.5 * r * r).exp();
        libm::erf(r * FRAC_1_SQRT_2) - r * density
    };
    let (mut low, mut high) = (0.0, 10.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        match within(middle) < share {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The potential of the places that stand for a ball is that of the ball.
    #[test]
    fn places_in_a_ball_have_its_potential() {
        let places = places_in_ball();
        let off = |from: DVec3, spoiled: f64| {
            let to = |place: &DVec3| (spoiled * *place).distance(from).recip();
            let sum: f64 = places.iter().map(to).sum();
            let distance = from.length();
            let expected = libm::erf(distance / 2.0_f64.sqrt()) / distance;
            (sum / PLACES as f64 / expected - 1.0).abs()
        };
        let mut spoiled = 0.0_f64;
        for distance in [0.5, 1.0, 2.0, 5.0] {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE.normalize()] {
                let found = off(distance * axis, 1.0);
                assert!(found < 1e-3, "at {distance} along {axis}: {found:.1e}");
                spoiled = spoiled.max(off(distance * axis, 1.05));
            }
        }
        assert!(spoiled > 1e-2, "balls of other sizes are found");
    }
}
