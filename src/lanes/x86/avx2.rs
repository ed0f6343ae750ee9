//! Eight lanes in registers of AVX2: one of f32, two of f64.

use super::super::NEAR_ZERO;
use super::super::{Bits, LaneKernel, Level, Lookup, Mask, Real, Row, Select, SimdKernel, Single};
use super::{methods, operators};
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

#[derive(Clone, Copy)]
pub struct Avx2;

/// Lanes 0 to 3, and 4 to 7.
#[derive(Clone, Copy)]
pub struct F64x8([__m256d; 2]);

#[derive(Clone, Copy)]
pub struct F32x8(__m256);

#[derive(Clone, Copy)]
pub struct U32x8(__m256i);

/// All bits of a chosen lane are set, as comparisons of f64 give it.
#[derive(Clone, Copy)]
pub struct Mask8([__m256d; 2]);

/// Runs a kernel on this level.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub fn run<K: SimdKernel>(kernel: K) -> K::Output {
    kernel.run::<Avx2>()
}

#[inline(never)]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn run_apart<K: SimdKernel>(kernel: K) -> K::Output {
    kernel.run::<Avx2>()
}

#[inline(never)]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn run_lanes_apart<K: LaneKernel<Avx2>>(kernel: K) -> K::Output {
    kernel.run()
}

// SAFETY of all that follows: there are lanes of this kind only where the processor has the features, see `super`.
// Pointers that are read or written lead to as many numbers as the register holds: slices are checked to have them.

impl Level for Avx2 {
    type Mask = Mask8;
    type F64 = F64x8;
    type F32 = F32x8;
    type U32 = U32x8;

    #[inline(always)]
    fn call<K: SimdKernel>(kernel: K) -> K::Output {
        unsafe { run_apart(kernel) }
    }

    #[inline(always)]
    fn call_with<K: LaneKernel<Self>>(kernel: K) -> K::Output {
        unsafe { run_lanes_apart(kernel) }
    }

    #[inline(always)]
    fn prefetch<T>(all: &[T], soon: usize) {
        super::prefetch(all, soon);
    }
}

impl Mask8 {
    /// Of the comparison of f32 or u32.
    #[inline(always)]
    unsafe fn widened(mask: __m256i) -> Self {
        unsafe {
            let low = _mm256_cvtepi32_epi64(_mm256_castsi256_si128(mask));
            let high = _mm256_cvtepi32_epi64(_mm256_extracti128_si256::<1>(mask));
            Self([_mm256_castsi256_pd(low), _mm256_castsi256_pd(high)])
        }
    }

    /// For a choice among f32 or u32.
    #[inline(always)]
    unsafe fn narrowed(self) -> __m256i {
        unsafe {
            let (low, high) = (_mm256_castpd_ps(self.0[0]), _mm256_castpd_ps(self.0[1]));
            // The even halves of both: lanes 0, 1, 4, 5, 2, 3, 6, 7.
            let mixed = _mm256_castps_si256(_mm256_shuffle_ps::<0b10_00_10_00>(low, high));
            _mm256_permute4x64_epi64::<0b11_01_10_00>(mixed)
        }
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([unsafe { _mm256_castsi256_pd(_mm256_set1_epi64x(-i64::from(value))) }; 2])
    }

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        unsafe {
            let bits = _mm256_set1_epi64x(i64::from(bits));
            let (low, high) = (_mm256_setr_epi64x(1, 2, 4, 8), _mm256_setr_epi64x(16, 32, 64, 128));
            Self([all_bits_of(bits, low), all_bits_of(bits, high)])
        }
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        unsafe { (_mm256_movemask_pd(self.0[0]) | _mm256_movemask_pd(self.0[1]) << 4).cast_unsigned() }
    }
}

/// All ones in the lanes that have the bits of others.
#[inline(always)]
unsafe fn all_bits_of(bits: __m256i, of: __m256i) -> __m256d {
    unsafe { _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(bits, of), of)) }
}

/// By an intrinsic of two registers, half by half.
macro_rules! halves {
    ($intrinsic:ident($a:expr, $b:expr)) => {
        unsafe { [$intrinsic($a.0[0], $b.0[0]), $intrinsic($a.0[1], $b.0[1])] }
    };
}

impl BitAnd for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(halves!(_mm256_and_pd(self, other)))
    }
}

impl BitOr for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(halves!(_mm256_or_pd(self, other)))
    }
}

impl Not for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        let all = Self::splat(true);
        Self(halves!(_mm256_xor_pd(self, all)))
    }
}

macro_rules! row {
    ($name:ident, $scalar:ty, $zero:expr) => {
        impl Row for $name {
            type Scalar = $scalar;
            type Mask = Mask8;
            type Array = [$scalar; 8];
            const LANES: usize = 8;

            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                unsafe { Self::splat_register(value) }
            }

            #[inline(always)]
            fn from_array(lanes: [$scalar; 8]) -> Self {
                unsafe { Self::read(lanes.as_ptr()) }
            }

            #[inline(always)]
            fn to_array(self) -> [$scalar; 8] {
                let mut lanes = [$zero; 8];
                unsafe { self.write(lanes.as_mut_ptr()) };
                lanes
            }

            #[inline(always)]
            fn load(from: &[$scalar], at: usize) -> Self {
                let from = &from[at..at + 8];
                unsafe { Self::read(from.as_ptr()) }
            }

            #[inline(always)]
            fn store(self, into: &mut [$scalar], at: usize) {
                let into = &mut into[at..at + 8];
                unsafe { self.write(into.as_mut_ptr()) };
            }

            #[inline(always)]
            fn gather(from: &[$scalar], at: &Lookup) -> Self {
                assert!((at.last as usize) < from.len());
                if at.is_run {
                    return unsafe { Self::read(from.as_ptr().add(at.at[0] as usize)) };
                }
                if at.is_same {
                    return Self::splat(from[at.at[0] as usize]);
                }
                let one = |lane: usize| unsafe { *from.get_unchecked(at.at[lane] as usize) };
                Self::from_array([one(0), one(1), one(2), one(3), one(4), one(5), one(6), one(7)])
            }

            #[inline(always)]
            fn compress(self, mask: Mask8, into: &mut [$scalar], at: usize) {
                let into = &mut into[at..at + 8];
                unsafe { self.compressed(mask.bits(), into.as_mut_ptr()) };
            }
        }
    };
}

row!(F64x8, f64, 0.0);
row!(F32x8, f32, 0.0);
row!(U32x8, u32, 0);

impl F64x8 {
    #[inline(always)]
    unsafe fn splat_register(value: f64) -> Self {
        Self([unsafe { _mm256_set1_pd(value) }; 2])
    }

    #[inline(always)]
    unsafe fn read(from: *const f64) -> Self {
        Self(unsafe { [_mm256_loadu_pd(from), _mm256_loadu_pd(from.add(4))] })
    }

    #[inline(always)]
    unsafe fn write(self, into: *mut f64) {
        unsafe {
            _mm256_storeu_pd(into, self.0[0]);
            _mm256_storeu_pd(into.add(4), self.0[1]);
        }
    }

    /// The chosen lanes, at a place for eight.
    #[inline(always)]
    unsafe fn compressed(self, bits: u32, into: *mut f64) {
        unsafe {
            let first = (bits & 0xf).count_ones() as usize;
            _mm256_storeu_pd(into, compressed_half(self.0[0], bits & 0xf));
            _mm256_storeu_pd(into.add(first), compressed_half(self.0[1], bits >> 4 & 0xf));
        }
    }
}

/// The chosen ones of four f64 first.
#[inline(always)]
unsafe fn compressed_half(values: __m256d, bits: u32) -> __m256d {
    unsafe {
        let order = _mm256_loadu_si256(COMPRESS[bits as usize].as_ptr().cast());
        let values = _mm256_castpd_si256(values);
        _mm256_castsi256_pd(_mm256_permutevar8x32_epi32(values, order))
    }
}

/// For every choice of four lanes of 64 bits, the halves of the chosen ones.
static COMPRESS: [[u32; 8]; 16] = {
    let mut orders = [[0; 8]; 16];
    let mut bits = 0;
    while bits < 16 {
        let (mut lane, mut at) = (0, 0);
        while lane < 4 {
            if bits >> lane & 1 == 1 {
                orders[bits][at] = 2 * lane;
                orders[bits][at + 1] = 2 * lane + 1;
                at += 2;
            }
            lane += 1;
        }
        bits += 1;
    }
    orders
};

impl F32x8 {
    #[inline(always)]
    unsafe fn splat_register(value: f32) -> Self {
        Self(unsafe { _mm256_set1_ps(value) })
    }

    #[inline(always)]
    unsafe fn read(from: *const f32) -> Self {
        Self(unsafe { _mm256_loadu_ps(from) })
    }

    #[inline(always)]
    unsafe fn write(self, into: *mut f32) {
        unsafe { _mm256_storeu_ps(into, self.0) };
    }

    #[inline(always)]
    unsafe fn compressed(self, bits: u32, into: *mut f32) {
        unsafe { U32x8(_mm256_castps_si256(self.0)).compressed(bits, into.cast()) }
    }
}

impl U32x8 {
    #[inline(always)]
    unsafe fn splat_register(value: u32) -> Self {
        Self(unsafe { _mm256_set1_epi32(value.cast_signed()) })
    }

    #[inline(always)]
    unsafe fn read(from: *const u32) -> Self {
        Self(unsafe { _mm256_loadu_si256(from.cast()) })
    }

    #[inline(always)]
    unsafe fn write(self, into: *mut u32) {
        unsafe { _mm256_storeu_si256(into.cast(), self.0) };
    }

    #[inline(always)]
    unsafe fn compressed(self, bits: u32, into: *mut u32) {
        unsafe {
            // A byte of all ones for each chosen lane, and by it the numbers of the chosen lanes, a byte each.
            let chosen = _pdep_u64(u64::from(bits), 0x0101_0101_0101_0101).wrapping_mul(0xff);
            let order = _pext_u64(0x0706_0504_0302_0100, chosen);
            let order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(order.cast_signed()));
            _mm256_storeu_si256(into.cast(), _mm256_permutevar8x32_epi32(self.0, order));
        }
    }
}

impl Select<Mask8> for F64x8 {
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(unsafe {
            [_mm256_blendv_pd(no.0[0], yes.0[0], mask.0[0]), _mm256_blendv_pd(no.0[1], yes.0[1], mask.0[1])]
        })
    }
}

impl Select<Mask8> for F32x8 {
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm256_blendv_ps(no.0, yes.0, _mm256_castsi256_ps(mask.narrowed())) })
    }
}

impl Select<Mask8> for U32x8 {
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm256_blendv_epi8(no.0, yes.0, mask.narrowed()) })
    }
}

/// Operators of f64, half by half.
macro_rules! operators_of_halves {
    ($($trait:ident $method:ident $intrinsic:ident),* $(,)?) => {
        $(impl $trait for F64x8 {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(halves!($intrinsic(self, other)))
            }
        })*
    };
}

operators_of_halves!(Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd);
operators!(F32x8: Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps);

impl Neg for F64x8 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let sign = Self::splat(-0.0);
        Self(halves!(_mm256_xor_pd(self, sign)))
    }
}

impl Neg for F32x8 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_set1_ps(-0.0)) })
    }
}

/// Comparisons by a predicate.
macro_rules! comparisons {
    ($($method:ident $predicate:ident),* $(,)?) => {
        $(#[inline(always)]
        fn $method(self, other: Self) -> Mask8 {
            Mask8(unsafe {
                [
                    _mm256_cmp_pd::<$predicate>(self.0[0], other.0[0]),
                    _mm256_cmp_pd::<$predicate>(self.0[1], other.0[1]),
                ]
            })
        })*
    };
}

impl Real for F64x8 {
    type Level = Avx2;
    type F32 = F32x8;
    type U32 = U32x8;

    comparisons!(lt _CMP_LT_OQ, le _CMP_LE_OQ, eq _CMP_EQ_OQ);

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { [_mm256_sqrt_pd(self.0[0]), _mm256_sqrt_pd(self.0[1])] })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let sign = Self::splat(-0.0);
        Self(halves!(_mm256_andnot_pd(sign, self)))
    }

    #[inline(always)]
    fn floor(self) -> Self {
        Self(unsafe { [_mm256_floor_pd(self.0[0]), _mm256_floor_pd(self.0[1])] })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(halves!(_mm256_max_pd(self, other)))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(halves!(_mm256_min_pd(self, other)))
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let bit = Self::splat(-0.0);
        let (magnitude, sign) =
            (Self(halves!(_mm256_andnot_pd(bit, self))), Self(halves!(_mm256_and_pd(bit, sign))));
        Self(halves!(_mm256_or_pd(magnitude, sign)))
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        let exponent = Self::splat(f64::INFINITY);
        Self(halves!(_mm256_and_pd(exponent, self)))
    }

    #[inline(always)]
    fn exp2_whole(self) -> Self {
        Self(unsafe { [exp2_whole(self.0[0]), exp2_whole(self.0[1])] })
    }

    #[inline(always)]
    fn next_away(self, towards: Self) -> Self {
        Self([next_away(self.0[0], towards.0[0]), next_away(self.0[1], towards.0[1])])
    }

    #[inline(always)]
    fn is_negative(self) -> Mask8 {
        // Choices go by the sign bit, and so does `bits`; masks that are combined by `!` need all bits.
        let zero = unsafe { _mm256_setzero_si256() };
        Mask8(unsafe {
            [
                _mm256_castsi256_pd(_mm256_cmpgt_epi64(zero, _mm256_castpd_si256(self.0[0]))),
                _mm256_castsi256_pd(_mm256_cmpgt_epi64(zero, _mm256_castpd_si256(self.0[1]))),
            ]
        })
    }

    #[inline(always)]
    fn to_f32(self) -> F32x8 {
        F32x8(unsafe { _mm256_set_m128(_mm256_cvtpd_ps(self.0[1]), _mm256_cvtpd_ps(self.0[0])) })
    }

    #[inline(always)]
    fn to_u32(self) -> U32x8 {
        U32x8(unsafe { _mm256_set_m128i(_mm256_cvttpd_epi32(self.0[1]), _mm256_cvttpd_epi32(self.0[0])) })
    }
}

#[inline(always)]
unsafe fn exp2_whole(exponent: __m256d) -> __m256d {
    unsafe {
        let exponent = _mm256_cvtepi32_epi64(_mm256_cvtpd_epi32(exponent));
        let biased = _mm256_add_epi64(exponent, _mm256_set1_epi64x(1023));
        _mm256_castsi256_pd(_mm256_slli_epi64::<52>(biased))
    }
}

#[inline(always)]
fn next_away(value: __m256d, towards: __m256d) -> __m256d {
    unsafe {
        let (bits, zero) = (_mm256_castpd_si256(value), _mm256_setzero_pd());
        // -1 where the signs differ, which leads towards zero; 1 elsewhere.
        let apart = _mm256_xor_si256(bits, _mm256_castpd_si256(towards));
        let back = _mm256_cmpgt_epi64(_mm256_setzero_si256(), apart);
        let next = _mm256_add_epi64(bits, _mm256_or_si256(back, _mm256_set1_epi64x(1)));
        let next = _mm256_castsi256_pd(next);
        // What is next to zero may have been stepped past it, which gives no number.
        let (least, sign) = (_mm256_set1_pd(NEAR_ZERO), _mm256_set1_pd(-0.0));
        let tiny = _mm256_or_pd(
            _mm256_cmp_pd::<_CMP_LT_OQ>(_mm256_andnot_pd(sign, next), least),
            _mm256_cmp_pd::<_CMP_LT_OQ>(_mm256_andnot_pd(sign, value), least),
        );
        let away = _mm256_or_pd(least, _mm256_and_pd(sign, towards));
        let next = _mm256_blendv_pd(next, away, tiny);
        _mm256_blendv_pd(value, next, _mm256_cmp_pd::<_CMP_NEQ_OQ>(towards, zero))
    }
}

impl Single for F32x8 {
    type F64 = F64x8;

    methods!(max _mm256_max_ps, min _mm256_min_ps);

    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        unsafe { Mask8::widened(_mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0))) }
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        unsafe { Mask8::widened(_mm256_castps_si256(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0))) }
    }

    #[inline(always)]
    fn lt_bits(self, other: Self) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)).cast_unsigned() }
    }

    #[inline(always)]
    fn le_bits(self, other: Self) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)).cast_unsigned() }
    }

    #[inline(always)]
    fn to_f64(self) -> F64x8 {
        F64x8(unsafe {
            [
                _mm256_cvtps_pd(_mm256_castps256_ps128(self.0)),
                _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(self.0)),
            ]
        })
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, term.0) })
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        Self(unsafe { _mm256_fmsub_ps(self.0, factor.0, term.0) })
    }
}

impl Bits for U32x8 {
    type F64 = F64x8;

    methods!(
        wrapping_add _mm256_add_epi32,
        wrapping_mul _mm256_mullo_epi32,
        and _mm256_and_si256,
        or _mm256_or_si256,
        xor _mm256_xor_si256,
    );

    #[inline(always)]
    fn shl<const N: i32>(self) -> Self {
        Self(unsafe { _mm256_slli_epi32::<N>(self.0) })
    }

    #[inline(always)]
    fn shr<const N: i32>(self) -> Self {
        Self(unsafe { _mm256_srli_epi32::<N>(self.0) })
    }

    #[inline(always)]
    fn reverse_bits(self) -> Self {
        Self(unsafe { reverse_bits(self.0) })
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        unsafe { Mask8::widened(_mm256_cmpeq_epi32(self.0, other.0)) }
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        unsafe {
            // Signed comparisons of numbers whose order is turned to that of signed ones.
            let half = _mm256_set1_epi32(i32::MIN);
            let (a, b) = (_mm256_xor_si256(self.0, half), _mm256_xor_si256(other.0, half));
            Mask8::widened(_mm256_cmpgt_epi32(b, a))
        }
    }

    #[inline(always)]
    fn to_f64(self) -> F64x8 {
        F64x8(unsafe {
            [to_f64(_mm256_castsi256_si128(self.0)), to_f64(_mm256_extracti128_si256::<1>(self.0))]
        })
    }
}

#[inline(always)]
unsafe fn to_f64(values: __m128i) -> __m256d {
    unsafe {
        // 2^52 with the number as its last bits, less 2^52.
        let shift = _mm256_set1_pd(4_503_599_627_370_496.0);
        let bits = _mm256_or_si256(_mm256_cvtepu32_epi64(values), _mm256_castpd_si256(shift));
        _mm256_sub_pd(_mm256_castsi256_pd(bits), shift)
    }
}

/// The bits of each number the other way round.
#[inline(always)]
pub unsafe fn reverse_bits(value: __m256i) -> __m256i {
    unsafe {
        // Bytes the other way round, and of every byte both halves by a table.
        let bytes = _mm256_setr_epi8(
            3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12, 3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15,
            14, 13, 12,
        );
        let reversed = _mm256_setr_epi8(
            0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15, 0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3,
            11, 7, 15,
        );
        let halves = _mm256_set1_epi8(0xf);
        let value = _mm256_shuffle_epi8(value, bytes);
        let low = _mm256_shuffle_epi8(reversed, _mm256_and_si256(value, halves));
        let high = _mm256_shuffle_epi8(reversed, _mm256_and_si256(_mm256_srli_epi16::<4>(value), halves));
        _mm256_or_si256(_mm256_slli_epi16::<4>(low), high)
    }
}
