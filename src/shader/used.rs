//! What of a text is used: its items stand between empty lines, and one that nobody names is left out.

/// What a host or a stage calls, and the block.
const ROOTS: [&str; 5] = ["wave_light", "wave_irradiance", "image", "screen", "Wave"];

struct Item<'a> {
    text: &'a str,
    /// What it declares.
    names: Vec<&'a str>,
    is_used: bool,
}

impl<'a> Item<'a> {
    fn of(text: &'a str) -> Self {
        let declared = |line: &'a str| {
            let words = ["fn ", "struct ", "const "];
            let rest = words.iter().find_map(|word| line.strip_prefix(word))?;
            rest.split(|it: char| !is_of_name(it)).next()
        };
        let names: Vec<&str> = text.lines().filter_map(declared).collect();
        let is_used = names.is_empty() || names.iter().any(|name| ROOTS.contains(name));
        Self {
            text,
            names,
            is_used,
        }
    }

    fn words(&self) -> impl Iterator<Item = &'a str> {
        let code = self
            .text
            .lines()
            .map(|line| line.split("//").next().unwrap_or_default());
        code.flat_map(|line| line.split(|it| !is_of_name(it)))
    }
}

fn is_of_name(it: char) -> bool {
    it.is_ascii_alphanumeric() || it == '_'
}

/// Returns a text without the functions, structs and constants that it does not use.
pub(super) fn used(text: &str) -> String {
    let mut items: Vec<Item<'_>> = text.trim_end().split("\n\n").map(Item::of).collect();
    loop {
        let words = items
            .iter()
            .filter(|item| item.is_used)
            .flat_map(Item::words);
        let words: std::collections::BTreeSet<&str> = words.collect();
        let mut found = false;
        for item in items.iter_mut().filter(|item| !item.is_used) {
            item.is_used = item.names.iter().any(|name| words.contains(name));
            found |= item.is_used;
        }
        if !found {
            break;
        }
    }
    let kept = items
        .iter()
        .filter(|item| item.is_used)
        .map(|item| item.text);
    kept.collect::<Vec<_>>().join("\n\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_used_by_way_of_others_stays_and_comments_use_nothing() {
        let text = "// Head.\n\n// A.\nfn a() {\n    b();\n}\n\nfn b() {}\n\nstruct C { d: f32 }\n\n\
                    fn wave_light() {\n    a(); // and c(), C\n}\n\nfn c() { c(); }\n";
        let kept = "// Head.\n\n// A.\nfn a() {\n    b();\n}\n\nfn b() {}\n\n\
                    fn wave_light() {\n    a(); // and c(), C\n}\n";
        assert_eq!(used(text), kept);
    }
}
