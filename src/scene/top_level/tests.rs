use super::*;
use crate::appearance::material::MaterialBinding;
use crate::base::lanes::tests::on_all_levels;
use crate::base::lanes::{Level, Mask, Row, SimdKernel, dispatch, lanes};
use crate::base::math::{DAffine3, DVec3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{
    Cone, Cuboid, Cylinder, Disk, Plane, PreparedRay, RayInterval, Rectangle, Shape, Sphere, Torus, Triangle,
};
use crate::scene::{Finish, Geometry};
use crate::testing::{Random, eight_rays, geometry};

fn random_shape(random: &mut Random) -> Shape {
    let p = random.point(10.0);
    match (random.unit() * 9.0) as u32 {
        0 => Shape::Sphere(Sphere { center: p, radius: 0.1 + random.unit() }),
        1 => Shape::Triangle(Triangle { corners: [p, p + random.point(1.0), p + random.point(1.0)] }),
        2 => Shape::Rectangle(Rectangle { corner: p, u: random.point(1.0), v: random.point(1.0) }),
        3 => Shape::Disk(Disk { center: p, normal: random.point(1.0).normalize(), radius: random.unit() }),
        4 => Shape::Cuboid(Cuboid { min: p, max: p + DVec3::splat(0.5) }),
        5 => {
            let to = p + random.point(1.0);
            Shape::Cylinder(Cylinder::new(p, to, 0.1 + random.unit(), random.unit() < 0.5).expect("a length"))
        }
        6 => {
            let (apex, top) = (p + random.point(1.0), (random.unit() - 0.5).max(0.0));
            Shape::Cone(Cone::new(p, apex, 0.1 + random.unit(), top, random.unit() < 0.5).expect("a height"))
        }
        7 => Shape::Torus(Torus::new(p, random.direction(), 1.0, 0.1 + 0.8 * random.unit())),
        // A grid of flat axis-aligned tiles: boxes without thickness, and shared edges.
        _ => {
            let corner = p.floor();
            Shape::Rectangle(Rectangle { corner, u: DVec3::X, v: DVec3::Z })
        }
    }
}

fn random_geometry(random: &mut Random, count: usize) -> Geometry {
    let mut geometry = Geometry::default();
    while geometry.primitives.len() < count {
        let affine = match (random.unit() * 3.0) as u32 {
            0 => DAffine3::IDENTITY,
            1 => DAffine3::from_translation(random.point(2.0)),
            _ => {
                DAffine3::from_axis_angle(random.point(1.0).normalize(), random.unit())
                    * DAffine3::from_scale(DVec3::new(1.0, 2.0, 0.5))
            }
        };
        geometry.push(&random_shape(random), affine, Finish::Material(MaterialBinding::One(0)));
    }
    let floor = Shape::Plane(Plane { point: DVec3::NEG_Y * 12.0, normal: DVec3::Y });
    geometry.push(&floor, DAffine3::IDENTITY, Finish::Material(MaterialBinding::One(0)));
    geometry
}

fn brute_force(geometry: &Geometry, ray: &TraversalRay) -> Option<Hit> {
    let hits = (0..).zip(&geometry.primitives);
    let hits = hits.filter_map(|(primitive, p)| Some(Hit { at: p.hit(ray, f64::INFINITY)?, primitive }));
    let hits: Vec<_> = hits.collect();
    let mut nearest = *hits.iter().reduce(|best, hit| if hit.at.t < best.at.t { hit } else { best })?;
    let end = Bvh::build(geometry).coincidence_range(ray).end(nearest.at.t);
    nearest.at.coincident |= hits.iter().filter(|hit| hit.at.t < end).count() > 1;
    Some(nearest)
}

fn random_ray(random: &mut Random) -> Ray {
    let origin = random.point(15.0);
    let direction = match (random.unit() * 4.0) as u32 {
        0 => DVec3::X,
        1 => DVec3::new(-0.0, -1.0, 0.0),
        2 => origin.floor() - origin,
        _ => random.point(1.0),
    };
    // Through lattice points too: corners and edges of tiles.
    let origin = if random.unit() < 0.3 { origin.floor() } else { origin };
    Ray { origin, direction: if direction == DVec3::ZERO { DVec3::Z } else { direction } }
}

#[test]
fn the_tree_equals_brute_force() {
    let mut random = Random(1);
    for count in [0, 1, 2, 3, 8, 300] {
        let geometry = random_geometry(&mut random, count);
        let bvh = Bvh::build(&geometry);
        for _ in 0..4000 {
            let ray = TraversalRay::new(random_ray(&mut random));
            let expected = brute_force(&geometry, &ray);
            for (level, hit) in on_all_levels(|| bvh.closest(&geometry, &ray)) {
                assert_eq!(hit, expected, "{ray:?}, {level:?}");
            }
            let t_max = random.unit() * 20.0;
            let blocked = expected.is_some_and(|hit| hit.at.t < t_max);
            for (level, occluded) in on_all_levels(|| bvh.occluded(&geometry, &ray, t_max)) {
                assert_eq!(occluded, blocked, "{ray:?} {t_max}, {level:?}");
            }
        }
    }
}

#[test]
fn the_first_of_equals_wins() {
    let sphere = Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 });
    let geometry = geometry(vec![sphere; 40]);
    let bvh = Bvh::build(&geometry);
    let mut random = Random(2);
    for _ in 0..1000 {
        let origin = random.point(1.0).normalize() * 5.0;
        let ray = TraversalRay::new(Ray { origin, direction: random.point(0.3) - origin });
        assert_eq!(bvh.closest(&geometry, &ray).map(|hit| hit.primitive), Some(0));
    }
}

#[test]
fn flat_boxes_are_not_lost() {
    let mut random = Random(3);
    for _ in 0..20_000 {
        let corner = random.point(5.0);
        let (u, v) = (DVec3::X * random.unit(), DVec3::Z * random.unit());
        let tile = Shape::Rectangle(Rectangle { corner, u, v });
        let geometry = geometry([tile]);
        let bvh = Bvh::build(&geometry);
        let origin = random.point(100.0);
        let aim = corner + u * random.unit() + v * if random.unit() < 0.5 { 0.0 } else { random.unit() };
        let ray = TraversalRay::new(Ray { origin, direction: aim - origin });
        assert_eq!(bvh.closest(&geometry, &ray), brute_force(&geometry, &ray));
    }
}

#[test]
fn deep_trees_are_walked_to_the_end() {
    // Each sphere contains all previous ones: boxes that double in size degrade the tree to a chain.
    let spheres = (0..220).map(|k| Sphere { center: DVec3::ZERO, radius: libm::exp2(f64::from(k - 110)) });
    let geometry = geometry(spheres.map(Shape::Sphere));
    let bvh = Bvh::build(&geometry);
    let mut random = Random(4);
    for _ in 0..300 {
        let origin = random.point(1.0) * libm::exp2(200.0 * random.unit() - 100.0);
        let ray = TraversalRay::new(Ray { origin, direction: random.point(1.0) });
        assert_eq!(bvh.closest(&geometry, &ray), brute_force(&geometry, &ray));
    }
}

/// Eight rays, the bits of those to be searched, and their intervals of t.
#[derive(Clone, Copy, Debug)]
struct Eight {
    rays: [Ray; 8],
    wanted: u32,
    min: [f64; 8],
    max: [f64; 8],
}

impl Eight {
    /// Neighbours from one place, or random rays.
    fn new(random: &mut Random) -> Self {
        let first = random_ray(random);
        let together = random.unit() < 0.6;
        let rays = std::array::from_fn(|_| match together {
            true => Ray { direction: first.direction + random.point(0.02), ..first },
            false => random_ray(random),
        });
        let wanted = if random.unit() < 0.5 { 0xff } else { (256.0 * random.unit()) as u32 };
        let min = [0; 8].map(|_| if random.unit() < 0.7 { 0.0 } else { 3.0 * random.unit() });
        let max = [0; 8].map(|_| if random.unit() < 0.5 { f64::INFINITY } else { 20.0 * random.unit() });
        Self { rays, wanted, min, max }
    }

    fn within<L: Level>(&self) -> RayInterval<L::F64> {
        RayInterval { min: L::F64::from_array(self.min), max: L::F64::from_array(self.max) }
    }

    /// The rays to be searched, with their lanes.
    fn each(&self) -> impl Iterator<Item = (usize, TraversalRay, RayInterval<f64>)> {
        lanes(self.wanted).map(|lane| {
            let within = RayInterval { min: self.min[lane], max: self.max[lane] };
            (lane, TraversalRay::new(self.rays[lane]), within)
        })
    }
}

struct Intersect<'a>(&'a Bvh, &'a Geometry, &'a Eight, Coherence);

impl SimdKernel for Intersect<'_> {
    type Output = [Option<Hit>; 8];

    #[inline(always)]
    fn run<L: Level>(self) -> Self::Output {
        let Self(bvh, geometry, eight, coherence) = self;
        let (ray, wanted) = (eight_rays::<L>(&eight.rays), L::Mask::from_bits(eight.wanted));
        let stacks = &mut Stacks::default();
        let hits = bvh.intersect::<L>(geometry, &ray, eight.within::<L>(), wanted, coherence, stacks).store();
        std::array::from_fn(|lane| hits.lane(lane))
    }
}

struct Occlude<'a>(&'a Bvh, &'a Geometry, &'a Eight, Coherence, Option<TransmissiveFlags<'a>>);

impl SimdKernel for Occlude<'_> {
    /// The bits of blocked rays, and of dimmed ones.
    type Output = [u32; 2];

    #[inline(always)]
    fn run<L: Level>(self) -> [u32; 2] {
        let Self(bvh, geometry, eight, coherence, transmissive) = self;
        let (ray, wanted) = (eight_rays::<L>(&eight.rays), L::Mask::from_bits(eight.wanted));
        let (within, stacks) = (eight.within::<L>(), &mut Stacks::default());
        let found = bvh.occlusion::<L>(geometry, &ray, within, wanted, (coherence, transmissive), stacks);
        [found.blocked.bits(), found.dimmed.bits()]
    }
}

/// Runs a test for geometries with and without a tree, with eight rays at a time.
fn each_eight(mut test: impl FnMut(&Geometry, &Bvh, &Eight, &mut Random, Coherence)) {
    let mut random = Random(5);
    for count in [0, 1, 3, 11, 12, 300] {
        let geometry = random_geometry(&mut random, count);
        let bvh = Bvh::build(&geometry);
        for _ in 0..1000 {
            let eight = Eight::new(&mut random);
            for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                test(&geometry, &bvh, &eight, &mut random, coherence);
            }
        }
    }
}

#[test]
fn eight_rays_meet_what_each_of_them_does() {
    let mut met = 0;
    each_eight(|geometry, bvh, eight, _, coherence| {
        for (level, hits) in on_all_levels(|| dispatch(Intersect(bvh, geometry, eight, coherence))) {
            for (lane, ray, within) in eight.each() {
                let expected = bvh.closest_within(geometry, &ray, within);
                assert_eq!(hits[lane], expected, "{level:?}, {coherence:?}, {lane} of {eight:?}");
                met += u32::from(expected.is_some());
            }
        }
    });
    assert!(met > 10_000, "{met}");
}

#[test]
fn eight_rays_are_blocked_where_each_of_them_is() {
    let mut found = [0; 2];
    each_eight(|geometry, bvh, eight, random, coherence| {
        let flags: Vec<bool> = geometry.primitives.iter().map(|_| random.unit() < 0.3).collect();
        let transmissive = (random.unit() < 0.7).then_some(TransmissiveFlags(&flags));
        let stops = |index: usize| transmissive.is_none() || !flags[index];
        let all = on_all_levels(|| dispatch(Occlude(bvh, geometry, eight, coherence, transmissive)));
        for (lane, ray, within) in eight.each() {
            let [mut blocked, mut dimmed] = [false; 2];
            for (index, primitive) in geometry.primitives.iter().enumerate() {
                let meets = primitive.occludes(&PreparedRay::<f64>::splat(&ray), within);
                if stops(index) { blocked |= meets } else { dimmed |= meets }
            }
            let expected = [blocked, dimmed && !blocked];
            for (level, bits) in &all {
                let actual = bits.map(|bits| bits >> lane & 1 == 1);
                assert_eq!(actual, expected, "{level:?}, {coherence:?}, {lane} of {eight:?}");
            }
            for (count, is) in found.iter_mut().zip(expected) {
                *count += u32::from(is);
            }
        }
    });
    assert!(found.iter().all(|count| *count > 1000), "{found:?}");
}
