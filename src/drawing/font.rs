//! Fonts: the one in the program, and TrueType and OpenType files.

use super::shaping::{Shaper, shaped};
use crate::base::digest::{Content, Digest, Digester};
use ab_glyph::{Font as _, FontVec};
use harfrust::font::Blob;
use std::fmt;
use std::sync::{Arc, LazyLock};

/// Roboto Medium, see assets/README.md.
pub const FONT_FILE: &[u8] = include_bytes!("../../assets/fonts/Roboto-Medium.ttf");

static BUNDLED: LazyLock<Option<FontFace>> = LazyLock::new(|| {
    let outlines = FontVec::try_from_vec(FONT_FILE.to_vec()).ok()?;
    Some(FontFace { outlines, shaper: Shaper::new(Blob::from(FONT_FILE))? })
});

/// A font. The default is the one in the program.
#[derive(Clone, Default)]
pub struct Font(Option<Arc<FontFile>>);

/// A font from a file.
struct FontFile {
    digest: Digest,
    face: FontFace,
}

/// What a font knows of its glyphs: their outlines, and how letters become glyphs.
pub(super) struct FontFace {
    pub outlines: FontVec,
    pub shaper: Shaper,
}

impl FontFace {
    pub fn has(&self, letter: char) -> bool {
        self.outlines.glyph_id(letter).0 != 0
    }
}

/// A file that is not a font.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FontError;

impl fmt::Display for FontError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("it is not a TrueType or OpenType font")
    }
}

impl std::error::Error for FontError {}

impl Font {
    /// The font in the bytes of a TrueType or OpenType file.
    ///
    /// # Errors
    /// If the bytes are not such a file.
    pub fn parse(bytes: Vec<u8>) -> Result<Self, FontError> {
        let digest = Digest::of(bytes.as_slice());
        let shaper = Shaper::new(Blob::from(bytes.clone())).ok_or(FontError)?;
        let outlines = FontVec::try_from_vec(bytes).map_err(|_| FontError)?;
        Ok(Self(Some(Arc::new(FontFile { digest, face: FontFace { outlines, shaper } }))))
    }

    /// None if the program's own font were broken; then text is left out.
    pub(super) fn face(&self) -> Option<&FontFace> {
        match &self.0 {
            Some(own) => Some(&own.face),
            None => BUNDLED.as_ref(),
        }
    }

    /// The face that has a letter: that of the font or, if it lacks the letter, of the program's font. If both lack it,
    /// the font's.
    pub(super) fn face_of(&self, letter: char) -> Option<&FontFace> {
        let mut faces = self.face().into_iter().chain(BUNDLED.as_ref());
        faces.find(|face| face.has(letter)).or_else(|| self.face())
    }

    /// The letters of a text that neither the font nor the program's font can draw, each once, in their order.
    pub fn missing_glyphs(&self, text: &str) -> Vec<char> {
        let mut missing: Vec<(usize, char)> = Vec::new();
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            let letters = line.trim_end_matches(['\r', '\n']);
            for glyph in shaped::<()>(self, letters, &[]).iter().filter(|glyph| glyph.glyph.0 == 0) {
                let letter = letters.get(glyph.letter..).and_then(|rest| rest.chars().next());
                missing.extend(letter.map(|letter| (start + glyph.letter, letter)));
            }
            start += line.len();
        }
        // Glyphs of lines to the left come in reverse order.
        missing.sort_unstable();
        let mut letters: Vec<char> = Vec::new();
        for (_, letter) in missing {
            if !letters.contains(&letter) {
                letters.push(letter);
            }
        }
        letters
    }

    fn digest(&self) -> Option<Digest> {
        self.0.as_ref().map(|own| own.digest)
    }
}

impl PartialEq for Font {
    fn eq(&self, other: &Self) -> bool {
        self.digest() == other.digest()
    }
}

impl fmt::Debug for Font {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Font").field(&self.digest()).finish()
    }
}

impl Content for Font {
    fn feed(&self, into: &mut Digester) {
        self.digest().feed(into);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_letters_are_found() {
        let font = Font::default();
        assert_eq!(font.missing_glyphs("zoë 漢字 12 漢"), ['漢', '字']);
        assert!(font.missing_glyphs("frame 007 · 0.29 s, ÄÖÜß Ωλ Жя, m² H₂O 10⁻⁵").is_empty());
    }

    #[test]
    fn fonts_are_equal_by_their_bytes() {
        let own = || Font::parse(FONT_FILE.to_vec()).expect("a font");
        assert_eq!(own(), own());
        assert_ne!(own(), Font::default());
        assert_eq!(Font::parse(b"no font".to_vec()), Err(FontError));
    }
}
