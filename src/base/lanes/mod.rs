//! Numbers in lanes: a formula is written once, for one number or for eight at a time.
//!
//! [`Real`] is what formulas are generic over: `f64` is the case of one lane, and each [`Level`] (an instruction set)
//! has an eight-lane type. Every operation on f64 rounds as the scalar one does, so a result does not depend on the
//! number of lanes nor on the level. Only [`Single::mul_add`] may be fused; it is for conservative filters, which
//! decide what may be skipped and never what is hit.
//!
//! Work on eight lanes is a [`SimdKernel`]: [`dispatch`] runs it on the best level of the processor. Functions between
//! a kernel and the operations must be `#[inline(always)]` and free of closures that hold lanes: what is compiled by
//! itself lacks the level's instructions.

/// Declares a function of lanes that is compiled by itself for each level: what is large, or asked for in many places. Its
/// arguments and results go through memory. Borrowed arguments live for `'k`.
macro_rules! out_of_line {
    ($(#[$doc:meta])* $visible:vis fn $name:ident<'k, F>($($argument:ident: $type:ty),* $(,)?) -> $output:ty $body:block) => {
        $(#[$doc])*
        #[inline(always)]
        $visible fn $name<'k, F: $crate::base::lanes::Real>($($argument: $type),*) -> $output {
            struct Kernel<'k, F: $crate::base::lanes::Real> {
                $($argument: $type,)*
                lanes: std::marker::PhantomData<(&'k (), F)>,
            }

            impl<'k, F: $crate::base::lanes::Real> $crate::base::lanes::LaneKernel<F::Level> for Kernel<'k, F> {
                type Output = $output;

                #[inline(always)]
                fn run(self) -> $output {
                    let Self { $($argument,)* lanes: _ } = self;
                    $body
                }
            }

            let kernel = Kernel { $($argument,)* lanes: std::marker::PhantomData::<(&'k (), F)> };
            <F::Level as $crate::base::lanes::Level>::call_with(kernel)
        }
    };
}
pub(crate) use out_of_line;

mod choice;
mod color;
mod next;
mod portable;
mod scalar;
#[cfg(test)]
pub(crate) mod tests;
mod vec3;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use choice::{LEVEL_VARIABLE, LevelError, LevelName, forced_level, level};
pub use color::Color;
pub use next::{NEAR_ZERO, next_away};
pub use portable::Portable;
pub use vec3::{Vec3, turned};

use std::ops::{Add, BitAnd, BitOr, Div, Index, IndexMut, Mul, Neg, Not, Sub};

/// A choice of lanes.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    fn splat(value: bool) -> Self;
    /// The lanes whose bits are set, lane 0 the lowest.
    fn from_bits(bits: u32) -> Self;
    /// A bit for each chosen lane; others are 0.
    fn bits(self) -> u32;

    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// What can be chosen lane by lane.
pub trait Select<M>: Copy {
    /// `yes` in the lanes of `mask`, `no` elsewhere.
    fn select(mask: M, yes: Self, no: Self) -> Self;
}

/// What all rows of numbers have in common: how they come from and go to memory.
pub trait Row: Select<Self::Mask> {
    type Scalar: Copy + Default;
    type Mask: Mask;
    type Array: Copy + Index<usize, Output = Self::Scalar> + IndexMut<usize>;
    const LANES: usize;

    fn splat(value: Self::Scalar) -> Self;
    fn from_array(lanes: Self::Array) -> Self;
    fn to_array(self) -> Self::Array;
    /// Consecutive numbers, from index `at` on.
    fn load(from: &[Self::Scalar], at: usize) -> Self;
    fn store(self, into: &mut [Self::Scalar], at: usize);
    fn gather(from: &[Self::Scalar], at: &Lookup) -> Self;
    /// Stores the lanes of `mask` one after the other, from index `at` on. May overwrite as many places behind `at` as
    /// there are lanes.
    fn compress(self, mask: Self::Mask, into: &mut [Self::Scalar], at: usize);
}

/// Double precision, each operation rounded by itself.
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
    /// This magnitude with the sign of another number.
    fn copysign(self, sign: Self) -> Self;
    /// The largest power of two that is not above the magnitude, of normal numbers.
    fn power_of_two(self) -> Self;
    /// 2 to the power of a whole number from -1022 to 1023.
    fn exp2_whole(self) -> Self;
    /// [`next_away`] of finite numbers; of others it may be no number.
    fn next_away(self, towards: Self) -> Self;
    /// Comparisons with what is not a number are false.
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    fn eq(self, other: Self) -> Self::Mask;
    /// Whether the sign bit is set.
    fn is_negative(self) -> Self::Mask;
    fn to_f32(self) -> Self::F32;
    /// The whole part of numbers from 0 to below 2^31.
    fn to_u32(self) -> Self::U32;

    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// A scalar function of every lane.
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let mut lanes = self.to_array();
        for lane in 0..Self::LANES {
            lanes[lane] = f(lanes[lane]);
        }
        Self::from_array(lanes)
    }
}

/// Single precision: colours and conservative filters.
pub trait Single:
    Row<Scalar = f32>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    type F64;

    fn abs(self) -> Self;
    /// The larger of each; `other` if one is not a number.
    fn max(self, other: Self) -> Self;
    /// The smaller of each; `other` if one is not a number.
    fn min(self, other: Self) -> Self;
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    /// The bits of the mask of [`Single::lt`], which some levels have sooner.
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
    /// self · factor + term, rounded once or twice. For filters alone.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// self · factor - term, rounded once or twice. For filters alone.
    fn mul_sub(self, factor: Self, term: Self) -> Self;
}

/// Whole numbers of 32 bits.
pub trait Bits: Row<Scalar = u32> {
    type F64;

    fn wrapping_add(self, other: Self) -> Self;
    fn wrapping_mul(self, other: Self) -> Self;
    fn and(self, other: Self) -> Self;
    fn or(self, other: Self) -> Self;
    fn xor(self, other: Self) -> Self;
    /// Shifted by N bits, 1 to 31.
    fn shl<const N: i32>(self) -> Self;
    fn shr<const N: i32>(self) -> Self;
    fn reverse_bits(self) -> Self;
    fn eq(self, other: Self) -> Self::Mask;
    fn lt(self, other: Self) -> Self::Mask;
    fn to_f64(self) -> Self::F64;
}

/// Eight lanes of an instruction set.
pub trait Level: Copy + 'static {
    type Mask: Mask;
    type F64: Real<Mask = Self::Mask, F32 = Self::F32, U32 = Self::U32, Level = Self, Array = [f64; 8]>;
    type F32: Single<Mask = Self::Mask, F64 = Self::F64, Array = [f32; 8]>;
    type U32: Bits<Mask = Self::Mask, F64 = Self::F64, Array = [u32; 8]>;
    /// The level for work on one ray: eight boxes or triangles in f32 and a few f64, to which wider registers give nothing, while
    /// masks in registers of their own take longer to look at.
    type Narrow: Level;

    /// Runs a kernel as a function of its own, compiled for the level: what comes before and after keeps its registers.
    fn call<K: SimdKernel>(kernel: K) -> K::Output;
    /// The same for work that holds lanes.
    fn call_with<K: LaneKernel<Self>>(kernel: K) -> K::Output;
    /// Asks for the cache lines of an entry that is needed soon. There need not be one.
    fn prefetch<T>(all: &[T], soon: usize);
}

/// Work on eight lanes.
pub trait SimdKernel {
    type Output;

    /// Implementations are `#[inline(always)]`, so that they are compiled for each level.
    fn run<L: Level>(self) -> Self::Output;
}

/// Work on eight lanes of one level, some of which it holds.
pub trait LaneKernel<L: Level> {
    type Output;

    /// Implementations are `#[inline(always)]`.
    fn run(self) -> Self::Output;
}

/// Where lanes find their numbers in memory.
#[derive(Clone, Copy, Debug)]
pub struct Lookup {
    at: [u32; 8],
    /// The largest of the indices.
    last: u32,
    /// Whether the indices are consecutive, and whether all of them are the same.
    is_run: bool,
    is_same: bool,
}

impl Lookup {
    /// Of up to eight indices, at least one; lanes beyond them repeat the last one.
    #[inline(always)]
    pub fn new(indices: &[u32]) -> Self {
        let count = indices.len();
        let mut at = [indices[count - 1]; 8];
        let (mut last, mut is_run, mut is_same) = (0, count == 8, true);
        for lane in 0..8 {
            if lane < count {
                at[lane] = indices[lane];
            }
            last = last.max(at[lane]);
            is_run &= at[lane] == at[0].wrapping_add(lane as u32);
            is_same &= at[lane] == at[0];
        }
        Self { at, last, is_run, is_same }
    }

    /// `count` indices from `first` on, of which there are more than none; lanes beyond them repeat the last one.
    #[inline(always)]
    pub fn run(first: u32, count: usize) -> Self {
        let mut at = [0; 8];
        for (lane, at) in at.iter_mut().enumerate() {
            *at = first + lane.min(count - 1) as u32;
        }
        Self { at, last: at[7], is_run: count == 8, is_same: count == 1 }
    }

    #[inline(always)]
    pub fn lane(&self, lane: usize) -> u32 {
        self.at[lane]
    }
}

/// The numbers of the bits that are set.
#[inline(always)]
pub fn lanes(bits: u32) -> LaneNumbers {
    LaneNumbers(bits)
}

/// An iterator over the numbers of bits that are set.
pub struct LaneNumbers(u32);

impl Iterator for LaneNumbers {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize & 31;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}

/// Runs a kernel on [`level`].
#[inline]
pub fn dispatch<K: SimdKernel>(kernel: K) -> K::Output {
    match level() {
        #[cfg(target_arch = "x86_64")]
        LevelName::Avx2 => x86::run_avx2(kernel),
        #[cfg(target_arch = "x86_64")]
        LevelName::Avx512 => x86::run_avx512(kernel),
        _ => Portable::call(kernel),
    }
}

/// Runs a kernel for one ray on the [narrow level](Level::Narrow) of [`level`].
#[inline]
pub fn dispatch_narrow<K: SimdKernel>(kernel: K) -> K::Output {
    match level() {
        #[cfg(target_arch = "x86_64")]
        LevelName::Avx2 | LevelName::Avx512 => x86::run_avx2(kernel),
        _ => Portable::call(kernel),
    }
}

/// [`Level::prefetch`] for work without lanes.
#[inline(always)]
pub fn prefetch<T>(all: &[T], soon: usize) {
    #[cfg(target_arch = "x86_64")]
    x86::prefetch(all, soon);
    #[cfg(not(target_arch = "x86_64"))]
    Portable::prefetch(all, soon);
}
