//! Meshes: the engine that finds triangles along rays on an OpenCL device, in a tree of boxes that the host builds.
//! What it finds ends the rays of all that follows; the light that meshes throw back is found when it is known what
//! hides them. The tree stays until a mesh is another, and what rays meet until the camera is.

mod kernels;
pub mod pack;
mod self_test;
mod shade;
mod shade_test;
mod sight;
mod sources;
mod tree;

use opencl3::event::Event;

use crate::cost::FrameCost;
use crate::error::Result;
use crate::image::{DepthAlong, DepthImage, ImageSize};
use crate::light::Lights;
use crate::opencl::{
    Argument, Compute, DeviceBuffer, Handle, Pixel, RendererOptions, Uploaded, UploadedShared,
    run_time,
};
use crate::scene::{Camera, Mesh, Scene};
pub(crate) use kernels::build_text;
use kernels::{Kernels, Shading, launch};
use pack::MeshSight;
pub use tree::{Tree, UploadedTree};

/// The kernels, the tree and the buffers of a device, which are kept from frame to frame.
#[derive(Debug)]
pub(crate) struct Meshes {
    options: RendererOptions,
    kernels: Option<Kernels>,
    /// Without shadows, and with them.
    shadings: [Option<Shading>; 2],
    /// Of which meshes the tree is, and how often one was built.
    known: Vec<Mesh>,
    built: u32,
    tree: Tree,
    uploaded: UploadedTree,
    depths: UploadedShared<f32>,
    finals: UploadedShared<f32>,
    albedos: Uploaded<[f32; 4]>,
    lights: Lights,
    pixel_depths: Option<DeviceBuffer<f32>>,
    pixel_triangles: Option<DeviceBuffer<u32>>,
    lengths: Option<DeviceBuffer<f32>>,
    triangles: Option<DeviceBuffer<u32>>,
    light: Option<DeviceBuffer<Pixel>>,
    pass: Option<Pass>,
    under_way: Vec<Handle<Event>>,
    cost: FrameCost,
}

/// What rays met, which the device has.
#[derive(Debug)]
struct Pass {
    of: PassOf,
    sight: MeshSight,
    depth: DepthImage,
}

/// What that depends on.
#[derive(Debug, Clone, PartialEq)]
struct PassOf {
    camera: Camera,
    image: ImageSize,
    across: u32,
    built: u32,
    depth: Option<DepthImage>,
}

impl Meshes {
    /// Makes one without kernels: they are built when a scene first needs them.
    pub(crate) fn new(options: &RendererOptions) -> Self {
        Self {
            options: options.clone(),
            kernels: None,
            shadings: [None, None],
            known: Vec::new(),
            built: 0,
            tree: Tree::default(),
            uploaded: UploadedTree::new(),
            depths: UploadedShared::new("the depth image"),
            finals: UploadedShared::new("the lengths of rays"),
            albedos: Uploaded::new("the colours of meshes"),
            lights: Lights::new(),
            pixel_depths: None,
            pixel_triangles: None,
            lengths: None,
            triangles: None,
            light: None,
            pass: None,
            under_way: Vec::new(),
            cost: FrameCost::default(),
        }
    }

    /// Returns what the last call cost.
    pub(crate) fn cost(&self) -> FrameCost {
        self.cost
    }

    /// Returns how far the rays of a valid scene, so many across a pixel, go to meshes, or to its depths.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Build`](crate::Error::Build),
    /// [`Error::SelfTest`](crate::Error::SelfTest), [`Error::Device`](crate::Error::Device).
    pub(crate) fn trace(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        across: u32,
    ) -> Result<DepthImage> {
        self.cost = FrameCost::default();
        if self.kernels.is_none() {
            let (kernels, program) = Kernels::build(compute, &self.options)?;
            let tested = self_test::self_test(compute, &self.options, (kernels, &program))?;
            self.kernels = Some(tested);
        }
        self.plant(scene)?;
        let of = PassOf {
            camera: scene.camera.clone(),
            image: scene.image,
            across,
            built: self.built,
            depth: scene.depth.clone(),
        };
        if let Some(pass) = self.pass.as_ref().filter(|pass| pass.of == of) {
            return Ok(pass.depth.clone());
        }
        self.pass = None;
        let sight = sight::sight(scene, &self.tree, across);
        self.uploaded.upload(compute, &self.tree)?;
        let depths = scene.depth.as_ref().map(DepthImage::shared_values);
        self.depths.upload(compute, depths)?;
        self.reserve(compute, scene.image.pixels(), &sight)?;
        let drawn = self.enqueue_rays(compute, scene.image, &sight);
        let settled = self.settle(compute);
        drawn.and(settled)?;
        let size = ImageSize {
            width: sight.width,
            height: sight.height,
        };
        let mut lengths = vec![0.0; size.pixels()];
        if let Some(from) = &self.lengths {
            from.read(compute, &mut lengths)?;
        }
        let depth = DepthImage::new(size, DepthAlong::Ray, lengths)?;
        self.pass = Some(Pass {
            of,
            sight,
            depth: depth.clone(),
        });
        Ok(depth)
    }

    /// Builds the tree of a scene's meshes, unless it is there.
    fn plant(&mut self, scene: &Scene) -> Result<()> {
        let is_as = |mesh: &Mesh, known: &Mesh| {
            mesh.triangles == known.triangles
                && (mesh.scale, mesh.rotate, mesh.translate)
                    == (known.scale, known.rotate, known.translate)
        };
        let mut pairs = scene.meshes.iter().zip(&self.known);
        if scene.meshes.len() == self.known.len() && pairs.all(|(mesh, known)| is_as(mesh, known)) {
            return Ok(());
        }
        self.known.clear();
        self.built += 1;
        self.tree = Tree::default(); // before there is another: two may not fit
        self.tree = Tree::new(&scene.meshes)?;
        self.known.clone_from(&scene.meshes);
        Ok(())
    }

    fn reserve(&mut self, compute: &Compute, pixels: usize, sight: &MeshSight) -> Result<()> {
        let rays = sight.width as usize * sight.height as usize;
        let what = "what rays meet of meshes";
        grow(&mut self.pixel_depths, compute, what, pixels)?;
        grow(&mut self.pixel_triangles, compute, what, pixels)?;
        grow(&mut self.lengths, compute, "the lengths of rays", rays)?;
        grow(&mut self.triangles, compute, what, rays)?;
        grow(&mut self.light, compute, "the light of meshes", pixels)
    }

    fn enqueue_rays(
        &mut self,
        compute: &Compute,
        image: ImageSize,
        sight: &MeshSight,
    ) -> Result<()> {
        let Some(kernels) = &self.kernels else {
            return Ok(());
        };
        let lanes = self.options.lanes.unwrap_or(compute.device().lanes);
        let blocks = blocks(image, lanes);
        let pixels = image.width * image.height;
        let met: [(&str, &dyn Argument); 3] = [
            ("sight", sight),
            ("pixel_depths", &self.pixel_depths),
            ("pixel_triangles", &self.pixel_triangles),
        ];
        let mut arguments = [&self.uploaded.arguments()[..], &met[..]].concat();
        let under_way = &mut self.under_way;
        let items = ("first_block", "end_block", blocks);
        launch(compute, &kernels.trace_pixels, &arguments, items, under_way)?;
        let rays: [(&str, &dyn Argument); 3] = [
            ("depths", self.depths.argument()),
            ("lengths", &self.lengths),
            ("triangles", &self.triangles),
        ];
        arguments.extend(rays);
        let items = ("first_pixel", "end_pixel", pixels);
        launch(compute, &kernels.trace_rays, &arguments, items, under_way)
    }

    /// Waits for what is under way, and adds up what it cost.
    fn settle(&mut self, compute: &Compute) -> Result<()> {
        let mut outcome = Ok(());
        for event in self.under_way.drain(..) {
            match run_time(compute, &event) {
                Ok(time) => {
                    self.cost.kernel += time;
                    self.cost.meshes += time;
                }
                Err(error) => outcome = outcome.and(Err(error)),
            }
            self.cost.launches += 1;
        }
        outcome?;
        self.uploaded.settle(compute)?;
        self.depths.settle(compute)?;
        self.finals.settle(compute)?;
        self.albedos.settle(compute)?;
        self.lights.settle(compute)
    }
}

/// Returns the number of blocks of so many rays that cover an image, each of the shape that `cl/block.h` has.
fn blocks(image: ImageSize, lanes: u32) -> u32 {
    let (columns, rows) = match lanes {
        16 => (4, 4),
        8 => (4, 2),
        4 => (2, 2),
        _ => (1, 1),
    };
    image.width.div_ceil(columns) * image.height.div_ceil(rows)
}

/// Makes sure that a buffer has room for so many elements.
fn grow<T: bytemuck::Pod>(
    buffer: &mut Option<DeviceBuffer<T>>,
    compute: &Compute,
    what: &str,
    len: usize,
) -> Result<()> {
    if buffer.as_ref().is_none_or(|it| it.len() < len) {
        *buffer = None;
        *buffer = Some(DeviceBuffer::new(compute, what, len)?);
    }
    Ok(())
}
