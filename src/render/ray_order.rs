//! An order of rays in which those that follow each other are alike. Kernels integrate 16 rays side by side, and cut
//! panels for all of them where one needs it: rays at random take twice as long as rays of neighbouring pixels.
//!
//! A ray is its direction u, and the point p of its line next to the middle of all. Each gets a cell, by halving six
//! extents, the longest first: those of p, and those of u times half of a ray's length, as far as ends are apart. The
//! order is that of the cells' numbers (Morton 1966), found by counting.

use glam::DVec3;

use crate::scene::Ray;
use crate::threads;

/// Bits of a cell's number: as many cells as there are groups of 16 rays among 65536, and some.
const BITS: usize = 14;

/// Rays at a time, of each thread.
const AT_ONCE: usize = 1024;

/// Extents reach so many standard deviations to both sides: a few rays elsewhere do not matter.
const DEVIATIONS: f64 = 2.0;

/// Extents and the middle are those of some of the rays, about so many.
const SAMPLE: usize = 4096;

/// Returns places in a list of valid rays, alike ones next to each other.
pub(super) fn alike(rays: &[Ray]) -> Vec<u32> {
    let sample = || rays.iter().step_by(rays.len().div_ceil(SAMPLE).max(1));
    let count = sample().count() as f64;
    let middle = sample().map(|ray| ray.at(0.5)).sum::<DVec3>() / count;
    let half_length = sample().map(|ray| ray.span.length()).sum::<f64>() / count / 2.0;
    let features: Vec<_> = sample()
        .map(|ray| feature_of(ray, middle, half_length))
        .collect();
    let cells = Cells::around(&features);
    let mut numbers = vec![0; rays.len().next_multiple_of(AT_ONCE)];
    threads::for_each_chunk(&mut numbers, AT_ONCE, |chunk, numbers| {
        let rays = &rays[chunk * AT_ONCE..];
        for (number, ray) in numbers.iter_mut().zip(rays) {
            *number = cells.number(&feature_of(ray, middle, half_length));
        }
    });
    by_number(&numbers[..rays.len()])
}

fn feature_of(ray: &Ray, middle: DVec3, half_length: f64) -> [f64; 6] {
    let direction = ray.span / ray.span.length();
    let from_middle = ray.origin - middle;
    let beside = from_middle - direction * from_middle.dot(direction);
    let aside = direction * half_length;
    [beside.x, beside.y, beside.z, aside.x, aside.y, aside.z]
}

/// A grid of cells.
struct Cells {
    features: Vec<Halved>,
}

/// A feature whose extent is halved.
struct Halved {
    index: usize,
    /// Where the extent begins, and how many cells there are to a unit.
    begin: f64,
    per_unit: f64,
    /// What each cell of the extent has in the numbers of the grid's.
    bits: Vec<u16>,
}

impl Cells {
    fn around(features: &[[f64; 6]]) -> Self {
        let count = features.len() as f64;
        let (mut begin, mut extents) = ([0.0; 6], [0.0; 6]);
        for index in 0..6 {
            let values = || features.iter().map(|feature| feature[index]);
            let mean = values().sum::<f64>() / count;
            let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
            let reach = DEVIATIONS * variance.sqrt();
            (begin[index], extents[index]) = (mean - reach, 2.0 * reach);
        }
        let (mut left, mut halvings) = (extents, [0_u32; 6]);
        let mut whose = [0; BITS];
        for index in &mut whose {
            *index = (0..6).fold(0, |best, it| if left[it] > left[best] { it } else { best });
            left[*index] *= 0.5;
            halvings[*index] += 1;
        }
        let halved = (0..6).filter(|index| halvings[*index] > 0);
        let features = halved.map(|index| {
            let count = 1_u16 << halvings[index];
            // The bits of the number that are this feature's, the lowest first.
            let own = || (0..BITS).filter(|bit| whose[BITS - 1 - bit] == index);
            let bits_of = |place: u16| {
                let bits = own().enumerate();
                bits.fold(0, |bits, (k, bit)| bits | (place >> k & 1) << bit)
            };
            Halved {
                index,
                begin: begin[index],
                per_unit: f64::from(count) / extents[index].max(f64::MIN_POSITIVE),
                bits: (0..count).map(bits_of).collect(),
            }
        });
        Self {
            features: features.collect(),
        }
    }

    fn number(&self, feature: &[f64; 6]) -> u16 {
        let bits = self.features.iter().map(|it| {
            let place = (feature[it.index] - it.begin) * it.per_unit; // below is 0, and so is what is no number
            it.bits[(place as usize).min(it.bits.len() - 1)]
        });
        bits.fold(0, |number, bits| number | bits)
    }
}

/// Returns places by rising numbers, those of one number in their order.
fn by_number(numbers: &[u16]) -> Vec<u32> {
    let mut next = vec![0_u32; (1 << BITS) + 1];
    for number in numbers {
        next[usize::from(*number) + 1] += 1;
    }
    for number in 1..next.len() {
        next[number] += next[number - 1];
    }
    let mut order = vec![0; numbers.len()];
    for (place, number) in numbers.iter().enumerate() {
        let next = &mut next[usize::from(*number)];
        order[*next as usize] = place as u32;
        *next += 1;
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays from a ball to a square, spread evenly in five dimensions.
    fn rays(count: u32) -> Vec<Ray> {
        let ray = |number: u32| {
            let [a, b, c, d, e] = [1_i32, 2, 3, 4, 5]
                .map(|power| (f64::from(number) * 1.2207_f64.powi(-power)).fract() - 0.5);
            Ray::between(DVec3::new(a, b - 4.0, c), DVec3::new(3.0 * d, 4.0, 3.0 * e))
        };
        (0..count).map(ray).collect()
    }

    /// Returns how far rays that follow each other are apart at both ends, in the mean.
    fn apart(rays: &[Ray], order: &[u32]) -> f64 {
        let pairs = order.windows(2).map(|pair| {
            let [one, other] = [pair[0], pair[1]].map(|place| &rays[place as usize]);
            (one.at(0.0) - other.at(0.0)).length() + (one.at(1.0) - other.at(1.0)).length()
        });
        pairs.sum::<f64>() / (order.len() - 1) as f64
    }

    #[test]
    fn neighbours_are_alike_and_every_ray_is_there_once() {
        let mut rays = rays(20_001);
        let given: Vec<u32> = (0..rays.len() as u32).collect();
        for spoiled in [0.0, 1e9] {
            rays[7].origin.x += spoiled; // one elsewhere does not matter
            let order = alike(&rays);
            let (before, after) = (apart(&rays, &given), apart(&rays, &order));
            let ways = spoiled * 4.0 / 2e4; // there and back, at both ends
            let (before, after) = (before - ways, after - ways);
            println!("rays {before} apart as given, {after} in order");
            assert!(after < 0.4 * before);
            let mut places = order;
            places.sort_unstable();
            assert_eq!(places, given);
        }
    }

    #[test]
    fn rays_that_are_all_the_same_keep_their_order() {
        let same = vec![rays(2)[1]; 100];
        assert_eq!(alike(&same), (0..100).collect::<Vec<_>>());
        assert_eq!(alike(&same[..1]), [0]);
        assert!(alike(&[]).is_empty());
    }
}
