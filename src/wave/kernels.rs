//! The kernels of the wave, built when a scene first needs them: for its method, and for the kinds of source it has.

use std::collections::HashMap;

use super::kinds::{Present, resolve};
use super::pack::layout::STRUCTS;
use super::{Rule, counts, tiles};
use crate::error::{Error, Result};
use crate::opencl::{Compute, FilmFormat, Kernel, Program, RendererOptions, flags_for};
use crate::scene::CORE_FLOOR;
use crate::scene::kinds::KIND_COUNT;

/// What a kernel is built for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Task {
    pub method: Variant,
    /// Which kinds of source the scene has.
    pub kinds: Present,
    /// Whether lights are sums, and any source falls off with the squared distance.
    pub has_squares: bool,
    /// Whether lights are sums, and any has no closed form for how it falls off.
    pub has_shapes: bool,
    /// Whether any adds up the light of all points of its core.
    pub has_convolutions: bool,
    /// The power of the decay where light fades in another way than by that of 2015.
    pub fading: Option<u32>,
    pub reduced: Reduced,
    /// Whether any has a series over its core.
    pub has_series: bool,
    /// Tiles: whether the light of any ends.
    pub has_ends: bool,
    /// Whether pixels are means over their squares.
    pub has_footprints: bool,
    /// Whether depths end the rays.
    pub has_depth: bool,
    pub film: FilmFormat,
    pub rays: Rays,
}

impl Task {
    /// Returns whether integrals along a ray are calls: where copies would be many, compilers take four times as long
    /// for them, and nothing is faster. One kind by pixels has one copy.
    fn has_calls(&self) -> bool {
        let kinds = self.kinds.iter().filter(|is_present| **is_present).count();
        self.rays == Rays::Tiles || kinds > 1
    }
}

/// What kernels make of an integral.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Reduced {
    /// Itself.
    Sum,
    /// Its root; the fields are packed as their squares.
    Root,
    /// The root of that of squared fields.
    RootOfSquares,
}

/// Which rays a kernel takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Rays {
    /// Every pixel's.
    Pixels,
    /// A few of every tile, more next to cores.
    Tiles,
    /// Those of a list.
    Listed,
    /// None: fields are sampled in the cells of a grid.
    Cells,
}

/// A way to integrate that has kernels of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Variant {
    Simpson,
    Jittered,
    Exact {
        /// Of the rule: what its kernels are built with.
        nodes: u32,
        coarse: bool,
    },
}

/// Every kernel built so far.
#[derive(Debug, Default)]
pub(super) struct Kernels(HashMap<Task, Kernel>);

impl Kernels {
    /// Makes sure that a kernel is built, and returns its program if it was built now. `rule` is what the method
    /// `exact` integrates with.
    ///
    /// # Errors
    /// As [`Program::build`].
    pub(super) fn prepare(
        &mut self,
        compute: &Compute,
        options: &RendererOptions,
        task: Task,
        rule: &Rule,
    ) -> Result<Option<Program>> {
        if self.0.contains_key(&task) {
            return Ok(None);
        }
        let (name, text) = task_text(&task);
        let workers = tiles::workers(compute.device(), options);
        let definitions = task_definitions(workers, options.counts_samples, &task, rule);
        let program = Program::build(compute, text, &definitions, options)?;
        self.0.insert(task, program.kernel(name)?);
        Ok(Some(program))
    }

    /// Returns whether a kernel is built.
    pub(super) fn has(&self, task: Task) -> bool {
        self.0.contains_key(&task)
    }

    /// Forgets a kernel.
    pub(super) fn forget(&mut self, task: Task) {
        self.0.remove(&task);
    }

    /// Returns how many were built.
    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    /// Returns a kernel that was prepared.
    pub(super) fn get(&self, task: Task) -> Result<&Kernel> {
        self.0.get(&task).ok_or_else(|| {
            Error::Unsupported("a kernel that was never built was launched".to_owned())
        })
    }
}

/// Returns a task's kernel as a device's compiler gets it: its name, the resolved text of its program, and the options.
pub(crate) fn program_text(
    task: &Task,
    rule: &Rule,
    (lanes, workers): (u32, u32),
) -> (&'static str, String, String) {
    let (name, text) = task_text(task);
    let definitions = task_definitions(workers, false, task, rule);
    (name, text, flags_for(lanes, &definitions))
}

/// Returns what every program of the wave is built with: the host owns these numbers.
pub(crate) fn common_definitions(counts_samples: bool) -> String {
    let sizes: String = STRUCTS
        .iter()
        .map(|s| format!(" -D SIZEOF_{}={}", s.name.to_uppercase(), s.size))
        .collect();
    let places = counts::definitions();
    let counting = if counts_samples {
        " -D COUNT_NODES"
    } else {
        ""
    };
    format!(" -D CORE_FLOOR={CORE_FLOOR:e}f -D KIND_COUNT={KIND_COUNT}{sizes}{places}{counting}")
}

/// Returns the name of a task's kernel, and the resolved text of its program.
fn task_text(task: &Task) -> (&'static str, String) {
    let (file, name) = match task.rays {
        Rays::Pixels => ("wave/render.cl", "render"),
        Rays::Tiles => ("wave/tiles/tiles.cl", "tiles"),
        Rays::Listed => ("wave/trace.cl", "trace"),
        Rays::Cells => ("wave/bake.cl", "bake"),
    };
    (name, resolve(file, &task.kinds))
}

/// Returns what that is built with, where `workers` work-items share a tile.
fn task_definitions(workers: u32, counts_samples: bool, task: &Task, rule: &Rule) -> String {
    let mut definitions = common_definitions(counts_samples);
    match task.method {
        Variant::Simpson => {}
        Variant::Jittered => definitions += " -D JITTERED",
        Variant::Exact { .. } => definitions += &rule.definitions(),
    }
    definitions += match task.reduced {
        Reduced::Sum => "",
        Reduced::Root => " -D ROOT",
        Reduced::RootOfSquares => " -D ROOT -D SQUARED",
    };
    if task.has_squares || task.reduced == Reduced::Root {
        definitions += " -D INVERSE_SQUARES";
    }
    if task.has_shapes || task.fading.is_some() || task.reduced == Reduced::RootOfSquares {
        definitions += " -D SHAPES";
    }
    if task.has_convolutions {
        definitions += " -D CONVOLUTION";
    }
    if let Some(power) = task.fading {
        definitions += &format!(" -D FADING={power}");
    }
    if task.has_series {
        definitions += " -D SERIES";
    }
    if task.has_ends {
        definitions += " -D ENDS";
    }
    if task.has_footprints {
        definitions += " -D FOOTPRINT";
    }
    if task.has_depth {
        definitions += " -D DEPTH";
    }
    definitions += task.film.definitions();
    if task.rays == Rays::Tiles {
        definitions += &tiles::definitions(workers);
    }
    if task.has_calls() {
        definitions += " -D PER_RAY=CALL";
    }
    definitions
}
