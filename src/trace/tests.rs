//! No lit point shadows itself, at any size and at any distance from the origin, and no ray starts far from its surface
//! (SELF-01 of the hard cases, and the same for every other shape).

use super::light::{LightSample, ShadowRay};
use super::spawn::spawn_ray;
use crate::appearance::material::MaterialBinding;
use crate::base::math::{Angle, DAffine3, DMat3, DVec3, Ray, UNIT_ROUNDOFF, euler_xyz};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{
    Cone, Cuboid, Cylinder, Disk, Plane, Rectangle, Shape, Sphere, Surface, Triangle,
};
use crate::scene::{Finish, Primitive};
use crate::testing::Random;

/// Points per configuration.
const POINTS: u32 = if cfg!(debug_assertions) { 3_000 } else { 100_000 };
/// The least cosine of lights above the horizon.
const GRAZING: f64 = 0.001;
const SIZES: [f64; 4] = [1e-3, 1.0, 1e3, 1e6];
const OFFSETS: [f64; 5] = [0.0, 10.0, 1e3, 1e4, 1e6];
/// A unit vector.
const AWAY: DVec3 = DVec3::new(0.6, 0.64, 0.48);

/// A uniform direction above the horizon of `normal`.
fn above(random: &mut Random, normal: DVec3) -> DVec3 {
    loop {
        let direction = random.direction();
        if direction.dot(normal) > GRAZING {
            return direction;
        }
    }
}

/// The hit of a ray on `primitive` as the integrator sees it: the normal faces the eye.
fn seen(primitive: &Primitive, ray: Ray) -> Option<Surface> {
    let t = primitive.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY)?;
    let mut surface = primitive.surface_at(&ray, t);
    if surface.normal.dot(ray.direction) > 0.0 {
        surface.normal = -surface.normal;
    }
    Some(surface)
}

/// The shadow ray to a light at a point, which it reaches at t = 1.
fn spawn_to(surface: &Surface, target: DVec3) -> Ray {
    let light = LightSample::<f64> { end: target.into(), ..LightSample::none() };
    let ShadowRay { ray, t_max } = light.shadow_ray(&surface.into());
    assert_eq!(t_max, 1.0);
    Ray { origin: ray.origin.into(), direction: ray.direction.into() }
}

/// A primitive under test, its size, and the map of target points, whose coordinates are in -0.5..0.5.
struct Target {
    primitive: Primitive,
    size: f64,
    aim: DAffine3,
}

impl Target {
    /// Visible points of the primitive, each seen from a random eye at three times its size, with a direction to a
    /// light.
    fn points(&self, seed: u64) -> impl Iterator<Item = (Surface, DVec3)> + '_ {
        let mut random = Random(seed);
        let mut point = move || {
            let middle = self.aim.translation;
            let origin = middle + random.direction() * (3.0 * self.size);
            let aim = DVec3::new(random.unit() - 0.5, 0.0, random.unit() - 0.5);
            let direction = (self.aim.transform_point3(aim) - origin).normalize();
            let surface = seen(&self.primitive, Ray { origin, direction })?;
            Some((surface, above(&mut random, surface.normal)))
        };
        std::iter::from_fn(move || Some(point())).flatten().take(POINTS as usize)
    }

    /// The number of points at which a convex or flat primitive shadows itself, from lights at infinity and at the
    /// distance `size`.
    fn false_shadows(&self) -> usize {
        let shadowed = |(surface, direction): &(Surface, DVec3)| {
            let far = TraversalRay::new(spawn_ray(surface, *direction));
            let near = TraversalRay::new(spawn_to(surface, surface.point + *direction * self.size));
            self.primitive.intersect_up_to(&far, f64::INFINITY).is_some()
                || self.primitive.intersect_up_to(&near, 1.0).is_some()
        };
        self.points(7).filter(shadowed).count()
    }
}

fn primitive(shape: Shape, to_world: DAffine3) -> Primitive {
    Primitive::new(&shape, to_world, Finish::Material(MaterialBinding::One(0))).expect("a primitive")
}

/// Turned by 30 and 40 degrees and moved, for shapes with a transform.
fn tilted(size: DVec3, middle: DVec3) -> DAffine3 {
    let turn = euler_xyz(Angle(30.0), Angle(40.0), Angle(0.0));
    DAffine3::from_mat3_translation(turn * DMat3::from_diagonal(size), middle)
}

/// Every size at every offset.
fn each_place() -> impl Iterator<Item = (f64, DVec3)> {
    SIZES.into_iter().flat_map(|size| OFFSETS.map(|offset| (size, AWAY * offset)))
}

/// A sphere. Rays aim at points inside a square that is 1.8 radii wide.
fn sphere(radius: f64, center: DVec3) -> Target {
    let shape = Shape::Sphere(Sphere { center, radius });
    let aim = DAffine3::from_mat3_translation(DMat3::from_diagonal(DVec3::splat(1.8 * radius)), center);
    Target { primitive: primitive(shape.clone(), DAffine3::IDENTITY), size: radius, aim }
}

#[test]
fn self_01_lit_spheres_do_not_shadow_themselves() {
    for (radius, center) in each_place() {
        assert_eq!(sphere(radius, center).false_shadows(), 0, "radius {radius} at {center}");
    }
}

#[test]
fn self_01_rays_leave_spheres_from_close_by() {
    for (radius, center) in each_place() {
        let limit = 32.0 * UNIT_ROUNDOFF * (center.length() + radius);
        for (surface, direction) in sphere(radius, center).points(8) {
            let origin = spawn_ray(&surface, direction).origin;
            let moved = (origin - surface.point).length();
            // Reference: the distance of the origin from the sphere itself. Both coordinates are given exactly, so only
            // the difference and its length are rounded, relative to the radius.
            let off = (origin - center).length() - radius;
            let rounding = 4.0 * UNIT_ROUNDOFF * radius;
            let close = moved <= limit && off <= limit + rounding;
            assert!(close, "radius {radius} at {center}: {moved:e}, {off:e}");
            assert!(off >= -rounding, "radius {radius} at {center}: below the surface by {off:e}");
        }
    }
}

/// From inside, the far side is one chord away: 2 r cos. An origin that is moved inwards lengthens it.
#[test]
fn self_01_spheres_lit_from_inside_end_at_their_far_side() {
    for (radius, center) in each_place() {
        let sphere = sphere(radius, center).primitive;
        let mut random = Random(9);
        for _ in 0..POINTS {
            let origin = center + random.direction() * (0.9 * radius);
            let surface = seen(&sphere, Ray { origin, direction: random.direction() });
            let surface = surface.expect("a ray from inside hits");
            let direction = above(&mut random, surface.normal);
            let cosine = surface.normal.dot(direction);
            let chord = 2.0 * radius * cosine;
            let longest = chord + 64.0 * UNIT_ROUNDOFF * (center.length() + radius) / cosine;
            let t = sphere.intersect_up_to(&TraversalRay::new(spawn_ray(&surface, direction)), f64::INFINITY);
            let far_side = t.is_some_and(|at| at.t >= 0.999 * chord && at.t <= longest);
            assert!(far_side, "radius {radius} at {center}: {t:?} instead of {chord}");
        }
    }
}

#[test]
fn self_01_lit_ellipsoids_do_not_shadow_themselves() {
    let unit = Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 });
    for (size, middle) in each_place() {
        let aim = tilted(DVec3::new(3.0, 1.0, 0.5) * size, middle);
        let ellipsoid = Target { primitive: primitive(unit.clone(), aim), size: 3.0 * size, aim };
        assert!(ellipsoid.primitive.transform.is_some(), "an ellipsoid is no sphere");
        assert_eq!(ellipsoid.false_shadows(), 0, "size {size} at {middle}");
    }
}

/// A flat or convex shape of each size at each place, turned and not.
fn flat_shapes_do_not_shadow_themselves(shape: Shape) {
    let mut wrong = Vec::new();
    for (size, middle) in each_place() {
        let straight = DAffine3::from_mat3_translation(DMat3::from_diagonal(DVec3::splat(size)), middle);
        for aim in [straight, tilted(DVec3::splat(size), middle)] {
            let target = Target { primitive: primitive(shape.clone(), aim), size, aim };
            let count = target.false_shadows();
            if count > 0 {
                wrong.push(format!("{count} of {POINTS}: {:?}", target.primitive));
            }
        }
    }
    assert!(wrong.is_empty(), "false shadows\n{}", wrong.join("\n"));
}

const CORNER: DVec3 = DVec3::new(-0.5, 0.0, -0.5);

#[test]
fn self_01_lit_planes_do_not_shadow_themselves() {
    flat_shapes_do_not_shadow_themselves(Shape::Plane(Plane { point: CORNER, normal: DVec3::Y }));
}

#[test]
fn self_01_lit_rectangles_do_not_shadow_themselves() {
    let rectangle = Rectangle { corner: CORNER, u: DVec3::new(1.0, 0.0, 0.1), v: DVec3::Z };
    flat_shapes_do_not_shadow_themselves(Shape::Rectangle(rectangle));
}

#[test]
fn self_01_lit_disks_do_not_shadow_themselves() {
    let disk = Disk { center: DVec3::ZERO, normal: DVec3::Y, radius: 0.5 };
    flat_shapes_do_not_shadow_themselves(Shape::Disk(disk));
}

#[test]
fn self_01_lit_triangles_do_not_shadow_themselves() {
    let corners = [CORNER, DVec3::new(0.5, 0.0, -0.3), DVec3::new(0.1, 0.0, 0.5)];
    flat_shapes_do_not_shadow_themselves(Shape::Triangle(Triangle { corners }));
}

#[test]
fn self_01_lit_boxes_do_not_shadow_themselves() {
    let cuboid = Cuboid { min: DVec3::splat(-0.5), max: DVec3::splat(0.5) };
    flat_shapes_do_not_shadow_themselves(Shape::Cuboid(cuboid));
}

#[test]
fn self_01_lit_cylinders_do_not_shadow_themselves() {
    let (from, to) = (DVec3::new(0.0, -0.4, 0.1), DVec3::new(0.2, 0.5, 0.0));
    let cylinder = Cylinder::new(from, to, 0.4, true).expect("a cylinder");
    flat_shapes_do_not_shadow_themselves(Shape::Cylinder(cylinder));
    let upright = Cylinder::new(DVec3::Y * -0.5, DVec3::Y * 0.5, 0.5, true).expect("a cylinder");
    flat_shapes_do_not_shadow_themselves(Shape::Cylinder(upright));
}

#[test]
fn self_01_lit_cones_do_not_shadow_themselves() {
    for (base, top) in [(0.6, 0.0), (0.5, 0.2), (0.1, 0.6), (0.5, 0.5)] {
        let cone = Cone::new(DVec3::Y * -0.3, DVec3::Y * 0.7, base, top, true).expect("a cone");
        flat_shapes_do_not_shadow_themselves(Shape::Cone(cone));
    }
}

/// Flat shapes through the origin along the axes, whose coordinates there are exact zeros. Only the normal, which may
/// not be a unit vector to the last bit, shows how far rounding has moved a point off them.
#[test]
fn self_01_floors_at_height_zero_do_not_shadow_themselves() {
    let mut wrong = Vec::new();
    for (a, b) in [3.0, 7.0, 10.0].into_iter().flat_map(|a| [3.0, 7.0, 10.0].map(|b| (a, b))) {
        let (u, v) = (DVec3::X * a, DVec3::new(1.0, 0.0, b));
        let middle = (u + v) * 0.5;
        let aim = DAffine3::from_mat3_translation(DMat3::from_cols(u, DVec3::Y, v), middle);
        for shape in [
            Shape::Rectangle(Rectangle { corner: DVec3::ZERO, u, v }),
            Shape::Triangle(Triangle { corners: [DVec3::ZERO, u, u + v] }),
        ] {
            let primitive = primitive(shape.clone(), DAffine3::IDENTITY);
            let count = Target { primitive, size: a.max(b), aim }.false_shadows();
            if count > 0 {
                wrong.push(format!("{count} of {POINTS}: {shape:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "false shadows\n{}", wrong.join("\n"));
}
