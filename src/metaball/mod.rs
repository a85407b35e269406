//! The metaballs: the engine that finds surfaces of particles' summed fields along rays, on an OpenCL device (Mishima,
//! Tanaka, Sagawa 2008). Particles are sorted into cells anew for every frame. What it draws ends the rays of light.

mod kernels;
mod launches;
pub mod pack;
mod plan;
mod self_test;
mod sources;

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::time::Duration;

use opencl3::event::Event;

use crate::cost::FrameCost;
use crate::error::Result;
use crate::image::{DepthAlong, DepthImage, ImageSize};
use crate::opencl::{
    Argument, Compute, DeviceBuffer, Handle, Pixel, RendererOptions, Uploaded, UploadedShared,
    run_time,
};
use crate::scene::{Scene, SeenSurfaces};
use kernels::Kernels;
pub(crate) use kernels::build_text;
use launches::Launches;
use pack::{Particle, Point, Sight, Slab, Surface};
use plan::{Plan, Variant};

/// Cells that a work-item adds up, `CHUNK` of `cl/metaball/sort.cl`.
const CHUNK: u32 = 256;

/// Rays, or particles, that a work-item carries side by side.
const MOST_LANES: usize = 16;

/// What finding surfaces took, of all rays together.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SurfaceCounts {
    /// Places at which the summed field was taken.
    pub passes: u64,
    /// Fields of particles that were added up there.
    pub pairs: u64,
}

/// The kernels and buffers of a device, which are kept from frame to frame.
#[derive(Debug)]
pub(crate) struct Surfaces {
    options: RendererOptions,
    kernels: HashMap<Variant, Kernels>,
    /// Of which particles the packed ones are: revisions and radii.
    known: Vec<(u64, u64)>,
    packed: Vec<Point>,
    points: Uploaded<Point>,
    surfaces: Uploaded<Surface>,
    slabs: Uploaded<Slab>,
    depths: UploadedShared<f32>,
    cells: Option<DeviceBuffer<u32>>,
    sums: Option<DeviceBuffer<u32>>,
    cell_of_point: Option<DeviceBuffer<u32>>,
    order: Option<DeviceBuffer<u32>>,
    particles: Option<DeviceBuffer<Particle>>,
    /// Places and radii of particles in their cells, each in a plane of its own.
    planes: Option<DeviceBuffer<f32>>,
    squares: Option<DeviceBuffer<[u32; 2]>>,
    lengths: Option<DeviceBuffer<f32>>,
    light: Option<DeviceBuffer<Pixel>>,
    /// Of passes and pairs, `LANES` at a time.
    counts: Option<DeviceBuffer<u32>>,
    counted: SurfaceCounts,
    under_way: Vec<Handle<Event>>,
    /// How many of those sort particles, and how long they took.
    sorting: (usize, Duration),
    cost: FrameCost,
}

impl Surfaces {
    /// Makes one without kernels: they are built when a scene first needs them.
    pub(crate) fn new(options: &RendererOptions) -> Self {
        Self {
            options: options.clone(),
            kernels: HashMap::new(),
            known: Vec::new(),
            packed: Vec::new(),
            points: Uploaded::new("the particles"),
            surfaces: Uploaded::new("the surfaces"),
            slabs: Uploaded::new("the slabs of surfaces"),
            depths: UploadedShared::new("the depth image"),
            cells: None,
            sums: None,
            cell_of_point: None,
            order: None,
            particles: None,
            planes: None,
            squares: None,
            lengths: None,
            light: None,
            counts: None,
            counted: SurfaceCounts::default(),
            under_way: Vec::new(),
            sorting: (0, Duration::ZERO),
            cost: FrameCost::default(),
        }
    }

    /// Returns what the last frame cost.
    pub(crate) fn cost(&self) -> FrameCost {
        self.cost
    }

    /// Returns how long sorting particles into cells took in the last frame.
    #[cfg(feature = "papers")]
    pub(crate) fn sorting(&self) -> Duration {
        self.sorting.1
    }

    /// Returns what was counted in the last frame, if anything was.
    #[cfg(feature = "papers")]
    pub(crate) fn counted(&self) -> SurfaceCounts {
        self.counted
    }

    /// Draws the surfaces of a valid scene, with so many rays across and down in a pixel, and reads them back.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Build`](crate::Error::Build),
    /// [`Error::SelfTest`](crate::Error::SelfTest), [`Error::Device`](crate::Error::Device).
    pub(crate) fn draw(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        across: u32,
    ) -> Result<SeenSurfaces> {
        self.draw_by(compute, scene, across, None)
    }

    /// Draws by the kernels of a variant; `None`: of that which the scene needs.
    fn draw_by(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        across: u32,
        variant: Option<Variant>,
    ) -> Result<SeenSurfaces> {
        self.cost = FrameCost::default();
        let lanes = self.options.lanes.unwrap_or(compute.device().lanes);
        let (sight, plane) = plan::sight(scene, across, lanes);
        let mut plan = Plan::new(scene, &sight, &plane);
        plan.variant = variant.unwrap_or(plan.variant);
        self.prepare(compute, plan.variant)?;
        self.upload(compute, scene, &plan)?;
        self.reserve(compute, scene.image, &sight, &plan)?;
        let drawn = self.enqueue(compute, &sight, &plan);
        let settled = self.settle(compute);
        drawn.and(settled)?;
        self.read(compute, scene, &sight)
    }

    fn prepare(&mut self, compute: &Compute, variant: Variant) -> Result<()> {
        if let Entry::Vacant(entry) = self.kernels.entry(variant) {
            let (kernels, program) = Kernels::build(compute, variant, &self.options)?;
            let tested =
                self_test::self_test(compute, variant, &self.options, (kernels, &program))?;
            entry.insert(tested);
        }
        Ok(())
    }

    fn upload(&mut self, compute: &Compute, scene: &Scene, plan: &Plan) -> Result<()> {
        let stamp = |it: &crate::scene::Metaballs| (it.points.revision(), it.radius.to_bits());
        let now: Vec<(u64, u64)> = scene.metaballs.iter().map(stamp).collect();
        let is_known = self.known == now;
        if !is_known {
            self.packed.clear();
            for metaballs in scene.metaballs.iter() {
                pack::add_points(metaballs, &mut self.packed);
            }
            self.known = now;
        }
        self.points.upload_unless(is_known, compute, &self.packed)?;
        self.surfaces.upload(compute, &plan.surfaces)?;
        self.slabs.upload(compute, &plan.slabs)?;
        let depths = scene.depth.as_ref().map(DepthImage::shared_values);
        self.depths.upload(compute, depths)
    }

    fn reserve(
        &mut self,
        compute: &Compute,
        image: ImageSize,
        sight: &Sight,
        plan: &Plan,
    ) -> Result<()> {
        let points = self.packed.len();
        let cells = plan.cell_count as usize;
        let rays = sight.width as usize * sight.height as usize;
        let squares = plan.square_count as usize * plan.surfaces.len();
        grow(&mut self.cells, compute, "the cells of particles", cells)?;
        grow(
            &mut self.sums,
            compute,
            "the sums of cells",
            cells.div_ceil(CHUNK as usize),
        )?;
        grow(
            &mut self.cell_of_point,
            compute,
            "the places of particles",
            points,
        )?;
        grow(&mut self.order, compute, "the order of particles", points)?;
        grow(
            &mut self.particles,
            compute,
            "the particles in their cells",
            points,
        )?;
        grow(&mut self.counts, compute, "the counts of passes", 2)?;
        if let (Some(counts), true) = (&mut self.counts, self.options.counts_samples) {
            counts.write(compute, &[0; 2])?;
        }
        let planes = 4 * plane_of(points);
        let is_new = grow(&mut self.planes, compute, "the planes of particles", planes)?;
        if let (Some(it), true) = (&mut self.planes, is_new) {
            // Lanes read beyond the last particle, whatever is there.
            it.write(compute, &vec![0.0; planes])?;
        }
        grow(
            &mut self.squares,
            compute,
            "the slabs of squares of rays",
            squares,
        )?;
        grow(&mut self.lengths, compute, "the lengths of rays", rays)?;
        grow(
            &mut self.light,
            compute,
            "the light of surfaces",
            image.pixels(),
        )?;
        Ok(())
    }

    /// Enqueues all kernels of a frame.
    fn enqueue(&mut self, compute: &Compute, sight: &Sight, plan: &Plan) -> Result<()> {
        let Some(kernels) = self.kernels.get(&plan.variant) else {
            return Ok(());
        };
        let (surface_count, point_count) = (plan.surfaces.len() as u32, self.packed.len() as u32);
        let plane = plane_of(self.packed.len()) as u32;
        let common: Vec<(&str, &dyn Argument)> = vec![
            ("sight", sight),
            ("surfaces", &self.surfaces),
            ("surface_count", &surface_count),
            ("slabs", &self.slabs),
            ("points", &self.points),
            ("point_count", &point_count),
            ("cells", &self.cells),
            ("cell_count", &plan.cell_count),
            ("sums", &self.sums),
            ("cell_of_point", &self.cell_of_point),
            ("order", &self.order),
            ("particles", &self.particles),
            ("planes", &self.planes),
            ("plane", &plane),
            ("squares", &self.squares),
            ("square_count", &plan.square_count),
            ("depths", self.depths.argument()),
            ("lengths", &self.lengths),
            ("light", &self.light),
            ("counts", &self.counts),
        ];
        let mut launches = Launches {
            compute,
            common,
            under_way: &mut self.under_way,
        };
        launches.sort(kernels, plan)?;
        self.sorting = (launches.under_way.len(), Duration::ZERO);
        launches.draw(kernels, plan, sight)
    }

    /// Waits for what is under way, and adds up what it cost.
    fn settle(&mut self, compute: &Compute) -> Result<()> {
        let mut outcome = Ok(());
        for (number, event) in self.under_way.drain(..).enumerate() {
            match run_time(compute, &event) {
                Ok(time) => {
                    self.cost.kernel += time;
                    if number < self.sorting.0 {
                        self.sorting.1 += time;
                    }
                }
                Err(error) => outcome = outcome.and(Err(error)),
            }
            self.cost.launches += 1;
        }
        outcome?;
        self.points.settle(compute)?;
        self.surfaces.settle(compute)?;
        self.slabs.settle(compute)?;
        self.depths.settle(compute)
    }

    fn read_counts(&mut self, compute: &Compute) -> Result<()> {
        if let (Some(counts), true) = (&self.counts, self.options.counts_samples) {
            let mut found = [0; 2];
            counts.read(compute, &mut found)?;
            let lanes = u64::from(self.options.lanes.unwrap_or(compute.device().lanes));
            let [passes, pairs] = found.map(|count| u64::from(count) * lanes);
            self.counted = SurfaceCounts { passes, pairs };
            self.cost.samples = pairs;
        }
        Ok(())
    }

    fn read(&mut self, compute: &Compute, scene: &Scene, sight: &Sight) -> Result<SeenSurfaces> {
        let size = ImageSize {
            width: sight.width,
            height: sight.height,
        };
        self.read_counts(compute)?;
        let mut lengths = vec![0.0; size.pixels()];
        let mut light = vec![0.0; 4 * scene.image.pixels()];
        if let (Some(from), Some(pixels)) = (&self.lengths, &self.light) {
            from.read(compute, &mut lengths)?;
            pixels.read(compute, bytemuck::cast_slice_mut(&mut light))?;
        }
        let along = match sight.is_along_axis {
            0 => DepthAlong::Ray,
            _ => DepthAlong::Axis,
        };
        Ok(SeenSurfaces {
            depth: DepthImage::new(size, along, lengths)?,
            light: light.into(),
            lit: None,
        })
    }
}

/// Returns the length of a plane of numbers of particles, behind which lanes may read.
fn plane_of(points: usize) -> usize {
    points + MOST_LANES
}

/// Makes sure that a buffer has room for so many elements. Returns whether it is another one now.
fn grow<T: bytemuck::Pod>(
    buffer: &mut Option<DeviceBuffer<T>>,
    compute: &Compute,
    what: &str,
    len: usize,
) -> Result<bool> {
    let is_small = buffer.as_ref().is_none_or(|it| it.len() < len);
    if is_small {
        *buffer = None;
        *buffer = Some(DeviceBuffer::new(compute, what, len)?);
    }
    Ok(is_small)
}
