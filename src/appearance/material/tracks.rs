//! Materials over time.

use super::{Exponent, Highlight, Lobes, Material, Medium, Slot};
use crate::appearance::light_groups::glow::Dimmer;
use crate::appearance::optics::Fresnel;
use crate::appearance::texture::{Paint, PaintTracks};
use crate::base::color::Rgb;
use crate::base::time::Time;
use crate::film::LayerId;
use crate::track::Animated;
use bevy_ecs::component::Component;

/// A lobe over time: a strength (at least 0) times a tint.
#[derive(Clone, Debug, PartialEq)]
pub struct Lobe {
    pub strength: Animated<f64>,
    pub tint: PaintTracks,
}

/// A number of 0..=1 over time, which paint may vary over the surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Level {
    Even(Animated<f64>),
    Painted(PaintTracks),
}

/// A material over time.
#[derive(Clone, Component, Debug, PartialEq)]
pub struct MaterialTracks {
    pub emission: Lobe,
    pub ambient: Lobe,
    pub diffuse: Lobe,
    pub specular: Lobe,
    pub mirror: Lobe,
    pub fuzz: Level,
    pub transparency: Lobe,
    pub refraction: Lobe,
    pub microfacet: Animated<f64>,
    /// The surface's own colour. Its alpha says how much of the surface is there.
    pub base: PaintTracks,
    pub metallic: Level,
    pub roughness: Level,
    pub highlight: Highlight,
    pub shininess: Animated<f64>,
    pub fresnel: Fresnel,
    pub ior: Animated<f64>,
    pub absorption: Animated<Rgb>,
    pub priority: i32,
}

/// An index of refraction is never less, whatever an easing makes of it.
const LEAST_IOR: f64 = 1e-3;

impl MaterialTracks {
    /// The material at a moment; its emission is collected in `emission_layer`.
    pub fn at(&self, time: Time, emission_layer: LayerId) -> Material {
        let mut paints = Paints(Vec::new());
        let mut lobe = |slot, lobe: &Lobe| paints.over(slot, &lobe.tint, time) * level(&lobe.strength, time);
        let mut lobes = Lobes {
            ambient: lobe(Slot::Ambient, &self.ambient),
            diffuse: lobe(Slot::Diffuse, &self.diffuse),
            specular: lobe(Slot::Specular, &self.specular),
            mirror: lobe(Slot::Mirror, &self.mirror),
            transparency: lobe(Slot::Transparency, &self.transparency),
            refraction: lobe(Slot::Refraction, &self.refraction),
            ..Lobes::default()
        };
        lobes.emission = match &self.emission.tint {
            PaintTracks::Color(_) => self.emission_split().0,
            paint => paints.over(Slot::Emission, paint, time) * self.emission_split().0,
        };
        lobes.microfacet = level(&self.microfacet, time);
        lobes.base = paints.over(Slot::Base, &self.base, time);
        paints.coverage(&self.base, time);
        lobes.fuzz = paints.level(Slot::Fuzz, &self.fuzz, time);
        lobes.metallic = paints.level(Slot::Metallic, &self.metallic, time);
        lobes.roughness = paints.level(Slot::Roughness, &self.roughness, time);
        paints.0.retain_mut(|(slots, _)| {
            slots.retain(|slot| !is_absent(*slot, &lobes));
            !slots.is_empty()
        });
        // What a lobe without strength is like makes no difference, and so is not told.
        let (shines, refracts) = (lobes.specular != Rgb::ZERO, lobes.refraction != Rgb::ZERO);
        lobes.fuzz = if lobes.mirror == Rgb::ZERO { 0.0 } else { lobes.fuzz };
        if lobes.microfacet == 0.0 {
            (lobes.base, lobes.metallic, lobes.roughness) = (Rgb::ZERO, 0.0, 0.0);
        }
        Material {
            lobes,
            paints: paints.0,
            emission_layer,
            highlight: if shines { self.highlight } else { Highlight::default() },
            shininess: Exponent::new(if shines { self.shininess.at(time).max(0.0) } else { 0.0 }),
            fresnel: if refracts { self.fresnel } else { Fresnel::default() },
            medium: self.medium(refracts, lobes.microfacet > 0.0, time),
        }
    }

    /// What is behind the surface: all of it matters to what is refracted, the index alone to small mirrors.
    fn medium(&self, refracts: bool, mirrors: bool, time: Time) -> Medium {
        let ior = if refracts || mirrors { self.ior.at(time).max(LEAST_IOR) } else { Medium::EMPTY.ior };
        if !refracts {
            return Medium { ior, ..Medium::EMPTY };
        }
        Medium { ior, absorption: self.absorption.at(time).max(Rgb::ZERO), priority: self.priority }
    }

    /// The emission that is traced, but for paint, and what weights it over time.
    pub fn emission_split(&self) -> (Rgb, Dimmer) {
        let white = Animated::Constant(Rgb::ONE);
        let tint = if let PaintTracks::Color(color) = &self.emission.tint { color } else { &white };
        Dimmer::split(&Animated::Constant(true), &self.emission.strength, tint)
    }
}

/// A strength; an easing that overshoots must not turn it negative.
fn level(strength: &Animated<f64>, time: Time) -> f32 {
    strength.at(time).max(0.0) as f32
}

/// Whether a slot is zero whatever paint says: then its paint is not called for.
fn is_absent(slot: Slot, lobes: &Lobes) -> bool {
    match slot {
        Slot::Emission => lobes.emission == Rgb::ZERO,
        Slot::Ambient => lobes.ambient == Rgb::ZERO,
        Slot::Diffuse => lobes.diffuse == Rgb::ZERO,
        Slot::Specular => lobes.specular == Rgb::ZERO,
        Slot::Mirror => lobes.mirror == Rgb::ZERO,
        Slot::Fuzz => lobes.fuzz == 0.0 || lobes.mirror == Rgb::ZERO,
        Slot::Transparency => lobes.transparency == Rgb::ZERO,
        Slot::Refraction => lobes.refraction == Rgb::ZERO,
        Slot::Base | Slot::Metallic | Slot::Roughness => lobes.microfacet == 0.0,
        Slot::Coverage => false,
    }
}

/// The paints met so far, each with its slots.
struct Paints(Vec<(Vec<Slot>, Paint)>);

impl Paints {
    /// The constant factor of a slot; what varies is noted.
    fn over(&mut self, slot: Slot, tint: &PaintTracks, time: Time) -> Rgb {
        self.note(slot, tint.at(time))
    }

    fn note(&mut self, slot: Slot, paint: Paint) -> Rgb {
        if let Some(color) = paint.constant() {
            return color;
        }
        match self.0.iter_mut().find(|(_, known)| *known == paint) {
            Some((slots, _)) => slots.push(slot),
            None => self.0.push((vec![slot], paint)),
        }
        Rgb::ONE
    }

    /// Notes how much of the surface is there, if that is not all of it.
    fn coverage(&mut self, base: &PaintTracks, time: Time) {
        let paint = base.at(time);
        if paint.has_alpha() {
            self.note(Slot::Coverage, paint);
        }
    }

    fn level(&mut self, slot: Slot, tracks: &Level, time: Time) -> f32 {
        match tracks {
            Level::Even(value) => level(value, time).min(1.0),
            // Numbers have no alpha.
            Level::Painted(paint) => (self.note(slot, paint.at(time).opaque()).element_sum() / 3.0).min(1.0),
        }
    }
}
