//! Textures at the poles of spheres, and skies at the edges of cube maps.

use super::input_rng::InputRng;
use super::measure::{Case, Verdict, Workload, method};
use super::number::{Float, Number, Vector3};
use crate::appearance::environment::CubeMap;
use crate::appearance::texture::Image;
use crate::base::color::Rgb;
use crate::base::math::exact::Exact;
use crate::base::math::{Angle, DVec2, DVec3};
use crate::geometry::shape::{OneRay, Sphere};
use std::f64::consts::PI;
use std::rc::Rc;

/// A point of a sphere close to its pole -y.
#[derive(Clone, Copy)]
pub struct PolePoint<R> {
    pub center: Vector3<R>,
    pub radius: R,
    pub point: Vector3<R>,
    pub sphere: Sphere,
}

impl<R: Float> PolePoint<R> {
    pub fn new(center: DVec3, radius: f64, point: DVec3) -> Self {
        let (center, radius, point) = (Vector3::<R>::of(center), R::of(radius), Vector3::<R>::of(point));
        let sphere = Sphere { center: center.wide(), radius: radius.wide() };
        Self { center, radius, point, sphere }
    }
}

/// The angle from -y, by the arc cosine of the height.
pub fn arc_cosine<R: Float>(at: &PolePoint<R>) -> R {
    let height = (at.point.0[1] - at.center.0[1]) / at.radius;
    (-height).acos()
}

fn arc_tangent(at: &PolePoint<f32>) -> f32 {
    let Vector3([x, y, z]) = at.point - at.center;
    libm::atan2f((x * x + z * z).sqrt(), -y)
}

pub fn ours(at: &PolePoint<f64>) -> f64 {
    at.sphere.uv_at(at.point.wide(), 0).y * PI
}

fn at_pole<R: Float>(workload: Workload) -> Vec<PolePoint<R>> {
    let mut rng = InputRng::new(13);
    let one = |_| {
        let (angle, turn) = (rng.log_uniform(1e-6, 1e-2), Angle(360.0 * rng.unit()).cos_sin());
        let across = turn * libm::sin(angle);
        let up = DVec3::new(across.x, -libm::cos(angle), across.y);
        let (center, radius) = (DVec3::new(0.0, 3.0, 0.0), 0.7);
        PolePoint::new(center, radius, center + up * radius)
    };
    (0..workload.inputs).map(one).collect()
}

/// Compares with the true angle, from the series of its small tangent: the distance from the axis over the height.
fn pole_judge<R: Float>(at: &PolePoint<R>, found: R) -> Verdict {
    let Vector3([x, y, z]) = at.point.to::<Exact>() - at.center.to();
    let tangent = (x * x + z * z).sqrt() / -y;
    // atan(x) = x - x³/3 + x⁵/5 - …
    let square = tangent * tangent;
    let (mut angle, mut power) = (Exact::zero(), tangent);
    for k in 0..10 {
        let term = power / Exact::of(f64::from(2 * k + 1));
        angle = if k % 2 == 0 { angle + term } else { angle - term };
        power = power * square;
    }
    Verdict::off(((Exact::of(found.wide()) - angle) / angle).value().abs())
}

fn pole(workload: Workload) -> Case {
    Case {
        id: "SH-13",
        what: "latitude 10^-6 to 10^-2 radians from the pole of a sphere",
        error: "largest relative error",
        wrong: "no number",
        methods: [
            method(at_pole::<f32>(workload), arc_cosine, pole_judge),
            method(at_pole::<f64>(workload), arc_cosine, pole_judge),
            method(at_pole::<f32>(workload), arc_tangent, pole_judge),
            method(at_pole::<f64>(workload), ours, pole_judge),
        ],
    }
}

/// Texels along an edge of a face.
const SIZE: u32 = 64;

/// The radiance of the cube maps: 0.5 + 0.5 d·a.
fn light(direction: DVec3) -> f64 {
    0.5 + 0.5 * direction.normalize().dot(DVec3::new(0.2, 0.3, 0.93).normalize())
}

/// The direction to a point of a face: s to the right and t down, in -1..=1.
fn on_face(face: usize, s: f64, t: f64) -> DVec3 {
    let [right, up] = [s, -t];
    match face {
        0 => DVec3::new(1.0, up, -right),
        1 => DVec3::new(-1.0, up, right),
        2 => DVec3::new(right, 1.0, -up),
        3 => DVec3::new(right, -1.0, up),
        4 => DVec3::new(right, up, 1.0),
        _ => DVec3::new(-right, up, -1.0),
    }
}

/// Six faces with a function of the direction, evaluated at the centres of the texels.
pub fn faces(size: u32, of: impl Fn(DVec3) -> f64) -> Option<[Image; 6]> {
    let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(size) * 2.0 - 1.0;
    let texels = |face: usize| {
        let at = |i: u32| Rgb::splat(of(on_face(face, middle(i % size), middle(i / size))) as f32);
        Image::new(size, size, (0..size * size).map(at).collect())
    };
    let [a, b, c, d, e, f] = [0, 1, 2, 3, 4, 5].map(texels);
    Some([a?, b?, c?, d?, e?, f?])
}

/// The textbook lookup: the face of the longest coordinate, bilinearly filtered and clamped to its edges.
pub fn clamped<R: Float>(faces: &[Image; 6], direction: Vector3<R>) -> R {
    let size = faces[0].width();
    let Vector3([x, y, z]) = direction;
    let [ax, ay, az] = [x, y, z].map(R::abs);
    let (face, right, down, long) = if ax >= ay && ax >= az {
        if x > R::zero() { (0, -z, -y, ax) } else { (1, z, -y, ax) }
    } else if ay >= az {
        if y > R::zero() { (2, x, z, ay) } else { (3, x, -z, ay) }
    } else if z > R::zero() {
        (4, x, -y, az)
    } else {
        (5, -x, -y, az)
    };
    let place = |along: R| {
        let at = (R::of(0.5) * along / long + R::of(0.5)) * R::of(size.into()) - R::of(0.5);
        let at = at.max(R::zero()).min(R::of((size - 1).into()));
        let low = at.floor();
        ((low.wide() as u32).min(size - 2), at - low.min(R::of((size - 2).into())))
    };
    let ((column, s), (row, t)) = (place(right), place(down));
    let texel = |x: u32, y: u32| R::of(faces[face].texel(column + x, row + y).x.into());
    let mix = |a: R, b: R, share: R| a + (b - a) * share;
    mix(mix(texel(0, 0), texel(1, 0), s), mix(texel(0, 1), texel(1, 1), s), t)
}

/// Two nearby directions on both sides of an edge of the cube.
#[derive(Clone)]
struct EdgeDirections<R> {
    sides: [Vector3<R>; 2],
    maps: Rc<([Image; 6], CubeMap)>,
}

fn at_edge<R: Float>(maps: &Rc<([Image; 6], CubeMap)>, workload: Workload) -> Vec<EdgeDirections<R>> {
    let mut rng = InputRng::new(15);
    let one = |k: u32| {
        let (axis, along) = (k as usize % 3, rng.uniform(-0.99, 0.99));
        let signs =
            DVec2::new(if rng.unit() < 0.5 { -1.0 } else { 1.0 }, if rng.unit() < 0.5 { -1.0 } else { 1.0 });
        let sides = [1e-6, -1e-6].map(|off| {
            let mut d = DVec3::ZERO;
            (d[axis], d[(axis + 1) % 3], d[(axis + 2) % 3]) =
                (along, signs.x * (1.0 + off), signs.y * (1.0 - off));
            Vector3::of(d.normalize())
        });
        EdgeDirections { sides, maps: Rc::clone(maps) }
    };
    (0..workload.inputs).map(one).collect()
}

fn seam(workload: Workload) -> Option<Case> {
    fn jump<R: Number>(sides: [R; 2]) -> f64 {
        (sides[0].wide() - sides[1].wide()).abs()
    }
    let images = faces(SIZE, light)?;
    let map = CubeMap::new(images.each_ref()).ok()?;
    let maps = Rc::new((images, map));
    fn textbook<R: Float>(at: &EdgeDirections<R>) -> [R; 2] {
        at.sides.map(|side| clamped(&at.maps.0, side))
    }
    fn ours(at: &EdgeDirections<f64>) -> [f64; 2] {
        at.sides.map(|side| at.maps.1.radiance_from(side.wide()).x.into())
    }
    Some(Case {
        id: "SH-15",
        what: "sky of six faces of 64 x 64 texels, 10^-6 radians on both sides of edges",
        error: "largest jump over an edge (1/255 = 0.0039 is seen)",
        wrong: "",
        methods: [
            method(at_edge::<f32>(&maps, workload), textbook, |_, sides| Verdict::off(jump(sides))),
            method(at_edge::<f64>(&maps, workload), textbook, |_, sides| Verdict::off(jump(sides))),
            None,
            method(at_edge::<f64>(&maps, workload), ours, |_, sides| Verdict::off(jump(sides))),
        ],
    })
}

pub fn cases(workload: Workload) -> Vec<Case> {
    [pole(workload)].into_iter().chain(seam(workload)).collect()
}
