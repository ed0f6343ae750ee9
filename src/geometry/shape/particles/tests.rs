//! Particles find what every sphere finds.

use super::{ParticleTracks, Particles};
use crate::base::lanes::tests::on_all_levels;
use crate::base::lanes::{Level, Mask, Row, SimdKernel, dispatch};
use crate::base::math::{DVec3, Ray};
use crate::base::time::Time;
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::part_search::every_part;
use crate::geometry::shape::{
    Geometric, LaneHit, OneRay, PreparedRay, RayInterval, ShapeHit, Sphere, Surface,
};
use crate::testing::{Random, eight_rays};
use std::sync::Arc;

/// Spheres that overlap, some of them equal.
fn random(random: &mut Random, count: usize) -> Vec<Sphere> {
    let mut spheres: Vec<Sphere> = (0..count)
        .map(|_| Sphere { center: random.point(1.0), radius: 0.01 + 0.2 * random.unit() })
        .collect();
    spheres.extend_from_within(..count / 8);
    spheres
}

#[test]
fn the_tree_finds_what_every_sphere_finds() {
    let mut random_numbers = Random(17);
    for count in [0, 1, 7, 8, 9, 300] {
        let mut spheres = random(&mut random_numbers, count);
        let still = Particles::still(spheres.clone());
        assert_finds_every(&still, &spheres, &mut random_numbers);

        // A swarm that flies away, and the tree that goes with it.
        spheres.iter_mut().for_each(|sphere| sphere.center += 0.02 * random_numbers.point(1.0) + DVec3::X);
        let tracks = Arc::new(ParticleTracks::still(spheres.clone()));
        let moved = tracks.at(Time::from_integer(0)).with_tree(Some(&*still.0));
        assert_eq!(moved.tree().refits(), 1, "{count}");
        assert_finds_every(&Particles(Arc::new(moved)), &spheres, &mut random_numbers);

        // After a leap of each sphere, that tree would be bad.
        let leapt = random(&mut random_numbers, count);
        let tracks = Arc::new(ParticleTracks::still(leapt.clone()));
        let moved = tracks.at(Time::from_integer(0)).with_tree(Some(&*still.0));
        assert!(count < 300 || moved.tree().refits() == 0);
        assert_finds_every(&Particles(Arc::new(moved)), &leapt, &mut random_numbers);
    }
}

/// Rays find the nearest of all spheres.
fn assert_finds_every(all: &Particles, spheres: &[Sphere], random_numbers: &mut Random) {
    let (mut hits, middle) = (0, spheres.first().map_or(DVec3::ZERO, |sphere| sphere.center));
    for _ in 0..1000 {
        let origin = middle + random_numbers.point(2.0);
        let direction = middle + random_numbers.point(1.0) - origin;
        let ray = TraversalRay::new(Ray { origin, direction });
        let each = (0..).zip(spheres).filter_map(|(part, sphere)| {
            Some(ShapeHit::of_part(sphere.intersect_up_to(&ray, f64::INFINITY)?.t, part))
        });
        let nearest = each.min_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
        let found = || (all.intersect_up_to(&ray, f64::INFINITY), all.occludes_up_to(&ray, f64::INFINITY));
        for (level, (hit, blocked)) in on_all_levels(found) {
            let hit = hit.map(|hit| ShapeHit { coincident: false, ..hit });
            assert_eq!((hit, blocked), (nearest, nearest.is_some()), "{level:?}");
        }
        let Some(at) = nearest else { continue };
        hits += 1;
        assert_eq!(all.intersect_up_to(&ray, at.t), None, "nothing lies before the nearest");
        let (surface, own) =
            (all.surface_at(&ray.ray, at), spheres[at.part as usize].surface_at(&ray.ray, at));
        assert_eq!(surface, own);
        assert_eq!(all.uv_at(surface.point, at.part), spheres[at.part as usize].uv_at(surface.point, 0));
    }
    assert!(spheres.len() < 7 || hits > 20, "{hits} of {}", spheres.len());
}

#[test]
fn every_hit_is_passed_once() {
    let mut random_numbers = Random(5);
    let spheres = random(&mut random_numbers, 60);
    let all = Particles::still(spheres.clone());
    for _ in 0..500 {
        let origin = random_numbers.point(1.5);
        let ray = TraversalRay::new(Ray { origin, direction: random_numbers.point(1.0) - origin });
        let mut found = Vec::new();
        let mut take = |at: ShapeHit| found.push((at.part, at.t.to_bits()));
        every_part(&all, &ray, RayInterval::up_to(f64::INFINITY), &mut take);
        let mut expected = Vec::new();
        for (part, sphere) in (0..).zip(&spheres) {
            let mut within = RayInterval::up_to(f64::INFINITY);
            while let Some(at) = sphere.intersect_one(&ray, within) {
                expected.push((part, at.t.to_bits()));
                within.min = at.t;
            }
        }
        found.sort_unstable();
        assert_eq!(found, expected);
    }
}

/// Hits and surfaces of eight rays.
struct Eight<'a>(&'a Particles, &'a [Ray; 8]);

impl SimdKernel for Eight<'_> {
    type Output = ([Option<ShapeHit>; 8], u32, [Surface; 8]);

    #[inline(always)]
    fn run<L: Level>(self) -> Self::Output {
        let Self(shape, rays) = self;
        let ray = PreparedRay::new(eight_rays::<L>(rays));
        let within = RayInterval::up_to(L::F64::splat(f64::INFINITY));
        let at: LaneHit<L::F64> = shape.intersect(&ray, within);
        let blocked = shape.occludes(&ray, within).bits();
        (std::array::from_fn(|lane| at.lane(lane)), blocked, shape.surface(&ray.ray, at, 0.0).store())
    }
}

#[test]
fn eight_rays_find_what_each_finds() {
    let mut random_numbers = Random(29);
    let all = Particles::still(random(&mut random_numbers, 200));
    for _ in 0..200 {
        let rays: [Ray; 8] = std::array::from_fn(|_| {
            let origin = random_numbers.point(2.0);
            Ray { origin, direction: random_numbers.point(0.5) - origin }
        });
        let each = rays.map(|ray| all.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY));
        for (level, (hits, blocked, surfaces)) in on_all_levels(|| dispatch(Eight(&all, &rays))) {
            assert_eq!(hits, each, "{level:?}");
            for lane in 0..8 {
                assert_eq!(blocked >> lane & 1 == 1, each[lane].is_some());
                if let Some(at) = each[lane] {
                    assert_eq!(surfaces[lane], all.surface_at(&rays[lane], at), "{level:?}");
                }
            }
        }
    }
}

#[test]
fn bounds_and_supports_are_those_of_the_spheres() {
    let spheres =
        vec![Sphere { center: DVec3::X, radius: 0.5 }, Sphere { center: DVec3::NEG_Y * 3.0, radius: 1.0 }];
    let all = Particles::still(spheres);
    assert_eq!([DVec3::X, DVec3::NEG_Y].map(|direction| all.support(direction)), [Some(1.5), Some(4.0)]);
    let bounds = all.bounds().expect("bounds");
    assert!((bounds.max.x - 1.5).abs() < 1e-12 && (bounds.min.y + 4.0).abs() < 1e-12);
    assert_eq!(Particles::still(Vec::new()).bounds(), None);
}
