//! Rays that start on surfaces: false shadows where they meet their own surface again, and gaps where what is near is
//! skipped.

use super::draw::Draw;
use super::measure::{Case, Effort, Verdict, way};
use super::real::{Machine, Real, V};
use super::spheres::{Aimed, quadratic, recentred};
use crate::accuracy::exact::Exact;
use crate::appearance::optics::refract;
use crate::base::math::{Angle, DVec3, Ray};
use crate::geometry::bvh::Probe;
use crate::geometry::shape::{Crossing, OneRay, Rectangle, Sphere};
use crate::trace::spawn::spawn_ray;

/// The least t of secondary rays that ray tracers are usually written with.
pub const LEAST: f64 = 1e-3;

/// A ray at a sphere, and a direction to light above the place that it meets.
#[derive(Clone, Copy)]
pub struct Lit<R> {
    pub aimed: Aimed<R>,
    pub light: V<R>,
}

/// Whether the place shadows itself, and how far from it nothing shadows it.
pub struct Shadow {
    pub blocked: bool,
    pub gap: f64,
}

/// The textbook: the point as it is, and roots above [`LEAST`].
pub fn textbook<R: Machine>(at: &Lit<R>) -> Option<Shadow> {
    let Aimed { center, radius, origin, direction, .. } = at.aimed;
    let t = quadratic(center, radius, origin, direction, R::of(LEAST))?;
    let point = origin + direction * t;
    let blocked = quadratic(center, radius, point, at.light, R::of(LEAST)).is_some();
    Some(Shadow { blocked, gap: LEAST })
}

/// Point put back onto the sphere, moved along the normal by the bound of its error, and rounded away (Pharr, Jakob,
/// Humphreys, *Physically Based Rendering*, 6.8.6).
pub fn stable(at: &Lit<f32>) -> Option<Shadow> {
    let Aimed { center, radius, origin, direction, .. } = at.aimed;
    let t = recentred(center, radius, origin, direction)?;
    let normal = (origin + direction * t - center).unit();
    let point = center + normal * radius;
    let roundoff = f32::ROUNDOFF as f32;
    let error = |i: usize| (2.0 * point.0[i].abs() + center.0[i].abs() + 6.0 * radius) * roundoff;
    let reach = (0..3).map(|i| normal.0[i].abs() * error(i)).sum::<f32>();
    let moved = point + normal * reach;
    let start = V(std::array::from_fn(|i| moved.0[i].next_towards(normal.0[i])));
    let blocked = recentred(center, radius, start, at.light).is_some();
    Some(Shadow { blocked, gap: (start - point).length().wide() })
}

/// The product's own.
pub fn ours(at: &Lit<f64>) -> Option<Shadow> {
    let Sphere { .. } = at.aimed.sphere;
    let probe = &at.aimed.probe;
    let found = at.aimed.sphere.hit(probe, f64::INFINITY)?;
    let surface = at.aimed.sphere.surface_at(&probe.ray, found);
    let ray = spawn_ray(&surface, at.light.wide());
    let blocked = at.aimed.sphere.blocks(&Probe::new(ray), f64::INFINITY);
    Some(Shadow { blocked, gap: (ray.origin - surface.point).length() })
}

fn lit<R: Machine>(radius: f64, away: f64, effort: Effort) -> Vec<Lit<R>> {
    let mut draw = Draw::new(1);
    let center = DVec3::new(0.6, 0.64, 0.48) * away;
    let one = |_| {
        let normal = draw.direction();
        let mut above = || loop {
            let d = draw.direction();
            if d.dot(normal).abs() > 0.01 {
                return if d.dot(normal) < 0.0 { -d } else { d };
            }
        };
        let (eye, light) = (above(), above());
        let point = center + normal * radius;
        let aimed = Aimed::new(center, radius, point + eye * (3.0 * radius), -eye);
        Lit { aimed, light: V::of(light) }
    };
    (0..effort.inputs).map(one).collect()
}

fn shadow<R: Machine>(at: &Lit<R>, found: Option<Shadow>) -> Verdict {
    // Rays that miss what is smaller than the rounding of its place are told elsewhere.
    let radius = at.aimed.radius.wide();
    found.map_or(Verdict::RIGHT, |shadow| Verdict { off: Some(shadow.gap / radius), wrong: shadow.blocked })
}

fn sphere(what: &'static str, radius: f64, away: f64, effort: Effort) -> Case {
    Case {
        id: "SELF-01",
        what,
        error: "gap in which nothing casts a shadow, in radii",
        wrong: "lit places that shadow themselves",
        ways: [
            way(lit::<f32>(radius, away, effort), textbook, shadow),
            way(lit::<f64>(radius, away, effort), textbook, shadow),
            way(lit::<f32>(radius, away, effort), stable, shadow),
            way(lit::<f64>(radius, away, effort), ours, shadow),
        ],
    }
}

/// A tilted rectangle that is looked at and lit.
#[derive(Clone, Copy)]
struct Board<R> {
    corner: V<R>,
    u: V<R>,
    v: V<R>,
    origin: V<R>,
    direction: V<R>,
    light: V<R>,
    ours: Rectangle,
    probe: Probe,
}

fn boards<R: Machine>(size: f64, effort: Effort) -> Vec<Board<R>> {
    let mut draw = Draw::new(2);
    let (a, b) = (Angle(30.0).cos_sin(), Angle(40.0).cos_sin());
    let (u, v) = (DVec3::new(a.x, a.y, 0.0), DVec3::new(-a.y * b.x, a.x * b.x, b.y));
    let normal = u.cross(v);
    let corner = V::<R>::of((u + v) * (-0.5 * size));
    let (u, v) = (V::<R>::of(u * size), V::<R>::of(v * size));
    let ours = Rectangle { corner: corner.wide(), u: u.wide(), v: v.wide() };
    let one = |_| {
        let point = ours.corner + ours.u * draw.unit() + ours.v * draw.unit();
        let mut above = || (normal + draw.direction() * 0.95) * size;
        let (origin, light) = (V::<R>::of(point + above()), V::<R>::of(point + above()));
        let direction = V::<R>::of((point - origin.wide()).normalize());
        let probe = Probe::new(Ray { origin: origin.wide(), direction: direction.wide() });
        Board { corner, u, v, origin, direction, light, ours, probe }
    };
    (0..effort.inputs).map(one).collect()
}

fn parallelogram<R: Machine>(at: &Board<R>, origin: V<R>, direction: V<R>, least: R) -> Option<R> {
    let normal = at.u.cross(at.v);
    let t = normal.dot(at.corner - origin) / normal.dot(direction);
    (t > least).then_some(t)
}

fn board_textbook<R: Machine>(at: &Board<R>) -> Option<Shadow> {
    let t = parallelogram(at, at.origin, at.direction, R::of(LEAST))?;
    let point = at.origin + at.direction * t;
    let to_light = (at.light - point).unit();
    let blocked = parallelogram(at, point, to_light, R::of(LEAST)).is_some();
    Some(Shadow { blocked, gap: LEAST })
}

fn board_stable(at: &Board<f32>) -> Option<Shadow> {
    let t = parallelogram(at, at.origin, at.direction, 0.0)?;
    let normal = at.u.cross(at.v).unit();
    let near = at.origin + at.direction * t;
    let point = near + normal * normal.dot(at.corner - near);
    let roundoff = f32::ROUNDOFF as f32;
    let error = |i: usize| ((at.corner - point).0[i].abs() * 11.0 + point.0[i].abs() * 3.0) * roundoff;
    let reach = (0..3).map(|i| normal.0[i].abs() * error(i)).sum::<f32>();
    let moved = point + normal * reach;
    let start = V(std::array::from_fn(|i| moved.0[i].next_towards(normal.0[i])));
    let blocked = parallelogram(at, start, at.light - start, 0.0).is_some_and(|t| t < 1.0);
    Some(Shadow { blocked, gap: (start - point).length().wide() })
}

fn board_ours(at: &Board<f64>) -> Option<Shadow> {
    let found = at.ours.hit(&at.probe, f64::INFINITY)?;
    let surface = at.ours.surface_at(&at.probe.ray, found);
    let ray = spawn_ray(&surface, at.light.wide() - surface.point);
    let ray = Ray { direction: at.light.wide() - ray.origin, ..ray };
    let blocked = at.ours.blocks(&Probe::new(ray), 1.0);
    Some(Shadow { blocked, gap: (ray.origin - surface.point).length() })
}

fn board(what: &'static str, size: f64, effort: Effort) -> Case {
    let judge = move |found: Option<Shadow>| {
        found.map_or(Verdict::RIGHT, |shadow| Verdict { off: Some(shadow.gap / size), wrong: shadow.blocked })
    };
    Case {
        id: "SELF-01",
        what,
        error: "gap in which nothing casts a shadow, in sides",
        wrong: "lit places that shadow themselves",
        ways: [
            way(boards::<f32>(size, effort), board_textbook, move |_, found| judge(found)),
            way(boards::<f64>(size, effort), board_textbook, move |_, found| judge(found)),
            way(boards::<f32>(size, effort), board_stable, move |_, found| judge(found)),
            way(boards::<f64>(size, effort), board_ours, move |_, found| judge(found)),
        ],
    }
}

/// Snell's law for a unit direction and a unit normal that faces it; `ratio` is the index before over that behind.
fn bent<R: Real>(direction: V<R>, normal: V<R>, ratio: R) -> Option<V<R>> {
    let cosine = -direction.dot(normal);
    let square = R::one() - ratio * ratio * (R::one() - cosine * cosine);
    (square >= R::zero()).then(|| direction * ratio + normal * (ratio * cosine - square.root()))
}

/// In at one side of a glass ball and out at the other: the direction behind it.
fn through<R: Real>(center: V<R>, radius: R, origin: V<R>, direction: V<R>, least: R) -> Option<V<R>> {
    let entry = quadratic(center, radius, origin, direction, least)?;
    let point = origin + direction * entry;
    let normal = (point - center) * (R::one() / radius);
    let inside = bent(direction, normal, R::one() / R::of(1.5))?;
    let exit = quadratic(center, radius, point, inside, least)?;
    let normal = (point + inside * exit - center) * (R::one() / radius);
    bent(inside, normal * -R::one(), R::of(1.5))
}

fn glass_textbook<R: Machine>(at: &Aimed<R>) -> Option<V<R>> {
    through(at.center, at.radius, at.origin, at.direction, R::of(LEAST))
}

/// The exit as the second root, which no least t can lose.
fn glass_stable(at: &Aimed<f32>) -> Option<V<f32>> {
    let entry = recentred(at.center, at.radius, at.origin, at.direction)?;
    let normal = (at.origin + at.direction * entry - at.center).unit();
    let inside = bent(at.direction, normal, 1.0 / 1.5)?;
    let exit = (normal - inside * (2.0 * inside.dot(normal))).unit();
    bent(inside, exit * -1.0, 1.5)
}

fn glass_ours(at: &Aimed<f64>) -> Option<V<f64>> {
    let mut ray = at.probe.ray;
    for eta in [1.5, 1.0 / 1.5] {
        let probe = Probe::new(ray);
        let found: Crossing = at.sphere.hit(&probe, f64::INFINITY)?;
        let surface = at.sphere.surface_at(&ray, found);
        let facing = if eta > 1.0 { surface.normal } else { -surface.normal };
        let bent = refract::<f64>(ray.direction.into(), facing.into(), eta);
        if bent.is_total {
            return None;
        }
        ray = spawn_ray(&surface, bent.direction.into());
    }
    Some(V::of(ray.direction))
}

fn glass<R: Machine>(effort: Effort) -> Vec<Aimed<R>> {
    let mut draw = Draw::new(5);
    let one = |_| {
        let (axis, radius) = (draw.direction(), 4e-4);
        let height = draw.ring(axis, 0.0, 0.95) * radius;
        Aimed::new(DVec3::ZERO, radius, height + axis * (5.0 * radius), -axis)
    };
    (0..effort.inputs).map(one).collect()
}

fn glass_judge<R: Machine>(at: &Aimed<R>, found: Option<V<R>>) -> Verdict {
    // The direction is of unit length to the kernel's rounding only; the truth is that of the direction made so.
    let direction = at.direction.to::<Exact>().unit();
    let radius = Exact::of(at.radius.wide());
    // The chord is longer than a hundredth of the radius, and the roots of the points as they are far smaller.
    let least = radius * Exact::of(0.01);
    let exact = through(at.center.to(), radius, at.origin.to(), direction, least);
    match (found, exact) {
        (Some(found), Some(exact)) => Verdict::off((found.to::<Exact>() - exact).length().value()),
        (found, exact) => Verdict::wrong_if(found.is_some() != exact.is_some()),
    }
}

fn small_glass(effort: Effort) -> Case {
    Case {
        id: "SELF-05",
        what: "glass ball of radius 0.0004: the direction behind it",
        error: "largest error of the direction",
        wrong: "second surface lost",
        ways: [
            way(glass::<f32>(effort), glass_textbook, glass_judge),
            way(glass::<f64>(effort), glass_textbook, glass_judge),
            way(glass::<f32>(effort), glass_stable, glass_judge),
            way(glass::<f64>(effort), glass_ours, glass_judge),
        ],
    }
}

pub fn cases(effort: Effort) -> Vec<Case> {
    vec![
        sphere("lit sphere of radius 0.001 at the origin", 1e-3, 0.0, effort),
        sphere("lit sphere of radius 1, 10^4 from the origin", 1.0, 1e4, effort),
        sphere("lit sphere of radius 1000 at the origin", 1e3, 0.0, effort),
        sphere("lit sphere of radius 100, 10^6 from the origin", 1e2, 1e6, effort),
        board("lit square of side 10^6", 1e6, effort),
        small_glass(effort),
    ]
}
