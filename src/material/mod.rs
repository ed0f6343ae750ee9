//! Materials: how much of each lobe a surface has.

mod exponent;
mod lobes;
mod tracks;

pub use exponent::{Exponent, Highlight};
pub use lobes::{Lobes, Slot};
pub use tracks::{Level, Lobe, MaterialTracks};

use crate::color::Rgb;
use crate::digest::content;
use crate::film::LayerId;
use crate::optics::Fresnel;
use crate::texture::{Paint, Spot};
use bevy_ecs::component::Component;
use std::ops::RangeInclusive;

/// What a surface does with light at one moment.
#[derive(Clone, Component, Debug, PartialEq)]
pub struct Material {
    /// The lobes where nothing is painted.
    pub lobes: Lobes,
    /// What varies over the surface: each paint multiplies the lobes of its slots.
    pub paints: Vec<(Vec<Slot>, Paint)>,
    /// Where emission is collected.
    pub emission_layer: LayerId,
    pub highlight: Highlight,
    pub shininess: Exponent,
    pub fresnel: Fresnel,
    pub medium: Medium,
}

content!(struct Material { lobes, paints, emission_layer, highlight, shininess, fresnel, medium });

/// What an object is made of: indices into the scene's materials.
#[derive(Clone, Copy, Component, Debug, PartialEq, Eq)]
pub enum MadeOf {
    /// The same all over.
    One(u32),
    /// The materials that came with its mesh, in the order of their slots from index `first` on. Behind them
    /// stands the one of triangles without a slot.
    Slots { first: u32, count: u32 },
}

content!(enum MadeOf { One(index), Slots { first, count } });

impl MadeOf {
    /// All materials in use.
    pub fn indices(self) -> RangeInclusive<u32> {
        match self {
            Self::One(index) => index..=index,
            Self::Slots { first, count } => first..=first + count,
        }
    }
}

/// What is inside of a surface that refracts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Index of refraction, above 0.
    pub ior: f64,
    /// Absorbed per unit of length: exp(-absorption · d) of the light is left after a way of d.
    pub absorption: Rgb,
    /// Where media overlap, the one of the highest priority is there.
    pub priority: i32,
}

content!(struct Medium { ior, absorption, priority });

impl Material {
    /// The lobes at a point of the surface.
    pub fn painted(&self, spot: &Spot) -> Lobes {
        let mut lobes = self.lobes;
        for (slots, paint) in &self.paints {
            let color = paint.color(spot);
            slots.iter().for_each(|slot| lobes.tint(*slot, color));
        }
        lobes
    }

    /// Whether any paint has a pattern that lies on the surface, by u and v.
    pub fn is_printed(&self) -> bool {
        self.paints.iter().any(|(_, paint)| paint.is_printed())
    }

    /// Whether light enters what the surface encloses.
    pub fn refracts(&self) -> bool {
        self.lobes.refraction != Rgb::ZERO
    }

    /// Whether its reflections are scattered, and so have to be sampled.
    pub fn is_rough(&self) -> bool {
        let lobes = &self.lobes;
        let fuzzy = lobes.fuzz > 0.0 && lobes.mirror != Rgb::ZERO;
        fuzzy || (lobes.microfacet > 0.0 && lobes.roughness > 0.0)
    }
}

impl Medium {
    pub const EMPTY: Self = Self { ior: 1.0, absorption: Rgb::ZERO, priority: i32::MIN };

    /// The share of light that is left after a way of this length.
    pub fn transmittance(&self, length: f64) -> Rgb {
        if self.absorption == Rgb::ZERO {
            return Rgb::ONE;
        }
        // A way without end through what absorbs nothing: 0 · ∞ would be no number.
        let left = |absorption: f32| match absorption {
            0.0 => 1.0,
            absorption => libm::exp(-f64::from(absorption) * length) as f32,
        };
        Rgb::from_array(self.absorption.to_array().map(left))
    }
}
