//! What a path may find light by asking for: lights, objects that shine, and skies that are brighter in some
//! directions. Grouped by layer, so that what one layer asks never depends on another.

use super::lights::{Arrival, Origin, arrival};
use super::shade::Seen;
use super::tracer::{Dice, Tracer};
use crate::bvh::Hit;
use crate::color::Rgb;
use crate::environment::SkyTable;
use crate::film::LayerId;
use crate::light::{Light, Source};
use crate::material::MadeOf;
use crate::math::{DVec2, DVec3};
use crate::sampling::Use;
use crate::scene::Finish;
use crate::shape::{Crossing, Surface};
use crate::texture::Footprint;
use std::f64::consts::PI;

/// One source of light.
#[derive(Clone, Copy, Debug)]
enum Luminaire<'a> {
    /// The light of this index in the scene.
    Light(u32, Light),
    /// The primitive of this index shines.
    Object(u32),
    Sky(&'a SkyTable),
}

/// Sources of one layer that are each asked at every surface; of more than these, one.
const ASKED: usize = 8;

struct Group<'a> {
    layer: LayerId,
    members: Vec<Luminaire<'a>>,
    /// The chance of each member; none if all are asked.
    chances: Option<Chances>,
}

/// Chances of a few things, and their sums.
struct Chances {
    each: Vec<f64>,
    up_to: Vec<f64>,
}

pub struct Luminaires<'a> {
    groups: Vec<Group<'a>>,
    /// Of every primitive: the chance with which it is asked, if it is a source.
    primitives: Vec<Option<f64>>,
    sky: Option<(&'a SkyTable, f64)>,
}

/// Light from a source, with the chance that it was drawn in its density.
pub struct Asked {
    pub layer: LayerId,
    pub arrival: Arrival,
}

impl<'a> Luminaires<'a> {
    pub fn new(tracer: &Tracer<'a>) -> Self {
        let mut groups: Vec<Group<'a>> = Vec::new();
        for (layer, luminaire) in sources(tracer) {
            match groups.iter_mut().find(|group| group.layer == layer) {
                Some(group) => group.members.push(luminaire),
                None => groups.push(Group { layer, members: vec![luminaire], chances: None }),
            }
        }
        let mut all = Self { groups, primitives: Vec::new(), sky: None };
        let primitives = &tracer.scene.geometry.primitives;
        all.primitives.resize(primitives.len(), None);
        let mut lights = vec![None; tracer.scene.shading.lights.len()];
        for group in &mut all.groups {
            if group.members.len() > ASKED {
                group.chances = Some(Chances::of(group.members.iter().map(|member| member.power(tracer))));
            }
            for (index, member) in group.members.iter().enumerate() {
                let chance = group.chances.as_ref().map_or(1.0, |chances| chances.each[index]);
                match member {
                    Luminaire::Light(light, _) => lights[*light as usize] = Some(chance),
                    Luminaire::Object(primitive) => all.primitives[*primitive as usize] = Some(chance),
                    Luminaire::Sky(table) => all.sky = Some((table, chance)),
                }
            }
        }
        for (primitive, noted) in primitives.iter().zip(&mut all.primitives) {
            if let Finish::Light(light) = primitive.finish {
                *noted = lights[light as usize];
            }
        }
        all
    }

    /// All sources in the order in which they are asked, if each is a light without an area that is asked every time.
    pub fn plain_lights(&self) -> Option<Vec<Light>> {
        let all = self.groups.iter().flat_map(|group| &group.members);
        let plain = all.map(|member| match member {
            Luminaire::Light(_, light) if !light.source.is_sampled() => Some(*light),
            _ => None,
        });
        let chosen = self.groups.iter().any(|group| group.chances.is_some());
        if chosen { None } else { plain.collect() }
    }

    /// Asks every layer's sources for light at a point that is seen.
    pub fn ask(&self, tracer: &Tracer, seen: &Seen, dice: Dice, mut take: impl FnMut(Asked)) {
        let surface = dice.surface;
        for group in &self.groups {
            let number = group.layer.0;
            let mut ask = |index: usize, chance: f64, turn: u32| {
                let light = number.wrapping_mul(2 * ASKED as u32).wrapping_add(turn);
                let member = &group.members[index];
                let u = match member.is_sampled() {
                    true => dice.sampler.two(Use::Light { surface, light }),
                    false => DVec2::ZERO,
                };
                let arrival = member.arrival(tracer, seen, u);
                if let Some(arrival) = arrival {
                    take(Asked { layer: group.layer, arrival: arrival.with_chance(chance) });
                }
            };
            match &group.chances {
                None => (0..group.members.len()).for_each(|index| ask(index, 1.0, index as u32)),
                Some(chances) => {
                    let u = dice.sampler.two(Use::Choice { surface, layer: number }).x;
                    let index = chances.pick(u);
                    ask(index, chances.each[index], ASKED as u32);
                }
            }
        }
    }

    /// The density per solid angle with which a point of a primitive is asked for light at `from`; none if it
    /// never is.
    pub fn density(&self, tracer: &Tracer, from: DVec3, hit: &Hit, surface: &Surface) -> Option<f64> {
        let chance = self.primitives[hit.primitive as usize]?;
        let primitive = &tracer.scene.geometry.primitives[hit.primitive as usize];
        Some(primitive.density_from(from, surface)? * chance)
    }

    /// Whether the sky is asked for light.
    pub fn sky_is_asked(&self) -> bool {
        self.sky.is_some()
    }

    /// The density per solid angle with which the sky is asked for light from a direction; none if it never is.
    pub fn sky_density(&self, tracer: &Tracer, direction: DVec3) -> Option<f64> {
        let ((table, chance), environment) = self.sky.zip(tracer.environment)?;
        Some(environment.pdf(table, direction) * chance)
    }
}

/// All sources of a scene with their layers, in a fixed order.
fn sources<'a>(tracer: &Tracer<'a>) -> Vec<(LayerId, Luminaire<'a>)> {
    let (scene, shading) = (tracer.scene, tracer.scene.shading);
    let lights = tracer.lights.iter().map(|(index, light)| (light.layer, Luminaire::Light(*index, *light)));
    let objects = (0..).zip(&scene.geometry.primitives).filter_map(|(index, primitive)| {
        // Meshes of several materials are found by chance: they have no one emission to choose points by.
        let Finish::Material(MadeOf::One(material)) = primitive.finish else { return None };
        let material = &shading.materials[material as usize];
        let weighted = scene.weights.0[material.emission_layer.index()] != Rgb::ZERO;
        let shines = weighted && material.lobes.emission != Rgb::ZERO && primitive.has_area();
        shines.then_some((material.emission_layer, Luminaire::Object(index)))
    });
    let sky = tracer.environment.zip(shading.sky_table.as_deref());
    let sky = sky.map(|(environment, table)| (environment.layer, Luminaire::Sky(table)));
    lights.chain(objects).chain(sky).collect()
}

impl Luminaire<'_> {
    /// Whether its light comes from more than one direction, so that one has to be drawn.
    fn is_sampled(&self) -> bool {
        match self {
            Self::Light(_, light) => light.source.is_sampled(),
            Self::Object(_) | Self::Sky(_) => true,
        }
    }

    /// Roughly how much light it gives, which is all that a choice among many goes by.
    fn power(&self, tracer: &Tracer) -> f64 {
        let brightness = |color: Rgb| f64::from(color.element_sum());
        match self {
            Self::Light(_, light) => {
                let area = match &light.source {
                    Source::Sphere(sphere) => 4.0 * PI * sphere.radius * sphere.radius,
                    Source::Rectangle { rectangle, .. } => rectangle.u.cross(rectangle.v).length(),
                    Source::Point { .. } | Source::Spot { .. } | Source::Directional { .. } => 1.0,
                };
                brightness(light.radiance) * area
            }
            Self::Object(index) => {
                let primitive = &tracer.scene.geometry.primitives[*index as usize];
                let Some(material) = primitive.material(0) else { return 0.0 };
                let emission = tracer.scene.shading.materials[material as usize].lobes.emission;
                brightness(emission) * primitive.bounds().map_or(0.0, |bounds| bounds.area())
            }
            Self::Sky(_) => 1.0,
        }
    }

    /// The light that comes from it to a surface, for `u` uniform in the unit square.
    fn arrival(&self, tracer: &Tracer, seen: &Seen, u: DVec2) -> Option<Arrival> {
        match self {
            Self::Light(_, light) => arrival(light, seen, u),
            Self::Sky(table) => {
                let environment = tracer.environment?;
                let (direction, density) = environment.sample(table, u);
                let radiance = environment.radiance(direction) * (1.0 / (PI * density)) as f32;
                Some(Arrival { direction, radiance, density: Some(density), from: Origin::Infinity })
            }
            Self::Object(index) => {
                let primitive = &tracer.scene.geometry.primitives[*index as usize];
                let material = primitive.material(0)?;
                let material = &tracer.scene.shading.materials[material as usize];
                let at = seen.surface.point;
                let (surface, part, density) = primitive.sample_from(at, &seen.frame(), u)?;
                let hit = Hit { at: Crossing::of_part(1.0, part), primitive: *index };
                let emission = match material.paints.is_empty() {
                    true => material.lobes.emission,
                    false => {
                        let spot = tracer.scene.geometry.spot(&hit, &surface, &Footprint::default(), false);
                        material.painted(&spot).emission
                    }
                };
                Some(Arrival::from_surface(at, surface, emission, density))
            }
        }
    }
}

impl Chances {
    fn of(weights: impl Iterator<Item = f64>) -> Self {
        let weights: Vec<f64> = weights.collect();
        let whole: f64 = weights.iter().sum();
        // Sources that all seem to give nothing are asked evenly.
        let even = 1.0 / weights.len() as f64;
        let each: Vec<f64> =
            weights.iter().map(|weight| if whole > 0.0 { weight / whole } else { even }).collect();
        let up_to = each.iter().scan(0.0, |sum, chance| {
            *sum += chance;
            Some(*sum)
        });
        Self { up_to: up_to.collect(), each }
    }

    fn pick(&self, u: f64) -> usize {
        let mut index = self.up_to.partition_point(|sum| *sum <= u).min(self.each.len() - 1);
        // Rounding of the sums must not pick what has no chance.
        while self.each[index] == 0.0 && index > 0 {
            index -= 1;
        }
        index
    }
}
