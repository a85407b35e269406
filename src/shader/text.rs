//! The text of a shader in WGSL: parts of `wgsl/`, and between them what depends on the scene: the declaration of its
//! block, and the function that adds all light up.

use super::Entry;
use super::block::{Block, Kind, Row};

pub(super) const LICENCE: &str = "// Written by energywave, MIT OR Apache-2.0.\n";
const RAY: &str = include_str!("../../wgsl/ray.wgsl");
const CLOSED_FORM: &str = include_str!("../../wgsl/closed_form.wgsl");
const NODES: &str = include_str!("../../wgsl/nodes.wgsl");
const MAPPED: &str = include_str!("../../wgsl/mapped.wgsl");
const PLAIN: &str = include_str!("../../wgsl/plain.wgsl");
const SHAPED: &str = include_str!("../../wgsl/shaped.wgsl");
const IMAGE: &str = include_str!("../../wgsl/image.wgsl");

impl Block {
    /// Returns the text in WGSL.
    pub(super) fn text(&self, entry: Entry) -> String {
        let mut text = LICENCE.to_owned();
        text += "// Light along a ray, the integral of field times decay: linear RGB before tone mapping.\n";
        text += &self.layout();
        text += &format!("\n{RAY}");
        let has = |is_mapped| self.kinds.iter().any(|kind| kind.is_mapped == is_mapped);
        if has(true) || self.is_shaped {
            text += &format!("\n{NODES}");
        }
        if has(false) {
            let over = if self.is_shaped { SHAPED } else { PLAIN };
            text += &format!("\n{CLOSED_FORM}\n{over}");
        }
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
        text
    }

    /// Returns the declaration of the block, with the offset of every field.
    fn layout(&self) -> String {
        let mut text = String::from(
            "\n// The scene's values. Before each field its offset in bytes.\nstruct Wave {\n\
             \x20   /* 0 */ rays: vec4f, // |E - S|; beta |E - S|, or 0 without decay; what multiplies all light;\n\
             \x20                        // no squared distance to a core is taken below the last\n\
             \x20   /* 16 */ eye: vec4f, // last 1, or 0 where rays are parallel\n\
             \x20   /* 32 */ corner: vec4f, // from the eye to the top left corner of the projection plane\n\
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
                "    /* {byte} */ series: array<vec4f, {count}>, // of local intensities\n"
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
