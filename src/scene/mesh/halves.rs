//! Triangles in float64, for those who ask on the host what is where: halved along the longest axis of the box around
//! them, and each that a ray may meet solved for its three unknowns (Moeller, Trumbore 1997). What is found depends on
//! the triangles alone, not on how they are halved: of several at one place the first of the scene counts.

use glam::DVec3;

use super::Mesh;

/// Triangles that are halved no further.
const LEAF: usize = 4;

/// A ray within this share of an edge meets the triangle: of two that share it, at least one.
const EDGE: f64 = 1e-12;

/// Boxes that wait at most: halves of halves of 2^26 triangles, one more at each level.
const WAITING: usize = 64;

/// Triangles in halves of halves.
#[derive(Debug)]
pub(crate) struct Halves {
    triangles: Vec<Triangle>,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Triangle {
    pub corners: [DVec3; 3],
    pub mesh: usize,
    /// Its number among all.
    pub number: u32,
}

/// A box around triangles, or around two boxes.
#[derive(Debug, Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    first: usize,
    /// Of triangles; 0: there are two boxes.
    count: usize,
}

impl Triangle {
    fn center(&self, axis: usize) -> f64 {
        let at = |corner: DVec3| corner.to_array()[axis];
        self.corners.iter().map(|corner| at(*corner)).sum()
    }

    /// Returns the direction from which its corners go round counterclockwise, of length 1.
    pub(crate) fn normal(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a).normalize_or(DVec3::Z)
    }

    /// Returns how far along a ray it is met.
    fn distance(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let (distance, is_within) = self.crossing(origin, direction);
        (is_within && distance > 0.0).then_some(distance)
    }

    /// Returns where a line crosses its plane, in lengths of the direction, and whether it does so within its edges.
    pub(crate) fn crossing(&self, origin: DVec3, direction: DVec3) -> (f64, bool) {
        let [a, b, c] = self.corners;
        let (ab, ac, from_a) = (b - a, c - a, origin - a);
        let across = direction.cross(ac);
        let volume = ab.dot(across);
        let turned = from_a.cross(ab);
        let (u, v) = (from_a.dot(across) / volume, direction.dot(turned) / volume);
        let distance = ac.dot(turned) / volume;
        (distance, u >= -EDGE && v >= -EDGE && u + v <= 1.0 + EDGE)
    }

    /// Returns its place that is nearest to a point (Ericson 2005, chapter 5.1.5).
    pub(crate) fn nearest_to(&self, point: DVec3) -> DVec3 {
        let [a, b, c] = self.corners;
        let (ab, ac) = (b - a, c - a);
        let along = |from: DVec3| (ab.dot(point - from), ac.dot(point - from));
        let ((a1, a2), (b1, b2), (c1, c2)) = (along(a), along(b), along(c));
        if a1 <= 0.0 && a2 <= 0.0 {
            return a;
        }
        if b1 >= 0.0 && b2 <= b1 {
            return b;
        }
        if c2 >= 0.0 && c1 <= c2 {
            return c;
        }
        let beside_c = a1 * b2 - b1 * a2;
        if beside_c <= 0.0 && a1 >= 0.0 && b1 <= 0.0 {
            return a + a1 / (a1 - b1) * ab;
        }
        let beside_b = c1 * a2 - a1 * c2;
        if beside_b <= 0.0 && a2 >= 0.0 && c2 <= 0.0 {
            return a + a2 / (a2 - c2) * ac;
        }
        let beside_a = b1 * c2 - c1 * b2;
        let (from_b, from_c) = (b2 - b1, c1 - c2);
        if beside_a <= 0.0 && from_b >= 0.0 && from_c >= 0.0 {
            return b + from_b / (from_b + from_c) * (c - b);
        }
        let all = 1.0 / (beside_a + beside_b + beside_c);
        a + beside_b * all * ab + beside_c * all * ac
    }
}

impl Halves {
    /// Halves the triangles of meshes, of which there is one at least.
    pub(crate) fn new(meshes: &[Mesh]) -> Self {
        let mut triangles = Vec::new();
        for (mesh, it) in meshes.iter().enumerate() {
            let placed = it.placed_vertices();
            let corners = it.triangles.triangles().iter();
            let corners = corners.map(|corners| corners.map(|corner| placed[corner as usize]));
            triangles.extend(corners.map(|corners| (corners, mesh)));
        }
        Self::of(triangles)
    }

    /// Halves triangles, by their corners and the mesh that they are of.
    pub(crate) fn of(triangles: impl IntoIterator<Item = ([DVec3; 3], usize)>) -> Self {
        let numbered = triangles.into_iter().zip(0..);
        let numbered = numbered.map(|((corners, mesh), number)| Triangle {
            corners,
            mesh,
            number,
        });
        let mut triangles: Vec<Triangle> = numbered.collect();
        let mut nodes = vec![node_of(&triangles, 0)];
        let mut waiting = vec![(0, 0, triangles.len())];
        while let Some((number, begin, end)) = waiting.pop() {
            if end - begin <= LEAF {
                continue;
            }
            let size: DVec3 = nodes[number].high - nodes[number].low;
            let axis = size.max_position();
            let middle = begin + (end - begin) / 2;
            triangles[begin..end].select_nth_unstable_by(middle - begin, |one, other| {
                one.center(axis).total_cmp(&other.center(axis))
            });
            let first = nodes.len();
            (nodes[number].first, nodes[number].count) = (first, 0);
            for (place, (begin, end)) in [(begin, middle), (middle, end)].into_iter().enumerate() {
                nodes.push(node_of(&triangles[begin..end], begin));
                waiting.push((first + place, begin, end));
            }
        }
        Self { triangles, nodes }
    }

    /// Returns one of them.
    pub(crate) fn any(&self) -> &Triangle {
        &self.triangles[0]
    }

    /// Returns the corners of the box around all.
    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        (self.nodes[0].low, self.nodes[0].high)
    }

    /// Returns what a ray meets first, and how far along it, in lengths of the direction.
    pub(crate) fn nearest(&self, origin: DVec3, direction: DVec3) -> Option<(f64, &Triangle)> {
        let mut met: Option<(f64, &Triangle)> = None;
        self.along(
            origin,
            direction,
            f64::INFINITY,
            0.0,
            &mut |triangle, most| {
                if let Some(length) = triangle.distance(origin, direction) {
                    let is_nearer = met
                        .is_none_or(|(before, it)| (length, triangle.number) < (before, it.number));
                    if is_nearer {
                        met = Some((length, triangle));
                        *most = length;
                    }
                }
            },
        );
        met
    }

    /// Shows the triangles in boxes that a way meets, near ones first, up to so many times its length, which `see` may
    /// lessen. Boxes are larger by a margin to each side.
    pub(crate) fn along<'a>(
        &'a self,
        origin: DVec3,
        direction: DVec3,
        mut most: f64,
        margin: f64,
        see: &mut impl FnMut(&'a Triangle, &mut f64),
    ) {
        let inverse = direction.recip();
        let (mut waiting, mut count) = ([0_usize; WAITING], 1);
        while count > 0 {
            count -= 1;
            let node = &self.nodes[waiting[count]];
            if !node.is_met(origin, inverse, most, margin) {
                continue;
            }
            if node.count == 0 {
                // The nearer one is looked at first.
                let (one, other) = (&self.nodes[node.first], &self.nodes[node.first + 1]);
                let way = (other.low + other.high - one.low - one.high).dot(direction);
                let second = usize::from(way < 0.0);
                waiting[count] = node.first + 1 - second;
                waiting[count + 1] = node.first + second;
                count += 2;
                continue;
            }
            for triangle in &self.triangles[node.first..node.first + node.count] {
                see(triangle, &mut most);
            }
        }
    }

    /// Shows the triangles in boxes that are no farther from a point than a distance, which `see` may lessen.
    pub(crate) fn around<'a>(
        &'a self,
        point: DVec3,
        mut most: f64,
        see: &mut impl FnMut(&'a Triangle, &mut f64),
    ) {
        let (mut waiting, mut count) = ([0_usize; WAITING], 1);
        while count > 0 {
            count -= 1;
            let node = &self.nodes[waiting[count]];
            if node.distance(point) > most {
                continue;
            }
            if node.count == 0 {
                let away = |number: usize| self.nodes[number].distance(point);
                let second = usize::from(away(node.first + 1) < away(node.first));
                waiting[count] = node.first + 1 - second;
                waiting[count + 1] = node.first + second;
                count += 2;
                continue;
            }
            for triangle in &self.triangles[node.first..node.first + node.count] {
                see(triangle, &mut most);
            }
        }
    }
}

impl Node {
    fn is_met(&self, origin: DVec3, inverse: DVec3, most: f64, margin: f64) -> bool {
        // Along an axis that the ray does not go along, 0 times infinity is no number, which min and max pass over.
        let (low, high) = (
            (self.low - margin - origin) * inverse,
            (self.high + margin - origin) * inverse,
        );
        let pairs = low.to_array().into_iter().zip(high.to_array());
        let (first, last) = pairs.fold((0.0_f64, most), |(first, last), (low, high)| {
            (first.max(low.min(high)), last.min(low.max(high)))
        });
        first <= last * (1.0 + 1e-12)
    }

    fn distance(&self, point: DVec3) -> f64 {
        point.distance(point.clamp(self.low, self.high))
    }
}

fn node_of(triangles: &[Triangle], first: usize) -> Node {
    let corners = triangles.iter().flat_map(|it| it.corners);
    let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = corners.fold(empty, |(low, high), it| (low.min(it), high.max(it)));
    let count = triangles.len();
    Node {
        low,
        high,
        first,
        count,
    }
}
