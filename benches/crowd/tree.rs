//! A plain tree code for light along rays: an octree whose nodes stand for their points where they are narrow beside
//! their distance from the ray (Barnes, Hut 1986).

use energywave::scene::{Decay, Points, Profile, Ray};
use glam::DVec3;

/// A node has no children if it has no more points.
const FEW: usize = 8;

struct Node {
    /// The mean place of its points, by their light, how far the farthest is from there, and the light of all.
    middle: DVec3,
    radius: f64,
    light: DVec3,
    /// Of its own, where it has no children.
    points: Vec<(DVec3, DVec3)>,
    children: Vec<Node>,
}

pub struct Tree {
    root: Node,
    profile: Profile,
    decay: Decay,
}

impl Tree {
    /// Makes the tree of points that have lights of their own.
    pub fn new(points: &Points, decay: Decay) -> Self {
        let places = points.points.positions().iter();
        let lights = points.points.lights().unwrap().iter();
        let light = |light: &[f32; 3]| points.coefficient * DVec3::from(light.map(f64::from));
        let all = places.copied().zip(lights.map(light)).collect();
        Self {
            root: Node::new(all),
            profile: points.profile,
            decay,
        }
    }

    /// Returns the light along a ray over s, where nodes may be so wide by their distance; counts points and nodes.
    pub fn light(&self, ray: &Ray, opening: f64, evaluations: &mut usize) -> DVec3 {
        let mut light = DVec3::ZERO;
        let mut open = vec![&self.root];
        while let Some(node) = open.pop() {
            if node.radius <= opening * distance(ray, node.middle) {
                *evaluations += 1;
                light += node.light * self.integral(ray, node.middle);
                continue;
            }
            *evaluations += node.points.len();
            for (place, own) in &node.points {
                light += *own * self.integral(ray, *place);
            }
            open.extend(&node.children);
        }
        light
    }

    /// Returns the integral of `zeta / d` or `zeta / d^2` over a ray: with `v = -1 / (s + beta)`, of a point's parabola
    /// `a v^2 + 2 b v + length^2`.
    fn integral(&self, ray: &Ray, place: DVec3) -> f64 {
        let Decay { alpha, beta, .. } = self.decay;
        let from = ray.origin - place;
        let length2 = ray.span.length_squared();
        let b0 = from.dot(ray.span);
        let beside2 = (from - ray.span * (b0 / length2)).length_squared();
        let a = (from - beta * ray.span).length_squared();
        let b = length2 * beta - b0;
        let root = (length2 * beside2).sqrt();
        let [(p0, x0), (p1, x1)] = [-1.0 / beta, -1.0 / (1.0 + beta)].map(|v| {
            let p = a * v + b;
            (p, p * p + root * root)
        });
        alpha
            * match self.profile {
                Profile::Inverse => {
                    let growth = (p1 / root).asinh() - (p0 / root).asinh();
                    (b * growth - (x1.sqrt() - x0.sqrt())) / (a * a.sqrt())
                }
                _ => {
                    let turn = (root * (p1 - p0)).atan2(root * root + p0 * p1);
                    let bent = (2.0 * b * b - a * length2) * turn / root;
                    (p1 - p0 + bent - b * (x1 / x0).ln()) / (a * a)
                }
            }
    }
}

impl Node {
    fn new(points: Vec<(DVec3, DVec3)>) -> Self {
        let weight = |light: &DVec3| light.element_sum();
        let light: DVec3 = points.iter().map(|(_, light)| *light).sum();
        let middle: DVec3 = points.iter().map(|(place, own)| *place * weight(own)).sum();
        let middle = middle / weight(&light);
        let far = |(place, _): &(DVec3, DVec3)| place.distance_squared(middle);
        let radius = points.iter().map(far).fold(0.0, f64::max).sqrt();
        let mut node = Self {
            middle,
            radius,
            light,
            points: Vec::new(),
            children: Vec::new(),
        };
        if points.len() <= FEW {
            node.points = points;
            return node;
        }
        let mut parts = [const { Vec::new() }; 8];
        for point in points {
            let above = point.0.cmpge(middle).bitmask();
            parts[above as usize].push(point);
        }
        let parts = parts.into_iter().filter(|part| !part.is_empty());
        node.children = parts.map(Node::new).collect();
        node
    }
}

/// Returns how far a place is from a ray.
fn distance(ray: &Ray, place: DVec3) -> f64 {
    let from = place - ray.origin;
    let share = from.dot(ray.span) / ray.span.length_squared();
    from.distance(ray.span * share.clamp(0.0, 1.0))
}
