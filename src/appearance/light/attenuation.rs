//! Attenuation of light with distance.

use crate::base::digest::Content;
use crate::base::lanes::Real;

/// The fraction min(1, 1 / (`constant` + `linear`·d + `quadratic`·d²)) arrives at distance d. Each coefficient is at
/// least
/// 0.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub struct Attenuation {
    /// The part of the divisor that is the same at all distances.
    pub constant: f64,
    /// The part that grows with the distance.
    pub linear: f64,
    /// The part that grows with the square of the distance.
    pub quadratic: f64,
}

/// No attenuation.
impl Default for Attenuation {
    fn default() -> Self {
        Self { constant: 1.0, linear: 0.0, quadratic: 0.0 }
    }
}

#[warn(missing_docs)]
impl Attenuation {
    /// The fraction that arrives at a distance.
    #[inline(always)]
    pub fn share<F: Real>(&self, distance: F) -> F {
        let one = F::splat(1.0);
        if self.linear == 0.0 && self.quadratic == 0.0 {
            return F::splat(if self.constant <= 1.0 { 1.0 } else { 1.0 / self.constant });
        }
        let fading = distance * (F::splat(self.linear) + distance * F::splat(self.quadratic));
        let divisor = F::splat(self.constant) + fading;
        // This also covers a divisor of 0, at the light itself.
        F::select(divisor.le(one), one, one / divisor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn never_more_than_all() {
        let square = Attenuation { constant: 0.0, linear: 0.0, quadratic: 1.0 };
        assert_eq!([0.0, 0.5, 1.0, 2.0, 10.0].map(|d| square.share(d)), [1.0, 1.0, 1.0, 0.25, 0.01]);
        assert_eq!(Attenuation::default().share(f64::INFINITY), 1.0);
        assert_eq!(Attenuation { constant: 2.0, linear: 1.0, quadratic: 0.0 }.share(2.0), 0.25);
    }
}
