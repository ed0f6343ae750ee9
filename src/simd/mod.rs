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

/// A row of numbers. What compares with something that is not a number is false.
pub trait Numbers: Copy {
    type Scalar;
    type Row;

    fn splat(value: Self::Scalar) -> Self;
    fn load(values: &Self::Row) -> Self;
    fn store(self) -> Self::Row;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    fn over(self, other: Self) -> Self;
    /// The larger of each; `other` where one is not a number.
    fn larger(self, other: Self) -> Self;
    fn smaller(self, other: Self) -> Self;
    fn absolute(self) -> Self;
}

/// Four f64, computed with as scalars are: each operation rounded by itself, the same on every processor.
pub trait Quad: Numbers<Scalar = f64, Row = [f64; 4]> {
    /// A choice of lanes.
    type Mask: Copy;

    fn root(self) -> Self;
    fn negated(self) -> Self;
    /// These magnitudes with the signs of others.
    fn signed_like(self, signs: Self) -> Self;
    /// The largest powers of two that are not above the magnitudes of normal numbers.
    fn power_of_two(self) -> Self;
    /// [`crate::math::next_away`] of finite numbers; of others it may be no number.
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

/// Eight f32, for filters and colours. Comparisons give a bit per lane, lane 0 the lowest.
pub trait Lanes: Numbers<Scalar = f32, Row = [f32; 8]> {
    type Quad: Quad;

    /// self · factor + term, rounded once or twice.
    fn times_plus(self, factor: Self, term: Self) -> Self;
    /// self · factor - term, rounded once or twice.
    fn times_minus(self, factor: Self, term: Self) -> Self;
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

/// [`Lanes::fetch`] for work without lanes.
#[inline(always)]
pub fn fetch<T>(all: &[T], soon: usize) {
    #[cfg(target_arch = "x86_64")]
    x86::fetch(all, soon);
    #[cfg(not(target_arch = "x86_64"))]
    Portable::fetch(all, soon);
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

    /// All that quads can do, of two rows of numbers: numbers, and bits of choices.
    struct AllQuads([f64; 4], [f64; 4]);

    fn all_quads<Q: Quad>(a: Q, b: Q) -> (Vec<[f64; 4]>, Vec<u32>) {
        let (below, at_most) = (a.below(b), a.at_most(b));
        let numbers = [
            a.plus(b),
            a.minus(b),
            a.times(b),
            a.over(b),
            a.root(),
            a.negated(),
            a.absolute(),
            a.larger(b),
            a.smaller(b),
            a.signed_like(b),
            a.power_of_two(),
            a.pick(below, b),
            a.pick(Q::choose(0b0101), b),
        ];
        let mut rows: Vec<_> = numbers.map(Q::store).to_vec();
        rows.push(a.narrow().map(f64::from));
        let finite = a.absolute().below(Q::splat(f64::INFINITY));
        rows.push(a.next_away(b).pick(finite, a).store());
        let bits = [below, at_most, Q::both(below, at_most), Q::either(below, at_most), Q::choose(0b1010)];
        let mut bits = bits.map(Q::bits).to_vec();
        bits.push(a.signs());
        (rows, bits)
    }

    impl Work for AllQuads {
        type Output = (Vec<[f64; 4]>, Vec<u32>);

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            all_quads(L::Quad::load(&self.0), L::Quad::load(&self.1))
        }
    }

    #[test]
    fn levels_compute_the_same_in_f64() {
        let mut random = Random(6);
        let special = [
            0.0,
            -0.0,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
            f64::MAX,
            -1.0,
            1e-310,
            crate::math::NEAR_ZERO,
            -crate::math::NEAR_ZERO.next_up(),
        ];
        for round in 0..20_000 {
            let mut row = || {
                [0; 4].map(|_| match round % 2 {
                    0 => (random.unit() - 0.5) * 100.0,
                    _ => special[(random.unit() * special.len() as f64) as usize],
                })
            };
            let (a, b) = (row(), row());
            let (best, bits) = dispatch(AllQuads(a, b));
            let (plain, expected) = AllQuads(a, b).run::<Portable>();
            assert_eq!(bits, expected, "{a:?} {b:?}");
            // Of numbers that are none, no bits are promised.
            let known = |rows: Vec<[f64; 4]>| -> Vec<Option<u64>> {
                rows.iter().flatten().map(|v| (!v.is_nan()).then(|| v.to_bits())).collect()
            };
            assert_eq!(known(best), known(plain), "{a:?} {b:?}");
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
