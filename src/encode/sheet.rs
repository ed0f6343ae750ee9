//! A filmstrip: one picture of several frames in a grid, each with a line of text below.

use super::picture::Picture;
use super::text::Line;

/// What is behind the frames: paper.
const PAPER: u8 = 255;
/// How dark the text is.
const INK: u8 = 40;
/// The line around each frame, without which a bright one would have no edge.
const LINE: u8 = 170;
/// A sheet's usual width divided by its height.
const ASPECT: f64 = 1.5;

/// A grid of equal cells in the making.
pub struct Sheet {
    columns: u32,
    cell: (u32, u32),
    /// Between cells, and around all.
    gap: u32,
    /// Height of the letters, and of the space below a frame that is for them.
    letters: f32,
    below: u32,
    picture: Picture,
}

/// How a sheet is laid out, in pixels; as in [`Sheet`].
struct Measures {
    columns: u32,
    gap: u32,
    letters: f32,
    below: u32,
    size: (u32, u32),
}

impl Measures {
    fn of(count: u32, columns: u32, cell: (u32, u32)) -> Self {
        let columns = columns.clamp(1, count.max(1));
        let gap = (cell.0 / 24).clamp(4, 24);
        let letters = (cell.0 as f32 * 0.05).clamp(11.0, 28.0);
        let below = (letters * 1.4).round() as u32;
        let rows = count.max(1).div_ceil(columns);
        // What is too large for whole numbers is for memory, too.
        let side = |places: u32, one: u32| places.saturating_mul(one + gap).saturating_add(gap);
        Self { columns, gap, letters, below, size: (side(columns, cell.0), side(rows, cell.1 + below)) }
    }
}

impl Sheet {
    /// A sheet of `count` frames of this size.
    pub fn new(count: u32, columns: u32, cell: (u32, u32)) -> Self {
        let Measures { columns, gap, letters, below, size } = Measures::of(count, columns, cell);
        let picture = Picture::filled(size.0, size.1, [PAPER; 3]);
        Self { columns, cell, gap, letters, below, picture }
    }

    /// Width and height of such a sheet in pixels.
    pub fn size(count: u32, columns: u32, cell: (u32, u32)) -> (u32, u32) {
        Measures::of(count, columns, cell).size
    }

    /// Puts a frame of the sheet's size into its place.
    pub fn put(&mut self, index: u32, frame: &Picture, text: &str) {
        let left = self.gap + index % self.columns * (self.cell.0 + self.gap);
        let top = self.gap + index / self.columns * (self.cell.1 + self.below + self.gap);
        let edge = Picture::filled(self.cell.0 + 2, self.cell.1 + 2, [LINE; 3]);
        self.picture.place(&edge, left - 1, top - 1);
        self.picture.place(frame, left, top);
        let line = Line::new(text, self.letters);
        let across = (self.cell.0 as usize).saturating_sub(line.width) / 2;
        let down = (self.below as usize).saturating_sub(line.height);
        for (y, row) in line.cover.chunks_exact(line.width.max(1)).enumerate() {
            let y = (top + self.cell.1) as usize + down + y;
            // A text that is too long ends with its cell.
            for (x, cover) in row.iter().enumerate().take(self.cell.0 as usize) {
                let at = 3 * (y * self.picture.width as usize + left as usize + across + x);
                let code = f32::from(PAPER) + (f32::from(INK) - f32::from(PAPER)) * cover;
                self.picture.rgb[at..at + 3].fill((code + 0.5) as u8);
            }
        }
    }

    pub fn finish(self) -> Picture {
        self.picture
    }
}

/// How many columns of frames of this size give a sheet of about the usual shape with few empty places.
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
    fn frames_and_texts_have_their_places() {
        let mut sheet = Sheet::new(5, 3, (96, 48));
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
        // The last place is empty, and there is ink below a frame.
        assert_eq!(pixel(204, 4 + 48 + 15 + 4), [255; 3]);
        assert!((52..67).any(|y| (4..100).any(|x| pixel(x, y)[0] < 100)));
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
