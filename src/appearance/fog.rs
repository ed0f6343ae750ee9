//! Fog: it absorbs light along a segment and adds in-scattered light.

use crate::appearance::light_groups::{GroupRadiance, GroupWeight};
use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::lanes::{Real, out_of_line};
use crate::base::math::{LaneRay, exp, exp_m1};
use crate::base::time::Time;
use crate::track::Animated;
use bevy_ecs::component::Component;

/// Fog at one moment.
#[derive(Clone, Copy, Component, Debug, PartialEq, Content)]
pub struct Fog {
    /// The radiance of an infinite segment through the fog.
    pub in_scattering: GroupRadiance,
    /// Extinction per unit of length. With a falloff, this is the density at the falloff's base.
    pub density: f64,
    pub falloff: Option<Falloff>,
}

/// Exponential decrease of the density with height: `density`·exp(-(y - `base`) / `height`).
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct Falloff {
    pub base: f64,
    /// Above 0.
    pub height: f64,
}

/// Fog over time.
#[derive(Clone, Component, Debug, PartialEq)]
pub struct FogTracks {
    pub color: Animated<Rgb>,
    /// At least 0.
    pub density: Animated<f64>,
    pub falloff: Option<FalloffTracks>,
}

/// A [`Falloff`] over time.
#[derive(Clone, Debug, PartialEq)]
pub struct FalloffTracks {
    pub base: Animated<f64>,
    pub height: Animated<f64>,
}

impl FogTracks {
    /// The fog at a moment, with in-scattering that [`FogTracks::split`] has given.
    pub fn at(&self, time: Time, in_scattering: GroupRadiance) -> Fog {
        let falloff = self.falloff.as_ref().map(|falloff| Falloff {
            base: falloff.base.at(time),
            height: falloff.height.at(time).max(f64::MIN_POSITIVE),
        });
        Fog { in_scattering, density: self.density.at(time).max(0.0), falloff }
    }

    /// Splits the fog's colour into the radiance that is traced and its keyed weight.
    pub fn split(&self) -> (Rgb, GroupWeight) {
        GroupRadiance::split(&self.color)
    }
}

out_of_line! {
    fn opacity<'k, F>(fog: &'k Fog, ray: &'k LaneRay<F>, t: F) -> F {
        -exp_m1(-fog.optical_depth(ray, t))
    }
}

impl Fog {
    /// The fraction of light that the fog absorbs along `ray` (whose direction is a unit vector) up to `t`, which may
    /// be infinite: 1 - exp(-∫ density). expm1 keeps the digits of thin fog.
    #[inline(always)]
    pub fn opacity<F: Real>(&self, ray: &LaneRay<F>, t: F) -> F {
        opacity(self, ray, t)
    }

    /// The optical depth: the integral of the density up to `t`.
    #[inline(always)]
    fn optical_depth<F: Real>(&self, ray: &LaneRay<F>, t: F) -> F {
        let (zero, infinite) = (F::splat(0.0), F::splat(f64::INFINITY));
        // Zero density comes first: a segment of length 0 and a density of 0 could each give 0 · ∞ below.
        if self.density == 0.0 {
            return zero;
        }
        let density = F::splat(self.density);
        let Some(Falloff { base, height }) = self.falloff else {
            return F::select(t.eq(zero), zero, density * t);
        };
        let (base, height) = (F::splat(base), F::splat(height));
        let climb = ray.direction.y;
        let is_endless = t.eq(infinite) & climb.le(zero);
        // The density at the lower end of the segment. At the upper end it underflows on long segments.
        let descent = F::select(climb.lt(zero), climb * t, zero);
        let low = density * exp(-((ray.origin.y + descent - base) / height));
        // ∫₀ᵗ exp(-rise·s) ds. Nearly level segments need expm1. Where the exponent is below epsilon, the limit `t` is
        // exact.
        let rise = climb.abs() / height;
        let climbed = rise * t;
        let length = F::select(F::splat(f64::EPSILON).lt(climbed), -exp_m1(-climbed) / rise, t);
        // If the density underflows or overflows, the length does not matter.
        let is_extreme = low.eq(zero) | low.eq(infinite);
        let optical_depth = F::select(is_extreme, low, low * length);
        let optical_depth = F::select(is_endless, infinite, optical_depth);
        F::select(t.eq(zero), zero, optical_depth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::DVec3;

    fn fog(density: f64, falloff: Option<Falloff>) -> Fog {
        Fog { in_scattering: GroupRadiance::default(), density, falloff }
    }

    fn from(origin: DVec3, direction: DVec3) -> LaneRay<f64> {
        LaneRay { origin: origin.into(), direction: direction.into() }
    }

    fn along(direction: DVec3) -> LaneRay<f64> {
        from(DVec3::ZERO, direction)
    }

    #[test]
    fn sh_11_fog_extremes() {
        for (way, expected) in [(1e-8, 9.999_999_95e-9), (0.1, 0.095_162_581_964), (80.0, 1.0), (1e4, 1.0)] {
            let opacity = fog(0.5, None).opacity(&along(DVec3::X), way / 0.5);
            assert!((opacity / expected - 1.0).abs() < 1e-9, "{way}: {opacity}");
        }
        assert_eq!(fog(0.0, None).opacity(&along(DVec3::X), f64::INFINITY), 0.0);
        assert_eq!(fog(1e-9, None).opacity(&along(DVec3::X), f64::INFINITY), 1.0);
    }

    #[test]
    fn falloff_agrees_with_a_sum_of_short_ways() {
        let thin = fog(0.3, Some(Falloff { base: 1.0, height: 2.0 }));
        for y in [-0.8, -1e-9, 0.0, 1e-12, 0.3, 1.0] {
            let ray = along(DVec3::new((1.0_f64 - y * y).sqrt(), y, 0.0));
            let steps = 100_000;
            let step = 7.0 / f64::from(steps);
            let sum: f64 = (0..steps)
                .map(|k| 0.3 * libm::exp(-(y * (f64::from(k) + 0.5) * step - 1.0) / 2.0) * step)
                .sum();
            assert!((thin.optical_depth(&ray, 7.0) / sum - 1.0).abs() < 1e-8, "{y}");
        }
        // An infinite segment upwards keeps some light. Downwards and level, it keeps none.
        let up = thin.opacity(&along(DVec3::Y), f64::INFINITY);
        assert!((up + libm::expm1(-0.6 * libm::exp(0.5))).abs() < 1e-15);
        for direction in [DVec3::X, DVec3::NEG_Y, DVec3::new(0.8, -0.6, 0.0)] {
            assert_eq!(thin.opacity(&along(direction), f64::INFINITY), 1.0);
        }
    }

    /// Straight down to `ground`: a difference of two exponential functions.
    #[test]
    fn the_way_down_is_as_thick_as_its_closed_form_says() {
        let falloff = Falloff { base: 0.0, height: 1.0 };
        let fog = fog(0.5, Some(falloff));
        let high = [1e-9, 0.5, 1.0, 36.0, 600.0, 700.0, 709.0, 710.0, 711.0, 745.0, 760.0, 1e4, 1e10, 1e100];
        for ground in [-2.0, 0.0, 3.0] {
            for above in high {
                let ray = from(DVec3::new(0.0, ground + above, 0.0), DVec3::NEG_Y);
                let way = ray.origin.y - ground;
                // From great heights, the rounded length does not end exactly on the ground.
                let expected = 0.5 * libm::exp(way - ray.origin.y) * -libm::expm1(-way);
                let down = fog.optical_depth(&ray, way);
                assert!((down / expected - 1.0).abs() <= 1e-12, "{above} over {ground}: {down}");
            }
        }
        for above in [600.0, 711.0, 760.0, 1e6] {
            let back = along(DVec3::Y);
            let down = from(DVec3::Y * above, DVec3::NEG_Y);
            assert_eq!(fog.optical_depth(&down, above), fog.optical_depth(&back, above), "there and back");
        }
    }

    #[test]
    fn level_and_endless_ways_have_their_limits() {
        let fog = fog(0.5, Some(Falloff { base: 1.0, height: 2.0 }));
        let optical_depth =
            |y: f64, direction: DVec3, t: f64| fog.optical_depth(&from(DVec3::Y * y, direction), t);
        for y in [-50.0, 0.0, 1.0, 100.0] {
            let here = 0.5 * libm::exp(-(y - 1.0) / 2.0);
            for tilt in [0.0, 5e-324, -5e-324, 1e-300] {
                assert_eq!(optical_depth(y, DVec3::new(1.0, tilt, 0.0), 7.0), here * 7.0, "level at {y}");
            }
            assert!((optical_depth(y, DVec3::Y, f64::INFINITY) / (here * 2.0) - 1.0).abs() < 1e-15);
        }
        for y in [-1e300, 0.0, 760.0, 1e300] {
            assert_eq!(optical_depth(y, DVec3::NEG_Y, f64::INFINITY), f64::INFINITY);
            assert_eq!(optical_depth(y, DVec3::X, f64::INFINITY), f64::INFINITY);
            assert_eq!(optical_depth(y, DVec3::NEG_Y, 0.0), 0.0);
        }
        assert_eq!(optical_depth(1e300, DVec3::Y, f64::INFINITY), 0.0);
    }

    #[test]
    fn no_way_is_without_a_thickness() {
        let heights = [-1e300, -1e9, -700.0, 0.0, 1e-300, 711.0, 1e9, 1e300];
        let lengths = [0.0, 5e-324, 1e-300, 1.0, 1e9, 1e300, f64::INFINITY];
        let climbs = [-1e300, -1.0, -1e-300, -5e-324, 0.0, 5e-324, 1e-300, 1.0, 1e300];
        let scales = [f64::MIN_POSITIVE, 1e-9, 1.0, 1e300];
        for (y, base) in heights.iter().flat_map(|y| heights.map(|base| (*y, base))) {
            for (t, climb) in lengths.iter().flat_map(|t| climbs.map(|climb| (*t, climb))) {
                for (height, density) in scales.iter().flat_map(|h| [1e-300, 1.0, 1e300].map(|d| (*h, d))) {
                    let fog = fog(density, Some(Falloff { base, height }));
                    let ray = from(DVec3::Y * y, DVec3::new(0.0, climb, 0.0));
                    let (optical_depth, opacity) = (fog.optical_depth(&ray, t), fog.opacity(&ray, t));
                    let what = || format!("{t} along {climb} from {y} in {fog:?}");
                    assert!(optical_depth >= 0.0 && (0.0..=1.0).contains(&opacity), "{}", what());
                }
            }
        }
    }
}
