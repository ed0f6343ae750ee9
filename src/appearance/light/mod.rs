//! Lights: what shines, from where, and what dims it over time.

mod attenuation;
mod tracks;

pub use attenuation::Attenuation;
pub use tracks::{LightKind, LightTracks};

use crate::base::color::Rgb;
use crate::base::digest::content;
use crate::base::lanes::Real;
use crate::base::math::DVec3;
use crate::film::LayerId;
use crate::geometry::shape::{Rectangle, Sphere};
use bevy_ecs::component::Component;

/// A light at one moment, without what keys weight: switching and fading it touch its layer's weight alone.
#[derive(Clone, Copy, Component, Debug, PartialEq)]
pub struct Light {
    pub source: Source,
    /// The product of everything about colour and intensity that never changes. A point, spot or directional
    /// light of radiance 1 facing a surface of diffuse 1 gives radiance 1; an area light is seen as bright
    /// as this from wherever it is seen.
    pub radiance: Rgb,
    /// Where its light is collected: shared by lights whose weights are keyed alike.
    pub layer: LayerId,
}

content!(struct Light { source, radiance, layer });

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// Evenly from one point.
    Point { position: DVec3, attenuation: Attenuation },
    /// From one point into a cone.
    Spot { position: DVec3, cone: Cone, attenuation: Attenuation },
    /// From infinitely far away, from this direction (a unit vector).
    Directional { to_light: DVec3 },
    /// From every point of a sphere, outwards.
    Sphere(Sphere),
    /// From every point of a rectangle: to both sides, or only to that of `u` × `v`.
    Rectangle { rectangle: Rectangle, one_sided: bool },
}

content!(enum Source {
    Point { position, attenuation },
    Spot { position, cone, attenuation },
    Directional { to_light },
    Sphere(sphere),
    Rectangle { rectangle, one_sided },
});

impl Source {
    /// Whether light comes from more than one direction, so that one has to be drawn.
    pub fn is_sampled(&self) -> bool {
        matches!(self, Self::Sphere(_) | Self::Rectangle { .. })
    }
}

/// The cone of a spot light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Unit vector from the light along the middle of its cone.
    pub axis: DVec3,
    /// Cosines of the angles from the axis up to which the light is full, and from which there is none.
    pub full: f64,
    pub none: f64,
}

content!(struct Cone { axis, full, none });

impl Cone {
    /// The share of the light that goes in a direction of this cosine to the axis: smooth from the full light
    /// to none.
    #[inline(always)]
    pub fn share<F: Real>(&self, cosine: F) -> F {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let s = (cosine - F::splat(self.none)) / F::splat(self.full - self.none);
        let smooth = s * s * (F::splat(3.0) - F::splat(2.0) * s);
        let edge = F::select(cosine.le(F::splat(self.none)), zero, smooth);
        F::select(F::splat(self.full).le(cosine), one, edge)
    }
}
