//! `[display]`: an exposure that is not named is made to fit the scene, a background is read from its file.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use serde::de::value::{SeqAccessDeserializer, StrDeserializer};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::error::SceneError;
use crate::image::{Alpha, Background, BackgroundImage, Bloom, Display, Exposure, ToneMap};
use crate::scene::Scene;
use crate::scene::colors::read_color;

#[derive(Debug, Clone, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct DisplayTable {
    pub(super) exposure: Option<ExposureKey>,
    tone_map: ToneMap,
    #[serde(skip_serializing_if = "is_default")]
    alpha: Alpha,
    #[serde(skip_serializing_if = "Option::is_none")]
    background: Option<BackgroundKey>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bloom: Option<Bloom>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bits: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    quality: Option<u32>,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

// What is read of `[display]`.
keys! { pub(in crate::scene) DISPLAY_KEYS;
    exposure: NumberOr(-100.0, 100.0, "auto"), "stops", Otherwise("fits the scene"),
        "radiance times 2^exposure; \"auto\" fits the picture";
    tone_map: Word(&["agx", "khronos-neutral", "clamp", "exponential", "reinhard", "aces"]), NONE, Value("\"agx\""),
        "the curve that brings radiance into a picture's range";
    alpha: Word(&["opaque", "additive", "luminance"]), NONE, Value("\"opaque\""),
        "what a picture that is laid over another hides";
    background: ColorOrFile, NONE, Otherwise("black"), "what the light is laid over; a .png or .exr";
    bloom: Table("bloom"), NONE, Otherwise("none"), "light that is spread around what is bright";
    bits: Whole(8, 32), NONE, Otherwise("8; EXR 32"), "of a channel: PNG 8 or 16, EXR 16 or 32";
    quality: Whole(1, 100), NONE, Otherwise("90"), "of a JPEG";
}

// What is read of `bloom`, whose type knows no scene.
keys! { pub(in crate::scene) BLOOM_KEYS;
    strength: from_to(0.0, 1.0), NONE, Required, "which share of all light is spread";
    radius: from_to(1e-9, 1.0), "picture heights", Value("0.05"), "the standard deviation of its widest part";
}

impl DisplayTable {
    /// Makes the table as it is written; `None` where a background was made in code.
    pub(super) fn of(display: &Display) -> Option<Self> {
        let background = match &display.background {
            None => None,
            Some(Background::Color(color)) => Some(BackgroundKey::Color(*color)),
            Some(Background::Image(image)) => Some(BackgroundKey::File(image.file()?.to_owned())),
        };
        Some(Self {
            exposure: Some(ExposureKey(display.exposure)),
            tone_map: display.tone_map,
            alpha: display.alpha,
            background,
            bloom: display.bloom,
            bits: display.bits,
            quality: display.quality,
        })
    }

    /// Returns it as a scene has it, before its exposure is made to fit and its background is read.
    pub(super) fn display(&self) -> Display {
        Display {
            exposure: self
                .exposure
                .as_ref()
                .map_or(Exposure::default(), |key| key.0),
            tone_map: self.tone_map,
            alpha: self.alpha,
            background: match &self.background {
                Some(BackgroundKey::Color(color)) => Some(Background::Color(*color)),
                Some(BackgroundKey::File(_)) | None => None,
            },
            bloom: self.bloom,
            bits: self.bits,
            quality: self.quality,
        }
    }

    /// Returns the file of its background, from the folder of the scene.
    pub(super) fn background_file(&self) -> Option<&Path> {
        match &self.background {
            Some(BackgroundKey::File(file)) => Some(file),
            _ => None,
        }
    }

    /// Gives a scene of right values the exposure that fits it, unless one is named.
    pub(super) fn fit_exposure(&self, scene: &mut Scene) {
        if self.exposure.is_none() {
            scene.display.exposure = scene.fitting_exposure().into();
        }
    }

    /// Reads the background that is in a file, unless the scene has got another; its path is from `folder`.
    pub(super) fn read_background(
        &self,
        folder: &Path,
        scene: &mut Scene,
    ) -> Result<(), SceneError> {
        if let (Some(BackgroundKey::File(file)), None) =
            (&self.background, &scene.display.background)
        {
            let image = BackgroundImage::open(folder.join(file))
                .map_err(|error| SceneError::value("display.background", error.to_string()))?;
            scene.display.background = Some(Background::Image(Arc::new(image)));
        }
        Ok(())
    }
}

/// Stops, or "auto".
#[derive(Debug, Clone)]
pub(super) struct ExposureKey(pub(super) Exposure);

impl<'de> Deserialize<'de> for ExposureKey {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        reader.deserialize_any(ExposureVisitor).map(Self)
    }
}

struct ExposureVisitor;

#[allow(clippy::cast_precision_loss)] // whole numbers of stops
impl Visitor<'_> for ExposureVisitor {
    type Value = Exposure;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number of stops, or \"auto\"")
    }

    fn visit_f64<E: Error>(self, stops: f64) -> Result<Exposure, E> {
        Ok(stops.into())
    }

    fn visit_i64<E: Error>(self, stops: i64) -> Result<Exposure, E> {
        Ok((stops as f64).into())
    }

    fn visit_u64<E: Error>(self, stops: u64) -> Result<Exposure, E> {
        Ok((stops as f64).into())
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Exposure, E> {
        match word {
            "auto" => Ok(Exposure::Auto),
            _ => Err(E::invalid_type(serde::de::Unexpected::Str(word), &self)),
        }
    }
}

impl Serialize for ExposureKey {
    fn serialize<S: Serializer>(&self, writer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            Exposure::Stops(stops) => writer.serialize_f64(stops),
            Exposure::Auto => writer.serialize_str("auto"),
        }
    }
}

/// A colour, or the name of a file.
#[derive(Debug, Clone)]
enum BackgroundKey {
    Color([f64; 3]),
    File(PathBuf),
}

impl<'de> Deserialize<'de> for BackgroundKey {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        reader.deserialize_any(BackgroundVisitor)
    }
}

struct BackgroundVisitor;

impl<'de> Visitor<'de> for BackgroundVisitor {
    type Value = BackgroundKey;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a colour such as \"#102030\", or the name of an .exr or .png")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<BackgroundKey, A::Error> {
        read_color(SeqAccessDeserializer::new(list)).map(of_color)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<BackgroundKey, E> {
        match text.starts_with('#') {
            true => read_color(StrDeserializer::new(text)).map(of_color),
            false => Ok(BackgroundKey::File(text.into())),
        }
    }
}

fn of_color(color: DVec3) -> BackgroundKey {
    BackgroundKey::Color(color.to_array())
}

impl Serialize for BackgroundKey {
    fn serialize<S: Serializer>(&self, writer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Color(color) => color.serialize(writer),
            Self::File(file) => file.serialize(writer),
        }
    }
}
