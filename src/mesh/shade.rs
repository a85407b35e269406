//! The light on meshes, and on points that a host lists.

use std::sync::Arc;

use glam::DVec3;

use super::kernels::{Shading, launch};
use super::pack::vector;
use super::shade_test::shade_test;
use super::{Meshes, blocks, sight};
use crate::cost::FrameCost;
use crate::error::Result;
use crate::image::DepthImage;
use crate::opencl::{Argument, Compute, DeviceBuffer};
use crate::scene::{Lighting, Scene};

/// Points of a launch.
const POINTS: usize = 1 << 16;

impl Meshes {
    /// Makes sure that the kernels of light are there, with shadows or without.
    fn make_shading(&mut self, compute: &Compute, has_shadows: bool) -> Result<()> {
        let shading = &mut self.shadings[usize::from(has_shadows)];
        if shading.is_none() {
            let (built, program) = Shading::build(compute, &self.options, has_shadows)?;
            let built = (built, &program, has_shadows);
            *shading = Some(shade_test(compute, &self.options, built)?);
        }
        Ok(())
    }

    /// Returns the mean radiance of what each pixel's rays met of meshes in the last [`Meshes::trace`], RGBA by rows,
    /// where `ends`, the final lengths of the same rays, do not hide it.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Device`](crate::Error::Device).
    pub(crate) fn shade(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        ends: &DepthImage,
    ) -> Result<Arc<Vec<f32>>> {
        self.cost = FrameCost::default();
        let has_shadows = scene.lighting.is_some_and(|lighting| lighting.shadows);
        self.make_shading(compute, has_shadows)?;
        let pixels = scene.image.pixels();
        let mut light = vec![0.0; 4 * pixels];
        let shading = &self.shadings[usize::from(has_shadows)];
        let (Some(shading), Some(pass)) = (shading, &self.pass) else {
            return Ok(light.into());
        };
        let has_finals = !Arc::ptr_eq(ends.shared_values(), pass.depth.shared_values());
        let finals = has_finals.then(|| ends.shared_values());
        self.finals.upload(compute, finals)?;
        let albedos: Vec<[f32; 4]> = scene.meshes.iter().map(|it| vector(it.albedo)).collect();
        self.albedos.upload(compute, &albedos)?;
        let lit = sight::light(scene);
        let has_finals = u32::from(has_finals);
        self.lights
            .upload(compute, scene, scene.lighting, self.tree.origin)?;
        let own: [(&str, &dyn Argument); 8] = [
            ("sight", &pass.sight),
            ("lit", &lit),
            ("albedos", &self.albedos),
            ("lengths", &self.lengths),
            ("triangles", &self.triangles),
            ("has_finals", &has_finals),
            ("finals", self.finals.argument()),
            ("light", &self.light),
        ];
        let tree = self.uploaded.arguments();
        let arguments = [&tree[..], &self.lights.arguments()[..], &own[..]].concat();
        let items = (
            "first_block",
            "end_block",
            blocks(scene.image, shading.lanes),
        );
        let under_way = &mut self.under_way;
        let drawn = launch(compute, &shading.shade_meshes, &arguments, items, under_way);
        let settled = self.settle(compute);
        drawn.and(settled)?;
        if let Some(from) = &self.light {
            from.read(compute, bytemuck::cast_slice_mut(&mut light))?;
        }
        Ok(light.into())
    }

    /// Returns the irradiance, linear RGB, of points with normals of length 1, as many of both, that waves cast on them
    /// in a valid scene; with shadows, what its meshes leave of that.
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
        let lighting = scene.lighting.unwrap_or_default();
        if lighting.shadows {
            self.plant(scene)?;
        }
        let has_shadows = lighting.shadows && !self.tree.nodes.is_empty();
        self.make_shading(compute, has_shadows)?;
        let mut irradiances = Vec::with_capacity(points.len());
        for (points, normals) in points.chunks(POINTS).zip(normals.chunks(POINTS)) {
            self.light_points(
                compute,
                (scene, lighting, has_shadows),
                points,
                normals,
                &mut irradiances,
            )?;
        }
        Ok(irradiances)
    }

    fn light_points(
        &mut self,
        compute: &Compute,
        (scene, lighting, has_shadows): (&Scene, Lighting, bool),
        points: &[DVec3],
        normals: &[DVec3],
        irradiances: &mut Vec<[f32; 3]>,
    ) -> Result<()> {
        let Some(shading) = &self.shadings[usize::from(has_shadows)] else {
            return Ok(());
        };
        // Where nothing hides them, from the middle of all points.
        let ends = || points.iter().copied();
        let (low, high) = (ends().reduce(DVec3::min), ends().reduce(DVec3::max));
        let middle = 0.5 * (low.unwrap_or_default() + high.unwrap_or_default());
        let origin = if has_shadows {
            self.tree.origin
        } else {
            middle
        };
        self.uploaded.upload(compute, &self.tree)?;
        self.lights.upload(compute, scene, Some(lighting), origin)?;
        let upload = |what, rows: Vec<[f32; 4]>| -> Result<DeviceBuffer<[f32; 4]>> {
            let mut buffer = DeviceBuffer::new(compute, what, rows.len())?;
            buffer.write(compute, &rows)?;
            Ok(buffer)
        };
        let places = points.iter().map(|point| vector(*point - origin)).collect();
        let places = upload("the points that are lit", places)?;
        let facing = normals.iter().map(|normal| vector(*normal)).collect();
        let facing = upload("their normals", facing)?;
        let found = DeviceBuffer::new(compute, "their light", points.len())?;
        let count = points.len() as u32;
        let own: [(&str, &dyn Argument); 4] = [
            ("end_point", &count),
            ("points", &places),
            ("normals", &facing),
            ("irradiances", &found),
        ];
        let tree = self.uploaded.arguments();
        let arguments = [&tree[..], &self.lights.arguments()[..], &own[..]].concat();
        let items = ("first_block", "end_block", count.div_ceil(shading.lanes));
        let under_way = &mut self.under_way;
        let lit = launch(compute, &shading.light_points, &arguments, items, under_way);
        let settled = self.settle(compute);
        lit.and(settled)?;
        let mut rows = vec![[0.0_f32; 4]; points.len()];
        found.read(compute, &mut rows)?;
        irradiances.extend(
            rows.into_iter()
                .map(|[red, green, blue, _]| [red, green, blue]),
        );
        Ok(())
    }
}
