//! Text as coverage.

use super::coverage::CoverageMask;
use super::font::Font;
use ab_glyph::{Font as _, FontVec, PxScale, ScaleFont, point};

/// The height of a line in pixels, if letters are `size` pixels high.
pub fn line_height(size: f32) -> usize {
    Font::default().face().map_or(0, |font| font.as_scaled(PxScale::from(size)).height().ceil() as usize)
}

/// The width of the longest line of a text in pixels, if letters are `size` pixels high.
pub fn text_width(font: &Font, text: &str, size: f32) -> f32 {
    let Some(font) = font.face() else { return 0.0 };
    text.lines().map(|line| places(font, line, size).1).fold(0.0, f32::max)
}

/// The alignment of lines that are shorter than the longest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Center,
    Right,
}

/// The glyphs of a line with the places where they begin, and the width of the line.
fn places(font: &FontVec, line: &str, size: f32) -> (Vec<(ab_glyph::GlyphId, f32)>, f32) {
    let scaled = font.as_scaled(PxScale::from(size));
    let (mut at, mut last, mut glyphs) = (0.0, None, Vec::new());
    for letter in line.chars() {
        let glyph = scaled.glyph_id(letter);
        at += last.map_or(0.0, |last| scaled.kern(last, glyph));
        glyphs.push((glyph, at));
        at += scaled.h_advance(glyph);
        last = Some(glyph);
    }
    (glyphs, at)
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
    /// A line of text, `size` pixels high from the lowest descender to the highest ascender.
    pub fn new(text: &str, size: f32) -> Self {
        Self::shifted(&Font::default(), text, size, [0.0; 2])
    }

    /// [`TextMask::new`] in any font, moved right and down by parts of a pixel.
    fn shifted(font: &Font, text: &str, size: f32, [right, down]: [f32; 2]) -> Self {
        // The program's font is never broken. If it were, pictures would have no text.
        let Some(font) = font.face() else { return Self::default() };
        let (glyphs, end) = places(font, text, size);
        let scale = PxScale::from(size);
        let scaled = font.as_scaled(scale);
        let (width, height) = ((end + right).ceil() as usize, (scaled.height() + down).ceil() as usize);
        let mut line = Self { width, height, coverage: vec![0.0; width * height] };
        for (glyph, at) in glyphs {
            let glyph = glyph.with_scale_and_position(scale, point(at + right, scaled.ascent() + down));
            let Some(outlined) = font.outline_glyph(glyph) else { continue };
            let (left, top) = (outlined.px_bounds().min.x as i64, outlined.px_bounds().min.y as i64);
            outlined.draw(|x, y, c| line.add(left + i64::from(x), top + i64::from(y), c));
        }
        line
    }

    /// Several lines below each other, each `size` pixels high.
    pub fn block(text: &str, size: f32, align: Align) -> Self {
        let lines: Vec<Self> = text.lines().map(|line| Self::new(line, size)).collect();
        let width = lines.iter().map(|line| line.width).max().unwrap_or(0);
        let mut block = Self { width, height: 0, coverage: Vec::new() };
        for line in lines {
            let left = match align {
                Align::Left => 0,
                Align::Center => (width - line.width) / 2,
                Align::Right => width - line.width,
            };
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

    /// Adds coverage to a pixel, clamped to 1 because letters may overlap.
    fn add(&mut self, x: i64, y: i64, coverage: f32) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x < self.width && y < self.height {
            let pixel = &mut self.coverage[y * self.width + x];
            *pixel = (*pixel + coverage).min(1.0);
        }
    }
}

/// One line of text whose box has its top left corner at any place, also between pixels.
pub fn placed_line(font: &Font, line: &str, size: f32, [x, y]: [f64; 2]) -> CoverageMask {
    let (left, top) = (x.floor(), y.floor());
    let mask = TextMask::shifted(font, line, size, [(x - left) as f32, (y - top) as f32]);
    CoverageMask {
        left: left as i64,
        top: top as i64,
        width: mask.width,
        height: mask.height,
        values: mask.coverage,
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
        let centre = |x: f64| {
            let line = placed_line(&Font::default(), "lo", 20.0, [x, 3.25]);
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
    fn lines_are_below_each_other() {
        let (short, long) = (TextMask::new("il", 20.0), TextMask::new("frame 007", 20.0));
        let rows = |block: &TextMask, from: usize| -> Vec<Vec<f32>> {
            block.coverage.chunks(block.width).skip(from).take(20).map(<[f32]>::to_vec).collect()
        };
        for (align, left) in [(Align::Left, 0), (Align::Right, long.width - short.width)] {
            let block = TextMask::block("frame 007\n\nil", 20.0, align);
            assert_eq!((block.width, block.height, block.coverage.len()), (long.width, 60, 60 * long.width));
            assert_eq!(rows(&block, 0), rows(&long, 0));
            assert!(rows(&block, 20).concat().iter().all(|coverage| *coverage == 0.0));
            let last: Vec<f32> =
                rows(&block, 40).iter().flat_map(|row| row[left..left + short.width].to_vec()).collect();
            assert_eq!(last, short.coverage);
        }
        let one = |text| TextMask::block(text, 20.0, Align::Center).coverage;
        assert_eq!(one("il"), short.coverage);
        assert_eq!(one("il\r\n"), short.coverage);
        assert_eq!(TextMask::block("", 20.0, Align::Left).width, 0);
    }

    #[test]
    fn empty_text_has_no_width() {
        assert_eq!(TextMask::new("", 20.0).width, 0);
    }
}
