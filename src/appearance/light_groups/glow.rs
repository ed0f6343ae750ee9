//! Light split in two: what is traced once, and what only weights it from frame to frame.

use crate::base::color::Rgb;
use crate::base::digest::content;
use crate::base::time::Time;
use crate::film::LayerId;
use crate::track::Animated;
use bevy_ecs::component::Component;

/// A colour from no place in particular, split in two: its layer weights what is keyed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glow {
    pub radiance: Rgb,
    pub layer: LayerId,
}

content!(struct Glow { radiance, layer });

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
    /// The keyed ones of a switch, an intensity and a colour, and the product of the constant ones.
    pub fn split(on: &Animated<bool>, intensity: &Animated<f64>, color: &Animated<Rgb>) -> (Rgb, Self) {
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
        // What is 0 or off at every key is so in between: no easing makes anything of it.
        let never = on.values().all(|on| !on)
            || intensity.values().all(|intensity| *intensity <= 0.0)
            || color.values().all(|color| *color == Rgb::ZERO);
        if never {
            return (Rgb::ZERO, Self::default());
        }
        (radiance, Self { on: keyed(on), intensity: keyed(intensity), color: keyed(color) })
    }

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
