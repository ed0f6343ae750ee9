//! Lights: their shape, position and radiance.

mod attenuation;
mod tracks;

pub use attenuation::Attenuation;
pub use tracks::{LightKind, LightTracks};

use crate::base::color::Rgb;
use crate::base::digest::{Content, Digester};
use crate::base::lanes::Real;
use crate::base::math::DVec3;
use crate::film::LayerId;
use crate::geometry::shape::{Rectangle, Sphere};
use bevy_ecs::component::Component;

/// A light at one moment, without its keyed weight. Switching and fading a light change only the weight of its layer.
#[derive(Clone, Copy, Component, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct Light {
    /// Where the light comes from.
    pub source: Source,
    /// The product of the constant factors of colour and intensity. A point, spot or directional light of radiance 1
    /// gives radiance 1 on a facing surface of diffuse 1. An area light has this radiance, seen from any distance.
    pub radiance: Rgb,
    /// Whether objects block its light. They always do for area lights.
    pub shadows: bool,
    /// The film layer of its light. Lights with equal keyed weights share a layer.
    pub layer: LayerId,
}

/// A light that casts shadows feeds what it did before there were others.
impl Content for Light {
    fn feed(&self, into: &mut Digester) {
        let Self { source, radiance, shadows, layer } = self;
        if !shadows {
            // No source has this name.
            "without shadows".feed(into);
        }
        source.feed(into);
        radiance.feed(into);
        layer.feed(into);
    }
}

/// The shape and position of a light.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub enum Source {
    /// Light from one point, the same in all directions.
    Point {
        /// The point.
        position: DVec3,
        /// What is left at a distance.
        attenuation: Attenuation,
    },
    /// Light from one point into a cone.
    Spot {
        /// The point.
        position: DVec3,
        /// The directions that get light.
        cone: SpotCone,
        /// What is left at a distance.
        attenuation: Attenuation,
    },
    /// Light from infinitely far away.
    Directional {
        /// The unit vector towards the light.
        to_light: DVec3,
    },
    /// Every point of a sphere emits outwards.
    Sphere(Sphere),
    /// Every point of a rectangle emits, to both sides or only to the side of `u` × `v`.
    Rectangle {
        /// The rectangle.
        rectangle: Rectangle,
        /// Whether only the side of `u` × `v` emits.
        one_sided: bool,
    },
}

#[warn(missing_docs)]
impl Source {
    /// Whether light arrives from more than one direction, so that sampling it takes random numbers.
    pub fn is_sampled(&self) -> bool {
        matches!(self, Self::Sphere(_) | Self::Rectangle { .. })
    }
}

/// The cone of a spot light.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct SpotCone {
    /// Unit vector along the axis of the cone, away from the light.
    pub axis: DVec3,
    /// Cosines of two angles to the axis: full light up to the first, none from the second on.
    pub cos_falloff_start: f64,
    pub cos_falloff_end: f64,
}

impl SpotCone {
    /// The fraction of the light in a direction of this cosine to the axis, by smoothstep between the two angles.
    #[inline(always)]
    pub fn share<F: Real>(&self, cosine: F) -> F {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let s = (cosine - F::splat(self.cos_falloff_end))
            / F::splat(self.cos_falloff_start - self.cos_falloff_end);
        let smooth = s * s * (F::splat(3.0) - F::splat(2.0) * s);
        let edge = F::select(cosine.le(F::splat(self.cos_falloff_end)), zero, smooth);
        F::select(F::splat(self.cos_falloff_start).le(cosine), one, edge)
    }
}
