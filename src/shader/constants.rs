//! A block's values as a constant of GLSL, for hosts that have no blocks.

use super::block::{Block, Row};

impl Block {
    /// Returns the constant `wave`, and what the light is multiplied with before it is tone-mapped.
    pub(super) fn constant(&self) -> String {
        let text = |row: &Row| {
            let [x, y, z, w] = row;
            format!("vec4({x:?}, {y:?}, {z:?}, {w:?})")
        };
        let list = |type_name: &str, items: &[String]| {
            let count = items.len();
            format!(
                "{type_name}[{count}](\n        {}\n    )",
                items.join(",\n        ")
            )
        };
        let head = super::block::HEAD_NAMES.len();
        let mut parts: Vec<String> = self.rows[..head].iter().map(text).collect();
        let mut rest = &self.rows[head..];
        for kind in &self.kinds {
            let own = kind.row_names.len();
            let (lights, others) = rest.split_at(kind.count * (own + 2));
            let of_light = |rows: &[Row]| {
                let rows: Vec<String> = rows.iter().map(text).collect();
                let (shape, light) = rows.split_at(own);
                format!(
                    "{}({}, Light({}))",
                    kind.type_name,
                    shape.join(", "),
                    light.join(", ")
                )
            };
            let items: Vec<String> = lights.chunks_exact(own + 2).map(of_light).collect();
            parts.push(list(kind.type_name, &items));
            rest = others;
        }
        if !self.series.is_empty() {
            let items: Vec<String> = self.series.iter().map(text).collect();
            parts.push(list("vec4", &items));
        }
        let values = parts.join(",\n    ");
        format!(
            "const Wave wave = Wave(\n    {values}\n);\nconst float EXPOSURE = {:?};\n",
            self.gain
        )
    }
}
