//! Roots of functions of one variable within a bracket.

use crate::base::lanes::{Mask, Real};

/// The maximum number of steps. At least every second step halves the bracket. Only brackets that span all exponents
/// of f64, which shapes do not have, would need more: about 2100 halvings.
const STEPS: u32 = 200;

/// A differentiable function of one variable; each lane has its own.
pub trait Function<F> {
    /// The value and the derivative at x.
    fn at(&self, x: F) -> (F, F);
}

/// The roots of functions between `low` and `high`, in the lanes of the mask `open`. The signs of a function at `low`
/// and `high` differ; `rising` marks the lanes whose function is below zero at `low`. A lane ends when its step is at
/// most `resolution`.
///
/// Newton's method within a bracket: bisection replaces a step that leaves the bracket, or that is not shorter than
/// half of the step before (Press et al., *Numerical Recipes*, 3rd ed., section 9.4).
#[inline(always)]
pub fn root_between<F: Real>(
    (mut low, mut high): (F, F),
    rising: F::Mask,
    resolution: F,
    mut open: F::Mask,
    f: &impl Function<F>,
) -> F {
    let (zero, half) = (F::splat(0.0), F::splat(0.5));
    let mut x = low * half + high * half;
    let mut last = high - low;
    for _ in 0..STEPS {
        let (value, slope) = f.at(x);
        open = open & !value.eq(zero);
        let below = value.lt(zero);
        let is_low = (below & rising) | (!below & !rising);
        low = F::select(is_low, x, low);
        high = F::select(is_low, high, x);
        let newton = x - value / slope;
        // If the slope is 0, `newton` is NaN or infinite and these comparisons are false.
        let good = low.le(newton) & newton.le(high) & (newton - x).abs().lt(half * last);
        let next = F::select(good, newton, low * half + high * half);
        last = (next - x).abs();
        x = F::select(open, next, x);
        open = open & !last.le(resolution);
        if !open.any() {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A function from a closure.
    struct Given<G>(G);

    impl<G: Fn(f64) -> (f64, f64)> Function<f64> for Given<G> {
        fn at(&self, x: f64) -> (f64, f64) {
            self.0(x)
        }
    }

    fn root(bracket: (f64, f64), rising: bool, resolution: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
        root_between(bracket, rising, resolution, true, &Given(f))
    }

    #[test]
    fn finds_simple_and_flat_roots() {
        let cosine = root((0.0, 3.0), false, 0.0, |x| (libm::cos(x), -libm::sin(x)));
        assert!((cosine - PI / 2.0).abs() <= 2.0 * f64::EPSILON);
        // A triple root: Newton's method converges too slowly there, so bisection finds it.
        let flat = root((-1.0, 2.5), true, 1e-15, |x| ((x - 0.3) * (x - 0.3) * (x - 0.3), 0.0));
        assert!((flat - 0.3).abs() <= 2e-15, "{flat}");
    }

    #[test]
    fn ends_where_the_slope_is_no_number() {
        let x = root((-1.0, 3.0), true, 1e-12, |x| (x, f64::NAN));
        assert!(x.abs() <= 1e-11);
    }
}
