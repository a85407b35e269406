//! The lists that kernels read, on the device.

use super::{Compute, Uploaded};
use crate::error::Result;
use crate::pack::{Sources, layout};

/// Each is uploaded when it changed.
#[derive(Debug)]
pub(super) struct Lists {
    pub nodes: Uploaded<layout::Node>,
    pub spheres: Uploaded<layout::Sphere>,
    pub cylinders: Uploaded<layout::Cylinder>,
    pub beams: Uploaded<layout::Beam>,
    pub tori: Uploaded<layout::Torus>,
    pub curves: Uploaded<layout::Curve>,
    pub spline_pieces: Uploaded<layout::SplinePiece>,
    pub rays: Uploaded<layout::RayRecord>,
}

impl Lists {
    pub(super) fn new() -> Self {
        Self {
            nodes: Uploaded::new("the list of quadrature nodes"),
            spheres: Uploaded::new("the list of spheres"),
            cylinders: Uploaded::new("the list of cylinders"),
            beams: Uploaded::new("the list of beams"),
            tori: Uploaded::new("the list of tori"),
            curves: Uploaded::new("the list of curves"),
            spline_pieces: Uploaded::new("the list of spline pieces"),
            rays: Uploaded::new("the list of rays"),
        }
    }

    /// Makes the device's lists equal to these; without rays, those there stay.
    pub(super) fn upload(
        &mut self,
        compute: &Compute,
        nodes: &[layout::Node],
        sources: &Sources,
        rays: Option<&[layout::RayRecord]>,
    ) -> Result<()> {
        self.nodes.upload(compute, nodes)?;
        self.spheres.upload(compute, &sources.spheres)?;
        self.cylinders.upload(compute, &sources.cylinders)?;
        self.beams.upload(compute, &sources.beams)?;
        self.tori.upload(compute, &sources.tori)?;
        self.curves.upload(compute, &sources.curves)?;
        let pieces = &sources.spline_pieces;
        self.spline_pieces.upload(compute, pieces)?;
        match rays {
            Some(rays) => self.rays.upload(compute, rays),
            None => Ok(()),
        }
    }

    /// Waits for copies under way.
    pub(super) fn settle(&mut self, compute: &Compute) -> Result<()> {
        self.nodes.settle(compute)?;
        self.spheres.settle(compute)?;
        self.cylinders.settle(compute)?;
        self.beams.settle(compute)?;
        self.tori.settle(compute)?;
        self.curves.settle(compute)?;
        self.spline_pieces.settle(compute)?;
        self.rays.settle(compute)
    }
}
