//! Materials: how much of each lobe a surface has.

mod exponent;
mod lobes;
mod tracks;

pub use exponent::{Exponent, Highlight};
pub use lobes::{Lobes, SHARP, Slot};
pub use tracks::{Level, Lobe, MaterialTracks};

use crate::appearance::optics::Fresnel;
use crate::appearance::texture::{Paint, Spot, Texel};
use crate::base::color::Rgb;
use crate::base::digest::content;
use crate::film::LayerId;
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
        let mut coverage = 1.0;
        for (slots, paint) in &self.paints {
            let Texel { color, alpha } = paint.at(spot);
            // What is not there of the surface's own colour is not there of the surface; of a lobe's, of that lobe.
            let color = match slots.contains(&Slot::Coverage) {
                true => {
                    coverage = alpha;
                    color
                }
                false => color * alpha,
            };
            slots.iter().for_each(|slot| lobes.tint(*slot, color));
        }
        if coverage == 1.0 { lobes } else { lobes.covering(coverage) }
    }

    /// Whether light passes the surface straight on anywhere.
    pub fn is_clear(&self) -> bool {
        self.lobes.transparency != Rgb::ZERO || self.is_cut_out()
    }

    /// Whether parts of the surface are not there.
    pub fn is_cut_out(&self) -> bool {
        self.paints.iter().any(|(slots, _)| slots.contains(&Slot::Coverage))
    }

    /// Whether paint says anything that matters where so many surfaces are left that may reflect or bend light: with none
    /// left, what the surface gives off and lets pass.
    pub fn is_painted(&self, left: u32) -> bool {
        let passed = [Slot::Emission, Slot::Transparency, Slot::Coverage];
        let matters = |slots: &[Slot]| left > 0 || slots.iter().any(|slot| passed.contains(slot));
        self.paints.iter().any(|(slots, _)| matters(slots))
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
}
