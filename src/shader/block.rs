//! The values of a scene in a shader's uniform block: a head that says how rays run, then the lights of every kind, and
//! the series of local intensities, in rows of four float32.

use std::collections::HashMap;

use glam::DVec3;

use super::UniformField;
use super::refuse::refuse;
use crate::error::{Result, SceneError};
#[cfg(feature = "shaders")]
use crate::image::Exposure;
use crate::scene::Scene;
use crate::scene::kinds::for_each_kind;
use crate::wave::pack::layout::Falloff;
use crate::wave::pack::{Anchor, Sources};

/// Four numbers of the block.
pub(super) type Row = [f32; 4];

/// The most bytes that every implementation of OpenGL ES 3 and WebGPU has for a block.
const MOST_BYTES: usize = 16384;

/// A packed source that a shader may have.
pub(super) trait Exported {
    /// The text of its kind.
    const TEXT: &'static [&'static str];

    /// The same where a scene has light that changes along a core.
    const TEXT_WITH_SERIES: &'static [&'static str] = Self::TEXT;

    /// What the rows of its struct are called, but for its light.
    const ROW_NAMES: &'static [&'static str];

    /// Whether it is integrated by nodes.
    const IS_MAPPED: bool = false;

    /// How its field falls off.
    fn falloff(&self) -> Falloff;

    /// Returns its struct in the block, but for its light; where its series begins in the block's, and its rows.
    fn rows(&self, series: [usize; 2]) -> Vec<Row>;

    /// Returns colour times coefficient times measure.
    fn emission(&self) -> Row;

    /// Returns the rows of the series of one of a list, from all packed rows.
    fn series(_: &[Self], _: usize, _: &[Row]) -> Vec<Row>
    where
        Self: Sized,
    {
        Vec::new()
    }
}

/// Which formulas the light of a scene takes.
#[derive(Default)]
pub(super) struct Forms {
    /// Of the decay.
    pub(super) power: u32,
    pub(super) is_absorbed: bool,
    has_decay: bool,
    /// Straight light of 1/q, of 1/q^2, and without a closed form.
    pub(super) has_inverse: bool,
    pub(super) has_square: bool,
    pub(super) has_shaped: bool,
}

impl Forms {
    fn of(scene: &Scene) -> Self {
        let fading = scene.fading();
        let power = scene.decay.map_or(0, |decay| decay.power);
        Self {
            power,
            is_absorbed: fading.is_some_and(|it| it.kappa != 0.0),
            has_decay: power > 0,
            ..Self::default()
        }
    }

    /// Returns whether light fades otherwise than by the square of n.
    pub(super) fn fades(&self) -> bool {
        self.is_absorbed || matches!(self.power, 1 | 3)
    }

    fn add(&mut self, falloff: Falloff) {
        let is_shaped = falloff.profile > 1 || falloff.reach2 > 0.0 || self.fades();
        self.has_shaped |= is_shaped;
        self.has_inverse |= !is_shaped && falloff.profile == 0;
        self.has_square |= !is_shaped && falloff.profile == 1;
    }

    /// Returns a number that is another for other texts.
    fn number(&self) -> usize {
        let flags = [
            self.is_absorbed,
            self.has_decay,
            self.has_inverse,
            self.has_square,
            self.has_shaped,
        ];
        let flags = flags.iter().fold(0, |sum, it| 2 * sum + usize::from(*it));
        4 * flags + self.power as usize
    }
}

/// The values of a scene, and what there is of every kind.
pub(super) struct Block {
    pub(super) rows: Vec<Row>,
    pub(super) series: Vec<Row>,
    pub(super) forms: Forms,
    pub(super) kinds: Vec<Kind>,
    /// What light is multiplied with before it is tone-mapped.
    #[cfg(feature = "shaders")]
    pub(super) gain: f32,
}

pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) list_name: &'static str,
    pub(super) type_name: &'static str,
    pub(super) row_names: &'static [&'static str],
    pub(super) texts: [&'static [&'static str]; 2],
    pub(super) is_mapped: bool,
    pub(super) count: usize,
    pub(super) first_byte: usize,
}

macro_rules! add_kinds {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// Adds all sources; fails where one has no closed form.
        fn add_kinds(block: &mut Block, sources: &Sources, softening2: f32) -> Result<()> {
            $(
                let names = [stringify!($kind), stringify!($list), stringify!($Type)];
                block.add(names, &sources.$list, &sources.rows.list, softening2)?;
            )*
            Ok(())
        }
    };
}
for_each_kind!(add_kinds);

impl Block {
    pub(super) fn of(scene: &Scene) -> Result<Self> {
        scene.validate()?;
        refuse(scene)?;
        let length = scene.ray_length();
        let anchor = Anchor::new(scene, DVec3::ZERO, length, length);
        let sources = Sources::new(scene, &anchor);
        let softening2 = scene.integration.softening.powi(2) as f32;
        let mut block = Self {
            rows: head(scene, length),
            series: Vec::new(),
            forms: Forms::of(scene),
            kinds: Vec::new(),
            #[cfg(feature = "shaders")]
            gain: gain(scene),
        };
        add_kinds(&mut block, &sources, softening2)?;
        if block.kinds.is_empty() {
            let message = "the scene has no source that glows: give it one";
            return Err(SceneError::value("", message).into());
        }
        let bytes = size_of::<Row>() * (block.rows.len() + block.series.len());
        if bytes > MOST_BYTES {
            let message = format!(
                "the lights of the scene take {bytes} bytes of a uniform block, which has {MOST_BYTES}: \
                 export fewer sources, or fewer layers, at a time"
            );
            // The table that takes most of it.
            let ends = block.kinds.iter().skip(1).map(|it| it.first_byte);
            let ends = ends.chain([size_of::<Row>() * block.rows.len()]);
            let largest =
                (block.kinds.iter().zip(ends)).max_by_key(|(it, end)| end - it.first_byte);
            let key = largest.map_or(String::new(), |(it, _)| format!("{}[0]", it.name));
            return Err(SceneError::value(key, message).into());
        }
        Ok(block)
    }

    pub(super) fn counts(&self) -> Vec<usize> {
        let of_kinds = self.kinds.iter().map(|kind| kind.count);
        of_kinds
            .chain([self.series.len(), self.forms.number()])
            .collect()
    }

    /// Returns the fields of the block, each of four numbers.
    pub(super) fn fields(&self) -> Vec<UniformField> {
        let mut names: Vec<String> = HEAD_NAMES.map(str::to_owned).to_vec();
        for kind in &self.kinds {
            let of_light = ["light.color", "light.core"];
            let rows = || kind.row_names.iter().chain(&of_light);
            let of = |index| rows().map(move |row| format!("{}[{index}].{row}", kind.list_name));
            names.extend((0..kind.count).flat_map(of));
        }
        names.extend((0..self.series.len()).map(|index| format!("series[{index}]")));
        let offsets = (0..).step_by(size_of::<Row>());
        let fields = names.into_iter().zip(offsets);
        fields
            .map(|(name, offset)| UniformField { name, offset })
            .collect()
    }

    fn add<Device: Exported>(
        &mut self,
        [name, list_name, type_name]: [&'static str; 3],
        list: &[Device],
        packed: &[Row],
        softening2: f32,
    ) -> Result<()> {
        if list.is_empty() {
            return Ok(());
        }
        self.kinds.push(Kind {
            name,
            list_name,
            type_name,
            row_names: Device::ROW_NAMES,
            texts: [Device::TEXT, Device::TEXT_WITH_SERIES],
            is_mapped: Device::IS_MAPPED,
            count: list.len(),
            first_byte: size_of::<Row>() * self.rows.len(),
        });
        // What is the same is there once.
        let mut there: HashMap<Vec<[u32; 4]>, usize> = HashMap::new();
        for (index, source) in list.iter().enumerate() {
            let series = Device::series(list, index, packed);
            let bits = series.iter().map(|row| row.map(f32::to_bits)).collect();
            let begin = *there.entry(bits).or_insert_with(|| {
                let begin = self.series.len();
                self.series.extend_from_slice(&series);
                begin
            });
            self.rows.extend(source.rows([begin, series.len()]));
            let falloff = source.falloff();
            if !Device::IS_MAPPED {
                self.forms.add(falloff);
            }
            self.rows
                .extend(light(source.emission(), falloff, softening2));
        }
        Ok(())
    }
}

/// A squared distance beyond all, as `nodes.wgsl` has it; and where a Gaussian ends, in standard deviations.
const ENDLESS: f32 = 1e30;
const GAUSSIAN_END: f32 = 9.0;

/// Returns the struct of a light: colour and profile; thickness and reach.
fn light([red, green, blue, _]: Row, falloff: Falloff, softening2: f32) -> [Row; 2] {
    let Falloff {
        profile,
        radius2,
        reach2,
        ..
    } = falloff;
    let is_gaussian = profile == 3;
    let per = |it: f32| if it > 0.0 { it.recip() } else { 0.0 };
    let bell_end2 = if is_gaussian {
        GAUSSIAN_END * GAUSSIAN_END * radius2
    } else {
        ENDLESS
    };
    let end2 = if reach2 > 0.0 { reach2 } else { ENDLESS };
    let per_width2 = if is_gaussian { per(2.0 * radius2) } else { 0.0 };
    [
        [red, green, blue, profile as f32],
        [
            radius2 + softening2,
            per(reach2),
            end2.min(bell_end2),
            per_width2,
        ],
    ]
}

/// Returns 2 to the power of the exposure; what fits a picture is known only when there is one.
#[cfg(feature = "shaders")]
fn gain(scene: &Scene) -> f32 {
    match scene.display.exposure {
        Exposure::Stops(stops) => stops.exp2() as f32,
        Exposure::Auto => 1.0,
    }
}

/// What the rows of the head are called.
pub(super) const HEAD_NAMES: [&str; 6] = ["rays", "eye", "corner", "across", "down", "forward"];

/// Returns what the block begins with.
fn head(scene: &Scene, length: f64) -> Vec<Row> {
    let plane = scene.view_plane();
    let decay = scene.decay.filter(|decay| decay.power > 0);
    let strength = decay.map_or(1.0, |it| it.alpha / it.beta.powi(it.power as i32));
    let kappa = scene.absorption.map_or(0.0, |it| it.kappa);
    let row = |v: DVec3, last: f64| [v.x as f32, v.y as f32, v.z as f32, last as f32];
    let (width, height) = (f64::from(scene.image.width), f64::from(scene.image.height));
    let corner = plane.first_pixel - 0.5 * (plane.column_step + plane.row_step);
    let kind = if plane.is_parallel { 0.0 } else { 1.0 };
    let floor = crate::scene::CORE_FLOOR * length;
    let beta = decay.map_or(0.0, |decay| decay.beta * length);
    vec![
        // Emission is measured over s, the integral over lengths.
        [length, beta, strength / length, floor * floor].map(|it| it as f32),
        row(plane.eye, kind),
        row(corner, kappa),
        row(width * plane.column_step, 0.0),
        row(height * plane.row_step, 0.0),
        row(plane.forward, 0.0),
    ]
}
