//! Random scenes, to compare one way of tracing with another.

mod everything;
mod tests;

use crate::appearance::environment::{Environment, Sky};
use crate::appearance::light::{Attenuation, Light, Source, SpotCone};
use crate::appearance::light_groups::GroupRadiance;
use crate::appearance::material::{
    Exponent, Highlight, Lobes, Material, MaterialBinding, Medium, TextureSlot,
};
use crate::appearance::optics::Fresnel;
use crate::appearance::texture::{Pattern, PatternTexture, Texture, TextureMappingTracks, TextureSpace};
use crate::base::color::Rgb;
use crate::base::math::{Angle, DAffine3, DMat3, DVec3, axis_angle, look_at};
use crate::base::stats::{Counts, ProgressMeter};
use crate::base::time::Time;
use crate::camera::{Camera, Projection, ThinLens};
use crate::film::filter::FilterSampler;
use crate::film::{AovSet, Film, LayerId};
use crate::geometry::mesh::{self, Normals, generate};
use crate::geometry::shape::{
    Cone as ConeShape, Cuboid, Cylinder, Disk, Mesh, Operation, Plane, Rectangle, Shape, Solid, Sphere,
    Triangle,
};
use crate::scene::top_level::Bvh;
use crate::scene::{Finish, Geometry, Scene, Shading, Weights};
use crate::sequence::quality::{Integrator, PathSettings, Quality};
use crate::testing::Random;
use crate::trace::pixels::{PixelTracer, SampleSet};
use crate::trace::{Moment, TraceSettings, trace};
use std::ops::Range;
use std::sync::Arc;

const SIZE: (u32, u32) = (61, 37);

fn color(random: &mut Random) -> Rgb {
    Rgb::new(random.unit() as f32, random.unit() as f32, random.unit() as f32)
}

/// One of a few values.
fn one_of<T: Copy>(random: &mut Random, values: &[T]) -> T {
    values[(random.unit() * values.len() as f64) as usize]
}

fn layer(random: &mut Random) -> LayerId {
    LayerId(one_of(random, &[0, 1, 2]))
}

/// A pattern in the colours of some lobes, in object space or over u and v.
fn texture(random: &mut Random) -> (Vec<TextureSlot>, Texture) {
    let patterns = [
        Pattern::Checker,
        Pattern::Stripes,
        Pattern::Waves,
        Pattern::Noise { octaves: 3, seed: 1 },
        Pattern::Marble { octaves: 2, seed: 4, turbulence: 1.0 },
    ];
    let pattern = PatternTexture {
        pattern: one_of(random, &patterns),
        space: one_of(random, &[TextureSpace::Object, TextureSpace::Uv]),
        mapping: TextureMappingTracks::default().at(Time::from_integer(0)),
        // Black removes a lobe.
        first: Texture::Color(one_of(random, &[Rgb::ZERO, Rgb::ONE])),
        second: Texture::Color(color(random)),
    };
    let slots = [TextureSlot::Ambient, TextureSlot::Diffuse, TextureSlot::Specular, TextureSlot::Mirror];
    (slots.into_iter().filter(|_| random.unit() < 0.6).collect(), Texture::Pattern(Box::new(pattern)))
}

fn material(random: &mut Random) -> Material {
    let textured = random.unit() < 0.4;
    let mut lobe = |chance: f64| if random.unit() < chance { color(random) } else { Rgb::ZERO };
    let lobes = Lobes {
        ambient: lobe(0.7),
        diffuse: lobe(0.8),
        specular: lobe(0.6),
        mirror: lobe(0.6),
        emission: if textured { Rgb::ZERO } else { lobe(0.2) },
        ..Lobes::default()
    };
    Material {
        lobes,
        textures: if textured { vec![texture(random)] } else { Vec::new() },
        emission_layer: layer(random),
        highlight: one_of(random, &[Highlight::Phong, Highlight::BlinnPhong]),
        shininess: Exponent::new(one_of(random, &[0.0, 1.0, 32.0, 200.0, 7.5])),
        fresnel: Fresnel::Off,
        medium: Medium::EMPTY,
        relief: Default::default(),
    }
}

/// Turns a material into smooth metal or plastic, which needs no random samples.
fn polish(material: &mut Material, random: &mut Random) {
    material.lobes = Lobes {
        microfacet: 1.0,
        base: color(random),
        metallic: one_of(random, &[0.0, 0.5, 1.0]),
        ambient: material.lobes.ambient,
        ..Lobes::default()
    };
    material.textures.clear();
    material.medium.ior = 1.5;
}

fn shape(random: &mut Random, kind: usize) -> Shape {
    let mut point = || random.point(3.0);
    let (a, b, c) = (point(), point(), point());
    let radius = 0.2 + random.unit();
    let operation = one_of(random, &[Operation::Difference, Operation::Intersection, Operation::Union]);
    match kind % 10 {
        0 => Shape::Plane(Plane { point: a, normal: b.normalize_or(DVec3::Y) }),
        1 => Shape::Triangle(Triangle { corners: [a, b, c] }),
        2 => Shape::Cuboid(Cuboid { min: a.min(b), max: a.max(b) }),
        3 => Shape::Disk(Disk { center: a, normal: b.normalize_or(DVec3::Y), radius }),
        4 => Shape::Rectangle(Rectangle { corner: a, u: b, v: b.cross(c) }),
        5 => Shape::Cylinder(Cylinder::new(a, b, radius, true).expect("a cylinder")),
        6 => Shape::Cone(ConeShape::new(a, b, radius, 0.0, true).expect("a cone")),
        7 => {
            let parts = vec![shape(random, 2), Shape::Sphere(Sphere { center: a, radius: 2.0 * radius })];
            Shape::Solid(Solid::new(operation, parts))
        }
        8 => {
            let cut = Plane { point: a, normal: c.normalize_or(DVec3::Y) };
            Shape::Solid(Solid::cut(&shape(random, 2 + kind % 5), [cut]))
        }
        _ => Shape::Sphere(Sphere { center: a, radius }),
    }
}

fn light(random: &mut Random) -> Light {
    let position = random.point(6.0);
    let attenuation = Attenuation { constant: 1.0, linear: 0.1 * random.unit(), quadratic: 0.05 };
    let cone =
        SpotCone { axis: -position.normalize_or(DVec3::Y), cos_falloff_start: 0.9, cos_falloff_end: 0.6 };
    let source = match (random.unit() * 4.0) as u32 {
        0 => Source::Point { position, attenuation: Attenuation::default() },
        1 => Source::Point { position, attenuation },
        2 => Source::Spot { position, cone, attenuation },
        _ => Source::Directional { to_light: position.normalize_or(DVec3::Y) },
    };
    // Most cast shadows.
    Light { source, radiance: color(random), shadows: position.x < 3.0, layer: layer(random) }
}

/// A random scene. Some are far from the origin, others are seen from afar.
pub struct RandomScene {
    geometry: Geometry,
    shading: Shading,
    camera: Camera,
    quality: Quality,
    /// The centre of all objects.
    middle: DVec3,
    /// The number of layers of light.
    layers: usize,
    aovs: AovSet,
}

impl RandomScene {
    /// A scene for Whitted's integrator.
    pub fn new(seed: u64) -> Self {
        let random = &mut Random(seed);
        let middle = one_of(random, &[DVec3::ZERO, DVec3::new(1e5, -3e4, 2e3)]);
        let moved = DAffine3::from_translation(middle);
        let mut materials: Vec<_> = (0..4).map(|_| material(random)).collect();
        if seed.is_multiple_of(3) {
            polish(&mut materials[(seed % 4) as usize], &mut Random(seed + 3000));
        }
        let mut geometry = Geometry::default();
        for kind in 0..1 + (random.unit() * 24.0) as usize {
            let finish = Finish::Material(MaterialBinding::One(one_of(random, &[0, 1, 2, 3])));
            let turn = axis_angle(random.direction(), Angle(360.0 * random.unit()));
            let uneven = DMat3::from_diagonal(DVec3::new(1.0, 0.5 + random.unit(), 1.0));
            let placed = DAffine3::from_mat3(one_of(random, &[DMat3::IDENTITY, turn, turn * uneven]));
            geometry.push(&shape(random, kind), moved * placed, finish);
        }
        let sky = Sky::Gradient { bottom: color(random), top: color(random), up: DVec3::Y };
        let shading = Shading {
            materials,
            lights: (0..3).map(|_| shifted(light(random), middle)).collect(),
            environment: Environment { sky, layer: layer(random), ..Environment::default() },
            ambient: GroupRadiance { radiance: color(random), layer: layer(random) },
            ..Shading::default()
        };
        let position = middle + random.direction() * one_of(random, &[2.0, 8.0, 300.0]);
        let half_height = one_of(random, &[0.03, 0.5, 2.0]);
        let projection = one_of(
            random,
            &[Projection::Perspective { half_height }, Projection::Orthographic { half_height: 4.0 }],
        );
        let basis = look_at(position, middle, DVec3::Y).expect("a frame");
        let quality = Quality {
            bounces: one_of(random, &[0, 1, 4]),
            antialias: one_of(random, &[1, 2]),
            threshold: one_of(random, &[0.0, 0.3]),
            clamp: one_of(random, &[None, Some(0.5)]),
            ..Quality::default()
        };
        Self {
            geometry,
            shading,
            camera: Camera { position, basis, projection, lens: None },
            quality,
            middle,
            layers: 3,
            aovs: AovSet::default(),
        }
    }

    /// A scene for paths. Some scenes have meshes, a lens, and materials that transmit or scatter light.
    pub fn of_paths(seed: u64) -> Self {
        let mut scene = Self::new(seed);
        let random = &mut Random(seed + 1000);
        let chance = |random: &mut Random, share: f64| random.unit() < share;
        // In some scenes a matt mesh is the only object, so that neighbouring rays hit nothing else.
        let alone = seed % 4 == 3;
        for material in &mut scene.shading.materials {
            let Lobes { ambient, diffuse, mirror, .. } = material.lobes;
            let matt = Lobes { ambient, diffuse, ..Lobes::default() };
            let lobes = match random.unit() {
                share if alone || share < 0.4 => matt,
                share if share < 0.5 => Lobes { ambient, mirror, ..Lobes::default() },
                share if share < 0.7 => Lobes { ambient, mirror, fuzz: 0.7, ..Lobes::default() },
                _ => continue,
            };
            material.lobes = lobes;
        }
        let first = &mut scene.shading.materials[0];
        match seed % 4 {
            0 => (first.lobes.refraction, first.medium.ior) = (color(random), 1.5),
            1 => first.lobes.fuzz = 0.3,
            2 => first.lobes.transparency = color(random),
            _ => {}
        }
        if chance(random, 0.3) {
            scene.shading.lights.clear();
        }
        let environment = &mut scene.shading.environment;
        environment.from_world = DMat3::from_axis_angle(random.direction(), random.unit());
        if chance(random, 0.3) {
            environment.sky = Sky::Constant(color(random));
        }
        let middle = DAffine3::from_translation(scene.middle);
        if alone {
            scene.geometry = Geometry::default();
            scene.quality.smooth_terminator = seed % 8 == 7;
        }
        let all = [Normals::Smooth, Normals::Flat];
        for normals in all.into_iter().take(if alone { 1 } else { 2 }) {
            let mut parts = generate::displaced_sphere(3, seed);
            let turn = axis_angle(random.direction(), Angle(360.0 * random.unit()));
            let mut place =
                middle * DAffine3::from_translation(random.point(2.0)) * DAffine3::from_mat3(turn);
            // Some meshes have no transform of their own.
            if alone || chance(random, 0.5) {
                let moved =
                    parts.positions.iter().map(|position| place.transform_point3(*position)).collect();
                (parts.positions, place) = (moved, DAffine3::IDENTITY);
            }
            let mesh = Arc::new(mesh::TriangleMesh::new(parts).expect("a mesh"));
            let finish = Finish::Material(MaterialBinding::One(one_of(random, &[0, 1, 2, 3])));
            scene.geometry.push(&Shape::Mesh(Mesh::new(mesh, normals)), place, finish);
        }
        if chance(random, 0.5) {
            scene.camera.lens = Some(ThinLens { radius: 0.1, focus: 4.0 });
        }
        let roulette = one_of(random, &[None, Some(1)]);
        let path = PathSettings { roulette, refractive_shadows: chance(random, 0.5) };
        scene.quality.integrator = Integrator::Path(path);
        scene.quality.samples = one_of(random, &[1, 3]);
        // None of these numbers of layers is a power of two.
        scene.layers = one_of(random, &[3, 3, 9, 20]);
        scene
    }

    /// The objects, and their materials and lights.
    pub fn content(&self) -> (&Geometry, &Shading) {
        (&self.geometry, &self.shading)
    }

    /// The camera, the quality, the AOVs and the number of layers.
    pub fn settings(&self) -> (Camera, Quality, AovSet, usize) {
        (self.camera, self.quality, self.aovs, self.layers)
    }

    /// The layers of the image and the counts, traced with this many pixels, and samples of each, at a time.
    pub fn trace(&self, pixels_at_once: usize, samples_at_once: u32) -> (Vec<DVec3>, Counts) {
        self.with_settings(|scene, bvh, settings| {
            let (pixels, quality) = (PixelTracer::new(scene, bvh, settings, Moment::ONLY), self.quality);
            let (samples, places, layers) = (pixels.count(), places(), pixels.layers());
            let mut sums = vec![DVec3::ZERO; places.len() * layers];
            let mut counts = Counts::default();
            let parts = places.chunks(pixels_at_once).zip(sums.chunks_mut(pixels_at_once * layers));
            for (places, sums) in parts {
                for first in (0..samples).step_by(samples_at_once as usize) {
                    let samples = first..samples.min(first + samples_at_once);
                    counts += pixels.add(places, &SampleSet { samples, seed: quality.seed }, sums);
                }
            }
            (sums, counts)
        })
    }

    /// Calls `use_it` with a tracer of random samples at a moment, and the places of all pixels.
    pub fn with_tracer<R>(&self, moment: Moment, use_it: impl FnOnce(&PixelTracer, &[(u32, u32)]) -> R) -> R {
        self.with_settings(|scene, bvh, settings| {
            use_it(&PixelTracer::sampled(scene, bvh, settings, moment), &places())
        })
    }

    fn with_settings<R>(&self, use_it: impl FnOnce(&Scene, &Bvh, &TraceSettings) -> R) -> R {
        let Self { geometry, shading, camera, quality, layers, aovs, .. } = self;
        let weights = Weights(vec![Rgb::ONE; *layers]);
        let scene = Scene { geometry, shading, weights: &weights, camera };
        let filter = FilterSampler::new(quality.filter);
        let settings = TraceSettings { size: SIZE, quality: *quality, filter, aovs: *aovs, first_sample: 0 };
        use_it(&scene, &Bvh::build(geometry), &settings)
    }

    /// The film of a range of each pixel's samples.
    pub fn film(&self, samples: Range<u32>) -> Film {
        let Self { geometry, shading, camera, layers, aovs, .. } = self;
        let weights = Weights(vec![Rgb::ONE; *layers]);
        let scene = Scene { geometry, shading, weights: &weights, camera };
        let quality = Quality { samples: samples.len() as u32, noise: None, ..self.quality };
        let filter = FilterSampler::new(quality.filter);
        let settings =
            TraceSettings { size: SIZE, quality, filter, aovs: *aovs, first_sample: samples.start };
        trace(&scene, &Bvh::build(geometry), &settings, &ProgressMeter::default()).0
    }
}

/// The places of all pixels, row by row.
fn places() -> Vec<(u32, u32)> {
    (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))).collect()
}

fn shifted(light: Light, by: DVec3) -> Light {
    let source = match light.source {
        Source::Point { position, attenuation } => Source::Point { position: position + by, attenuation },
        Source::Spot { position, cone, attenuation } => {
            Source::Spot { position: position + by, cone, attenuation }
        }
        other => other,
    };
    Light { source, ..light }
}
