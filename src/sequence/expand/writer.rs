//! Writes the expanded text together with its source map.

use super::source_map::{MAX_SHOWN, NO_USE, Piece, Use, UseKind, notes};
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::ops::Range;

/// Maximum size of an expanded text in bytes: that of a file.
pub const LARGEST: usize = 64 << 20;

/// Maximum size of a source map in bytes.
const LARGEST_MAP: usize = 1 << 30;

/// Uses within a value that are kept where it is inserted. Messages about larger values do not name all uses.
const MOST_MOVED: usize = 1000;

/// What an expansion reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The size of the text, or that of all values.
    Text,
    /// The size of the source map.
    Map,
}

impl Limit {
    pub fn message(self) -> String {
        match self {
            Self::Text => format!("the sequence expands to more than {} MiB", LARGEST >> 20),
            Self::Map => {
                format!(
                    "the sequence expands to so many parts that their places fill {} MiB",
                    LARGEST_MAP >> 20
                )
            }
        }
    }
}

/// What values hold: bytes of text, and pieces.
#[derive(Clone, Copy, Debug, Default)]
pub struct Held {
    text: usize,
    pieces: usize,
}

/// What all writers of a file share: their uses, and how much they may write together.
#[derive(Debug)]
pub struct Ledger {
    uses: RefCell<Vec<Use>>,
    /// What is in the expanded text, and what is in values.
    written: Cell<Held>,
    held: Cell<Held>,
    largest: usize,
    largest_map: usize,
    /// The limit that was reached, and the place at which it was.
    full: RefCell<Option<(Limit, Range<usize>)>>,
}

impl Default for Ledger {
    fn default() -> Self {
        Self::limited(LARGEST, LARGEST_MAP)
    }
}

impl Ledger {
    fn limited(largest: usize, largest_map: usize) -> Self {
        Self {
            uses: RefCell::default(),
            written: Cell::default(),
            held: Cell::default(),
            largest,
            largest_map,
            full: RefCell::default(),
        }
    }

    /// Notes a use within another one. Returns its index.
    pub fn used(&self, within: u32, place: &Range<usize>, kind: UseKind) -> u32 {
        self.push(Use { within, start: place.start as u32, len: place.len() as u32, kind })
    }

    fn push(&self, used: Use) -> u32 {
        let mut uses = self.uses.borrow_mut();
        uses.push(used);
        uses.len() as u32 - 1
    }

    /// A use with those around it, all of them within another one. `known` are the copies so far.
    fn moved(&self, innermost: u32, within: u32, known: &mut HashMap<u32, u32>) -> u32 {
        if known.len() > MOST_MOVED {
            return within;
        }
        // Messages show no more of them.
        let mut chain = Vec::new();
        {
            let uses = self.uses.borrow();
            let mut next = innermost;
            while chain.len() < MAX_SHOWN
                && let Some(used) = uses.get(next as usize)
            {
                chain.push((next, *used));
                next = used.within;
            }
        }
        chain.into_iter().rev().fold(within, |within, (index, used)| {
            *known.entry(index).or_insert_with(|| self.push(Use { within, ..used }))
        })
    }

    /// Whether a limit has been reached. Nothing more is written then.
    pub fn is_full(&self) -> bool {
        self.full.borrow().is_some()
    }

    /// The limit that was reached, and the place at which it was.
    pub fn full_at(&self) -> Option<(Limit, Range<usize>)> {
        self.full.borrow().clone()
    }

    pub fn into_uses(self) -> Vec<Use> {
        self.uses.into_inner()
    }

    /// The places of a use and of those around it, with notes.
    pub fn notes(&self, used: u32) -> Vec<(Range<usize>, String)> {
        notes(&self.uses.borrow(), used)
    }

    /// What values hold now.
    pub fn held(&self) -> Held {
        self.held.get()
    }

    /// Notes that all values since then are gone.
    pub fn release(&self, then: Held) {
        self.held.set(then);
    }

    /// Whether this many more bytes and pieces may be written into the text or a value.
    fn admits(&self, is_output: bool, bytes: usize, pieces: usize, place: &Range<usize>) -> bool {
        let target = if is_output { &self.written } else { &self.held };
        let Held { text, pieces: before } = target.get();
        target.set(Held { text: text + bytes, pieces: before + pieces });
        let pieces = self.written.get().pieces + self.held.get().pieces;
        let map = pieces * size_of::<Piece>() + self.uses.borrow().len() * size_of::<Use>();
        let limit = match text + bytes > self.largest {
            true => Some(Limit::Text),
            false => (map > self.largest_map).then_some(Limit::Map),
        };
        if let Some(limit) = limit
            && !self.is_full()
        {
            self.full.replace(Some((limit, place.clone())));
        }
        limit.is_none()
    }
}

/// A text with the places of its pieces.
#[derive(Debug, Default)]
pub struct Fragment {
    pub text: String,
    pub pieces: Vec<Piece>,
    /// Whether a part is missing, because of a fault that has been reported.
    pub is_faulty: bool,
    /// Whether it is the expanded text itself, not a value.
    pub is_output: bool,
}

impl Fragment {
    /// Appends a copy of a source's text, which begins at byte `from` of all sources.
    pub fn copy(&mut self, ledger: &Ledger, text: &str, from: usize, used: u32) {
        if !text.is_empty() && ledger.admits(self.is_output, text.len(), 1, &(from..from + text.len())) {
            self.push(Piece { start: 0, from: from as u32, len: 0, used }, text);
        }
    }

    /// Appends a text that was made from the source at `place`.
    pub fn made(&mut self, ledger: &Ledger, text: &str, place: &Range<usize>, used: u32) {
        if !text.is_empty() && ledger.admits(self.is_output, text.len(), 1, place) {
            self.push(
                Piece { start: 0, from: place.start as u32, len: place.len().max(1) as u32, used },
                text,
            );
        }
    }

    /// Appends a part of another text. Its pieces are used at `place`, within `used`.
    pub fn insert(
        &mut self,
        ledger: &Ledger,
        other: &Fragment,
        part: Range<usize>,
        place: &Range<usize>,
        used: u32,
    ) {
        self.is_faulty |= other.is_faulty;
        let text = other.text.get(part.clone()).unwrap_or_default();
        let begun = other.pieces.partition_point(|piece| piece.start as usize <= part.start);
        let end = other.pieces.partition_point(|piece| (piece.start as usize) < part.end);
        let pieces = other.pieces.get(begun.saturating_sub(1)..end).unwrap_or_default();
        if text.is_empty() || !ledger.admits(self.is_output, text.len(), pieces.len(), place) {
            return;
        }
        let base = self.text.len() as u32;
        self.text.push_str(text);
        let here = ledger.used(used, place, UseKind::Value);
        let (mut known, mut last) = (HashMap::new(), (NO_USE, here));
        for piece in pieces {
            if piece.used != last.0 {
                last = (piece.used, ledger.moved(piece.used, here, &mut known));
            }
            let skipped = (part.start as u32).saturating_sub(piece.start);
            // Only copies have places for each of their bytes.
            let from = if piece.len == 0 { piece.from + skipped } else { piece.from };
            let start = base + (piece.start + skipped - part.start as u32);
            self.pieces.push(Piece { start, from, used: last.1, ..*piece });
        }
    }

    fn push(&mut self, piece: Piece, text: &str) {
        self.pieces.push(Piece { start: self.text.len() as u32, ..piece });
        self.text.push_str(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_pieces_have_limits_of_their_own() {
        let piece = size_of::<Piece>();
        let output = || Fragment { is_output: true, ..Fragment::default() };
        let ledger = Ledger::limited(8, 4 * piece);
        let mut out = output();
        // The text of values does not count.
        Fragment::default().copy(&ledger, "1234567", 0, NO_USE);
        out.copy(&ledger, "12345678", 0, NO_USE);
        assert_eq!((out.text.as_str(), ledger.full_at()), ("12345678", None));
        out.copy(&ledger, "9", 20, NO_USE);
        assert_eq!((out.text.len(), ledger.full_at()), (8, Some((Limit::Text, 20..21))));
        let (ledger, mut out) = (Ledger::limited(8, 4 * piece), output());
        (0..5).for_each(|at| out.copy(&ledger, "1", at, NO_USE));
        assert_eq!((out.text.len(), ledger.full_at()), (4, Some((Limit::Map, 4..5))));
        // Values that are gone do not count.
        let ledger = Ledger::limited(8, 4 * piece);
        for _ in 0..10 {
            let held = ledger.held();
            Fragment::default().copy(&ledger, "1234567", 0, NO_USE);
            ledger.release(held);
        }
        assert!(!ledger.is_full());
    }

    #[test]
    fn parts_keep_their_places_and_uses() {
        let (ledger, mut value, mut outer, mut out) =
            (Ledger::default(), Fragment::default(), Fragment::default(), Fragment::default());
        value.copy(&ledger, "(abc", 100, NO_USE);
        value.made(&ledger, "12", &(200..205), NO_USE);
        value.copy(&ledger, "d)", 104, NO_USE);
        outer.insert(&ledger, &value, 0..value.text.len(), &(300..301), NO_USE);
        let copy = ledger.used(NO_USE, &(500..501), UseKind::Template);
        out.insert(&ledger, &outer, 2..7, &(400..401), copy);
        assert_eq!(out.text, "bc12d");
        let places: Vec<_> = out.pieces.iter().map(|piece| (piece.start, piece.from, piece.len)).collect();
        assert_eq!(places, [(0, 102, 0), (2, 200, 5), (4, 104, 0)]);
        // From the inside out: where the value was used first, and the template last.
        let notes: Vec<_> =
            ledger.notes(out.pieces[0].used).into_iter().map(|(place, _)| place.start).collect();
        assert_eq!(notes, [300, 400, 500]);
    }
}
