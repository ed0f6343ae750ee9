//! What both integrators share: the frame's scene with all that is constant resolved, and one sample's state.

use super::lights::Arrival;
use super::media::{Enclosure, Media};
use super::shade::Seen;
use super::spawn::spawn;
use crate::bvh::{Bvh, Hit};
use crate::camera::Ray;
use crate::color::Rgb;
use crate::counters::Counts;
use crate::environment::Environment;
use crate::film::LayerId;
use crate::fog::Fog;
use crate::glow::Glow;
use crate::light::Light;
use crate::material::{Lobes, Material, Medium};
use crate::math::DVec3;
use crate::optics::refract;
use crate::quality::Quality;
use crate::sampling::Sampler;
use crate::scene::{Finish, Primitive, Scene};
use crate::shape::Surface;
use crate::tree::Probe;

/// One frame's scene, ready to be traced.
pub struct Tracer<'a> {
    pub scene: &'a Scene<'a>,
    pub bvh: &'a Bvh,
    pub quality: &'a Quality,
    /// Lights that shine, with their index: a layer of weight zero is not traced.
    pub lights: Vec<(u32, Light)>,
    pub environment: Option<&'a Environment>,
    pub ambient: Option<Glow>,
    pub fog: Option<Fog>,
    /// Whether shadow rays pass what refracts.
    refractive_shadows: bool,
    /// Whether any material lets light pass to what lies in its shadow.
    clear: bool,
    /// Whether any material refracts, so that rays must know what they are inside of.
    media: bool,
}

/// What one thread's samples work with.
pub struct Work {
    /// What the sample in hand adds to each layer.
    pub layers: Vec<DVec3>,
    pub counts: Counts,
    /// Rays that are put off.
    pub pending: Vec<super::whitted::Pending>,
}

impl Work {
    pub fn new(layers: usize) -> Self {
        let layers = vec![DVec3::ZERO; layers];
        Self { layers, counts: Counts::default(), pending: Vec::new() }
    }

    pub fn add(&mut self, layer: LayerId, radiance: Rgb) {
        self.layers[layer.index()] += radiance.as_dvec3();
    }
}

/// The share of a light that arrives in spite of what stands in the way.
#[derive(Clone, Copy, Debug)]
pub struct Passing {
    pub whole: Rgb,
    /// The part of it that has passed nothing by refraction.
    pub unbent: Rgb,
}

impl Passing {
    fn all_or_nothing(blocked: bool) -> Self {
        let share = if blocked { Rgb::ZERO } else { Rgb::ONE };
        Self { whole: share, unbent: share }
    }

    fn absorb(&mut self, medium: Medium, length: f64) {
        let left = medium.transmittance(length);
        self.dim(left, left);
    }

    fn dim(&mut self, whole: Rgb, unbent: Rgb) {
        self.whole *= whole;
        self.unbent *= unbent;
    }
}

/// What is left of light on its way along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// The share that the medium around does not absorb.
    pub passed: Rgb,
    /// The share that the fog does not hide.
    pub clear: f32,
}

/// What a ray hit.
pub enum Met<'a> {
    Nothing,
    Light { index: u32, outside: bool, surface: Surface, hit: Hit },
    Surface(Face<'a>),
}

/// A surface that a ray hit.
pub struct Face<'a> {
    pub material: &'a Material,
    pub lobes: Lobes,
    /// Turned towards where the ray came from.
    pub surface: Surface,
    /// Whether the ray came from the side that the normal is on.
    pub outside: bool,
    pub hit: Hit,
    pub enclosure: Enclosure,
}

impl Face<'_> {
    pub fn seen(&self, ray: &Ray) -> Seen<'_> {
        let Self { material, lobes, surface, .. } = self;
        Seen { material, lobes, surface, to_eye: -ray.direction }
    }
}

impl<'a> Tracer<'a> {
    pub fn new(scene: &'a Scene<'a>, bvh: &'a Bvh, quality: &'a Quality, refractive_shadows: bool) -> Self {
        let shading = scene.shading;
        let weighted = |layer: LayerId| scene.weights.0[layer.index()] != Rgb::ZERO;
        let shines = |light: &Light| light.radiance != Rgb::ZERO && weighted(light.layer);
        let glows = |glow: &Glow| glow.radiance != Rgb::ZERO && weighted(glow.layer);
        let lights = (0..).zip(&shading.lights).filter(|(_, light)| shines(light));
        let used = |test: fn(&Material) -> bool| {
            let mut materials = scene.geometry.primitives.iter().flat_map(Primitive::materials);
            materials.any(|index| test(&shading.materials[index as usize]))
        };
        let media = used(Material::refracts);
        let clear = used(|material| material.lobes.transparency != Rgb::ZERO);
        let environment = &shading.environment;
        Self {
            scene,
            bvh,
            quality,
            lights: lights.map(|(index, light)| (index, *light)).collect(),
            environment: (!environment.is_black() && weighted(environment.layer)).then_some(environment),
            ambient: Some(shading.ambient).filter(glows),
            fog: shading.fog.filter(|fog| fog.density > 0.0),
            refractive_shadows,
            clear: clear || (media && refractive_shadows),
            media,
        }
    }

    /// What the ray meets, and what its way there, which may be infinite, leaves of `throughput`. The fog's own
    /// light is added. A ray that `gathers` light for a surface sees no fog before lights and the sky, as the surface's shadow
    /// rays do not either.
    pub fn advance(
        &self,
        ray: &Ray,
        media: &Media,
        throughput: Rgb,
        gathers: bool,
        work: &mut Work,
    ) -> (Met<'a>, Way) {
        let hit = self.bvh.closest(self.scene.geometry, &Probe::new(*ray));
        let t = hit.map_or(f64::INFINITY, |hit| hit.at.t);
        let mut way = Way { passed: Rgb::ONE, clear: 1.0 };
        if self.media {
            way.passed = media.here(&self.scene.shading.materials).transmittance(t);
        }
        let met = hit.map_or(Met::Nothing, |hit| self.met(ray, hit));
        let Some(fog) = self.fog.as_ref().filter(|_| !gathers || matches!(met, Met::Surface(_))) else {
            return (met, way);
        };
        let opacity = fog.opacity(ray, t) as f32;
        work.add(fog.glow.layer, throughput * way.passed * fog.glow.radiance * opacity);
        way.clear = 1.0 - opacity;
        (met, way)
    }

    fn met(&self, ray: &Ray, hit: Hit) -> Met<'a> {
        let primitive = &self.scene.geometry.primitives[hit.primitive as usize];
        let surface = primitive.surface(ray, hit.at);
        // Surfaces are two-sided: the normal faces the eye.
        let outside = surface.normal.dot(ray.direction) <= 0.0;
        if let Finish::Light(index) = primitive.finish {
            return Met::Light { index, outside, surface, hit };
        }
        let index = primitive.material(hit.at.part).unwrap_or_default();
        let material = &self.scene.shading.materials[index as usize];
        let lobes = match material.paints.is_empty() {
            true => material.lobes,
            false => material.painted(&self.scene.geometry.spot(&hit, &surface)),
        };
        let surface = if outside { surface } else { surface.flipped() };
        let enclosure = Enclosure { primitive: hit.primitive, material: index };
        Met::Surface(Face { material, lobes, surface, outside, hit, enclosure })
    }

    /// What the sky adds to a ray that met nothing.
    pub fn add_sky(&self, ray: &Ray, throughput: Rgb, work: &mut Work) {
        if let Some(environment) = self.environment {
            work.add(environment.layer, throughput * environment.radiance(ray.direction));
        }
    }

    /// A surface's share of the ambient light.
    pub fn add_ambient(&self, face: &Face, throughput: Rgb, work: &mut Work) {
        if let Some(ambient) = &self.ambient {
            work.add(ambient.layer, throughput * face.lobes.ambient * ambient.radiance);
        }
    }

    /// What a surface shines by itself.
    pub fn add_emission(&self, face: &Face, throughput: Rgb, work: &mut Work) {
        if face.lobes.emission != Rgb::ZERO {
            work.add(face.material.emission_layer, throughput * face.lobes.emission);
        }
    }

    /// The share of the light that arrives at a surface, on its side that is seen, in spite of what stands in
    /// the way.
    pub fn passing(&self, arrival: &Arrival, surface: &Surface, media: &Media, work: &mut Work) -> Passing {
        let (ray, t_max) = arrival.shadow_ray(surface);
        if ray.direction == DVec3::ZERO {
            return Passing::all_or_nothing(false);
        }
        work.counts.rays.shadow += 1;
        if !self.clear {
            let mut passing =
                Passing::all_or_nothing(self.bvh.occluded(self.scene.geometry, &Probe::new(ray), t_max));
            if self.media {
                passing.absorb(media.here(&self.scene.shading.materials), ray.direction.length() * t_max);
            }
            return passing;
        }
        self.transmitted(arrival, ray, t_max, *media, work)
    }

    /// [`Tracer::passing`] surface by surface: the product of what each of them lets pass.
    fn transmitted(
        &self,
        arrival: &Arrival,
        mut ray: Ray,
        mut t_max: f64,
        mut media: Media,
        work: &mut Work,
    ) -> Passing {
        let materials = &self.scene.shading.materials;
        let mut share = Passing::all_or_nothing(false);
        loop {
            let hit = self.bvh.closest_before(self.scene.geometry, &Probe::new(ray), t_max);
            let length = ray.direction.length() * hit.map_or(t_max, |hit| hit.at.t);
            if self.media {
                share.absorb(media.here(materials), length);
            }
            let Some(hit) = hit else { return share };
            let Met::Surface(face) = self.met(&ray, hit) else { return Passing::all_or_nothing(true) };
            let (passes, beyond) = self.straight_through(&face, arrival.direction, media);
            share.dim(passes.whole, passes.unbent);
            media = beyond;
            if share.whole == Rgb::ZERO {
                return share;
            }
            work.counts.rays.shadow += 1;
            (ray, t_max) = arrival.shadow_ray(&face.surface);
        }
    }

    /// The share that passes a surface straight on, and what is around the light beyond it.
    fn straight_through(&self, face: &Face, direction: DVec3, media: Media) -> (Passing, Media) {
        let Lobes { transparency, refraction, .. } = face.lobes;
        let unbent = Passing { whole: transparency, unbent: transparency };
        if !face.material.refracts() {
            return (unbent, media);
        }
        let boundary = media.boundary(face.enclosure, face.outside, &self.scene.shading.materials);
        if boundary.hidden {
            return (Passing::all_or_nothing(false), boundary.passed);
        }
        if !self.refractive_shadows {
            return (unbent, boundary.passed);
        }
        let eta = boundary.behind.ior / boundary.before.ior;
        let passes = refract(direction, face.surface.normal, eta).map_or(0.0, |(_, cosine)| {
            let before = -direction.dot(face.surface.normal);
            1.0 - face.material.fresnel.reflectance(before, cosine, eta)
        });
        (Passing { whole: transparency + refraction * passes as f32, ..unbent }, boundary.passed)
    }

    /// The ray straight on through a surface.
    pub fn straight_on(face: &Face, ray: &Ray) -> Ray {
        spawn(&face.surface, ray.direction)
    }
}

/// The sampler of a sample, and how many surfaces it has met: the numbers of every surface are its own.
#[derive(Clone, Copy, Debug)]
pub struct Dice {
    pub sampler: Sampler,
    pub surface: u32,
}
