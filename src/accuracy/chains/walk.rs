//! One path, surface by surface.

use super::{Thing, Way, strength};
use crate::accuracy::robustness::{Met, Scenery};
use crate::appearance::light::Source;
use crate::appearance::material::Material;
use crate::appearance::optics::{Microfacet, reflect, refract};
use crate::base::color::Rgb;
use crate::base::math::{DVec2, DVec3, Ray};
use crate::geometry::bvh::Probe;
use crate::geometry::shape::Geometric;
use crate::sampling::{Frame, cosine_hemisphere, hash, uniform_sphere};
use crate::scene::Finish;
use crate::trace::spawn::spawn_ray;
use std::f64::consts::PI;

/// Random numbers of a path.
pub struct Numbers {
    seed: u32,
    count: u32,
}

impl Numbers {
    pub fn new(pixel: u32, path: u32) -> Self {
        Self { seed: hash([pixel, path, 9]), count: 0 }
    }

    pub fn next(&mut self) -> f64 {
        self.count += 1;
        f64::from(hash([self.seed, self.count, 8])) / 4_294_967_296.0
    }
}

/// How paths are followed through a scene.
pub struct Walk<'a> {
    scenery: &'a Scenery<'a>,
    bounces: u32,
}

/// Where a path has come to.
struct Path {
    ray: Ray,
    throughput: f64,
    chain: Vec<Thing>,
    /// Whether the last surface could not ask lights: then what is met counts in full.
    sharp: bool,
}

/// How a surface sends a path on.
struct Sent {
    direction: DVec3,
    way: Way,
    /// What is left of the light.
    share: f64,
}

impl<'a> Walk<'a> {
    pub fn new(scenery: &'a Scenery<'a>, bounces: u32) -> Self {
        Self { scenery, bounces }
    }

    /// Follows a path through a place in a pixel, and gives each chain that finds light with what it adds.
    pub fn follow(
        &self,
        pixel: (u32, u32),
        size: (u32, u32),
        jitter: DVec2,
        numbers: &mut Numbers,
        add: &mut dyn FnMut(&[Thing], f64),
    ) {
        let ray = self.scenery.ray_within(pixel, size, jitter);
        let mut path = Path { ray, throughput: 1.0, chain: Vec::new(), sharp: true };
        for surfaces in 0..=self.bounces + 1 {
            let Some(met) = self.scenery.met(&path.ray) else { return self.escape(&mut path, add) };
            let primitive = self.scenery.primitive(met.target.0);
            if let Finish::Light(index) = primitive.finish {
                return self.meet(&mut path, index, add);
            }
            let Some(index) = primitive.material(met.part) else { return };
            let material = &self.scenery.scene.shading.materials[index as usize];
            let emission = f64::from(material.lobes.emission.max_element());
            if emission > 0.0 && path.sharp {
                self.end(&mut path, Thing::Emission(index), emission, add);
            }
            if surfaces > self.bounces {
                return;
            }
            self.ask(&mut path, &met, (index, material), numbers, add);
            let Some(sent) = sent(material, &path.ray, &met, numbers) else { return };
            path.throughput *= sent.share;
            path.sharp = !matches!(sent.way, Way::Scattered | Way::Glossy);
            path.chain.push(Thing::Surface(index, sent.way));
            path.ray = spawn_ray(&met.surface, sent.direction);
        }
    }

    fn end(&self, path: &mut Path, thing: Thing, light: f64, add: &mut dyn FnMut(&[Thing], f64)) {
        path.chain.push(thing);
        add(&path.chain, path.throughput * light);
        path.chain.pop();
    }

    /// A path that meets a light counts if no surface has asked it before.
    fn meet(&self, path: &mut Path, index: u32, add: &mut dyn FnMut(&[Thing], f64)) {
        if path.sharp {
            let light = self.strength(index);
            self.end(path, Thing::Light(index), light, add);
        }
    }

    fn escape(&self, path: &mut Path, add: &mut dyn FnMut(&[Thing], f64)) {
        let shading = self.scenery.scene.shading;
        if shading.environment.is_black() {
            return;
        }
        let color = shading.environment.radiance::<f64>(path.ray.direction.normalize().into());
        let light = f64::from(Rgb::from(color).max_element());
        self.end(path, Thing::Background, light, add);
    }

    fn strength(&self, index: u32) -> f64 {
        let scene = self.scenery.scene;
        let light = &scene.shading.lights[index as usize];
        strength(light, scene.weights.0[light.layer.index()])
    }

    /// Asks one of the lights what it sends to a surface that scatters.
    fn ask(
        &self,
        path: &mut Path,
        met: &Met,
        (index, material): (u32, &Material),
        numbers: &mut Numbers,
        add: &mut dyn FnMut(&[Thing], f64),
    ) {
        let scattered = scattered(material);
        let lights: Vec<u32> = self.scenery.scene.lights().map(|(index, _)| index).collect();
        let (choice, u, v) = (numbers.next(), numbers.next(), numbers.next());
        let Some(&light) = lights.get((choice * lights.len() as f64) as usize) else { return };
        if scattered <= 0.0 {
            return;
        }
        let place = self.scenery.place_on(light, &met.surface, [u, v]);
        let normal = facing(met, &path.ray);
        let way = place.point - met.surface.point;
        let cosine = normal.dot(way.normalize());
        if cosine <= 0.0 || place.per_area <= 0.0 {
            return;
        }
        let start = spawn_ray(&met.surface, way);
        let probe = Probe::new(Ray { direction: place.point - start.origin, ..start });
        if self.scenery.blocked(&probe) {
            return;
        }
        let light_of = self.strength(light) * place.per_area * lights.len() as f64;
        path.chain.push(Thing::Surface(index, Way::Scattered));
        self.end(path, Thing::Light(light), scattered * cosine * light_of, add);
        path.chain.pop();
    }
}

fn facing(met: &Met, ray: &Ray) -> DVec3 {
    let normal = met.surface.normal;
    if normal.dot(ray.direction) > 0.0 { -normal } else { normal }
}

fn largest(color: Rgb) -> f64 {
    f64::from(color.max_element())
}

/// Rougher ones scatter light as diffuse surfaces do, about.
const ROUGH: f32 = 0.4;

fn is_glossy(material: &Material) -> bool {
    material.lobes.metallic > 0.5 || material.lobes.roughness < ROUGH
}

/// The reflectance by which light is scattered all around.
fn scattered(material: &Material) -> f64 {
    let lobes = &material.lobes;
    let base = if is_glossy(material) { 0.0 } else { f64::from(lobes.microfacet) * largest(lobes.base) };
    largest(lobes.diffuse) + base
}

/// Draws how a surface sends a path on; none where it takes all light.
fn sent(material: &Material, ray: &Ray, met: &Met, numbers: &mut Numbers) -> Option<Sent> {
    let lobes = &material.lobes;
    let glossy = if is_glossy(material) { f64::from(lobes.microfacet) * largest(lobes.base) } else { 0.0 };
    let mirror = largest(lobes.mirror);
    let (passed, refracted) = (largest(lobes.transparency), largest(lobes.refraction));
    let weights = [
        (Way::Scattered, scattered(material)),
        (Way::Mirrored, mirror),
        (Way::Glossy, glossy),
        (Way::Passed, passed),
        (Way::Refracted, refracted),
    ];
    let share: f64 = weights.iter().map(|(_, weight)| weight).sum();
    let mut rest = numbers.next() * share;
    let chosen = weights.into_iter().find(|(_, weight)| {
        rest -= weight;
        rest < 0.0
    });
    let (way, _) = chosen?;
    let (normal, incoming) = (facing(met, ray), ray.direction.normalize());
    let (u, v) = (numbers.next(), numbers.next());
    let mirrored: DVec3 = reflect::<f64>(incoming.into(), normal.into()).into();
    let direction = match way {
        Way::Scattered => {
            let local = cosine_hemisphere::<f64>(u, v);
            Frame::around(normal.into()).to_world(local).into()
        }
        Way::Passed => incoming,
        Way::Mirrored => {
            let fuzz: DVec3 = uniform_sphere::<f64>(u, v).into();
            (mirrored + fuzz * f64::from(lobes.fuzz)).normalize_or(mirrored)
        }
        Way::Glossy => {
            let frame = Frame::<f64>::around(normal.into());
            let roughness = f64::from(lobes.roughness);
            let mirrors = Microfacet { alpha: (roughness * roughness).max(1e-4) };
            let half = frame.to_world(mirrors.sample(frame.to_local((-incoming).into()), u, v));
            reflect::<f64>(incoming.into(), half).into()
        }
        Way::Refracted => return Some(boundary(material, ray, met, mirrored, u, share)),
    };
    (way != Way::Scattered || direction != DVec3::ZERO).then_some(Sent { direction, way, share })
}

/// At a boundary light is reflected or refracted, by Fresnel's share.
fn boundary(material: &Material, ray: &Ray, met: &Met, mirrored: DVec3, u: f64, share: f64) -> Sent {
    let (normal, incoming) = (facing(met, ray), ray.direction.normalize());
    let enters = met.surface.normal.dot(ray.direction) < 0.0;
    let eta = if enters { material.medium.ior } else { 1.0 / material.medium.ior };
    let bent = refract::<f64>(incoming.into(), normal.into(), eta);
    let cosine = -incoming.dot(normal);
    let reflected = if bent.is_total { 1.0 } else { material.fresnel.reflectance(cosine, bent.cosine, eta) };
    match u < reflected {
        true => Sent { direction: mirrored, way: Way::Mirrored, share },
        false => Sent { direction: bent.direction.into(), way: Way::Refracted, share },
    }
}

/// A place on a light, and what of its radiance comes from there: geometry over density, over π where the light has an area.
pub struct Place {
    pub point: DVec3,
    pub per_area: f64,
}

impl Scenery<'_> {
    /// Draws a place on a light.
    fn place_on(&self, light: u32, from: &crate::geometry::shape::Surface, [u, v]: [f64; 2]) -> Place {
        let at = from.point;
        let flat = |point: DVec3, normal: DVec3, area: f64, both: bool| {
            let way = at - point;
            let square = way.length_squared();
            let cosine = normal.dot(way) / square.sqrt();
            let cosine = if both { cosine.abs() } else { cosine.max(0.0) };
            Place { point, per_area: area * cosine / square / PI }
        };
        match &self.scene.shading.lights[light as usize].source {
            Source::Point { position, .. } | Source::Spot { position, .. } => {
                Place { point: *position, per_area: 1.0 }
            }
            Source::Directional { to_light } => Place { point: at + *to_light * self.far(), per_area: 1.0 },
            Source::Sphere(sphere) => {
                let (surface, _, pdf) = sphere.sample_from(at.into(), &Frame::<f64>::identity(), u, v);
                let per_area = if pdf > 0.0 { 1.0 / (PI * pdf) } else { 0.0 };
                Place { point: surface.point.into(), per_area }
            }
            Source::Rectangle { rectangle, one_sided } => {
                let point = rectangle.corner + rectangle.u * u + rectangle.v * v;
                let normal = rectangle.u.cross(rectangle.v);
                flat(point, normal.normalize_or_zero(), normal.length(), !one_sided)
            }
        }
    }
}
