//! The launches of a frame: particles into cells, then rays to surfaces.

use opencl3::event::Event;

use super::CHUNK;
use super::kernels::Kernels;
use super::pack::Sight;
use super::plan::Plan;
use crate::error::Result;
use crate::opencl::{Argument, Compute, DeviceForm, Handle, Kernel};

/// Work-items in a group, which share nothing; of a CPU few enough that all cores are busy to the end.
const GROUP: usize = 16;
const GPU_GROUP: usize = 64;

/// Units of rays in a group.
const UNIT_GROUP: usize = 2;

/// Units of rays of a launch: desktop GPUs kill launches of seconds.
const UNITS: u32 = 1 << 16;

/// Launches of a frame, with the arguments that they have in common.
pub(super) struct Launches<'a> {
    pub compute: &'a Compute,
    pub common: Vec<(&'a str, &'a dyn Argument)>,
    pub under_way: &'a mut Vec<Handle<Event>>,
}

impl Launches<'_> {
    /// Launches a kernel over so many work-items, in groups of the wanted size or smaller.
    fn launch(
        &mut self,
        kernel: &Kernel,
        more: &[(&str, &dyn Argument)],
        items: u32,
        wanted: usize,
    ) -> Result<()> {
        if items == 0 {
            return Ok(());
        }
        let mut arguments: Vec<(&str, &dyn Argument)> = self.common.clone();
        arguments.extend(more);
        arguments.retain(|(name, _)| kernel.parameters().iter().any(|it| it == name));
        let wanted = match self.compute.device().form {
            DeviceForm::Gpu if wanted > 1 => GPU_GROUP,
            _ => wanted,
        };
        let group = kernel.group(self.compute, wanted)?;
        let event = kernel.launch(self.compute, &arguments, items as usize, group)?;
        self.under_way.push(event);
        Ok(())
    }

    /// Sorts particles into cells.
    pub(super) fn sort(&mut self, kernels: &Kernels, plan: &Plan) -> Result<()> {
        let chunks = plan.cell_count.div_ceil(CHUNK);
        self.launch(&kernels.clear_cells, &[], chunks, GROUP)?;
        for (number, surface) in (0_u32..).zip(&plan.surfaces) {
            let count = surface.point_count;
            self.launch(
                &kernels.count_particles,
                &[("number", &number)],
                count,
                GROUP,
            )?;
        }
        self.launch(&kernels.sum_chunks, &[], chunks, GROUP)?;
        self.launch(&kernels.begin_chunks, &[], 1, 1)?;
        self.launch(&kernels.begin_cells, &[], chunks, GROUP)?;
        let points = plan
            .surfaces
            .iter()
            .map(|surface| surface.point_count)
            .sum();
        self.launch(&kernels.scatter_particles, &[], points, GROUP)?;
        self.launch(&kernels.sort_cells, &[], chunks, GROUP)
    }

    /// Finds the slabs that matter, then the surfaces.
    pub(super) fn draw(&mut self, kernels: &Kernels, plan: &Plan, sight: &Sight) -> Result<()> {
        let squares = plan.square_count;
        for number in 0..plan.surfaces.len() as u32 {
            self.launch(&kernels.find_slabs, &[("number", &number)], squares, GROUP)?;
        }
        let units = sight.width.div_ceil(sight.unit) * sight.height.div_ceil(sight.unit);
        for first in (0..units).step_by(UNITS as usize) {
            let end = units.min(first + UNITS);
            let some: [(&str, &dyn Argument); 2] = [("first_unit", &first), ("end_unit", &end)];
            self.launch(&kernels.draw_surfaces, &some, end - first, UNIT_GROUP)?;
        }
        Ok(())
    }
}
