//! Shapes as textbooks have them, in any precision.

use crate::accuracy::exact::Exact;
use crate::accuracy::hard_cases::real::{Machine, Real, V};
use crate::accuracy::hard_cases::solids::{self, Profile};
use crate::accuracy::hard_cases::spheres::{quadratic, recentred};
use crate::accuracy::hard_cases::tori::{ferrari, polished, quartic};
use crate::accuracy::hard_cases::triangles::{LEAST_DETERMINANT, moller_trumbore, woop};
use crate::base::math::{DAffine3, DMat3, DVec3};
use crate::geometry::shape::Shape;
use crate::scene::Primitive;

/// A precision in which every shape can be met by its textbook's formula.
pub trait Textbook: Real {
    /// The least determinant with which a triangle counts as met.
    const PARALLEL: f64;

    /// The nearest root beyond `least` of the torus of radii 1 and `minor` around the y axis; `direction` is of unit length.
    fn torus(minor: f64, origin: V<Self>, direction: V<Self>, least: Self) -> Option<Self>;
}

macro_rules! textbook {
    ($number:ty) => {
        impl Textbook for $number {
            const PARALLEL: f64 = LEAST_DETERMINANT;

            fn torus(minor: f64, origin: V<Self>, direction: V<Self>, least: Self) -> Option<Self> {
                ferrari(quartic(minor, origin, direction), least)
            }
        }
    };
}

textbook!(f32);
textbook!(f64);

/// What is true: the same formulas in twice the digits of f64.
impl Textbook for Exact {
    const PARALLEL: f64 = 0.0;

    fn torus(minor: f64, origin: V<Self>, direction: V<Self>, least: Self) -> Option<Self> {
        // From the point next to the centre, f64 has the root to many digits, and Newton's steps double them.
        let shift = -origin.dot(direction);
        let near = origin + direction * shift;
        let coefficients = quartic(minor, near, direction);
        let start = ferrari(coefficients.map(Real::wide), (least - shift).value())?;
        let [a, b, c, d] = coefficients;
        let (two, three, four) = (Self::of(2.0), Self::of(3.0), Self::of(4.0));
        let mut t = Self::of(start);
        for _ in 0..3 {
            let value = (((t + a) * t + b) * t + c) * t + d;
            let slope = ((four * t + three * a) * t + two * b) * t + c;
            if slope == Self::zero() {
                break;
            }
            t = t - value / slope;
        }
        Some(t + shift).filter(|t| *t > least)
    }
}

/// A shape in its own space.
#[derive(Clone, Copy)]
enum Kind<R> {
    Sphere {
        center: V<R>,
        radius: R,
    },
    Plane {
        point: V<R>,
        normal: V<R>,
    },
    Disk {
        center: V<R>,
        normal: V<R>,
        radius: R,
    },
    Rectangle {
        corner: V<R>,
        u: V<R>,
        v: V<R>,
    },
    Box {
        min: V<R>,
        max: V<R>,
    },
    Triangle([V<R>; 3]),
    /// Of heights up to 1.
    Solid(Profile),
    /// Of radii 1 and this.
    Torus(f64),
}

/// A shape in the world.
#[derive(Clone, Copy)]
pub struct Body<R> {
    kind: Kind<R>,
    /// The way into its own space: rows of a matrix, and what is added behind.
    local: Option<([V<R>; 3], V<R>)>,
}

impl<R: Textbook> Body<R> {
    /// A part of a primitive as this precision has it; none of what nothing is seen of.
    pub fn new(primitive: &Primitive, part: u32) -> Option<Self> {
        let placed = primitive.placement.as_ref().map(|placement| placement.to_world.inverse());
        let mut own = None;
        let kind = match &primitive.shape {
            Shape::Sphere(sphere) => {
                Kind::Sphere { center: V::of(sphere.center), radius: R::of(sphere.radius) }
            }
            Shape::Plane(plane) => Kind::Plane { point: V::of(plane.point), normal: V::of(plane.normal) },
            Shape::Disk(disk) => Kind::Disk {
                center: V::of(disk.center),
                normal: V::of(disk.normal),
                radius: R::of(disk.radius),
            },
            Shape::Rectangle(at) => {
                Kind::Rectangle { corner: V::of(at.corner), u: V::of(at.u), v: V::of(at.v) }
            }
            Shape::Triangle(triangle) => Kind::Triangle(triangle.corners.map(V::of)),
            Shape::Cuboid(cuboid) => Kind::Box { min: V::of(cuboid.min), max: V::of(cuboid.max) },
            Shape::Mesh(mesh) => Kind::Triangle(mesh.mesh.corners(part).map(V::of)),
            Shape::Cylinder(cylinder) => solid(cylinder.ends(), &mut own),
            Shape::Cone(cone) => solid(cone.ends(), &mut own),
            Shape::Torus(torus) => {
                let ((center, axis), (major, minor)) = (torus.center_and_axis(), torus.radii());
                own = Some(upright(center, axis, major));
                Kind::Torus(minor / major)
            }
            Shape::Group => return None,
        };
        let local = match (own, placed) {
            (None, None) => None,
            (own, placed) => Some(own.unwrap_or_default() * placed.unwrap_or_default()),
        };
        let rows = |affine: DAffine3| {
            let DMat3 { x_axis, y_axis, z_axis } = affine.matrix3.transpose();
            ([x_axis, y_axis, z_axis].map(V::of), V::of(affine.translation))
        };
        Some(Self { kind, local: local.map(rows) })
    }

    fn moved(&self, origin: V<R>, direction: V<R>) -> (V<R>, V<R>) {
        let Some((rows, shift)) = self.local else { return (origin, direction) };
        let turned = |v: V<R>| V(rows.map(|row| row.dot(v)));
        (turned(origin) + shift, turned(direction))
    }

    /// The textbook: the nearest root beyond `least`.
    pub fn hit(&self, origin: V<R>, direction: V<R>, least: R) -> Option<R> {
        let (o, d) = self.moved(origin, direction);
        let beyond = |t: &R| *t > least;
        match self.kind {
            Kind::Sphere { center, radius } => quadratic(center, radius, o, d, least),
            Kind::Plane { point, normal } => plane(point, normal, o, d).filter(beyond),
            Kind::Disk { center, normal, radius } => plane(center, normal, o, d).filter(beyond).filter(|t| {
                let off = o + d * *t - center;
                off.dot(off) <= radius * radius
            }),
            Kind::Rectangle { corner, u, v } => {
                plane(corner, u.cross(v), o, d).filter(beyond).filter(|t| inside(corner, u, v, o + d * *t))
            }
            Kind::Box { min, max } => slabs(min, max, o, d, least),
            Kind::Triangle(corners) => moller_trumbore(corners, o, d, R::of(R::PARALLEL)).filter(beyond),
            Kind::Solid(profile) => solids::nearest(&profile, o, d, least),
            Kind::Torus(minor) => {
                let length = d.length();
                R::torus(minor, o, d * (R::one() / length), least * length).map(|t| t / length)
            }
        }
    }
}

impl Body<f32> {
    /// The stable formula where the textbook's is not.
    pub fn stable(&self, origin: V<f32>, direction: V<f32>) -> Option<f32> {
        let (o, d) = self.moved(origin, direction);
        match self.kind {
            Kind::Sphere { center, radius } => recentred(center, radius, o, d),
            Kind::Triangle(corners) => woop(corners, o, d),
            Kind::Solid(profile) => solids::recentred(&profile, o, d),
            Kind::Torus(minor) => {
                let length = d.length();
                polished(minor, o, d * (1.0 / length)).filter(|t| *t > 0.0).map(|t| t / length)
            }
            _ => self.hit(origin, direction, 0.0),
        }
    }
}

/// The space in which a solid of revolution stands upright around the origin, and `size` is 1.
fn upright(center: DVec3, axis: DVec3, size: f64) -> DAffine3 {
    let (x, z) = axis.any_orthonormal_pair();
    let turn = DMat3::from_cols(x, axis, z).transpose() * (1.0 / size);
    DAffine3 { matrix3: turn, translation: -(turn * center) }
}

fn solid<R>(([bottom, top], closed): ([(DVec3, f64); 2], bool), own: &mut Option<DAffine3>) -> Kind<R> {
    let (middle, span) = ((bottom.0 + top.0) * 0.5, top.0 - bottom.0);
    let half = 0.5 * span.length();
    *own = Some(upright(middle, span.normalize(), half));
    let (mean, lean) = (0.5 * (bottom.1 + top.1) / half, 0.5 * (top.1 - bottom.1) / half);
    Kind::Solid(Profile { base: mean, slope: lean, low: -1.0, closed })
}

fn plane<R: Real>(point: V<R>, normal: V<R>, origin: V<R>, direction: V<R>) -> Option<R> {
    let slope = normal.dot(direction);
    (slope != R::zero()).then(|| normal.dot(point - origin) / slope)
}

/// Whether a point of the plane lies in the parallelogram.
fn inside<R: Real>(corner: V<R>, u: V<R>, v: V<R>, point: V<R>) -> bool {
    let (off, normal) = (point - corner, u.cross(v));
    let square = normal.dot(normal);
    let unit = |share: R| share >= R::zero() && share <= square;
    unit(off.cross(v).dot(normal)) && unit(u.cross(off).dot(normal))
}

/// Kay and Kajiya's slabs.
fn slabs<R: Real>(min: V<R>, max: V<R>, origin: V<R>, direction: V<R>, least: R) -> Option<R> {
    let (mut enter, mut leave) = (R::of(-f64::MAX), R::of(f64::MAX));
    for axis in 0..3 {
        let (o, d) = (origin.0[axis], direction.0[axis]);
        if d == R::zero() {
            if o < min.0[axis] || o > max.0[axis] {
                return None;
            }
            continue;
        }
        let (a, b) = ((min.0[axis] - o) / d, (max.0[axis] - o) / d);
        enter = enter.larger(a.smaller(b));
        leave = leave.smaller(a.larger(b));
    }
    if enter > leave {
        return None;
    }
    [enter, leave].into_iter().find(|t| *t > least)
}

/// Whether a number of a machine is one.
pub fn sound<R: Machine>(t: &R) -> bool {
    t.wide().is_finite()
}
