//! Light sources for next-event estimation: lights, objects that emit, and skies of images. They are grouped by layer,
//! so that the samples of one layer never depend on another.

use super::area_table::AreaTable;
use super::discrete_distribution::DiscreteDistribution;
use super::emission::emission;
use super::evaluate::sample_light;
use super::sampled_emitter::{SampledEmitter, sources};
use super::{LightSample, Receiver, sky};
use crate::appearance::environment::{Environment, EnvironmentDistribution};
use crate::appearance::texture::TextureInputs;
use crate::base::color::Rgb;
use crate::base::lanes::{Bits, Mask, Real, Row, Select, Vec3, out_of_line};
use crate::film::LayerId;
use crate::geometry::shape::LaneSurface;
use crate::scene::{Finish, Scene};

/// The most sources of a layer that are all sampled at every surface. If a layer has more, one of them is chosen.
const MAX_SAMPLED: usize = 8;

struct SourceGroup<'a> {
    layer: LayerId,
    members: Vec<SampledEmitter<'a>>,
    /// How one of the members is chosen; `None` if all are sampled.
    choice: Option<SourceChoice>,
}

struct SourceChoice {
    distribution: DiscreteDistribution,
    /// The members that lanes sample together.
    areas: AreaTable,
}

/// A light sample that every surface takes.
#[derive(Clone, Copy, Debug)]
pub struct LightRequest {
    pub layer: LayerId,
    /// Separates its random numbers from those of other requests.
    pub number: u32,
    group: usize,
    /// The member; `None` if one is chosen at random.
    member: Option<usize>,
    /// Whether the sample is random: the source has several directions, or is chosen among several.
    pub is_sampled: bool,
    /// Whether some source casts no shadows.
    pub some_unshadowed: bool,
}

impl LightRequest {
    /// Whether one of many sources is chosen.
    pub fn is_choice(&self) -> bool {
        self.member.is_none()
    }
}

/// Chooses and samples the light sources of a scene, layer by layer.
pub struct LightSampler<'a> {
    scene: &'a Scene<'a>,
    environment: Option<&'a Environment>,
    groups: Vec<SourceGroup<'a>>,
    requests: Vec<LightRequest>,
    /// For each light, the probability of sampling it, if it is a source.
    lights: Vec<Option<f64>>,
    /// The primitives that emit and are sampled, ascending, each with its probability.
    objects: Vec<(u32, f64)>,
    sky: Option<(&'a EnvironmentDistribution, f64)>,
}

impl<'a> LightSampler<'a> {
    pub fn new(scene: &'a Scene<'a>, environment: Option<&'a Environment>, emitters: bool) -> Self {
        let mut groups: Vec<SourceGroup<'a>> = Vec::new();
        for (layer, emitter) in sources(scene, environment, emitters) {
            match groups.iter_mut().find(|group| group.layer == layer) {
                Some(group) => group.members.push(emitter),
                None => groups.push(SourceGroup { layer, members: vec![emitter], choice: None }),
            }
        }
        let lights = vec![None; scene.shading.lights.len()];
        let (requests, objects) = (Vec::new(), Vec::new());
        let mut all = Self { scene, environment, groups, requests, lights, objects, sky: None };
        all.add_requests(emitters);
        all
    }

    /// Builds the requests and the probabilities of sources. Without `choice`, every light is sampled.
    fn add_requests(&mut self, choice: bool) {
        let scene = self.scene;
        for (index, group) in self.groups.iter_mut().enumerate() {
            let first = group.layer.0.wrapping_mul(2 * MAX_SAMPLED as u32);
            let request = |member: Option<usize>, number: u32, is_sampled: bool| LightRequest {
                layer: group.layer,
                number: first.wrapping_add(number),
                group: index,
                member,
                is_sampled,
                some_unshadowed: false,
            };
            if choice && group.members.len() > MAX_SAMPLED {
                let powers = group.members.iter().map(|member| member.power(scene));
                let some_unshadowed = !group.members.iter().all(SampledEmitter::casts_shadows);
                let request = request(None, MAX_SAMPLED as u32, true);
                self.requests.push(LightRequest { some_unshadowed, ..request });
                let distribution = DiscreteDistribution::of(powers);
                group.choice =
                    Some(SourceChoice { distribution, areas: AreaTable::new(&group.members, scene) });
            } else {
                for (member, source) in group.members.iter().enumerate() {
                    let some_unshadowed = !source.casts_shadows();
                    let request = request(Some(member), member as u32, source.is_sampled());
                    self.requests.push(LightRequest { some_unshadowed, ..request });
                }
            }
            for (index, member) in group.members.iter().enumerate() {
                let chance =
                    group.choice.as_ref().map_or(1.0, |choice| choice.distribution.probabilities[index]);
                match member {
                    SampledEmitter::Light(light, _) => self.lights[*light as usize] = Some(chance),
                    SampledEmitter::Object(primitive, _) => self.objects.push((*primitive, chance)),
                    SampledEmitter::Sky(table) => self.sky = Some((table, chance)),
                }
            }
        }
        self.objects.sort_unstable_by_key(|(primitive, _)| *primitive);
    }

    /// The probability of sampling a primitive; none if it is not a source.
    fn chance(&self, primitive: u32) -> Option<f64> {
        match self.scene.geometry.finishes()[primitive as usize] {
            Finish::Light(light) => self.lights[light as usize],
            Finish::Material(_) => {
                let place = self.objects.binary_search_by_key(&primitive, |(object, _)| *object).ok()?;
                Some(self.objects[place].1)
            }
            Finish::Empty => None,
        }
    }

    /// All light samples of a surface, in a fixed order.
    pub fn requests(&self) -> &[LightRequest] {
        &self.requests
    }

    /// Whether a source can be both sampled and hit by chance, so that multiple importance sampling is needed.
    pub fn needs_mis(&self) -> bool {
        let mut lights = self.scene.geometry.lights();
        let is_sampled = |light: u32| self.lights[light as usize].is_some();
        self.sky.is_some() || !self.objects.is_empty() || lights.any(is_sampled)
    }

    /// Whether an object emits light that cannot be sampled.
    pub fn has_unsampled_emission(&self) -> bool {
        let Scene { geometry, shading, weights, .. } = self.scene;
        let emits = |index: u32| {
            let material = &shading.materials[index as usize];
            material.lobes.emission != Rgb::ZERO && weights.0[material.emission_layer.index()] != Rgb::ZERO
        };
        let mut finishes = (0..).zip(geometry.finishes());
        geometry.materials().any(emits)
            && finishes.any(|(index, of)| of.materials().any(emits) && self.chance(index).is_none())
    }

    /// Whether the sky is sampled.
    pub fn samples_sky(&self) -> bool {
        self.sky.is_some()
    }

    /// Samples light at points, from two numbers in 0..1 and one that chooses among many sources.
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
    fn sample_emitter<F: Real>(
        &self,
        emitter: &SampledEmitter,
        at: &Receiver<F>,
        u: [F; 2],
    ) -> LightSample<F> {
        match emitter {
            SampledEmitter::Light(_, light) => sample_light(light, at, u),
            SampledEmitter::Sky(table) => match self.environment {
                Some(environment) => sky::sample(environment, table, u),
                None => LightSample::none(),
            },
            SampledEmitter::Object(index, inputs) => self.sample_object(*index, *inputs, at, u),
        }
    }

    /// Samples the light of a primitive that emits.
    #[inline(always)]
    fn sample_object<F: Real>(
        &self,
        index: u32,
        inputs: TextureInputs,
        at: &Receiver<F>,
        [u, v]: [F; 2],
    ) -> LightSample<F> {
        let primitive = &self.scene.geometry.primitives[index as usize];
        let (surface, part, pdf) = primitive.sample_from(at.point, at.eye, u, v);
        let emission = emission(self.scene, index, inputs, &surface, part);
        LightSample::from_surface(at, &surface, emission, pdf)
    }

    /// The density per steradian of sampling points of primitives `from` points, in the lanes of a mask. It is 0 for
    /// primitives that are not sampled.
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

    /// The density per steradian of sampling the sky in directions. It is 0 if the sky is not sampled.
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
        let SourceGroup { members, choice: among, .. } = &sampler.groups[request.group];
        if let Some(member) = request.member {
            return sampler.sample_emitter(&members[member], at, u);
        }
        let Some(SourceChoice { distribution, areas }) = among else { return LightSample::none() };
        let (chosen, chance) = distribution.sample(choice);
        let (mut sample, known) = areas.sample(chosen, at, u);
        let (indices, mut rest) = (chosen.to_array(), ((1u32 << F::LANES) - 1) & !known.bits());
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
            if let Some(chance) = sampler.chance(index) {
                let primitive = &sampler.scene.geometry.primitives[index as usize];
                let found = primitive.pdf_from(from, surface) * F::splat(chance);
                pdf = F::select(same, found, pdf);
            }
        }
        pdf
    }
}
