//! Lights: what shines, from where, and what dims it over time.

use crate::color::Rgb;
use crate::film::LayerId;
use crate::math::DVec3;
use crate::time::Time;
use crate::track::Animated;
use bevy_ecs::component::Component;

/// A light at one moment, without what keys weight: switching and fading it touch its layer's weight alone.
#[derive(Clone, Copy, Component, Debug, PartialEq)]
pub struct Light {
    pub position: DVec3,
    /// The product of everything about colour and intensity that never changes.
    pub radiance: Rgb,
    /// Where its light is collected: shared by lights whose weights are keyed alike.
    pub layer: LayerId,
}

/// A light over time.
#[derive(Clone, Component, Debug, PartialEq)]
pub struct LightTracks {
    pub kind: LightKind,
    pub color: Animated<Rgb>,
    /// At least 0. A light of intensity 1 facing a surface of diffuse 1 gives radiance 1.
    pub intensity: Animated<f64>,
    pub on: Animated<bool>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// Shines evenly from one point, without fall-off.
    Point { position: Animated<DVec3> },
}

impl LightKind {
    pub fn position(&self, time: Time) -> DVec3 {
        match self {
            Self::Point { position } => position.at(time),
        }
    }
}

impl LightTracks {
    /// What weights this light over time; lights with equal dimmers share a layer.
    pub fn dimmer(&self) -> Dimmer {
        fn keyed<T: Clone>(value: &Animated<T>) -> Option<Animated<T>> {
            matches!(value, Animated::Keyed(_)).then(|| value.clone())
        }
        Dimmer { on: keyed(&self.on), intensity: keyed(&self.intensity), color: keyed(&self.color) }
    }

    /// The product of the parts that are constant.
    pub fn constant_radiance(&self) -> Rgb {
        let mut radiance = Rgb::ONE;
        if let Animated::Constant(color) = &self.color {
            radiance *= *color;
        }
        if let Animated::Constant(intensity) = &self.intensity {
            radiance *= *intensity as f32;
        }
        if self.on == Animated::Constant(false) { Rgb::ZERO } else { radiance }
    }
}

/// A colour from no place in particular, split like a [`Light`]:
/// its layer weights what is keyed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glow {
    pub radiance: Rgb,
    pub layer: LayerId,
}

impl Default for Glow {
    fn default() -> Self {
        Self { radiance: Rgb::ZERO, layer: LayerId::CONSTANT }
    }
}

impl Glow {
    /// The constant part of a colour over time, and what weights it.
    pub fn split(color: &Animated<Rgb>) -> (Rgb, Dimmer) {
        match color {
            Animated::Constant(radiance) => (*radiance, Dimmer::default()),
            Animated::Keyed(_) => (Rgb::ONE, Dimmer { color: Some(color.clone()), ..Dimmer::default() }),
        }
    }
}

/// The keyed parts of a colour times an intensity times a switch.
#[derive(Clone, Component, Debug, Default, PartialEq)]
pub struct Dimmer {
    pub on: Option<Animated<bool>>,
    pub intensity: Option<Animated<f64>>,
    pub color: Option<Animated<Rgb>>,
}

impl Dimmer {
    pub fn is_constant(&self) -> bool {
        *self == Self::default()
    }

    /// The weight at `time`: 1 for a dimmer without keys.
    pub fn at(&self, time: Time) -> Rgb {
        if self.on.as_ref().is_some_and(|on| !on.at(time)) {
            return Rgb::ZERO;
        }
        let color = self.color.as_ref().map_or(Rgb::ONE, |color| color.at(time).max(Rgb::ZERO));
        let intensity = self.intensity.as_ref().map_or(1.0, |intensity| intensity.at(time).max(0.0));
        color * intensity as f32
    }
}
