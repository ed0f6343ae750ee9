//! Images with alpha, such as logos.

use super::coverage::CoverageMask;
use crate::base::digest::{Content, Digest, Digester};
use std::fmt;
use std::sync::Arc;

/// Codes of red, green, blue and alpha, not premultiplied, in rows from the top. At least one pixel.
#[derive(Clone)]
pub struct Bitmap(Arc<Pixels>);

struct Pixels {
    width: usize,
    height: usize,
    rgba: Vec<[u8; 4]>,
    digest: Digest,
}

impl Bitmap {
    /// None if the number of pixels differs, or is 0.
    pub fn new(width: usize, height: usize, rgba: Vec<[u8; 4]>) -> Option<Self> {
        let fits = width > 0 && height > 0 && rgba.len() == width * height;
        let digest = Digest::of(&(width, rgba.as_flattened().to_vec()));
        fits.then(|| Self(Arc::new(Pixels { width, height, rgba, digest })))
    }

    /// Width divided by height.
    pub fn aspect(&self) -> f64 {
        self.0.width as f64 / self.0.height as f64
    }

    /// The image in a rectangle, left, top, width and height, as colours in 0..=1 and their coverage, where it lies in a
    /// picture of a size. Each pixel is the mean of the part of the image that it shows.
    pub(super) fn scaled(
        &self,
        [left, top, width, height]: [f64; 4],
        size: (u32, u32),
    ) -> (CoverageMask, Vec<[f64; 3]>) {
        let (left, columns) = shares([left, width], self.0.width, size.0);
        let (top, rows) = shares([top, height], self.0.height, size.1);
        let mut values = Vec::with_capacity(rows.len() * columns.len());
        let mut colors = Vec::with_capacity(rows.len() * columns.len());
        for row in &rows {
            for column in &columns {
                let (mut sum, mut alpha) = ([0.0; 3], 0.0);
                for &(y, down) in row {
                    for &(x, across) in column {
                        let [r, g, b, a] =
                            self.0.rgba[y * self.0.width + x].map(|code| f64::from(code) / 255.0);
                        let weight = down * across * a;
                        alpha += weight;
                        sum = [sum[0] + r * weight, sum[1] + g * weight, sum[2] + b * weight];
                    }
                }
                values.push(alpha.min(1.0) as f32);
                colors.push(if alpha > 0.0 { sum.map(|part| (part / alpha).min(1.0)) } else { sum });
            }
        }
        (CoverageMask { left, top, width: columns.len(), height: rows.len(), values }, colors)
    }
}

/// For each pixel of the picture along one side of a rectangle, the image's pixels that it shows, with the part of the
/// pixel that each one fills. The first result is the first pixel.
fn shares([start, length]: [f64; 2], count: usize, size: u32) -> (i64, Vec<Vec<(usize, f64)>>) {
    let first = start.floor().max(0.0);
    let last = (start + length).ceil().min(size.into());
    let scale = length / count as f64;
    let pixel = |index: usize| {
        let edge = first + index as f64;
        let low = (((edge - start) / scale).floor().max(0.0) as usize).min(count);
        let high = (((edge + 1.0 - start) / scale).ceil().max(0.0) as usize).min(count);
        let part = |at: usize| {
            let (from, to) = (start + at as f64 * scale, start + (at + 1) as f64 * scale);
            (at, (to.min(edge + 1.0) - from.max(edge)).max(0.0))
        };
        (low..high).map(part).filter(|(_, part)| *part > 0.0).collect()
    };
    (first as i64, (0..(last - first).max(0.0) as usize).map(pixel).collect())
}

impl PartialEq for Bitmap {
    fn eq(&self, other: &Self) -> bool {
        self.0.digest == other.0.digest
    }
}

impl fmt::Debug for Bitmap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Bitmap").field(&self.0.digest).finish()
    }
}

impl Content for Bitmap {
    fn feed(&self, into: &mut Digester) {
        self.0.digest.feed(into);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_fill_their_rectangle() {
        let image = Bitmap::new(2, 1, vec![[255, 0, 0, 255], [0, 0, 255, 0]]).expect("an image");
        let (coverage, colors) = image.scaled([1.5, 2.0, 4.0, 2.0], (100, 100));
        assert_eq!((coverage.left, coverage.top, coverage.width, coverage.height), (1, 2, 5, 2));
        assert_eq!(coverage.values[..5], [0.5, 1.0, 0.5, 0.0, 0.0]);
        assert_eq!(colors[1], [1.0, 0.0, 0.0]);
        assert!(Bitmap::new(2, 2, vec![[0; 4]]).is_none());
    }

    #[test]
    fn only_pixels_of_the_picture_are_made() {
        let image = Bitmap::new(1, 1, vec![[255; 4]]).expect("an image");
        let (coverage, _) = image.scaled([-1e9, 8.5, 2e9, 1e9], (20, 10));
        assert_eq!((coverage.left, coverage.top, coverage.width, coverage.height), (0, 8, 20, 2));
        assert_eq!((coverage.values[0], coverage.values[20]), (0.5, 1.0));
        assert!(image.scaled([30.0, 0.0, 5.0, 5.0], (20, 10)).1.is_empty());
    }

    #[test]
    fn small_images_show_means() {
        let image =
            Bitmap::new(2, 2, vec![[0, 0, 0, 255], [255; 4], [255; 4], [0, 0, 0, 255]]).expect("an image");
        let (coverage, colors) = image.scaled([0.0, 0.0, 1.0, 1.0], (100, 100));
        assert_eq!((coverage.values, colors), (vec![1.0], vec![[0.5; 3]]));
    }
}
