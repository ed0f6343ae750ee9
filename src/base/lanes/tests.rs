//! All levels give the results of one lane.

use super::*;
use crate::base::math::NEAR_ZERO;
use crate::testing::Random;
use std::cell::Cell;

thread_local! {
    /// The level on which kernels of this thread run; none for the best level.
    pub static FORCED: Cell<Option<LevelName>> = const { Cell::new(None) };
}

/// The results of a computation on this thread, on each level of the processor.
pub fn on_all_levels<T>(mut compute: impl FnMut() -> T) -> Vec<(LevelName, T)> {
    let before = FORCED.get();
    let levels = LevelName::ALL.into_iter().filter(|level| level.is_available());
    let results = levels.map(|level| {
        FORCED.set(Some(level));
        (level, compute())
    });
    let results = results.collect();
    FORCED.set(before);
    results
}

/// Results as f64, f32, u32 and bits of masks.
type Results = (Vec<f64>, Vec<f32>, Vec<u32>, Vec<bool>);

/// The results of all operations, lane by lane.
fn everything<F: Real>(a: F, b: F) -> Results {
    let (less, below) = (a.lt(b), b.to_f32().lt(a.to_f32()));
    let reals = [
        a + b,
        a - b,
        a * b,
        a / b,
        -a,
        a.sqrt(),
        a.abs(),
        a.floor(),
        a.max(b),
        a.min(b),
        a.copysign(b),
        a.power_of_two(),
        a.floor().max(F::splat(-1022.0)).min(F::splat(1023.0)).exp2_whole(),
        F::select(a.abs().lt(F::splat(f64::INFINITY)), a.next_away(b), a),
        F::select(less | a.eq(b), a, b),
        a.to_f32().to_f64(),
        a.map(|x| x * 0.5),
        F::splat(2.5),
    ];
    let (s, t) = (a.to_f32(), b.to_f32());
    let singles = [
        s + t,
        s - t,
        s * t,
        s / t,
        -s,
        s.sqrt(),
        s.abs(),
        s.max(t),
        s.min(t),
        F::F32::select(less, s, t),
        F::F32::splat(1.5),
    ];
    let (n, m) = {
        let small = |x: F| F::select(x.abs().lt(F::splat(1e9)), x.abs(), F::splat(7.0)).to_u32();
        (small(a), small(b))
    };
    let (n, m) = (n.wrapping_mul(F::U32::splat(0x9e37_79b9)), m.wrapping_add(F::U32::splat(0xffff_fff0)));
    let whole = [
        n,
        m,
        n.wrapping_add(m),
        n.wrapping_mul(m),
        n.and(m),
        n.or(m),
        n.xor(m),
        n.shl::<5>(),
        n.shr::<9>(),
        n.reverse_bits(),
        F::U32::select(n.lt(m), n, m),
    ];
    let masks = [
        less,
        a.le(b),
        a.eq(b),
        a.gt(b),
        a.is_negative(),
        below,
        s.le(t),
        n.eq(m),
        n.lt(m),
        !(less & below),
        less | below,
        F::Mask::from_bits(0b1010_0101),
        F::Mask::splat(true),
    ];
    let mut results: Results = Default::default();
    for lane in 0..F::LANES {
        results.0.extend(reals.iter().map(|row| row.to_array()[lane]));
        results.0.extend([n.to_f64().to_array()[lane]]);
        results.1.extend(singles.iter().map(|row| row.to_array()[lane]));
        results.2.extend(whole.iter().map(|row| row.to_array()[lane]));
        results.3.extend(masks.iter().map(|mask| mask.bits() >> lane & 1 == 1));
        assert_eq!(s.lt_bits(t), s.lt(t).bits());
        assert_eq!(s.le_bits(t), s.le(t).bits());
    }
    results
}

struct Everything([f64; 8], [f64; 8]);

impl SimdKernel for Everything {
    type Output = Results;

    #[inline(always)]
    fn run<L: Level>(self) -> Results {
        everything(L::F64::from_array(self.0), L::F64::from_array(self.1))
    }
}

/// The bits of numbers. The bits of NaN are not specified.
fn bits(values: &[f64]) -> Vec<Option<u64>> {
    values.iter().map(|value| (!value.is_nan()).then(|| value.to_bits())).collect()
}

fn single_bits(values: &[f32]) -> Vec<Option<u32>> {
    values.iter().map(|value| (!value.is_nan()).then(|| value.to_bits())).collect()
}

#[test]
fn all_levels_compute_what_one_lane_does() {
    let special = [
        0.0,
        -0.0,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        f64::MAX,
        1.0,
        -1.0,
        1e-310,
        1e-40,
        NEAR_ZERO,
        -NEAR_ZERO.next_up(),
        3.5e8,
    ];
    let mut random = Random(6);
    for round in 0..5000 {
        let mut row = || {
            [0; 8].map(|_| match round % 2 {
                0 => (random.unit() - 0.5) * 1000.0,
                _ => special[(random.unit() * special.len() as f64) as usize],
            })
        };
        let (a, b) = (row(), row());
        let mut expected: Results = Default::default();
        for lane in 0..8 {
            let (reals, singles, whole, masks) = everything(a[lane], b[lane]);
            expected.0.extend(reals);
            expected.1.extend(singles);
            expected.2.extend(whole);
            expected.3.extend(masks);
            // The mask from bits differs between lanes.
            let from_bits = expected.3.len() - 2;
            expected.3[from_bits] = 0b1010_0101 >> lane & 1 == 1;
        }
        for (level, found) in on_all_levels(|| dispatch(Everything(a, b))) {
            assert_eq!(bits(&found.0), bits(&expected.0), "{level:?}: {a:?} {b:?}");
            assert_eq!(single_bits(&found.1), single_bits(&expected.1), "{level:?}: {a:?} {b:?}");
            assert_eq!((&found.2, &found.3), (&expected.2, &expected.3), "{level:?}: {a:?} {b:?}");
        }
    }
}

struct Memory<'a> {
    from: &'a [f64],
    at: Lookup,
    bits: u32,
}

impl SimdKernel for Memory<'_> {
    type Output = ([f64; 8], Vec<f64>, Vec<f32>, Vec<u32>);

    #[inline(always)]
    fn run<L: Level>(self) -> Self::Output {
        let row = L::F64::gather(self.from, &self.at);
        let mask = L::Mask::from_bits(self.bits);
        let (mut doubles, mut singles, mut whole) = (vec![0.0; 24], vec![0.0; 24], vec![0; 24]);
        row.compress(mask, &mut doubles, 3);
        row.to_f32().compress(mask, &mut singles, 4);
        row.to_u32().compress(mask, &mut whole, 5);
        row.store(&mut doubles, 14);
        assert_eq!(L::F64::load(&doubles, 14).to_array(), row.to_array());
        let count = self.bits.count_ones() as usize;
        doubles.truncate(3 + count);
        singles.truncate(4 + count);
        whole.truncate(5 + count);
        (row.to_array(), doubles, singles, whole)
    }
}

#[test]
fn lanes_come_from_memory_and_go_there_in_their_order() {
    let from: Vec<f64> = (0..40).map(f64::from).collect();
    let mut random = Random(7);
    for bits in 0..256 {
        let scattered: [u32; 8] = std::array::from_fn(|_| (random.unit() * 40.0) as u32);
        let run = Lookup::run(bits % 30, 1 + bits as usize % 8);
        let (count, mut ascending) = (1 + bits as usize % 8, scattered.to_vec());
        ascending.sort_unstable();
        ascending.dedup();
        let ascending = Lookup::ascending(&ascending[..count.min(ascending.len())]);
        for at in [Lookup::new(&scattered), Lookup::new(&scattered[..count]), ascending, run] {
            let gathered: [f64; 8] = std::array::from_fn(|lane| from[at.lane(lane) as usize]);
            let chosen: Vec<f64> = lanes(bits).map(|lane| gathered[lane]).collect();
            for (level, (row, doubles, singles, whole)) in
                on_all_levels(|| dispatch(Memory { from: &from, at, bits }))
            {
                assert_eq!(row, gathered, "{level:?}");
                assert_eq!(doubles[3..], chosen, "{level:?} {bits:b}");
                assert_eq!(singles[4..], chosen.iter().map(|x| *x as f32).collect::<Vec<_>>());
                assert_eq!(whole[5..], chosen.iter().map(|x| *x as u32).collect::<Vec<_>>());
            }
        }
    }
}

#[test]
fn rows_are_transposed() {
    struct Transpose<'a>(&'a [f32; 64]);
    impl SimdKernel for Transpose<'_> {
        type Output = [[f32; 8]; 8];

        #[inline(always)]
        fn run<L: Level>(self) -> [[f32; 8]; 8] {
            let mut rows = [L::F32::splat(0.0); 8];
            for (number, row) in rows.iter_mut().enumerate() {
                *row = L::F32::load(self.0, 8 * number);
            }
            let mut transposed = [[0.0; 8]; 8];
            for (row, into) in L::transpose(rows).into_iter().zip(&mut transposed) {
                *into = row.to_array();
            }
            transposed
        }
    }
    let numbers: [f32; 64] = std::array::from_fn(|number| number as f32);
    for (level, rows) in on_all_levels(|| dispatch(Transpose(&numbers))) {
        for (lane, row) in rows.iter().enumerate() {
            assert_eq!(*row, std::array::from_fn(|number| numbers[8 * number + lane]), "{level:?}");
        }
    }
}

#[test]
fn filters_may_fuse_but_not_more() {
    struct Fused(f32, f32);
    impl SimdKernel for Fused {
        type Output = [f32; 2];

        #[inline(always)]
        fn run<L: Level>(self) -> [f32; 2] {
            let (a, b) = (L::F32::splat(self.0), L::F32::splat(self.1));
            [a.mul_add(b, a).to_array()[3], a.mul_sub(b, a).to_array()[5]]
        }
    }
    let mut random = Random(8);
    for _ in 0..1000 {
        let (a, b) = ((random.unit() - 0.5) as f32 * 100.0, (random.unit() - 0.5) as f32 * 100.0);
        for (level, [sum, difference]) in on_all_levels(|| dispatch(Fused(a, b))) {
            let bound = 2.0 * f32::EPSILON * (a * b).abs().max(a.abs());
            assert!((sum - (a * b + a)).abs() <= bound, "{level:?}");
            assert!((difference - (a * b - a)).abs() <= bound, "{level:?}");
        }
    }
}
