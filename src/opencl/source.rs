//! OpenCL C of several files as one text: includes are resolved here, so nothing is read from disk at run time.

use std::collections::HashSet;

/// A file: its path from `cl/`, and its text.
pub type SourceFile<'a> = (&'a str, &'a str);

macro_rules! embed {
    ($($name:expr),* $(,)?) => {
        &[$(($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/cl/", $name)))),*]
    };
}
pub(crate) use embed;

/// What all engines share: arithmetic, rays, and the film.
pub const SHARED: &[SourceFile<'static>] = embed!(
    "check_size.h",
    "lanes.h",
    "block.h",
    "fine.h",
    "roots.h",
    "elementary.h",
    "random.h",
    "view.h",
    "film.h",
    "depth.cl",
    "add.cl",
);

/// The files that a program may include, and what its templates are made for.
#[derive(Debug, Clone, Default)]
pub struct Sources<'a> {
    /// Every file that there is.
    pub files: Vec<SourceFile<'a>>,
    /// A file with `#pragma each_kind` comes once for each of these, with `KIND` defined as its name.
    pub kinds: Vec<&'a str>,
}

impl Sources<'_> {
    /// Gives the text of a file of `cl/`, every `#include "..."` replaced by the file. A file with `#pragma once` comes
    /// once. `#line` marks keep the compiler's messages at `cl/FILE:LINE`.
    pub fn resolve(&self, name: &str) -> String {
        let mut text = String::new();
        self.append(name, &mut HashSet::new(), &mut text);
        text
    }

    /// Gives the resolved text of a source that is not in `cl/` but includes files from there.
    pub fn resolve_text(&self, name: &str, source: &str) -> String {
        let mut text = String::new();
        self.expand(name, source, &mut HashSet::new(), &mut text);
        text
    }

    fn append(&self, name: &str, seen: &mut HashSet<String>, text: &mut String) {
        match self.files.iter().find(|(file, _)| *file == name) {
            Some((_, source)) => self.expand(&format!("cl/{name}"), source, seen, text),
            None => text.push_str(&format!("#error \"no file cl/{name}\"\n")),
        }
    }

    fn expand(&self, name: &str, source: &str, seen: &mut HashSet<String>, text: &mut String) {
        let has_pragma = |pragma: &str| source.lines().any(|line| line.trim() == pragma);
        let is_new = seen.insert(name.to_owned());
        if !is_new && has_pragma("#pragma once") {
            return;
        }
        match has_pragma("#pragma each_kind") {
            false => self.expand_lines(name, source, seen, text),
            true => {
                for kind in &self.kinds {
                    text.push_str(&format!("#define KIND {kind}\n"));
                    self.expand_lines(name, source, seen, text);
                    text.push_str("#undef KIND\n");
                }
            }
        }
    }

    fn expand_lines(
        &self,
        name: &str,
        source: &str,
        seen: &mut HashSet<String>,
        text: &mut String,
    ) {
        text.push_str(&format!("#line 1 \"{name}\"\n"));
        for (index, line) in source.lines().enumerate() {
            if let Some(included) = included_file(line) {
                self.append(&relative_to(name, included), seen, text);
                text.push_str(&format!("#line {} \"{name}\"\n", index + 2));
            } else if ["#pragma once", "#pragma each_kind"].contains(&line.trim()) {
                text.push('\n');
            } else {
                text.push_str(line);
                text.push('\n');
            }
        }
    }
}

fn included_file(line: &str) -> Option<&str> {
    let name = line.trim().strip_prefix("#include")?.trim();
    let name = name.strip_prefix('"')?;
    name.split_once('"').map(|(name, _)| name)
}

/// Returns the path from `cl/` of a file that is included by `cl/...` (or by a text outside, then from `cl/` itself).
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

/// Returns the names of a kernel's parameters in a resolved text. `KINDS(SOURCE_PARAMETER)` stands for a list of each
/// kind that the text defines in `KINDS`, a macro that ends in `_PARAMETERS` for those that it names, `FILM_PARAMETER`
/// for the film's buffer and its image where there is one.
pub(super) fn parameters(text: &str, kernel: &str, has_image: bool) -> Vec<String> {
    let head = format!("{kernel}(");
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    // The kernel's own name, not the end of another's.
    let begins = |at: &usize| !text[..*at].ends_with(is_word);
    let after_kernel = |at: &usize| {
        let before = &text[..*at];
        let last = before.rfind("__kernel");
        last.is_some_and(|kernel| !before[kernel..].contains([';', '{', '}']))
    };
    let found = text.match_indices(&head).map(|(at, _)| at);
    let Some(at) = found.filter(begins).find(after_kernel) else {
        return Vec::new();
    };
    let from = at + head.len();
    let Some(to) = text[from..].find(") {").map(|length| from + length) else {
        return Vec::new();
    };
    let mut names = Vec::new();
    for declaration in text[from..to].split(',') {
        let mut rest = declaration;
        if let Some((_, after)) = rest.split_once("KINDS(SOURCE_PARAMETER)") {
            names.extend(
                kinds_of(text)
                    .into_iter()
                    .map(|kind| format!("{kind}_list")),
            );
            rest = after;
        }
        let last = rest.rsplit(|c| !is_word(c)).find(|word| !word.is_empty());
        match last {
            Some("FILM_PARAMETER") => {
                let film = ["pixels", "image"]
                    .into_iter()
                    .take(1 + usize::from(has_image));
                names.extend(film.map(str::to_owned));
            }
            Some(name) if name.ends_with("_PARAMETERS") => names.extend(defined(text, name)),
            _ => names.extend(last.map(str::to_owned)),
        }
    }
    names
}

/// Returns the names of the parameters that a text defines as a macro, which may go on over lines.
fn defined(text: &str, name: &str) -> Vec<String> {
    let head = format!("#define {name}");
    let begin = text.find(&head).map(|at| at + head.len());
    let mut parts = String::new();
    for line in begin.into_iter().flat_map(|begin| text[begin..].lines()) {
        let more = line.trim_end().strip_suffix('\\');
        parts.push_str(more.unwrap_or(line));
        if more.is_none() {
            break;
        }
    }
    let last = |part: &str| {
        part.rsplit([' ', '*'])
            .find(|word| !word.is_empty())
            .map(str::to_owned)
    };
    parts.split(',').filter_map(last).collect()
}

/// Returns the kinds of `#define KINDS(X) X(sphere, Sphere, 0) ...`.
fn kinds_of(text: &str) -> Vec<&str> {
    let line = text
        .lines()
        .find(|line| line.starts_with("#define KINDS(X)"));
    let rows = line.unwrap_or("").split(" X(").skip(1);
    rows.filter_map(|row| row.split(',').next()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sources() -> Sources<'static> {
        Sources {
            files: vec![
                ("a.h", "#pragma once\nA\n"),
                ("x/b.h", "#include \"../a.h\" // why\nB\n"),
                ("x/each.h", "#pragma each_kind\nmade_for(KIND)\n"),
                (
                    "main.cl",
                    "#include \"a.h\"\n#include \"x/b.h\"\n#include \"x/each.h\"\nend\n",
                ),
            ],
            kinds: vec!["sphere", "torus"],
        }
    }

    #[test]
    fn includes_are_resolved_once_templates_for_each_kind_and_lines_keep_their_place() {
        let text = sources().resolve("main.cl");
        assert!(
            !text.contains("#include") && !text.contains("#error"),
            "{text}"
        );
        assert_eq!(text.matches("\nA\n").count(), 1, "{text}");
        assert_eq!(text.matches("made_for").count(), 2, "{text}");
        assert!(text.contains("#define KIND torus\n#line 1 \"cl/x/each.h\"\n\nmade_for"));
        assert!(
            text.ends_with("#undef KIND\n#line 4 \"cl/main.cl\"\nend\n"),
            "{text}"
        );
        let missing = sources().resolve_text("mine.cl", "#include \"none.h\"\n");
        assert!(
            missing.contains("#error \"no file cl/none.h\""),
            "{missing}"
        );
    }

    #[test]
    fn a_kernels_parameters_are_found_by_name() {
        let text = "#define KINDS(X) X(sphere, Sphere, 0) X(torus, Torus, 3)\n\
                    void not_draw(int a) { draw(1); }\n\
                    __kernel __attribute__((reqd_work_group_size(4, 1, 1))) void\ndraw(const View view,\n  \
                    KINDS(SOURCE_PARAMETER) __global const float *const restrict depths,\n  \
                    FILM_PARAMETER, const uint last) {\n}\n";
        let names = |has_image| parameters(text, "draw", has_image);
        let all = [
            "view",
            "sphere_list",
            "torus_list",
            "depths",
            "pixels",
            "image",
            "last",
        ];
        assert_eq!(names(true), all);
        assert_eq!(names(false).len(), 6);
        assert!(parameters(text, "not_draw", true).is_empty());
        let text = "#define A_PARAMETERS  \\\n    __global const Box *const restrict boxes, \\\n  const uint size\n\
                    #define OTHER 1\n__kernel void draw(A_PARAMETERS, const uint last) {\n}\n";
        assert_eq!(parameters(text, "draw", false), ["boxes", "size", "last"]);
        assert!(parameters(text, "missing", true).is_empty());
    }
}
