//! What a shader cannot have, by the key of the scene file that asks for it.

use crate::error::{Error, Result, SceneError};
use crate::scene::kinds::for_each_kind;
use crate::scene::{Profile, Reduction, Scene, SourceKind};

/// Refuses what has no form here.
pub(super) fn refuse(scene: &Scene) -> Result<()> {
    let lists = [
        ("mesh", scene.meshes.len()),
        ("metaballs", scene.metaballs.len()),
        ("wave", scene.waves.len()),
        (
            "particles",
            scene.particles.len() + scene.light_elements.len(),
        ),
        ("points", scene.points.len()),
        ("volume", scene.volumes.len()),
    ];
    if let Some((name, _)) = lists.iter().find(|(_, count)| *count > 0) {
        return Err(no_form(format!("{name}[0]"), &format!("[[{name}]]")));
    }
    if scene.integration.reduction == Reduction::Rms {
        return Err(no_form(
            "integration.reduction",
            "the root of a sum of squares",
        ));
    }
    refuse_sources(scene)
}

macro_rules! define_refuse_sources {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        fn refuse_sources(scene: &Scene) -> Result<()> {
            $(for (index, source) in scene.$list.iter().enumerate() {
                refuse_source(source, &format!("{}[{index}]", stringify!($kind)))?;
            })*
            Ok(())
        }
    };
}
for_each_kind!(define_refuse_sources);

fn refuse_source(source: &impl SourceKind, key: &str) -> Result<()> {
    let layers = source.shared().layers;
    for (index, light) in source.lights().enumerate() {
        let name = match light.falloff.profile {
            Profile::Smeared => "profile = \"smeared\"",
            Profile::Convolution => "profile = \"convolution\"",
            _ => continue,
        };
        let is_own = layers.get(index).is_some_and(|it| it.profile.is_some());
        let layer = if is_own {
            format!(".layers[{index}]")
        } else {
            String::new()
        };
        return Err(no_form(format!("{key}{layer}.profile"), name));
    }
    Ok(())
}

/// Says that a key has no form.
pub(super) fn no_form(key: impl Into<String>, what: &str) -> Error {
    let message = format!(
        "{what} has no form in shaders, which have point, line, segment, beam, ring, curve and polyline with powers of \
         1/d or a Gaussian: export a scene without it, or give the engine a baked volume"
    );
    SceneError::value(key, message).into()
}
