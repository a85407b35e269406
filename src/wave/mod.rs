//! The wave: the engine that integrates light along rays on an OpenCL device. A frame is planned ([`Wave::plan`]), then
//! drawn into a [`Film`](crate::opencl::Film).

mod bake;
mod counts;
mod dispatch;
mod kernels;
mod kinds;
mod lists;
mod pace;
pub mod pack;
mod partition;
mod plan;
mod rule;
mod self_test;
mod sums;
mod tiles;

use std::collections::VecDeque;
use std::ops::Range;

use opencl3::event::Event;

pub(crate) use kernels::{Rays, Reduced, Task, Variant, common_definitions, program_text};
pub(crate) use kinds::{Present, resolve, resolve_text};
pub use pace::Split;
pub use partition::TILE_SHARES;
pub(crate) use plan::{Plan, grain_rows};
pub use rule::Rule;
pub(crate) use tiles::workers as tile_workers;

use crate::cost::FrameCost;
use crate::error::Result;
use crate::image::{DepthAlong, DepthImage, ImageSize};
use crate::opencl::{
    Compute, FilmFormat, Handle, RawMemory, RendererOptions, UploadedShared, Watch,
};
use crate::scene::{Method, Ray, Reduction, Scene};
use crate::threads;
use counts::Counts;
use dispatch::Launched;
use kernels::Kernels;
use lists::Lists;
use pace::Pace;
use pack::layout::View;
use pack::{Anchor, PackStamp, PackedSources};
use tiles::{OpenTiles, Tolerance};

/// Lengths on the device, of every pixel by rows from the top left, that end the rays of a scene without depths.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DeviceDepths {
    pub memory: RawMemory,
    /// What they are lengths of: ray or axis.
    pub along: DepthAlong,
}

/// The kernels and buffers of a device, which are kept from frame to frame.
#[derive(Debug)]
pub struct Wave {
    options: RendererOptions,
    /// Instead of the rule that meets the scene's tolerance.
    rule: Option<Rule>,
    kernels: Kernels,
    lanes: u32,
    packed: PackedSources,
    lists: Lists,
    open_tiles: OpenTiles,
    counts: Counts,
    depths: UploadedShared<f32>,
    pace: Pace,
    cost: FrameCost,
    /// Launches that somebody waits for, in order.
    under_way: VecDeque<Launched>,
    /// Launches of frames that nobody waited for.
    unwatched: Vec<Launched>,
    /// Until a launch of kernels that were built last is over.
    first_launch: Option<Watch>,
    /// Other commands of such frames: PoCL 3.1 aborts when an event fails that was released before it was over.
    held: Vec<Handle<Event>>,
}

impl Wave {
    /// Makes an engine for a device. Kernels are built when a scene first needs them.
    ///
    /// # Errors
    /// [`crate::Error::Unsupported`] for options that kernels cannot be built for.
    pub fn new(compute: &Compute, options: &RendererOptions) -> Result<Self> {
        options.check()?;
        Ok(Self {
            rule: None,
            kernels: Kernels::default(),
            lanes: options.lanes.unwrap_or(compute.device().lanes),
            packed: PackedSources::default(),
            lists: Lists::new(),
            open_tiles: OpenTiles::default(),
            counts: Counts::default(),
            depths: UploadedShared::new("the depth image"),
            pace: Pace::new(compute.device().form),
            cost: FrameCost::default(),
            under_way: VecDeque::new(),
            unwatched: Vec::new(),
            first_launch: None,
            held: Vec::new(),
            options: options.clone(),
        })
    }

    /// Integrates by this rule, whatever the tolerance; `None`: by the one that meets it.
    pub(crate) fn set_rule(&mut self, rule: Option<Rule>) {
        self.rule = rule;
    }

    /// Cuts frames in this way, whatever the pace; `None`: by time.
    pub fn force_split(&mut self, split: Option<Split>) {
        self.pace.force(split);
    }

    /// Returns how many kernels the last frame enqueued.
    pub fn launches(&self) -> u32 {
        self.cost.launches
    }

    /// Returns the cost of what was drawn since the frame began.
    pub(crate) fn cost(&self) -> FrameCost {
        self.cost
    }

    /// Returns how many kernels were built.
    pub(crate) fn kernel_count(&self) -> usize {
        self.kernels.count()
    }

    /// Returns the rows at whose multiples the scene's image may be cut and still be, to the bit, the same as in one
    /// piece.
    pub(crate) fn grain_rows(&mut self, scene: &Scene) -> u32 {
        grain_rows(scene, self.packed.facts(scene).has_both_signs)
    }

    /// Plans the frame of a valid scene: packs it, uploads what changed, and makes sure that its kernels are built.
    ///
    /// # Errors
    /// As [`crate::Renderer::render`].
    pub(crate) fn plan(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        film: FilmFormat,
    ) -> Result<Plan> {
        self.plan_behind(compute, scene, None, film)
    }

    /// Plans the frame of a valid scene as [`Wave::plan`] does, behind depths that the device has, if there are any:
    /// the scene then has none.
    ///
    /// # Errors
    /// As [`crate::Renderer::render`].
    pub(crate) fn plan_behind(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        there: Option<DeviceDepths>,
        film: FilmFormat,
    ) -> Result<Plan> {
        let plane = scene.view_plane();
        let reach = plane.farthest_pixel(scene.image) + plane.ray_length;
        let anchor = Anchor::new(scene, plane.eye, reach, plane.ray_length);
        let depths = scene.depth.as_ref().map(DepthImage::shared_values);
        self.depths.upload(compute, depths)?;
        let has_both_signs = self.packed.facts(scene).has_both_signs;
        let rays = match plan::has_tiles(scene, has_both_signs) {
            true => Rays::Tiles,
            false => Rays::Pixels,
        };
        let stamp = self.packed.pack(scene, anchor);
        let own = scene.depth.as_ref().map(DepthImage::along);
        let along = there.map(|depths| depths.along).or(own);
        let task = Task {
            has_depth: along.is_some(),
            ..self.task(scene, rays, film)
        };
        let view = pack::view_behind(&plane, scene, along);
        let mut plan = self.prepare(compute, scene, task, stamp, Some(view), scene.image)?;
        plan.depths = there.map(|depths| depths.memory);
        Ok(plan)
    }

    /// Plans single rays through a valid scene. Light is measured over the parameter s.
    ///
    /// # Errors
    /// As [`crate::Renderer::render`].
    pub(crate) fn plan_rays(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        rays: &[Ray],
    ) -> Result<Plan> {
        let origin = rays.first().map_or(glam::DVec3::ZERO, |ray| ray.origin);
        let records = threads::map(rays, |ray| pack::ray(ray, origin));
        let far = |ray: &Ray| ray.origin.distance(origin) + ray.span.length();
        let reach = threads::greatest(rays, far);
        let anchor = Anchor {
            origin,
            reach,
            measure: pack::even_decay(scene),
            pixel: pack::Pixel::None,
            tolerance: scene.integration.method.tolerance(),
            reduction: scene.integration.reduction,
        };
        let stamp = self.packed.pack(scene, anchor);
        let task = self.task(scene, Rays::Listed, FilmFormat::Floats);
        let size = ImageSize {
            width: rays.len() as u32,
            height: 1,
        };
        let plan = self.prepare(compute, scene, task, stamp, None, size)?;
        self.lists.upload_rays(compute, &records)?;
        Ok(plan)
    }

    fn task(&mut self, scene: &Scene, rays: Rays, film: FilmFormat) -> Task {
        let rule = self.rule_for(scene);
        let reduced = self.reduced(scene);
        let facts = self.packed.facts(scene);
        let is_sum = reduced == Reduced::Sum;
        Task {
            method: match scene.integration.method {
                Method::Simpson { .. } => Variant::Simpson,
                Method::Jittered { .. } => Variant::Jittered,
                Method::Exact { .. } => Variant::Exact {
                    nodes: rule.nodes,
                    coarse: rule.coarse,
                },
            },
            has_squares: is_sum && facts.has_squares,
            has_shapes: is_sum && facts.has_shapes,
            has_convolutions: facts.has_convolutions,
            fading: scene.fading().map(|fading| fading.power),
            reduced,
            kinds: self.packed.sources.counts().map(|count| count > 0),
            has_series: self.packed.sources.rows.has_series,
            has_ends: self.packed.sources.rows.first_balls.is_some() && rays == Rays::Tiles,
            has_footprints: scene.integration.has_footprints() && rays != Rays::Listed,
            has_depth: false,
            film,
            rays,
        }
    }

    fn reduced(&mut self, scene: &Scene) -> Reduced {
        match scene.integration.reduction {
            Reduction::Sum => Reduced::Sum,
            Reduction::Rms if self.packed.facts(scene).has_closed_squares => Reduced::Root,
            Reduction::Rms => Reduced::RootOfSquares,
        }
    }

    fn rule_for(&mut self, scene: &Scene) -> Rule {
        let tolerance = scene.integration.method.tolerance();
        let reduced = self.reduced(scene);
        let facts = self.packed.facts(scene);
        let (is_sharp, has_both_signs) = (facts.has_sharp_peaks, facts.has_both_signs);
        let fitting = match reduced {
            Reduced::Sum => Rule::of(tolerance, is_sharp, has_both_signs),
            Reduced::Root => Rule::of(tolerance, true, false),
            Reduced::RootOfSquares => Rule::of_squares(tolerance),
        };
        self.rule.unwrap_or(fitting)
    }

    /// Makes sure that the kernels are built, and uploads what changed.
    fn prepare(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        task: Task,
        stamp: PackStamp,
        view: Option<View>,
        size: ImageSize,
    ) -> Result<Plan> {
        let rule = self.rule_for(scene);
        let has_negative_light = self.packed.facts(scene).has_negative_light;
        let nodes = match scene.integration.method {
            Method::Simpson { divisions } => {
                // Of a ray that ends early, only the kernel knows where its nodes are.
                let is_known = !task.has_depth && task.fading.is_none();
                let decay = scene.decay.filter(|decay| is_known && decay.power > 0);
                sums::simpson(divisions, decay)
            }
            Method::Jittered { divisions, .. } => sums::strata(divisions),
            Method::Exact { .. } => Vec::new(),
        };
        let integrand = pack::integrand(scene, &rule, nodes.len() as u32);
        let plan = Plan::new(
            task,
            view,
            integrand,
            self.packed.sources.counts(),
            size,
            Tolerance::of(&scene.integration, has_negative_light),
            compute.device().compute_units,
        );
        let (kernels, options) = (&mut self.kernels, &self.options);
        if let (false, Some(slow_start)) = (kernels.has(task), options.slow_start) {
            self.first_launch = Some(Watch::begin(compute.device(), slow_start));
        }
        if let Some(program) = kernels.prepare(compute, options, task, &rule)? {
            self.self_test(compute, task, &program)?;
        }
        self.lists.upload_nodes(compute, &nodes)?;
        let sources = &self.packed.sources;
        self.lists.upload_sources(compute, sources, stamp)?;
        Ok(plan)
    }

    /// Returns the pixels of whole rows.
    pub(crate) fn pixels_of(scene: &Scene, rows: &Range<u32>) -> Range<u32> {
        rows.start * scene.image.width..rows.end * scene.image.width
    }
}
