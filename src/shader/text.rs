//! The text of a shader in WGSL: parts of `wgsl/`, and between them what depends on the scene: the declaration of its
//! block, and the function that adds all light up.

use super::Entry;
use super::block::{Block, Kind, Row};
use super::used::used;

pub(super) const LICENCE: &str = "// Written by energywave, MIT OR Apache-2.0.\n";
const RAY: &str = include_str!("../../wgsl/ray.wgsl");
const CLOSED_FORM: &str = include_str!("../../wgsl/closed_form.wgsl");
const NODES: &str = include_str!("../../wgsl/nodes.wgsl");
const MAPPED: &str = include_str!("../../wgsl/mapped.wgsl");
const SHAPED: &str = include_str!("../../wgsl/shaped.wgsl");
const IMAGE: &str = include_str!("../../wgsl/image.wgsl");

impl Block {
    /// Returns the text in WGSL.
    pub(super) fn text(&self, entry: Entry) -> String {
        let mut text = LICENCE.to_owned();
        text += "// Light along a ray, the integral of field times decay: linear RGB before tone mapping.\n";
        text += &self.layout();
        text += &format!("\n{RAY}");
        text += &format!(
            "\n{}\n{NODES}\n{CLOSED_FORM}\n{}\n{}",
            self.fading(),
            self.shaped(),
            self.integral()
        );
        for kind in &self.kinds {
            for part in kind.texts[usize::from(!self.series.is_empty())] {
                text += &format!("\n{part}");
            }
            if kind.is_mapped {
                let mapped = MAPPED.replace("KIND", kind.name);
                text += &format!("\n{}", mapped.replace("TYPE", kind.type_name));
            }
        }
        text += &self.sum();
        if entry == Entry::Image {
            text += &format!("\n{IMAGE}");
        }
        used(&text)
    }

    /// Returns the function of what decay and absorption leave.
    fn fading(&self) -> String {
        let left = match self.forms.power {
            1 => "n",
            3 => "n * n * n",
            _ => "n * n",
        };
        let absorbed = match self.forms.is_absorbed {
            true => " * exp(-wave.corner.w * x)",
            false => "",
        };
        format!(
            "// Returns what is left of light at a place.\nfn fading(x: f32) -> f32 {{\n    let n = nearness(x);\n\
             \x20   return {left}{absorbed};\n}}\n"
        )
    }

    /// Returns the functions of light without a closed form.
    fn shaped(&self) -> String {
        if !self.forms.fades() {
            return SHAPED.to_owned();
        }
        // What calls it for a whole side takes two halves.
        let call = "shaped_panel(q, light, stretch, ";
        ["mapped", "place", "from_"]
            .iter()
            .fold(SHAPED.to_owned(), |text, first| {
                let halves = call.replace("panel", "halves");
                text.replace(&format!("{call}{first}"), &format!("{halves}{first}"))
            })
    }

    /// Returns the function of the integral over a stretch, with the forms that the scene has.
    fn integral(&self) -> String {
        let forms = &self.forms;
        let mut text = String::from(
            "// Returns the integral over a stretch, for a coefficient of 1.\n\
             fn integral_over(q: Quadratic, light: Light, stretch: Stretch) -> f32 {\n\
             \x20   if (stretch.to <= stretch.from_) {\n        return 0.0;\n    }\n",
        );
        let has_closed = forms.has_inverse || forms.has_square;
        text += match (forms.has_shaped, has_closed) {
            (true, false) => "    return shaped_over(q, light, stretch);\n",
            (true, true) => {
                "    if (light.color.w > 1.0 || light.core.y > 0.0) {\n        \
                 return shaped_over(q, light, stretch);\n    }\n"
            }
            (false, _) => "",
        };
        let of = |form| format!("return wave.rays.z * {form}(ends_of(q, stretch), q);\n");
        let (inverse, square) = (of("inverse_over"), of("inverse_square_over"));
        text += &match (forms.has_inverse, forms.has_square) {
            (true, true) => {
                format!("    if (light.color.w > 0.0) {{\n        {square}    }}\n    {inverse}")
            }
            (true, false) => format!("    {inverse}"),
            (false, true) => format!("    {square}"),
            (false, false) => String::new(),
        };
        text + "}\n\nfn evenly_lit(from_: f32, to: f32) -> Stretch {\n    return Stretch(from_, to, 1.0, 1.0);\n}\n"
    }

    /// Returns the declaration of the block, with the offset of every field.
    fn layout(&self) -> String {
        let mut text = String::from(
            "\n// The scene's values. Before each field its offset in bytes.\nstruct Wave {\n\
             \x20   /* 0 */ rays: vec4f, // |E - S|; beta |E - S|, or 0 without decay; what multiplies all light;\n\
             \x20                        // no squared distance to a core is taken below the last\n\
             \x20   /* 16 */ eye: vec4f, // last 1, or 0 where rays are parallel\n\
             \x20   /* 32 */ corner: vec4f, // from the eye to the top left corner of the plane; last kappa\n\
             \x20   /* 48 */ across: vec4f, // from there to the top right corner\n\
             \x20   /* 64 */ down: vec4f, // and to the bottom left corner\n\
             \x20   /* 80 */ forward: vec4f, // where parallel rays go\n",
        );
        for Kind {
            list_name,
            type_name,
            count,
            first_byte,
            ..
        } in &self.kinds
        {
            text += &format!("    /* {first_byte} */ {list_name}: array<{type_name}, {count}>,\n");
        }
        let (first, count) = (self.rows.len(), self.series.len());
        if count > 0 {
            let byte = size_of::<Row>() * first;
            text += &format!(
                "    /* {byte} */ series: array<vec4f, {count}>, // of local intensities, and corners of paths\n"
            );
        }
        let bytes = size_of::<Row>() * (first + count);
        text + &format!("}} // {bytes} bytes\n@group(0) @binding(0) var<uniform> wave: Wave;\n")
    }

    /// Returns the function that adds all light up.
    fn sum(&self) -> String {
        let mut text = String::from(
            "\n// Returns the light along a ray: linear RGB. The direction is of length 1, depth the length at which\n\
             // the ray is hidden, world units from its origin.\n\
             fn wave_light(origin: vec3f, direction: vec3f, depth: f32) -> vec3f {\n\
             \x20   let ray = Ray(origin, direction, clamp(depth, 0.0, wave.rays.x));\n\
             \x20   var light = vec3f(0.0);\n",
        );
        for Kind {
            name,
            list_name,
            count,
            ..
        } in &self.kinds
        {
            text += &format!(
                "    for (var i = 0; i < {count}; i++) {{\n        light += {name}_light(ray, wave.{list_name}[i]) * \
                 wave.{list_name}[i].light.color.rgb;\n    }}\n"
            );
        }
        text + "    return light;\n}\n"
    }
}
