//! Text as pixels, in the bundled font.

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use std::sync::LazyLock;

/// Roboto Medium, see assets/README.md.
pub const FONT_FILE: &[u8] = include_bytes!("../../assets/fonts/Roboto-Medium.ttf");

static FONT: LazyLock<Option<FontRef<'static>>> = LazyLock::new(|| FontRef::try_from_slice(FONT_FILE).ok());

/// The letters of a text that the font does not have, each once, in their order.
pub fn lacking(text: &str) -> Vec<char> {
    let mut lacking = Vec::new();
    for letter in text.chars() {
        let known = FONT.as_ref().is_none_or(|font| font.glyph_id(letter).0 != 0);
        if !known && !lacking.contains(&letter) {
            lacking.push(letter);
        }
    }
    lacking
}

/// Rows of pixels of a line whose letters are `size` pixels high.
pub fn line_height(size: f32) -> usize {
    FONT.as_ref().map_or(0, |font| font.as_scaled(PxScale::from(size)).height().ceil() as usize)
}

/// Where the lines of a text stand that are shorter than its longest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Center,
    Right,
}

/// A line of text, or several below each other: how much of each pixel they cover.
#[derive(Clone, Debug, Default)]
pub struct Line {
    pub width: usize,
    pub height: usize,
    /// 0..=1, row by row.
    pub cover: Vec<f32>,
}

impl Line {
    /// The text, `size` pixels high from the lowest descender to the highest letter.
    pub fn new(text: &str, size: f32) -> Self {
        // The font is a part of the program; if it were broken, pictures would still be right without captions.
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
        let mut line = Self { width, height, cover: vec![0.0; width * height] };
        for outlined in glyphs.into_iter().filter_map(|glyph| font.outline_glyph(glyph)) {
            let (left, top) = (outlined.px_bounds().min.x as i64, outlined.px_bounds().min.y as i64);
            outlined.draw(|x, y, cover| line.add(left + i64::from(x), top + i64::from(y), cover));
        }
        line
    }

    /// The lines of a text below each other, each `size` pixels high.
    pub fn block(text: &str, size: f32, align: Align) -> Self {
        let lines: Vec<Self> = text.lines().map(|line| Self::new(line, size)).collect();
        let width = lines.iter().map(|line| line.width).max().unwrap_or(0);
        let mut block = Self { width, height: 0, cover: Vec::new() };
        for line in lines {
            let left = match align {
                Align::Left => 0,
                Align::Center => (width - line.width) / 2,
                Align::Right => width - line.width,
            };
            let top = block.cover.len();
            block.height += line.height;
            block.cover.resize(block.height * width, 0.0);
            for y in 0..line.height {
                let row = &line.cover[y * line.width..][..line.width];
                block.cover[top + y * width + left..][..line.width].copy_from_slice(row);
            }
        }
        block
    }

    /// Letters may touch each other.
    fn add(&mut self, x: i64, y: i64, cover: f32) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x < self.width && y < self.height {
            let pixel = &mut self.cover[y * self.width + x];
            *pixel = (*pixel + cover).min(1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_cover_some_of_their_line() {
        let line = Line::new("frame 007 · 0.29 s", 32.0);
        assert_eq!((line.height, line.cover.len()), (32, line.width * 32));
        assert!((180..300).contains(&line.width), "{}", line.width);
        let share = line.cover.iter().sum::<f32>() / line.cover.len() as f32;
        assert!((0.1..0.4).contains(&share), "{share}");
        assert!(line.cover.iter().all(|cover| (0.0..=1.0).contains(cover)));
    }

    #[test]
    fn digits_are_equally_wide() {
        let widths = (0..10).map(|digit| Line::new(&format!("{digit}{digit}"), 40.0).width);
        assert_eq!(widths.collect::<std::collections::HashSet<_>>().len(), 1);
    }

    #[test]
    fn letters_that_are_not_there_are_told() {
        assert_eq!(lacking("zoë 漢字 12 漢"), ['漢', '字']);
        assert!(lacking("frame 007 · 0.29 s, ÄÖÜß Ωλ Жя").is_empty());
    }

    #[test]
    fn lines_stand_below_each_other() {
        let (short, long) = (Line::new("il", 20.0), Line::new("frame 007", 20.0));
        let rows = |block: &Line, from: usize| -> Vec<Vec<f32>> {
            block.cover.chunks(block.width).skip(from).take(20).map(<[f32]>::to_vec).collect()
        };
        for (align, left) in [(Align::Left, 0), (Align::Right, long.width - short.width)] {
            let block = Line::block("frame 007\n\nil", 20.0, align);
            assert_eq!((block.width, block.height, block.cover.len()), (long.width, 60, 60 * long.width));
            assert_eq!(rows(&block, 0), rows(&long, 0));
            assert!(rows(&block, 20).concat().iter().all(|cover| *cover == 0.0));
            let last: Vec<f32> =
                rows(&block, 40).iter().flat_map(|row| row[left..left + short.width].to_vec()).collect();
            assert_eq!(last, short.cover);
        }
        let one = |text| Line::block(text, 20.0, Align::Center).cover;
        assert_eq!(one("il"), short.cover);
        assert_eq!(one("il\r\n"), short.cover);
        assert_eq!(Line::block("", 20.0, Align::Left).width, 0);
    }

    #[test]
    fn nothing_takes_no_place() {
        assert_eq!(Line::new("", 20.0).width, 0);
    }
}
