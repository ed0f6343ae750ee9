//! The pixels that change from one frame to the next.

/// A rectangle of pixels. It is never empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    pub left: usize,
    pub top: usize,
    pub width: usize,
    pub height: usize,
}

impl PixelRect {
    /// The rows of this rectangle in a picture that is `stride` pixels wide.
    pub fn rows<'a, T>(&self, picture: &'a [T], stride: usize) -> impl Iterator<Item = &'a [T]> + use<'a, T> {
        let Self { left, top, width, height } = *self;
        picture.chunks_exact(stride).skip(top).take(height).map(move |row| &row[left..left + width])
    }
}

/// The smallest rectangle that contains every difference of two pictures of the same size, both `stride` pixels wide.
/// `None` if they are equal.
pub fn changed<T: PartialEq>(old: &[T], new: &[T], stride: usize) -> Option<PixelRect> {
    let rows = || old.chunks_exact(stride).zip(new.chunks_exact(stride));
    let top = rows().position(|(old, new)| old != new)?;
    let bottom = rows().rposition(|(old, new)| old != new)?;
    let (mut left, mut right) = (stride, 0);
    for (old, new) in rows().take(bottom + 1).skip(top) {
        let differs = |x: &usize| old[*x] != new[*x];
        left = (0..left).find(differs).unwrap_or(left);
        right = (right..stride).rev().find(differs).unwrap_or(right);
    }
    Some(PixelRect { left, top, width: right + 1 - left, height: bottom + 1 - top })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_pictures_have_none() {
        assert_eq!(changed(&[1; 12], &[1; 12], 4), None);
    }

    #[test]
    fn the_smallest_rectangle() {
        let side = 6;
        for a in 0..side * side {
            for b in 0..side * side {
                let mut new = vec![0; side * side];
                new[a] = 1;
                new[b] = 2;
                let (ax, ay, bx, by) = (a % side, a / side, b % side, b / side);
                let expected = PixelRect {
                    left: ax.min(bx),
                    top: ay.min(by),
                    width: ax.abs_diff(bx) + 1,
                    height: ay.abs_diff(by) + 1,
                };
                assert_eq!(changed(&vec![0; side * side], &new, side), Some(expected));
            }
        }
    }

    #[test]
    fn rows_cut_the_rectangle_out() {
        let picture: Vec<u8> = (0..12).collect();
        let rectangle = PixelRect { left: 1, top: 1, width: 2, height: 2 };
        let rows: Vec<_> = rectangle.rows(&picture, 4).collect();
        assert_eq!(rows, [[5, 6], [9, 10]]);
    }
}
