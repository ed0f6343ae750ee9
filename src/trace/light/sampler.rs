//! Light sources for next-event estimation: lights, objects that emit, and skies of images. They are grouped by layer,
//! so that the samples of one layer never depend on another.

use super::emission::emission;
use super::evaluate::sample_light;
use super::sampled_emitter::{SampledEmitter, sources};
use super::source_group::{GroupChoice, LightRequest, RequestedSource, SourceGroup};
use super::{LightSample, Receiver, sky};
use crate::appearance::environment::{Environment, EnvironmentDistribution};
use crate::appearance::texture::TextureInputs;
use crate::base::color::Rgb;
use crate::base::lanes::{Bits, Mask, Real, Row, Select, Vec3, out_of_line};
use crate::film::LayerId;
use crate::geometry::shape::LaneSurface;
use crate::scene::{Finish, Scene};

/// Chooses and samples the light sources of a scene, layer by layer.
pub struct LightSampler<'a> {
    scene: &'a Scene<'a>,
    environment: Option<&'a Environment>,
    groups: Vec<SourceGroup<'a>>,
    requests: Vec<LightRequest>,
    /// For each light, its place, if it is a source.
    lights: Vec<Option<SourcePlace>>,
    /// The primitives that emit and are sampled, ascending, each with its place.
    objects: Vec<(u32, SourcePlace)>,
    sky: Option<(&'a EnvironmentDistribution, SourcePlace)>,
}

/// A group and a member of it.
#[derive(Clone, Copy, Debug)]
struct SourcePlace {
    group: usize,
    member: usize,
}

impl<'a> LightSampler<'a> {
    pub fn new(scene: &'a Scene<'a>, environment: Option<&'a Environment>, emitters: bool) -> Self {
        let mut layers: Vec<(LayerId, Vec<SampledEmitter<'a>>)> = Vec::new();
        for (layer, emitter) in sources(scene, environment, emitters) {
            match layers.iter_mut().find(|(of, _)| *of == layer) {
                Some((_, members)) => members.push(emitter),
                None => layers.push((layer, vec![emitter])),
            }
        }
        // Whitted's surfaces sample every light.
        let groups =
            layers.into_iter().map(|(layer, members)| SourceGroup::new(layer, members, scene, emitters));
        let groups: Vec<SourceGroup> = groups.collect();
        let requests = groups.iter().enumerate().flat_map(|(index, group)| group.requests(index)).collect();
        let lights = vec![None; scene.shading.lights.len()];
        let mut all = Self { scene, environment, groups, requests, lights, objects: Vec::new(), sky: None };
        all.add_places();
        all
    }

    /// Adds the places of all sources.
    fn add_places(&mut self) {
        for (index, group) in self.groups.iter().enumerate() {
            for (member, source) in group.members.iter().enumerate() {
                let place = SourcePlace { group: index, member };
                match source {
                    SampledEmitter::Light(light, ..) => self.lights[*light as usize] = Some(place),
                    SampledEmitter::Object(primitive, _) => self.objects.push((*primitive, place)),
                    SampledEmitter::Sky(table) => self.sky = Some((table, place)),
                }
            }
        }
        self.objects.sort_unstable_by_key(|(primitive, _)| *primitive);
    }

    /// The place of a primitive among the sources; none if it is not one.
    fn place(&self, primitive: u32) -> Option<SourcePlace> {
        match self.scene.geometry.finishes()[primitive as usize] {
            Finish::Light(light) => self.lights[light as usize],
            Finish::Material(_) => {
                let place = self.objects.binary_search_by_key(&primitive, |(object, _)| *object).ok()?;
                Some(self.objects[place].1)
            }
            Finish::Empty => None,
        }
    }

    /// How many samples of a source surfaces at points may expect.
    #[inline(always)]
    fn expected<F: Real>(&self, place: SourcePlace, from: &Scattering<F>) -> F {
        self.groups[place.group].expected(place.member, from.point, from.is_first)
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
            && finishes.any(|(index, of)| of.materials().any(emits) && self.place(index).is_none())
    }

    /// Whether the sky is sampled.
    pub fn samples_sky(&self) -> bool {
        self.sky.is_some()
    }

    /// Samples light at points, from two numbers in 0..1 and one that chooses among several sources.
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
            SampledEmitter::Light(_, light, face) => sample_light((light, face), at, u),
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

    /// The density per steradian of sampling points of primitives from where paths were scattered, in the lanes of a
    /// mask. It is 0 for primitives that are not sampled.
    #[inline(always)]
    pub fn pdf_of_hit<F: Real>(
        &self,
        from: Scattering<F>,
        primitives: F::U32,
        surface: &LaneSurface<F>,
        wanted: F::Mask,
    ) -> F {
        pdf_of_hit(self, from, primitives, surface, wanted)
    }

    /// The density per steradian of sampling the sky in directions. It is 0 if the sky is not sampled.
    #[inline(always)]
    pub fn pdf_of_sky<F: Real>(&self, from: Scattering<F>, direction: Vec3<F>) -> F {
        match self.sky.zip(self.environment) {
            Some(((table, place), environment)) => {
                environment.pdf(table, direction) * self.expected(place, &from)
            }
            None => F::splat(0.0),
        }
    }
}

/// Where paths were scattered last.
#[derive(Clone, Copy)]
pub struct Scattering<F: Real> {
    pub point: Vec3<F>,
    /// The lanes in which that was at the first surface.
    pub is_first: F::Mask,
}

out_of_line! {
    fn sample<'k, F>(
        sampler: &'k LightSampler<'k>,
        request: &'k LightRequest,
        at: &'k Receiver<'k, F>,
        u: [F; 2],
        choice: F,
    ) -> LightSample<F> {
        let SourceGroup { members, choice: group_choice, .. } = &sampler.groups[request.group];
        let (number, count) = match request.source {
            RequestedSource::Member(member) => return sampler.sample_emitter(&members[member], at, u),
            RequestedSource::Chosen(number, count) => (number as f64, count as f64),
        };
        let Some(GroupChoice { among, areas }) = group_choice else { return LightSample::none() };
        // The numbers of all samples of a surface are evenly spaced.
        let choice = choice + F::splat(number / count);
        let (chosen, chance) = among.choose(at.point, choice - choice.floor());
        let (mut sample, known) = areas.sample(chosen, at, u);
        let (indices, mut rest) = (chosen.to_array(), ((1u32 << F::LANES) - 1) & !known.bits());
        while rest != 0 {
            let index = indices[rest.trailing_zeros() as usize];
            let same = chosen.eq(F::U32::splat(index));
            let drawn = sampler.sample_emitter(&members[index as usize], at, u);
            sample = LightSample::select(same, drawn, sample);
            rest &= !same.bits();
        }
        sample.with_chance(chance * F::splat(count))
    }
}

out_of_line! {
    fn pdf_of_hit<'k, F>(
        sampler: &'k LightSampler<'k>,
        from: Scattering<F>,
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
            if let Some(place) = sampler.place(index) {
                let primitive = &sampler.scene.geometry.primitives[index as usize];
                let found = primitive.pdf_from(from.point, surface) * sampler.expected(place, &from);
                pdf = F::select(same, found, pdf);
            }
        }
        pdf
    }
}
