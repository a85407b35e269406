//! What takes the place of values of a scene that was read: options of the program, keywords of Python, a struct of C.
//! One rule for all: naming divisions asks for a sum of so many, naming a tolerance or a sampling for the integral.

use super::{MethodKeys, MethodName, check_sampling};
use crate::error::{Result, SceneError};
use crate::image::Exposure;
use crate::scene::{Antialias, Method, Sampling, Scene};

/// Values that take the place of a scene's own; `None` leaves what it has. [`Overrides::apply`] is what
/// [`Scene::from_file_with`](crate::scene::Scene::from_file_with) and
/// [`AnimatedScene::at_with`](crate::scene::AnimatedScene::at_with) call before they check the scene.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Overrides {
    /// Width of the image, pixels.
    pub width: Option<u32>,
    /// Height of the image, pixels.
    pub height: Option<u32>,
    /// The quadrature. `None`: what `divisions`, `tolerance` and `sampling` ask for, else the scene's.
    pub method: Option<MethodName>,
    /// Divisions of Simpson's rule (even) or strata; asks for Simpson's rule where the scene has neither.
    pub divisions: Option<u32>,
    /// The relative error that the exact method aims at; asks for it.
    pub tolerance: Option<f64>,
    /// Where the exact method takes integrals; asks for it.
    pub sampling: Option<Sampling>,
    /// Which rays a pixel of the exact method stands for.
    pub antialias: Option<Antialias>,
    /// Exposure of the picture.
    pub exposure: Option<Exposure>,
}

impl Overrides {
    /// Puts the values into a scene that was read and is to be checked; `keys` is what its text says of all methods.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) for tiles with a method that takes every pixel.
    pub fn apply(&self, scene: &mut Scene, keys: &MethodKeys) -> Result<()> {
        scene.image.width = self.width.unwrap_or(scene.image.width);
        scene.image.height = self.height.unwrap_or(scene.image.height);
        let integration = &mut scene.integration;
        integration.method = self.method(integration.method, keys)?;
        integration.antialias = self.antialias.unwrap_or(integration.antialias);
        scene.display.exposure = self.exposure.unwrap_or(scene.display.exposure);
        Ok(())
    }

    fn method(&self, of_scene: Method, keys: &MethodKeys) -> Result<Method> {
        let name = self.name(MethodName::of(&of_scene));
        let divisions = self.divisions.unwrap_or(keys.divisions);
        let method = match name {
            MethodName::Simpson => Method::Simpson { divisions },
            MethodName::Jittered => Method::Jittered {
                divisions,
                seed: keys.seed,
            },
            MethodName::Exact => Method::Exact {
                tolerance: self.tolerance.unwrap_or(keys.tolerance),
                sampling: self.sampling.unwrap_or(keys.sampling),
            },
        };
        let checked = check_sampling(&method, self.sampling);
        checked.map_err(|fault| SceneError::value("integration.sampling", fault.message()))?;
        Ok(method)
    }

    fn name(&self, of_scene: MethodName) -> MethodName {
        let asks_sum = self.divisions.is_some();
        let asks_exact = self.tolerance.is_some() || self.sampling.is_some();
        match self.method {
            Some(name) => name,
            None if asks_sum == asks_exact => of_scene,
            None if asks_exact => MethodName::Exact,
            None if of_scene == MethodName::Exact => MethodName::Simpson,
            None => of_scene,
        }
    }
}

impl MethodName {
    /// The words of scene files.
    pub const WORDS: [(&'static str, Self); 3] = [
        ("exact", Self::Exact),
        ("simpson", Self::Simpson),
        ("jittered", Self::Jittered),
    ];

    fn of(method: &Method) -> Self {
        match method {
            Method::Simpson { .. } => Self::Simpson,
            Method::Jittered { .. } => Self::Jittered,
            Method::Exact { .. } => Self::Exact,
        }
    }
}

impl Sampling {
    /// The words of scene files.
    pub const WORDS: [(&'static str, Self); 2] = [("tiles", Self::Tiles), ("pixels", Self::Pixels)];
}

impl Antialias {
    /// The words of scene files.
    pub const WORDS: [(&'static str, Self); 2] =
        [("footprint", Self::Footprint), ("none", Self::None)];
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEYS: MethodKeys = MethodKeys {
        divisions: 40,
        seed: 7,
        tolerance: 1e-4,
        sampling: Sampling::Pixels,
    };
    const SIMPSON: Method = Method::Simpson { divisions: 2 };
    const JITTERED: Method = Method::Jittered {
        divisions: 2,
        seed: 1,
    };

    fn exact(tolerance: f64, sampling: Sampling) -> Method {
        Method::Exact {
            tolerance,
            sampling,
        }
    }

    #[test]
    fn what_is_named_asks_for_the_method_that_has_it() {
        let none = Overrides::default();
        let divisions = Overrides {
            divisions: Some(8),
            ..none
        };
        let tolerance = Overrides {
            tolerance: Some(0.5),
            ..none
        };
        let both = Overrides {
            divisions: Some(8),
            ..tolerance
        };
        let of_keys = exact(1e-4, Sampling::Pixels);
        let seeded = |divisions| Method::Jittered { divisions, seed: 7 };
        let eight = Method::Simpson { divisions: 8 };
        for (overrides, of_scene, expected) in [
            (none, SIMPSON, Method::Simpson { divisions: 40 }),
            (none, JITTERED, seeded(40)),
            (none, Method::default(), of_keys),
            (divisions, Method::default(), eight),
            (divisions, JITTERED, seeded(8)),
            (tolerance, JITTERED, exact(0.5, Sampling::Pixels)),
            (both, Method::default(), exact(0.5, Sampling::Pixels)),
            (both, SIMPSON, eight),
        ] {
            let found = overrides.method(of_scene, &KEYS).unwrap();
            assert_eq!(found, expected, "{overrides:?} of {of_scene:?}");
        }
    }

    #[test]
    fn tiles_are_for_the_exact_method() {
        let tiles = Overrides {
            sampling: Some(Sampling::Tiles),
            ..Overrides::default()
        };
        let found = tiles.method(SIMPSON, &KEYS).unwrap();
        assert_eq!(found, exact(1e-4, Sampling::Tiles));
        let conflict = Overrides {
            method: Some(MethodName::Jittered),
            ..tiles
        };
        let error = conflict.method(SIMPSON, &KEYS).unwrap_err().to_string();
        assert!(error.contains("integration.sampling: tiles are"), "{error}");
        assert!(error.contains("\"jittered\" takes every"), "{error}");
    }
}
