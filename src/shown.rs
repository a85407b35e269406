//! Text of others in our messages: keys and values of files, what was typed, words of drivers. It never reaches a
//! terminal raw, and never at any length.

use std::path::Path;

/// Characters of a name or a value that a message repeats, and of a whole message of one line.
const LONGEST: usize = 80;
const LONGEST_LINE: usize = 600;

/// Returns a text of others as our messages repeat it: on one line, with control characters and those that turn the
/// direction of writing as `\u{1b}`, and of a long one 80 characters, `…` for its middle.
///
/// ```
/// assert_eq!(energywave::shown("\u{1b}[31mred\n"), r"\u{1b}[31mred\n");
/// assert_eq!(energywave::shown(&"x".repeat(100_000)).chars().count(), 80);
/// ```
#[must_use]
pub fn shown(text: &str) -> String {
    cut(text, LONGEST)
}

/// Returns what a program prints of a text of several lines of our own: control characters but line breaks and tabs are
/// escaped, as [`shown()`] does.
#[must_use]
pub fn shown_lines(text: &str) -> String {
    let escape = |c: char| match c {
        '\n' | '\t' => c.to_string(),
        c => escaped(c),
    };
    text.chars().map(escape).collect()
}

/// Shows a path.
pub(crate) fn shown_path(path: &Path) -> String {
    shown(&path.to_string_lossy())
}

/// Shows a message that has one line: longer than a name may be.
pub(crate) fn shown_line(text: &str) -> String {
    cut(text, LONGEST_LINE)
}

/// Escapes a text and cuts its middle out where it has more than `longest` characters.
fn cut(text: &str, longest: usize) -> String {
    let mut whole = String::new();
    let mut length = 0;
    for c in text.chars() {
        let piece = escaped(c);
        length += piece.chars().count();
        if length > longest {
            let back = (longest - 1) / 2;
            let front = pieces(text.chars(), longest - 1 - back);
            let mut back = pieces(text.chars().rev(), back);
            back.reverse();
            return front.concat() + "…" + &back.concat();
        }
        whole += &piece;
    }
    whole
}

/// Returns as many characters, escaped, as have this length together.
fn pieces(text: impl Iterator<Item = char>, longest: usize) -> Vec<String> {
    let mut left = longest;
    text.map(escaped)
        .take_while(|piece| {
            let length = piece.chars().count();
            let fits = length <= left;
            left = left.saturating_sub(length);
            fits
        })
        .collect()
}

fn escaped(c: char) -> String {
    match c {
        '\n' | '\r' | '\t' => c.escape_default().to_string(),
        c if c.is_control() || is_unseen(c) => c.escape_unicode().to_string(),
        c => c.to_string(),
    }
}

/// Returns whether a character shows nothing itself, but may change how its neighbours look: soft hyphens, marks and
/// overrides of direction, separators of lines, joiners, tags.
fn is_unseen(c: char) -> bool {
    matches!(c,
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
        | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moves_a_terminals_cursor_or_turns_writing_is_escaped() {
        for (raw, expected) in [
            ("\u{1b}[31mred", r"\u{1b}[31mred"),
            ("a\nb\r\tc", r"a\nb\r\tc"),
            ("\u{7f}\u{9b}2J", r"\u{7f}\u{9b}2J"),
            ("\u{202e}gpj.exe", r"\u{202e}gpj.exe"),
            (
                "zero\u{200b}width\u{2028}\u{feff}",
                r"zero\u{200b}width\u{2028}\u{feff}",
            ),
            ("Größe 大小 \"x\" \\", "Größe 大小 \"x\" \\"),
        ] {
            assert_eq!(shown(raw), expected);
            assert_eq!(shown_line(raw), expected);
        }
        assert_eq!(shown_lines("a\n\tb\u{1b}c"), "a\n\tb\\u{1b}c");
    }

    #[test]
    fn long_texts_lose_their_middle_and_short_ones_nothing() {
        let short = "k".repeat(80);
        assert_eq!(shown(&short), short);
        let long = format!("begin{}end", "x".repeat(100_000));
        let found = shown(&long);
        assert_eq!(found.chars().count(), 80);
        assert!(found.starts_with("begin") && found.ends_with("end") && found.contains('…'));
        // Escapes count as what they are shown as, and are never cut in two.
        let found = shown(&"\u{1b}".repeat(1000));
        assert!(found.chars().count() <= 80, "{found}");
        assert_eq!(found.matches(r"\u{1b}").count(), 12);
        assert_eq!(shown_line(&long).chars().count(), 600);
    }
}
