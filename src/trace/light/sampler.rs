//! Light sources for next-event estimation: lights, objects that emit, and skies that are brighter in some directions.
//! Grouped by layer, so that what one layer samples never depends on another.

use super::{LightSample, Receiver, sample_light, sky};
use crate::appearance::environment::{Environment, SkyTable};
use crate::appearance::light::{Light, Source};
use crate::appearance::material::MadeOf;
use crate::base::color::Rgb;
use crate::base::lanes::{Bits, Mask, Real, Row, Select, Vec3, out_of_line};
use crate::film::LayerId;
use crate::geometry::shape::LaneSurface;
use crate::scene::{Finish, Scene};
use crate::trace::textures;
use std::f64::consts::PI;

/// One source of light.
#[derive(Clone, Copy, Debug)]
pub enum Emitter<'a> {
    /// The light of this index in the scene.
    Light(u32, Light),
    /// The primitive of this index emits.
    Object(u32),
    Sky(&'a SkyTable),
}

/// Sources of one layer that are each sampled at every surface; of more than these, one.
const MOST_SAMPLED: usize = 8;

struct Group<'a> {
    layer: LayerId,
    members: Vec<Emitter<'a>>,
    /// The chance of each member; none if all are sampled.
    chances: Option<Chances>,
}

/// Chances of a few things, and their sums.
struct Chances {
    each: Vec<f64>,
    up_to: Vec<f64>,
}

/// One sample of light at every surface.
#[derive(Clone, Copy, Debug)]
pub struct LightRequest {
    pub layer: LayerId,
    /// By which its random numbers differ from those of others.
    pub number: u32,
    group: usize,
    /// Which member; none if one is chosen.
    member: Option<usize>,
    /// Whether light comes from more than one direction, or more than one source, so that one has to be drawn.
    pub is_sampled: bool,
}

impl LightRequest {
    /// Whether one of many sources is chosen.
    pub fn is_choice(&self) -> bool {
        self.member.is_none()
    }
}

pub struct LightSampler<'a> {
    scene: &'a Scene<'a>,
    environment: Option<&'a Environment>,
    groups: Vec<Group<'a>>,
    requests: Vec<LightRequest>,
    /// Of every primitive: the chance with which it is sampled, if it is a source.
    primitives: Vec<Option<f64>>,
    sky: Option<(&'a SkyTable, f64)>,
}

impl<'a> LightSampler<'a> {
    pub fn new(scene: &'a Scene<'a>, environment: Option<&'a Environment>, emitters: bool) -> Self {
        let mut groups: Vec<Group<'a>> = Vec::new();
        for (layer, emitter) in sources(scene, environment, emitters) {
            match groups.iter_mut().find(|group| group.layer == layer) {
                Some(group) => group.members.push(emitter),
                None => groups.push(Group { layer, members: vec![emitter], chances: None }),
            }
        }
        let primitives = vec![None; scene.geometry.primitives.len()];
        let mut all = Self { scene, environment, groups, requests: Vec::new(), primitives, sky: None };
        all.settle(emitters);
        all
    }

    /// Settles what is sampled, and with which chance. Without `choice`, every light is.
    fn settle(&mut self, choice: bool) {
        let scene = self.scene;
        let mut lights = vec![None; scene.shading.lights.len()];
        for (index, group) in self.groups.iter_mut().enumerate() {
            let first = group.layer.0.wrapping_mul(2 * MOST_SAMPLED as u32);
            let request = |member: Option<usize>, number: u32, is_sampled: bool| LightRequest {
                layer: group.layer,
                number: first.wrapping_add(number),
                group: index,
                member,
                is_sampled,
            };
            if choice && group.members.len() > MOST_SAMPLED {
                let powers = group.members.iter().map(|member| member.power(scene));
                self.requests.push(request(None, MOST_SAMPLED as u32, true));
                group.chances = Some(Chances::of(powers));
            } else {
                let members = group.members.iter().enumerate();
                self.requests.extend(
                    members.map(|(member, source)| request(Some(member), member as u32, source.is_sampled())),
                );
            }
            for (index, member) in group.members.iter().enumerate() {
                let chance = group.chances.as_ref().map_or(1.0, |chances| chances.each[index]);
                match member {
                    Emitter::Light(light, _) => lights[*light as usize] = Some(chance),
                    Emitter::Object(primitive) => self.primitives[*primitive as usize] = Some(chance),
                    Emitter::Sky(table) => self.sky = Some((table, chance)),
                }
            }
        }
        for (primitive, noted) in scene.geometry.primitives.iter().zip(&mut self.primitives) {
            if let Finish::Light(light) = primitive.finish {
                *noted = lights[light as usize];
            }
        }
    }

    /// All that is sampled at a surface, in a fixed order.
    pub fn requests(&self) -> &[LightRequest] {
        &self.requests
    }

    /// Whether anything that can be met by chance is sampled, so that both have to be weighed.
    pub fn weighs(&self) -> bool {
        self.sky.is_some() || self.primitives.iter().any(Option::is_some)
    }

    /// Whether anything emits light that cannot be sampled.
    pub fn leaves_out_emission(&self) -> bool {
        let Scene { geometry, shading, weights, .. } = self.scene;
        let emits = |index: u32| {
            let material = &shading.materials[index as usize];
            material.lobes.emission != Rgb::ZERO && weights.0[material.emission_layer.index()] != Rgb::ZERO
        };
        let mut primitives = geometry.primitives.iter().zip(&self.primitives);
        primitives.any(|(primitive, sampled)| sampled.is_none() && primitive.materials().any(emits))
    }

    /// Whether the sky is sampled.
    pub fn samples_sky(&self) -> bool {
        self.sky.is_some()
    }

    /// Light that comes to points, for two numbers in 0..1 and one that chooses among many sources.
    #[inline(always)]
    pub fn sample<F: Real>(
        &self,
        request: &LightRequest,
        at: &Receiver<F>,
        u: [F; 2],
        choice: F,
    ) -> LightSample<F> {
        sample(self, request, at, u, choice)
    }

    #[inline(always)]
    fn sample_emitter<F: Real>(&self, emitter: &Emitter, at: &Receiver<F>, u: [F; 2]) -> LightSample<F> {
        match emitter {
            Emitter::Light(_, light) => sample_light(light, at, u),
            Emitter::Sky(table) => match self.environment {
                Some(environment) => sky::sample(environment, table, u),
                None => LightSample::none(),
            },
            Emitter::Object(index) => self.sample_object(*index, at, u),
        }
    }

    /// Light from a primitive that emits.
    #[inline(always)]
    fn sample_object<F: Real>(&self, index: u32, at: &Receiver<F>, [u, v]: [F; 2]) -> LightSample<F> {
        let primitive = &self.scene.geometry.primitives[index as usize];
        let (surface, part, pdf) = primitive.sample_from(at.point, at.eye, u, v);
        let emission = textures::emission(self.scene, index, &surface, part);
        LightSample::from_surface(at, &surface, emission, pdf)
    }

    /// The density per steradian with which points of primitives are sampled `from` points, in the lanes of a mask; 0 for
    /// what never is.
    #[inline(always)]
    pub fn pdf_of_hit<F: Real>(
        &self,
        from: Vec3<F>,
        primitives: F::U32,
        surface: &LaneSurface<F>,
        wanted: F::Mask,
    ) -> F {
        pdf_of_hit(self, from, primitives, surface, wanted)
    }

    /// The density per steradian with which the sky is sampled in directions; 0 if it never is.
    #[inline(always)]
    pub fn pdf_of_sky<F: Real>(&self, direction: Vec3<F>) -> F {
        match self.sky.zip(self.environment) {
            Some(((table, chance), environment)) => environment.pdf(table, direction) * F::splat(chance),
            None => F::splat(0.0),
        }
    }
}

out_of_line! {
    fn sample<'k, F>(
        sampler: &'k LightSampler<'k>,
        request: &'k LightRequest,
        at: &'k Receiver<'k, F>,
        u: [F; 2],
        choice: F,
    ) -> LightSample<F> {
        let Group { members, chances, .. } = &sampler.groups[request.group];
        if let Some(member) = request.member {
            return sampler.sample_emitter(&members[member], at, u);
        }
        let Some(chances) = chances else { return LightSample::none() };
        let (chosen, chance) = chances.choose(choice);
        let (indices, mut rest) = (chosen.to_array(), (1u32 << F::LANES) - 1);
        let mut sample = LightSample::none();
        while rest != 0 {
            let index = indices[rest.trailing_zeros() as usize];
            let same = chosen.eq(F::U32::splat(index));
            let drawn = sampler.sample_emitter(&members[index as usize], at, u);
            sample = LightSample::select(same, drawn, sample);
            rest &= !same.bits();
        }
        sample.with_chance(chance)
    }
}

out_of_line! {
    fn pdf_of_hit<'k, F>(
        sampler: &'k LightSampler<'k>,
        from: Vec3<F>,
        primitives: F::U32,
        surface: &'k LaneSurface<F>,
        wanted: F::Mask,
    ) -> F {
        let (indices, mut rest) = (primitives.to_array(), wanted.bits());
        let mut pdf = F::splat(0.0);
        while rest != 0 {
            let index = indices[rest.trailing_zeros() as usize];
            let same = primitives.eq(F::U32::splat(index));
            rest &= !same.bits();
            if let Some(chance) = sampler.primitives[index as usize] {
                let primitive = &sampler.scene.geometry.primitives[index as usize];
                let found = primitive.pdf_from(from, surface) * F::splat(chance);
                pdf = F::select(same, found, pdf);
            }
        }
        pdf
    }
}

/// All sources of a scene with their layers, in a fixed order: lights, and of others those that can be sampled, if `emitters`
/// are.
fn sources<'a>(
    scene: &'a Scene<'a>,
    environment: Option<&'a Environment>,
    emitters: bool,
) -> Vec<(LayerId, Emitter<'a>)> {
    let shading = scene.shading;
    let lights = scene.lights().map(|(index, light)| (light.layer, Emitter::Light(index, *light)));
    if !emitters {
        return lights.collect();
    }
    let objects = (0..).zip(&scene.geometry.primitives).filter_map(|(index, primitive)| {
        // Meshes of several materials are found by chance: they have no one emission to choose points by.
        let Finish::Material(MadeOf::One(material)) = primitive.finish else { return None };
        let material = &shading.materials[material as usize];
        let weighted = scene.weights.0[material.emission_layer.index()] != Rgb::ZERO;
        let shines = weighted && material.lobes.emission != Rgb::ZERO && primitive.has_area();
        shines.then_some((material.emission_layer, Emitter::Object(index)))
    });
    let sky = environment.zip(shading.sky_table.as_deref());
    let sky = sky.map(|(environment, table)| (environment.layer, Emitter::Sky(table)));
    lights.chain(objects).chain(sky).collect()
}

impl Emitter<'_> {
    /// Whether its light comes from more than one direction, so that one has to be drawn.
    fn is_sampled(&self) -> bool {
        match self {
            Self::Light(_, light) => light.source.is_sampled(),
            Self::Object(_) | Self::Sky(_) => true,
        }
    }

    /// Roughly how much light it gives, which is all that a choice among many goes by.
    fn power(&self, scene: &Scene) -> f64 {
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
                let primitive = &scene.geometry.primitives[*index as usize];
                let Some(material) = primitive.material(0) else { return 0.0 };
                let emission = scene.shading.materials[material as usize].lobes.emission;
                brightness(emission) * primitive.bounds().map_or(0.0, |bounds| bounds.area())
            }
            Self::Sky(_) => 1.0,
        }
    }
}

impl Chances {
    fn of(weights: impl Iterator<Item = f64>) -> Self {
        let weights: Vec<f64> = weights.collect();
        let whole: f64 = weights.iter().sum();
        // Sources that all seem to give nothing are sampled evenly.
        let even = 1.0 / weights.len() as f64;
        let each: Vec<f64> =
            weights.iter().map(|weight| if whole > 0.0 { weight / whole } else { even }).collect();
        let up_to = each.iter().scan(0.0, |sum, chance| {
            *sum += chance;
            Some(*sum)
        });
        Self { up_to: up_to.collect(), each }
    }

    /// Which source lanes sample for a number in 0..1, and its chance.
    #[inline(always)]
    fn choose<F: Real>(&self, u: F) -> (F::U32, F) {
        let numbers = u.to_array();
        let (mut indices, mut each) = (F::U32::splat(0).to_array(), numbers);
        for lane in 0..F::LANES {
            let index = self.pick(numbers[lane]);
            (indices[lane], each[lane]) = (index as u32, self.each[index]);
        }
        (F::U32::from_array(indices), F::from_array(each))
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
