//! Triangles: leaks at edges and corners, depths, and the normals of slender triangles.

use super::input_rng::InputRng;
use super::measure::{Case, Verdict, Workload, method};
use super::number::{Float, Number, Vector3};
use crate::base::math::exact::{Exact, Vector};
use crate::base::math::{DVec3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::mesh::generate;
use crate::geometry::shape::{Geometric, OneRay, Triangle};

/// The triangles of a closed mesh around a vertex, and a ray from inside towards that vertex or one of its edges.
#[derive(Clone)]
struct Fan<R> {
    triangles: Vec<[Vector3<R>; 3]>,
    origin: Vector3<R>,
    direction: Vector3<R>,
    ours: Vec<Triangle>,
    probe: TraversalRay,
}

/// Minimum determinant in Möller and Trumbore's paper.
pub const LEAST_DETERMINANT: f64 = 1e-6;

/// The test of Möller and Trumbore (1997); triangles with a determinant below `parallel` are missed.
pub fn moller_trumbore<R: Number>(
    [a, b, c]: [Vector3<R>; 3],
    origin: Vector3<R>,
    direction: Vector3<R>,
    parallel: R,
) -> Option<R> {
    let (u_edge, v_edge) = (b - a, c - a);
    let p = direction.cross(v_edge);
    let determinant = u_edge.dot(p);
    if determinant.abs() < parallel || determinant == R::zero() {
        return None;
    }
    let inverse = R::one() / determinant;
    let from = origin - a;
    let u = from.dot(p) * inverse;
    if u < R::zero() || u > R::one() {
        return None;
    }
    let q = from.cross(u_edge);
    let v = direction.dot(q) * inverse;
    if v < R::zero() || u + v > R::one() {
        return None;
    }
    Some(v_edge.dot(q) * inverse).filter(|t| *t > R::zero())
}

/// The watertight test of Woop, Benthin and Wald (2013) in f32, with f64 if an edge function is zero.
pub fn woop([a, b, c]: [Vector3<f32>; 3], origin: Vector3<f32>, direction: Vector3<f32>) -> Option<f32> {
    let d = direction.0;
    let z = (0..3).max_by(|i, j| d[*i].abs().total_cmp(&d[*j].abs())).unwrap_or(2);
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let (sx, sy, sz) = (d[x] / d[z], d[y] / d[z], 1.0 / d[z]);
    let [a, b, c] = [a, b, c].map(|corner| (corner - origin).0);
    let place = |p: [f32; 3]| (p[x] - sx * p[z], p[y] - sy * p[z]);
    let [(ax, ay), (bx, by), (cx, cy)] = [a, b, c].map(place);
    let mut edges = [cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax];
    if edges.contains(&0.0) {
        let wide = |p: f32, q: f32, r: f32, s: f32| {
            (f64::from(p) * f64::from(q) - f64::from(r) * f64::from(s)) as f32
        };
        edges = [wide(cx, by, cy, bx), wide(ax, cy, ay, cx), wide(bx, ay, by, ax)];
    }
    let [u, v, w] = edges;
    if edges.iter().any(|edge| *edge < 0.0) && edges.iter().any(|edge| *edge > 0.0) {
        return None;
    }
    let determinant = u + v + w;
    let t = (u * a[z] + v * b[z] + w * c[z]) * sz / determinant;
    (determinant != 0.0 && t > 0.0).then_some(t)
}

/// The test of Möller and Trumbore with the paper's least determinant.
pub fn published<R: Float>(corners: [Vector3<R>; 3], origin: Vector3<R>, direction: Vector3<R>) -> Option<R> {
    moller_trumbore(corners, origin, direction, R::of(LEAST_DETERMINANT))
}

fn textbook<R: Float>(at: &Fan<R>) -> Option<R> {
    let hits = at.triangles.iter().filter_map(|t| published(*t, at.origin, at.direction));
    hits.reduce(R::min)
}

fn stable(at: &Fan<f32>) -> Option<f32> {
    at.triangles.iter().filter_map(|t| woop(*t, at.origin, at.direction)).reduce(f32::min)
}

fn ours(at: &Fan<f64>) -> Option<f64> {
    let hits = at.ours.iter().filter_map(|triangle| triangle.intersect_up_to(&at.probe, f64::INFINITY));
    hits.map(|at| at.t).reduce(f64::min)
}

fn fans<R: Float>(offset: f64, workload: Workload) -> Vec<Fan<R>> {
    let parts = generate::icosphere(3);
    let center = DVec3::new(1.0, 0.7, -0.3) * offset;
    // Rounded to the precision of the method, so that neighbours still share their corners.
    let corner = |v: u32| Vector3::<R>::of(center + parts.positions[v as usize]);
    let mut around = vec![Vec::new(); parts.positions.len()];
    for triangle in &parts.triangles {
        triangle.iter().for_each(|v| around[*v as usize].push(*triangle));
    }
    let mut rng = InputRng::new(12);
    let one = |k: u32| {
        let vertex = (rng.unit() * around.len() as f64) as u32;
        let near = &around[vertex as usize];
        let [a, b] = [vertex, near[0].into_iter().find(|v| *v != vertex).unwrap_or(vertex)].map(corner);
        let share = if k.is_multiple_of(2) { 0.0 } else { rng.unit() };
        let aim = a.wide() + (b.wide() - a.wide()) * share;
        let origin = Vector3::<R>::of(center + rng.direction() * rng.uniform(0.0, 0.3));
        let direction = Vector3::<R>::of((aim - origin.wide()).normalize());
        let triangles: Vec<_> = near.iter().map(|t| t.map(corner)).collect();
        let ours = triangles.iter().map(|t| Triangle { corners: t.map(Vector3::wide) }).collect();
        let probe = TraversalRay::new(Ray { origin: origin.wide(), direction: direction.wide() });
        Fan { triangles, origin, direction, ours, probe }
    };
    (0..workload.inputs).map(one).collect()
}

fn leaks(what: &'static str, offset: f64, workload: Workload) -> Case {
    fn judge<R: Float>(_: &Fan<R>, found: Option<R>) -> Verdict {
        Verdict::wrong_if(found.is_none())
    }
    Case {
        id: "INT-12",
        what,
        error: "",
        wrong: "rays that leave the closed mesh",
        methods: [
            method(fans::<f32>(offset, workload), textbook, judge),
            method(fans::<f64>(offset, workload), textbook, judge),
            method(fans::<f32>(offset, workload), stable, judge),
            method(fans::<f64>(offset, workload), ours, judge),
        ],
    }
}

/// A triangle with one edge far shorter than the others.
#[derive(Clone, Copy)]
struct Slender<R> {
    corners: [Vector3<R>; 3],
    ours: Triangle,
}

fn slender<R: Float>(workload: Workload) -> Vec<Slender<R>> {
    let mut rng = InputRng::new(15);
    let one = |_| {
        let (along, a) = (rng.direction(), rng.direction() * 10.0);
        let narrow = rng.ring(along, 1.0, 1.0) * rng.log_uniform(1e-5, 1e-1);
        let corners = [a, a + along, a + along * rng.unit() + narrow].map(Vector3::<R>::of);
        Slender { corners, ours: Triangle { corners: corners.map(Vector3::wide) } }
    };
    (0..workload.inputs).map(one).collect()
}

fn normal<R: Float>(at: &Slender<R>) -> Vector3<R> {
    let [a, b, c] = at.corners;
    (b - a).cross(c - a).unit()
}

/// The normal in f64.
fn wide_normal(at: &Slender<f32>) -> Vector3<f32> {
    let [a, b, c] = at.corners.map(Vector3::to::<f64>);
    (b - a).cross(c - a).unit().to()
}

fn our_normal(at: &Slender<f64>) -> Vector3<f64> {
    let (surface, _) = at.ours.sample_area(0.5, 0.5);
    Vector3::of(surface.normal.into())
}

/// The angle to the true normal, from the cross product of both, which does not cancel.
fn normal_judge<R: Float>(at: &Slender<R>, found: Vector3<R>) -> Verdict {
    let [a, b, c] = at.corners.map(|corner| Vector::from(corner.wide()));
    let exact = (b - a).cross(c - a);
    let found = Vector::from(found.wide());
    Verdict::off((found.cross(exact).length() / (exact.length() * found.length())).value())
}

fn normals(workload: Workload) -> Case {
    Case {
        id: "INT-15",
        what: "normal of triangles 10 to 10^5 times as long as wide, 10 from the origin",
        error: "largest angle to the true one, in radians",
        wrong: "",
        methods: [
            method(slender::<f32>(workload), normal, normal_judge),
            method(slender::<f64>(workload), normal, normal_judge),
            method(slender::<f32>(workload), wide_normal, normal_judge),
            method(slender::<f64>(workload), our_normal, normal_judge),
        ],
    }
}

/// A ray from afar that hits a triangle.
#[derive(Clone, Copy)]
struct DistantTriangle<R> {
    corners: [Vector3<R>; 3],
    origin: Vector3<R>,
    direction: Vector3<R>,
    ours: Triangle,
    probe: TraversalRay,
}

fn far<R: Float>(workload: Workload) -> Vec<DistantTriangle<R>> {
    let mut rng = InputRng::new(13);
    let one = |_| {
        let (u, v) = rng.direction().any_orthonormal_pair();
        let corners = [DVec3::ZERO, u, v].map(Vector3::<R>::of);
        let [a, b, c] = corners.map(Vector3::wide);
        let aim = a + (b - a) * 0.3 + (c - a) * rng.uniform(0.1, 0.6);
        let from = rng.direction() * 1e4;
        let (origin, direction) = (Vector3::<R>::of(from), Vector3::<R>::of((aim - from).normalize()));
        let probe = TraversalRay::new(Ray { origin: origin.wide(), direction: direction.wide() });
        DistantTriangle { corners, origin, direction, ours: Triangle { corners: [a, b, c] }, probe }
    };
    // Edge-on triangles may be missed from this distance.
    let facing = |at: &DistantTriangle<R>| {
        let [a, b, c] = at.ours.corners;
        (b - a).cross(c - a).dot(at.direction.wide()).abs() > 0.1
    };
    (0..workload.inputs).map(one).filter(facing).collect()
}

fn depths(workload: Workload) -> Case {
    fn judge<R: Float>(at: &DistantTriangle<R>, found: Option<R>) -> Verdict {
        let Some(t) = found else { return Verdict::WRONG };
        let [a, b, c] = at.corners.map(Vector3::to::<Exact>);
        let normal = (b - a).cross(c - a);
        let exact = normal.dot(a - at.origin.to()) / normal.dot(at.direction.to());
        Verdict::off((Exact::of(t.wide()) - exact).value().abs())
    }
    Case {
        id: "INT-13",
        what: "triangle of size 1, seen from 10^4 away",
        error: "largest error of t",
        wrong: "missed",
        methods: [
            method(far::<f32>(workload), |at| published(at.corners, at.origin, at.direction), judge),
            method(far::<f64>(workload), |at| published(at.corners, at.origin, at.direction), judge),
            method(far::<f32>(workload), |at| woop(at.corners, at.origin, at.direction), judge),
            method(
                far::<f64>(workload),
                |at| at.ours.intersect_up_to(&at.probe, f64::INFINITY).map(|at| at.t),
                judge,
            ),
        ],
    }
}

pub fn cases(workload: Workload) -> Vec<Case> {
    vec![
        leaks("rays at edges and corners of a closed mesh of 1280 triangles", 0.0, workload),
        leaks("the same mesh of radius 1, 10^4 from the origin", 1e4, workload),
        depths(workload),
        normals(workload),
    ]
}
