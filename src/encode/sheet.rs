//! Filmstrips: several frames in a grid, each with a text below, as one picture.

use super::picture::Picture;
use crate::drawing::TextMask;

/// The code of the background.
const PAPER: u8 = 255;
/// The code of the text.
const INK: u8 = 40;
/// The code of the border around each frame. Without it, bright frames would have no visible edge.
const LINE: u8 = 170;
/// The preferred width of a sheet divided by its height.
const ASPECT: f64 = 1.5;

/// A grid of equal cells that is being filled.
pub struct Sheet {
    columns: u32,
    cell: (u32, u32),
    /// Space between cells and around the grid, in pixels.
    gap: u32,
    /// Height of the letters in pixels.
    letters: f32,
    /// Height of the space for text below a frame, in pixels.
    below: u32,
    picture: Picture,
}

/// The layout of a sheet in pixels; the fields are those of [`Sheet`].
struct SheetLayout {
    columns: u32,
    gap: u32,
    letters: f32,
    below: u32,
    size: (u32, u32),
}

impl SheetLayout {
    fn of(count: u32, columns: u32, cell: (u32, u32), lines: u32) -> Self {
        let columns = columns.clamp(1, count.max(1));
        let gap = (cell.0 / 24).clamp(4, 24);
        let letters = (cell.0 as f32 * 0.05).clamp(11.0, 28.0);
        let below = (letters * (0.4 + lines as f32)).round() as u32;
        let rows = count.max(1).div_ceil(columns);
        // A size that saturates u32 is too large for memory too.
        let side = |places: u32, one: u32| places.saturating_mul(one.saturating_add(gap)).saturating_add(gap);
        Self {
            columns,
            gap,
            letters,
            below,
            size: (side(columns, cell.0), side(rows, cell.1.saturating_add(below))),
        }
    }
}

impl Sheet {
    /// A sheet of `count` frames of the size `cell`, each with `lines` lines of text.
    pub fn new(count: u32, columns: u32, cell: (u32, u32), lines: u32) -> Self {
        let SheetLayout { columns, gap, letters, below, size } = SheetLayout::of(count, columns, cell, lines);
        let picture = Picture::filled(size.0, size.1, [PAPER; 3]);
        Self { columns, cell, gap, letters, below, picture }
    }

    /// Width and height of a sheet in pixels.
    pub fn size(count: u32, columns: u32, cell: (u32, u32), lines: u32) -> (u32, u32) {
        SheetLayout::of(count, columns, cell, lines).size
    }

    /// Draws a frame of the cell's size and its text.
    pub fn put(&mut self, index: u32, frame: &Picture, text: &str) {
        let left = self.gap + index % self.columns * (self.cell.0 + self.gap);
        let top = self.gap + index / self.columns * (self.cell.1 + self.below + self.gap);
        let edge = Picture::filled(self.cell.0 + 2, self.cell.1 + 2, [LINE; 3]);
        self.picture.place(&edge, left - 1, top - 1);
        self.picture.place(frame, left, top);
        let mask = TextMask::centered_lines(text, self.letters);
        let across = (self.cell.0 as usize).saturating_sub(mask.width) / 2;
        let down = (self.below as usize).saturating_sub(mask.height);
        // A name with line breaks may give more lines than expected; the rest is cut off.
        for (y, row) in mask.coverage.chunks_exact(mask.width.max(1)).enumerate().take(self.below as usize) {
            let y = (top + self.cell.1) as usize + down + y;
            // A text that is too long is cut off at the cell's edge.
            for (x, coverage) in row.iter().enumerate().take(self.cell.0 as usize) {
                let at = 3 * (y * self.picture.width as usize + left as usize + across + x);
                let code = f32::from(PAPER) + (f32::from(INK) - f32::from(PAPER)) * coverage;
                self.picture.rgb[at..at + 3].fill((code + 0.5) as u8);
            }
        }
    }

    pub fn finish(self) -> Picture {
        self.picture
    }
}

/// The number of columns for which the sheet has about the preferred shape and few empty cells.
pub fn columns(count: u32, cell: (u32, u32)) -> u32 {
    let cost = |columns: u32| {
        let rows = count.div_ceil(columns);
        let aspect = f64::from(columns * cell.0) / f64::from(rows * cell.1);
        let empty = f64::from(columns * rows - count) / f64::from(count);
        libm::log(aspect / ASPECT).abs() + 3.0 * empty
    };
    (1..=count.clamp(1, 64)).min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_and_texts_are_in_their_cells() {
        let mut sheet = Sheet::new(5, 3, (96, 48), 1);
        for index in 0..5 {
            sheet.put(index, &Picture::filled(96, 48, [10 * index as u8, 99, 0]), "frame 3");
        }
        let picture = sheet.finish();
        assert_eq!((picture.width, picture.height), (3 * 100 + 4, 2 * (48 + 15 + 4) + 4));
        let pixel = |x: u32, y: u32| &picture.rgb[3 * (y * picture.width + x) as usize..][..3];
        let frame = [0, 99, 0];
        assert_eq!((pixel(4, 4), pixel(99, 51)), (&frame[..], &frame[..]));
        assert_eq!((pixel(3, 4), pixel(2, 4)), (&[LINE; 3][..], &[255; 3][..]));
        assert_eq!(pixel(104, 4 + 48 + 15 + 4), [40, 99, 0]);
        // The last cell is empty, and there is text below a frame.
        assert_eq!(pixel(204, 4 + 48 + 15 + 4), [255; 3]);
        assert!((52..67).any(|y| (4..100).any(|x| pixel(x, y)[0] < 100)));
    }

    #[test]
    fn every_line_has_space() {
        let height = |lines, text: &str| {
            let mut sheet = Sheet::new(1, 1, (96, 48), lines);
            sheet.put(0, &Picture::filled(96, 48, [0; 3]), text);
            let picture = sheet.finish();
            let row = |y: u32| &picture.rgb[(3 * y * picture.width) as usize..][..3 * picture.width as usize];
            let inked = |y: &u32| row(*y).iter().any(|code| *code < 100);
            (picture.height, (53..picture.height).filter(inked).count())
        };
        assert_eq!(Sheet::size(1, 1, (96, 48), 3).1, height(3, "x").0);
        let (one, two) = (height(1, "x"), height(2, "x\nx"));
        assert_eq!((two.0 - one.0, two.1), (11, 2 * one.1));
        // Extra lines are not drawn outside the sheet.
        height(1, "x\nx\nx\nx\nx\nx\nx");
    }

    #[test]
    fn grids_are_about_as_wide_as_a_page() {
        assert_eq!(columns(8, (640, 360)), 2);
        assert_eq!(columns(9, (640, 360)), 3);
        assert_eq!(columns(6, (400, 400)), 3);
        assert_eq!(columns(1, (640, 360)), 1);
        assert_eq!(columns(5, (100, 1000)), 5);
    }
}
