//! Procedural patterns: the fraction of their second texture at a point.

use super::footprint::contrast;
use super::noise::{fractal_noise, turbulence};
use crate::base::digest::Content;
use crate::base::math::{Angle, DVec3, gamma};

/// A pattern of two textures, in units of its own. A pattern that names only x and y does not depend on z.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub enum Pattern {
    /// Alternating unit cubes.
    Checker,
    /// Bands of width 1 along x.
    Stripes,
    /// Stripes shifted by a cosine: the bands of x + cos y.
    Waves,
    /// Round dots, two in every square of side 2π: where |cos x + sin y| is 1 or more.
    Dots,
    /// Islands and lakes: the bands of cos x + sin y.
    Islands,
    /// From the first texture at 0 to the second one at 1 along a unit vector.
    Gradient { axis: DVec3 },
    /// Clouds of about unit size. Each further octave has half the size and half the strength.
    Noise { octaves: u32, seed: u32 },
    /// Veins across x, one per unit. `turbulence` is their largest displacement in units.
    Marble { octaves: u32, seed: u32, turbulence: f64 },
}

impl Pattern {
    /// The fraction of the second texture at `point`, in 0..=1. Each coordinate is known within `error`. `seen` is the
    /// extent of the pixel's footprint along each axis. Details below that size fade to their mean.
    pub fn share(&self, point: DVec3, error: DVec3, seen: DVec3) -> f64 {
        if !point.is_finite() {
            return 0.0;
        }
        // Rounding of the cosines, sines and sums below.
        let rounding = gamma(4) * (point.x.abs() + 2.0);
        let slope = error.x + error.y + rounding;
        // Where coordinates are uncertain by a twentieth of a cell, cells fade as if they were small.
        let width = seen.max(error * UNCERTAIN);
        match *self {
            Self::Checker => {
                let odd = |i: usize| is_odd(cell(point[i], error[i]));
                let left = contrast(width.x) * contrast(width.y) * contrast(width.z);
                faded(odd(0) ^ odd(1) ^ odd(2), 0.5, left)
            }
            Self::Stripes => faded(is_odd(cell(point.x, error.x)), 0.5, contrast(width.x)),
            Self::Waves => {
                let along = point.x + libm::cos(point.y);
                faded(is_odd(cell(along, slope)), 0.5, contrast(width.x + width.y))
            }
            Self::Dots => {
                let inside = height(point).abs() + slope >= 1.0;
                faded(inside, DOTTED, contrast(width.x + width.y))
            }
            Self::Islands => faded(is_odd(cell(height(point), slope)), 0.5, contrast(width.x + width.y)),
            Self::Gradient { axis } => point.dot(axis).clamp(0.0, 1.0),
            Self::Noise { octaves, seed } => {
                (0.5 + 0.5 * fractal_noise(point, octaves, seed, width.max_element())).clamp(0.0, 1.0)
            }
            Self::Marble { octaves, seed, turbulence: strength } => {
                let vein = point.x + strength * turbulence(point, octaves, seed, width.max_element());
                // A vein and the gap to the next one are two cells.
                0.5 + 0.5 * contrast(2.0 * width.x) * Angle(360.0 * vein).cos_sin().y
            }
        }
    }
}

/// An uncertainty of a twentieth of a cell counts as a footprint of half a cell, from where contrast fades.
const UNCERTAIN: f64 = 10.0;

/// The whole number below a coordinate that is known within `bound`. A coordinate that may be a whole number counts as
/// one. So all points of a plane on the boundary of two cells lie in the same cell, whatever their rounding.
fn cell(coordinate: f64, bound: f64) -> f64 {
    (coordinate + bound).floor()
}

/// Whether a whole number is odd. Large ones are even, and infinities and NaN are not odd.
fn is_odd(cell: f64) -> bool {
    let half = 0.5 * cell;
    half.floor() < half
}

/// The height field of dots and islands.
fn height(point: DVec3) -> f64 {
    libm::cos(point.x) + libm::sin(point.y)
}

/// The fraction of the plane where |cos x + sin y| is 1 or more. At each x with cos x ≥ 0, the sum is 1 or more for the
/// fraction acos(1 - cos x) / π of all y. It is -1 or less as often, half a turn on. So the fraction is 2/π² times the
/// integral of acos(1 - cos x) from 0 to π/2.
const DOTTED: f64 = 0.369_563_058_864_799_4;

/// The fraction of the second texture in a cell of one of two kinds, faded by `contrast` to the mean over all cells.
fn faded(second: bool, mean: f64, contrast: f64) -> f64 {
    let lost = 1.0 - contrast;
    if second { 1.0 - (1.0 - mean) * lost } else { mean * lost }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    fn exact(pattern: Pattern, x: f64, y: f64, z: f64) -> f64 {
        pattern.share(DVec3::new(x, y, z), DVec3::ZERO, DVec3::ZERO)
    }

    #[test]
    fn cells_do_not_double_at_zero() {
        let stripes = [-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5].map(|x| exact(Pattern::Stripes, x, 0.0, 0.0));
        assert_eq!(stripes, [0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
        for (x, y, z) in [(0.5, 0.5, 0.5), (-0.5, -0.5, 0.5), (-0.5, 0.5, -0.5), (1.5, -0.5, 0.5)] {
            assert_eq!(exact(Pattern::Checker, x, y, z), 0.0);
            assert_eq!(exact(Pattern::Checker, x - 1.0, y, z), 1.0);
        }
    }

    #[test]
    fn curved_patterns_are_those_of_their_formulas() {
        let even = |value: f64| value.floor().rem_euclid(2.0);
        let mut random = Random(8);
        for _ in 0..10_000 {
            let p = random.point(30.0);
            assert_eq!(exact(Pattern::Waves, p.x, p.y, p.z), even(p.x + libm::cos(p.y)));
            let height = libm::cos(p.x) + libm::sin(p.y);
            assert_eq!(exact(Pattern::Islands, p.x, p.y, p.z), even(height));
            // With truncation towards zero, as for C integers, the values in -1..1 count as even.
            assert_eq!(exact(Pattern::Dots, p.x, p.y, p.z), (height.trunc() % 2.0).abs());
        }
        assert_eq!(exact(Pattern::Waves, 0.0, 0.0, 0.0), 1.0);
        assert_eq!(exact(Pattern::Dots, 0.0, 0.0, 0.0), 1.0);
        assert_eq!(exact(Pattern::Islands, 0.0, 0.0, 0.0), 1.0);
        // Here cos x + sin y is 1, up to rounding.
        let third = std::f64::consts::FRAC_PI_3;
        for k in [-5.0, -1.0, 1.0, 5.0, 7.0] {
            assert_eq!(exact(Pattern::Dots, k * third, third / 2.0, 0.0), 1.0);
            assert_eq!(exact(Pattern::Islands, k * third, third / 2.0, 0.0), 1.0);
        }
    }

    /// From far away, a pattern has the mean of its near values.
    #[test]
    fn patterns_fade_to_their_means() {
        for pattern in [Pattern::Checker, Pattern::Stripes, Pattern::Waves, Pattern::Dots, Pattern::Islands] {
            // Odd, so that no point lies on the straight coasts of islands.
            let side = 1001;
            // Whole periods: two cells, or a full turn of both functions.
            let step = if matches!(pattern, Pattern::Dots | Pattern::Islands) {
                std::f64::consts::TAU / f64::from(side)
            } else {
                2.0 / f64::from(side)
            };
            let points =
                (0..side).flat_map(|x| (0..side).map(move |y| (f64::from(x) + 0.5, f64::from(y) + 0.5)));
            let sum: f64 = points.map(|(x, y)| exact(pattern, x * step, y * step, 0.5)).sum();
            let far = pattern.share(DVec3::new(0.3, 0.4, 0.5), DVec3::ZERO, DVec3::splat(9.0));
            assert!((sum / f64::from(side * side) - far).abs() < 1e-3, "{pattern:?}: {far}");
        }
    }

    /// Dots are round and separate. On the line through their centres, the gaps are as wide as the dots.
    #[test]
    fn dots_stand_alone() {
        let dot = |x: f64, y: f64| exact(Pattern::Dots, x, y, 0.0) == 1.0;
        let quarter = std::f64::consts::FRAC_PI_2;
        assert!(dot(0.0, quarter) && dot(2.0 * quarter, -quarter), "on tops and in hollows");
        assert!(!dot(quarter, 0.0) && !dot(2.0 * quarter, quarter) && !dot(0.0, -quarter), "on slopes");
    }

    /// A checker of unit cubes, on a plane between two layers of cubes, shows only the squares of x and z.
    #[test]
    fn sh_17_a_plane_on_a_boundary_shows_one_layer_of_cells() {
        let mut random = Random(17);
        for height in [0.0, 2.0] {
            for error in [1e-16, 1e-15, 1e-14, 1e-13] {
                for _ in 0..10_000 {
                    let p = random.point(50.0);
                    let y = height + (2.0 * random.unit() - 1.0) * error;
                    let bound = DVec3::splat(error);
                    let seen = Pattern::Checker.share(DVec3::new(p.x, y, p.z), bound, DVec3::ZERO);
                    let flat = is_odd(cell(p.x, error)) ^ is_odd(cell(p.z, error));
                    assert_eq!(seen, faded(flat, 0.5, 1.0), "{p} at {y:e}");
                }
            }
        }
    }

    #[test]
    fn gradients_end_at_their_paints() {
        let gradient = Pattern::Gradient { axis: DVec3::Y };
        let got = [-1.0, 0.0, 0.25, 1.0, 2.0].map(|y| exact(gradient, 5.0, y, 5.0));
        assert_eq!(got, [0.0, 0.0, 0.25, 1.0, 1.0]);
    }

    #[test]
    fn shares_stay_within_0_and_1_wherever_the_point() {
        let noise = Pattern::Noise { octaves: 4, seed: 1 };
        let marble = Pattern::Marble { octaves: 4, seed: 1, turbulence: 3.0 };
        let cells = [Pattern::Checker, Pattern::Stripes, Pattern::Waves, Pattern::Dots, Pattern::Islands];
        let all = [&cells[..], &[noise, marble]].concat();
        let mut random = Random(5);
        let odd_points = [f64::NAN, f64::INFINITY, 1e300, -1e300, 1e17].map(DVec3::splat);
        let points: Vec<_> = (0..2000).map(|_| random.point(100.0)).chain(odd_points).collect();
        for point in points {
            for pattern in &all {
                let share = pattern.share(point, DVec3::splat(1e-12), random.point(2.0).abs());
                assert!((0.0..=1.0).contains(&share), "{pattern:?} at {point}: {share}");
            }
        }
    }

    #[test]
    fn quiet_marble_is_a_sine() {
        let marble = Pattern::Marble { octaves: 1, seed: 0, turbulence: 0.0 };
        assert_eq!([0.0, 0.25, 0.5, 0.75].map(|x| exact(marble, x, 7.3, 1.0)), [0.5, 1.0, 0.5, 0.0]);
    }
}
