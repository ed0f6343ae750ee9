//! Floating-point error bounds and the exact operations behind them.

use super::DVec3;
use crate::base::lanes::Real;

/// Unit roundoff of f64: half the distance from 1 to the next float.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON * 0.5;

/// The relative error of `n` rounded operations is at most `gamma(n)` = n·u / (1 - n·u)
/// (Higham, *Accuracy and Stability of Numerical Algorithms*, lemma 3.1).
pub const fn gamma(n: u32) -> f64 {
    let nu = n as f64 * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}

/// a·b - c·d within about 1.5 units in the last place, without fused multiply-add: Dekker's splitting recovers the
/// rounding errors of both products, which are added back.
#[inline(always)]
pub fn difference_of_products<F: Real>(a: F, b: F, c: F, d: F) -> F {
    let (ab, cd) = (a * b, c * d);
    let difference = ab - cd;
    // If splitting overflows, near the ends of the exponent range, the result is the plain difference.
    let error = product_error(a, b, ab) - product_error(c, d, cd);
    F::select(error.abs().lt(F::splat(f64::INFINITY)), difference + error, difference)
}

/// The exact rounding error of `product` = fl(a·b) (Dekker 1971, Veltkamp splitting).
#[inline(always)]
fn product_error<F: Real>(a: F, b: F, product: F) -> F {
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    ((ah * bh - product) + ah * bl + al * bh) + al * bl
}

#[inline(always)]
fn split<F: Real>(a: F) -> (F, F) {
    const FACTOR: f64 = 134_217_729.0; // 2^27 + 1
    let scaled = F::splat(FACTOR) * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// a·b + c as if computed in twice the precision and then rounded (Ogita, Rump and Oishi, *Accurate Sum and Dot
/// Product*, 2005). Outside the range of Dekker's splitting it is the plain sum.
pub fn dot_plus(a: DVec3, b: DVec3, c: f64) -> f64 {
    let (mut sum, mut lost) = (c, 0.0);
    for (a, b) in a.to_array().into_iter().zip(b.to_array()) {
        let product = a * b;
        let next = sum + product;
        let added = next - sum;
        lost += (sum - (next - added)) + (product - added) + product_error(a, b, product);
        sum = next;
    }
    if lost.is_finite() { sum + lost } else { sum }
}

/// The cross product; each component is a [`difference_of_products`].
pub fn cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        difference_of_products(a.y, b.z, a.z, b.y),
        difference_of_products(a.z, b.x, a.x, b.z),
        difference_of_products(a.x, b.y, a.y, b.x),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cancelling_products_keep_their_digits() {
        // (1 + e)(1 - e) - 1 = -e². The plain formula loses all of it.
        let e = f64::EPSILON;
        assert_eq!((1.0 + e) * (1.0 - e) - 1.0 * 1.0, 0.0);
        assert_eq!(difference_of_products(1.0 + e, 1.0 - e, 1.0, 1.0), -e * e);
        assert_eq!(difference_of_products(3.0, 7.0, 21.0, 1.0), 0.0);
        assert_eq!(difference_of_products(1e300, 1e8, 1e300, 1e8 - 1.0), 1e300);
    }

    #[test]
    fn cancelling_sums_keep_their_digits() {
        let e = f64::EPSILON;
        let (a, b) = (DVec3::new(1.0 + e, 3.0, 1e8), DVec3::new(1.0 - e, -1e16, 3e8));
        assert_eq!(dot_plus(a, b, -1.0), -e * e);
        assert_eq!(dot_plus(DVec3::splat(1e300), DVec3::X, 1.0), 1e300);
    }

    #[test]
    fn gamma_bounds_the_first_order_term() {
        assert!(gamma(3) > 3.0 * UNIT_ROUNDOFF && gamma(3) < 3.001 * UNIT_ROUNDOFF);
    }
}
