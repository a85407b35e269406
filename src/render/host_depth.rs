//! Depths that a host has on the device, and what they mean.

use glam::DMat4;

use crate::error::{Error, Result};
use crate::image::{ClipDepth, ClipRange, DepthAlong};
use crate::opencl::{ClipValues, Compute, DepthValues, HostDepthMemory, HostDepths, unfit};
use crate::scene::{Camera, Scene};

/// Depths of a frame's pixels in a host's own memory, for
/// [`Renderer::enqueue_behind`](crate::Renderer::enqueue_behind): nothing of them is read back. They take the place of
/// [`Scene::depth`](crate::Scene), which the scene then has not. `examples/host_opencl.rs` draws behind a depth buffer.
///
/// They give the picture that the same values give as a [`DepthImage`](crate::image::DepthImage): to the bit where the
/// device has float64 (`cl_khr_fp64`), else those of clip space differ by a few units of float32's last place.
///
/// A length of 0 hides all of a ray, and an infinite value nothing. What a `DepthImage` refuses cannot be told of
/// without reading it back: where a value is no number, a negative length, or more than 1e-4 beyond the planes of the
/// projection, nothing hides the light.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct HostDepth {
    /// Where they are.
    pub memory: HostDepthMemory,
    /// What they are measured along.
    pub along: DepthAlong,
    /// What depths are lengths of that are none themselves: [`DepthAlong::Ndc`] and [`DepthAlong::Buffer`].
    pub clip: Option<ClipDepth>,
    /// World units to a unit of the memory's; values are multiplied with it before anything else. Negative where z is,
    /// as in view spaces that look along -z; never 0.
    pub scale: f64,
    /// Whether the first row is the lowest of the picture, as in textures that OpenGL draws; else it is the highest.
    pub is_bottom_up: bool,
}

impl HostDepth {
    /// Takes lengths, world units, rows from the top: along the rays or along the axis of view.
    #[must_use]
    pub fn new(memory: impl Into<HostDepthMemory>, along: DepthAlong) -> Self {
        Self {
            memory: memory.into(),
            along,
            clip: None,
            scale: 1.0,
            is_bottom_up: false,
        }
    }

    /// Takes depths of clip space behind a projection, rows from the top: NDC depths, or with [`DepthAlong::Buffer`]
    /// those of a depth buffer. The depth of a camera is
    /// [`CameraMatrices::clip_depth`](crate::scene::CameraMatrices::clip_depth).
    #[must_use]
    pub fn from_clip(
        memory: impl Into<HostDepthMemory>,
        along: DepthAlong,
        clip: &ClipDepth,
    ) -> Self {
        Self {
            clip: Some(*clip),
            ..Self::new(memory, along)
        }
    }

    /// Takes lengths, or depths of clip space behind the projection of a camera's matrices; rows from the top.
    ///
    /// # Errors
    /// [`Error::Host`] for depths of clip space where the camera has no matrices; [`Error::Scene`] where their
    /// projection gives no depth.
    pub fn of_camera(
        memory: impl Into<HostDepthMemory>,
        along: DepthAlong,
        camera: &Camera,
    ) -> Result<Self> {
        if along.is_length() {
            return Ok(Self::new(memory, along));
        }
        let Some(matrices) = &camera.matrices else {
            let reason = "lengths along clip space without a projection; give the camera view and projection";
            return Err(unfit("depth", reason));
        };
        Ok(Self::from_clip(memory, along, &matrices.clip_depth()?))
    }

    /// Returns what kernels are told of the values.
    ///
    /// # Errors
    /// [`Error::Host`] if they mean nothing, or the scene has depths as well.
    pub(super) fn values(&self, scene: &Scene) -> Result<DepthValues> {
        let wrong = |reason: &str| Err(unfit("depth", reason));
        if scene.depth.is_some() {
            return wrong("the scene has a depth of its own; set the scene's to None");
        }
        match (self.along.is_length(), self.clip.is_some()) {
            (true, true) => return wrong("lengths have no projection; set `clip` to None"),
            (false, false) => {
                return wrong(
                    "depths of clip space are no lengths; HostDepth::from_clip takes their projection",
                );
            }
            _ => {}
        }
        if !self.scale.is_finite() || self.scale == 0.0 {
            let reason = format!("a scale of {}; it must be a number but 0", self.scale);
            return wrong(&reason);
        }
        Ok(DepthValues {
            scale: self.scale,
            is_bottom_up: self.is_bottom_up,
            clip: self.clip.map(|clip| clip_values(&clip, self.along)),
        })
    }

    /// Returns what the lengths that kernels get are measured along.
    pub(super) fn lengths_along(&self) -> DepthAlong {
        match self.along.is_length() {
            true => self.along,
            false => DepthAlong::Axis,
        }
    }
}

fn clip_values(clip: &ClipDepth, along: DepthAlong) -> ClipValues {
    let (a, b) = clip.terms();
    ClipValues {
        a,
        b,
        is_orthographic: clip.is_orthographic(),
        is_reversed: clip.is_reversed(),
        low: clip.range().low(),
        is_share: along == DepthAlong::Buffer,
    }
}

/// Makes sure that the kernel for a host's depths is built, and has shown that it computes right.
pub(super) fn prepare(compute: &Compute, depths: &mut HostDepths) -> Result<()> {
    let Some(program) = depths.prepare(compute)? else {
        return Ok(());
    };
    if depths.skips_self_test() || compute.device().is_simulator || program.was_tested() {
        return Ok(());
    }
    // On a queue of its own: the renderer's waits for the host.
    let outcome = compute
        .sibling()
        .and_then(|compute| self_test(&compute, depths));
    match &outcome {
        Ok(()) => program.mark_tested(),
        Err(_) => depths.forget(),
    }
    outcome
}

/// The relative error that a length may have: where there is no float64, that of a quotient of float32.
const LIMIT: f64 = 1e-5;

/// From the near plane to the far one of [`known`], and beyond.
const SHARES: [f32; 9] = [0.0, 1e-6, 0.25, 0.5, 0.9, 0.99, 0.99999, 1.0, f32::NAN];

/// Returns projections of every sort.
fn known() -> Result<[ClipDepth; 4]> {
    let perspective = |z: f64, w: f64| {
        let mut matrix = DMat4::from_diagonal((1.2, 1.6, z, 0.0).into());
        (matrix.z_axis.w, matrix.w_axis.z) = (-1.0, w);
        matrix
    };
    let across = DMat4::from_diagonal((0.1, 0.1, -0.01, 1.0).into());
    let zero = Some(ClipRange::ZeroToOne);
    Ok([
        ClipDepth::new(perspective(-1.0001, -0.10001), zero)?,
        ClipDepth::new(perspective(0.0, 0.3), zero)?,
        ClipDepth::new(perspective(-1.002, -0.2002), Some(ClipRange::MinusOneToOne))?,
        ClipDepth::new(across, zero)?,
    ])
}

/// # Errors
/// [`Error::SelfTest`] if the kernel computes wrong.
fn self_test(compute: &Compute, depths: &HostDepths) -> Result<()> {
    for clip in known()? {
        let along = DepthAlong::Buffer;
        let values = DepthValues {
            scale: 1.0,
            is_bottom_up: false,
            clip: Some(clip_values(&clip, along)),
        };
        let found = depths.lengths_of(compute, &SHARES, &values)?;
        for (share, found) in SHARES.into_iter().zip(found) {
            let expected = clip.along_axis_of(along, share.into());
            let expected = expected.unwrap_or(f64::INFINITY);
            let found = f64::from(found);
            let is_right = found == expected || (found - expected).abs() <= LIMIT * expected.abs();
            if !is_right {
                let device = compute.device();
                return Err(Error::SelfTest {
                    device: device.name.clone(),
                    driver: format!("{} {}", device.platform, device.driver),
                    reason: format!("the depth {share} of a host is {found} away, not {expected}"),
                });
            }
        }
    }
    Ok(())
}
