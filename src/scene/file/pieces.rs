//! A TOML text in pieces that are read one after another: whole, it takes fifty times its size while it is read. The
//! first piece is the text without most of its sources and groups, each of the others a run of `[[KIND]]` and
//! `[[group]]` tables.

use std::borrow::Cow;

use super::scan::{Headers, UNIT_COUNT, UNITS};

/// A text of at most this many bytes is one piece, and so is the least run of tables that is cut off.
pub(super) const WHOLE: usize = 1 << 20;
pub(super) const RUN: usize = 1 << 16;

/// A part of a text, which is TOML itself.
#[derive(Debug)]
pub(super) struct Piece<'a> {
    pub text: Cow<'a, str>,
    /// Where its parts begin: in the piece, and in the whole text.
    parts: Vec<(usize, usize)>,
    /// How many sources of each kind, and groups, stand before its own.
    pub before: [usize; UNIT_COUNT],
}

impl<'a> Piece<'a> {
    fn whole(text: &'a str) -> Self {
        Self {
            text: Cow::Borrowed(text),
            parts: vec![(0, 0)],
            before: [0; UNIT_COUNT],
        }
    }

    /// Returns where a place in the piece is in the whole text.
    pub(super) fn place(&self, inside: usize) -> usize {
        let part = self.parts.iter().rfind(|(begin, _)| *begin <= inside);
        part.map_or(inside, |(begin, whole)| whole + (inside - begin))
    }

    /// Turns a key of the piece, such as `torus[3].axis`, into that of the whole text.
    pub(super) fn key(&self, inside: &str) -> String {
        match source_key(inside) {
            Some((kind, index, rest)) => {
                format!("{}[{}]{rest}", UNITS[kind], index + self.before[kind])
            }
            None => inside.to_owned(),
        }
    }
}

/// Takes the key of a source or a group apart: the place of its kind, its index, and the rest.
pub(super) fn source_key(key: &str) -> Option<(usize, usize, &str)> {
    let (kind, rest) = key.split_once('[')?;
    let (index, rest) = rest.split_once(']')?;
    let kind = UNITS.iter().position(|it| *it == kind)?;
    Some((kind, index.parse().ok()?, rest))
}

/// A text in pieces.
#[derive(Debug)]
pub(super) struct Pieces<'a> {
    pub list: Vec<Piece<'a>>,
    /// How many tables of each kind, and groups, there are; 0 in a text that is one piece.
    pub counts: [usize; UNIT_COUNT],
    /// The kinds all of whose tables stand in the first piece.
    is_whole: [bool; UNIT_COUNT],
}

impl<'a> Pieces<'a> {
    /// Cuts a text longer than `whole` bytes; runs of tables have at least `run` bytes.
    pub(super) fn of(text: &'a str, whole: usize, run: usize) -> Self {
        if text.len() <= whole {
            return Self {
                list: vec![Piece::whole(text)],
                counts: [0; UNIT_COUNT],
                is_whole: [true; UNIT_COUNT],
            };
        }
        let Headers {
            list,
            is_named_otherwise,
        } = Headers::of(text);
        let mut first = Piece {
            text: Cow::Owned(String::new()),
            parts: Vec::new(),
            before: [0; UNIT_COUNT],
        };
        let mut runs: Vec<Piece<'a>> = Vec::new();
        let mut counts = [0; UNIT_COUNT];
        let mut open: Option<(usize, [usize; UNIT_COUNT])> = None;
        let mut close = |open: &mut Option<(usize, [usize; UNIT_COUNT])>, end: usize| {
            runs.extend(open.take().map(|(begin, before)| Piece {
                text: Cow::Borrowed(&text[begin..end]),
                parts: vec![(0, begin)],
                before,
            }));
        };
        // What stands before the first header, then every table.
        let begins = list.iter().map(|header| (header.at, header.kind));
        let begins = std::iter::once((0, None)).chain(begins);
        let ends = list.iter().map(|header| header.at).chain([text.len()]);
        for ((begin, kind), end) in begins.zip(ends) {
            let stays = match kind {
                // The first of each kind stays, so that one that is also named in another way is refused.
                Some(kind) => is_named_otherwise[kind] || counts[kind] == 0,
                None => true,
            };
            if stays {
                close(&mut open, begin);
                first.parts.push((first.text.len(), begin));
                first.text.to_mut().push_str(&text[begin..end]);
            } else {
                let (run_begin, _) = *open.get_or_insert((begin, counts));
                if end - run_begin >= run {
                    close(&mut open, end);
                }
            }
            if let Some(kind) = kind {
                counts[kind] += 1;
            }
        }
        close(&mut open, text.len());
        runs.insert(0, first);
        Self {
            list: runs,
            counts,
            is_whole: is_named_otherwise,
        }
    }

    /// Returns the piece in which a key of the text stands, and the key there.
    pub(super) fn piece_of(&self, key: &str) -> (&Piece<'a>, String) {
        let first = &self.list[0];
        let Some((kind, index, rest)) = source_key(key) else {
            return (first, key.to_owned());
        };
        if self.is_whole[kind] || index == 0 {
            return (first, key.to_owned());
        }
        let runs = self.list[1..].iter();
        let piece = runs.rev().find(|piece| piece.before[kind] <= index);
        let piece = piece.unwrap_or(first);
        let inside = index.saturating_sub(piece.before[kind]);
        (piece, format!("{}[{inside}]{rest}", UNITS[kind]))
    }
}
