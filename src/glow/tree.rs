//! Boxes around elements, for rays that are no picture's: a tree of neighbours (Meister, Bittner 2018: PLOC, by
//! `obvhs`), laid out as a walk down it meets its boxes, so that kernels need no stack.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::pack::{Element, GlowBox};
use super::shapes::{self, Shape};
use crate::error::{Error, Result};
use crate::memory;
use crate::scene::Scene;

/// Elements of a leaf, at most, and what one more box costs, elements.
const LEAF: u32 = 4;
const BOX_COST: f32 = 0.5;

/// Boxes are so much wider, of the greatest coordinate: rounding moves what is in them by less.
const WIDER: f64 = 4e-6;

/// Bytes that an element takes while a tree is built.
const BYTES: u64 = 400;

/// All that shines in a scene.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// From where positions are given, world space.
    pub origin: DVec3,
    pub boxes: Vec<GlowBox>,
    /// In the order of the boxes.
    pub elements: Vec<Element>,
}

impl Tree {
    /// Builds that of a valid scene's particles.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`] if the host has too little for it.
    pub(super) fn new(scene: &Scene) -> Result<Self> {
        let count = shapes::count(scene);
        if let Some(shortage) = memory::shortage(count as u64 * BYTES) {
            let message = format!("{count} particles of light: {shortage}");
            return Err(Error::OutOfMemory(message));
        }
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        shapes::for_each(scene, 0..count, |shape, _| {
            let [least, most] = around(shape);
            (low, high) = (low.min(least), high.max(most));
        });
        if low.x > high.x {
            return Ok(Self::default());
        }
        let origin = 0.5 * (low + high);
        let wider = WIDER * (high - origin).max_element();
        let (mut bounds, mut elements) = (Vec::new(), Vec::new());
        shapes::for_each(scene, 0..count, |shape, shine| {
            let shape = seen_from(shape, origin);
            let [least, most] = around(shape);
            let corner = |corner: DVec3| Vec3A::from(corner.as_vec3());
            bounds.push(Aabb::new(corner(least - wider), corner(most + wider)));
            elements.push(exact(Element::new(shape, shine), shape));
        });
        let (boxes, order) = walk(&bounds);
        Ok(Self {
            origin,
            boxes,
            elements: order.iter().map(|it| elements[*it as usize]).collect(),
        })
    }
}

/// Returns the corners of the box around a shape.
fn around(shape: Shape) -> [DVec3; 2] {
    match shape {
        Shape::Ball { center, radius } => [center - radius, center + radius],
        Shape::Stretch {
            ends: [from, to],
            radii: [first, last],
        } => [(from - first).min(to - last), (from + first).max(to + last)],
    }
}

fn seen_from(shape: Shape, origin: DVec3) -> Shape {
    match shape {
        Shape::Ball { center, radius } => Shape::Ball {
            center: center - origin,
            radius,
        },
        Shape::Stretch { ends, radii } => Shape::Stretch {
            ends: ends.map(|end| end - origin),
            radii,
        },
    }
}

/// Adds what float32 leaves of the middle.
fn exact(element: Element, shape: Shape) -> Element {
    let middle = match shape {
        Shape::Ball { center, .. } => center,
        Shape::Stretch { ends, .. } => 0.5 * (ends[0] + ends[1]),
    };
    let rest = (middle - middle.as_vec3().as_dvec3()).as_vec3();
    Element {
        rest_x: rest.x,
        rest_y: rest.y,
        rest_z: rest.z,
        ..element
    }
}

/// Returns the boxes of a tree, those within one behind it, and in which order leaves have what is bounded.
fn walk(bounds: &[Aabb]) -> (Vec<GlowBox>, Vec<u32>) {
    let numbers: Vec<u32> = (0..bounds.len() as u32).collect();
    let mut builder = PlocBuilder::with_capacity(bounds.len());
    let distance = PlocSearchDistance::Low;
    let mut tree = builder.build(distance, bounds, numbers, SortPrecision::U64, 2);
    collapse(&mut tree, LEAF, BOX_COST);
    let mut boxes: Vec<GlowBox> = Vec::with_capacity(tree.nodes.len());
    let mut order = Vec::with_capacity(bounds.len());
    // Boxes to come, and those whose last one was laid out.
    let mut waiting = vec![Ok(0_u32)];
    while let Some(next) = waiting.pop() {
        let number = match next {
            Ok(number) => number as usize,
            Err(done) => {
                let place: usize = done;
                boxes[place].next = boxes.len() as u32;
                continue;
            }
        };
        let node = &tree.nodes[number];
        let (first, count) = (node.first_index, node.prim_count);
        let begin = order.len() as u32;
        match count {
            0 => waiting.extend([Err(boxes.len()), Ok(first + 1), Ok(first)]),
            _ => {
                let range = first as usize..(first + count) as usize;
                order.extend_from_slice(&tree.primitive_indices[range]);
            }
        }
        boxes.push(GlowBox {
            low_x: node.min.x,
            low_y: node.min.y,
            low_z: node.min.z,
            next: begin,
            high_x: node.max.x,
            high_y: node.max.y,
            high_z: node.max.z,
            count,
        });
    }
    (boxes, order)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, LightElement};

    /// Balls along a spiral, some of them at one place, and a streak across.
    fn scene(count: u32) -> Scene {
        let mut scene = Scene::new(Camera::new(DVec3::X, DVec3::ZERO));
        let ball = |number: u32| LightElement::Ball {
            center: DVec3::new(
                f64::from(number / 7).sin(),
                f64::from(number / 7).cos(),
                0.01 * f64::from(number / 7),
            ),
            radius: 0.02 + 0.001 * f64::from(number % 5),
            light: DVec3::X,
        };
        let mut elements: Vec<_> = (0..count).map(ball).collect();
        elements.push(LightElement::Streak {
            ends: [DVec3::splat(-1.0), DVec3::splat(2.0)],
            radii: [0.1, 0.2, 0.4],
            light: DVec3::Y,
        });
        scene.light_elements = elements.into();
        scene
    }

    #[test]
    fn every_element_is_in_one_leaf_and_in_all_boxes_around_it() {
        for count in [0, 1, 2, 1000] {
            let tree = Tree::new(&scene(count)).unwrap();
            assert_eq!(tree.elements.len(), count as usize + 2);
            let mut seen = 0;
            let mut around: Vec<&GlowBox> = Vec::new();
            for (number, it) in tree.boxes.iter().enumerate() {
                around.retain(|outer| outer.next as usize > number);
                let has = |outer: &&GlowBox| {
                    outer.low_x <= it.low_x && outer.high_z >= it.high_z && outer.low_y <= it.low_y
                };
                assert!(around.iter().all(has), "box {number}");
                if it.count == 0 {
                    around.push(it);
                    continue;
                }
                assert_eq!(it.next, seen, "box {number}");
                seen += it.count;
                let first = it.next as usize;
                for element in &tree.elements[first..first + it.count as usize] {
                    let reach = element.radius;
                    assert!(element.x - reach >= it.low_x && element.z + reach <= it.high_z);
                }
            }
            assert!(
                around
                    .iter()
                    .all(|outer| outer.next as usize == tree.boxes.len())
            );
            assert_eq!(seen as usize, tree.elements.len());
        }
        let dark = Scene::new(Camera::new(DVec3::X, DVec3::ZERO));
        assert!(Tree::new(&dark).unwrap().boxes.is_empty());
    }
}
