//! What a shader cannot have.

use crate::error::{Error, Result};
use crate::scene::{Fading, Profile, Reduction, Scene};

/// Refuses what has no closed form here.
pub(super) fn refuse(scene: &Scene) -> Result<()> {
    let surfaces = [
        ("[[mesh]]", scene.meshes.len()),
        ("[[metaballs]]", scene.metaballs.len()),
        (
            "[[particles]]",
            scene.particles.len() + scene.light_elements.len(),
        ),
        ("[[wave]]", scene.waves.len()),
        ("[[volume]]", scene.volumes.len()),
    ];
    if let Some((name, _)) = surfaces.iter().find(|(_, count)| *count > 0) {
        return Err(no_form(name));
    }
    if scene.integration.reduction == Reduction::Rms {
        return Err(no_form("reduction = \"rms\""));
    }
    match scene.fading() {
        Some(Fading { kappa, .. }) if kappa != 0.0 => return Err(no_form("[absorption]")),
        Some(_) => return Err(no_form("a [decay] of another power than 2 or 0")),
        None => {}
    }
    if scene.any_falloff(|it| matches!(it.profile, Profile::Smeared | Profile::Convolution)) {
        return Err(no_form("profile = \"smeared\" or \"convolution\""));
    }
    Ok(())
}

pub(super) fn no_form(what: &str) -> Error {
    Error::Unsupported(format!(
        "{what} has no form in shaders, which have point, line, segment, beam, ring and curve with powers of 1/d or \
         a Gaussian: export a scene without it, or give the engine a baked volume"
    ))
}
