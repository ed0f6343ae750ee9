//! Lights over time.

use super::{Attenuation, Cone, Source};
use crate::appearance::light_groups::glow::Dimmer;
use crate::base::color::Rgb;
use crate::base::math::{Angle, DVec3};
use crate::base::time::Time;
use crate::geometry::shape::{Rectangle, Sphere};
use crate::track::Animated;
use bevy_ecs::component::Component;

/// A light over time.
#[derive(Clone, Component, Debug, PartialEq)]
pub struct LightTracks {
    pub kind: LightKind,
    pub color: Animated<Rgb>,
    /// At least 0. See [`Light::radiance`](super::Light::radiance) for what it is measured in.
    pub intensity: Animated<f64>,
    pub on: Animated<bool>,
}

/// A [`Source`] over time.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    Point {
        position: Animated<DVec3>,
        attenuation: Attenuation,
    },
    Spot {
        position: Animated<DVec3>,
        target: Animated<DVec3>,
        /// Full angles of the cones outside which there is no light, and inside which there is all.
        angle: Animated<Angle>,
        inner_angle: Option<Animated<Angle>>,
        attenuation: Attenuation,
    },
    Directional {
        /// The way the light goes; any length.
        direction: Animated<DVec3>,
    },
    Sphere {
        center: Animated<DVec3>,
        radius: Animated<f64>,
    },
    Rectangle {
        corner: Animated<DVec3>,
        u: Animated<DVec3>,
        v: Animated<DVec3>,
        one_sided: bool,
    },
}

/// No light is smaller than this, whatever an easing makes of its size.
const SMALLEST: f64 = 1e-30;

impl LightKind {
    pub fn at(&self, time: Time) -> Source {
        match self {
            Self::Point { position, attenuation } => {
                Source::Point { position: position.at(time), attenuation: *attenuation }
            }
            Self::Spot { position, target, angle, inner_angle, attenuation } => {
                let position = position.at(time);
                let none = half_cosine(angle.at(time));
                let full = inner_angle.as_ref().map_or(none, |inner| half_cosine(inner.at(time)));
                // A target on the light itself leaves it shining downwards.
                let axis = (target.at(time) - position).normalize_or(DVec3::NEG_Y);
                let cone = Cone { axis, full: full.max(none), none };
                Source::Spot { position, cone, attenuation: *attenuation }
            }
            Self::Directional { direction } => {
                Source::Directional { to_light: -direction.at(time).normalize_or(DVec3::NEG_Y) }
            }
            Self::Sphere { center, radius } => {
                Source::Sphere(Sphere { center: center.at(time), radius: radius.at(time).max(SMALLEST) })
            }
            Self::Rectangle { corner, u, v, one_sided } => {
                let rectangle = Rectangle { corner: corner.at(time), u: u.at(time), v: v.at(time) };
                Source::Rectangle { rectangle, one_sided: *one_sided }
            }
        }
    }
}

/// Cosine of half an angle of 0..=360 degrees.
fn half_cosine(angle: Angle) -> f64 {
    Angle(angle.0.clamp(0.0, 360.0) * 0.5).cos_sin().x
}

impl LightTracks {
    /// What weights this light over time; lights with equal dimmers share a layer.
    pub fn dimmer(&self) -> Dimmer {
        Dimmer::split(&self.on, &self.intensity, &self.color).1
    }

    /// The product of the parts that are constant.
    pub fn constant_radiance(&self) -> Rgb {
        Dimmer::split(&self.on, &self.intensity, &self.color).0
    }
}
