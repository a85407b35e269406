//! The kernels of a renderer, built when a scene first needs them: for its method, and for the kinds of source it has.

use std::collections::HashMap;

use opencl3::kernel::Kernel;

use super::handle::Handle;
use super::program::{BuildOptions, Program};
use super::tiles;
use super::{Compute, ProgramKey};
use crate::error::{Error, Result};
use crate::pack::Rule;
use crate::scene::Method;

/// What a kernel is built for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Task {
    pub method: Variant,
    /// Which kinds of source the scene has, in the order of [`KIND_OPTIONS`].
    pub kinds: [bool; 5],
    /// Whether any source falls off with the squared distance.
    pub has_squares: bool,
    /// Whether depths end the rays.
    pub has_depth: bool,
    pub film: Film,
    pub rays: Rays,
}

/// What finished pixels are stored in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Film {
    /// A buffer of float32.
    Floats,
    /// A buffer of half floats.
    Halves,
    /// An image.
    Image,
}

/// Which rays a kernel takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Rays {
    /// Every pixel's.
    Pixels,
    /// A few of every tile, more next to cores.
    Tiles,
    /// Those of a list.
    Listed,
}

/// What the kernels' compiler is told of the kinds of source that there are.
const KIND_OPTIONS: [&str; 5] = [
    " -D SPHERES",
    " -D CYLINDERS",
    " -D BEAMS",
    " -D TORI",
    " -D CURVES",
];

/// A way to integrate that has kernels of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Variant {
    Simpson,
    Exact {
        /// Of the rule: what its kernels are built with.
        nodes: u32,
        coarse: bool,
    },
}

impl Variant {
    pub(super) fn of(method: Method, rule: Rule) -> Self {
        match method {
            Method::Simpson => Self::Simpson,
            Method::Exact => Self::Exact {
                nodes: rule.nodes,
                coarse: rule.coarse,
            },
        }
    }
}

/// Every kernel built so far.
#[derive(Debug, Default)]
pub(super) struct Kernels(HashMap<Task, Handle<Kernel>>);

impl Kernels {
    /// Makes sure of a kernel; the key of its program if it was built now. `rule` is what the method `exact` integrates
    /// with.
    ///
    /// # Errors
    /// As [`Program::build`].
    pub(super) fn prepare(
        &mut self,
        compute: &Compute,
        options: &BuildOptions,
        task: Task,
        rule: &Rule,
    ) -> Result<Option<ProgramKey>> {
        if self.0.contains_key(&task) {
            return Ok(None);
        }
        let mut definitions = match task.method {
            Variant::Simpson => String::new(),
            Variant::Exact { .. } => rule.definitions(),
        };
        let options_of = KIND_OPTIONS.into_iter().zip(task.kinds);
        let squares = (" -D INVERSE_SQUARES", task.has_squares);
        let depth = (" -D DEPTH", task.has_depth);
        let image = (" -D IMAGE", task.film == Film::Image);
        let halves = (" -D HALVES", task.film == Film::Halves);
        for (option, is_there) in options_of.chain([squares, depth, image, halves]) {
            if is_there {
                definitions += option;
            }
        }
        if task.rays == Rays::Tiles {
            definitions += &tiles::definitions(tiles::workers(compute.device(), options));
        }
        let options = BuildOptions {
            extra: format!("{definitions} {}", options.extra),
            ..options.clone()
        };
        let (file, name) = match task.rays {
            Rays::Pixels => ("render.cl", "render"),
            Rays::Tiles => ("tiles.cl", "tiles"),
            Rays::Listed => ("trace.cl", "trace"),
        };
        let program = Program::build(compute, &[file], &options)?;
        self.0.insert(task, program.kernel(name)?);
        Ok(Some(program.key()))
    }

    /// Lets a kernel go.
    pub(super) fn forget(&mut self, task: Task) {
        self.0.remove(&task);
    }

    /// How many were built.
    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    /// A kernel that was made sure of.
    pub(super) fn get(&self, task: Task) -> Result<&Handle<Kernel>> {
        self.0.get(&task).ok_or_else(|| {
            Error::Unsupported("a kernel that was never built was launched".to_owned())
        })
    }
}
