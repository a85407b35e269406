//! `[integration]` of a scene file.

mod overrides;

pub use overrides::Overrides;

use serde::{Deserialize, Serialize};

use crate::scene::integration::{
    check_divisions, check_slices, check_step, check_strata, check_tolerance,
};
use crate::scene::values::{Checked, Fault};
use crate::scene::{
    Antialias, Crowd, Integration, Measure, Method, Reduction, Sampling, VolumeMethod,
};

/// `[integration]`: keys of all methods may stand there, whichever is chosen.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct IntegrationTable {
    method: MethodName,
    #[serde(skip_serializing_if = "Option::is_none")]
    divisions: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    #[serde(skip_serializing_if = "is_zero")]
    absolute_tolerance: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    sampling: Option<Sampling>,
    measure: Measure,
    #[serde(skip_serializing_if = "Reduction::is_sum")]
    reduction: Reduction,
    antialias: Antialias,
    softening: f64,
    #[serde(skip_serializing_if = "is_true")]
    hidden_surfaces: bool,
    #[serde(skip_serializing_if = "VolumeMethodName::is_ray")]
    volume_method: VolumeMethodName,
    #[serde(skip_serializing_if = "Option::is_none")]
    slices: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    volume_step: Option<f64>,
    #[serde(skip_serializing_if = "is_auto")]
    crowd: Crowd,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // serde gives a reference
fn is_auto(crowd: &Crowd) -> bool {
    *crowd == Crowd::Auto
}

#[allow(clippy::trivially_copy_pass_by_ref)] // serde gives a reference
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

#[allow(clippy::trivially_copy_pass_by_ref)] // serde gives a reference
fn is_true(flag: &bool) -> bool {
    *flag
}

// What is read of `[integration]`.
keys! { pub(in crate::scene) INTEGRATION_KEYS;
    method: Word(&["simpson", "jittered", "exact"]), NONE, Value("\"exact\""),
        "the integral to a tolerance, or sums of equal divisions";
    tolerance: from_to_below(1e-12, 1.0), NONE, Value("1e-3"), "exact: the relative error aimed at";
    absolute_tolerance: NOT_NEGATIVE, "linear light", Value("0"),
        "tiles: what a source's light may be off by beside that";
    sampling: Word(&["pixels", "tiles"]), NONE, Value("\"tiles\""),
        "exact: take every integral, or those that are needed";
    divisions: Whole(1, 65536), NONE, Value("200"), "simpson: an even number, at least 2; jittered: any";
    seed: WHOLE, NONE, Value("0"), "jittered: which random numbers";
    measure: Word(&["parameter", "length"]), NONE, Value("\"length\""),
        "sum over world units, or over s from 0 to 1 along the ray as in 2015";
    reduction: Word(&["sum", "rms"]), NONE, Value("\"sum\""),
        "the sum of all lights, or the root of one light's summed square";
    antialias: Word(&["footprint", "none"]), NONE, Value("\"footprint\""),
        "exact: a pixel is the mean over its square, or what one ray gets";
    softening: NOT_NEGATIVE, WORLD, Value("0"), "its square is added to every squared distance to a core";
    hidden_surfaces: Flag, NONE, Value("true"), "whether surfaces hide the light behind them";
    volume_method: Word(&["ray", "slices"]), NONE, Value("\"ray\""),
        "volumes: along rays, or on planes before the eye as in 2006";
    slices: Whole(1, 65536), NONE, Value("256"), "volumes by slices: how many planes";
    volume_step: from_to(0.01, 100.0), "cells", Value("1"), "volumes by rays: the length of a piece at most";
    crowd: Word(&["auto", "never"]), NONE, Value("\"auto\""),
        "many points: their light together, or of each by itself";
}

/// The name of a [`Method`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MethodName {
    /// Simpson's rule with equal divisions.
    Simpson,
    /// A random place of each division.
    Jittered,
    /// The integral.
    Exact,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
enum VolumeMethodName {
    #[default]
    Ray,
    Slices,
}

impl VolumeMethodName {
    #[allow(clippy::trivially_copy_pass_by_ref)] // serde gives a reference
    fn is_ray(&self) -> bool {
        *self == Self::Ray
    }
}

impl Default for IntegrationTable {
    fn default() -> Self {
        let Integration {
            measure,
            reduction,
            antialias,
            softening,
            hidden_surfaces,
            absolute_tolerance,
            ..
        } = Integration::default();
        Self {
            method: MethodName::Exact,
            divisions: None,
            seed: None,
            tolerance: None,
            absolute_tolerance,
            sampling: None,
            measure,
            reduction,
            antialias,
            softening,
            hidden_surfaces,
            volume_method: VolumeMethodName::Ray,
            slices: None,
            volume_step: None,
            crowd: Crowd::Auto,
        }
    }
}

/// What `[integration]` of a file says of all methods, whichever it chooses; the default where it says nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MethodKeys {
    /// Simpson and jittered: number of equal divisions.
    pub divisions: u32,
    /// Jittered: chooses the random numbers.
    pub seed: u32,
    /// Exact: relative error aimed at.
    pub tolerance: f64,
    /// Exact: where integrals are taken.
    pub sampling: Sampling,
}

impl IntegrationTable {
    pub(super) fn keys(&self) -> MethodKeys {
        MethodKeys {
            divisions: self.divisions.unwrap_or(200),
            seed: self.seed.unwrap_or(0),
            tolerance: self.tolerance.unwrap_or(1e-3),
            sampling: self.sampling.unwrap_or_default(),
        }
    }

    pub(super) fn integration(&self) -> Integration {
        let keys = self.keys();
        Integration {
            method: match self.method {
                MethodName::Simpson => Method::Simpson {
                    divisions: keys.divisions,
                },
                MethodName::Jittered => Method::Jittered {
                    divisions: keys.divisions,
                    seed: keys.seed,
                },
                MethodName::Exact => Method::Exact {
                    tolerance: keys.tolerance,
                    sampling: keys.sampling,
                },
            },
            absolute_tolerance: self.absolute_tolerance,
            measure: self.measure,
            reduction: self.reduction,
            antialias: self.antialias,
            softening: self.softening,
            hidden_surfaces: self.hidden_surfaces,
            volumes: match self.volume_method {
                VolumeMethodName::Ray => VolumeMethod::Ray {
                    step: self.volume_step.unwrap_or(1.0),
                },
                VolumeMethodName::Slices => VolumeMethod::Slices {
                    count: self.slices.unwrap_or(256),
                },
            },
            crowd: self.crowd,
        }
    }

    pub(super) fn of(integration: &Integration) -> Self {
        let (volume_method, slices, volume_step) = match integration.volumes {
            VolumeMethod::Ray { step } => {
                (VolumeMethodName::Ray, None, (step != 1.0).then_some(step))
            }
            VolumeMethod::Slices { count } => (VolumeMethodName::Slices, Some(count), None),
        };
        let keep = Self {
            volume_method,
            slices,
            volume_step,
            absolute_tolerance: integration.absolute_tolerance,
            crowd: integration.crowd,
            measure: integration.measure,
            reduction: integration.reduction,
            antialias: integration.antialias,
            softening: integration.softening,
            hidden_surfaces: integration.hidden_surfaces,
            ..Self::default()
        };
        match integration.method {
            Method::Simpson { divisions } => Self {
                method: MethodName::Simpson,
                divisions: Some(divisions),
                ..keep
            },
            Method::Jittered { divisions, seed } => Self {
                method: MethodName::Jittered,
                divisions: Some(divisions),
                seed: Some(seed),
                ..keep
            },
            Method::Exact {
                tolerance,
                sampling,
            } => Self {
                method: MethodName::Exact,
                tolerance: Some(tolerance),
                sampling: Some(sampling),
                ..keep
            },
        }
    }

    /// Checks what the scene does not hold: the keys of the method that was not chosen.
    pub(super) fn check(&self) -> Checked {
        self.slices.map_or(Ok(()), check_slices)?;
        self.volume_step.map_or(Ok(()), check_step)?;
        let keys = self.keys();
        match self.method {
            MethodName::Jittered => check_strata(keys.divisions)?,
            MethodName::Simpson | MethodName::Exact => check_divisions(keys.divisions)?,
        }
        check_sampling(&self.integration().method, self.sampling)?;
        check_tolerance(keys.tolerance)
    }
}

/// Checks that who names tiles has the method that they are for.
pub(super) fn check_sampling(method: &Method, named: Option<Sampling>) -> Checked {
    if matches!(method, Method::Exact { .. }) || named != Some(Sampling::Tiles) {
        return Ok(());
    }
    let name = method.name();
    let message = format!("tiles are for the method \"exact\"; \"{name}\" takes every pixel");
    Err(Fault::new("sampling", message))
}
