//! Spheres: from afar, from close by, from inside, and along their limb.

use super::draw::Draw;
use super::measure::{Case, Effort, Verdict, way};
use super::real::{Machine, Real, V};
use crate::accuracy::exact::Exact;
use crate::base::math::{DVec3, Ray};
use crate::geometry::bvh::Probe;
use crate::geometry::shape::{OneRay, Sphere};

/// A ray and a sphere, in one precision and, of the same numbers, as the product has them.
#[derive(Clone, Copy)]
pub struct Aimed<R> {
    pub center: V<R>,
    pub radius: R,
    pub origin: V<R>,
    pub direction: V<R>,
    pub sphere: Sphere,
    pub probe: Probe,
}

impl<R: Machine> Aimed<R> {
    pub fn new(center: DVec3, radius: f64, origin: DVec3, direction: DVec3) -> Self {
        let (center, radius) = (V::<R>::of(center), R::of(radius));
        let (origin, direction) = (V::<R>::of(origin), V::<R>::of(direction));
        let sphere = Sphere { center: center.wide(), radius: radius.wide() };
        let probe = Probe::new(Ray { origin: origin.wide(), direction: direction.wide() });
        Self { center, radius, origin, direction, sphere, probe }
    }

    fn exact(&self) -> Option<Exact> {
        let [center, origin, direction] = [self.center, self.origin, self.direction].map(V::to);
        quadratic(center, Exact::of(self.radius.wide()), origin, direction, Exact::zero())
    }

    /// The error of t, relative or as a length over the radius.
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

/// The textbook's a t² + 2 b t + c = 0 (Glassner, *An Introduction to Ray Tracing*, 2.2): the first root above `least`.
pub fn quadratic<R: Real>(center: V<R>, radius: R, origin: V<R>, direction: V<R>, least: R) -> Option<R> {
    let from = origin - center;
    let a = direction.dot(direction);
    let b = from.dot(direction);
    let c = from.dot(from) - radius * radius;
    let discriminant = b * b - a * c;
    if discriminant < R::zero() {
        return None;
    }
    let root = discriminant.root();
    let first = (-b - root) / a;
    if first > least {
        return Some(first);
    }
    let second = (-b + root) / a;
    (second > least).then_some(second)
}

/// From the point next to the centre, factored, with the root that does not cancel (*Ray Tracing Gems*, chapter 7).
pub fn recentred<R: Real>(center: V<R>, radius: R, origin: V<R>, direction: V<R>) -> Option<R> {
    let from = origin - center;
    let a = direction.dot(direction);
    let middle = -from.dot(direction) / a;
    let nearest = (from + direction * middle).length();
    let square = (radius - nearest) * (radius + nearest) / a;
    if square < R::zero() {
        return None;
    }
    let (distance, half) = (from.length(), square.root());
    let c = (distance - radius) * (distance + radius) / a;
    if c > R::zero() {
        let two = R::of(2.0);
        let entry = if distance > two * radius { middle - half } else { c / (middle + half) };
        return (middle > R::zero()).then_some(entry);
    }
    Some(if middle > R::zero() { middle + half } else { c / (middle - half) })
}

fn textbook<R: Machine>(at: &Aimed<R>) -> Option<R> {
    quadratic(at.center, at.radius, at.origin, at.direction, R::zero())
}

fn stable(at: &Aimed<f32>) -> Option<f32> {
    recentred(at.center, at.radius, at.origin, at.direction)
}

fn ours(at: &Aimed<f64>) -> Option<f64> {
    at.sphere.hit(&at.probe, f64::INFINITY).map(|at| at.t)
}

/// A sphere with its centre at `center`; for each ray, its origin and what it is aimed at.
struct Setting {
    id: &'static str,
    what: &'static str,
    /// Whether errors are those of t relative to itself, not to the radius.
    relative: bool,
    center: DVec3,
    radius: f64,
    ray: fn(&mut Draw, DVec3, f64) -> (DVec3, DVec3),
}

impl Setting {
    fn inputs<R: Machine>(&self, effort: Effort) -> Vec<Aimed<R>> {
        let mut draw = Draw::new(7);
        let one = |_| {
            let (origin, aim) = (self.ray)(&mut draw, self.center, self.radius);
            Aimed::new(self.center, self.radius, origin, aim - origin)
        };
        (0..effort.inputs).map(one).collect()
    }

    fn case(&self, effort: Effort) -> Case {
        fn judge<R: Machine>(relative: bool) -> impl Fn(&Aimed<R>, Option<R>) -> Verdict {
            move |at, found| at.judged(found.map(R::wide), relative)
        }
        let relative = self.relative;
        Case {
            id: self.id,
            what: self.what,
            error: if relative { "largest relative error of t" } else { "largest error of t, in radii" },
            wrong: "hit or miss mistaken",
            ways: [
                way(self.inputs::<f32>(effort), textbook, judge(relative)),
                way(self.inputs::<f64>(effort), textbook, judge(relative)),
                way(self.inputs::<f32>(effort), stable, judge(relative)),
                way(self.inputs::<f64>(effort), ours, judge(relative)),
            ],
        }
    }
}

/// Half of the rays at the sphere, half just past it.
fn from_afar(draw: &mut Draw, radius: f64, distance: f64) -> (DVec3, DVec3) {
    let w = draw.direction();
    let (inner, outer) = if draw.unit() < 0.5 { (0.0, 0.999) } else { (1.001, 1.05) };
    (w * distance, draw.ring(w, inner, outer) * radius)
}

pub fn cases(effort: Effort) -> Vec<Case> {
    let settings = [
        Setting {
            id: "INT-01",
            what: "sphere of radius 1, seen from 10^4 away",
            relative: false,
            center: DVec3::ZERO,
            radius: 1.0,
            ray: |draw, _, r| from_afar(draw, r, 1e4),
        },
        Setting {
            id: "INT-01",
            what: "sphere of radius 0.001, seen from 1000 away (10^6 radii)",
            relative: false,
            center: DVec3::ZERO,
            radius: 1e-3,
            ray: |draw, _, r| from_afar(draw, r, 1e3),
        },
        Setting {
            id: "INT-03",
            what: "ground sphere of 6371 km, seen from 2 m above it",
            relative: true,
            center: DVec3::new(0.0, -6_371_000.0, 0.0),
            radius: 6_371_000.0,
            ray: |draw, _, _| {
                let turn = crate::base::math::Angle(draw.between(-85.0, -5.0)).cos_sin();
                let eye = DVec3::new(0.0, 2.0, 0.0);
                (eye, eye + DVec3::new(turn.x, turn.y, 0.0))
            },
        },
        Setting {
            id: "INT-05",
            what: "rays that start inside, 10^-5 of the radius below the surface",
            relative: false,
            center: DVec3::ZERO,
            radius: 1.0,
            ray: |draw, _, r| {
                let from = draw.direction() * (r * (1.0 - 1e-5));
                let way = draw.direction();
                // What leaves at once is as ill-conditioned as it is near.
                (from, from + if way.dot(from) > 0.0 { -way } else { way })
            },
        },
        Setting {
            id: "INT-06",
            what: "grazing rays, 10^-6 to 10^-2 of the radius below the limb",
            relative: false,
            center: DVec3::ZERO,
            radius: 1.0,
            ray: |draw, _, r| {
                let w = draw.direction();
                let height = 1.0 - draw.scale(1e-6, 1e-2);
                let limb = draw.ring(w, height, height) * r;
                (limb + w * (10.0 * r), limb)
            },
        },
    ];
    settings.iter().map(|setting| setting.case(effort)).collect()
}
