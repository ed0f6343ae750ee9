//! SIMD lanes: a formula is written once, for one number or for eight at a time.
//!
//! Formulas are generic over [`Real`]. `f64` has one lane, and each [`Level`] (an instruction set) has an eight-lane
//! type. Every f64 operation rounds like the scalar one, so results do not depend on the number of lanes nor on the
//! level. Only [`Single::mul_add`] may be fused. It is for conservative filters, which decide what can be skipped but
//! never what is hit.
//!
//! Work on eight lanes is a [`SimdKernel`]; `dispatch` runs it on the best level of the processor. Functions
//! between a kernel and the operations must be `#[inline(always)]` and must not contain closures that hold lanes: a
//! function that is compiled separately lacks the instructions of the level.

/// Declares a function of lanes that is compiled separately for each level. Use it for large functions and for those
/// with many callers. Arguments and results are passed through memory. Borrowed arguments live for `'k`.
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
mod dispatch;
mod lookup;
mod next;
mod portable;
mod scalar;
#[cfg(test)]
pub(crate) mod tests;
mod traits;
mod vec3;
#[cfg(all(target_arch = "x86_64", not(feature = "portable-only")))]
mod x86;

pub use choice::{LEVEL_VARIABLE, LevelError, LevelName, forced_level, level};
pub use color::Color;
pub use dispatch::{dispatch, dispatch_narrow, prefetch};
pub use lookup::{LaneNumbers, Lookup, lanes};
pub use next::{NEAR_ZERO, next_away};
pub use portable::Portable;
pub use traits::{Bits, LaneKernel, Level, Mask, Real, Row, Select, SimdKernel, Single};
pub use vec3::{Vec3, transform_vector};
