//! A simplified path tracer that records the vertices of its paths.

use super::vertex::{PathVertex, ScatterKind};
use crate::accuracy::robustness::{SceneRays, SurfaceHit};
use crate::appearance::light::{Light, Source};
use crate::appearance::material::{Coat, Material};
use crate::appearance::optics::{Microfacet, reflect, refract};
use crate::base::color::Rgb;
use crate::base::math::{DVec2, DVec3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::Geometric;
use crate::sampling::{FrameAxes, LocalFrame, cosine_hemisphere, hash, uniform_sphere};
use crate::scene::Finish;
use crate::trace::spawn::spawn_ray;
use std::f64::consts::PI;

/// The random numbers of a path.
pub struct PathSampler {
    seed: u32,
    count: u32,
}

impl PathSampler {
    pub fn new(pixel: u32, path: u32) -> Self {
        Self { seed: hash([pixel, path, 9]), count: 0 }
    }

    pub fn next(&mut self) -> f64 {
        self.count += 1;
        f64::from(hash([self.seed, self.count, 8])) / 4_294_967_296.0
    }
}

/// Traces paths through a scene and records their vertices.
pub struct PathRecorder<'a> {
    rays: &'a SceneRays<'a>,
    bounces: u32,
}

/// The state of a path.
struct PathState {
    ray: Ray,
    throughput: f64,
    chain: Vec<PathVertex>,
    /// Whether the last surface did not sample lights. Then the next emitter counts in full.
    specular: bool,
}

/// A sampled direction of scattering.
struct ScatterSample {
    direction: DVec3,
    kind: ScatterKind,
    /// The throughput factor.
    share: f64,
}

impl<'a> PathRecorder<'a> {
    pub fn new(rays: &'a SceneRays<'a>, bounces: u32) -> Self {
        Self { rays, bounces }
    }

    /// Traces a path through a point of a pixel, and calls `add` with each chain that reaches light and its
    /// contribution.
    pub fn follow(
        &self,
        pixel: (u32, u32),
        size: (u32, u32),
        jitter: DVec2,
        sampler: &mut PathSampler,
        add: &mut dyn FnMut(&[PathVertex], f64),
    ) {
        let ray = self.rays.ray_within(pixel, size, jitter);
        let mut path = PathState { ray, throughput: 1.0, chain: Vec::new(), specular: true };
        for depth in 0..=self.bounces + 1 {
            let Some(hit) = self.rays.closest_hit(&path.ray) else { return self.escape(&mut path, add) };
            let primitive = self.rays.primitive(hit.target.0);
            if let Finish::Light(index) = primitive.finish {
                return self.hit_light(&mut path, index, add);
            }
            let Some(index) = primitive.material(hit.part) else { return };
            let material = &self.rays.scene.shading.materials[index as usize];
            let emission = f64::from(material.lobes.emission.max_element());
            if emission > 0.0 && path.specular {
                self.end(&mut path, PathVertex::Emission(index), emission, add);
            }
            if depth > self.bounces {
                return;
            }
            self.sample_light(&mut path, &hit, (index, material), sampler, add);
            let Some(sample) = sample_scatter(material, &path.ray, &hit, sampler) else { return };
            path.throughput *= sample.share;
            path.specular = !matches!(sample.kind, ScatterKind::Scattered | ScatterKind::Glossy);
            path.chain.push(PathVertex::Surface(index, sample.kind));
            path.ray = spawn_ray(&hit.surface, sample.direction);
        }
    }

    fn end(
        &self,
        path: &mut PathState,
        vertex: PathVertex,
        light: f64,
        add: &mut dyn FnMut(&[PathVertex], f64),
    ) {
        path.chain.push(vertex);
        add(&path.chain, path.throughput * light);
        path.chain.pop();
    }

    /// Adds a light that the path hits, unless the last surface sampled lights.
    fn hit_light(&self, path: &mut PathState, index: u32, add: &mut dyn FnMut(&[PathVertex], f64)) {
        if path.specular {
            let light = self.strength(index);
            self.end(path, PathVertex::Light(index), light, add);
        }
    }

    fn escape(&self, path: &mut PathState, add: &mut dyn FnMut(&[PathVertex], f64)) {
        let shading = self.rays.scene.shading;
        if shading.environment.is_black() {
            return;
        }
        let color = shading.environment.radiance::<f64>(path.ray.direction.normalize().into());
        let light = f64::from(Rgb::from(color).max_element());
        self.end(path, PathVertex::Background, light, add);
    }

    fn strength(&self, index: u32) -> f64 {
        let scene = self.rays.scene;
        let light = &scene.shading.lights[index as usize];
        strength(light, scene.weights.0[light.layer.index()])
    }

    /// Next-event estimation: adds the light of one random light source at a diffuse surface.
    fn sample_light(
        &self,
        path: &mut PathState,
        hit: &SurfaceHit,
        (index, material): (u32, &Material),
        sampler: &mut PathSampler,
        add: &mut dyn FnMut(&[PathVertex], f64),
    ) {
        let diffuse_albedo = diffuse_albedo(material);
        let lights: Vec<u32> = self.rays.scene.lights().map(|(index, _)| index).collect();
        let (choice, u, v) = (sampler.next(), sampler.next(), sampler.next());
        let Some(&light) = lights.get((choice * lights.len() as f64) as usize) else { return };
        if diffuse_albedo <= 0.0 {
            return;
        }
        let point = self.rays.point_on_light(light, &hit.surface, [u, v]);
        let normal = facing(hit, &path.ray);
        let way = point.point - hit.surface.point;
        let cosine = normal.dot(way.normalize());
        if cosine <= 0.0 || point.per_area <= 0.0 {
            return;
        }
        let start = spawn_ray(&hit.surface, way);
        let probe = TraversalRay::new(Ray { direction: point.point - start.origin, ..start });
        if self.rays.scene.shading.lights[light as usize].shadows && self.rays.blocked(&probe) {
            return;
        }
        let light_of = self.strength(light) * point.per_area * lights.len() as f64;
        path.chain.push(PathVertex::Surface(index, ScatterKind::Scattered));
        self.end(path, PathVertex::Light(light), diffuse_albedo * cosine * light_of, add);
        path.chain.pop();
    }
}

/// The radiance or intensity of a light, as the largest of its colour channels.
fn strength(light: &Light, weight: Rgb) -> f64 {
    f64::from((light.radiance * weight).max_element())
}

fn facing(hit: &SurfaceHit, ray: &Ray) -> DVec3 {
    let normal = hit.surface.normal;
    if normal.dot(ray.direction) > 0.0 { -normal } else { normal }
}

fn largest(color: Rgb) -> f64 {
    f64::from(color.max_element())
}

/// Rougher microfacet surfaces count as diffuse.
const ROUGH: f32 = 0.4;

fn is_glossy(material: &Material) -> bool {
    material.lobes.metallic > 0.5 || material.lobes.roughness < ROUGH
}

/// The albedo of diffuse scattering, with that of rough microfacets.
fn diffuse_albedo(material: &Material) -> f64 {
    let lobes = &material.lobes;
    let base = if is_glossy(material) { 0.0 } else { f64::from(lobes.microfacet) * largest(lobes.base) };
    largest(lobes.diffuse) + base
}

/// Samples a direction of scattering; `None` if the surface absorbs all light.
fn sample_scatter(
    material: &Material,
    ray: &Ray,
    hit: &SurfaceHit,
    sampler: &mut PathSampler,
) -> Option<ScatterSample> {
    let lobes = &material.lobes;
    let glossy = if is_glossy(material) { f64::from(lobes.microfacet) * largest(lobes.base) } else { 0.0 };
    let coat = f64::from(Coat::REFLECTANCE * lobes.coat.share);
    let mirror = largest(lobes.mirror);
    let (transmitted, refracted) = (largest(lobes.transparency), largest(lobes.refraction));
    let weights = [
        (ScatterKind::Scattered, diffuse_albedo(material)),
        (ScatterKind::Mirrored, mirror),
        (ScatterKind::Glossy, glossy + coat),
        (ScatterKind::Transmitted, transmitted),
        (ScatterKind::Refracted, refracted),
    ];
    let share: f64 = weights.iter().map(|(_, weight)| weight).sum();
    let mut rest = sampler.next() * share;
    let chosen = weights.into_iter().find(|(_, weight)| {
        rest -= weight;
        rest < 0.0
    });
    let (kind, _) = chosen?;
    let (normal, incoming) = (facing(hit, ray), ray.direction.normalize());
    let (u, v) = (sampler.next(), sampler.next());
    let mirrored: DVec3 = reflect::<f64>(incoming.into(), normal.into()).into();
    let direction = match kind {
        ScatterKind::Scattered => {
            let local = cosine_hemisphere::<f64>(u, v);
            LocalFrame::from_z(normal.into()).to_world(local).into()
        }
        ScatterKind::Transmitted => incoming,
        ScatterKind::Mirrored => {
            let fuzz: DVec3 = uniform_sphere::<f64>(u, v).into();
            (mirrored + fuzz * f64::from(lobes.fuzz)).normalize_or(mirrored)
        }
        ScatterKind::Glossy => {
            let frame = LocalFrame::<f64>::from_z(normal.into());
            let roughness = if lobes.microfacet > 0.0 { lobes.roughness } else { lobes.coat.roughness };
            let roughness = f64::from(roughness);
            let mirrors = Microfacet { alpha: (roughness * roughness).max(1e-4) };
            let half = frame.to_world(mirrors.sample(frame.to_local((-incoming).into()), u, v));
            reflect::<f64>(incoming.into(), half).into()
        }
        ScatterKind::Refracted => return Some(boundary(material, ray, hit, mirrored, u, share)),
    };
    (kind != ScatterKind::Scattered || direction != DVec3::ZERO).then_some(ScatterSample {
        direction,
        kind,
        share,
    })
}

/// Reflects or refracts at a dielectric boundary, chosen by the Fresnel reflectance.
fn boundary(
    material: &Material,
    ray: &Ray,
    hit: &SurfaceHit,
    mirrored: DVec3,
    u: f64,
    share: f64,
) -> ScatterSample {
    let (normal, incoming) = (facing(hit, ray), ray.direction.normalize());
    let enters = hit.surface.normal.dot(ray.direction) < 0.0;
    let eta = if enters { material.medium.ior } else { 1.0 / material.medium.ior };
    let bent = refract::<f64>(incoming.into(), normal.into(), eta);
    let cosine = -incoming.dot(normal);
    let reflected = if bent.is_total { 1.0 } else { material.fresnel.reflectance(cosine, bent.cosine, eta) };
    match u < reflected {
        true => ScatterSample { direction: mirrored, kind: ScatterKind::Mirrored, share },
        false => ScatterSample { direction: bent.direction.into(), kind: ScatterKind::Refracted, share },
    }
}

/// A sampled point on a light. `per_area` is the geometry term over the pdf; for area lights it is also divided by π.
pub struct LightPoint {
    pub point: DVec3,
    pub per_area: f64,
}

impl SceneRays<'_> {
    /// Samples a point on a light.
    fn point_on_light(
        &self,
        light: u32,
        from: &crate::geometry::shape::Surface,
        [u, v]: [f64; 2],
    ) -> LightPoint {
        let at = from.point;
        let flat = |point: DVec3, normal: DVec3, area: f64, both: bool| {
            let way = at - point;
            let square = way.length_squared();
            let cosine = normal.dot(way) / square.sqrt();
            let cosine = if both { cosine.abs() } else { cosine.max(0.0) };
            LightPoint { point, per_area: area * cosine / square / PI }
        };
        match &self.scene.shading.lights[light as usize].source {
            Source::Point { position, .. } | Source::Spot { position, .. } => {
                LightPoint { point: *position, per_area: 1.0 }
            }
            Source::Directional { to_light } => {
                LightPoint { point: at + *to_light * self.far(), per_area: 1.0 }
            }
            Source::Sphere(sphere) => {
                let (surface, _, pdf) = sphere.sample_from(at.into(), &FrameAxes::<f64>::identity(), u, v);
                let per_area = if pdf > 0.0 { 1.0 / (PI * pdf) } else { 0.0 };
                LightPoint { point: surface.point.into(), per_area }
            }
            Source::Rectangle { rectangle, one_sided } => {
                let point = rectangle.corner + rectangle.u * u + rectangle.v * v;
                let normal = rectangle.u.cross(rectangle.v);
                flat(point, normal.normalize_or_zero(), normal.length(), !one_sided)
            }
        }
    }
}
