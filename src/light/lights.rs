//! What casts light, packed and uploaded for the kernels that include `cl/light/irradiance.h`.

use glam::DVec3;

use super::pack::{CastLight, STRUCTS, pack};
use crate::error::Result;
use crate::opencl::{Argument, Compute, Uploaded};
use crate::scene::{Lighting, Scene, SourcesStamp};

/// The emitters of a scene on a device, packed and uploaded anew where they changed.
#[derive(Debug)]
pub(crate) struct Lights {
    /// Of what they were packed.
    known: Option<Known>,
    packed: Vec<CastLight>,
    list: Uploaded<CastLight>,
    count: u32,
    shadow_samples: u32,
}

#[derive(Debug, PartialEq)]
struct Known {
    sources: SourcesStamp,
    lighting: Option<Lighting>,
    origin: DVec3,
}

/// Returns the sizes of the structs, which every program that includes `cl/light/irradiance.h` is built with.
pub(crate) fn definitions() -> String {
    let sizes = STRUCTS.iter();
    sizes
        .map(|it| format!(" -D SIZEOF_{}={}", it.name.to_uppercase(), it.size))
        .collect()
}

impl Lights {
    pub(crate) fn new() -> Self {
        Self {
            known: None,
            packed: Vec::new(),
            list: Uploaded::new("the light that waves cast"),
            count: 0,
            shadow_samples: 0,
        }
    }

    /// Makes the device's lights those of a valid scene that is lit so, places relative to `origin`, world space,
    /// before the next command of the queue begins; without a lighting, none.
    ///
    /// # Errors
    /// As [`Uploaded::upload`].
    pub(crate) fn upload(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        lighting: Option<Lighting>,
        origin: DVec3,
    ) -> Result<()> {
        let known = Some(Known {
            sources: scene.sources_stamp(),
            lighting,
            origin,
        });
        let is_known = self.known == known;
        if !is_known {
            let emitters = lighting.map(|lighting| scene.emitters(&lighting));
            self.packed = pack(&emitters.unwrap_or_default(), origin);
            self.count = self.packed.len() as u32;
            self.known = known;
        }
        let shadows = lighting.filter(|lighting| lighting.shadows);
        self.shadow_samples = shadows.map_or(0, |lighting| lighting.shadow_samples);
        self.list.upload_unless(is_known, compute, &self.packed)
    }

    /// Returns what `LIGHTS_PARAMETERS` names.
    pub(crate) fn arguments(&self) -> [(&'static str, &dyn Argument); 3] {
        [
            ("lights", &self.list),
            ("light_count", &self.count),
            ("shadow_samples", &self.shadow_samples),
        ]
    }

    /// Waits for copies under way.
    ///
    /// # Errors
    /// As [`Uploaded::settle`].
    pub(crate) fn settle(&mut self, compute: &Compute) -> Result<()> {
        self.list.settle(compute)
    }
}
