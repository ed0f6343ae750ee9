//! Pictures do not tell how many rays were traced at once, nor on what kind of lanes.

use crate::bvh::Bvh;
use crate::camera::{Camera, Projection};
use crate::color::Rgb;
use crate::counters::Counts;
use crate::environment::{Environment, Sky};
use crate::film::Extras;
use crate::film::LayerId;
use crate::filter::FilterSampler;
use crate::glow::Glow;
use crate::light::{Attenuation, Cone, Light, Source};
use crate::material::{Exponent, Highlight, Lobes, MadeOf, Material, Medium};
use crate::math::{Angle, DAffine3, DMat3, DVec3, axis_angle, look_at};
use crate::optics::Fresnel;
use crate::quality::Quality;
use crate::scene::{Finish, Geometry, Scene, Shading, Weights};
use crate::shape::{Cone as ConeShape, Cuboid, Cylinder, Disk, Plane, Rectangle, Shape, Sphere, Triangle};
use crate::simd::tests::portably;
use crate::testing::Random;
use crate::trace::pixel::Pixels;
use crate::trace::{Moment, TraceSettings, Window};

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

fn material(random: &mut Random) -> Material {
    let mut lobe = |chance: f64| if random.unit() < chance { color(random) } else { Rgb::ZERO };
    let lobes = Lobes {
        ambient: lobe(0.7),
        diffuse: lobe(0.8),
        specular: lobe(0.6),
        mirror: lobe(0.6),
        emission: lobe(0.2),
        ..Lobes::default()
    };
    Material {
        lobes,
        paints: Vec::new(),
        emission_layer: layer(random),
        highlight: one_of(random, &[Highlight::Phong, Highlight::BlinnPhong]),
        shininess: Exponent::new(one_of(random, &[0.0, 1.0, 32.0, 200.0, 7.5])),
        fresnel: Fresnel::Off,
        medium: Medium::EMPTY,
    }
}

fn shape(random: &mut Random, kind: usize) -> Shape {
    let mut point = || random.point(3.0);
    let (a, b, c) = (point(), point(), point());
    let radius = 0.2 + random.unit();
    match kind % 8 {
        0 => Shape::Plane(Plane { point: a, normal: b.normalize_or(DVec3::Y) }),
        1 => Shape::Triangle(Triangle { corners: [a, b, c] }),
        2 => Shape::Cuboid(Cuboid { min: a.min(b), max: a.max(b) }),
        3 => Shape::Disk(Disk { center: a, normal: b.normalize_or(DVec3::Y), radius }),
        4 => Shape::Rectangle(Rectangle { corner: a, u: b, v: b.cross(c) }),
        5 => Shape::Cylinder(Cylinder::new(a, b, radius, true).expect("a cylinder")),
        6 => Shape::Cone(ConeShape::new(a, b, radius, 0.0, true).expect("a cone")),
        _ => Shape::Sphere(Sphere { center: a, radius }),
    }
}

fn light(random: &mut Random) -> Light {
    let position = random.point(6.0);
    let attenuation = Attenuation { constant: 1.0, linear: 0.1 * random.unit(), quadratic: 0.05 };
    let cone = Cone { axis: -position.normalize_or(DVec3::Y), full: 0.9, none: 0.6 };
    let source = match (random.unit() * 4.0) as u32 {
        0 => Source::Point { position, attenuation: Attenuation::default() },
        1 => Source::Point { position, attenuation },
        2 => Source::Spot { position, cone, attenuation },
        _ => Source::Directional { to_light: position.normalize_or(DVec3::Y) },
    };
    Light { source, radiance: color(random), layer: layer(random) }
}

/// A world at random, far from the world's origin for some seeds and seen from afar for others.
struct World {
    geometry: Geometry,
    shading: Shading,
    camera: Camera,
    quality: Quality,
}

impl World {
    fn new(seed: u64) -> Self {
        let random = &mut Random(seed);
        let middle = one_of(random, &[DVec3::ZERO, DVec3::new(1e5, -3e4, 2e3)]);
        let moved = DAffine3::from_translation(middle);
        let materials: Vec<_> = (0..4).map(|_| material(random)).collect();
        let mut geometry = Geometry::default();
        for kind in 0..1 + (random.unit() * 24.0) as usize {
            let finish = Finish::Material(MadeOf::One(one_of(random, &[0, 1, 2, 3])));
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
            ambient: Glow { radiance: color(random), layer: layer(random) },
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
        Self { geometry, shading, camera: Camera { position, basis, projection, lens: None }, quality }
    }

    /// The picture, eight rays at a time or one by one.
    fn trace(&self, together: bool) -> (Vec<DVec3>, Counts) {
        let weights = Weights(vec![Rgb::ONE; 3]);
        let Self { geometry, shading, camera, quality } = self;
        let scene = Scene { geometry, shading, weights: &weights, camera };
        let bvh = Bvh::build(geometry);
        let filter = FilterSampler::new(quality.filter);
        let settings = TraceSettings { size: SIZE, quality: *quality, filter, extras: Extras::default() };
        let mut pixels = Pixels::new(&scene, &bvh, &settings, Moment::ONLY);
        assert!(pixels.together, "a scene for eight rays");
        pixels.together = together;
        let mut sums = vec![DVec3::ZERO; (SIZE.0 * SIZE.1) as usize * 3];
        let window = Window { pixels: &pixels, held: &[0, 1, 2], rows: 0..SIZE.1 };
        let counts = window.trace(&mut sums, |layer, sum| *layer = sum);
        (sums, counts)
    }
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

#[test]
fn eight_rays_see_what_each_of_them_does() {
    let (mut rays, mut mirrored) = (0, 0);
    for seed in 0..150 {
        let world = World::new(seed);
        let (alone, counts) = world.trace(false);
        let (together, counts_together) = world.trace(true);
        assert_eq!(counts, counts_together, "seed {seed}");
        let differ = alone.iter().zip(&together).filter(|(a, b)| a != b).count();
        assert_eq!(differ, 0, "seed {seed}");
        rays += counts.rays.shadow;
        mirrored += counts.rays.mirror;
        if seed % 10 == 0 {
            assert!(portably(|| world.trace(true)).0 == together, "seed {seed}");
        }
    }
    assert!(rays > 100_000 && mirrored > 100_000, "{rays} {mirrored}");
}
