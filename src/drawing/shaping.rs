//! A line of letters → glyphs from left to right.
//!
//! A line is cut where the direction, the script, the font or the style of its letters changes. Each run becomes glyphs by
//! the tables of its font: letters join, stack and change places as their script asks, pairs are kerned, and ligatures
//! replace letters.

use super::font::{Font, FontFace};
use ab_glyph::GlyphId;
use harfrust::font::Blob;
use harfrust::unicode;
use harfrust::{Buffer, Direction, Script, ShapeOptions, ShapePlan, ShaperFont};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use unicode_bidi::ParagraphBidiInfo;

/// Turns letters of one font into glyphs.
pub struct Shaper {
    font: harfrust::Font,
    /// What the font's tables do for a direction and a script, found once for each.
    plans: Mutex<Vec<Arc<ShapePlan>>>,
}

/// A glyph of a line, in units of its font.
pub struct ShapedGlyph<'f> {
    pub face: &'f FontFace,
    pub glyph: GlyphId,
    /// The letter that it stands for, or the first of several: its index in bytes.
    pub letter: usize,
    /// From this glyph's origin to the next one's.
    pub advance: f32,
    /// Where it is drawn, relative to its origin: to the right, and upwards.
    pub offset: [f32; 2],
}

/// Letters that become glyphs together.
struct Run<'f, S> {
    face: &'f FontFace,
    letters: Range<usize>,
    script: Script,
    style: S,
}

impl Shaper {
    pub fn new(file: Blob) -> Option<Self> {
        Some(Self { font: harfrust::Font::new(file, 0)?, plans: Mutex::default() })
    }

    fn plan(&self, direction: Direction, script: Script) -> Arc<ShapePlan> {
        let mut plans = self.plans.lock().unwrap_or_else(PoisonError::into_inner);
        let known = plans.iter().find(|plan| plan.direction() == direction && plan.script() == Some(script));
        known.map(Arc::clone).unwrap_or_else(|| {
            let plan = Arc::new(ShapePlan::new(&self.font, direction, Some(script), None, &[]));
            plans.push(Arc::clone(&plan));
            plan
        })
    }

    /// The glyphs of a run from left to right.
    fn shape<'f, S>(
        &self,
        run: &Run<'f, S>,
        line: &str,
        is_leftward: bool,
        glyphs: &mut Vec<ShapedGlyph<'f>>,
    ) {
        let direction = if is_leftward { Direction::RightToLeft } else { Direction::LeftToRight };
        let mut buffer = Buffer::new();
        let Some(letters) = line.get(run.letters.clone()) else { return };
        buffer.push_str(letters);
        buffer.set_direction(direction);
        buffer.set_script(Some(run.script));
        let plan = self.plan(direction, run.script);
        // It fails only for other plans than those of the buffer's direction and script.
        if harfrust::shape(&ShaperFont::new(&self.font), &mut buffer, ShapeOptions::new().plan(Some(&plan)))
            .is_err()
        {
            return;
        }
        let infos = buffer.glyph_infos().iter().zip(buffer.glyph_positions());
        glyphs.extend(infos.map(|(info, place)| ShapedGlyph {
            face: run.face,
            // Fonts have at most 65,535 glyphs.
            glyph: GlyphId(u16::try_from(info.glyph_id).unwrap_or_default()),
            letter: run.letters.start + info.cluster as usize,
            advance: place.x_advance as f32,
            offset: [place.x_offset as f32, place.y_offset as f32],
        }));
    }
}

/// The glyphs of a line. `styles` has the style of each byte, or is empty; letters of different styles never become one
/// glyph.
pub fn shaped<'f, S: Copy + Default + PartialEq>(
    font: &'f Font,
    line: &str,
    styles: &[S],
) -> Vec<ShapedGlyph<'f>> {
    let mut glyphs = Vec::new();
    if line.is_empty() {
        return glyphs;
    }
    let paragraph = ParagraphBidiInfo::new(line, None);
    let (levels, directed) = paragraph.visual_runs(0..line.len());
    for part in directed {
        let is_leftward = levels.get(part.start).is_some_and(|level| level.is_rtl());
        let mut runs = runs(font, line, styles, part);
        if is_leftward {
            runs.reverse();
        }
        runs.iter().for_each(|run| run.face.shaper.shape(run, line, is_leftward, &mut glyphs));
    }
    glyphs
}

/// Cuts letters of one direction where their script, font or style changes.
fn runs<'f, S: Copy + Default + PartialEq>(
    font: &'f Font,
    line: &str,
    styles: &[S],
    part: Range<usize>,
) -> Vec<Run<'f, S>> {
    let mut runs: Vec<Run<'f, S>> = Vec::new();
    let Some(letters) = line.get(part.clone()) else { return runs };
    for (index, letter) in letters.char_indices() {
        let start = part.start + index;
        let end = start + letter.len_utf8();
        let (script, style) =
            (unicode::script(letter.into()), styles.get(start).copied().unwrap_or_default());
        // Marks and joiners belong to the letter before them.
        let joins = script == Script::INHERITED;
        // The program's font is never broken. If it were, pictures would have no text.
        let Some(face) = font.face_of(letter) else { continue };
        let last = runs.last_mut().filter(|last| last.style == style);
        match last {
            Some(last) if joins => last.letters.end = end,
            Some(last)
                if std::ptr::eq(last.face, face)
                    && (last.script == script || is_common(last.script) || is_common(script)) =>
            {
                last.letters.end = end;
                if is_common(last.script) {
                    last.script = script;
                }
            }
            _ => runs.push(Run { face, letters: start..end, script, style }),
        }
    }
    runs
}

/// Whether a script is that of spaces, digits and signs, which letters of all scripts use.
fn is_common(script: Script) -> bool {
    [Script::COMMON, Script::INHERITED, Script::UNKNOWN].contains(&script)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn letters(line: &str) -> Vec<usize> {
        shaped::<()>(&Font::default(), line, &[]).iter().map(|glyph| glyph.letter).collect()
    }

    #[test]
    fn glyphs_stand_from_left_to_right() {
        assert_eq!(letters("abc"), [0, 1, 2]);
        // Hebrew runs to the left; the number within it does not, and neither does the word after it.
        assert_eq!(letters("a \u{5d0}\u{5d1} 12 \u{5d2} b"), [0, 1, 10, 9, 7, 8, 6, 4, 2, 12, 13]);
    }

    #[test]
    fn marks_join_their_letter() {
        let font = Font::default();
        let accented = shaped::<()>(&font, "e\u{301}", &[]);
        let composed = shaped::<()>(&font, "\u{e9}", &[]);
        let ids = |glyphs: &[ShapedGlyph]| glyphs.iter().map(|glyph| glyph.glyph).collect::<Vec<_>>();
        assert_eq!(ids(&accented), ids(&composed));
    }

    #[test]
    fn pairs_are_kerned_within_a_style() {
        let width = |line: &str, styles: &[u8]| -> f32 {
            shaped(&Font::default(), line, styles).iter().map(|glyph| glyph.advance).sum()
        };
        let apart = width("A", &[]) + width("V", &[]);
        assert!(width("AV", &[]) < apart);
        assert_eq!(width("AV", &[0, 1]), apart);
    }

    #[test]
    fn scripts_are_cut_apart_and_take_signs_with_them() {
        let font = Font::default();
        let cut = |line: &str| {
            let all = runs::<()>(&font, line, &[], 0..line.len());
            all.iter().map(|run| line[run.letters.clone()].to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(cut("(12) Ab, \u{3b1}\u{3b2} 3"), ["(12) Ab, ", "\u{3b1}\u{3b2} 3"]);
        assert_eq!(cut("x\u{200d}\u{301}y"), ["x\u{200d}\u{301}y"]);
        assert_eq!(cut(""), Vec::<String>::new());
    }
}
