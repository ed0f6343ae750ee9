//! Eight rays and one shape: the tests of single rays, lane by lane, with the same operations in the same order, so that
//! eight rays meet what each of them does, to the last bit.

use super::mesh::Blocked;
use super::{Crossing, Plane, Shape, Sphere, Surface, Triangle};
use crate::camera::Ray;
use crate::math::{DVec3, gamma};
use crate::simd::{Lanes, Octo, Quad, Rows, Vector, Work};
use crate::tree::Probe;

/// Eight rays.
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    pub origin: Rows,
    pub direction: Rows,
}

/// Where eight rays cross a shape.
#[derive(Clone, Copy, Debug)]
pub struct Crossings {
    /// A bit for each ray that does, within its limits.
    pub met: u32,
    pub t: [f64; 8],
    pub parts: [u32; 8],
    /// A bit for each at which something else may come first.
    pub crowded: u32,
}

/// What eight points of surfaces are like.
#[derive(Clone, Copy, Debug)]
pub struct Surfaces {
    pub point: Rows,
    pub error: Rows,
    pub normal: Rows,
    pub shading: Rows,
}

impl Rays {
    #[inline(always)]
    pub fn load<L: Lanes>(&self) -> (Vector<L::Quad>, Vector<L::Quad>) {
        (Vector::load(&self.origin), Vector::load(&self.direction))
    }

    #[inline(always)]
    fn at<L: Lanes>(&self, t: &[f64; 8]) -> Vector<L::Quad> {
        let (origin, direction) = self.load::<L>();
        origin + direction * Octo::load(t)
    }

    /// So many rays, eight at most and one at least; the others are the last one.
    #[inline(always)]
    pub fn gather<'a>(count: usize, ray: impl Fn(usize) -> &'a Ray) -> Self {
        let mut rays = Self { origin: Rows::ZERO, direction: Rows::ZERO };
        for lane in 0..8 {
            let Ray { origin, direction } = *ray(lane.min(count - 1));
            rays.origin.set(lane, origin);
            rays.direction.set(lane, direction);
        }
        rays
    }

    /// One of them.
    pub fn one(&self, lane: usize) -> Ray {
        Ray { origin: self.origin.one(lane), direction: self.direction.one(lane) }
    }
}

impl Crossings {
    pub const NONE: Self = Self { met: 0, t: [f64::INFINITY; 8], parts: [0; 8], crowded: 0 };

    #[inline(always)]
    fn between<Q: Quad>(t: Octo<Q>, crossed: u32, limit: &[f64; 8]) -> Self {
        let met = crossed & (Octo::splat(0.0).below(t) & t.below(Octo::load(limit))).bits();
        Self { met, t: t.store(), parts: [0; 8], crowded: 0 }
    }

    /// Found ray by ray.
    pub fn one_by_one(rays: u32, mut hit: impl FnMut(usize) -> Option<Crossing>) -> Self {
        let mut found = Self::NONE;
        for lane in lanes(rays) {
            if let Some(at) = hit(lane) {
                found.set(lane, at);
            }
        }
        found
    }

    /// Where one of the rays crosses the shape is here.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, at: Crossing) {
        (self.t[lane], self.parts[lane]) = (at.t, at.part);
        self.met |= 1 << lane;
        self.crowded = self.crowded & !(1 << lane) | u32::from(at.crowded) << lane;
    }

    /// Where one of the rays crosses the shape.
    pub fn one(&self, lane: usize) -> Crossing {
        let crowded = self.crowded >> lane & 1 == 1;
        Crossing { crowded, ..Crossing::of_part(self.t[lane], self.parts[lane]) }
    }
}

/// The numbers of the bits that are set.
pub fn lanes(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = (bits != 0).then(|| bits.trailing_zeros() as usize & 7);
        bits &= bits.wrapping_sub(1);
        lane
    })
}

impl Surfaces {
    #[inline(always)]
    fn new<Q: Quad>(point: Vector<Q>, error: Vector<Q>, normal: Vector<Q>) -> Self {
        let normal = normal.store();
        Self { point: point.store(), error: error.store(), normal, shading: normal }
    }

    /// Found point by point.
    pub fn one_by_one(wanted: u32, surface: impl Fn(usize) -> Surface) -> Self {
        let mut surfaces = [Surface::new(DVec3::ZERO, DVec3::ZERO, DVec3::Y); 8];
        for lane in lanes(wanted) {
            surfaces[lane] = surface(lane);
        }
        Self::of(&surfaces)
    }

    pub fn set(&mut self, lane: usize, surface: &Surface) {
        self.point.set(lane, surface.point);
        self.error.set(lane, surface.error);
        self.normal.set(lane, surface.normal);
        self.shading.set(lane, surface.shading);
    }

    pub fn of(surfaces: &[Surface; 8]) -> Self {
        Self {
            point: Rows::of(&surfaces.map(|surface| surface.point)),
            error: Rows::of(&surfaces.map(|surface| surface.error)),
            normal: Rows::of(&surfaces.map(|surface| surface.normal)),
            shading: Rows::of(&surfaces.map(|surface| surface.shading)),
        }
    }
}

/// The test of eight rays against a shape, before their limits.
pub struct Hit<'a, S> {
    pub shape: &'a S,
    pub rays: &'a Rays,
    pub wanted: u32,
    pub limit: &'a [f64; 8],
}

/// The surface of a shape where eight rays cross it.
struct Met<'a, S> {
    shape: &'a S,
    rays: &'a Rays,
    t: &'a [f64; 8],
}

impl Shape {
    /// [`Shape::hit`] of those of eight rays whose bits are set.
    #[inline(always)]
    pub fn hit_together<L: Lanes>(&self, rays: &Rays, wanted: u32, limit: &[f64; 8]) -> Crossings {
        let found = match self {
            Self::Sphere(shape) => Some(L::apart(Hit { shape, rays, wanted, limit })),
            Self::Plane(shape) => Some(L::apart(Hit { shape, rays, wanted, limit })),
            Self::Triangle(shape) => L::apart(Hit { shape, rays, wanted, limit }),
            Self::Mesh(shape) => Some(L::apart(Hit { shape, rays, wanted, limit })),
            _ => None,
        };
        match found {
            Some(found) => Crossings { met: found.met & wanted, ..found },
            None => self.hit_one_by_one(rays, wanted, limit),
        }
    }

    /// [`Shape::blocks`] of those of eight rays whose bits are set, a bit each.
    #[inline(always)]
    pub fn blocks_together<L: Lanes>(&self, rays: &Rays, wanted: u32, t_max: &[f64; 8]) -> u32 {
        match self {
            Self::Mesh(mesh) => L::apart(Blocked { mesh, rays, wanted, t_max }),
            _ => self.hit_together::<L>(rays, wanted, t_max).met,
        }
    }

    #[inline(never)]
    fn hit_one_by_one(&self, rays: &Rays, wanted: u32, limit: &[f64; 8]) -> Crossings {
        Crossings::one_by_one(wanted, |lane| self.hit(&Probe::new(rays.one(lane)), limit[lane]))
    }

    /// [`Shape::surface`] where those of eight rays cross the shape whose bits are set.
    #[inline(always)]
    pub fn surface_together<L: Lanes>(&self, rays: &Rays, at: &Crossings, wanted: u32) -> Surfaces {
        match self {
            Self::Sphere(shape) => L::apart(Met { shape, rays, t: &at.t }),
            Self::Plane(shape) => L::apart(Met { shape, rays, t: &at.t }),
            Self::Triangle(shape) => {
                let [point, ..] = shape.corners;
                let shape = &Plane { point, normal: super::triangle::unit_normal(shape.corners) };
                L::apart(Met { shape, rays, t: &at.t })
            }
            _ => Surfaces::one_by_one(wanted, |lane| self.surface(&rays.one(lane), at.one(lane))),
        }
    }
}

/// [`super::flat::crossing`].
impl Work for Hit<'_, Plane> {
    type Output = Crossings;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Crossings {
        let (origin, direction) = self.rays.load::<L>();
        let normal = Vector::splat(self.shape.normal);
        let along = normal.dot(direction);
        let height = normal.dot(Vector::splat(self.shape.point) - origin);
        Crossings::between(height / along, Octo::splat(0.0).below(along.absolute()).bits(), self.limit)
    }
}

/// [`Sphere::hit`](super::Geometric::hit), all its cases at once.
impl Work for Hit<'_, Sphere> {
    type Output = Crossings;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Crossings {
        let (zero, radius) = (Octo::splat(0.0), Octo::splat(self.shape.radius));
        let (origin, d) = self.rays.load::<L>();
        let from_center = origin - Vector::splat(self.shape.center);
        let distance = from_center.length();
        let outside = distance - radius;
        let (a, b) = (d.dot(d), -from_center.dot(d));
        let is_outside = zero.at_most(outside);
        let inverse = Octo::splat(1.0) / a;
        let first = b * inverse;
        let near = from_center + d * first;
        let nearest = near.length();
        let square = (radius - nearest) * (radius + nearest);
        let missed = ((is_outside & b.at_most(zero)) | square.below(zero)).bits();
        if missed == 0xff {
            return Crossings::NONE;
        }
        let closest = first - near.dot(d) * inverse;
        let half_chord = (square * inverse).root();
        let entry = {
            let c = outside * (distance + radius) * inverse;
            let afar = (Octo::splat(2.0) * radius).below(distance);
            (closest - half_chord).pick(afar, c / (closest + half_chord))
        };
        let mut t = entry;
        if is_outside.bits() != 0xff {
            let ahead = zero.below(closest);
            let back = -outside * (distance + radius) * inverse / (half_chord - closest);
            t = entry.pick(is_outside, (closest + half_chord).pick(ahead, back));
        }
        Crossings::between(t, !missed, self.limit)
    }
}

/// [`Triangle::hit`](super::Geometric::hit); none if the rays are not all longest along one axis.
impl Work for Hit<'_, Triangle> {
    type Output = Option<Crossings>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Option<Crossings> {
        let Self { shape: triangle, wanted, limit, .. } = self;
        let (origin, direction) = self.rays.load::<L>();
        let axis = direction.longest_axis(wanted)?;
        let (dx, dy, dz) = turned(direction, axis);
        let inverse = Octo::splat(1.0) / dz;
        let (shear_x, shear_y) = (dx * inverse, dy * inverse);
        let zero = Octo::splat(0.0);
        let [a, b, c] = triangle.corners;
        let corners = [Vector::splat(a), Vector::splat(b), Vector::splat(c)];
        let ((ax, ay, az), (bx, by, bz), (cx, cy, cz)) = (
            turned(corners[0] - origin, axis),
            turned(corners[1] - origin, axis),
            turned(corners[2] - origin, axis),
        );
        let (ax, ay) = (ax - shear_x * az, ay - shear_y * az);
        let (bx, by) = (bx - shear_x * bz, by - shear_y * bz);
        let (cx, cy) = (cx - shear_x * cz, cy - shear_y * cz);
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        let inside = (zero.at_most(u) & zero.at_most(v) & zero.at_most(w))
            | (u.at_most(zero) & v.at_most(zero) & w.at_most(zero));
        let (left, right) = (ax.smaller(bx).smaller(cx), ax.larger(bx).larger(cx));
        let (low, high) = (ay.smaller(by).smaller(cy), ay.larger(by).larger(cy));
        let around = left.at_most(zero) & zero.at_most(right) & low.at_most(zero) & zero.at_most(high);
        let covered = (inside & around & zero.below((u + v + w).absolute())).bits();
        if covered & wanted == 0 {
            return Some(Crossings::NONE);
        }
        let normal = Vector::splat(super::triangle::perpendicular(triangle.corners));
        let along = normal.dot(direction);
        let t = normal.dot(corners[0] - origin) / along;
        let (a, b, c) = (az * inverse, bz * inverse, cz * inverse);
        let (near, far) = (a.smaller(b).smaller(c), a.larger(b).larger(c));
        let t = t.larger(near).smaller(far);
        Some(Crossings::between(t, covered & zero.below(along.absolute()).bits(), limit))
    }
}

/// The coordinates of vectors, the one along an axis last.
#[inline(always)]
fn turned<Q: Quad>(v: Vector<Q>, last: usize) -> (Octo<Q>, Octo<Q>, Octo<Q>) {
    match last {
        0 => (v.y, v.z, v.x),
        1 => (v.z, v.x, v.y),
        _ => (v.x, v.y, v.z),
    }
}

/// [`super::flat::surface`].
impl Work for Met<'_, Plane> {
    type Output = Surfaces;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Surfaces {
        let (anchor, normal) = (Vector::splat(self.shape.point), Vector::splat(self.shape.normal));
        placed(anchor, self.rays.at::<L>(self.t), normal)
    }
}

/// [`super::flat::placed`].
#[inline(always)]
pub(super) fn placed<Q: Quad>(anchor: Vector<Q>, near: Vector<Q>, normal: Vector<Q>) -> Surfaces {
    let height = normal.dot(anchor - near);
    let point = near + normal * height;
    let error = (anchor - point).absolute() * Octo::splat(gamma(11))
        + point.absolute() * Octo::splat(gamma(3))
        + normal.absolute() * (height.absolute() * Octo::splat(gamma(8)));
    Surfaces::new(point, error, normal)
}

/// [`Sphere::surface`](super::Geometric::surface).
impl Work for Met<'_, Sphere> {
    type Output = Surfaces;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Surfaces {
        let Sphere { center, radius } = *self.shape;
        let at = self.rays.at::<L>(self.t);
        on_sphere(at, Vector::splat(center), Octo::splat(radius))
    }
}

/// The same where each ray crosses a sphere of its own.
#[inline(always)]
pub fn on_spheres<L: Lanes>(centers: &Rows, radii: &[f64; 8], rays: &Rays, t: &[f64; 8]) -> Surfaces {
    on_sphere(rays.at::<L>(t), Vector::load(centers), Octo::load(radii))
}

#[inline(always)]
fn on_sphere<Q: Quad>(at: Vector<Q>, center: Vector<Q>, radius: Octo<Q>) -> Surfaces {
    let normal = (at - center).normalized_or(Vector::splat(DVec3::Y));
    let point = center + normal * radius;
    let rounding = radius * Octo::splat(gamma(6));
    let error = point.absolute() * Octo::splat(gamma(2))
        + center.absolute() * Octo::splat(gamma(1))
        + Vector { x: rounding, y: rounding, z: rounding };
    Surfaces::new(point, error, normal)
}
