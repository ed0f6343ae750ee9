//! Where another film of the same size sees the points that the pixels of a film see.

use super::super::memory::{Held, Memory};
use crate::base::math::DVec2;
use rayon::prelude::*;

/// Positions nearer to the centre of a pixel than this, in pixels, are the centre: where nothing moves, rounding must not
/// blur.
const CENTERED: f64 = 1e-3;

/// For each pixel of a film, the pixels of another film around the same point.
#[derive(Debug, PartialEq)]
#[warn(missing_docs)]
pub struct Reprojection {
    width: usize,
    taps: Held<Taps>,
    /// Whether any point is seen by the same pixel.
    pub(super) is_partly_still: bool,
}

/// Four pixels, weighted as in bilinear interpolation. Those that see something else have no weight; the weights of the
/// others add up to 1. All are 0 if the point is not seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taps {
    /// The column on the left and the row above. Those on the right and below follow, as far as there are any.
    pub column: u32,
    pub row: u32,
    /// Left and right in the upper row, then in the lower one.
    pub weights: [f32; 4],
    /// Whether the same pixel sees the point, at the same place.
    pub is_still: bool,
}

impl Taps {
    pub fn is_seen(&self) -> bool {
        self.weights != [0.0; 4]
    }

    /// The pixels that count, by their number in a picture of this width, and their weights. Others may hold any light, also an
    /// infinite one, and may be beyond the edge.
    #[inline(always)]
    pub fn pixels(&self, width: usize) -> impl Iterator<Item = (usize, f32)> {
        let first = self.row as usize * width + self.column as usize;
        let pixels = [first, first + 1, first + width, first + width + 1];
        pixels.into_iter().zip(self.weights).filter(|(_, weight)| *weight > 0.0)
    }
}

#[warn(missing_docs)]
impl Reprojection {
    pub(super) const BYTES_PER_PIXEL: u64 = size_of::<Taps>() as u64;

    /// `find` gives what a pixel sees, and the position at which the other film sees it, in pixels from the left and from
    /// the top: none if it is behind the other camera. `sees` decides whether a pixel of the other film sees that point.
    /// Pixels are counted row by row. It has its memory from `memory`.
    pub fn new<P>(
        memory: &Memory,
        size: (u32, u32),
        find: impl Fn(usize) -> Option<(DVec2, P)> + Sync,
        sees: impl Fn(usize, &P) -> bool + Sync,
    ) -> Self {
        let width = size.0 as usize;
        let mut taps = memory.unset::<Taps>(width * size.1 as usize);
        taps.par_chunks_exact_mut(width.max(1)).enumerate().for_each(|(y, row)| {
            for (x, taps) in row.iter_mut().enumerate() {
                *taps = Taps::default();
                if let Some((at, point)) = find(y * width + x)
                    && let Some(found) = taps_at(size, at, |pixel| sees(pixel, &point))
                {
                    let away = at - DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                    let is_still = away.abs().max_element() < CENTERED && found.weights[0] == 1.0;
                    *taps = Taps { is_still, ..found };
                }
            }
        });
        let is_partly_still = taps.iter().any(|taps| taps.is_still);
        Self { width, taps, is_partly_still }
    }

    /// The same without points that the same pixel sees at the same place.
    pub fn without_still(mut self) -> Self {
        self.taps.iter_mut().filter(|taps| taps.is_still).for_each(|taps| *taps = Taps::default());
        self.is_partly_still = false;
        self
    }

    /// Whether the point of a pixel is seen.
    pub fn sees(&self, [x, y]: [usize; 2]) -> bool {
        self.row(y)[x].is_seen()
    }

    /// The taps of the pixels of a row.
    pub(super) fn row(&self, y: usize) -> &[Taps] {
        &self.taps[y * self.width..][..self.width]
    }
}

/// The taps around a position. None outside of the picture.
fn taps_at((width, height): (u32, u32), at: DVec2, sees: impl Fn(usize) -> bool) -> Option<Taps> {
    let [(column, right), (row, below)] = [between(at.x, width)?, between(at.y, height)?];
    let mut weights = [0.0; 4];
    for (index, weight) in weights.iter_mut().enumerate() {
        let (is_below, is_right) = (index / 2, index % 2);
        let share = [1.0 - right, right][is_right] * [1.0 - below, below][is_below];
        let other = (row as usize + is_below) * width as usize + column as usize + is_right;
        if share > 0.0 && sees(other) {
            *weight = share as f32;
        }
    }
    let sum: f32 = weights.iter().sum();
    if sum > 0.0 {
        weights.iter_mut().for_each(|weight| *weight /= sum);
    }
    Some(Taps { column, row, weights, is_still: false })
}

/// The pixel before a position along an axis, and the weight of the pixel behind it, which is 0 if there is none.
fn between(at: f64, count: u32) -> Option<(u32, f64)> {
    if !(at >= 0.0 && at <= f64::from(count)) {
        return None;
    }
    // Half a pixel at each edge is nearest to the pixel there.
    let center = (at - 0.5).clamp(0.0, f64::from(count - 1));
    let nearest = f64::from((center + 0.5) as u32);
    let center = if (center - nearest).abs() < CENTERED { nearest } else { center };
    let before = center as u32;
    Some((before, center - f64::from(before)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taps(at: [f64; 2], hidden: Option<usize>) -> Option<Taps> {
        taps_at((4, 3), at.into(), |pixel| Some(pixel) != hidden)
    }

    #[test]
    fn taps_interpolate_between_centers() {
        let found = taps([2.0, 1.75], None).expect("inside");
        assert_eq!((found.column, found.row, found.weights), (1, 1, [0.375, 0.375, 0.125, 0.125]));
        let centered = taps([1.5 + 1e-9, 2.5], None).expect("inside");
        assert_eq!((centered.column, centered.row, centered.weights), (1, 2, [1.0, 0.0, 0.0, 0.0]));
        assert_eq!(taps([4.0, 0.0], None).expect("the corner").weights, [1.0, 0.0, 0.0, 0.0]);
        assert_eq!([taps([4.1, 1.0], None), taps([1.0, -0.1], None), taps([f64::NAN, 1.0], None)], [None; 3]);
    }

    #[test]
    fn hidden_pixels_have_no_weight() {
        let found = taps([2.0, 1.75], Some(5)).expect("inside");
        assert_eq!(found.weights, [0.0, 0.6, 0.2, 0.2]);
        let only = taps_at((4, 3), DVec2::new(2.0, 1.5), |pixel| pixel == 6).expect("inside");
        assert_eq!(only.weights, [0.0, 1.0, 0.0, 0.0]);
        assert!(!taps_at((4, 3), DVec2::new(2.0, 1.5), |_| false).expect("inside").is_seen());
    }

    #[test]
    fn pixels_that_see_the_same_are_still() {
        let shifted = |by: f64| {
            let find = |pixel: usize| {
                Some((DVec2::new((pixel % 4) as f64 + 0.5 + by, (pixel / 4) as f64 + 0.5), ()))
            };
            Reprojection::new(&Memory::default(), (4, 3), find, |_, ()| true)
        };
        assert!(shifted(0.0).taps.iter().all(|taps| taps.is_still));
        assert!(!shifted(1.0).is_partly_still && !shifted(0.25).is_partly_still);
        assert!(!shifted(9.0).row(2)[3].is_seen());
        assert!(!shifted(0.0).without_still().row(0)[0].is_seen());
        assert_eq!(shifted(0.25).without_still(), shifted(0.25));
    }
}
