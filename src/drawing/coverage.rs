//! How much of each pixel a mark covers.

/// The coverage of a rectangle of pixels. Outside of it is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CoverageMask {
    /// The place of its top left pixel in the picture, which may be outside.
    pub left: i64,
    pub top: i64,
    pub width: usize,
    pub height: usize,
    /// 0..=1 per pixel, in rows from the top.
    pub values: Vec<f32>,
}

impl CoverageMask {
    /// The coverage by everything within `radius` pixels of this one, for halos.
    pub fn grown(&self, radius: f32) -> Self {
        let border = radius.ceil() as usize;
        let (width, height) = (self.width + 2 * border, self.height + 2 * border);
        let mut values = vec![0.0f32; width * height];
        for (down, across, weight) in disk(radius, border) {
            for y in 0..self.height {
                let from = &self.values[y * self.width..][..self.width];
                let to = &mut values[(y + down) * width + across..][..self.width];
                for (to, from) in to.iter_mut().zip(from) {
                    *to = to.max(from * weight);
                }
            }
        }
        let border = border as i64;
        Self { left: self.left - border, top: self.top - border, width, height, values }
    }

    /// The same, turned counterclockwise by a quarter turn, with the top left corner at the same place.
    pub fn turned(&self) -> Self {
        let (width, height) = (self.height, self.width);
        let at = |index: usize| self.values[(index % width) * self.width + (self.width - 1 - index / width)];
        let values = (0..width * height).map(at).collect();
        Self { width, height, values, ..*self }
    }
}

/// The pixels of a disk with soft edges around the middle of a square: row, column and weight.
fn disk(radius: f32, border: usize) -> Vec<(usize, usize, f32)> {
    let side = 2 * border + 1;
    let one = |index: usize| {
        let (y, x) = (index / side, index % side);
        let [dx, dy] = [x, y].map(|place| place as f32 - border as f32);
        (y, x, (radius + 0.5 - (dx * dx + dy * dy).sqrt()).clamp(0.0, 1.0))
    };
    (0..side * side).map(one).filter(|(_, _, weight)| *weight > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halos_reach_around_a_mark() {
        let dot = CoverageMask { left: 5, top: 7, width: 1, height: 1, values: vec![1.0] };
        let grown = dot.grown(1.0);
        assert_eq!((grown.left, grown.top, grown.width, grown.height), (4, 6, 3, 3));
        assert_eq!(grown.values[4], 1.0);
        assert_eq!(grown.values[1], 0.5);
        assert!(grown.values[0] < 0.1);
    }

    #[test]
    fn turned_text_reads_upwards() {
        let row = CoverageMask { left: 1, top: 2, width: 3, height: 1, values: vec![0.1, 0.2, 0.3] };
        let turned = row.turned();
        assert_eq!((turned.width, turned.height, turned.values), (1, 3, vec![0.3, 0.2, 0.1]));
    }
}
