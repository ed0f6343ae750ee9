//! STL files as text: `facet`s of three `vertex` lines, between `solid` and `endsolid`.

use super::Welder;
use crate::geometry::mesh::{MeshError, MeshLocation};
use crate::import::lines::{Lines, parsed, quoted};
use std::io::BufRead;
use std::ops::Range;

/// Reads all solids of a file.
pub fn read(lines: Lines<impl BufRead>, welder: &mut Welder) -> Result<(), MeshError> {
    let mut words = Words { lines, line: Vec::new(), word: 0..0, number: 0 };
    while words.advance()? {
        if !words.is("solid") {
            return Err(words.unlike("`solid`"));
        }
        // The name may be missing or have several words.
        words.skip_line();
        loop {
            words.require()?;
            if words.is("endsolid") {
                words.skip_line();
                break;
            }
            if !words.is("facet") {
                return Err(words.unlike("`facet` or `endsolid`"));
            }
            facet(&mut words, welder)?;
        }
    }
    Ok(())
}

/// Reads a facet behind its first word.
fn facet(words: &mut Words<impl BufRead>, welder: &mut Welder) -> Result<(), MeshError> {
    words.expect("normal")?;
    // Normals are ignored, and some programs write `-nan(ind)`.
    for _ in 0..3 {
        words.require()?;
    }
    words.expect("outer")?;
    words.expect("loop")?;
    let mut corners = [[0.0; 3]; 3];
    for corner in &mut corners {
        words.expect("vertex")?;
        for coordinate in corner {
            *coordinate = words.float()?;
        }
    }
    welder.push(corners, MeshLocation::Line(words.number))?;
    words.expect("endloop")?;
    words.expect("endfacet")
}

/// The words of a file one after the other, whatever their lines.
struct Words<R> {
    lines: Lines<R>,
    line: Vec<u8>,
    /// The last word's place in the line.
    word: Range<usize>,
    /// The line's number.
    number: u64,
}

impl<R: BufRead> Words<R> {
    /// Goes to the next word; false at the end of the file.
    fn advance(&mut self) -> Result<bool, MeshError> {
        loop {
            let rest = &self.line[self.word.end..];
            if let Some(blanks) = rest.iter().position(|byte| !byte.is_ascii_whitespace()) {
                let start = self.word.end + blanks;
                let length = rest[blanks..].iter().position(u8::is_ascii_whitespace);
                self.word = start..length.map_or(self.line.len(), |length| start + length);
                return Ok(true);
            }
            let Some((number, line)) = self.lines.next()? else { return Ok(false) };
            self.line.clear();
            self.line.extend_from_slice(line);
            (self.word, self.number) = (0..0, number);
        }
    }

    fn require(&mut self) -> Result<(), MeshError> {
        match self.advance()? {
            true => Ok(()),
            false => Err(MeshError::at(MeshLocation::Line(self.number), "the file ends before `endsolid`")),
        }
    }

    fn expect(&mut self, word: &str) -> Result<(), MeshError> {
        self.require()?;
        if self.is(word) { Ok(()) } else { Err(self.unlike(&format!("`{word}`"))) }
    }

    /// A number, rounded to f32 as in a binary file.
    fn float(&mut self) -> Result<f32, MeshError> {
        self.require()?;
        parsed(self.word()).ok_or_else(|| self.unlike("a number"))
    }

    fn word(&self) -> &[u8] {
        &self.line[self.word.clone()]
    }

    fn is(&self, word: &str) -> bool {
        self.word().eq_ignore_ascii_case(word.as_bytes())
    }

    fn skip_line(&mut self) {
        self.word.end = self.line.len();
    }

    fn unlike(&self, what: &str) -> MeshError {
        MeshError::at(
            MeshLocation::Line(self.number),
            format!("expected {what}, found {}", quoted(self.word())),
        )
    }
}
