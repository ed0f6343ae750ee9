//! Writes the expanded text together with its source map.

use super::source_map::{NO_USE, Piece, Use, UseKind, notes};
use std::cell::{Cell, RefCell};
use std::ops::Range;

/// Maximum size of an expanded text in bytes: that of a file.
pub const LARGEST: usize = 64 << 20;

/// What a piece of the source map counts as, in bytes.
const PIECE: usize = 4;

/// What all writers of a file share: their uses, and how much they may write together.
#[derive(Debug, Default)]
pub struct Ledger {
    uses: RefCell<Vec<Use>>,
    written: Cell<usize>,
    /// The place at which the expanded text became too large.
    full: RefCell<Option<Range<usize>>>,
}

impl Ledger {
    /// Notes a use within another one. Returns its index.
    pub fn used(&self, within: u32, place: &Range<usize>, kind: UseKind) -> u32 {
        let mut uses = self.uses.borrow_mut();
        uses.push(Use { within, start: place.start as u32, len: place.len() as u32, kind });
        uses.len() as u32 - 1
    }

    /// Whether the text has become too large. Nothing more is written then.
    pub fn is_full(&self) -> bool {
        self.full.borrow().is_some()
    }

    /// The place at which the text became too large.
    pub fn full_at(&self) -> Option<Range<usize>> {
        self.full.borrow().clone()
    }

    pub fn into_uses(self) -> Vec<Use> {
        self.uses.into_inner()
    }

    /// The places of a use and of those around it, with notes.
    pub fn notes(&self, used: u32) -> Vec<(Range<usize>, String)> {
        notes(&self.uses.borrow(), used)
    }

    /// Whether this many more bytes may be written.
    fn admits(&self, bytes: usize, place: &Range<usize>) -> bool {
        let written = self.written.get() + bytes + PIECE;
        self.written.set(written);
        if written > LARGEST && !self.is_full() {
            self.full.replace(Some(place.clone()));
        }
        written <= LARGEST
    }
}

/// A text with the places of its pieces.
#[derive(Debug, Default)]
pub struct Fragment {
    pub text: String,
    pub pieces: Vec<Piece>,
}

impl Fragment {
    /// Appends a copy of a source's text, which begins at byte `from` of all sources.
    pub fn copy(&mut self, ledger: &Ledger, text: &str, from: usize, used: u32) {
        if !text.is_empty() && ledger.admits(text.len(), &(from..from + text.len())) {
            self.push(Piece { start: 0, from: from as u32, len: 0, used }, text);
        }
    }

    /// Appends a text that was made from the source at `place`.
    pub fn made(&mut self, ledger: &Ledger, text: &str, place: &Range<usize>, used: u32) {
        if !text.is_empty() && ledger.admits(text.len(), place) {
            self.push(
                Piece { start: 0, from: place.start as u32, len: place.len().max(1) as u32, used },
                text,
            );
        }
    }

    /// Appends another text. Its pieces are used at `place`.
    pub fn insert(&mut self, ledger: &Ledger, other: &Fragment, place: &Range<usize>, used: u32) {
        let base = self.text.len() as u32;
        if !ledger.admits(other.text.len() + PIECE * other.pieces.len(), place) {
            return;
        }
        self.text.push_str(&other.text);
        let mut last = None;
        for piece in &other.pieces {
            let within = if piece.used == NO_USE { used } else { piece.used };
            let use_here = match last {
                Some((known, index)) if known == within => index,
                _ => ledger.used(within, place, UseKind::Value),
            };
            last = Some((within, use_here));
            self.pieces.push(Piece { start: base + piece.start, used: use_here, ..*piece });
        }
    }

    fn push(&mut self, piece: Piece, text: &str) {
        self.pieces.push(Piece { start: self.text.len() as u32, ..piece });
        self.text.push_str(text);
    }
}
