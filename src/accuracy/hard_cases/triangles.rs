//! Triangles: edges and corners that rays may slip through, depths, and the normals of slender ones.

use super::draw::Draw;
use super::measure::{Case, Effort, Verdict, way};
use super::real::{Machine, Real, V};
use crate::accuracy::exact::{Exact, Vector};
use crate::base::math::{DVec3, Ray};
use crate::geometry::bvh::Probe;
use crate::geometry::mesh::generate;
use crate::geometry::shape::{Geometric, OneRay, Triangle};

/// The triangles of a closed mesh around one of its corners, and a ray from inside at that corner or at one of its
/// edges.
#[derive(Clone)]
struct Fan<R> {
    triangles: Vec<[V<R>; 3]>,
    origin: V<R>,
    direction: V<R>,
    ours: Vec<Triangle>,
    probe: Probe,
}

/// The least determinant that Möller and Trumbore give.
pub const LEAST_DETERMINANT: f64 = 1e-6;

/// Möller and Trumbore (1997), of determinants of at least `parallel`.
pub fn moller_trumbore<R: Real>(
    [a, b, c]: [V<R>; 3],
    origin: V<R>,
    direction: V<R>,
    parallel: R,
) -> Option<R> {
    let (u_edge, v_edge) = (b - a, c - a);
    let p = direction.cross(v_edge);
    let determinant = u_edge.dot(p);
    if determinant.absolute() < parallel || determinant == R::zero() {
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

/// Woop, Benthin and Wald (2013) in f32, with f64 where an edge's number is zero.
pub fn woop([a, b, c]: [V<f32>; 3], origin: V<f32>, direction: V<f32>) -> Option<f32> {
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

pub fn published<R: Machine>(corners: [V<R>; 3], origin: V<R>, direction: V<R>) -> Option<R> {
    moller_trumbore(corners, origin, direction, R::of(LEAST_DETERMINANT))
}

fn textbook<R: Machine>(at: &Fan<R>) -> Option<R> {
    let hits = at.triangles.iter().filter_map(|t| published(*t, at.origin, at.direction));
    hits.reduce(R::smaller)
}

fn stable(at: &Fan<f32>) -> Option<f32> {
    at.triangles.iter().filter_map(|t| woop(*t, at.origin, at.direction)).reduce(f32::min)
}

fn ours(at: &Fan<f64>) -> Option<f64> {
    let hits = at.ours.iter().filter_map(|triangle| triangle.hit(&at.probe, f64::INFINITY));
    hits.map(|at| at.t).reduce(f64::min)
}

fn fans<R: Machine>(offset: f64, effort: Effort) -> Vec<Fan<R>> {
    let parts = generate::icosphere(3);
    let center = DVec3::new(1.0, 0.7, -0.3) * offset;
    // In the precision of the kernel, where neighbours still share their corners.
    let corner = |v: u32| V::<R>::of(center + parts.positions[v as usize]);
    let mut around = vec![Vec::new(); parts.positions.len()];
    for triangle in &parts.triangles {
        triangle.iter().for_each(|v| around[*v as usize].push(*triangle));
    }
    let mut draw = Draw::new(12);
    let one = |k: u32| {
        let vertex = (draw.unit() * around.len() as f64) as u32;
        let near = &around[vertex as usize];
        let [a, b] = [vertex, near[0].into_iter().find(|v| *v != vertex).unwrap_or(vertex)].map(corner);
        let share = if k.is_multiple_of(2) { 0.0 } else { draw.unit() };
        let aim = a.wide() + (b.wide() - a.wide()) * share;
        let origin = V::<R>::of(center + draw.direction() * draw.between(0.0, 0.3));
        let direction = V::<R>::of((aim - origin.wide()).normalize());
        let triangles: Vec<_> = near.iter().map(|t| t.map(corner)).collect();
        let ours = triangles.iter().map(|t| Triangle { corners: t.map(V::wide) }).collect();
        let probe = Probe::new(Ray { origin: origin.wide(), direction: direction.wide() });
        Fan { triangles, origin, direction, ours, probe }
    };
    (0..effort.inputs).map(one).collect()
}

fn leaks(what: &'static str, offset: f64, effort: Effort) -> Case {
    fn judge<R: Machine>(_: &Fan<R>, found: Option<R>) -> Verdict {
        Verdict::wrong_if(found.is_none())
    }
    Case {
        id: "INT-12",
        what,
        error: "",
        wrong: "rays that leave the closed mesh",
        ways: [
            way(fans::<f32>(offset, effort), textbook, judge),
            way(fans::<f64>(offset, effort), textbook, judge),
            way(fans::<f32>(offset, effort), stable, judge),
            way(fans::<f64>(offset, effort), ours, judge),
        ],
    }
}

/// A triangle of which one edge is far shorter than the others.
#[derive(Clone, Copy)]
struct Slender<R> {
    corners: [V<R>; 3],
    ours: Triangle,
}

fn slender<R: Machine>(effort: Effort) -> Vec<Slender<R>> {
    let mut draw = Draw::new(15);
    let one = |_| {
        let (along, a) = (draw.direction(), draw.direction() * 10.0);
        let narrow = draw.ring(along, 1.0, 1.0) * draw.scale(1e-5, 1e-1);
        let corners = [a, a + along, a + along * draw.unit() + narrow].map(V::<R>::of);
        Slender { corners, ours: Triangle { corners: corners.map(V::wide) } }
    };
    (0..effort.inputs).map(one).collect()
}

fn normal<R: Machine>(at: &Slender<R>) -> V<R> {
    let [a, b, c] = at.corners;
    (b - a).cross(c - a).unit()
}

/// Edges and their products in twice the digits.
fn wide_normal(at: &Slender<f32>) -> V<f32> {
    let [a, b, c] = at.corners.map(V::to::<f64>);
    (b - a).cross(c - a).unit().to()
}

fn our_normal(at: &Slender<f64>) -> V<f64> {
    let (surface, _) = at.ours.sample_area(0.5, 0.5);
    V::of(surface.normal.into())
}

/// The angle to the true normal: of a cross product with it, which does not cancel.
fn normal_judge<R: Machine>(at: &Slender<R>, found: V<R>) -> Verdict {
    let [a, b, c] = at.corners.map(|corner| Vector::from(corner.wide()));
    let exact = (b - a).cross(c - a);
    let found = Vector::from(found.wide());
    Verdict::off((found.cross(exact).length() / (exact.length() * found.length())).value())
}

fn normals(effort: Effort) -> Case {
    Case {
        id: "INT-15",
        what: "normal of triangles 10 to 10^5 times as long as wide, 10 from the origin",
        error: "largest angle to the true one, in radians",
        wrong: "",
        ways: [
            way(slender::<f32>(effort), normal, normal_judge),
            way(slender::<f64>(effort), normal, normal_judge),
            way(slender::<f32>(effort), wide_normal, normal_judge),
            way(slender::<f64>(effort), our_normal, normal_judge),
        ],
    }
}

/// A ray at a triangle, from afar.
#[derive(Clone, Copy)]
struct Far<R> {
    corners: [V<R>; 3],
    origin: V<R>,
    direction: V<R>,
    ours: Triangle,
    probe: Probe,
}

fn far<R: Machine>(effort: Effort) -> Vec<Far<R>> {
    let mut draw = Draw::new(13);
    let one = |_| {
        let (u, v) = draw.direction().any_orthonormal_pair();
        let corners = [DVec3::ZERO, u, v].map(V::<R>::of);
        let [a, b, c] = corners.map(V::wide);
        let aim = a + (b - a) * 0.3 + (c - a) * draw.between(0.1, 0.6);
        let from = draw.direction() * 1e4;
        let (origin, direction) = (V::<R>::of(from), V::<R>::of((aim - from).normalize()));
        let probe = Probe::new(Ray { origin: origin.wide(), direction: direction.wide() });
        Far { corners, origin, direction, ours: Triangle { corners: [a, b, c] }, probe }
    };
    // Seen from their edge, triangles may be missed from so far.
    let facing = |at: &Far<R>| {
        let [a, b, c] = at.ours.corners;
        (b - a).cross(c - a).dot(at.direction.wide()).abs() > 0.1
    };
    (0..effort.inputs).map(one).filter(facing).collect()
}

fn depths(effort: Effort) -> Case {
    fn judge<R: Machine>(at: &Far<R>, found: Option<R>) -> Verdict {
        let Some(t) = found else { return Verdict::WRONG };
        let [a, b, c] = at.corners.map(V::to::<Exact>);
        let normal = (b - a).cross(c - a);
        let exact = normal.dot(a - at.origin.to()) / normal.dot(at.direction.to());
        Verdict::off((Exact::of(t.wide()) - exact).value().abs())
    }
    Case {
        id: "INT-13",
        what: "triangle of size 1, seen from 10^4 away",
        error: "largest error of t",
        wrong: "missed",
        ways: [
            way(far::<f32>(effort), |at| published(at.corners, at.origin, at.direction), judge),
            way(far::<f64>(effort), |at| published(at.corners, at.origin, at.direction), judge),
            way(far::<f32>(effort), |at| woop(at.corners, at.origin, at.direction), judge),
            way(far::<f64>(effort), |at| at.ours.hit(&at.probe, f64::INFINITY).map(|at| at.t), judge),
        ],
    }
}

pub fn cases(effort: Effort) -> Vec<Case> {
    vec![
        leaks("rays at edges and corners of a closed mesh of 1280 triangles", 0.0, effort),
        leaks("the same mesh of radius 1, 10^4 from the origin", 1e4, effort),
        depths(effort),
        normals(effort),
    ]
}
