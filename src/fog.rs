//! Fog: light that is lost on the way to the eye, and the fog's own light in its place.

use crate::camera::Ray;
use crate::color::Rgb;
use crate::glow::{Dimmer, Glow};
use crate::time::Time;
use crate::track::Animated;
use bevy_ecs::component::Component;

/// Fog at one moment.
#[derive(Clone, Copy, Component, Debug, PartialEq)]
pub struct Fog {
    /// What a way without end through the fog looks like.
    pub glow: Glow,
    /// Lost share per unit of length for a short way; where there is a falloff, at its base.
    pub density: f64,
    pub falloff: Option<Falloff>,
}

/// Fog that grows thinner with height: its density is `density`·exp(-(y - `base`) / `height`).
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// The fog at a moment; `glow` is its light, split off once.
    pub fn at(&self, time: Time, glow: Glow) -> Fog {
        let falloff = self.falloff.as_ref().map(|falloff| Falloff {
            base: falloff.base.at(time),
            height: falloff.height.at(time).max(f64::MIN_POSITIVE),
        });
        Fog { glow, density: self.density.at(time).max(0.0), falloff }
    }

    /// The fog's light that is traced, and what weights it over time.
    pub fn split(&self) -> (Rgb, Dimmer) {
        Glow::split(&self.color)
    }
}

impl Fog {
    /// The share of light that is lost on the way along `ray` (whose direction is a unit vector) up to `t`,
    /// which may be infinite: 1 - exp(-∫ density), by `expm1`, which keeps the digits of thin fog.
    pub fn opacity(&self, ray: &Ray, t: f64) -> f64 {
        -libm::expm1(-self.thickness(ray, t))
    }

    /// The integral of the density along the way.
    fn thickness(&self, ray: &Ray, t: f64) -> f64 {
        // Asked for first, as a way without end through no fog would be 0 · ∞.
        if self.density == 0.0 {
            return 0.0;
        }
        let Some(Falloff { base, height }) = self.falloff else { return self.density * t };
        let here = self.density * libm::exp(-(ray.origin.y - base) / height);
        if here == 0.0 {
            return 0.0;
        }
        let rise = ray.direction.y / height;
        let climbed = rise * t;
        if rise == 0.0 {
            here * t
        } else if climbed == f64::INFINITY {
            here / rise
        } else {
            // ∫₀ᵗ exp(-rise·s) ds; level ways need the series that expm1 is.
            here * (-libm::expm1(-climbed) / rise)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;

    fn fog(density: f64, falloff: Option<Falloff>) -> Fog {
        Fog { glow: Glow::default(), density, falloff }
    }

    fn along(direction: DVec3) -> Ray {
        Ray { origin: DVec3::ZERO, direction }
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
            assert!((thin.thickness(&ray, 7.0) / sum - 1.0).abs() < 1e-8, "{y}");
        }
        // Upwards without end some light is left, downwards and level none.
        let up = thin.opacity(&along(DVec3::Y), f64::INFINITY);
        assert!((up + libm::expm1(-0.6 * libm::exp(0.5))).abs() < 1e-15);
        for direction in [DVec3::X, DVec3::NEG_Y, DVec3::new(0.8, -0.6, 0.0)] {
            assert_eq!(thin.opacity(&along(direction), f64::INFINITY), 1.0);
        }
    }
}
