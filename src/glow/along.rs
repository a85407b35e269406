//! Particles as light along listed rays, which need be no picture's: a tree of boxes is built of them on the host when
//! they change, and kernels walk down it.

use std::ops::Range;

use glam::DVec3;
use opencl3::event::Event;

use super::kernels;
use super::pack::{Element, GlowBox, GlowRay, GlowView, fading_view};
use super::self_test;
use super::tree::Tree;
use crate::error::Result;
use crate::opencl::{Argument, Compute, Film, Handle, Kernel, RendererOptions, Uploaded};
use crate::scene::{Ray, Scene};
use crate::threads;

/// Work-items in a group, which share nothing.
const GROUP: usize = 4;
const GPU_GROUP: usize = 32;

/// The kernel and buffers of a device, which are kept from list to list.
#[derive(Debug)]
pub(super) struct Along {
    pub(super) kernel: Option<Kernel>,
    /// Revisions of the lists that the device has a tree of.
    known: Option<[u64; 2]>,
    origin: DVec3,
    box_count: u32,
    elements: Uploaded<Element>,
    boxes: Uploaded<GlowBox>,
    rays: Uploaded<GlowRay>,
}

/// Rays that light is to be integrated along.
#[derive(Debug)]
pub(crate) struct RayPlan {
    view: GlowView,
    count: u32,
}

impl Along {
    pub(super) fn new() -> Self {
        Self {
            kernel: None,
            known: None,
            origin: DVec3::ZERO,
            box_count: 0,
            elements: Uploaded::new("the particles of light"),
            boxes: Uploaded::new("the boxes of particles"),
            rays: Uploaded::new("the rays"),
        }
    }

    /// Makes sure that the kernel is built, and tested.
    pub(super) fn build(&mut self, compute: &Compute, options: &RendererOptions) -> Result<()> {
        if self.kernel.is_none() {
            let (kernel, program) = kernels::build_along(compute, options)?;
            let tested = self_test::test_along(compute, options, (kernel, &program))?;
            self.kernel = Some(tested);
        }
        Ok(())
    }

    /// Uploads what changed of a valid scene's particles, and rays.
    pub(super) fn prepare(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        rays: &[Ray],
    ) -> Result<RayPlan> {
        let revisions = [scene.particles.revision(), scene.light_elements.revision()];
        let are_there = [self.elements.is_there(), self.boxes.is_there()];
        if self.known != Some(revisions) || are_there.contains(&false) {
            self.known = None;
            let mut tree = Tree::new(scene)?;
            let box_count = tree.boxes.len() as u32;
            self.elements.upload_taken(compute, &mut tree.elements)?;
            self.boxes.upload_taken(compute, &mut tree.boxes)?;
            (self.origin, self.box_count) = (tree.origin, box_count);
            self.known = Some(revisions);
        }
        let beta = scene.decay.map_or(0.0, |decay| decay.beta);
        let mut records = threads::map(rays, |ray| packed(ray, self.origin, beta));
        self.rays.upload_taken(compute, &mut records)?;
        Ok(RayPlan {
            view: fading_view(scene),
            count: rays.len() as u32,
        })
    }

    /// Enqueues what integrates along some of the rays, into a film of which each is a pixel.
    pub(super) fn draw(
        &self,
        compute: &Compute,
        plan: &RayPlan,
        rays: &Range<u32>,
        lanes: u32,
        film: &mut Film,
    ) -> Result<Option<Handle<Event>>> {
        let Some(kernel) = &self.kernel else {
            return Ok(None);
        };
        let drawn = film.arguments(compute, rays, (plan.count, 1), true, true)?;
        let mut arguments: Vec<(&str, &dyn Argument)> = vec![
            ("view", &plan.view),
            ("elements", &self.elements),
            ("boxes", &self.boxes),
            ("box_count", &self.box_count),
            ("rays", &self.rays),
        ];
        arguments.extend(drawn.named());
        let group = kernel.group(compute, if lanes == 1 { GPU_GROUP } else { GROUP })?;
        let items = rays.len().div_ceil(lanes as usize);
        kernel.launch(compute, &arguments, items, group).map(Some)
    }

    /// Waits for copies under way.
    pub(super) fn settle(&mut self, compute: &Compute) -> Result<()> {
        self.elements.settle(compute)?;
        self.boxes.settle(compute)?;
        self.rays.settle(compute)
    }
}

/// Packs a ray, its place next to the middle of all that shines seen from there.
fn packed(ray: &Ray, origin: DVec3, beta: f64) -> GlowRay {
    let length = ray.span.length();
    let toward = ray.span / length;
    let from = ray.origin - origin;
    let begin = from.dot(toward);
    let end = begin + length;
    let place = from - begin * toward;
    let rest = |v: DVec3| (v - v.as_vec3().as_dvec3()).as_vec3().to_array();
    GlowRay {
        place: place.as_vec3().to_array(),
        place_rest: rest(place),
        toward: toward.as_vec3().to_array(),
        toward_rest: rest(toward),
        begin: begin as f32,
        end: end as f32,
        begin_rest: (begin - f64::from(begin as f32)) as f32,
        end_rest: (end - f64::from(end as f32)) as f32,
        length: length as f32,
        beta: (beta * length) as f32,
    }
}
