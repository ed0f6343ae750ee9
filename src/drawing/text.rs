//! Text as coverage.

use super::coverage::CoverageMask;
use super::font::Font;
use super::shaping::shaped;
use crate::base::math::DVec2;
use ab_glyph::{Font as _, FontVec, GlyphId, PxScale, ScaleFont, point};

/// The width of the longest line of a text in pixels, if letters are `size` pixels high.
pub fn text_width(font: &Font, text: &str, size: f32) -> f32 {
    text.lines().map(|line| glyphs(font, line, size).1).fold(0.0, f32::max)
}

/// The alignment of lines that are shorter than the longest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Align {
    Left,
    Center,
    Right,
}

/// A glyph of a line.
pub(super) struct PlacedGlyph<'f> {
    pub face: &'f FontVec,
    pub glyph: GlyphId,
    /// Where it begins, in pixels from the beginning of the line.
    pub along: f32,
    /// Its distance upwards from the baseline.
    pub raised: f32,
    /// The height of letters.
    pub size: f32,
}

/// Whether a letter stands on the baseline, above it (`<sup>`) or below it (`<sub>`).
#[derive(Clone, Copy, Default, PartialEq)]
enum Script {
    #[default]
    Plain,
    Raised,
    Lowered,
}

/// What changes the script. There is no way to write these as text.
const TAGS: [(&str, Script); 4] = [
    ("<sup>", Script::Raised),
    ("<sub>", Script::Lowered),
    ("</sup>", Script::Plain),
    ("</sub>", Script::Plain),
];
/// The size of raised and lowered letters, and how far they are moved, relative to others.
const SCRIPT_SIZE: f32 = 0.625;
const RAISED_BY: f32 = 0.3125;
const LOWERED_BY: f32 = 0.125;

/// The letters of a line with their scripts.
fn letters(line: &str) -> impl Iterator<Item = (char, Script)> {
    let (mut rest, mut script) = (line, Script::Plain);
    std::iter::from_fn(move || {
        while let Some((tag, next)) = TAGS.iter().find(|(tag, _)| rest.starts_with(tag)) {
            (rest, script) = (&rest[tag.len()..], *next);
        }
        let letter = rest.chars().next()?;
        rest = &rest[letter.len_utf8()..];
        Some((letter, script))
    })
}

/// The glyphs of a line, and its width.
pub(super) fn glyphs<'f>(font: &'f Font, line: &str, size: f32) -> (Vec<PlacedGlyph<'f>>, f32) {
    let (mut text, mut scripts) = (String::new(), Vec::new());
    for (letter, script) in letters(line) {
        text.push(letter);
        scripts.resize(text.len(), script);
    }
    let mut along = 0.0f32;
    let placed = shaped(font, &text, &scripts).into_iter().map(|glyph| {
        let (size, raised) = match scripts.get(glyph.letter).copied().unwrap_or_default() {
            Script::Plain => (size, 0.0),
            Script::Raised => (SCRIPT_SIZE * size, RAISED_BY * size),
            Script::Lowered => (SCRIPT_SIZE * size, -LOWERED_BY * size),
        };
        let face = &glyph.face.outlines;
        let scale = size / face.height_unscaled();
        let [right, up] = glyph.offset.map(|offset| offset * scale);
        let start = along;
        along += glyph.advance * scale;
        PlacedGlyph { face, glyph: glyph.glyph, along: start + right, raised: raised + up, size }
    });
    (placed.collect(), along)
}

/// One line of text at any place of a picture, also between pixels.
pub struct PlacedLine<'f> {
    pub(super) glyphs: Vec<PlacedGlyph<'f>>,
    /// The beginning of the line, relative to the pixel in which its box has its top left corner.
    pub(super) start: [f32; 2],
    /// That pixel.
    pub(super) corner: [i64; 2],
    /// Width and height of the box in pixels.
    extent: [usize; 2],
}

impl<'f> PlacedLine<'f> {
    /// A line whose box has its top left corner at a place.
    pub fn new(font: &'f Font, line: &str, size: f32, at: DVec2) -> Self {
        let (glyphs, width) = glyphs(font, line, size);
        let floor = at.floor();
        let [right, down] = (at - floor).to_array().map(|part| part as f32);
        let face = font.face().map(|face| face.outlines.as_scaled(PxScale::from(size)));
        let (height, ascent) = face.map_or((0.0, 0.0), |face| (face.height(), face.ascent()));
        let extent = [width + right, height + down].map(|side| side.ceil() as usize);
        Self { glyphs, start: [right, ascent + down], corner: [floor.x as i64, floor.y as i64], extent }
    }

    /// Pixels without coverage: the box and `border` pixels around it, where they lie within a picture.
    pub(super) fn mask(&self, border: i64, (width, height): (u32, u32)) -> CoverageMask {
        let side = |axis: usize, end: u32| {
            let first = self.corner[axis].saturating_sub(border);
            let last = self.corner[axis].saturating_add(self.extent[axis] as i64 + border);
            let (first, last) = (first.max(0), last.min(end.into()));
            (first, (last - first).max(0) as usize)
        };
        let ((left, width), (top, height)) = (side(0, width), side(1, height));
        CoverageMask { left, top, width, height, values: vec![0.0; width * height] }
    }

    /// The coverage by the letters, in a picture of this size.
    pub fn letters(&self, size: (u32, u32)) -> CoverageMask {
        let mut mask = self.mask(0, size);
        if mask.values.is_empty() {
            return mask;
        }
        let [dx, dy] = [self.corner[0] - mask.left, self.corner[1] - mask.top];
        for PlacedGlyph { face, glyph, along, raised, size } in &self.glyphs {
            let place = point(self.start[0] + along, self.start[1] - raised);
            let glyph = glyph.with_scale_and_position(PxScale::from(*size), place);
            let Some(outlined) = face.outline_glyph(glyph) else { continue };
            let bounds = outlined.px_bounds();
            let (left, top) = (bounds.min.x as i64 + dx, bounds.min.y as i64 + dy);
            if left >= mask.width as i64 || bounds.max.x as i64 + dx <= 0 {
                continue;
            }
            outlined.draw(|x, y, c| mask.add(left + i64::from(x), top + i64::from(y), c));
        }
        mask
    }
}

/// The coverage of pixels by one or several lines of text.
#[derive(Clone, Debug, Default)]
pub struct TextMask {
    pub width: usize,
    pub height: usize,
    /// 0..=1 per pixel, in rows from the top.
    pub coverage: Vec<f32>,
}

impl TextMask {
    /// A line of text in the program's font, `size` pixels high from the lowest descender to the highest ascender.
    pub fn new(text: &str, size: f32) -> Self {
        let font = Font::default();
        let line = PlacedLine::new(&font, text, size, DVec2::ZERO);
        let [width, height] = line.extent;
        Self { width, height, coverage: line.letters((width as u32, height as u32)).values }
    }

    /// Several lines below each other, each `size` pixels high and in the middle of the longest.
    pub fn centered_lines(text: &str, size: f32) -> Self {
        let lines: Vec<Self> = text.lines().map(|line| Self::new(line, size)).collect();
        let width = lines.iter().map(|line| line.width).max().unwrap_or(0);
        let mut block = Self { width, height: 0, coverage: Vec::new() };
        for line in lines {
            let left = (width - line.width) / 2;
            let top = block.coverage.len();
            block.height += line.height;
            block.coverage.resize(block.height * width, 0.0);
            for y in 0..line.height {
                let row = &line.coverage[y * line.width..][..line.width];
                block.coverage[top + y * width + left..][..line.width].copy_from_slice(row);
            }
        }
        block
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_cover_some_of_their_line() {
        let line = TextMask::new("frame 007 · 0.29 s", 32.0);
        assert_eq!((line.height, line.coverage.len()), (32, line.width * 32));
        assert!((180..300).contains(&line.width), "{}", line.width);
        let share = line.coverage.iter().sum::<f32>() / line.coverage.len() as f32;
        assert!((0.1..0.4).contains(&share), "{share}");
        assert!(line.coverage.iter().all(|coverage| (0.0..=1.0).contains(coverage)));
    }

    #[test]
    fn digits_are_equally_wide() {
        let widths = (0..10).map(|digit| TextMask::new(&format!("{digit}{digit}"), 40.0).width);
        assert_eq!(widths.collect::<std::collections::HashSet<_>>().len(), 1);
    }

    #[test]
    fn text_may_lie_between_pixels() {
        let font = Font::default();
        let centre = |x: f64| {
            let line = PlacedLine::new(&font, "lo", 20.0, DVec2::new(x, 3.25)).letters((100, 50));
            let sums = line.values.iter().enumerate();
            let at = |index: usize| (line.left + (index % line.width) as i64) as f32;
            let moment: f32 = sums.map(|(index, value)| at(index) * value).sum();
            moment / line.values.iter().sum::<f32>()
        };
        let first = centre(4.0);
        for step in 1..8 {
            let moved = f64::from(step) / 8.0;
            assert!((centre(4.0 + moved) - first - moved as f32).abs() < 0.01);
        }
    }

    #[test]
    fn only_pixels_of_the_picture_are_made() {
        let font = Font::default();
        let text = "wide ".repeat(1000);
        let line = PlacedLine::new(&font, &text, 200.0, DVec2::new(-1e5, 3.0));
        let masks = [line.letters((50, 40)), line.halo(9.0, (50, 40))];
        assert!(masks.iter().all(|mask| mask.values.len() <= 50 * 40));
        assert!(masks.iter().all(|mask| mask.values.iter().any(|value| *value > 0.0)));
        let far = PlacedLine::new(&font, "a", 20.0, DVec2::new(1e300, 0.0));
        assert!(far.letters((50, 40)).values.is_empty());
    }

    #[test]
    fn letters_that_a_font_lacks_are_drawn_in_the_programs_font() {
        let own = Font::parse(super::super::font::FONT_FILE.to_vec()).expect("a font");
        let widths = [&own, &Font::default()].map(|font| text_width(font, "10⁷ − x", 20.0));
        assert_eq!(widths[0], widths[1]);
    }

    #[test]
    fn lines_are_below_each_other() {
        let (short, long) = (TextMask::new("il", 20.0), TextMask::new("frame 007", 20.0));
        let rows = |block: &TextMask, from: usize| -> Vec<Vec<f32>> {
            block.coverage.chunks(block.width).skip(from).take(20).map(<[f32]>::to_vec).collect()
        };
        let block = TextMask::centered_lines("frame 007\n\nil", 20.0);
        assert_eq!((block.width, block.height, block.coverage.len()), (long.width, 60, 60 * long.width));
        assert_eq!(rows(&block, 0), rows(&long, 0));
        assert!(rows(&block, 20).concat().iter().all(|coverage| *coverage == 0.0));
        let left = (long.width - short.width) / 2;
        let last: Vec<f32> =
            rows(&block, 40).iter().flat_map(|row| row[left..left + short.width].to_vec()).collect();
        assert_eq!(last, short.coverage);
        let one = |text| TextMask::centered_lines(text, 20.0).coverage;
        assert_eq!(one("il"), short.coverage);
        assert_eq!(one("il\r\n"), short.coverage);
        assert_eq!(TextMask::centered_lines("", 20.0).width, 0);
    }

    #[test]
    fn letters_may_be_raised_and_lowered() {
        let font = Font::default();
        let places = |line: &str| -> Vec<(f32, f32)> {
            glyphs(&font, line, 100.0).0.iter().map(|glyph| (glyph.raised, glyph.size)).collect()
        };
        let (plain, raised, lowered) = ((0.0, 100.0), (31.25, 62.5), (-12.5, 62.5));
        assert_eq!(places("m<sup>2</sup>v"), [plain, raised, plain]);
        assert_eq!(places("v<sub>ab"), [plain, lowered, lowered]);
        assert_eq!(places("a<b></sub>"), [plain; 4]);
        assert!(text_width(&font, "m<sup>2</sup>", 100.0) < text_width(&font, "m2", 100.0));
    }

    #[test]
    fn empty_text_has_no_width() {
        assert_eq!(TextMask::new("", 20.0).width, 0);
    }
}
