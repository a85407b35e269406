//! The light that a scene's cores cast on surfaces, as a shader: points, and parts of lines whose light is even.

use glam::DVec3;

use super::block::Row;
use super::text::LICENCE;
use super::used::used;
use super::{Shader, UniformField};
use crate::error::{Error, Result, SceneError};
use crate::scene::{EmitterCore, Scene};

const TEXT: &str = include_str!("../../wgsl/irradiance.wgsl");

/// Where a line ends that has no end, world units.
const FAR: f64 = 1e9;

const MOST_BYTES: usize = 16384;

/// What casts light: the rows of points, and of lines.
#[derive(Default)]
struct Casting {
    points: Vec<[Row; 2]>,
    lines: Vec<[Row; 4]>,
}

impl Casting {
    fn of(scene: &Scene) -> Result<Self> {
        scene.validate()?;
        let refuse = |what: &str, (table, index): (&str, usize)| -> Error {
            let message = format!(
                "{what} has no irradiance in shaders, which have that of points and of straight lines: export a scene \
                 without it"
            );
            SceneError::value(format!("{table}[{index}]"), message).into()
        };
        let row = |v: DVec3, last: f64| [v.x as f32, v.y as f32, v.z as f32, last as f32];
        let mut casting = Self::default();
        for emitter in scene.emitters(&scene.lighting.unwrap_or_default()) {
            let [light, middle, end] = emitter.light;
            let radius2 = emitter.radius * emitter.radius;
            if (middle - light).length() + (end - light).length() > 1e-6 * light.length() {
                return Err(refuse("light that changes along a core", emitter.source));
            }
            match emitter.core {
                EmitterCore::Point(place) => {
                    casting.points.push([row(place, radius2), row(light, 0.0)]);
                }
                EmitterCore::Line {
                    point,
                    direction,
                    range,
                } => {
                    let [from, to] = range.map(|it| it.clamp(-FAR, FAR));
                    // The parameter 0 is at an end that there is.
                    let zero = if from > -FAR {
                        from
                    } else if to < FAR {
                        to
                    } else {
                        0.0
                    };
                    casting.lines.push([
                        row(point + zero * direction, radius2),
                        row(direction, 0.0),
                        [(from - zero) as f32, (to - zero) as f32, 0.0, 0.0],
                        row(light, 0.0),
                    ]);
                }
                _ => return Err(refuse("a ring, an arc or a curve", emitter.source)),
            }
            if casting.bytes() > MOST_BYTES {
                let what = format!("what goes beyond {MOST_BYTES} bytes of a uniform block");
                return Err(refuse(&what, emitter.source));
            }
        }
        match casting.bytes() {
            0 => Err(SceneError::value("", "the scene has no core that casts light").into()),
            _ => Ok(casting),
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.points[..]) + size_of_val(&self.lines[..])
    }

    fn counts(&self) -> Vec<usize> {
        vec![self.points.len(), self.lines.len()]
    }

    fn fields(&self) -> Vec<UniformField> {
        let points = (0..self.points.len())
            .flat_map(|it| ["place", "light"].map(|row| format!("points[{it}].{row}")));
        let lines = (0..self.lines.len()).flat_map(|it| {
            ["place", "along", "range", "light"].map(|row| format!("lines[{it}].{row}"))
        });
        let offsets = (0..).step_by(size_of::<Row>());
        let fields = points.chain(lines).zip(offsets);
        fields
            .map(|(name, offset)| UniformField { name, offset })
            .collect()
    }

    fn text(&self) -> String {
        let lists = [
            ("points", "PointLight", self.points.len()),
            ("lines", "LineLight", self.lines.len()),
        ];
        let mut declared = String::new();
        let mut sums = String::new();
        for (list, type_name, count) in lists.into_iter().filter(|(_, _, count)| *count > 0) {
            declared += &format!("    {list}: array<{type_name}, {count}>,\n");
            let call = match list {
                "points" => "point_irradiance(it.place.xyz - place, normal, it.place.w)",
                _ => {
                    "line_irradiance(it.place.xyz - place, normal, it.along.xyz, it.range.xy, it.place.w)"
                }
            };
            sums += &format!(
                "    for (var i = 0; i < {count}; i++) {{\n        let it = wave.{list}[i];\n        \
                 sum += {call} * it.light.rgb;\n    }}\n"
            );
        }
        let text = format!(
            "{LICENCE}// The irradiance that a scene's cores cast, linear RGB.\n\n\
             // The scene's values: rows of four numbers, one behind the other.\nstruct Wave {{\n{declared}}}\n\
             @group(0) @binding(0) var<uniform> wave: Wave;\n\n{TEXT}\n\
             // Returns the irradiance of a place of a surface, world space, with a normal of length 1.\n\
             // A matt surface of the albedo a has the radiance a / pi times that.\n\
             fn wave_irradiance(place: vec3f, normal: vec3f) -> vec3f {{\n    var sum = vec3f(0.0);\n{sums}    \
             return sum;\n}}\n"
        );
        used(&text)
    }
}

/// Returns the bytes of the block of a scene; `counts` are those of the one that was exported.
pub(super) fn uniforms(scene: &Scene, counts: &[usize]) -> Result<Option<Vec<u8>>> {
    let casting = Casting::of(scene)?;
    let rows = [casting.points.concat(), casting.lines.concat()].concat();
    Ok((casting.counts() == counts).then(|| bytemuck::cast_slice(&rows).to_vec()))
}

/// Returns the text in WGSL, and what fills its block.
pub(super) fn export(scene: &Scene) -> Result<Shader> {
    let casting = Casting::of(scene)?;
    Ok(Shader {
        text: casting.text(),
        counts: casting.counts(),
        fields: casting.fields(),
        entry: super::Entry::Irradiance,
    })
}
