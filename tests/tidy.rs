//! The rules of ARCHITECTURE.md that a search can check.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn text_of(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap()
}

/// Every file under a folder of the repository whose name has this ending, with its text.
fn files(folder: &str, endings: &[&str]) -> Vec<(PathBuf, String)> {
    let mut folders = vec![root().join(folder)];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let ending = path.extension().unwrap_or_default().to_str().unwrap();
            if path.is_dir() {
                folders.push(path);
            } else if endings.contains(&ending) {
                let text = fs::read_to_string(&path).unwrap();
                found.push((path.strip_prefix(root()).unwrap().to_owned(), text));
            }
        }
    }
    assert!(!found.is_empty(), "no file in {folder}");
    found.sort();
    found
}

/// The text before its unit tests.
fn without_tests(text: &str) -> &str {
    text.split("#[cfg(test)]\nmod tests")
        .next()
        .unwrap()
        .split("#[cfg(test)]\npub(crate) mod tests")
        .next()
        .unwrap()
}

/// The modules of the crate's first level that a text names, but for comments.
fn modules_named(text: &str) -> Vec<String> {
    let code = without_tests(text).lines();
    let code = code.filter(|line| !line.trim_start().starts_with("//"));
    let mut named = Vec::new();
    for line in code {
        for (at, _) in line.match_indices("crate::") {
            let rest = &line[at + "crate::".len()..];
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
            named.push(rest[..end.unwrap_or(rest.len())].to_owned());
        }
    }
    named
}

/// What a module may look at: what lies below it. Errors, costs, the host's memory, the files that are written and how
/// text is shown lie below everything.
const LAYERS: [(&str, &[&str]); 19] = [
    ("image", &[]),
    ("volume", &["image"]),
    ("opencl", &[]),
    ("bloom", &["image", "opencl"]),
    ("glow", &["image", "opencl", "scene"]),
    // The self-tests of crowds, of light and of volumes compare with the reference.
    ("crowd", &["image", "opencl", "scene", "reference"]),
    ("mesh", &["image", "opencl", "scene", "light", "reference"]),
    ("metaball", &["image", "opencl", "scene"]),
    // One function is the renderer's, on the best device.
    ("light", &["opencl", "scene", "Device"]),
    ("scene", &["image", "volume"]),
    (
        "texture",
        &["image", "opencl", "scene", "volume", "reference"],
    ),
    ("particle", &["scene"]),
    // The block has the values that kernels get.
    ("shader", &["image", "light", "scene", "wave"]),
    ("reference", &["image", "scene", "volume"]),
    // The self-test compares with the reference.
    ("wave", &["image", "opencl", "scene", "reference", "volume"]),
    (
        "render",
        &[
            "image",
            "opencl",
            "bloom",
            "glow",
            "crowd",
            "light",
            "texture",
            "mesh",
            "metaball",
            "particle",
            "scene",
            "reference",
            "volume",
            "wave",
        ],
    ),
    (
        "papers",
        &[
            "volume",
            "image",
            "opencl",
            "particle",
            "scene",
            "reference",
            "render",
        ],
    ),
    ("verify", &["scene", "reference", "render"]),
    (
        "internals",
        &[
            "opencl",
            "bloom",
            "glow",
            "crowd",
            "light",
            "mesh",
            "texture",
            "metaball",
            "scene",
            "reference",
            "wave",
            "render",
        ],
    ),
];
const BELOW_ALL: [&str; 11] = [
    "error",
    "cost",
    "memory",
    "nearest",
    "output",
    "shown",
    "threads",
    "Error",
    "Result",
    "Renderer",
    "FrameCost",
];

/// What breaks the rule that arrows run down, of files and their texts.
fn arrows_up(files: &[(PathBuf, String)]) -> Vec<String> {
    let mut wrong = Vec::new();
    for (path, text) in files {
        let inside = path.strip_prefix("src").unwrap();
        let first = inside.iter().next().unwrap().to_str().unwrap();
        let module = first.trim_end_matches(".rs");
        let Some((_, below)) = LAYERS.iter().find(|(name, _)| *name == module) else {
            continue;
        };
        for named in modules_named(text) {
            let is_below = below.contains(&named.as_str()) || BELOW_ALL.contains(&named.as_str());
            if named != module && !is_below {
                wrong.push(format!("{}: crate::{named}", path.display()));
            }
        }
    }
    wrong
}

#[test]
fn arrows_run_down() {
    assert_eq!(arrows_up(&files("src", &["rs"])), Vec::<String>::new());
    let planted = |path: &str, text: &str| vec![(PathBuf::from(path), text.to_owned())];
    assert_eq!(
        arrows_up(&planted("src/opencl/x.rs", "use crate::scene::Scene;")).len(),
        1
    );
    assert_eq!(
        arrows_up(&planted("src/scene/x.rs", "use crate::image::Size;")).len(),
        0
    );
}

#[test]
fn only_the_self_test_of_kernels_asks_the_reference() {
    let askers: Vec<_> = files("src/wave", &["rs"])
        .into_iter()
        .filter(|(_, text)| modules_named(text).contains(&"reference".to_owned()))
        .map(|(path, _)| path)
        .collect();
    assert_eq!(askers, [Path::new("src/wave/self_test.rs")]);
}

#[test]
fn every_kind_has_its_four_files_and_no_other_file_lists_the_kinds() {
    let table = text_of("src/scene/kinds.rs");
    // `sphere: Sphere, spheres;`
    let rows = table
        .lines()
        .map(str::trim)
        .filter(|line| line.ends_with(';'));
    let kinds: Vec<&str> = rows
        .filter_map(|line| line.split_once(": "))
        .filter(|(name, rest)| name.chars().all(|c| c.is_ascii_lowercase()) && rest.contains(", "))
        .map(|(name, _)| name)
        .collect();
    assert!(kinds.len() >= 5 && kinds.contains(&"torus"), "{kinds:?}");
    for kind in &kinds {
        for place in [
            "src/scene/source/KIND.rs",
            "src/wave/pack/KIND.rs",
            "src/reference/field/KIND.rs",
            "cl/wave/source/KIND.h",
        ] {
            let path = root().join(place.replace("KIND", kind));
            assert!(path.exists(), "{}", path.display());
        }
    }
    // What is made for each kind is made from the table: outside of its own files nothing names all of them. The rays
    // that files know by the kind's name, the specimen of a benchmark and the README of the contract are no lists.
    let all = files("src", &["rs"])
        .into_iter()
        .chain(files("cl", &["h", "cl"]));
    for (path, text) in all {
        let is_known = ["src/scene/kinds.rs", "src/verify.rs", "src/lib.rs"]
            .iter()
            .any(|known| path == Path::new(known));
        let words = |kind: &&&str| {
            let code = without_tests(&text).lines();
            let mut code = code.filter(|line| !line.trim_start().starts_with("//"));
            code.any(|line| {
                line.split(|c: char| !c.is_alphanumeric())
                    .any(|word| word == **kind)
            })
        };
        let named = kinds.iter().filter(words).count();
        assert!(is_known || named < 4, "{}: {named} kinds", path.display());
    }
}

#[test]
fn every_file_of_cl_is_embedded_once() {
    let lists = [
        "src/wave/kinds.rs",
        "src/bloom/sources.rs",
        "src/glow/sources.rs",
        "src/crowd/sources.rs",
        "src/texture/sources.rs",
        "src/light/sources.rs",
        "src/mesh/sources.rs",
        "src/metaball/sources.rs",
        "src/opencl/source.rs",
    ];
    let lists = lists.map(text_of).concat();
    for (path, _) in files("cl", &["h", "cl"]) {
        let name = path.strip_prefix("cl").unwrap().to_str().unwrap();
        // Headers of kinds are embedded by their rows.
        let kind = name.strip_prefix("wave/source/").unwrap_or(name);
        let is_kind = root()
            .join("src/scene/source")
            .join(kind.replace(".h", ".rs"))
            .exists();
        let count = lists.matches(&format!("\"{name}\"")).count();
        assert_eq!(count, usize::from(!is_kind), "{name}");
    }
}

#[test]
fn unsafe_has_one_home() {
    // Hosts hand over handles that only they know to be alive: their calls are unsafe to make, in the renderer's
    // interface.
    let homes = [
        "src/opencl/",
        "src/internals.rs",
        "src/render/host.rs",
        "src/render/host_points.rs",
        "src/main.rs",
    ];
    for (path, text) in files("src", &["rs"]) {
        let is_home = homes
            .iter()
            .any(|home| path.to_str().unwrap().starts_with(home));
        let code = text
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"));
        let has_unsafe = code.clone().any(|line| {
            line.contains("unsafe {") || line.contains("unsafe fn") || line.contains("unsafe impl")
        });
        assert!(is_home || !has_unsafe, "{}", path.display());
    }
}

#[test]
fn the_library_has_no_word_of_the_command_line() {
    for (path, text) in files("src", &["rs"]) {
        let is_program = path.starts_with("src/cli") || path == Path::new("src/main.rs");
        let code = without_tests(&text).lines();
        let flags = code
            .filter(|line| !line.trim_start().starts_with("//"))
            .filter(|line| line.contains("--device") || line.contains("--no-self-test"));
        assert!(is_program || flags.count() == 0, "{}", path.display());
    }
}

#[test]
fn files_are_short_and_lines_too() {
    for folder in ["src", "cl", "tests", "benches", "examples", "crates/python"] {
        for (path, text) in files(folder, &["rs", "h", "cl", "py"]) {
            let lines = text.lines().count();
            assert!(lines <= 420, "{}: {lines} lines", path.display());
            // In tests, tables of what is expected may be wider.
            let is_counted = |line: &str| folder != "tests" || line.trim_start().starts_with("//");
            for (index, line) in text.lines().enumerate() {
                if !is_counted(line) {
                    continue;
                }
                let columns = line.chars().count();
                assert!(
                    columns <= 120,
                    "{}:{}: {columns} columns",
                    path.display(),
                    index + 1
                );
            }
        }
    }
}
