//! Code that the x86 levels share.

/// Declares a level and compiles kernels for its features.
macro_rules! level {
    ($name:ident, $narrow:ty, $features:literal) => {
        #[derive(Clone, Copy)]
        pub struct $name;

        /// Runs a kernel on this level.
        #[target_feature(enable = $features)]
        pub fn run<K: SimdKernel>(kernel: K) -> K::Output {
            kernel.run::<$name>()
        }

        #[inline(never)]
        #[target_feature(enable = $features)]
        fn run_out_of_line<K: SimdKernel>(kernel: K) -> K::Output {
            kernel.run::<$name>()
        }

        #[inline(never)]
        #[target_feature(enable = $features)]
        fn run_lanes_out_of_line<K: LaneKernel<$name>>(kernel: K) -> K::Output {
            kernel.run()
        }

        impl Level for $name {
            type Mask = Mask8;
            type F64 = F64x8;
            type F32 = F32x8;
            type U32 = U32x8;
            type Narrow = $narrow;

            #[inline(always)]
            fn call<K: SimdKernel>(kernel: K) -> K::Output {
                unsafe { run_out_of_line(kernel) }
            }

            #[inline(always)]
            fn call_with<K: LaneKernel<Self>>(kernel: K) -> K::Output {
                unsafe { run_lanes_out_of_line(kernel) }
            }

            #[inline(always)]
            fn transpose([a, b, c, d, e, f, g, h]: [F32x8; 8]) -> [F32x8; 8] {
                let rows = [a.0, b.0, c.0, d.0, e.0, f.0, g.0, h.0];
                let [a, b, c, d, e, f, g, h] = unsafe { crate::base::lanes::x86::transpose::transpose(rows) };
                [F32x8(a), F32x8(b), F32x8(c), F32x8(d), F32x8(e), F32x8(f), F32x8(g), F32x8(h)]
            }

            #[inline(always)]
            fn prefetch<T>(all: &[T], soon: usize) {
                crate::base::lanes::x86::prefetch::prefetch(all, soon);
            }
        }
    };
}

/// Implements `Row` for a type with the methods `splat_register`, `read`, `write` and `compressed`.
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
                if at.first == at.last {
                    return Self::splat(from[at.at[0] as usize]);
                }
                let one = |lane: usize| unsafe { *from.get_unchecked(at.at[lane] as usize) };
                Self::from_array([one(0), one(1), one(2), one(3), one(4), one(5), one(6), one(7)])
            }

            #[inline(always)]
            fn compress(self, mask: Mask8, into: &mut [$scalar], at: usize) {
                let into = &mut into[at..at + 8];
                unsafe { self.compressed(mask, into.as_mut_ptr()) };
            }
        }
    };
}

/// Implements operators of two rows by an intrinsic of two registers.
macro_rules! operators {
    ($name:ident: $($trait:ident $method:ident $intrinsic:ident),* $(,)?) => {
        $(impl $trait for $name {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        })*
    };
}

/// Implements methods of two rows by an intrinsic of two registers.
macro_rules! methods {
    ($($method:ident $intrinsic:ident),* $(,)?) => {
        $(#[inline(always)]
        fn $method(self, other: Self) -> Self {
            Self(unsafe { $intrinsic(self.0, other.0) })
        })*
    };
}

pub(super) use {level, methods, operators, row};
