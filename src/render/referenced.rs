//! Renders scenes on the built-in reference.

use std::ops::ControlFlow;
use std::time::Duration;

use super::one::Rows;
use crate::cost::{CrowdCost, FrameCost};
use crate::error::Result;
use crate::image::spread_light;
use crate::reference;
use crate::scene::Scene;

/// Renders some rows of a valid scene.
pub(super) fn draw_reference(
    scene: &Scene,
    wanted: Rows<'_>,
    progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
) -> Result<()> {
    let Rows {
        rows,
        target,
        stride,
        bloom,
    } = wanted;
    let (method, row) = (scene.integration.method, 4 * scene.image.width as usize);
    if stride == row {
        let target = &mut target[..rows.len() * row];
        reference::render_rows(scene, method, rows, target, progress)?;
        if let Some(bloom) = bloom {
            spread_light(scene.image, target, &bloom);
        }
        return Ok(());
    }
    let mut image = vec![0.0; rows.len() * row];
    reference::render_rows(scene, method, rows, &mut image, progress)?;
    for (to, from) in target.chunks_mut(stride).zip(image.chunks_exact(row)) {
        to[..row].copy_from_slice(from);
    }
    Ok(())
}

/// Returns the cost of a frame on the reference, all of whose time counts as the kernels'; the samples of its adaptive
/// quadrature are not counted.
pub(super) fn reference_cost(scene: &Scene, pixels: usize, time: Duration) -> FrameCost {
    let integrals = pixels as u64 * scene.light_count() as u64;
    let samples = scene.integration.method.samples().unwrap_or(0);
    FrameCost {
        kernel: time,
        meshes: Duration::ZERO,
        crowds: CrowdCost::default(),
        integrals,
        samples: integrals * u64::from(samples),
        launches: 1,
    }
}
