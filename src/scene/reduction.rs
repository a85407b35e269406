//! What goes with the root of one light's integral.

use super::kinds::for_each_kind;
use super::source::{Layer, Profile};
use super::values::{Checked, Fault};
use super::{Reduction, Scene, SourceKind};
use crate::error::SceneError;

macro_rules! check_each_root {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        impl Scene {
            /// Checks the sources where the scene takes a root: it looks at one.
            pub(super) fn check_reduction(&self) -> Result<(), SceneError> {
                if self.integration.reduction == Reduction::Sum {
                    return Ok(());
                }
                let count = self.source_count();
                if count > 1 {
                    let message = format!(
                        "\"rms\" takes the root of one light, there are {count} sources: leave one, or write \"sum\""
                    );
                    return Err(SceneError::value("integration.reduction", message));
                }
                $(if let Some(source) = self.$list.iter().next() {
                    check_root(source).map_err(|fault| fault.of(concat!(stringify!($kind), "[0]")))?;
                })*
                Ok(())
            }
        }
    };
}
for_each_kind!(check_each_root);

fn check_root(source: &impl SourceKind) -> Checked {
    let shared = source.shared();
    let layers = (shared.light_count() > 1).then_some("layers");
    if let Some(key) = layers.or(source.uneven()) {
        let message = "reduction = \"rms\" takes the root of one light that is even along its core: leave this out, or \
            write \"sum\"";
        return Err(Fault::new(key, message));
    }
    let in_layer = |key: &str, names: fn(&Layer) -> bool| match shared.layers.first() {
        Some(layer) if names(layer) => format!("layers[0].{key}"),
        _ => key.to_owned(),
    };
    if shared.has_peak() {
        let message = "is the light of an integral and not of its root: with reduction = \"rms\" give a coefficient";
        return Err(Fault::new(
            in_layer("peak", |layer| layer.peak.is_some()),
            message,
        ));
    }
    let mut lights = shared.lights();
    if lights.any(|light| light.falloff.profile == Profile::Convolution) {
        let message = "light that is added up over a core has no root of squares here: choose another profile, \
            or reduction = \"sum\"";
        return Err(Fault::new(
            in_layer("profile", |layer| layer.profile.is_some()),
            message,
        ));
    }
    Ok(())
}
