//! Triangle meshes: many triangles with a tree of their own.

mod bundle;
mod surfaces;
#[cfg(test)]
mod tests;

pub use bundle::Blocked;

use super::triangle::{covers, depth, uniform_weights, unit_normal};
use super::{Crossing, Geometric, Parameters, Surface, flat};
use crate::camera::Ray;
use crate::color::Rgb;
use crate::digest::{Content, Digester};
use crate::math::{Aabb, DAffine3, DVec2, DVec3};
use crate::mesh::{self, Normals, Sheared};
use crate::simd::{Lanes, Work};
use crate::tree::{Leaves, Probe, Slabs, Stack, Vicinity};
use glam::Vec3;
use std::sync::Arc;

/// A mesh, and how it is shaded. Meshes are large and never change, so they are shared, and compared by where
/// they are. A crossing's part is the index of its triangle.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub mesh: Arc<mesh::Mesh>,
    pub normals: Normals,
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh) && self.normals == other.normals
    }
}

impl Mesh {
    /// Whether it is shaded with normals of its vertices.
    pub fn is_smooth(&self) -> bool {
        match self.normals {
            Normals::File => self.mesh.has_normals(),
            Normals::Smooth => true,
            Normals::Flat => false,
        }
    }
}

/// [`Geometric::hit`] and [`Geometric::blocks`] on lanes that are at work already.
impl Mesh {
    #[inline(always)]
    pub fn hit_on<L: Lanes>(&self, probe: &Probe, t_max: f64, stack: &mut Stack) -> Option<Crossing> {
        L::apart(Alone { search: Nearest::new(self, probe, t_max), stack })
    }

    #[inline(always)]
    pub fn blocks_on<L: Lanes>(&self, probe: &Probe, t_max: f64, stack: &mut Stack) -> bool {
        L::apart(Alone { search: Any::new(self, probe, t_max), stack })
    }
}

impl Content for Mesh {
    fn feed(&self, into: &mut Digester) {
        let Self { mesh, normals } = self;
        mesh.digest().feed(into);
        normals.feed(into);
    }
}

impl Geometric for Mesh {
    const NAME: &'static str = "Mesh";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        parameters.mesh()
    }

    /// Of equally near triangles the one with the lowest index.
    fn hit_after(&self, probe: &Probe, after: f64, t_max: f64) -> Option<Crossing> {
        let mut nearest = Nearest { after, ..Nearest::new(self, probe, t_max) };
        self.mesh.tree().walk(probe, (after, t_max), &mut nearest);
        nearest.hit
    }

    fn crossings(&self, probe: &Probe, after: f64, t_max: f64, found: &mut Vec<Crossing>) {
        let mut all = All { mesh: self, probe, between: (after, t_max), found };
        self.mesh.tree().walk(probe, (after, t_max), &mut all);
    }

    fn blocks(&self, probe: &Probe, t_max: f64) -> bool {
        let mut any = Any::new(self, probe, t_max);
        self.mesh.tree().walk(probe, (0.0, t_max), &mut any);
        any.found
    }

    fn surface(&self, ray: &Ray, at: Crossing) -> Surface {
        let corners = self.mesh.corners(at.part);
        let surface = flat::surface(corners[0], unit_normal(corners), ray, at.t);
        let Some(normals) = self.mesh.corner_normals(at.part, self.normals) else { return surface };
        let weights = weights(corners, surface.point);
        let shaded = shaded(surface, normals, weights);
        if shaded.shading == surface.normal {
            surface
        } else {
            lifted(shaded, ray, corners, normals, weights)
        }
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(self.mesh.bounds())
    }

    /// Moving a mesh would mean a copy of it, and another tree: rays are moved instead.
    fn transformed(&self, _: &DAffine3) -> Option<Self> {
        None
    }

    /// What the corners' coordinates come to. Without them, the weights of the second and the third corner.
    fn uv(&self, point: DVec3, part: u32) -> DVec2 {
        let weights = self.weights(point, part);
        match self.mesh.corner_uvs(part) {
            Some([a, b, c]) => a + (b - a) * weights.x + (c - a) * weights.y,
            None => weights,
        }
    }

    /// Coordinates of a file lie anywhere.
    fn uv_ends(&self, part: u32) -> [bool; 2] {
        [self.mesh.corner_uvs(part).is_none(); 2]
    }

    fn color(&self, point: DVec3, part: u32) -> Rgb {
        let Some([a, b, c]) = self.mesh.corner_colors(part) else { return Rgb::ONE };
        let weights = self.weights(point, part).as_vec2();
        // At an edge a weight may be below zero by its rounding.
        (a + (b - a) * weights.x + (c - a) * weights.y).max(Rgb::ZERO)
    }

    fn area(&self) -> Option<f64> {
        self.mesh.summed_areas().last().copied()
    }

    /// A triangle by its area, then a point of it.
    fn sample_area(&self, u: DVec2) -> Option<(Surface, u32)> {
        let sums = self.mesh.summed_areas();
        let wanted = u.x * sums.last()?;
        let index = sums.partition_point(|&sum| sum <= wanted).min(sums.len() - 1);
        let before = index.checked_sub(1).map_or(0.0, |before| sums[before]);
        let rest = ((wanted - before) / (sums[index] - before)).clamp(0.0, 1.0);
        let corners @ [a, b, c] = self.mesh.corners(index as u32);
        let weights = uniform_weights(DVec2::new(rest, u.y));
        let point = a + (b - a) * weights.x + (c - a) * weights.y;
        let normal = unit_normal(corners);
        let surface = flat::placed(a, point, normal);
        let surface = match self.mesh.corner_normals(index as u32, self.normals) {
            Some(normals) => shaded(surface, normals, self::weights(corners, point)),
            None => surface,
        };
        Some((surface, index as u32))
    }
}

/// An interpolated unit normal that is not longer than this has no direction: corners' normals are f32, each off by
/// less than √3 · 2^-25, the rounding of three coordinates below 1, and so is any mean of them.
const NO_DIRECTION: f64 = f32::EPSILON as f64;

impl Mesh {
    /// The largest of its coordinates.
    fn reach(&self) -> f64 {
        self.mesh.tree().space().reach()
    }

    /// The weights of a triangle's second and third corner at a point of it.
    fn weights(&self, point: DVec3, part: u32) -> DVec2 {
        weights(self.mesh.corners(part), point)
    }
}

fn weights([a, b, c]: [DVec3; 3], point: DVec3) -> DVec2 {
    flat::shares(point - a, b - a, c - a)
}

/// The surface with the way to the smooth one on the side that the ray comes from: the point is moved onto the
/// planes across the corners' normals that lie above it, and these points are weighted as the corners are.
fn lifted(
    surface: Surface,
    ray: &Ray,
    [a, b, c]: [DVec3; 3],
    [p, q, r]: [Vec3; 3],
    DVec2 { x, y }: DVec2,
) -> Surface {
    let seen = if surface.normal.dot(ray.direction) > 0.0 { -surface.normal } else { surface.normal };
    let weights = [1.0 - x - y, x, y];
    let above = |corner: DVec3, normal: Vec3, weight: f64| {
        let normal = normal.as_dvec3();
        let normal = if normal.dot(seen) < 0.0 { -normal } else { normal };
        normal * ((corner - surface.point).dot(normal).max(0.0) * weight.max(0.0))
    };
    let lift = above(a, p, weights[0]) + above(b, q, weights[1]) + above(c, r, weights[2]);
    Surface { lift, ..surface }
}

/// The surface with the normal that the corners' normals come to.
fn shaded(surface: Surface, normals: [Vec3; 3], weights: DVec2) -> Surface {
    let [a, b, c] = normals.map(|normal| normal.as_dvec3());
    let normal = a + (b - a) * weights.x + (c - a) * weights.y;
    let length = normal.length();
    if length <= NO_DIRECTION { surface } else { surface.shaded(normal / length) }
}

/// The search for the nearest triangle. What the filter is sure of is not tested again; only its t is computed.
struct Nearest<'a> {
    mesh: &'a Mesh,
    probe: &'a Probe,
    /// There from the first leaf on.
    sheared: Option<Sheared>,
    after: f64,
    t_max: f64,
    vicinity: Vicinity,
    hit: Option<Crossing>,
}

impl<'a> Nearest<'a> {
    #[inline(always)]
    fn new(mesh: &'a Mesh, probe: &'a Probe, t_max: f64) -> Self {
        let vicinity = Vicinity::new(probe, mesh.reach());
        Self { mesh, probe, sheared: None, after: 0.0, t_max, vicinity, hit: None }
    }

    /// Takes a triangle's crossing if it is nearer, or as near and the triangle the earlier one; gives the t up to which
    /// more is of interest if that is a new one.
    #[inline(always)]
    fn consider(&mut self, t: f64, part: u32) -> Option<f64> {
        let Some(best) = &mut self.hit else {
            self.hit = Some(Crossing::of_part(t, part));
            return Some(self.vicinity.end(t));
        };
        if t < best.t || t == best.t && part < best.part {
            let end = self.vicinity.end(t);
            *best = Crossing { t, part, crowded: best.t < end };
            return Some(end);
        }
        best.crowded |= t < self.vicinity.end(best.t);
        None
    }
}

/// A search along a single ray.
struct Alone<'a, S> {
    search: S,
    stack: &'a mut Stack,
}

impl Work for Alone<'_, Nearest<'_>> {
    type Output = Option<Crossing>;

    #[inline(always)]
    fn run<L: Lanes>(mut self) -> Option<Crossing> {
        let Nearest { mesh: Mesh { mesh, .. }, probe, after, t_max, .. } = self.search;
        mesh.tree().walk_on::<L>(probe, (after, t_max), &mut self.search, self.stack);
        self.search.hit
    }
}

impl Work for Alone<'_, Any<'_>> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(mut self) -> bool {
        let Any { mesh: Mesh { mesh, .. }, probe, t_max, .. } = self.search;
        mesh.tree().walk_on::<L>(probe, (0.0, t_max), &mut self.search, self.stack);
        self.search.found
    }
}

impl Leaves for Nearest<'_> {
    #[inline(always)]
    fn fetch<L: Lanes>(&self, leaf: u32) {
        L::fetch(self.mesh.mesh.packets(), leaf as usize);
    }

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, leaf: u32, slabs: &Slabs, limit: f32) -> Option<f32> {
        L::apart(Visit { search: self, leaf, slabs, limit })
    }
}

impl Work for Visit<'_, Nearest<'_>> {
    type Output = Option<f32>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Option<f32> {
        let Self { search, leaf, slabs, mut limit } = self;
        let Nearest { mesh: Mesh { mesh, .. }, probe, after, t_max, .. } = *search;
        let packet = &mesh.packets()[leaf as usize];
        let sheared = search.sheared.get_or_insert_with(|| Sheared::new(probe, slabs));
        let sieve = sheared.sift::<L>(packet, limit);
        let mut candidates = sieve.hit | sieve.unsure;
        if candidates == 0 {
            return Some(limit);
        }
        let near = sieve.near.store();
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize & 7;
            let sure = sieve.hit >> lane & 1 == 1;
            candidates &= candidates - 1;
            if sure && near[lane] > limit {
                continue;
            }
            let corners = mesh.packed_corners(packet, lane);
            if !sure && !covers(corners, probe) {
                continue;
            }
            let Some(t) = depth(corners, probe).filter(|&t| t > after && t < t_max) else { continue };
            if let Some(end) = search.consider(t, packet.part(lane)) {
                limit = slabs.limit(end);
            }
        }
        Some(limit)
    }
}

/// All triangles beyond one t and before another.
struct All<'a> {
    mesh: &'a Mesh,
    probe: &'a Probe,
    between: (f64, f64),
    found: &'a mut Vec<Crossing>,
}

impl Leaves for All<'_> {
    #[inline(always)]
    fn fetch<L: Lanes>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        let Self { mesh: Mesh { mesh, .. }, probe, between: (after, t_max), .. } = *self;
        let packet = &mesh.packets()[leaf as usize];
        for lane in 0..packet.count() {
            let corners = mesh.packed_corners(packet, lane);
            let t = if covers(corners, probe) { depth(corners, probe) } else { None };
            let within = t.filter(|&t| t > after && t < t_max);
            self.found.extend(within.map(|t| Crossing::of_part(t, packet.part(lane))));
        }
        Some(limit)
    }
}

/// The visit of a leaf.
struct Visit<'a, S> {
    search: &'a mut S,
    leaf: u32,
    slabs: &'a Slabs,
    limit: f32,
}

/// The search for any triangle.
struct Any<'a> {
    mesh: &'a Mesh,
    probe: &'a Probe,
    sheared: Option<Sheared>,
    t_max: f64,
    found: bool,
}

impl<'a> Any<'a> {
    fn new(mesh: &'a Mesh, probe: &'a Probe, t_max: f64) -> Self {
        Self { mesh, probe, sheared: None, t_max, found: false }
    }
}

impl Leaves for Any<'_> {
    #[inline(always)]
    fn fetch<L: Lanes>(&self, leaf: u32) {
        L::fetch(self.mesh.mesh.packets(), leaf as usize);
    }

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, leaf: u32, slabs: &Slabs, limit: f32) -> Option<f32> {
        self.found = L::apart(Visit { search: self, leaf, slabs, limit });
        (!self.found).then_some(limit)
    }
}

impl Work for Visit<'_, Any<'_>> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self) -> bool {
        let Self { search, leaf, slabs, limit } = self;
        let Any { mesh: Mesh { mesh, .. }, probe, t_max, .. } = *search;
        let packet = &mesh.packets()[leaf as usize];
        let sheared = search.sheared.get_or_insert_with(|| Sheared::new(probe, slabs));
        let sieve = sheared.sift::<L>(packet, limit);
        let mut candidates = sieve.hit | sieve.unsure;
        if candidates == 0 {
            return false;
        }
        if sheared.within(&sieve, limit) != 0 {
            return true;
        }
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize;
            candidates &= candidates - 1;
            let corners = mesh.packed_corners(packet, lane);
            let sure = sieve.hit >> lane & 1 == 1;
            let t = if sure || covers(corners, probe) { depth(corners, probe) } else { None };
            if t.is_some_and(|t| t > 0.0 && t < t_max) {
                return true;
            }
        }
        false
    }
}
