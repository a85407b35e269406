//! The irradiance of listed points on a device.

use glam::DVec3;

use super::lights::Lights;
use super::pack::STRUCTS;
use super::self_test::self_test;
use super::sources::sources;
use crate::error::Result;
use crate::opencl::{Argument, Compute, DeviceBuffer, Kernel, Program, RendererOptions, run_time};
use crate::scene::Scene;

/// Work-items in a group, which share nothing.
const GROUP: usize = 16;

/// Points of a launch: desktop GPUs kill launches of seconds.
const POINTS: usize = 1 << 16;

/// The kernel and what it needs, kept from call to call.
#[derive(Debug)]
pub(crate) struct PointLighter {
    options: RendererOptions,
    kernel: Option<Kernel>,
    lights: Lights,
}

impl PointLighter {
    /// Makes one without a kernel: it is built when it is first needed.
    pub(crate) fn new(options: &RendererOptions) -> Self {
        Self {
            options: options.clone(),
            kernel: None,
            lights: Lights::new(),
        }
    }

    /// Returns the irradiance, linear RGB, of points with normals of length 1, as many of both, in a valid scene.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Build`](crate::Error::Build),
    /// [`Error::SelfTest`](crate::Error::SelfTest), [`Error::Device`](crate::Error::Device).
    pub(crate) fn irradiance(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        points: &[DVec3],
        normals: &[DVec3],
    ) -> Result<Vec<[f32; 3]>> {
        if self.kernel.is_none() {
            let program = build(compute, &self.options)?;
            let kernel = program.kernel("light_points")?;
            self.kernel = Some(kernel);
            if let Err(error) = self_test(self, compute, &program) {
                self.kernel = None;
                return Err(error);
            }
        }
        self.light(compute, scene, points, normals)
    }

    /// Whether kernels are tested at their first use.
    pub(super) fn is_tested(&self, compute: &Compute) -> bool {
        !self.options.skips_self_test && !compute.device().is_simulator
    }

    pub(super) fn light(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        points: &[DVec3],
        normals: &[DVec3],
    ) -> Result<Vec<[f32; 3]>> {
        let mut found = Vec::with_capacity(points.len());
        for (points, normals) in points.chunks(POINTS).zip(normals.chunks(POINTS)) {
            self.light_chunk(compute, scene, points, normals, &mut found)?;
        }
        Ok(found)
    }

    fn light_chunk(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        points: &[DVec3],
        normals: &[DVec3],
        found: &mut Vec<[f32; 3]>,
    ) -> Result<()> {
        let Some(kernel) = &self.kernel else {
            return Ok(());
        };
        let low = points.iter().copied().reduce(DVec3::min);
        let high = points.iter().copied().reduce(DVec3::max);
        let origin = 0.5 * (low.unwrap_or_default() + high.unwrap_or_default());
        self.lights.upload(compute, scene, origin)?;
        let row = |v: DVec3| [v.x as f32, v.y as f32, v.z as f32, 0.0];
        let upload = |what: &str, rows: Vec<[f32; 4]>| -> Result<DeviceBuffer<[f32; 4]>> {
            let mut buffer = DeviceBuffer::new(compute, what, rows.len())?;
            buffer.write(compute, &rows)?;
            Ok(buffer)
        };
        let places = points.iter().map(|point| row(*point - origin)).collect();
        let places = upload("the points that are lit", places)?;
        let facing = normals.iter().map(|normal| row(*normal)).collect();
        let facing = upload("their normals", facing)?;
        let irradiances = DeviceBuffer::new(compute, "their light", points.len())?;
        let count = points.len() as u32;
        let mut arguments: Vec<(&str, &dyn Argument)> = vec![
            ("count", &count),
            ("points", &places),
            ("normals", &facing),
            ("irradiances", &irradiances),
        ];
        arguments.extend(self.lights.arguments());
        let group = kernel.group(compute, GROUP)?;
        let event = kernel.launch(compute, &arguments, points.len(), group)?;
        run_time(compute, &event)?;
        let mut rows = vec![[0.0_f32; 4]; points.len()];
        irradiances.read(compute, &mut rows)?;
        self.lights.settle(compute)?;
        found.extend(
            rows.into_iter()
                .map(|[red, green, blue, _]| [red, green, blue]),
        );
        Ok(())
    }
}

/// Returns the sizes of the structs, which every program that includes `cl/light/irradiance.h` is built with.
pub(crate) fn definitions() -> String {
    let sizes = STRUCTS.iter();
    sizes
        .map(|it| format!(" -D SIZEOF_{}={}", it.name.to_uppercase(), it.size))
        .collect()
}

fn build(compute: &Compute, options: &RendererOptions) -> Result<Program> {
    let text = sources().resolve("light/points.cl");
    Program::build(compute, text, &definitions(), options)
}
