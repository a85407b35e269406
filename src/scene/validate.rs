//! The one check of a scene's values. What passes here needs no further check, neither in packing nor in a kernel.

use super::depth_layers::{FINEST, depths_across};
use super::kinds::for_each_kind;
use super::values::{Checked, Fault, SMALLEST, finite};
use super::{BRIGHTEST, Brightness, CORE_FLOOR, List, Measure, Scene, SourceKind, SourcesStamp};
use crate::error::{Result, SceneError};
use crate::image::{Background, Bloom, Display, Exposure, ImageSize};

type CheckedScene = std::result::Result<(), SceneError>;

/// Equal only for sources that are equally right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CheckedSources(SourcesStamp, Brightness);

impl Scene {
    /// Checks every value. The renderer calls it too: call it where you want the fault before the frame.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] with the key of the first value that cannot be drawn.
    pub fn validate(&self) -> Result<()> {
        Ok(self.check()?)
    }

    /// Checks every value, of the sources only if they, or the light that float32 holds, are not those of `checked`.
    pub(crate) fn validate_again(&self, checked: &mut Option<CheckedSources>) -> Result<()> {
        let now = Some(CheckedSources(
            self.sources_stamp(),
            self.check_but_sources()?,
        ));
        if *checked != now {
            *checked = None;
            self.validate()?;
            *checked = now;
        }
        Ok(())
    }

    pub(super) fn check(&self) -> CheckedScene {
        let brightness = self.check_but_sources()?;
        self.check_sources(&brightness)
    }

    /// Checks what does not grow with the number of sources; gives what their light is held against.
    fn check_but_sources(&self) -> std::result::Result<Brightness, SceneError> {
        let of = |table: &'static str| move |fault: Fault| fault.of(table);
        self.camera.check().map_err(of("camera"))?;
        self.check_ray_length().map_err(of("camera"))?;
        check_size(self.image).map_err(of("image"))?;
        if let Some(decay) = &self.decay {
            decay.check().map_err(of("decay"))?;
        }
        if let Some(absorption) = &self.absorption {
            absorption.check().map_err(of("absorption"))?;
        }
        if let Some(lighting) = &self.lighting {
            lighting.check().map_err(of("lighting"))?;
        }
        let integration = &self.integration;
        integration.method.check().map_err(of("integration"))?;
        for (key, value) in [
            ("softening", integration.softening),
            ("absolute_tolerance", integration.absolute_tolerance),
        ] {
            check_not_negative(key, value).map_err(of("integration"))?;
        }
        check_display(&self.display, self.image).map_err(of("display"))?;
        self.check_depth().map_err(of(""))?;
        for (index, mesh) in self.meshes.iter().enumerate() {
            mesh.check()
                .map_err(|fault| fault.of(&format!("mesh[{index}]")))?;
        }
        for (index, metaballs) in self.metaballs.iter().enumerate() {
            metaballs
                .check()
                .map_err(|fault| fault.of(&format!("metaballs[{index}]")))?;
        }
        self.check_reduction()?;
        self.check_simulation()?;
        self.check_particles()?;
        self.check_points()?;
        self.check_volumes()?;
        let brightness = self.brightness();
        let of_line = brightness.most / brightness.least_distance;
        if of_line > BRIGHTEST {
            let power = self.decay.map_or(0, |decay| decay.power);
            return Err(SceneError::value(
                "decay.beta",
                format!(
                    "alpha / beta^{power} next to a core comes to {of_line:.0e}, more than float32 holds"
                ),
            ));
        }
        Ok(brightness)
    }

    /// Returns the greatest value that decay times field times measure can take, on a ray through a core.
    fn brightness(&self) -> Brightness {
        let decay = self.decay.map_or(1.0, |decay| decay.at(0.0));
        let length = self.ray_length();
        let least_distance = (CORE_FLOOR * length).max(self.integration.softening);
        let measure = match self.integration.measure {
            Measure::Parameter => 1.0,
            Measure::Length => length,
        };
        Brightness {
            most: decay * measure.max(1.0),
            least_distance,
            measure: self.integration.measure,
            reduction: self.integration.reduction,
        }
    }

    fn check_ray_length(&self) -> Checked {
        if self.camera.ray_length.is_some() || self.ray_length() >= SMALLEST {
            return Ok(());
        }
        let message = "the projection plane lies behind the target and all sources, so ray_length has no default: \
            give camera.ray_length, or a smaller near";
        Err(Fault::new("near", message))
    }

    fn check_depth(&self) -> Checked {
        let Some(depth) = &self.depth else {
            return Ok(());
        };
        let (depth, image) = (depth.size(), self.image);
        if depths_across(depth, image).is_some() {
            return Ok(());
        }
        Err(Fault::new(
            "depth",
            format!(
                "the depth image has {}x{} pixels, the image {}x{}; they must be equal, or the depths 2 to {FINEST} \
                 times as many across and down",
                depth.width, depth.height, image.width, image.height
            ),
        ))
    }
}

macro_rules! check_sources {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        impl Scene {
            fn check_sources(&self, brightness: &Brightness) -> CheckedScene {
                $(check_list(stringify!($kind), &self.$list, brightness)?;)*
                Ok(())
            }
        }
    };
}
for_each_kind!(check_sources);

fn check_list<T: SourceKind>(
    kind: &str,
    list: &List<T>,
    brightness: &Brightness,
) -> std::result::Result<(), SceneError> {
    for (index, source) in list.iter().enumerate() {
        source
            .check(brightness)
            .map_err(|fault| fault.of(&format!("{kind}[{index}]")))?;
    }
    Ok(())
}

fn check_size(size: ImageSize) -> Checked {
    let limit = ImageSize::LIMIT;
    for (key, pixels) in [("width", size.width), ("height", size.height)] {
        if pixels == 0 {
            return Err(Fault::new(key, "must be at least 1 pixel"));
        }
        if pixels > limit {
            let message = format!("{pixels} pixels; an image is at most {limit}x{limit}");
            return Err(Fault::new(key, message));
        }
    }
    Ok(())
}

fn check_not_negative(key: &'static str, value: f64) -> Checked {
    finite(key, value)?;
    if value < 0.0 {
        return Err(Fault::new(key, "must not be negative"));
    }
    Ok(())
}

fn check_display(display: &Display, size: ImageSize) -> Checked {
    if let Exposure::Stops(stops) = display.exposure {
        finite("exposure", stops)?;
        if stops.abs() > 100.0 {
            return Err(Fault::new("exposure", "more than 100 stops"));
        }
    }
    if let Some(bits) = display.bits.filter(|bits| ![8, 16, 32].contains(bits)) {
        let message = format!("{bits} bits a channel; a PNG has 8 or 16, an EXR 16 or 32");
        return Err(Fault::new("bits", message));
    }
    if let Some(quality) = display
        .quality
        .filter(|quality| !(1..=100).contains(quality))
    {
        let message = format!("{quality}; a quality lies between 1 and 100");
        return Err(Fault::new("quality", message));
    }
    if let Some(bloom) = &display.bloom {
        check_bloom(bloom)?;
    }
    match &display.background {
        None => Ok(()),
        Some(Background::Color(color)) => {
            let is_shown = color.iter().all(|channel| (0.0..=1.0).contains(channel));
            match is_shown {
                true => Ok(()),
                false => Err(Fault::new("background", "channels lie between 0 and 1")),
            }
        }
        Some(Background::Image(image)) => {
            let found = image.size();
            if found == size {
                return Ok(());
            }
            let message = format!(
                "the background has {}x{} pixels, the image {}x{}; they must be equal",
                found.width, found.height, size.width, size.height
            );
            Err(Fault::new("background", message))
        }
    }
}

fn check_bloom(bloom: &Bloom) -> Checked {
    if !(0.0..=1.0).contains(&bloom.strength) {
        let message = format!(
            "{}; the share of light that is spread lies between 0 and 1",
            bloom.strength
        );
        return Err(Fault::new("bloom.strength", message));
    }
    if !(1e-9..=1.0).contains(&bloom.radius) {
        let message = format!(
            "{}; it is a share of the image's height, above 0 and at most 1",
            bloom.radius
        );
        return Err(Fault::new("bloom.radius", message));
    }
    Ok(())
}
