//! Rays that start on surfaces: false shadows if they hit their own surface again, and gaps in which nearby surfaces
//! are skipped.

use super::input_rng::InputRng;
use super::measure::{Case, Verdict, Workload, method};
use super::number::{Float, Number, Vector3};
use super::spheres::{SphereRay, quadratic, recentred};
use crate::appearance::optics::refract;
use crate::base::math::exact::Exact;
use crate::base::math::{Angle, DVec3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{OneRay, Rectangle, ShapeHit, Sphere};
use crate::trace::spawn::spawn_ray;

/// The usual least t of secondary rays.
pub const LEAST: f64 = 1e-3;

/// A ray that hits a sphere, and a direction to a light above the hit.
#[derive(Clone, Copy)]
pub struct LitPoint<R> {
    pub aimed: SphereRay<R>,
    pub light: Vector3<R>,
}

/// The result of a shadow ray: whether its own surface blocks it, and the distance within which it misses other
/// surfaces.
pub struct ShadowTest {
    pub blocked: bool,
    pub gap: f64,
}

/// The textbook: the computed point, and roots above [`LEAST`].
pub fn textbook<R: Float>(at: &LitPoint<R>) -> Option<ShadowTest> {
    let SphereRay { center, radius, origin, direction, .. } = at.aimed;
    let t = quadratic(center, radius, origin, direction, R::of(LEAST))?;
    let point = origin + direction * t;
    let blocked = quadratic(center, radius, point, at.light, R::of(LEAST)).is_some();
    Some(ShadowTest { blocked, gap: LEAST })
}

/// The point is projected onto the sphere, moved along the normal by its error bound, and rounded away (Pharr, Jakob,
/// Humphreys, *Physically Based Rendering*, 6.8.6).
pub fn stable(at: &LitPoint<f32>) -> Option<ShadowTest> {
    let SphereRay { center, radius, origin, direction, .. } = at.aimed;
    let t = recentred(center, radius, origin, direction)?;
    let normal = (origin + direction * t - center).unit();
    let point = center + normal * radius;
    let roundoff = f32::ROUNDOFF as f32;
    let error = |i: usize| (2.0 * point.0[i].abs() + center.0[i].abs() + 6.0 * radius) * roundoff;
    let reach = (0..3).map(|i| normal.0[i].abs() * error(i)).sum::<f32>();
    let moved = point + normal * reach;
    let start = Vector3(std::array::from_fn(|i| moved.0[i].next_towards(normal.0[i])));
    let blocked = recentred(center, radius, start, at.light).is_some();
    Some(ShadowTest { blocked, gap: (start - point).length().wide() })
}

/// Kinora's own functions.
pub fn ours(at: &LitPoint<f64>) -> Option<ShadowTest> {
    let Sphere { .. } = at.aimed.sphere;
    let probe = &at.aimed.probe;
    let found = at.aimed.sphere.intersect_up_to(probe, f64::INFINITY)?;
    let surface = at.aimed.sphere.surface_at(&probe.ray, found);
    let ray = spawn_ray(&surface, at.light.wide());
    let blocked = at.aimed.sphere.occludes_up_to(&TraversalRay::new(ray), f64::INFINITY);
    Some(ShadowTest { blocked, gap: (ray.origin - surface.point).length() })
}

fn lit<R: Float>(radius: f64, away: f64, workload: Workload) -> Vec<LitPoint<R>> {
    let mut rng = InputRng::new(1);
    let center = DVec3::new(0.6, 0.64, 0.48) * away;
    let one = |_| {
        let normal = rng.direction();
        let mut above = || loop {
            let d = rng.direction();
            if d.dot(normal).abs() > 0.01 {
                return if d.dot(normal) < 0.0 { -d } else { d };
            }
        };
        let (eye, light) = (above(), above());
        let point = center + normal * radius;
        let aimed = SphereRay::new(center, radius, point + eye * (3.0 * radius), -eye);
        LitPoint { aimed, light: Vector3::of(light) }
    };
    (0..workload.inputs).map(one).collect()
}

fn shadow<R: Float>(at: &LitPoint<R>, found: Option<ShadowTest>) -> Verdict {
    // Rays that miss the sphere, because it is smaller than the rounding of its centre, are not counted here.
    let radius = at.aimed.radius.wide();
    found.map_or(Verdict::RIGHT, |shadow| Verdict { off: Some(shadow.gap / radius), wrong: shadow.blocked })
}

fn sphere(what: &'static str, radius: f64, away: f64, workload: Workload) -> Case {
    Case {
        id: "SELF-01",
        what,
        error: "gap in which nothing casts a shadow, in radii",
        wrong: "lit places that shadow themselves",
        methods: [
            method(lit::<f32>(radius, away, workload), textbook, shadow),
            method(lit::<f64>(radius, away, workload), textbook, shadow),
            method(lit::<f32>(radius, away, workload), stable, shadow),
            method(lit::<f64>(radius, away, workload), ours, shadow),
        ],
    }
}

/// A tilted square with a camera ray and a light.
#[derive(Clone, Copy)]
struct LitSquare<R> {
    corner: Vector3<R>,
    u: Vector3<R>,
    v: Vector3<R>,
    origin: Vector3<R>,
    direction: Vector3<R>,
    light: Vector3<R>,
    ours: Rectangle,
    probe: TraversalRay,
}

fn lit_squares<R: Float>(size: f64, workload: Workload) -> Vec<LitSquare<R>> {
    let mut rng = InputRng::new(2);
    let (a, b) = (Angle(30.0).cos_sin(), Angle(40.0).cos_sin());
    let (u, v) = (DVec3::new(a.x, a.y, 0.0), DVec3::new(-a.y * b.x, a.x * b.x, b.y));
    let normal = u.cross(v);
    let corner = Vector3::<R>::of((u + v) * (-0.5 * size));
    let (u, v) = (Vector3::<R>::of(u * size), Vector3::<R>::of(v * size));
    let ours = Rectangle { corner: corner.wide(), u: u.wide(), v: v.wide() };
    let one = |_| {
        let point = ours.corner + ours.u * rng.unit() + ours.v * rng.unit();
        let mut above = || (normal + rng.direction() * 0.95) * size;
        let (origin, light) = (Vector3::<R>::of(point + above()), Vector3::<R>::of(point + above()));
        let direction = Vector3::<R>::of((point - origin.wide()).normalize());
        let probe = TraversalRay::new(Ray { origin: origin.wide(), direction: direction.wide() });
        LitSquare { corner, u, v, origin, direction, light, ours, probe }
    };
    (0..workload.inputs).map(one).collect()
}

fn parallelogram<R: Float>(
    at: &LitSquare<R>,
    origin: Vector3<R>,
    direction: Vector3<R>,
    least: R,
) -> Option<R> {
    let normal = at.u.cross(at.v);
    let t = normal.dot(at.corner - origin) / normal.dot(direction);
    (t > least).then_some(t)
}

fn square_textbook<R: Float>(at: &LitSquare<R>) -> Option<ShadowTest> {
    let t = parallelogram(at, at.origin, at.direction, R::of(LEAST))?;
    let point = at.origin + at.direction * t;
    let to_light = (at.light - point).unit();
    let blocked = parallelogram(at, point, to_light, R::of(LEAST)).is_some();
    Some(ShadowTest { blocked, gap: LEAST })
}

fn square_stable(at: &LitSquare<f32>) -> Option<ShadowTest> {
    let t = parallelogram(at, at.origin, at.direction, 0.0)?;
    let normal = at.u.cross(at.v).unit();
    let near = at.origin + at.direction * t;
    let point = near + normal * normal.dot(at.corner - near);
    let roundoff = f32::ROUNDOFF as f32;
    let error = |i: usize| ((at.corner - point).0[i].abs() * 11.0 + point.0[i].abs() * 3.0) * roundoff;
    let reach = (0..3).map(|i| normal.0[i].abs() * error(i)).sum::<f32>();
    let moved = point + normal * reach;
    let start = Vector3(std::array::from_fn(|i| moved.0[i].next_towards(normal.0[i])));
    let blocked = parallelogram(at, start, at.light - start, 0.0).is_some_and(|t| t < 1.0);
    Some(ShadowTest { blocked, gap: (start - point).length().wide() })
}

fn square_ours(at: &LitSquare<f64>) -> Option<ShadowTest> {
    let found = at.ours.intersect_up_to(&at.probe, f64::INFINITY)?;
    let surface = at.ours.surface_at(&at.probe.ray, found);
    let ray = spawn_ray(&surface, at.light.wide() - surface.point);
    let ray = Ray { direction: at.light.wide() - ray.origin, ..ray };
    let blocked = at.ours.occludes_up_to(&TraversalRay::new(ray), 1.0);
    Some(ShadowTest { blocked, gap: (ray.origin - surface.point).length() })
}

fn square(what: &'static str, size: f64, workload: Workload) -> Case {
    let judge = move |found: Option<ShadowTest>| {
        found.map_or(Verdict::RIGHT, |shadow| Verdict { off: Some(shadow.gap / size), wrong: shadow.blocked })
    };
    Case {
        id: "SELF-01",
        what,
        error: "gap in which nothing casts a shadow, in sides",
        wrong: "lit places that shadow themselves",
        methods: [
            method(lit_squares::<f32>(size, workload), square_textbook, move |_, found| judge(found)),
            method(lit_squares::<f64>(size, workload), square_textbook, move |_, found| judge(found)),
            method(lit_squares::<f32>(size, workload), square_stable, move |_, found| judge(found)),
            method(lit_squares::<f64>(size, workload), square_ours, move |_, found| judge(found)),
        ],
    }
}

/// Snell's law for a unit direction and a unit normal on the incoming side; `ratio` is the index of refraction before
/// the boundary over that behind it.
fn refracted<R: Number>(direction: Vector3<R>, normal: Vector3<R>, ratio: R) -> Option<Vector3<R>> {
    let cosine = -direction.dot(normal);
    let square = R::one() - ratio * ratio * (R::one() - cosine * cosine);
    (square >= R::zero()).then(|| direction * ratio + normal * (ratio * cosine - square.sqrt()))
}

/// The direction of a ray after it has passed a glass ball.
fn through<R: Number>(
    center: Vector3<R>,
    radius: R,
    origin: Vector3<R>,
    direction: Vector3<R>,
    least: R,
) -> Option<Vector3<R>> {
    let entry = quadratic(center, radius, origin, direction, least)?;
    let point = origin + direction * entry;
    let normal = (point - center) * (R::one() / radius);
    let inside = refracted(direction, normal, R::one() / R::of(1.5))?;
    let exit = quadratic(center, radius, point, inside, least)?;
    let normal = (point + inside * exit - center) * (R::one() / radius);
    refracted(inside, normal * -R::one(), R::of(1.5))
}

fn glass_textbook<R: Float>(at: &SphereRay<R>) -> Option<Vector3<R>> {
    through(at.center, at.radius, at.origin, at.direction, R::of(LEAST))
}

/// The exit is the second root, so no least t can skip it.
fn glass_stable(at: &SphereRay<f32>) -> Option<Vector3<f32>> {
    let entry = recentred(at.center, at.radius, at.origin, at.direction)?;
    let normal = (at.origin + at.direction * entry - at.center).unit();
    let inside = refracted(at.direction, normal, 1.0 / 1.5)?;
    let exit = (normal - inside * (2.0 * inside.dot(normal))).unit();
    refracted(inside, exit * -1.0, 1.5)
}

fn glass_ours(at: &SphereRay<f64>) -> Option<Vector3<f64>> {
    let mut ray = at.probe.ray;
    for eta in [1.5, 1.0 / 1.5] {
        let probe = TraversalRay::new(ray);
        let found: ShapeHit = at.sphere.intersect_up_to(&probe, f64::INFINITY)?;
        let surface = at.sphere.surface_at(&ray, found);
        let facing = if eta > 1.0 { surface.normal } else { -surface.normal };
        let bent = refract::<f64>(ray.direction.into(), facing.into(), eta);
        if bent.is_total {
            return None;
        }
        ray = spawn_ray(&surface, bent.direction.into());
    }
    Some(Vector3::of(ray.direction))
}

fn glass<R: Float>(workload: Workload) -> Vec<SphereRay<R>> {
    let mut rng = InputRng::new(5);
    let one = |_| {
        let (axis, radius) = (rng.direction(), 4e-4);
        let height = rng.ring(axis, 0.0, 0.95) * radius;
        SphereRay::new(DVec3::ZERO, radius, height + axis * (5.0 * radius), -axis)
    };
    (0..workload.inputs).map(one).collect()
}

fn glass_judge<R: Float>(at: &SphereRay<R>, found: Option<Vector3<R>>) -> Verdict {
    // The direction has unit length only up to rounding; the true answer is that of the normalized direction.
    let direction = at.direction.to::<Exact>().unit();
    let radius = Exact::of(at.radius.wide());
    // The chord is longer than a hundredth of the radius, and the false root at the entry point is far smaller.
    let least = radius * Exact::of(0.01);
    let exact = through(at.center.to(), radius, at.origin.to(), direction, least);
    match (found, exact) {
        (Some(found), Some(exact)) => Verdict::off((found.to::<Exact>() - exact).length().value()),
        (found, exact) => Verdict::wrong_if(found.is_some() != exact.is_some()),
    }
}

fn small_glass(workload: Workload) -> Case {
    Case {
        id: "SELF-05",
        what: "glass ball of radius 0.0004: the direction behind it",
        error: "largest error of the direction",
        wrong: "second surface lost",
        methods: [
            method(glass::<f32>(workload), glass_textbook, glass_judge),
            method(glass::<f64>(workload), glass_textbook, glass_judge),
            method(glass::<f32>(workload), glass_stable, glass_judge),
            method(glass::<f64>(workload), glass_ours, glass_judge),
        ],
    }
}

pub fn cases(workload: Workload) -> Vec<Case> {
    vec![
        sphere("lit sphere of radius 0.001 at the origin", 1e-3, 0.0, workload),
        sphere("lit sphere of radius 1, 10^4 from the origin", 1.0, 1e4, workload),
        sphere("lit sphere of radius 1000 at the origin", 1e3, 0.0, workload),
        sphere("lit sphere of radius 100, 10^6 from the origin", 1e2, 1e6, workload),
        square("lit square of side 10^6", 1e6, workload),
        small_glass(workload),
    ]
}
