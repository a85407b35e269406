//! Depth: how far each pixel's ray sees before something hides the light behind it (Abe, Watanabe 2010, eq. 13, 14).

#[cfg(feature = "files")]
use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{ClipDepth, ImageSize};
use crate::error::{Result, SceneError};

/// What a depth is measured along, from the eye.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum DepthAlong {
    /// The view ray itself: a distance.
    #[default]
    Ray,
    /// The ray's part along the direction of view, as most renderers' Z.
    Axis,
    /// No length: z / w of clip space behind a projection ([`ClipDepth`]). An image holds what that is along the axis.
    Ndc,
    /// The same as a depth buffer holds it: from 0 to 1, also where z / w goes from -1 to 1.
    Buffer,
}

impl DepthAlong {
    /// Returns whether depths are lengths.
    #[must_use]
    pub fn is_length(self) -> bool {
        matches!(self, Self::Ray | Self::Axis)
    }
}

/// A depth for every pixel, world units, by rows from the top left; infinite where nothing hides the light. Clones
/// share the values, which never change: a renderer uploads them once.
#[derive(Debug, Clone)]
pub struct DepthImage {
    size: ImageSize,
    along: DepthAlong,
    values: Arc<Vec<f32>>,
    #[cfg(feature = "files")]
    origin: Option<Arc<Origin>>,
}

/// How the depths of a file are read. Made of a [`DepthAlong`] it leaves all else at its default.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DepthOptions {
    /// What the depths are lengths of.
    pub along: DepthAlong,
    /// The channel that holds them, by its exact name; its part's may stand before it, as in `part.channel`. `None`:
    /// the one called `Z`, else the one whose name, layer or part says depth, else the only one.
    pub channel: Option<String>,
    /// World units to a unit of the file: 0.01 for centimetres in a scene in metres. Negative where the file's depths
    /// are, never 0.
    pub scale: f64,
    /// The value of the file that means that nothing is there, such as 0, -1 or NaN; infinity always does. That of a
    /// PNG is a whole number up to 65535.
    pub none: Option<f64>,
    /// What depths are lengths of that are none themselves: needed for [`DepthAlong::Ndc`] and [`DepthAlong::Buffer`].
    pub clip: Option<ClipDepth>,
    /// The size of an image in a file that does not say it: float32 without a header.
    pub size: Option<ImageSize>,
}

impl Default for DepthOptions {
    fn default() -> Self {
        Self {
            along: DepthAlong::default(),
            channel: None,
            scale: 1.0,
            none: None,
            clip: None,
            size: None,
        }
    }
}

impl From<DepthAlong> for DepthOptions {
    fn from(along: DepthAlong) -> Self {
        Self {
            along,
            ..Self::default()
        }
    }
}

/// The file that a depth image was read from, and how.
#[cfg(feature = "files")]
#[derive(Debug)]
pub(super) struct Origin {
    /// The full path.
    pub(super) file: PathBuf,
    pub(super) options: DepthOptions,
    /// The channel's name, with its part's; `None` of a file that has no channels.
    pub(super) channel: Option<String>,
    /// All channels, where the name of this one left a doubt.
    pub(super) doubt: Option<String>,
}

/// Two images are equal if they hide the same, wherever they came from.
impl PartialEq for DepthImage {
    fn eq(&self, other: &Self) -> bool {
        let is_alike = self.size == other.size && self.along == other.along;
        is_alike && (self.shares_values(other) || self.values == other.values)
    }
}

impl DepthImage {
    /// Makes a depth image of `values`, without copying them.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) if there is not one value for each pixel, or one is not a number or
    /// negative.
    pub fn new(size: ImageSize, along: DepthAlong, values: Vec<f32>) -> Result<Self> {
        let fault = |message: String| Err(SceneError::value("depth", message).into());
        check_count(size, &values)?;
        if !along.is_length() {
            let message = "depths of clip space are no lengths: `DepthImage::from_clip` takes their projection";
            return fault(message.to_owned());
        }
        let is_none = |depth: &f32| depth.is_nan() || *depth < 0.0;
        if let Some(index) = values.iter().position(is_none) {
            return fault(format!(
                "{} {}; a depth is a number from 0 on, infinite where nothing hides the light",
                values[index],
                place(size, index)
            ));
        }
        Ok(Self::of_checked(size, along, values))
    }

    /// Makes a depth image of depths of clip space, which it turns into lengths along the axis of view: NDC depths, or
    /// with [`DepthAlong::Buffer`] those of a depth buffer, by rows from the top left. At the far plane, to which
    /// buffers are cleared, nothing hides the light, nor where a value is infinite.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) if there is not one value for each pixel, one is not a number or lies
    /// beyond the planes, or `along` is a length.
    pub fn from_clip(
        size: ImageSize,
        along: DepthAlong,
        clip: &ClipDepth,
        values: Vec<f32>,
    ) -> Result<Self> {
        Self::from_scaled_clip(size, along, clip, 1.0, values)
    }

    /// The same of values that are to be multiplied first.
    pub(super) fn from_scaled_clip(
        size: ImageSize,
        along: DepthAlong,
        clip: &ClipDepth,
        scale: f64,
        mut values: Vec<f32>,
    ) -> Result<Self> {
        check_count(size, &values)?;
        let fault = |message: String| SceneError::value("depth", message);
        if along.is_length() {
            let message = "lengths have no projection: `DepthImage::new` takes them";
            return Err(fault(message.to_owned()).into());
        }
        for (index, value) in values.iter_mut().enumerate() {
            if *value == f32::INFINITY {
                continue;
            }
            let found = f64::from(*value) * scale;
            let depth = clip.along_axis_of(along, found).ok_or_else(|| {
                let low = match along {
                    DepthAlong::Buffer => 0.0,
                    _ => clip.range().low(),
                };
                fault(format!(
                    "{found} {}; depths of clip space go from {low} to 1 between the planes of this projection",
                    place(size, index)
                ))
            })?;
            *value = depth as f32;
        }
        Ok(Self::of_checked(size, DepthAlong::Axis, values))
    }

    fn of_checked(size: ImageSize, along: DepthAlong, values: Vec<f32>) -> Self {
        Self {
            size,
            along,
            values: Arc::new(values),
            #[cfg(feature = "files")]
            origin: None,
        }
    }

    /// Remembers what the image was read from.
    #[cfg(feature = "files")]
    pub(super) fn read_from(mut self, origin: Origin) -> Self {
        self.origin = Some(Arc::new(origin));
        self
    }

    #[cfg(feature = "files")]
    pub(super) fn origin(&self) -> Option<&Origin> {
        self.origin.as_deref()
    }

    /// Returns width and height in pixels.
    #[must_use]
    pub fn size(&self) -> ImageSize {
        self.size
    }

    /// Returns what the values are measured along: ray or axis.
    #[must_use]
    pub fn along(&self) -> DepthAlong {
        self.along
    }

    /// Returns a depth for every pixel.
    #[must_use]
    pub fn as_slice(&self) -> &[f32] {
        &self.values
    }

    /// Returns the values, which never change.
    pub(crate) fn shared_values(&self) -> &Arc<Vec<f32>> {
        &self.values
    }

    /// Returns whether both share their values.
    pub(crate) fn shares_values(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.values, &other.values)
    }
}

fn check_count(size: ImageSize, values: &[f32]) -> Result<()> {
    if values.len() == size.pixels() {
        return Ok(());
    }
    let message = format!(
        "{} values, {}x{} pixels need {}",
        values.len(),
        size.width,
        size.height,
        size.pixels()
    );
    Err(SceneError::value("depth", message).into())
}

/// Says where a pixel is.
fn place(size: ImageSize, index: usize) -> String {
    let width = size.width as usize;
    format!(
        "at column {}, row {}, counted from 0",
        index % width,
        index / width
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: ImageSize = ImageSize {
        width: 3,
        height: 2,
    };

    #[test]
    fn only_depths_are_taken() {
        let with = |value: f32| {
            let mut values = vec![1.0; 6];
            values[4] = value;
            DepthImage::new(SIZE, DepthAlong::Ray, values)
        };
        for good in [0.0, 1.5, f32::INFINITY] {
            assert!(with(good).is_ok());
        }
        for bad in [f32::NAN, -0.1, f32::NEG_INFINITY] {
            let message = with(bad).unwrap_err().to_string();
            assert!(message.contains("column 1, row 1"), "{message}");
        }
        let short = DepthImage::new(SIZE, DepthAlong::Ray, vec![1.0; 5]).unwrap_err();
        assert!(short.to_string().contains("5 values, 3x2 pixels need 6"));
    }
}
