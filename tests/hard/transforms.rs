//! Placed shapes. XF-01 of meshes and ellipsoids stands with those, XF-02's depth and the inverse of XF-04 in
//! `src/scene/primitive.rs`.

use crate::support::{Random, U, direction, few, geometry, hit, met, placed, shoot_all};
use kinora::appearance::material::MaterialBinding;
use kinora::base::math::{Angle, DAffine3, DMat3, DVec3, Ray, axis_angle};
use kinora::geometry::bvh::TraversalRay;
use kinora::geometry::shape::{Cone, Cylinder, Plane, Shape, Sphere};
use kinora::scene::top_level::Bvh;
use kinora::scene::{Finish, Geometry};
use kinora::sequence::parse;

/// Normals go by the inverse transpose: M n is off by 37 and 79 degrees.
#[test]
fn xf_01_normals_under_uneven_scales_and_shears() {
    let s = 0.5f64.sqrt();
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Z);
    let scale = |x, y, z| DMat3::from_diagonal(DVec3::new(x, y, z));
    for (map, normal, expected) in [
        (scale(2.0, 1.0, 1.0), DVec3::new(s, s, 0.0), DVec3::new(1.0, 2.0, 0.0) / 5f64.sqrt()),
        (scale(1.0, 1.0, 0.1), DVec3::new(0.0, s, s), DVec3::new(0.0, 0.1, 1.0) / 1.01f64.sqrt()),
        (shear, DVec3::Y, DVec3::Y),
        (shear, DVec3::X, DVec3::new(s, -s, 0.0)),
        (scale(-2.0, 1.0, 1.0), DVec3::new(s, s, 0.0), DVec3::new(-1.0, 2.0, 0.0) / 5f64.sqrt()),
        (scale(2e30, 1e30, 1e30), DVec3::new(s, s, 0.0), DVec3::new(1.0, 2.0, 0.0) / 5f64.sqrt()),
        (scale(2e-30, 1e-30, 1e-30), DVec3::new(s, s, 0.0), DVec3::new(1.0, 2.0, 0.0) / 5f64.sqrt()),
    ] {
        let (plane, map) = (Plane { point: DVec3::ZERO, normal }, DAffine3::from_mat3(map));
        let moved = kinora::geometry::shape::Geometric::transformed(&plane, &map).expect("a plane").normal;
        assert!((moved - expected).abs().max_element() <= 4.0 * U, "{map}: {moved} instead of {expected}");
    }
}

/// An ellipsoid before and behind a plain sphere: t is in the world's units, whatever the scale. Normalised in the
/// shape's space, it is off by the factor 3.
#[test]
fn xf_02_ellipsoids_stand_in_their_order() {
    let unit = Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 });
    let ellipsoid = DAffine3::from_scale(DVec3::new(3.0, 1.0, 0.5));
    let t = hit(&placed(&unit, ellipsoid), DVec3::new(10.0, 0.2, 0.1), DVec3::NEG_X).expect("a hit").t;
    assert!((t - 7.122_501_086_012_368).abs() <= 8.0 * U * t, "{t}");
    // A small sphere whose front is a little before it, and a little behind.
    for (off, first) in [(1e-12, 1), (-1e-12, 0)] {
        let radius = 0.25;
        let center = DVec3::new(10.0 - t + off - radius, 0.2, 0.1);
        let mut geometry = Geometry::default();
        geometry.push(&unit, ellipsoid, Finish::Material(MaterialBinding::One(0)));
        geometry.push(
            &Shape::Sphere(Sphere { center, radius }),
            DAffine3::IDENTITY,
            Finish::Material(MaterialBinding::One(0)),
        );
        let probe = TraversalRay::new(Ray { origin: DVec3::new(10.0, 0.2, 0.1), direction: DVec3::NEG_X });
        let hit = Bvh::build(&geometry).intersect_one(&geometry, &probe).expect("a hit");
        assert_eq!(hit.primitive, first, "{off:e}");
    }
}

fn refused(objects: &str) -> String {
    match parse("scene.ron", &format!("(\n    objects: {{\n        {objects}\n    }},\n)")) {
        Ok(_) => panic!("{objects} is accepted"),
        Err(faults) => faults.to_string(),
    }
}

/// Singular and overflowing transforms are told with their place, not hidden: no panic, no silent miss.
#[test]
fn xf_04_transforms_without_an_inverse_are_refused() {
    for (objects, expected) in [
        ("\"flat\": (shape: Sphere(), scale: (1, 0, 1)),", "a constant scale of 0"),
        ("\"none\": (shape: Sphere(), scale: (1, NaN, 1)),", "expected a finite number"),
        ("\"none\": (shape: Sphere(), scale: inf),", "expected a factor"),
        (
            "\"a\": (shape: Group, scale: 1e30), \"huge\": (shape: Sphere(), scale: 1e30, parent: \"a\"),",
            "object `huge` is scaled beyond 1e30",
        ),
        (
            "\"a\": (shape: Group, scale: 1e-30), \"tiny\": (shape: Sphere(), scale: 1e-30, parent: \"a\"),",
            "object `tiny` is scaled below 1e-30",
        ),
        (
            "\"a\": (shape: Group, scale: 1e30), \"far\": (shape: Sphere(), translation: (9, 0, 0), parent: \"a\"),",
            "object `far` is moved beyond 1e30",
        ),
    ] {
        let told = refused(objects);
        assert!(told.contains(expected) && told.contains("scene.ron:3:"), "{told}");
    }
    // Twenty scales whose product overflows, where the object itself has none: its own line is told.
    let chain: String = (0..20)
        .map(|k| {
            format!(
                "\"{k}\": (shape: Group, scale: 1e20{}),",
                if k == 0 { String::new() } else { format!(", parent: \"{}\"", k - 1) }
            )
        })
        .collect();
    let told = refused(&format!("{chain} \"ball\": (shape: Sphere(), parent: \"19\")"));
    assert!(told.contains("object `1` is scaled beyond 1e30") && !told.contains("ball` is"), "{told}");
    // Large and small ones that make up for each other are fine.
    let text = "(output: (size: (8, 8)), ambient: 1, default_material: (ambient: 1, color: 1), objects: {
        \"a\": (shape: Group, scale: 1e25), \"b\": (shape: Sphere(), scale: 1e-25, parent: \"a\") })";
    assert_eq!(shoot_all(text)[0].pixel(4, 4).x, 1.0);
}

/// Cylinders and cones far from the origin, scaled unevenly, met at their rims: the rounding of the way to the world
/// and back is larger than what keeps points of an upright one clear of its rims.
fn far_uneven_rims(rays: u32) {
    let mut random = Random(4);
    let cylinder = Shape::Cylinder(Cylinder::new(DVec3::NEG_Y, DVec3::Y, 1.0, true).expect("a cylinder"));
    let cone = Shape::Cone(Cone::new(DVec3::NEG_Y, DVec3::Y, 1.0, 0.0, true).expect("a cone"));
    let frustum = Shape::Cone(Cone::new(DVec3::NEG_Y, DVec3::Y, 1.0, 0.4, true).expect("a cone"));
    let cuboid = Shape::Cuboid(kinora::geometry::shape::Cuboid { min: DVec3::splat(-1.0), max: DVec3::ONE });
    for (shape, top) in [(&cylinder, 1.0), (&cone, 0.0), (&frustum, 0.4), (&cuboid, 1.0)] {
        for away in [0.0, 1e3, 1e6, 1e9] {
            let mut odd = 0;
            for _ in 0..rays / 100 {
                let axis = direction(&mut random);
                let uneven = DVec3::new(1.0, 0.1 + 3.0 * random.unit(), 0.1 + 3.0 * random.unit());
                let to_world = DAffine3::from_mat3_translation(
                    axis_angle(axis, Angle(360.0 * random.unit())) * DMat3::from_diagonal(uneven),
                    DVec3::new(0.6, 0.64, 0.48) * away,
                );
                let primitive = placed(shape, to_world);
                for k in 0..100 {
                    let turn = Angle(360.0 * random.unit()).cos_sin();
                    let (y, radius) = if k % 2 == 0 { (1.0, top) } else { (-1.0, 1.0) };
                    let aim = if matches!(shape, Shape::Cuboid(_)) {
                        DVec3::new(1.0, 2.0 * random.unit() - 1.0, y)
                    } else {
                        DVec3::new(turn.x * radius, y, turn.y * radius)
                    };
                    let origin = direction(&mut random) * 5.0;
                    let [origin, aim] = [origin, aim].map(|p| to_world.transform_point3(p));
                    odd += crossings(&primitive, origin, aim - origin) % 2;
                }
            }
            assert_eq!(odd, 0, "odd crossings {away} away of {shape:?}");
        }
    }
}

/// How many surfaces a ray passes, each found by the ray that the one before sends on; 9 at most.
fn crossings(primitive: &kinora::scene::Primitive, mut origin: DVec3, d: DVec3) -> u32 {
    let mut count = 0;
    while let Some((_, surface)) = met(primitive, origin, d) {
        origin = kinora::trace::spawn::spawn_ray(&surface, d).origin;
        count += 1;
        if count == 9 {
            break;
        }
    }
    count
}

#[test]
fn int_09_far_and_uneven_rims_are_crossed_evenly() {
    far_uneven_rims(few(200_000));
}

#[test]
#[ignore = "takes seconds: 2 million rays at rims; cargo test --release -- --ignored int_09"]
fn int_09_far_and_uneven_rims_are_crossed_evenly_in_full() {
    far_uneven_rims(2_000_000);
}

/// Boxes that rays meet exactly at an edge or a corner: lattice rays do, in pictures along the axes.
#[test]
fn int_09_boxes_are_crossed_evenly_at_edges() {
    let cuboid =
        Shape::Cuboid(kinora::geometry::shape::Cuboid { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) });
    let primitive = &geometry([cuboid]).primitives[0];
    let mut random = Random(6);
    let mut lattice = |reach: f64| (random.point(reach + 0.5)).round();
    let (mut met, mut odd) = (0, Vec::new());
    for _ in 0..few(1_000_000) {
        let (origin, aim) = (lattice(12.0), lattice(4.0));
        let outside = origin.abs().max_element() > 4.0;
        if outside && aim != origin {
            let count = crossings(primitive, origin, aim - origin);
            met += u32::from(count > 0);
            if count % 2 == 1 {
                odd.push((origin, aim));
            }
        }
    }
    assert!(odd.is_empty() && met > 100, "{} of {met}: {:?}", odd.len(), odd.first());
}
