//! Eight numbers at a time, on whatever the processor has.
//!
//! Filters compute in f32: what they decide differs between levels in what is tested again in f64, never in what is hit.
//! Whatever ends up in a picture is computed as scalars are, lane by lane. Code that works on lanes is generic over [`Lanes`], is inlined whole, and is run by
//! [`dispatch`] on the widest that the processor has.

mod octo;
mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use octo::{Choice, Octo, Rows, Vector};
pub use portable::Portable;

/// Four f64, computed with as scalars are: each operation rounded by itself, the same on every processor. Comparisons
/// are false for what is not a number.
pub trait Quad: Copy {
    /// A choice of lanes.
    type Mask: Copy;

    fn splat(value: f64) -> Self;
    fn load(values: &[f64; 4]) -> Self;
    fn store(self) -> [f64; 4];
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    fn over(self, other: Self) -> Self;
    fn root(self) -> Self;
    fn negated(self) -> Self;
    fn absolute(self) -> Self;
    /// The larger of each; `other` where `self` is not a number.
    fn larger(self, other: Self) -> Self;
    fn smaller(self, other: Self) -> Self;
    /// These magnitudes with the signs of others.
    fn signed_like(self, signs: Self) -> Self;
    /// The largest powers of two that are not above the magnitudes of normal numbers.
    fn power_of_two(self) -> Self;
    /// [`crate::math::next_away`].
    fn next_away(self, towards: Self) -> Self;
    /// These in the lanes of a choice, others elsewhere.
    fn pick(self, chosen: Self::Mask, other: Self) -> Self;
    /// A bit for each lane whose sign is negative, lane 0 the lowest.
    fn signs(self) -> u32;
    fn below(self, other: Self) -> Self::Mask;
    fn at_most(self, other: Self) -> Self::Mask;
    fn narrow(self) -> [f32; 4];
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// A bit for each chosen lane.
    fn bits(chosen: Self::Mask) -> u32;
    fn choose(bits: u32) -> Self::Mask;
}

/// Eight f32, for filters and colours. Comparisons give a bit per lane, lane 0 the lowest; they are false for what is not a
/// number.
pub trait Lanes: Copy {
    type Quad: Quad;

    fn splat(value: f32) -> Self;
    fn load(values: &[f32; 8]) -> Self;
    fn store(self) -> [f32; 8];
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    fn over(self, other: Self) -> Self;
    /// self · factor + term, rounded once or twice.
    fn times_plus(self, factor: Self, term: Self) -> Self;
    /// self · factor - term, rounded once or twice.
    fn times_minus(self, factor: Self, term: Self) -> Self;
    /// The larger of each; `other` where `self` is not a number.
    fn larger(self, other: Self) -> Self;
    fn smaller(self, other: Self) -> Self;
    fn absolute(self) -> Self;
    /// These in the lanes of `bits`, others elsewhere.
    fn pick(self, bits: u32, other: Self) -> Self;
    fn below(self, other: Self) -> u32;
    fn at_most(self, other: Self) -> u32;
    /// Does work on the same lanes, out of line: what comes before and after keeps its registers.
    fn apart<W: Work>(work: W) -> W::Output;
    /// Asks for the cache lines of an entry that will be needed soon. There need not be one.
    fn fetch<T>(all: &[T], soon: usize);
}

/// Work that is done with lanes of any kind.
pub trait Work {
    type Output;

    /// Does it. Implementations are `#[inline(always)]`, so that they are compiled for each level.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// Does the work on the widest lanes that the processor has.
#[inline]
pub fn dispatch<W: Work>(work: W) -> W::Output {
    #[cfg(test)]
    if tests::PORTABLE.get() {
        return work.run::<Portable>();
    }
    #[cfg(target_arch = "x86_64")]
    if x86::is_there() {
        return x86::run(work);
    }
    work.run::<Portable>()
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::testing::Random;
    use std::cell::Cell;

    thread_local! {
        /// Whether this thread does without what its processor has.
        pub static PORTABLE: Cell<bool> = const { Cell::new(false) };
    }

    /// What a computation gives without what the processor has.
    pub fn portably<T>(compute: impl FnOnce() -> T) -> T {
        PORTABLE.set(true);
        let result = compute();
        PORTABLE.set(false);
        result
    }

    /// All that lanes can do, of two rows of numbers.
    struct All([f32; 8], [f32; 8]);

    impl Work for All {
        type Output = ([[f32; 8]; 9], [u32; 2]);

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let (a, b) = (L::load(&self.0), L::load(&self.1));
            let numbers = [
                a.plus(b),
                a.minus(b),
                a.times(b),
                a.over(b),
                a.larger(b),
                a.smaller(b),
                a.absolute(),
                L::splat(self.0[3]),
                a.times_minus(b, a),
            ];
            (numbers.map(L::store), [a.below(b), a.at_most(b)])
        }
    }

    #[test]
    fn levels_compute_the_same() {
        let mut random = Random(5);
        let special = [0.0, -0.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, f32::MAX, 1.0, 1e-40];
        for round in 0..2000 {
            let mut row = || {
                [0; 8].map(|_| match round % 2 {
                    0 => (random.unit() - 0.5) as f32 * 100.0,
                    _ => special[(random.unit() * 8.0) as usize],
                })
            };
            let (a, b) = (row(), row());
            let (best, masks) = dispatch(All(a, b));
            let (plain, expected) = All(a, b).run::<Portable>();
            assert_eq!(masks, expected, "{a:?} {b:?}");
            for (best, plain) in best.into_iter().zip(plain).take(8) {
                assert_eq!(best.map(f32::to_bits), plain.map(f32::to_bits), "{a:?} {b:?}");
            }
            for lane in 0..8 {
                let bound = 2.0 * f32::EPSILON * (a[lane] * b[lane]).abs().max(a[lane].abs());
                let off = (best[8][lane] - plain[8][lane]).abs();
                assert!(off <= bound || !bound.is_finite() || !off.is_finite(), "{a:?} {b:?}");
            }
        }
    }
}
