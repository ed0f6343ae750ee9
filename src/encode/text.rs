//! Text rendered with the bundled font.

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use std::sync::LazyLock;

/// Roboto Medium, see assets/README.md.
pub const FONT_FILE: &[u8] = include_bytes!("../../assets/fonts/Roboto-Medium.ttf");

static FONT: LazyLock<Option<FontRef<'static>>> = LazyLock::new(|| FontRef::try_from_slice(FONT_FILE).ok());

/// The letters of a text that the font lacks, each once, in their order.
pub fn missing_glyphs(text: &str) -> Vec<char> {
    let mut missing = Vec::new();
    for letter in text.chars() {
        let known = FONT.as_ref().is_none_or(|font| font.glyph_id(letter).0 != 0);
        if !known && !missing.contains(&letter) {
            missing.push(letter);
        }
    }
    missing
}

/// The height of a line in pixels, if letters are `size` pixels high.
pub fn line_height(size: f32) -> usize {
    FONT.as_ref().map_or(0, |font| font.as_scaled(PxScale::from(size)).height().ceil() as usize)
}

/// The alignment of lines that are shorter than the longest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Center,
    Right,
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
        // The font is part of the program. If it were broken, pictures would have no captions.
        let Some(font) = FONT.as_ref() else { return Self::default() };
        let scale = PxScale::from(size);
        let scaled = font.as_scaled(scale);
        let (mut at, mut last, mut glyphs) = (0.0, None, Vec::new());
        for letter in text.chars() {
            let glyph = scaled.glyph_id(letter);
            at += last.map_or(0.0, |last| scaled.kern(last, glyph));
            glyphs.push(glyph.with_scale_and_position(scale, point(at, scaled.ascent())));
            at += scaled.h_advance(glyph);
            last = Some(glyph);
        }
        let (width, height) = (at.ceil() as usize, line_height(size));
        let mut line = Self { width, height, coverage: vec![0.0; width * height] };
        for outlined in glyphs.into_iter().filter_map(|glyph| font.outline_glyph(glyph)) {
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
    fn missing_letters_are_found() {
        assert_eq!(missing_glyphs("zoë 漢字 12 漢"), ['漢', '字']);
        assert!(missing_glyphs("frame 007 · 0.29 s, ÄÖÜß Ωλ Жя").is_empty());
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
