//! The fraction of light that a boundary between two media reflects.

use crate::base::digest::Content;
use crate::base::lanes::Real;

/// The reflectance formula of a refracting boundary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Content)]
pub enum Fresnel {
    /// The boundary reflects only at total internal reflection. The material's refracted fraction is a constant.
    #[default]
    Off,
    /// Fresnel's equations for unpolarised light.
    Exact,
    /// Schlick's approximation (1994).
    Schlick,
}

impl Fresnel {
    /// The reflected fraction of light that arrives at an angle of cosine `cosine` and is refracted to an angle of
    /// cosine `refracted`. `eta` is the index of refraction behind the boundary over that in front of it.
    #[inline(always)]
    pub fn reflectance<F: Real>(self, cosine: F, refracted: F, eta: F) -> F {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let share = match self {
            Self::Off => zero,
            Self::Exact => dielectric(cosine, refracted, eta),
            // The approximation holds for the angle outside the denser medium, which is the larger angle and has the
            // smaller cosine.
            Self::Schlick => schlick(normal_reflectance(eta), cosine.min(refracted)),
        };
        // A boundary between equal indices reflects nothing, whatever the formula.
        F::select(eta.eq(one), zero, share)
    }
}

/// Fresnel's equations, averaged over both polarisations (Born and Wolf, *Principles of Optics*, 1.5.2). The arguments
/// are those of [`Fresnel::reflectance`].
#[inline(always)]
fn dielectric<F: Real>(cosine: F, refracted: F, eta: F) -> F {
    let s = (cosine - eta * refracted) / (cosine + eta * refracted);
    let p = (eta * cosine - refracted) / (eta * cosine + refracted);
    let reflectance = F::splat(0.5) * (s * s + p * p);
    // If both cosines are 0, the quotient is 0 / 0. Then all light is reflected.
    F::select(reflectance.eq(reflectance), reflectance, F::splat(1.0))
}

/// Schlick's approximation, from the reflectance at normal incidence.
#[inline(always)]
pub fn schlick<F: Real>(normal: F, cosine: F) -> F {
    let one = F::splat(1.0);
    let rest = (one - cosine).max(F::splat(0.0)).min(one);
    let square = rest * rest;
    normal + (one - normal) * (rest * (square * square))
}

#[inline(always)]
fn normal_reflectance<F: Real>(eta: F) -> F {
    let ratio = (eta - F::splat(1.0)) / (eta + F::splat(1.0));
    ratio * ratio
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Angle;

    fn outside(model: Fresnel, degrees: f64, eta: f64) -> f64 {
        let turn = Angle(degrees).cos_sin();
        let sine = turn.y / eta;
        model.reflectance(turn.x, ((1.0 - sine) * (1.0 + sine)).sqrt(), eta)
    }

    #[test]
    fn sh_05_fresnel_table() {
        for (degrees, expected) in [
            (0.0, 0.04),
            (45.0, 0.050_239_911_012_2),
            (56.309_932_474, 0.073_964_497_041_4),
            (60.0, 0.089_186_712_802_2),
            (80.0, 0.387_704_354_691),
            (85.0, 0.612_799_645_265),
            (89.0, 0.904_184_949_780),
            (89.9, 0.989_911_876_919),
            (90.0, 1.0),
        ] {
            let found = outside(Fresnel::Exact, degrees, 1.5);
            assert!((found - expected).abs() <= 1e-12, "{degrees}: {found} against {expected}");
        }
        assert!((outside(Fresnel::Exact, 0.0, 1.33) - 0.020_059_312_199_5).abs() <= 1e-12);
        assert!((outside(Fresnel::Exact, 0.0, 2.417) - 0.171_968_832_523).abs() <= 1e-12);
        for degrees in [0.0, 33.0, 89.0, 90.0] {
            for model in [Fresnel::Off, Fresnel::Exact, Fresnel::Schlick] {
                assert_eq!(outside(model, degrees, 1.0), 0.0, "{model:?} at {degrees}");
            }
        }
        for tenth in 0..=900 {
            let degrees = f64::from(tenth) * 0.1;
            let off = outside(Fresnel::Schlick, degrees, 1.5) - outside(Fresnel::Exact, degrees, 1.5);
            assert!(off.abs() <= 0.036, "{degrees}: off by {off}");
        }
    }
}
