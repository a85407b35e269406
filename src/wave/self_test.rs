//! The first use of freshly built kernels: two small scenes whose light is known from the float64 reference. Drivers
//! have miscompiled kernels; a device whose driver does is refused before it draws.

use std::mem;
use std::ops::ControlFlow;

use glam::DVec3;

use super::Wave;
use super::kernels::{Rays, Reduced, Task, Variant};
use crate::error::{Error, Result};
use crate::image::{DepthAlong, DepthImage, ImageSize};
use crate::opencl::{Compute, Film, FilmFormat, Pixel, Program};
use crate::reference::{Emitter, Tracer};
use crate::scene::kinds::for_each_kind;
use crate::scene::{
    Absorption, Antialias, Camera, Decay, Integration, Measure, Method, Profile, Reduction,
    Sampling, Scene, SourceKind,
};
use crate::threads;
use crate::volume::{CellValue, Grid, Volume};

/// The step from one compared pixel to the next: a number that shares no divisor with the width and the lanes.
const STRIDE: usize = 97;

/// The relative error that a pixel may have even if the tolerance is smaller: what float32 and half floats lose.
const LEAST_LIMIT: f64 = 1e-3;

/// The relative error that a cell may have.
const CELL_LIMIT: f64 = 1e-3;

/// That of a pixel next to a core, a mean over its square: few pixels see much of a specimen, its ends and bends.
const MEAN_LIMIT: f64 = 1e-1;

/// The distance at which light of specimens ends, where that of a task does.
const SPECIMEN_REACH: f64 = 0.8;

/// Two tiles wide and high, with room for some that are smooth.
const SIZE: ImageSize = ImageSize {
    width: 76,
    height: 72,
};

impl Wave {
    /// Tests kernels that were just built, unless that was done on this device before.
    ///
    /// # Errors
    /// [`Error::SelfTest`] if they compute wrong. The kernels are forgotten.
    pub(super) fn self_test(
        &mut self,
        compute: &Compute,
        task: Task,
        program: &Program,
    ) -> Result<()> {
        // Another rule is somebody's experiment; simulators take minutes.
        let is_experiment = self.rule.is_some() || compute.device().is_simulator;
        if self.options.skips_self_test || is_experiment || program.was_tested() {
            return Ok(());
        }
        // On a queue of its own: the renderer's may wait for a host.
        let compute = compute.sibling()?;
        let mut tester = Self::new(&compute, &self.options)?;
        mem::swap(&mut tester.kernels, &mut self.kernels);
        let outcome = known_scenes(task).and_then(|scenes| {
            let mut scenes = scenes.iter();
            scenes.try_for_each(|scene| tester.check(&compute, task, scene))
        });
        mem::swap(&mut tester.kernels, &mut self.kernels);
        match &outcome {
            Ok(()) => program.mark_tested(),
            Err(_) => self.kernels.forget(task),
        }
        outcome
    }

    fn check(&mut self, compute: &Compute, task: Task, scene: &Scene) -> Result<()> {
        self.pace.slow_down(); // several launches for pixels, and for sources
        let wrong = match task.rays {
            Rays::Cells => self.wrong_cells(compute, scene)?,
            _ => self.wrong_pixels(compute, task, scene)?,
        };
        let Some(reason) = wrong else {
            return Ok(());
        };
        let device = compute.device();
        Err(Error::SelfTest {
            device: device.name.clone(),
            driver: format!("{} {}", device.platform, device.driver),
            reason,
        })
    }

    /// Compares some pixels of a scene with the reference; returns what is wrong.
    fn wrong_pixels(
        &mut self,
        compute: &Compute,
        task: Task,
        scene: &Scene,
    ) -> Result<Option<String>> {
        let found = self.draw_known(compute, task, scene)?;
        let plane = scene.view_plane();
        let tracer = Tracer::new(scene, scene.integration.method);
        let limit = scene.integration.method.tolerance().max(LEAST_LIMIT);
        let compared: Vec<usize> = (0..found.len()).step_by(STRIDE).collect();
        Ok(threads::find_any(&compared, |index| {
            let expected = tracer.pixel(scene, &plane, index);
            let limit = match tracer.is_mean(scene, &plane, index) {
                true => MEAN_LIMIT,
                false => limit,
            };
            let is_right = agrees(found[index], expected, limit);
            (!is_right).then(|| {
                format!(
                    "pixel {index} of the test is {:?}, not {expected:.6}",
                    found[index]
                )
            })
        }))
    }

    /// Compares some cells of a scene with the reference; returns what is wrong.
    pub(super) fn wrong_cells(
        &mut self,
        compute: &Compute,
        scene: &Scene,
    ) -> Result<Option<String>> {
        let grid = Grid::new(DVec3::new(0.1, -0.2, 0.15), DVec3::new(2.0, 1.4, 1.1), 21)?;
        for value in [CellValue::Mean(2), CellValue::Apart] {
            let nothing = &mut |_: f32| ControlFlow::Continue(());
            let volume = self.bake(compute, scene, (grid, value), nothing)?;
            if let Some(wrong) = wrong_cell(scene, &volume) {
                return Ok(Some(wrong));
            }
        }
        Ok(None)
    }

    /// Draws the pixels of the known scene by the very kernels of a task.
    fn draw_known(&mut self, compute: &Compute, task: Task, scene: &Scene) -> Result<Vec<Pixel>> {
        let size = scene.image;
        let mut film = Film::in_format(compute, task.film, size.width, size.height)?;
        let plan = match task.rays {
            Rays::Pixels | Rays::Tiles | Rays::Cells => self.plan(compute, scene, task.film)?,
            Rays::Listed => {
                let plane = scene.view_plane();
                let ray = |i| plane.ray(i % size.width, i / size.width);
                let rays: Vec<_> = (0..size.pixels() as u32).map(ray).collect();
                self.plan_rays(compute, scene, &rays)?
            }
        };
        self.begin(compute, &plan, size.pixels())?;
        match task.film {
            FilmFormat::Floats => {
                film.reserve_band(compute, size.pixels(), 1)?;
                let nothing = &mut |_: u32| ControlFlow::Continue(());
                let pixels = 0..size.pixels() as u32;
                self.draw(compute, &plan, pixels, &mut film, nothing)?;
            }
            FilmFormat::Halves | FilmFormat::Image { .. } => {
                self.draw_unwatched(compute, &plan, &mut film)?;
            }
        }
        let mut pixels = vec![[0.0; 4]; size.pixels()];
        film.read(compute, &mut pixels)?;
        self.settle(compute, &plan)?;
        self.settle_uploads(compute)?;
        Ok(pixels)
    }
}

/// Says which cell of a volume is not that of the reference.
fn wrong_cell(scene: &Scene, volume: &Volume) -> Option<String> {
    let emitter = Emitter::new(scene);
    let grid = volume.grid();
    let [columns, rows, layers] = grid.cells();
    for number in (0..columns * rows * layers).step_by(STRIDE) {
        let cell = [
            number % columns,
            number / columns % rows,
            number / columns / rows,
        ];
        let all = emitter.in_cell(grid, volume.value(), cell);
        let rest = volume
            .rest()
            .map(|rest| (rest, emitter.rest_in_cell(grid, cell)));
        for (volume, expected) in [Some((volume, all)), rest].into_iter().flatten() {
            let found = DVec3::from(volume.at(cell).map(f64::from));
            let error = (found - expected).abs().max_element();
            let is_right = error <= CELL_LIMIT * all.max_element(); // which no NaN is
            if !is_right {
                return Some(format!(
                    "cell {cell:?} of the test is {found}, not {expected:.6}"
                ));
            }
        }
    }
    None
}

/// Returns whether light is within the limit, relative to the brightest channel, and alpha is 1.
fn agrees(found: Pixel, expected: DVec3, limit: f64) -> bool {
    let [.., alpha] = found;
    let allowed = limit * expected.max_element();
    let channels = found.iter().zip(expected.to_array());
    let mut errors = channels.map(|(found, expected)| (f64::from(*found) - expected).abs());
    alpha == 1.0 && errors.all(|error| error <= allowed) // which no NaN is
}

/// Returns the scenes that a task's kernels are built for, and nothing else: one with decay and depths along the rays,
/// one with softening and depths along the axis.
fn known_scenes(task: Task) -> Result<[Scene; 2]> {
    let mut near = Scene::new(Camera::new(DVec3::new(0.4, -4.0, 1.7), DVec3::ZERO));
    near.decay = Some(Decay::new(0.1, 0.1));
    let mut far = Scene::new(Camera::new(DVec3::new(-1.0, -9.0, 4.0), DVec3::ZERO));
    far.integration.softening = 0.05;
    if task.has_footprints {
        near.integration.softening = 0.03; // ends of thinner cores are neither lines nor points
    }
    if let Some(power) = task.fading {
        let decay = Decay {
            power,
            ..Decay::new(0.1, 0.3)
        };
        (near.decay, far.decay) = (Some(decay), Some(decay));
        (near.absorption, far.absorption) = (
            Some(Absorption { kappa: 0.05 }),
            Some(Absorption { kappa: 0.4 }),
        );
    }
    for (scene, along) in [(&mut near, DepthAlong::Ray), (&mut far, DepthAlong::Axis)] {
        scene.image = SIZE;
        scene.integration = integration(task, scene.integration.softening);
        let first = match task.reduced {
            Reduced::Sum | Reduced::Root => Profile::Inverse,
            Reduced::RootOfSquares => Profile::InverseSquare,
        };
        add_specimens(scene, task, first); // where a root is taken, the only light
        if task.has_squares {
            add_specimens(scene, task, Profile::InverseSquare);
        }
        if task.has_shapes {
            add_specimens(scene, task, Profile::InverseCube);
        }
        if task.has_convolutions {
            let place = DVec3::new(-0.2, 0.1, 0.3);
            scene
                .segments
                .push(SourceKind::specimen(place, Profile::Convolution));
        }
        if task.has_depth {
            let distance = scene.camera.eye.length();
            let depth = |index: usize| depth(index, distance);
            let values = (0..SIZE.pixels()).map(depth).collect();
            scene.depth = Some(DepthImage::new(SIZE, along, values)?);
        }
    }
    Ok([near, far])
}

/// Returns how a task integrates, to a tolerance that its kernels, and no others, serve (see [`super::Rule`]).
fn integration(task: Task, softening: f64) -> Integration {
    let sampling = match task.rays {
        Rays::Tiles => Sampling::Tiles,
        Rays::Pixels | Rays::Listed | Rays::Cells => Sampling::Pixels,
    };
    let method = match task.method {
        Variant::Simpson => Method::Simpson { divisions: 64 },
        Variant::Jittered => Method::Jittered {
            divisions: 64,
            seed: 3,
        },
        Variant::Exact { coarse, .. } => Method::Exact {
            tolerance: if coarse { 1e-3 } else { 1e-4 },
            sampling,
        },
    };
    Integration {
        method,
        softening,
        antialias: match task.has_footprints {
            true => Antialias::Footprint,
            false => Antialias::None,
        },
        measure: Measure::Parameter, // as listed rays are
        reduction: match task.reduced {
            Reduced::Sum => Reduction::Sum,
            Reduced::Root | Reduced::RootOfSquares => Reduction::Rms,
        },
        ..Integration::default()
    }
}

/// Returns the depth of a pixel: a slope up to the sources, with a hole and an edge.
fn depth(index: usize, distance: f64) -> f32 {
    let (row, column) = (index / SIZE.width as usize, index % SIZE.width as usize);
    match row + column {
        ..50 => (distance * (0.8 + 0.004 * row as f64 + 0.002 * column as f64)) as f32,
        50..70 => f32::INFINITY,
        _ => (1.1 * distance) as f32,
    }
}

macro_rules! define_specimens {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// Adds one source of each kind that a task's kernels know.
        fn add_specimens(scene: &mut Scene, task: Task, profile: Profile) {
            let place = match profile {
                Profile::Inverse => DVec3::new(0.3, 0.2, 0.1),
                Profile::InverseSquare => DVec3::new(-0.4, 0.5, -0.2),
                _ => DVec3::new(0.1, -0.3, 0.4),
            };
            let mut kinds = task.kinds.into_iter();
            $(if kinds.next() == Some(true) {
                let mut specimen: crate::scene::$Type = SourceKind::specimen(place, profile);
                if task.has_ends && profile == Profile::InverseCube {
                    specimen.reach = Some(SPECIMEN_REACH);
                }
                let is_even = task.reduced != Reduced::Sum;
                let specimen = if is_even { specimen.evened() } else { specimen };
                let has_series = task.has_series && profile == Profile::Inverse;
                scene.$list.push(if has_series { specimen.with_series() } else { specimen });
            })*
        }
    };
}
for_each_kind!(define_specimens);
