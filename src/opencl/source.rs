//! The kernels' source, embedded in the program; includes are resolved here, so nothing is read from disk at run time.

use std::collections::HashSet;

macro_rules! embed {
    ($($name:literal),* $(,)?) => {
        /// Every file of `cl/`: its name from there, and its text.
        pub const FILES: &[(&str, &str)] = &[$(($name, include_str!(concat!("../../cl/", $name)))),*];
    };
}

embed!(
    "types.h",
    "lanes.h",
    "fine.h",
    "roots.h",
    "elementary.h",
    "decay.h",
    "ray.h",
    "sources.h",
    "field/profile.h",
    "field/quadratic.h",
    "field/sphere.h",
    "field/cylinder.h",
    "field/beam.h",
    "field/torus.h",
    "field/cubic.h",
    "field/spline.h",
    "field/curve.h",
    "integrate/quadrature.h",
    "integrate/simpson.h",
    "integrate/closed_form.h",
    "integrate/closed_form_square.h",
    "integrate/stretch.h",
    "integrate/closed.h",
    "integrate/beam.h",
    "integrate/panel.h",
    "integrate/exact.h",
    "peaks/torus.h",
    "peaks/curve.h",
    "peaks/curve_panels.h",
    "radiance.h",
    "clearance.h",
    "store.h",
    "tile.h",
    "hiding.h",
    "smoothness.h",
    "settle.h",
    "render.cl",
    "tiles.cl",
    "trace.cl",
);

/// The text of the given files of `cl/`, one after the other, every `#include "..."` replaced by the file. A file with
/// `#pragma once` comes once. `#line` marks keep the compiler's messages at `cl/FILE:LINE`.
pub fn resolve(names: &[&str]) -> String {
    let mut text = String::new();
    let mut seen = HashSet::new();
    for name in names {
        append(name, &mut seen, &mut text);
    }
    text
}

/// Like [`resolve`], for a text that is not in `cl/` but includes files from there.
pub(super) fn resolve_text(name: &str, source: &str) -> String {
    let mut text = String::new();
    expand(name, source, &mut HashSet::new(), &mut text);
    text
}

fn append(name: &str, seen: &mut HashSet<String>, text: &mut String) {
    match FILES.iter().find(|(file, _)| *file == name) {
        Some((_, source)) => expand(&format!("cl/{name}"), source, seen, text),
        None => text.push_str(&format!("#error \"no file cl/{name}\"\n")),
    }
}

fn expand(name: &str, source: &str, seen: &mut HashSet<String>, text: &mut String) {
    let is_new = seen.insert(name.to_owned());
    if !is_new && source.contains("#pragma once") {
        return;
    }
    text.push_str(&format!("#line 1 \"{name}\"\n"));
    for (index, line) in source.lines().enumerate() {
        if let Some(included) = included_file(line) {
            append(&relative_to(name, included), seen, text);
            text.push_str(&format!("#line {} \"{name}\"\n", index + 2));
        } else if line.trim() == "#pragma once" {
            text.push('\n');
        } else {
            text.push_str(line);
            text.push('\n');
        }
    }
}

fn included_file(line: &str) -> Option<&str> {
    let name = line.trim().strip_prefix("#include")?.trim();
    name.strip_prefix('"')?.strip_suffix('"')
}

/// The path from `cl/` of a file that is included by `cl/...` (or by a text outside, then from `cl/` itself).
fn relative_to(includer: &str, included: &str) -> String {
    let inside = includer.strip_prefix("cl/").unwrap_or("");
    let mut parts: Vec<&str> = inside.split('/').collect();
    parts.pop();
    for part in included.split('/') {
        if part == ".." {
            parts.pop();
        } else {
            parts.push(part);
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn includes_are_resolved_once_and_lines_keep_their_place() {
        let text = resolve(&["render.cl", "trace.cl"]);
        assert!(!text.contains("#include"), "an include is left");
        assert!(!text.contains("#error \"no file"), "a file is missing");
        assert_eq!(text.matches("floatv, intv and uintv hold").count(), 1);
        assert_eq!(text.matches("composite Simpson").count(), 0);
        assert_eq!(text.matches("floatv JOIN(simpson_, FIELD)").count(), 5);
        // The line after an include is announced with its own number.
        let render = FILES
            .iter()
            .find(|(name, _)| *name == "render.cl")
            .unwrap()
            .1;
        let line = 1 + render.lines().position(|l| l.contains("__kernel")).unwrap();
        let marked = text
            .split("#line")
            .find(|part| part.contains("__kernel void render"))
            .unwrap();
        let first: usize = marked.split_whitespace().next().unwrap().parse().unwrap();
        let offset = marked
            .lines()
            .skip(1)
            .position(|l| l.contains("__kernel"))
            .unwrap();
        assert_eq!(first + offset, line);
    }

    #[test]
    fn every_file_of_the_folder_is_embedded() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("cl");
        let mut folders = vec![root.clone()];
        let mut found = 0;
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                    continue;
                }
                let name = path
                    .strip_prefix(&root)
                    .unwrap()
                    .to_str()
                    .unwrap()
                    .to_owned();
                if name.ends_with(".h") || name.ends_with(".cl") {
                    assert!(
                        FILES.iter().any(|(file, _)| *file == name),
                        "{name} is not embedded"
                    );
                    found += 1;
                }
            }
        }
        assert_eq!(found, FILES.len());
    }
}
