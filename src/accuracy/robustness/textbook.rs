//! Textbook intersection formulas of all shapes, in any precision.

use crate::accuracy::hard_cases::number::{Float, Number, Vector3};
use crate::accuracy::hard_cases::solids::{self, Profile};
use crate::accuracy::hard_cases::spheres::{quadratic, recentred};
use crate::accuracy::hard_cases::tori::{ferrari, polished, quartic};
use crate::accuracy::hard_cases::triangles::{LEAST_DETERMINANT, moller_trumbore, woop};
use crate::base::math::exact::Exact;
use crate::base::math::{DAffine3, DMat3, DVec3};
use crate::geometry::shape::{Particles, Shape, Sphere};
use crate::scene::Primitive;

/// A number type with the textbook intersection formulas of all shapes.
pub trait TextbookNumber: Number {
    /// Triangles with a smaller determinant count as parallel to the ray.
    const PARALLEL: f64;

    /// The smallest root above `least` for the torus of radii 1 and `minor` around the y axis; `direction` has unit
    /// length.
    fn torus(minor: f64, origin: Vector3<Self>, direction: Vector3<Self>, least: Self) -> Option<Self>;
}

macro_rules! textbook {
    ($number:ty) => {
        impl TextbookNumber for $number {
            const PARALLEL: f64 = LEAST_DETERMINANT;

            fn torus(
                minor: f64,
                origin: Vector3<Self>,
                direction: Vector3<Self>,
                least: Self,
            ) -> Option<Self> {
                ferrari(quartic(minor, origin, direction), least)
            }
        }
    };
}

textbook!(f32);
textbook!(f64);

/// The true hits: the same formulas in double-double arithmetic.
impl TextbookNumber for Exact {
    const PARALLEL: f64 = 0.0;

    fn torus(minor: f64, origin: Vector3<Self>, direction: Vector3<Self>, least: Self) -> Option<Self> {
        // Seen from the point next to the centre, the root in f64 has many correct digits, and Newton's steps double
        // them.
        let shift = -origin.dot(direction);
        let near = origin + direction * shift;
        let coefficients = quartic(minor, near, direction);
        let start = ferrari(coefficients.map(Number::wide), (least - shift).value())?;
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

/// A shape in its local space.
#[derive(Clone, Copy)]
enum ShapeKind<R> {
    Sphere {
        center: Vector3<R>,
        radius: R,
    },
    Plane {
        point: Vector3<R>,
        normal: Vector3<R>,
    },
    Disk {
        center: Vector3<R>,
        normal: Vector3<R>,
        radius: R,
    },
    Rectangle {
        corner: Vector3<R>,
        u: Vector3<R>,
        v: Vector3<R>,
    },
    Box {
        min: Vector3<R>,
        max: Vector3<R>,
    },
    Triangle([Vector3<R>; 3]),
    /// A solid of revolution with heights up to 1.
    Solid(Profile),
    /// The minor radius of a torus; the major radius is 1.
    Torus(f64),
}

/// A shape in world space.
#[derive(Clone, Copy)]
pub struct TextbookShape<R> {
    kind: ShapeKind<R>,
    /// The transform from world to local space: the rows of a matrix, and a translation.
    local: Option<([Vector3<R>; 3], Vector3<R>)>,
}

impl<R: TextbookNumber> TextbookShape<R> {
    /// A part of a primitive in this precision; `None` for groups, which are invisible.
    pub fn new(primitive: &Primitive, part: u32) -> Option<Self> {
        let placed = primitive.transform.as_ref().map(|placement| placement.to_world.inverse());
        let mut own = None;
        let kind = match &primitive.shape {
            Shape::Sphere(sphere) => {
                ShapeKind::Sphere { center: Vector3::of(sphere.center), radius: R::of(sphere.radius) }
            }
            Shape::Plane(plane) => {
                ShapeKind::Plane { point: Vector3::of(plane.point), normal: Vector3::of(plane.normal) }
            }
            Shape::Disk(disk) => ShapeKind::Disk {
                center: Vector3::of(disk.center),
                normal: Vector3::of(disk.normal),
                radius: R::of(disk.radius),
            },
            Shape::Rectangle(at) => ShapeKind::Rectangle {
                corner: Vector3::of(at.corner),
                u: Vector3::of(at.u),
                v: Vector3::of(at.v),
            },
            Shape::Triangle(triangle) => ShapeKind::Triangle(triangle.corners.map(Vector3::of)),
            Shape::Cuboid(cuboid) => {
                ShapeKind::Box { min: Vector3::of(cuboid.min), max: Vector3::of(cuboid.max) }
            }
            Shape::Mesh(mesh) => ShapeKind::Triangle(mesh.mesh.corners(part).map(Vector3::of)),
            Shape::Particles(Particles(set)) => {
                let Sphere { center, radius } = set.spheres()[part as usize];
                ShapeKind::Sphere { center: Vector3::of(center), radius: R::of(radius) }
            }
            Shape::Cylinder(cylinder) => solid(cylinder.ends(), &mut own),
            Shape::Cone(cone) => solid(cone.ends(), &mut own),
            Shape::Torus(torus) => {
                let ((center, axis), (major, minor)) = (torus.center_and_axis(), torus.radii());
                own = Some(upright(center, axis, major));
                ShapeKind::Torus(minor / major)
            }
            // Its parts have textbook formulas, but the solid has none.
            Shape::Solid(_) | Shape::Group => return None,
        };
        let local = match (own, placed) {
            (None, None) => None,
            (own, placed) => Some(own.unwrap_or_default() * placed.unwrap_or_default()),
        };
        let rows = |affine: DAffine3| {
            let DMat3 { x_axis, y_axis, z_axis } = affine.matrix3.transpose();
            ([x_axis, y_axis, z_axis].map(Vector3::of), Vector3::of(affine.translation))
        };
        Some(Self { kind, local: local.map(rows) })
    }

    fn moved(&self, origin: Vector3<R>, direction: Vector3<R>) -> (Vector3<R>, Vector3<R>) {
        let Some((rows, shift)) = self.local else { return (origin, direction) };
        let turned = |v: Vector3<R>| Vector3(rows.map(|row| row.dot(v)));
        (turned(origin) + shift, turned(direction))
    }

    /// The smallest t above `least` by the textbook formula.
    pub fn hit(&self, origin: Vector3<R>, direction: Vector3<R>, least: R) -> Option<R> {
        let (o, d) = self.moved(origin, direction);
        let beyond = |t: &R| *t > least;
        match self.kind {
            ShapeKind::Sphere { center, radius } => quadratic(center, radius, o, d, least),
            ShapeKind::Plane { point, normal } => plane(point, normal, o, d).filter(beyond),
            ShapeKind::Disk { center, normal, radius } => {
                plane(center, normal, o, d).filter(beyond).filter(|t| {
                    let off = o + d * *t - center;
                    off.dot(off) <= radius * radius
                })
            }
            ShapeKind::Rectangle { corner, u, v } => {
                plane(corner, u.cross(v), o, d).filter(beyond).filter(|t| inside(corner, u, v, o + d * *t))
            }
            ShapeKind::Box { min, max } => slabs(min, max, o, d, least),
            ShapeKind::Triangle(corners) => moller_trumbore(corners, o, d, R::of(R::PARALLEL)).filter(beyond),
            ShapeKind::Solid(profile) => solids::nearest(&profile, o, d, least),
            ShapeKind::Torus(minor) => {
                let length = d.length();
                R::torus(minor, o, d * (R::one() / length), least * length).map(|t| t / length)
            }
        }
    }
}

impl TextbookShape<f32> {
    /// The smallest t by a stable formula, if the textbook formula is unstable.
    pub fn stable(&self, origin: Vector3<f32>, direction: Vector3<f32>) -> Option<f32> {
        let (o, d) = self.moved(origin, direction);
        match self.kind {
            ShapeKind::Sphere { center, radius } => recentred(center, radius, o, d),
            ShapeKind::Triangle(corners) => woop(corners, o, d),
            ShapeKind::Solid(profile) => solids::recentred(&profile, o, d),
            ShapeKind::Torus(minor) => {
                let length = d.length();
                polished(minor, o, d * (1.0 / length)).filter(|t| *t > 0.0).map(|t| t / length)
            }
            _ => self.hit(origin, direction, 0.0),
        }
    }
}

/// The transform into the space where the axis is +y, the centre is the origin, and `size` is 1.
fn upright(center: DVec3, axis: DVec3, size: f64) -> DAffine3 {
    let (x, z) = axis.any_orthonormal_pair();
    let turn = DMat3::from_cols(x, axis, z).transpose() * (1.0 / size);
    DAffine3 { matrix3: turn, translation: -(turn * center) }
}

fn solid<R>(([bottom, top], closed): ([(DVec3, f64); 2], bool), own: &mut Option<DAffine3>) -> ShapeKind<R> {
    let (middle, span) = ((bottom.0 + top.0) * 0.5, top.0 - bottom.0);
    let half = 0.5 * span.length();
    *own = Some(upright(middle, span.normalize(), half));
    let (mean, lean) = (0.5 * (bottom.1 + top.1) / half, 0.5 * (top.1 - bottom.1) / half);
    ShapeKind::Solid(Profile { base: mean, slope: lean, low: -1.0, closed })
}

fn plane<R: Number>(
    point: Vector3<R>,
    normal: Vector3<R>,
    origin: Vector3<R>,
    direction: Vector3<R>,
) -> Option<R> {
    let slope = normal.dot(direction);
    (slope != R::zero()).then(|| normal.dot(point - origin) / slope)
}

/// Whether a point of the plane is inside the parallelogram.
fn inside<R: Number>(corner: Vector3<R>, u: Vector3<R>, v: Vector3<R>, point: Vector3<R>) -> bool {
    let (off, normal) = (point - corner, u.cross(v));
    let square = normal.dot(normal);
    let unit = |share: R| share >= R::zero() && share <= square;
    unit(off.cross(v).dot(normal)) && unit(u.cross(off).dot(normal))
}

/// The slab test of Kay and Kajiya.
fn slabs<R: Number>(
    min: Vector3<R>,
    max: Vector3<R>,
    origin: Vector3<R>,
    direction: Vector3<R>,
    least: R,
) -> Option<R> {
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
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    if enter > leave {
        return None;
    }
    [enter, leave].into_iter().find(|t| *t > least)
}

/// Whether a number is neither NaN nor infinite.
pub fn is_finite<R: Float>(t: &R) -> bool {
    t.wide().is_finite()
}
