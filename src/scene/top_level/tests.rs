use super::*;
use crate::appearance::material::{Exponent, Highlight, Lobes, Material, MaterialBinding, Medium};
use crate::appearance::optics::Fresnel;
use crate::base::lanes::tests::on_all_levels;
use crate::base::lanes::{Level, Mask, Row, SimdKernel, dispatch, lanes};
use crate::base::math::{DAffine3, DVec3, Ray};
use crate::film::LayerId;
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{
    Cone, Cuboid, Cylinder, Disk, Operation, Particles, Plane, PreparedRay, RayInterval, Rectangle, Shape,
    Solid, Sphere, Torus, Triangle,
};
use crate::scene::{Digests, Finish, Geometry, Shading};
use crate::testing::{Random, eight_rays, geometry};

fn random_shape(random: &mut Random) -> Shape {
    let p = random.point(10.0);
    match (random.unit() * 11.0) as u32 {
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
        8 => {
            let sphere = |_| Sphere { center: p + random.point(1.0), radius: 0.1 + 0.3 * random.unit() };
            Shape::Particles(Particles::still((0..20).map(sphere).collect()))
        }
        9 => {
            let ball = |center| Shape::Sphere(Sphere { center, radius: 0.5 + 0.5 * random.unit() });
            let operations = [Operation::Difference, Operation::Intersection, Operation::Union];
            let parts = [p, p + DVec3::X * 0.7].map(ball).to_vec();
            Shape::Solid(Solid::new(operations[(random.unit() * 3.0) as usize], parts))
        }
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
    let hits =
        hits.filter_map(|(primitive, p)| Some(Hit { at: p.intersect_up_to(ray, f64::INFINITY)?, primitive }));
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
            for (level, hit) in on_all_levels(|| bvh.intersect_one(&geometry, &ray)) {
                assert_eq!(hit, expected, "{ray:?}, {level:?}");
            }
            let t_max = random.unit() * 20.0;
            let blocked = expected.is_some_and(|hit| hit.at.t < t_max);
            for (level, occluded) in on_all_levels(|| bvh.occludes_one(&geometry, &ray, t_max)) {
                assert_eq!(occluded, blocked, "{ray:?} {t_max}, {level:?}");
            }
        }
    }
}

fn matte() -> Material {
    Material {
        lobes: Lobes::default(),
        textures: Vec::new(),
        emission_layer: LayerId::CONSTANT,
        highlight: Highlight::Phong,
        shininess: Exponent::new(1.0),
        fresnel: Fresnel::Exact,
        medium: Medium::EMPTY,
        relief: Default::default(),
    }
}

/// The content of a slot, if it is visible.
type Content = (Shape, DAffine3, bool);

fn of_contents(contents: &[Content]) -> Geometry {
    let mut geometry = Geometry::with_slots(contents.len());
    contents.iter().enumerate().for_each(|(slot, content)| set(&mut geometry, slot, content));
    geometry
}

fn set(geometry: &mut Geometry, slot: usize, (shape, at, visible): &Content) {
    let finish = Finish::Material(MaterialBinding::One(slot as u32 % 3));
    geometry.set(slot, visible.then_some((shape, *at, finish)));
}

/// Moves a primitive a little or far away, flattens it, hides it or shows it.
fn edit((_, at, visible): &mut Content, random: &mut Random) {
    match (random.unit() * 12.0) as u32 {
        0 => *visible = !*visible,
        1 => *at = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0)),
        2 => *at = DAffine3::from_translation(random.point(200.0)),
        3..6 => *at = DAffine3::from_axis_angle(random.direction(), random.unit()),
        _ => *at = DAffine3::from_translation(random.point(0.5)),
    }
}

/// Random edits of single primitives and of all give the geometry, the digest, the extent and the hits of a scene that
/// is made from scratch.
#[test]
fn edits_give_what_a_fresh_scene_gives() {
    let (mut random, mut builds, mut refits) = (Random(6), 0, 0);
    let shading = Shading { materials: vec![matte(); 3], ..Shading::default() };
    for count in [0, 1, 5, 6, 9, 70, 400] {
        let mut content = || (random_shape(&mut random), DAffine3::IDENTITY, true);
        let mut contents: Vec<Content> = (0..count).map(|_| content()).collect();
        if let Some(first) = contents.first_mut() {
            first.0 = Shape::Plane(Plane { point: DVec3::NEG_Y * 12.0, normal: DVec3::Y });
        }
        let (mut geometry, mut bvh) = (of_contents(&contents), Bvh::default());
        let mut digests = Digests::default();
        for round in 0..60 {
            geometry.forget_old_changes();
            for (slot, content) in contents.iter_mut().enumerate() {
                if round % 20 == 19 || random.unit() < 3.0 / count as f64 {
                    edit(content, &mut random);
                    set(&mut geometry, slot, content);
                }
            }
            let fresh = of_contents(&contents);
            assert!(geometry == fresh);
            assert!(geometry.materials().eq(fresh.materials()));
            // Readers may miss rounds.
            if random.unit() < 0.2 {
                continue;
            }
            digests.update(&geometry, &shading, false);
            let mut anew = Digests::default();
            anew.update(&fresh, &shading, true);
            assert_eq!(digests.primitives(), anew.primitives());
            match bvh.update(&geometry) {
                BvhUpdate::None => {}
                BvhUpdate::Refit => refits += 1,
                BvhUpdate::Build => builds += 1,
            }
            let expected = Bvh::build(&fresh);
            assert_eq!(bvh.reach(), expected.reach());
            for _ in 0..20 {
                let ray = TraversalRay::new(random_ray(&mut random));
                assert_eq!(
                    bvh.intersect_one(&geometry, &ray),
                    expected.intersect_one(&fresh, &ray),
                    "{ray:?}"
                );
                assert_eq!(bvh.intersect_one(&geometry, &ray), brute_force(&geometry, &ray), "{ray:?}");
                let eight = Eight::new(&mut random);
                for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                    let hits = dispatch(Intersect(&bvh, &geometry, &eight, coherence));
                    assert_eq!(hits, dispatch(Intersect(&expected, &fresh, &eight, coherence)), "{eight:?}");
                }
            }
        }
    }
    assert!(builds > 20 && refits > 100, "{builds} builds, {refits} refits");
}

/// Moves spheres in steps, and returns whether each step built the tree, and the largest ratio of the tree's cost to
/// that of a tree that is built for the step.
fn steps(steps: u32, count: u32, place: impl Fn(u32, u32) -> DVec3) -> (Vec<bool>, f64) {
    let sphere = Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 0.1 });
    let finish = Finish::Material(MaterialBinding::One(0));
    let (mut geometry, mut bvh, mut worst) = (Geometry::with_slots(count as usize), Bvh::default(), 0.0f64);
    let step = |step| {
        geometry.forget_old_changes();
        for k in 0..count {
            let at = DAffine3::from_translation(place(step, k));
            geometry.set(k as usize, Some((&sphere, at, finish)));
        }
        let built = bvh.update(&geometry) == BvhUpdate::Build;
        worst = worst.max(bvh.cost() / Bvh::build(&geometry).cost());
        built
    };
    ((0..steps).map(step).collect(), worst)
}

/// The number of builds after the first.
fn rebuilds(built: &[bool]) -> usize {
    assert!(built[0], "{built:?}");
    built[1..].iter().filter(|built| **built).count()
}

/// Objects that swap their places make a tree of wide boxes, so it is built again, but not at every step before.
#[test]
fn a_tree_that_gets_worse_is_built_again() {
    let at = |k: u32| DVec3::new(f64::from(k % 20), f64::from(k / 20), 0.0);
    let (built, worst) = steps(101, 400, |step, k| at(k).lerp(at(399 - k), f64::from(step) / 100.0));
    assert!((2..50).contains(&rebuilds(&built)) && worst < 2.0, "{worst} {built:?}");
}

/// Objects that start in a few places and fly apart leave their boxes wide: with room to fly in, and within a scene
/// whose extent does not change.
#[test]
fn a_tree_whose_objects_fly_apart_is_built_again() {
    for fixed in [false, true] {
        for places in [1, 8] {
            let mut random = Random(9);
            let starts: Vec<DVec3> = (0..places).map(|_| random.point(20.0)).collect();
            let ways: Vec<[DVec3; 2]> = (0..400).map(|k| [starts[k % places], random.point(20.0)]).collect();
            let (built, worst) = steps(100, 400, |step, k| match (fixed, k) {
                (true, 0) => DVec3::splat(-20.0),
                (true, 1) => DVec3::splat(20.0),
                _ => ways[k as usize][0].lerp(ways[k as usize][1], f64::from(step) / 99.0),
            });
            let rebuilds = rebuilds(&built);
            assert!((2..50).contains(&rebuilds) && worst < 2.0, "{fixed} {places}: {worst} {built:?}");
        }
    }
}

/// Objects that move without end let the tree be built again now and then; a single one does not.
#[test]
fn a_tree_does_not_grow_old() {
    let at = |k: u32| DVec3::new(f64::from(k % 20), f64::from(k / 20), 0.0);
    let sway = |step: u32| DVec3::Z * f64::from(step % 2) * 0.1;
    let (built, _) = steps(101, 400, |step, k| at(k) + sway(step));
    assert_eq!(rebuilds(&built), 5, "{built:?}");
    let (built, _) = steps(101, 400, |step, k| if k == 7 { at(k) + sway(step) } else { at(k) });
    assert_eq!(rebuilds(&built), 0, "{built:?}");
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
        assert_eq!(bvh.intersect_one(&geometry, &ray).map(|hit| hit.primitive), Some(0));
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
        assert_eq!(bvh.intersect_one(&geometry, &ray), brute_force(&geometry, &ray));
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
        assert_eq!(bvh.intersect_one(&geometry, &ray), brute_force(&geometry, &ray));
    }
    for _ in 0..50 {
        let ray = |_| Ray {
            origin: random.point(1.0) * libm::exp2(200.0 * random.unit() - 100.0),
            direction: random.point(1.0),
        };
        let rays = [0; 8].map(ray);
        let eight = Eight { rays, wanted: 0xff, min: [0.0; 8], max: [f64::INFINITY; 8] };
        let hits = dispatch(Intersect(&bvh, &geometry, &eight, Coherence::Incoherent));
        for (lane, ray, _) in eight.each() {
            assert_eq!(hits[lane], brute_force(&geometry, &ray));
        }
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
    for count in [0, 1, 3, 11, 12, 60, 200, 1000] {
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
                let expected = bvh.intersect_within(geometry, &ray, within);
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

/// Objects that take turns being visible are tested without the tree.
#[test]
fn a_tree_is_kept_while_objects_take_turns() {
    let mut contents: Vec<Content> = (0..400)
        .map(|k| (sphere_at(f64::from(k % 20), f64::from(k / 20)), DAffine3::IDENTITY, k >= 20))
        .collect();
    let (mut geometry, mut bvh) = (of_contents(&contents), Bvh::default());
    let mut updates = Vec::new();
    for round in 0..60 {
        for (slot, content) in contents.iter_mut().enumerate().take(20) {
            content.2 = slot == round % 20;
            set(&mut geometry, slot, content);
        }
        updates.push(bvh.update(&geometry));
        let ray = TraversalRay::new(Ray {
            origin: DVec3::new((round % 20) as f64, 0.0, 9.0),
            direction: DVec3::NEG_Z,
        });
        assert_eq!(bvh.intersect_one(&geometry, &ray).map(|hit| hit.primitive), Some(round as u32 % 20));
    }
    let builds = updates.iter().filter(|update| **update == BvhUpdate::Build).count();
    assert_eq!(builds, 1, "{updates:?}");
    // Many at once get leaves.
    contents.iter_mut().enumerate().for_each(|(slot, content)| {
        content.2 = true;
        set(&mut geometry, slot, content);
    });
    assert_eq!(bvh.update(&geometry), BvhUpdate::Build);
}

fn sphere_at(x: f64, y: f64) -> Shape {
    Shape::Sphere(Sphere { center: DVec3::new(x, y, 0.0), radius: 0.1 })
}

/// A sphere that sways across a power of two, the size of the tree's space.
#[test]
fn a_tree_is_kept_while_the_extent_sways() {
    let at = |k: u32| DVec3::new(f64::from(k % 20), f64::from(k / 20), 0.0);
    let (built, _) = steps(40, 400, |step, k| match k {
        7 => DVec3::X * if step % 2 == 0 { 62.0 } else { 66.0 },
        _ => at(k),
    });
    assert_eq!(rebuilds(&built), 1, "{built:?}");
}
