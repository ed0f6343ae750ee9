//! Roots of functions of one variable, between bounds.

use crate::base::lanes::{Mask, Real};

/// No search takes more steps: every second one halves the bracket at least, and the exponents of f64 span
/// about 2100 halvings only for brackets that no shape has.
const STEPS: u32 = 200;

/// A function of one variable, of each lane its own.
pub trait Function<F> {
    /// The value at x, and the slope.
    fn at(&self, x: F) -> (F, F);
}

/// Where functions cross zero between `low` and `high`, where their signs differ, in the lanes of a mask; `rising` are those
/// that are below zero at `low`. A lane ends when its step is not longer than `resolution`.
///
/// Newton's method within a bracket: a step that leaves the bracket, or that is not half as long as the one
/// before, is replaced by a bisection (Press et al., *Numerical Recipes*, 3rd ed., section 9.4).
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
        // Comparisons fail for the NaN of a vanishing slope.
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

    /// A function given by a closure.
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
        // A triple root: Newton's steps shrink by a third each, so it is found by halving.
        let flat = root((-1.0, 2.5), true, 1e-15, |x| ((x - 0.3) * (x - 0.3) * (x - 0.3), 0.0));
        assert!((flat - 0.3).abs() <= 2e-15, "{flat}");
    }

    #[test]
    fn ends_where_the_slope_is_no_number() {
        let x = root((-1.0, 3.0), true, 1e-12, |x| (x, f64::NAN));
        assert!(x.abs() <= 1e-11);
    }
}
