//! Scenes as TOML. Faults have line, column and key.

use std::ops::Range;

use serde::de::DeserializeOwned;

use super::locate::{KeyMap, line_and_column};
use super::moving::Moving;
use super::numbers::around;
use super::pieces::{Piece, Pieces, RUN, WHOLE};
use super::scan::{key_at, value_at};
use super::tracks::{self, find, may_have_tracks};
use super::tree::{Moment, Node};
use super::words::{Language, name_missing, no_value, plain};
use super::{SceneFile, SourceTables, TRACKS_FACTOR, check_memory, empty_file};
use crate::error::{Result, SceneError};
use crate::scene::values::unnamed;

/// Bytes that reading takes for each byte of a text in pieces, and of a large piece: a list of short numbers.
const MEMORY_FACTOR: u64 = 4;
const PIECE_FACTOR: u64 = 96;

/// Reads a scene, and what of it changes.
pub(super) fn read(text: &str) -> Result<(SceneFile, Moving)> {
    if text.trim().is_empty() {
        return Err(empty_file().into());
    }
    let tracks = if may_have_tracks(text) {
        TRACKS_FACTOR
    } else {
        0
    };
    check_memory("the scene", text.len(), MEMORY_FACTOR + tracks)?;
    read_pieces(text, &Pieces::of(text, WHOLE, RUN))
}

/// Reads the pieces one after another. Of several faults it gives the first.
fn read_pieces(text: &str, pieces: &Pieces<'_>) -> Result<(SceneFile, Moving)> {
    let mut first: Option<SceneFile> = None;
    let mut moving = Moving::default();
    let mut fault: Option<(usize, SceneError)> = None;
    for (index, piece) in pieces.list.iter().enumerate() {
        check_piece(&piece.text)?;
        let found = match index {
            0 => read_piece(text, piece, None, &mut moving).map(|file| first = Some(file)),
            _ => {
                let period = first.as_ref().map(SceneFile::period);
                read_piece(text, piece, period, &mut moving).map(|run: SourceTables| {
                    if let Some(file) = &mut first {
                        file.reserve(pieces.counts);
                        file.add(run);
                    }
                })
            }
        };
        if let Err((place, found)) = found {
            if fault.as_ref().is_none_or(|(before, _)| place < *before) {
                fault = Some((place, found));
            }
            if index > 0 {
                break; // later ones stand behind it
            }
        }
    }
    match (fault, first) {
        (None, Some(file)) => Ok((file, moving)),
        (Some((_, fault)), _) => Err(fault.into()),
        (None, None) => Err(empty_file().into()),
    }
}

/// Reads a piece as it is at 0 s, and takes what has tracks; `period` is that of the first piece, if it is another one.
fn read_piece<T: DeserializeOwned>(
    text: &str,
    piece: &Piece<'_>,
    period: Option<Option<f64>>,
    moving: &mut Moving,
) -> std::result::Result<T, (usize, SceneError)> {
    if may_have_tracks(&piece.text)
        && let Ok(mut document) = toml::from_str::<Node>(&piece.text)
    {
        let placed = |mut fault: SceneError| {
            let place = piece.place(offset_in(&piece.text, &fault));
            fault.key = piece.key(&fault.key);
            fault.position = Some(line_and_column(text, place));
            (place, fault)
        };
        let found = find(&mut document, Language::Toml).map_err(placed)?;
        if !found.keys.is_empty() {
            let start = period.map_or_else(|| document.start(), Moment::start);
            let file = tracks::read(&document, start, Language::Toml)
                .map_err(|(key, message)| placed(SceneError::value(key, message)))?;
            moving.take(document, found, |key| piece.key(key), &piece.before);
            return Ok(file);
        }
    }
    toml::from_str(&piece.text).map_err(|error| fault_in(text, piece, &error))
}

/// Checks that a large piece can be read in the memory that there is.
fn check_piece(piece: &str) -> Result<()> {
    let what =
        "TOML in one piece (sources in [[...]] tables one after another, and JSON, take less)";
    match piece.len() > WHOLE {
        true => check_memory(what, piece.len(), PIECE_FACTOR),
        false => Ok(()),
    }
}

/// Returns line and column of the value at fault, or of what encloses it.
pub(super) fn place_of(text: &str, fault: &SceneError) -> (usize, usize) {
    locate(text, &Pieces::of(text, WHOLE, RUN), fault)
}

fn locate(text: &str, pieces: &Pieces<'_>, fault: &SceneError) -> (usize, usize) {
    let (piece, key) = pieces.piece_of(&fault.key);
    let inside = SceneError {
        key,
        ..fault.clone()
    };
    line_and_column(text, piece.place(offset_in(&piece.text, &inside)))
}

/// Returns where in a piece the value at fault stands, or a key that there is not.
fn offset_in(piece: &str, fault: &SceneError) -> usize {
    let keys = KeyMap::new(piece);
    let offset = match fault.message.starts_with("unknown field ") {
        true => keys.name_of(&fault.key),
        false => keys.offset_of(&fault.key),
    };
    offset.unwrap_or(0)
}

/// Makes the fault of syntax, type or key name that the TOML reader found in a piece, with its place in the text.
fn fault_in(text: &str, piece: &Piece<'_>, error: &toml::de::Error) -> (usize, SceneError) {
    let inside: &str = &piece.text;
    let span = error.span().unwrap_or(0..0);
    let keys = KeyMap::new(inside);
    let mut offset = span.start;
    let path = keys.path_at(&span).unwrap_or("").to_owned();
    let (key, message) = if let Some((key, message)) = bad_value(inside, &span, error.message()) {
        (key, message)
    } else if let Some((field, message)) = unnamed(error.message()) {
        let key = format!("{path}.{field}");
        offset = keys.offset_of(&key).unwrap_or(offset);
        (key, message.to_owned())
    } else {
        let is_named = !path.is_empty();
        let (key, words) = plain(Language::Toml, path, error.message());
        let (key, mut message) = name_missing(key, words);
        if let (Some(quoted), false) = (inside.get(span), is_named)
            && (1..40).contains(&quoted.len())
            && !quoted.contains(['\n', '`'])
        {
            message += &format!(" `{quoted}`");
        }
        (key, message)
    };
    let place = piece.place(offset);
    let fault = SceneError {
        position: Some(line_and_column(text, place)),
        ..SceneError::value(piece.key(&key), message)
    };
    (place, fault)
}

/// Returns key and message where something else stands in the place of a value, such as `.5` or a word without quotes.
fn bad_value(piece: &str, span: &Range<usize>, message: &str) -> Option<(String, String)> {
    const FAULTS: [&str; 10] = [
        "invalid mantissa",
        "invalid fraction",
        "invalid exponent",
        "invalid float",
        "redundant numeric sign",
        "unexpected leading zero",
        "may only go between digits",
        "string values must be quoted",
        "integer number overflowed",
        "unexpected key or value",
    ];
    let fault = FAULTS.iter().find(|fault| message.contains(**fault))?;
    let key = key_at(piece, span.start);
    let value = match value_at(piece, span.start) {
        Some(value) => value,
        None if *fault == "string values must be quoted" && !key.is_empty() => "",
        None => return None,
    };
    let is_list = value.starts_with(['[', '{', '"', '\'']);
    let raw = match is_list {
        true => around(piece, span.start, false),
        false => value,
    };
    // A second value on a line may be anything; only a comma for a point is known.
    if *fault == "unexpected key or value" && (is_list || !value.contains(',')) {
        return None;
    }
    let message = no_value(Language::Toml, &key, raw);
    Some((key, message))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::error::Error;
    use crate::scene::Scene;

    const HEAD: &str = "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n";

    /// Reads a text in one piece, and in as many as there can be.
    fn both_ways(text: &str) -> [std::result::Result<Scene, String>; 2] {
        [usize::MAX, 0].map(|whole| {
            let pieces = Pieces::of(text, whole, 1);
            let (file, _) = read_pieces(text, &pieces).map_err(|error| error.to_string())?;
            let read = file.into_scene(Path::new(""), &mut |_, _| Ok(()));
            read.map(|(scene, _)| scene).map_err(|error| match error {
                Error::Scene(fault) => {
                    let place = locate(text, &pieces, &fault);
                    format!("{place:?} {}", Error::Scene(fault))
                }
                other => other.to_string(),
            })
        })
    }

    #[test]
    fn a_scene_read_in_pieces_is_the_one_that_is_read_whole() {
        let spheres = "[[sphere]]\ncenter = [1, 2, 3]\n[[torus]]\nmajor_radius = 1\n".repeat(3);
        let curve = "[[curve]]\ncontrol_points = [[0,0,0],\n  [1,1,1], # [[sphere]]\n [2,0,1]]\n";
        let group = "[[group]]\n[group.repeat]\ncount = 2\nstep = [1, 0, 0]\n[[group.curve]]\n\
            control_points = [[0,0,0], [1,1,1], [2,0,1]]\n[[group.curve.layers]]\nradius = 1\n\
            [[curve]]\ncontrol_points = [[0,0,0], [1,1,1], [2,0,1]]\n[[curve.layers]]\nradius = 2\n";
        let text = format!(
            "{HEAD}{spheres}[display]\nexposure = 2\n{curve}{spheres}{group}{group}{curve}[decay]\nalpha=1\nbeta=1"
        );
        let [whole, cut] = both_ways(&text);
        let (whole, cut) = (whole.unwrap(), cut.unwrap());
        assert_eq!(whole, cut);
        assert_eq!(
            (cut.spheres.len(), cut.tori.len(), cut.curves.len()),
            (6, 6, 8)
        );
        let pieces = Pieces::of(&text, 0, 1);
        assert_eq!(pieces.list.len(), 1 + 6 + 6 + 4 + 2 - 4);
        assert_eq!(Pieces::of(&text, 0, 1 << 20).list.len(), 4);
    }

    #[test]
    fn a_fault_is_told_alike_in_whatever_piece_it_stands() {
        let good = "[[sphere]]\ncenter = [1, 2, 3]\n[[torus]]\nmajor_radius = 1\n\
            [[group]]\n[[group.torus]]\nmajor_radius = 2\n[[group]]\n";
        for fault in [
            "[[group]]\nzoom = 1\n",
            "[[group]]\n[[group.torus]]\nmajor_radius = -1\n",
            "[[group]]\n[[group.sphere]]\n[[group.sphere.layers]]\n[[group.sphere.layers]]\nradius = .5\n",
            "[[group.torus]]\nmajor_radius = -1\n",
            "[group.x]\ny = 1\n",
            "[[group.torus.layers]]\nradius = -1\n",
            "[[group]]\nscale = 0\n",
            "[[group]]\nscale = 1e8\n[[group.torus]]\nmajor_radius = 20\n",
            "[group]\nscale = 1\n",
            "[[torus]]\nmajor_radius = 1\n[torus.layers]\nradius = 1\n",
            "[[torus]]\nmajor_radius = 1\n[[sphere]]\n[[torus.layers]]\nradius = -1\n",
            "[[torus]]\nmajor_radius = 1\n[[torus.layers]]\nradius = -1\n",
            "[[sphere]]\nzoom = 1\n",
            "[[sphere]]\ncenter = [0, .5, 0]\n",
            "[[sphere]]\ncoefficient = 0,5\n",
            "[[sphere]]\ncoefficient = 1\ncoefficient = 1\n",
            "[[sphere]]\ncoefficient = 1e30\n",
            "[[torus]]\nmajor_radius = -1\n",
            "[[torus]]\naxis = [0, 0, 1]\n",
            "[[beam]]\ndirection = [0, 0, 1]\ncap_coefficient = 1\ntaper_length = 1\n",
            "[sphere]\ncoefficient = 1\n",
            "[torus.x]\ny = 1\n",
            "[[torus.x]]\ny = 1\n",
            "[camera]\nfov_y = 5\n",
            "[[camera]]\nfov_y = 5\n",
            "[\"torus\"]\n",
            "[[spheres]]\ncoefficient = 1\n",
            "[decay]\nalpha = 1\n",
            "[[torus]]\nmajor_radius = { times = [0, 0], values = [1, 2] }\n",
            "[[torus]]\nmajor_radius = { times = [0, 1], values = [-1, 2] }\n",
            "[[torus]]\nzoom = 1\nmajor_radius = { times = [0, 1], values = [1, 2] }\n",
            "[[group]]\n[[group.torus]]\nmajor_radius = { times = [0, 1], values = [1, 2], zoom = 1 }\n",
            "[[torus]]\ncoefficient = { times = [0, 1], values = [1, 2] }\n",
            "[[sphere]]\ncolor = { times = [0, 1], values = [1, 2] }\n",
            "[camera.fov_y]\ntimes = [0, 1]\n",
        ] {
            for text in [
                format!("{HEAD}{fault}{good}{good}"),
                format!("{HEAD}{good}{good}{fault}{good}{good}"),
                format!("{HEAD}{good}{good}{good}{fault}"),
            ] {
                let [whole, cut] = both_ways(&text);
                assert!(whole.is_err(), "{text}");
                assert_eq!(whole, cut, "{text}");
            }
        }
        // Two faults of one sort: the first is told.
        let [whole, cut] = both_ways(&format!(
            "{HEAD}{good}{good}[[sphere]]\na = 1\n[[torus]]\nb = 1\n"
        ));
        assert!(whole.as_ref().unwrap_err().contains("sphere[2]") && whole == cut);
    }

    #[test]
    fn a_quoted_name_of_a_table_keeps_its_kind_in_one_piece() {
        let text = format!(
            "{HEAD}[[torus]]\nmajor_radius = 1\n[[\"torus\"]]\nmajor_radius = 2\n[[torus]]\nmajor_radius = 3\n"
        );
        let [whole, cut] = both_ways(&text);
        assert_eq!(whole, cut);
        assert_eq!(cut.unwrap().tori[1].major_radius, 2.0);
    }
}
