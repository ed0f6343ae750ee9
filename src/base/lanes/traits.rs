//! The operations of lanes, and the levels that have them.

use super::lookup::Lookup;
use std::ops::{Add, BitAnd, BitOr, Div, Index, IndexMut, Mul, Neg, Not, Sub};

/// A set of lanes.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    fn splat(value: bool) -> Self;
    /// The lanes whose bits are set. The lowest bit is lane 0.
    fn from_bits(bits: u32) -> Self;
    /// One bit per lane of the set; all other bits are 0.
    fn bits(self) -> u32;

    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// Values that can be selected lane by lane.
pub trait Select<M>: Copy {
    /// `yes` in the lanes of `mask`, `no` elsewhere.
    fn select(mask: M, yes: Self, no: Self) -> Self;
}

/// A row: one number per lane. These operations move rows from and to memory.
pub trait Row: Select<Self::Mask> {
    type Scalar: Copy + Default;
    type Mask: Mask;
    type Array: Copy + Index<usize, Output = Self::Scalar> + IndexMut<usize>;
    const LANES: usize;

    fn splat(value: Self::Scalar) -> Self;
    fn from_array(lanes: Self::Array) -> Self;
    fn to_array(self) -> Self::Array;
    /// Loads consecutive numbers from index `at` on.
    fn load(from: &[Self::Scalar], at: usize) -> Self;
    fn store(self, into: &mut [Self::Scalar], at: usize);
    fn gather(from: &[Self::Scalar], at: &Lookup) -> Self;
    /// Stores the lanes of `mask` consecutively from index `at` on. It may overwrite [`Row::LANES`] entries from `at`
    /// on.
    fn compress(self, mask: Self::Mask, into: &mut [Self::Scalar], at: usize);
}

/// Rows of f64. Each operation is rounded once.
pub trait Real:
    Row<Scalar = f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    type Level: Level;
    type F32: Single<Mask = Self::Mask, F64 = Self>;
    type U32: Bits<Mask = Self::Mask, F64 = Self>;

    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn floor(self) -> Self;
    /// The larger of each; `other` if one is not a number.
    fn max(self, other: Self) -> Self;
    /// The smaller of each; `other` if one is not a number.
    fn min(self, other: Self) -> Self;
    /// This magnitude with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// The largest power of two that does not exceed the magnitude of a normal number.
    fn power_of_two(self) -> Self;
    /// 2 to the power of this integer, which is in -1022..=1023.
    fn exp2_whole(self) -> Self;
    /// [`next_away`](super::next_away) of finite numbers. For others it may be NaN.
    fn next_away(self, towards: Self) -> Self;
    /// Comparisons with NaN are false.
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    fn eq(self, other: Self) -> Self::Mask;
    /// Whether the sign bit is set.
    fn is_negative(self) -> Self::Mask;
    fn to_f32(self) -> Self::F32;
    /// The integer part of numbers from 0 to below 2^31.
    fn to_u32(self) -> Self::U32;

    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// Applies a scalar function to every lane.
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let mut lanes = self.to_array();
        for lane in 0..Self::LANES {
            lanes[lane] = f(lanes[lane]);
        }
        Self::from_array(lanes)
    }
}

/// Rows of f32, for colours and conservative filters.
pub trait Single:
    Row<Scalar = f32>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    type F64;

    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    /// The larger of each; `other` if one is not a number.
    fn max(self, other: Self) -> Self;
    /// The smaller of each; `other` if one is not a number.
    fn min(self, other: Self) -> Self;
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    /// The bits of the mask of [`Single::lt`]. Some levels compute them faster than the mask.
    #[inline(always)]
    fn lt_bits(self, other: Self) -> u32 {
        self.lt(other).bits()
    }

    /// The bits of the mask of [`Single::le`].
    #[inline(always)]
    fn le_bits(self, other: Self) -> u32 {
        self.le(other).bits()
    }

    fn to_f64(self) -> Self::F64;
    /// self · factor + term, rounded once or twice. For conservative filters only.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// self · factor - term, rounded once or twice. For conservative filters only.
    fn mul_sub(self, factor: Self, term: Self) -> Self;
}

/// Rows of u32.
pub trait Bits: Row<Scalar = u32> {
    type F64;

    fn wrapping_add(self, other: Self) -> Self;
    fn wrapping_mul(self, other: Self) -> Self;
    fn and(self, other: Self) -> Self;
    fn or(self, other: Self) -> Self;
    fn xor(self, other: Self) -> Self;
    /// Shifts left by N bits, 1 to 31.
    fn shl<const N: i32>(self) -> Self;
    fn shr<const N: i32>(self) -> Self;
    fn reverse_bits(self) -> Self;
    fn eq(self, other: Self) -> Self::Mask;
    fn lt(self, other: Self) -> Self::Mask;
    fn to_f64(self) -> Self::F64;
}

/// An instruction set with eight lanes.
pub trait Level: Copy + 'static {
    type Mask: Mask;
    type F64: Real<Mask = Self::Mask, F32 = Self::F32, U32 = Self::U32, Level = Self, Array = [f64; 8]>;
    type F32: Single<Mask = Self::Mask, F64 = Self::F64, Array = [f32; 8]>;
    type U32: Bits<Mask = Self::Mask, F64 = Self::F64, Array = [u32; 8]>;
    /// The level for work on one ray: eight boxes or triangles in f32, and few f64. Wider registers do not make it
    /// faster, and masks in mask registers take longer to read.
    type Narrow: Level;

    /// Runs a kernel as a separate function that is compiled for the level. The code around the call keeps its
    /// registers.
    fn call<K: SimdKernel>(kernel: K) -> K::Output;
    /// [`Level::call`] for a kernel that holds lanes.
    fn call_with<K: LaneKernel<Self>>(kernel: K) -> K::Output;
    /// Row `i` of the result holds lane `i` of each row.
    fn transpose(rows: [Self::F32; 8]) -> [Self::F32; 8];
    /// Prefetches the cache lines of the entry with index `soon`. The index may be out of bounds.
    fn prefetch<T>(all: &[T], soon: usize);
}

/// Work on eight lanes.
pub trait SimdKernel {
    type Output;

    /// Implementations are `#[inline(always)]`, so that they are compiled for each level.
    fn run<L: Level>(self) -> Self::Output;
}

/// Work on eight lanes of one level that holds lanes itself.
pub trait LaneKernel<L: Level> {
    type Output;

    /// Implementations are `#[inline(always)]`.
    fn run(self) -> Self::Output;
}
