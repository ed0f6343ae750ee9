//! How much of what the filter changes is kept, by what the audits show.

use super::planes::Planes;
use crate::base::lanes::{Color, Single};

/// Classes of changes by their squares. Each begins at four times the one before, and number 3 at the noise around a
/// pixel.
const CLASSES: usize = 6;

/// The side of tiles in pixels. What is kept in a tile comes from tiles of the other colour of a chessboard, so it does
/// not depend on the audits' samples there, and the error that they show stays without bias.
const TILE: usize = 16;

/// The numbers of a change: planes of a picture.
pub const NUMBERS: usize = 3;

/// What the filter changed at pixels, a lane each.
#[derive(Clone, Copy, Debug)]
pub struct Change<S> {
    /// The squared change, relative to the light of the pixel; 0 if it cannot be measured.
    moved: S,
    /// The product of the change and the error that the audits show after it, likewise.
    wrong: S,
    /// The class of the change.
    class: S,
}

impl<S: Single> Change<S> {
    /// The change from samples to filtered light. `noise` is the squared error of the samples around the pixel,
    /// relative to the light of the pixel. Squares are relative to it when they are multiplied by `unit`.
    #[inline(always)]
    pub fn new([samples, filtered]: [Color<S>; 2], audits: [Color<S>; 2], noise: S, unit: S) -> Self {
        let (zero, infinite) = (S::splat(0.0), S::splat(f32::INFINITY));
        let change = filtered - samples;
        let moved = unit * change.length_squared();
        let wrong = unit * change.dot(filtered - (audits[0] + audits[1]) * S::splat(0.5));
        let is_measured = zero.lt(moved) & moved.lt(infinite) & wrong.abs().lt(infinite);
        let (mut class, mut begin) = (zero, noise * S::splat(1.0 / 16.0));
        for _ in 1..CLASSES {
            class = class + S::select(begin.le(moved), S::splat(1.0), zero);
            begin = begin * S::splat(4.0);
        }
        let [moved, wrong, class] = [
            S::select(is_measured, moved, zero),
            S::select(is_measured, wrong, zero),
            S::select(is_measured, class, zero),
        ];
        Self { moved, wrong, class }
    }

    /// Stores changes from pixel `x` on in a row of planes.
    #[inline(always)]
    pub fn store(self, line: &mut [f32], x: usize) {
        let stride = line.len() / NUMBERS;
        self.moved.store(line, x);
        self.wrong.store(line, stride + x);
        self.class.store(line, 2 * stride + x);
    }
}

/// The shares of samples in the picture, per colour of tiles and class of changes.
pub struct Trust([[f32; CLASSES]; 2]);

impl Trust {
    /// If the filtered light F and the samples M mix to F + w (M - F), the squared error is least where w is the mean
    /// of (F - M) (F - T) divided by that of (F - M)²; both relative to the light, as the choice of candidates is. The
    /// mean of the audits is the truth T with independent noise, which leaves the first mean as it is. It is reduced by
    /// how much it may be due to chance.
    pub fn new(changes: &Planes) -> Self {
        let mut sums = [[Sums::default(); CLASSES]; 2];
        for y in 0..changes.height {
            let [moved, wrong, classes] = changes.channels(0, y);
            for (x, class) in classes.iter().enumerate().take(changes.width) {
                sums[1 - color(x, y)][*class as usize].add(moved[x], wrong[x]);
            }
        }
        Self(sums.map(|sums| sums.map(|sums| sums.share())))
    }

    /// The share of samples at each pixel of a row.
    pub fn samples(&self, y: usize, changes: &Planes) -> Vec<f32> {
        let [moved, _, classes] = changes.channels(0, y);
        let pixels = moved.iter().zip(classes).enumerate();
        // Light that overflows has no change that can be measured.
        let share = |(x, (moved, class)): (usize, (&f32, &f32))| match *moved > 0.0 {
            true => self.0[color(x, y)][*class as usize],
            false => 0.0,
        };
        pixels.map(share).collect()
    }
}

/// The colour of a pixel's tile.
fn color(x: usize, y: usize) -> usize {
    (x / TILE + y / TILE) % 2
}

#[derive(Clone, Copy, Default)]
struct Sums {
    moved: f64,
    wrong: f64,
    squares: f64,
}

impl Sums {
    fn add(&mut self, moved: f32, wrong: f32) {
        let wrong = f64::from(wrong);
        self.moved += f64::from(moved);
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
    use super::super::memory::Memory;
    use super::*;
    use crate::base::color::Rgb;
    use rayon::prelude::*;

    /// The changes of 64 x 64 pixels.
    fn changes(change: impl Fn(usize, usize) -> Change<f32> + Sync) -> Planes {
        let mut changes = Planes::zeros(&Memory::default(), (64, 64), NUMBERS);
        let lines = changes.par_lines_mut().enumerate();
        lines.for_each(|(y, line)| (0..64).for_each(|x| change(x, y).store(line, x)));
        changes
    }

    fn change(of: [Rgb; 2], audits: [Rgb; 2]) -> Change<f32> {
        Change::new(of.map(Color::from), audits.map(Color::from), 1.0, 1.0)
    }

    /// The share of samples where changes of 2 by -1 were made, and the truth has another value.
    fn share(truth: f32) -> f32 {
        let noise = |pixel: usize| if pixel.is_multiple_of(3) { 0.4 } else { -0.2 };
        let changes = changes(|x, y| {
            let noise = noise(64 * y + x);
            let audits = [Rgb::splat(truth + noise), Rgb::splat(truth - 0.5 * noise)];
            change([Rgb::splat(2.0), Rgb::splat(1.0)], audits)
        });
        Trust::new(&changes).samples(1, &changes)[36]
    }

    #[test]
    fn samples_replace_what_is_wrong() {
        assert_eq!((share(1.0), share(0.0)), (0.0, 0.0));
        assert!((share(2.0) - 1.0).abs() < 0.01 && (share(1.5) - 0.5).abs() < 0.01);
        assert_eq!(share(4.0), 1.0);
    }

    #[test]
    fn a_single_pixel_shows_nothing() {
        let [samples, filtered] = [9.0, 1.0].map(Rgb::splat);
        let nothing = [Rgb::ONE; 2];
        let changes = changes(|x, y| match (x, y) {
            (0, 0) => change([samples, filtered], [samples; 2]),
            _ => change(nothing, nothing),
        });
        let trust = Trust::new(&changes);
        assert!(trust.0.as_flattened().iter().all(|share| *share == 0.0));
        assert!((0..64).flat_map(|y| trust.samples(y, &changes)).all(|share| share == 0.0));
    }

    #[test]
    fn a_tile_does_not_decide_for_itself() {
        let changes = changes(|x, y| match color(x, y) {
            0 => change([Rgb::ONE, Rgb::ZERO], [Rgb::ONE; 2]),
            _ => change([Rgb::ONE, Rgb::ZERO], [Rgb::ZERO; 2]),
        });
        let trust = Trust::new(&changes);
        for y in 0..64 {
            let shares = trust.samples(y, &changes);
            assert!(shares.iter().enumerate().all(|(x, share)| (*share > 0.9) == (color(x, y) == 1)));
        }
    }

    /// Class 3 begins at the noise, and each one at four times the one before.
    #[test]
    fn classes_begin_at_powers_of_four() {
        for (moved, class) in [
            (0.0, 0.0),
            (0.06, 0.0),
            (0.0625, 1.0),
            (0.24, 1.0),
            (0.25, 2.0),
            (1.0, 3.0),
            (3.9, 3.0),
            (16.0, 5.0),
            (1e9, 5.0),
        ] {
            let filtered = Color { r: f32::sqrt(moved), g: 0.0, b: 0.0 };
            assert_eq!(
                Change::new([Color::black(), filtered], [filtered; 2], 1.0, 1.0).class,
                class,
                "{moved}"
            );
        }
    }
}
