//! What was meant by something that is no number, and how to write it.

/// Returns how a number is written that `raw` seems to mean, such as 0.5 for `.5`, `0,5` or `0.5f`; `None` where no
/// number can be seen in it.
pub(super) fn meant(raw: &str, is_whole: bool) -> Option<String> {
    let raw = raw.trim().replace('−', "-").replace('_', "");
    let digits_at = raw.find(|c: char| c.is_ascii_digit())?;
    let (before, rest) = raw.split_at(digits_at);
    if !before.chars().all(|c| "+-.,".contains(c)) {
        return None;
    }
    let sign = if before.contains('-') { "-" } else { "" };
    let point = if before.ends_with(['.', ',']) {
        "0."
    } else {
        ""
    };
    let mut text = format!("{sign}{point}{rest}");
    if text.matches(',').count() == 1 && !text.contains('.') {
        text = text.replace(',', ".");
    }
    let value = hexadecimal(rest).filter(|_| point.is_empty());
    let value = value.map(|value| if sign == "-" { -value } else { value });
    let value = value
        .or_else(|| text.parse().ok())
        .or_else(|| fraction(&text))
        .or_else(|| text.trim_end_matches(is_unit).parse().ok())
        .filter(|_| {
            !["0x", "0o", "0b"]
                .iter()
                .any(|it| rest.len() == 2 && rest == *it)
        })?;
    match is_whole {
        _ if !f64::is_finite(value) => None,
        true if value.fract() == 0.0 && value.abs() < 1e15 => Some(format!("{value:.0}")),
        _ => Some(format!("{value:?}")),
    }
}

/// Returns whether the last part of a key is a whole number's.
pub(super) fn is_whole(key: &str) -> bool {
    ["width", "height", "divisions", "count", "bits", "quality"]
        .contains(&key.rsplit('.').next().unwrap_or(key))
}

/// Returns what stands for a number at this place of a text: letters, digits, signs and points without a gap; or the
/// whole of a number with a comma for its point, where no list can be meant.
pub(super) fn around(text: &str, place: usize, may_have_comma: bool) -> &str {
    let is_part =
        |c: char| c.is_alphanumeric() || "+-._−°%/".contains(c) || (may_have_comma && c == ',');
    let mut place = place.min(text.len());
    while !text.is_char_boundary(place) {
        place -= 1;
    }
    let before = text[..place].trim_end_matches(is_part).len();
    let after = &text[place..];
    let end = place + after.len() - after.trim_start_matches(is_part).len();
    &text[before..end]
}

/// Letters and signs that others put behind numbers.
fn is_unit(c: char) -> bool {
    c.is_alphabetic() || "°+-.".contains(c)
}

fn hexadecimal(text: &str) -> Option<f64> {
    let digits = text
        .strip_prefix("0x")
        .or_else(|| text.strip_prefix("0X"))?;
    u32::from_str_radix(digits, 16).ok().map(f64::from)
}

fn fraction(text: &str) -> Option<f64> {
    let (above, below) = text.split_once('/')?;
    let (above, below): (f64, f64) = (above.parse().ok()?, below.parse().ok()?);
    Some(above / below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_meant_is_written_as_a_number() {
        for (raw, expected) in [
            (".5", Some("0.5")),
            ("-.5", Some("-0.5")),
            ("5.", Some("5.0")),
            ("1.e5", Some("100000.0")),
            (".5e3", Some("500.0")),
            ("0,5", Some("0.5")),
            (",5", Some("0.5")),
            ("1,5", Some("1.5")),
            ("1e", Some("1.0")),
            ("1e+", Some("1.0")),
            ("+-1", Some("-1.0")),
            ("--1", Some("-1.0")),
            ("−1", Some("-1.0")),
            ("007", Some("7.0")),
            ("1__0", Some("10.0")),
            ("0.5f", Some("0.5")),
            ("45°", Some("45.0")),
            ("45deg", Some("45.0")),
            ("1/2", Some("0.5")),
            ("0X10", Some("16.0")),
            ("0x", None),
            ("100000000000000000000", Some("1e20")),
            ("1,000,5", None),
            ("aces", None),
            ("x5", None),
            ("", None),
            ("1.2.3", None),
            ("1/0", None),
            ("NaN", None),
        ] {
            assert_eq!(meant(raw, false).as_deref(), expected, "{raw}");
        }
        assert_eq!(meant("5.", true).as_deref(), Some("5"));
        assert!(is_whole("image.width") && is_whole("width") && !is_whole("camera.near"));
    }

    #[test]
    fn a_number_ends_where_no_sign_of_it_stands() {
        assert_eq!(around("[.5, 0, 5.]", 1, false), ".5");
        assert_eq!(around("[.5, 0, 5.]", 10, false), "5.");
        assert_eq!(around("x: 1,5}", 5, true), "1,5");
        assert_eq!(around("x: 1,5}", 5, false), "5");
        assert_eq!(around("", 7, false), "");
    }
}
