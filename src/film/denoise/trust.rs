//! How much of what the filter changes is kept, by what the audits show.

use crate::base::color::Rgb;

/// Classes of changes by their squares. Each begins at four times the one before, and number 3 at the noise around a pixel.
const CLASSES: usize = 6;

/// The side of tiles in pixels. What is kept in a tile comes from tiles of the other colour of a chessboard, so it does not
/// depend on the audits' samples there, and the error that they show stays without bias.
const TILE: usize = 16;

/// Bytes per pixel of changes.
pub const BYTES_PER_PIXEL: u64 = size_of::<Change>() as u64;

/// What the filter changed at a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Change {
    /// The squared change, relative to the light of the pixel.
    moved: f32,
    /// The product of the change and the error that the audits show after it, likewise.
    wrong: f32,
    class: u8,
}

impl Change {
    /// The change from samples to filtered light. `noise` is the squared error of the samples around the pixel, relative to
    /// the light of the pixel. Squares are relative to it when they are multiplied by `unit`.
    pub fn new([samples, filtered]: [Rgb; 2], audits: [Rgb; 2], noise: f32, unit: f32) -> Self {
        let change = filtered - samples;
        let moved = unit * change.length_squared();
        let wrong = unit * change.dot(filtered - (audits[0] + audits[1]) * 0.5);
        if !(moved.is_finite() && wrong.is_finite() && moved > 0.0) {
            return Self::default();
        }
        let class = (moved / noise).log2() * 0.5 + 3.0;
        Self { moved, wrong, class: class.clamp(0.0, (CLASSES - 1) as f32) as u8 }
    }
}

/// The shares of samples in the picture, per colour of tiles and class of changes.
pub struct Trust([[f32; CLASSES]; 2]);

impl Trust {
    /// If the filtered light F and the samples M mix to F + w (M - F), the squared error is least where w is the mean of
    /// (F - M) (F - T) divided by that of (F - M)²; both relative to the light, as the choice of candidates is. The mean of
    /// the audits is the truth T with independent noise, which leaves the first mean as it is. It is reduced by how much it
    /// may be due to chance.
    pub fn new(width: usize, changes: &[Change]) -> Self {
        let mut sums = [[Sums::default(); CLASSES]; 2];
        for (pixel, change) in changes.iter().enumerate() {
            sums[1 - color(pixel, width)][usize::from(change.class)].add(change);
        }
        Self(sums.map(|sums| sums.map(|sums| sums.share())))
    }

    /// The share of samples at a pixel.
    pub fn samples(&self, pixel: usize, width: usize, change: &Change) -> f32 {
        // Light that overflows has no change that can be measured.
        if change.moved == 0.0 { 0.0 } else { self.0[color(pixel, width)][usize::from(change.class)] }
    }
}

/// The colour of a pixel's tile.
fn color(pixel: usize, width: usize) -> usize {
    (pixel % width / TILE + pixel / width / TILE) % 2
}

#[derive(Clone, Copy, Default)]
struct Sums {
    moved: f64,
    wrong: f64,
    squares: f64,
}

impl Sums {
    fn add(&mut self, change: &Change) {
        let wrong = f64::from(change.wrong);
        self.moved += f64::from(change.moved);
        self.wrong += wrong;
        self.squares += wrong * wrong;
    }

    /// The share of samples with the least error.
    fn share(&self) -> f32 {
        if self.wrong <= 0.0 {
            return 0.0;
        }
        let significant = (1.0 - self.squares / (self.wrong * self.wrong)).max(0.0);
        (significant * self.wrong / self.moved).min(1.0) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Changes by -1 of 4096 pixels of samples 2, where the truth has another value.
    fn share(truth: f32) -> f32 {
        let noise = |pixel: usize| if pixel.is_multiple_of(3) { 0.4 } else { -0.2 };
        let change = |pixel: usize| {
            let audits = [Rgb::splat(truth + noise(pixel)), Rgb::splat(truth - 0.5 * noise(pixel))];
            Change::new([Rgb::splat(2.0), Rgb::splat(1.0)], audits, 1.0, 1.0)
        };
        let changes: Vec<_> = (0..4096).map(change).collect();
        Trust::new(64, &changes).samples(100, 64, &changes[100])
    }

    #[test]
    fn samples_replace_what_is_wrong() {
        assert_eq!((share(1.0), share(0.0)), (0.0, 0.0));
        assert!((share(2.0) - 1.0).abs() < 0.01 && (share(1.5) - 0.5).abs() < 0.01);
        assert_eq!(share(4.0), 1.0);
    }

    #[test]
    fn a_single_pixel_shows_nothing() {
        let mut changes = vec![Change::default(); 4096];
        let [samples, filtered] = [9.0, 1.0].map(Rgb::splat);
        changes[0] = Change::new([samples, filtered], [samples; 2], 1.0, 1.0);
        let trust = Trust::new(64, &changes);
        assert!((0..4096).all(|pixel| trust.samples(pixel, 64, &changes[0]) == 0.0));
    }

    #[test]
    fn a_tile_does_not_decide_for_itself() {
        let wrong = |pixel: usize| match color(pixel, 64) {
            0 => Change::new([Rgb::ONE, Rgb::ZERO], [Rgb::ONE; 2], 1.0, 1.0),
            _ => Change::new([Rgb::ONE, Rgb::ZERO], [Rgb::ZERO; 2], 1.0, 1.0),
        };
        let changes: Vec<_> = (0..4096).map(wrong).collect();
        let trust = Trust::new(64, &changes);
        assert!(
            (0..4096)
                .all(|pixel| (trust.samples(pixel, 64, &changes[pixel]) > 0.9) == (color(pixel, 64) == 1))
        );
    }
}
