//! Light in two factors: a constant part, which is traced, and a keyed weight, which each frame applies to a layer.

use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::time::Time;
use crate::film::LayerId;
use crate::track::{Animated, Switch};
use bevy_ecs::component::Component;

/// Radiance without a position, as of ambient light or fog: the constant part, and the layer that the keyed part
/// weights.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct GroupRadiance {
    pub radiance: Rgb,
    pub layer: LayerId,
}

impl Default for GroupRadiance {
    fn default() -> Self {
        Self { radiance: Rgb::ZERO, layer: LayerId::CONSTANT }
    }
}

impl GroupRadiance {
    /// Splits a colour over time into its constant part and its keyed weight.
    pub fn split(color: &Animated<Rgb>) -> (Rgb, GroupWeight) {
        match color {
            Animated::Constant(radiance) => (*radiance, GroupWeight::default()),
            Animated::Keyed(_) => {
                (Rgb::ONE, GroupWeight { color: Some(color.clone()), ..GroupWeight::default() })
            }
        }
    }
}

/// The keyed factors of a light: its switch, its intensity and its colour. A factor without keys is `None`.
#[derive(Clone, Component, Debug, Default, PartialEq)]
pub struct GroupWeight {
    pub on: Option<Switch>,
    pub intensity: Option<Animated<f64>>,
    pub color: Option<Animated<Rgb>>,
}

impl GroupWeight {
    /// Splits a switch, an intensity and a colour into the product of the constant factors and the keyed factors.
    pub fn split(on: &Switch, intensity: &Animated<f64>, color: &Animated<Rgb>) -> (Rgb, Self) {
        fn keyed<T: Clone>(value: &Animated<T>) -> Option<Animated<T>> {
            matches!(value, Animated::Keyed(_)).then(|| value.clone())
        }
        let mut radiance = Rgb::ONE;
        if let Animated::Constant(color) = color {
            radiance *= *color;
        }
        if let Animated::Constant(intensity) = intensity {
            radiance *= *intensity as f32;
        }
        // If a factor is 0 or off at every key, it is so between the keys as well, whatever the easing.
        let never = on.is_never_on()
            || intensity.values().all(|intensity| *intensity <= 0.0)
            || color.values().all(|color| *color == Rgb::ZERO);
        if never {
            return (Rgb::ZERO, Self::default());
        }
        (
            radiance,
            Self { on: on.is_keyed().then(|| on.clone()), intensity: keyed(intensity), color: keyed(color) },
        )
    }

    pub fn is_constant(&self) -> bool {
        *self == Self::default()
    }

    /// The weight at `time`. It is 1 if nothing has keys.
    pub fn at(&self, time: Time) -> Rgb {
        if self.on.as_ref().is_some_and(|on| !on.at(time)) {
            return Rgb::ZERO;
        }
        let color = self.color.as_ref().map_or(Rgb::ONE, |color| color.at(time).max(Rgb::ZERO));
        let intensity = self.intensity.as_ref().map_or(1.0, |intensity| intensity.at(time).max(0.0));
        color * intensity as f32
    }
}
