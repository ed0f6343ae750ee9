//! Spheres from afar, from close by, from inside, and at their limb.

use super::input_rng::InputRng;
use super::measure::{Case, Verdict, Workload, method};
use super::number::{Float, Number, Vector3};
use crate::base::math::exact::Exact;
use crate::base::math::{DVec3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{OneRay, Sphere};

/// A ray and a sphere in one precision, and Kinora's types with the same numbers.
#[derive(Clone, Copy)]
pub struct SphereRay<R> {
    pub center: Vector3<R>,
    pub radius: R,
    pub origin: Vector3<R>,
    pub direction: Vector3<R>,
    pub sphere: Sphere,
    pub probe: TraversalRay,
}

impl<R: Float> SphereRay<R> {
    pub fn new(center: DVec3, radius: f64, origin: DVec3, direction: DVec3) -> Self {
        let (center, radius) = (Vector3::<R>::of(center), R::of(radius));
        let (origin, direction) = (Vector3::<R>::of(origin), Vector3::<R>::of(direction));
        let sphere = Sphere { center: center.wide(), radius: radius.wide() };
        let probe = TraversalRay::new(Ray { origin: origin.wide(), direction: direction.wide() });
        Self { center, radius, origin, direction, sphere, probe }
    }

    fn exact(&self) -> Option<Exact> {
        let [center, origin, direction] = [self.center, self.origin, self.direction].map(Vector3::to);
        quadratic(center, Exact::of(self.radius.wide()), origin, direction, Exact::zero())
    }

    /// The error of t, relative to t or to the radius.
    fn judged(&self, found: Option<f64>, relative: bool) -> Verdict {
        match (found, self.exact()) {
            (Some(t), Some(exact)) => {
                let off = (Exact::of(t) - exact).value().abs();
                let radii = self.radius.wide() / self.direction.wide().length();
                Verdict::off(off / if relative { exact.value() } else { radii })
            }
            (found, exact) => Verdict::wrong_if(found.is_some() != exact.is_some()),
        }
    }
}

/// The textbook's a t² + 2 b t + c = 0 (Glassner, *An Introduction to Ray Tracing*, 2.2): the smallest root above
/// `least`.
pub fn quadratic<R: Number>(
    center: Vector3<R>,
    radius: R,
    origin: Vector3<R>,
    direction: Vector3<R>,
    least: R,
) -> Option<R> {
    let from = origin - center;
    let a = direction.dot(direction);
    let b = from.dot(direction);
    let c = from.dot(from) - radius * radius;
    let discriminant = b * b - a * c;
    if discriminant < R::zero() {
        return None;
    }
    let root = discriminant.sqrt();
    let first = (-b - root) / a;
    if first > least {
        return Some(first);
    }
    let second = (-b + root) / a;
    (second > least).then_some(second)
}

/// From the line's point next to the centre, with factored differences and the root that does not cancel (*Ray
/// Tracing Gems*, chapter 7).
pub fn recentred<R: Number>(
    center: Vector3<R>,
    radius: R,
    origin: Vector3<R>,
    direction: Vector3<R>,
) -> Option<R> {
    let from = origin - center;
    let a = direction.dot(direction);
    let middle = -from.dot(direction) / a;
    let nearest = (from + direction * middle).length();
    let square = (radius - nearest) * (radius + nearest) / a;
    if square < R::zero() {
        return None;
    }
    let (distance, half) = (from.length(), square.sqrt());
    let c = (distance - radius) * (distance + radius) / a;
    if c > R::zero() {
        let two = R::of(2.0);
        let entry = if distance > two * radius { middle - half } else { c / (middle + half) };
        return (middle > R::zero()).then_some(entry);
    }
    Some(if middle > R::zero() { middle + half } else { c / (middle - half) })
}

fn textbook<R: Float>(at: &SphereRay<R>) -> Option<R> {
    quadratic(at.center, at.radius, at.origin, at.direction, R::zero())
}

fn stable(at: &SphereRay<f32>) -> Option<f32> {
    recentred(at.center, at.radius, at.origin, at.direction)
}

fn ours(at: &SphereRay<f64>) -> Option<f64> {
    at.sphere.intersect_up_to(&at.probe, f64::INFINITY).map(|at| at.t)
}

/// A sphere, and random rays as pairs of an origin and a target.
struct SphereCase {
    id: &'static str,
    what: &'static str,
    /// Whether errors are relative to t instead of the radius.
    relative: bool,
    center: DVec3,
    radius: f64,
    ray: fn(&mut InputRng, DVec3, f64) -> (DVec3, DVec3),
}

impl SphereCase {
    fn inputs<R: Float>(&self, workload: Workload) -> Vec<SphereRay<R>> {
        let mut rng = InputRng::new(7);
        let one = |_| {
            let (origin, aim) = (self.ray)(&mut rng, self.center, self.radius);
            SphereRay::new(self.center, self.radius, origin, aim - origin)
        };
        (0..workload.inputs).map(one).collect()
    }

    fn case(&self, workload: Workload) -> Case {
        fn judge<R: Float>(relative: bool) -> impl Fn(&SphereRay<R>, Option<R>) -> Verdict {
            move |at, found| at.judged(found.map(R::wide), relative)
        }
        let relative = self.relative;
        Case {
            id: self.id,
            what: self.what,
            error: if relative { "largest relative error of t" } else { "largest error of t, in radii" },
            wrong: "hit or miss mistaken",
            methods: [
                method(self.inputs::<f32>(workload), textbook, judge(relative)),
                method(self.inputs::<f64>(workload), textbook, judge(relative)),
                method(self.inputs::<f32>(workload), stable, judge(relative)),
                method(self.inputs::<f64>(workload), ours, judge(relative)),
            ],
        }
    }
}

/// Half of the rays hit the sphere, and half just miss it.
fn from_afar(rng: &mut InputRng, radius: f64, distance: f64) -> (DVec3, DVec3) {
    let w = rng.direction();
    let (inner, outer) = if rng.unit() < 0.5 { (0.0, 0.999) } else { (1.001, 1.05) };
    (w * distance, rng.ring(w, inner, outer) * radius)
}

pub fn cases(workload: Workload) -> Vec<Case> {
    let settings = [
        SphereCase {
            id: "INT-01",
            what: "sphere of radius 1, seen from 10^4 away",
            relative: false,
            center: DVec3::ZERO,
            radius: 1.0,
            ray: |rng, _, r| from_afar(rng, r, 1e4),
        },
        SphereCase {
            id: "INT-01",
            what: "sphere of radius 0.001, seen from 1000 away (10^6 radii)",
            relative: false,
            center: DVec3::ZERO,
            radius: 1e-3,
            ray: |rng, _, r| from_afar(rng, r, 1e3),
        },
        SphereCase {
            id: "INT-03",
            what: "ground sphere of 6371 km, seen from 2 m above it",
            relative: true,
            center: DVec3::new(0.0, -6_371_000.0, 0.0),
            radius: 6_371_000.0,
            ray: |rng, _, _| {
                let turn = crate::base::math::Angle(rng.uniform(-85.0, -5.0)).cos_sin();
                let eye = DVec3::new(0.0, 2.0, 0.0);
                (eye, eye + DVec3::new(turn.x, turn.y, 0.0))
            },
        },
        SphereCase {
            id: "INT-05",
            what: "rays that start inside, 10^-5 of the radius below the surface",
            relative: false,
            center: DVec3::ZERO,
            radius: 1.0,
            ray: |rng, _, r| {
                let from = rng.direction() * (r * (1.0 - 1e-5));
                let way = rng.direction();
                // Rays that leave at once would be ill-conditioned.
                (from, from + if way.dot(from) > 0.0 { -way } else { way })
            },
        },
        SphereCase {
            id: "INT-06",
            what: "grazing rays, 10^-6 to 10^-2 of the radius below the limb",
            relative: false,
            center: DVec3::ZERO,
            radius: 1.0,
            ray: |rng, _, r| {
                let w = rng.direction();
                let height = 1.0 - rng.log_uniform(1e-6, 1e-2);
                let limb = rng.ring(w, height, height) * r;
                (limb + w * (10.0 * r), limb)
            },
        },
    ];
    settings.iter().map(|setting| setting.case(workload)).collect()
}
