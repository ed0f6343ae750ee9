//! Where each piece of an expanded text was written.
//!
//! Faults of decoders have places in the expanded text. The source map turns them into places in the files.

use std::ops::Range;

/// A piece of an expanded text. It reaches to the next piece.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Its first byte in the expanded text.
    pub start: u32,
    /// The byte of all sources from which it comes.
    pub from: u32,
    /// Bytes of the source if something was computed from them. 0 if the piece is a copy.
    pub len: u32,
    /// Index into the list of uses.
    pub used: u32,
}

/// Why a part of a source is in the expanded text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UseKind {
    Value,
    Template,
    Include,
    /// The numbers of a copy. Only the first `dimensions` count.
    Copy {
        indices: [u32; 3],
        dimensions: u8,
    },
}

/// A use of a part of a source, within another use.
#[derive(Clone, Copy, Debug)]
pub struct Use {
    /// The index of the enclosing use; [`NO_USE`] if there is none.
    pub within: u32,
    /// The place of the use: its first byte in all sources, and its length.
    pub start: u32,
    pub len: u32,
    pub kind: UseKind,
}

/// The index of no use.
pub const NO_USE: u32 = u32::MAX;

/// Maximum number of uses in a message.
pub const MAX_SHOWN: usize = 6;

/// Connects an expanded text with its sources.
#[derive(Debug, Default)]
pub struct SourceMap {
    /// In the order of the expanded text. The first one starts at 0, unless there are none.
    pub pieces: Vec<Piece>,
    pub uses: Vec<Use>,
}

/// A place in the sources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    pub span: Range<usize>,
    /// Whether the text there is an expression.
    pub is_computed: bool,
    used: u32,
}

impl SourceMap {
    /// The place of a span of the expanded text.
    pub fn place(&self, span: &Range<usize>) -> Place {
        place(&self.pieces, span)
    }

    /// The uses around a place, each with a note about it, from the inside out.
    pub fn uses_of(&self, place: &Place) -> Vec<(Range<usize>, String)> {
        notes(&self.uses, place.used)
    }
}

/// The place of a span of a text with these pieces.
pub fn place(pieces: &[Piece], span: &Range<usize>) -> Place {
    let Some((first, end)) = piece_at(pieces, span.start) else {
        return Place { span: 0..0, is_computed: false, used: NO_USE };
    };
    let (from, len, used) = (first.from as usize, first.len as usize, first.used);
    if len > 0 {
        return Place { span: from..from + len, is_computed: true, used };
    }
    let start = from + (span.start - first.start as usize);
    let clipped = start..start + span.len().min(end - span.start);
    let place = |span| Place { span, is_computed: false, used };
    if span.end <= end {
        return place(clipped);
    }
    // Values with expressions inside reach over several pieces.
    let last = piece_at(pieces, span.end - 1).filter(|(last, _)| last.used == used);
    let end = last.map(|(last, _)| match last.len {
        0 => last.from as usize + (span.end - last.start as usize),
        len => (last.from + len) as usize,
    });
    place(
        end.filter(|end| *end > clipped.end && *end - start <= span.len() + (1 << 16))
            .map_or(clipped, |end| start..end),
    )
}

/// The piece around a byte of the text, and its end there.
fn piece_at(pieces: &[Piece], byte: usize) -> Option<(Piece, usize)> {
    let next = pieces.partition_point(|piece| piece.start as usize <= byte);
    let piece = *pieces.get(next.checked_sub(1)?)?;
    let end = pieces.get(next).map_or(usize::MAX, |piece| piece.start as usize);
    Some((piece, end))
}

/// The places of a use and of those around it, with notes, from the inside out.
pub fn notes(uses: &[Use], innermost: u32) -> Vec<(Range<usize>, String)> {
    let chain = std::iter::successors(uses.get(innermost as usize), |used| uses.get(used.within as usize));
    let noted = chain.map(|used| (used.start as usize..(used.start + used.len) as usize, used.kind.note()));
    noted.take(MAX_SHOWN).collect()
}

impl UseKind {
    fn note(self) -> String {
        match self {
            Self::Value => "the value is used here".to_owned(),
            Self::Template => "the template is used here".to_owned(),
            Self::Include => "included here".to_owned(),
            Self::Copy { indices, dimensions } => {
                let numbers = indices.iter().take(dimensions.into()).map(u32::to_string).collect::<Vec<_>>();
                format!("in the copy [{}] of this", numbers.join(","))
            }
        }
    }
}
