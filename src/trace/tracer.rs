//! What both integrators share: the frame's scene with all that is constant resolved, and one sample's state.

use super::media::{Boundary, Media, Nesting};
use super::place::{Members, Passed, Stop};
use super::shade::Seen;
use super::throughput::Throughput;
use super::wave::Lists;
use crate::bvh::{Bvh, Hit};
use crate::camera::{Beam, Ray};
use crate::color::Rgb;
use crate::counters::Counts;
use crate::environment::Environment;
use crate::film::LayerId;
use crate::fog::Fog;
use crate::glow::Glow;
use crate::light::Light;
use crate::material::{Lobes, Material};
use crate::math::DVec3;
use crate::quality::Quality;
use crate::sampling::Sampler;
use crate::scene::{Finish, Primitive, Scene};
use crate::shape::Surface;
use crate::texture::Footprint;
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
    /// Where the shares of eye rays that meet nothing go, in place of what the sky would add.
    pub holdout: Option<LayerId>,
    /// Whether shadow rays pass what refracts.
    pub refractive_shadows: bool,
    /// Whether any material lets light pass to what lies in its shadow.
    pub clear: bool,
    /// Whether any material refracts, so that rays must know what they are inside of.
    pub media: bool,
    /// Whether any material is painted, so that it matters how wide beams are.
    pub painted: bool,
}

/// What one thread's samples work with.
pub struct Work {
    /// What samples add to each layer, sample after sample.
    pub layers: Vec<DVec3>,
    /// Where the layers of the sample in hand begin.
    pub first: usize,
    pub counts: Counts,
    /// What rays are inside of.
    pub nesting: Nesting,
    pub members: Members,
    /// Rays that are put off.
    pub pending: Vec<super::whitted::Pending>,
    /// Light whose shadow rays are put off.
    pub shadows: Vec<super::wave::Shadow>,
    pub lists: Lists,
}

impl Work {
    /// For so many samples at once, and layers of each.
    pub fn new(samples: usize, layers: usize) -> Self {
        let layers = vec![DVec3::ZERO; samples * layers];
        let (pending, shadows) = (Vec::new(), Vec::new());
        let (nesting, members) = (Nesting::default(), Members::default());
        let (counts, lists) = (Counts::default(), Lists::default());
        Self { layers, first: 0, counts, nesting, members, pending, shadows, lists }
    }

    #[inline]
    pub fn add(&mut self, layer: LayerId, radiance: Rgb) {
        self.layers[self.first + layer.index()] += radiance.as_dvec3();
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
#[expect(
    clippy::large_enum_variant,
    reason = "it lives on the stack for one step of a ray; an allocation for every hit would cost more"
)]
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
    pub hit: Hit,
    /// If it refracts.
    pub boundary: Option<Boundary>,
    /// How far the ray has come once it has passed it straight on.
    pub passed: Passed,
    /// How wide the ray's beam is there.
    pub width: f64,
}

impl Face<'_> {
    /// What a ray sees that takes this tangent along.
    pub fn seen(&self, ray: &Ray, tangent: DVec3) -> Seen<'_> {
        let Self { material, lobes, surface, .. } = self;
        Seen { material, lobes, surface, to_eye: -ray.direction, tangent }
    }
}

impl<'a> Tracer<'a> {
    pub fn new(scene: &'a Scene<'a>, bvh: &'a Bvh, quality: &'a Quality, refractive_shadows: bool) -> Self {
        let shading = scene.shading;
        let weighted = |layer: LayerId| scene.weights.0[layer.index()] != Rgb::ZERO;
        let glows = |glow: &Glow| glow.radiance != Rgb::ZERO && weighted(glow.layer);
        let used = |test: fn(&Material) -> bool| {
            let mut materials = scene.geometry.primitives.iter().flat_map(Primitive::materials);
            materials.any(|index| test(&shading.materials[index as usize]))
        };
        let media = used(Material::refracts);
        let clear = used(|material| material.lobes.transparency != Rgb::ZERO);
        let painted = used(|material| !material.paints.is_empty());
        let environment = &shading.environment;
        Self {
            scene,
            bvh,
            quality,
            lights: scene.lights().map(|(index, light)| (index, *light)).collect(),
            environment: (!environment.is_black() && weighted(environment.layer)).then_some(environment),
            ambient: Some(shading.ambient).filter(glows),
            fog: shading.fog,
            holdout: None,
            refractive_shadows,
            clear: clear || (media && refractive_shadows),
            media,
            painted,
        }
    }

    /// What the ray meets first.
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.bvh.closest(self.scene.geometry, &Probe::new(*ray))
    }

    /// What the ray comes to, on from what it has passed, and what its way there, which may be infinite, leaves of the
    /// light; `first` finds what lies ahead of one that has not passed anything. The fog's own light is added. What a surface
    /// gathers comes through no fog, as its shadow rays do not: a way to what shines by itself glows for the throughput's
    /// other part alone.
    #[inline]
    pub fn advance(
        &self,
        (ray, beam, passed): (&Ray, &Beam, Option<Passed>),
        first: impl FnOnce() -> Option<Hit>,
        media: Media,
        throughput: &Throughput,
        work: &mut Work,
    ) -> (Met<'a>, Way) {
        let from = passed.map_or(0.0, |passed| passed.t);
        let stop = self.next_stop((ray, passed), f64::INFINITY, first, media, work);
        let length = stop.map_or(f64::INFINITY, |stop| stop.passed.t - from);
        let mut way = Way { passed: Rgb::ONE, clear: 1.0 };
        let met = stop.map_or(Met::Nothing, |stop| self.met(ray, stop, beam.after(length)));
        if let Met::Surface(face) = &met {
            work.counts.evaluations.paint += u64::from(!face.material.paints.is_empty());
        }
        if stop.is_some_and(|stop| stop.again) {
            return (met, way);
        }
        if self.media {
            way.passed = work.nesting.here(media, &self.scene.shading.materials).transmittance(length);
        }
        if let Some(fog) = &self.fog {
            work.counts.evaluations.fog += 1;
            let rest = Ray { origin: if from > 0.0 { ray.at(from) } else { ray.origin }, ..*ray };
            let opacity = fog.opacity(&rest, length) as f32;
            let glows = match met {
                Met::Surface(_) => throughput.seen(),
                Met::Nothing | Met::Light { .. } => throughput.shown(),
            };
            work.add(fog.glow.layer, glows * way.passed * fog.glow.radiance * opacity);
            way.clear = 1.0 - opacity;
        }
        (met, way)
    }

    /// The surface that was hit.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let mut surface = self.scene.geometry.primitives[hit.primitive as usize].surface(ray, hit.at);
        if !self.quality.smooth_terminator {
            surface.lift = DVec3::ZERO;
        }
        surface
    }

    /// The material that was hit.
    #[inline]
    pub fn material_of(&self, hit: &Hit) -> &'a Material {
        let index = self.scene.geometry.primitives[hit.primitive as usize].material(hit.at.part);
        &self.scene.shading.materials[index.unwrap_or_default() as usize]
    }

    /// What a ray has stopped at, for a beam of this width.
    #[inline]
    pub fn met(&self, ray: &Ray, stop: Stop, width: f64) -> Met<'a> {
        let Stop { hit, mut surface, boundary, passed, .. } = stop;
        let primitive = &self.scene.geometry.primitives[hit.primitive as usize];
        // Surfaces are two-sided: the normal faces the eye.
        let outside = surface.normal.dot(ray.direction) <= 0.0;
        if let Finish::Light(index) = primitive.finish {
            return Met::Light { index, outside, surface, hit };
        }
        let index = primitive.material(hit.at.part).unwrap_or_default();
        let material = &self.scene.shading.materials[index as usize];
        let lobes = match material.paints.is_empty() {
            true => material.lobes,
            false => {
                let seen = Footprint::new(width, ray.direction, surface.normal);
                material.painted(&self.scene.geometry.spot(&hit, &surface, &seen, material.is_printed()))
            }
        };
        if boundary.is_some() {
            surface = primitive.passed(surface, hit.at.part);
        }
        let surface = if outside { surface } else { surface.flipped() };
        Met::Surface(Face { material, lobes, surface, hit, boundary, passed, width })
    }

    /// What the sky adds to a ray that met nothing and may take so many bounces more. With all of them left it has
    /// come straight from the eye: what it sees is the picture's background, and may be held out.
    pub fn add_sky(&self, ray: &Ray, throughput: Rgb, left: u32, work: &mut Work) {
        if let Some(holdout) = self.holdout.filter(|_| left == self.quality.bounces) {
            work.add(holdout, throughput);
        } else if let Some(environment) = self.environment {
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
}

/// The sampler of a sample, and how many surfaces it has met: the numbers of every surface are its own.
#[derive(Clone, Copy, Debug)]
pub struct Dice {
    pub sampler: Sampler,
    pub surface: u32,
}
