//! Triangle meshes: many triangles with a tree of their own.

#[cfg(test)]
mod tests;

use super::triangle::{covers, depth, perpendicular, uniform_weights};
use super::{Crossing, Geometric, Parameters, Surface, flat};
use crate::camera::Ray;
use crate::color::Rgb;
use crate::math::{Aabb, DAffine3, DVec2, DVec3};
use crate::mesh::{self, Normals, Sheared};
use crate::simd::{Lanes, Work};
use crate::tree::{Leaves, Probe, Slabs};
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

impl Geometric for Mesh {
    const NAME: &'static str = "Mesh";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        parameters.mesh()
    }

    /// Of equally near triangles the one with the lowest index.
    fn hit(&self, probe: &Probe, t_max: f64) -> Option<Crossing> {
        let mut nearest = Nearest { mesh: self, probe, sheared: None, t_max, hit: None };
        self.mesh.tree().walk(probe, t_max, &mut nearest);
        nearest.hit
    }

    fn blocks(&self, probe: &Probe, t_max: f64) -> bool {
        let mut any = Any { mesh: self, probe, sheared: None, t_max, limit: 0.0, found: false };
        self.mesh.tree().walk(probe, t_max, &mut any);
        any.found
    }

    fn surface(&self, ray: &Ray, at: Crossing) -> Surface {
        let corners = self.mesh.corners(at.part);
        let normal = perpendicular(corners).normalize_or(DVec3::Y);
        self.shaded(flat::surface(corners[0], normal, ray, at.t), at.part)
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
        let normal = perpendicular(corners).normalize_or(DVec3::Y);
        Some((self.shaded(flat::placed(a, point, normal), index as u32), index as u32))
    }
}

/// An interpolated unit normal that is shorter than this has no direction that could be trusted: corners'
/// normals are f32, and cancel to within their rounding.
const SHORTEST_NORMAL: f64 = 1e-6;

impl Mesh {
    /// The weights of a triangle's second and third corner at a point of it.
    fn weights(&self, point: DVec3, part: u32) -> DVec2 {
        let [a, b, c] = self.mesh.corners(part);
        flat::shares(point - a, b - a, c - a)
    }

    /// The surface with the normal that the corners' normals come to.
    fn shaded(&self, surface: Surface, part: u32) -> Surface {
        let Some(normals) = self.mesh.corner_normals(part, self.normals) else { return surface };
        let [a, b, c] = normals.map(|normal| normal.as_dvec3());
        let weights = self.weights(surface.point, part);
        let normal = a + (b - a) * weights.x + (c - a) * weights.y;
        let length = normal.length();
        if length < SHORTEST_NORMAL { surface } else { surface.shaded(normal / length) }
    }
}

/// The search for the nearest triangle. What the filter is sure of is not tested again; only its t is computed.
struct Nearest<'a> {
    mesh: &'a Mesh,
    probe: &'a Probe,
    /// There from the first leaf on.
    sheared: Option<Sheared>,
    t_max: f64,
    hit: Option<Crossing>,
}

impl Leaves for Nearest<'_> {
    const IN_ORDER: bool = true;

    #[inline(always)]
    fn fetch<L: Lanes>(&self, leaf: u32) {
        L::fetch(self.mesh.mesh.packets(), leaf as usize);
    }

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, leaf: u32, slabs: &Slabs) -> Option<f32> {
        L::apart(Visit { search: self, leaf, slabs })
    }
}

impl Work for Visit<'_, Nearest<'_>> {
    type Output = Option<f32>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Option<f32> {
        let Self { search, leaf, slabs } = self;
        search.test::<L>(leaf, slabs)
    }
}

impl Nearest<'_> {
    #[inline(always)]
    fn test<L: Lanes>(&mut self, leaf: u32, slabs: &Slabs) -> Option<f32> {
        let packet = self.mesh.mesh.packet(leaf);
        let sheared = self.sheared.get_or_insert_with(|| Sheared::new(self.probe, slabs));
        let mut limit = slabs.limit(self.hit.map_or(self.t_max, |hit| hit.t));
        let sieve = sheared.sift::<L>(packet, limit);
        let mut candidates = sieve.hit | sieve.unsure;
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize;
            candidates &= candidates - 1;
            if sieve.hit >> lane & 1 == 1 && sieve.near[lane & 7] > limit {
                continue;
            }
            let corners = self.mesh.mesh.packed_corners(packet, lane);
            if sieve.hit >> lane & 1 == 0 && !covers(corners, self.probe) {
                continue;
            }
            let Some(t) = depth(corners, self.probe).filter(|&t| t > 0.0 && t < self.t_max) else { continue };
            let part = packet.part(lane);
            if self.hit.is_none_or(|best| t < best.t || t == best.t && part < best.part) {
                self.hit = Some(Crossing { t, part });
                limit = slabs.limit(t);
            }
        }
        Some(limit)
    }
}

/// The visit of a leaf.
struct Visit<'a, S> {
    search: &'a mut S,
    leaf: u32,
    slabs: &'a Slabs,
}

/// The search for any triangle.
struct Any<'a> {
    mesh: &'a Mesh,
    probe: &'a Probe,
    sheared: Option<Sheared>,
    t_max: f64,
    /// The filters' one, from the first leaf on.
    limit: f32,
    found: bool,
}

impl Leaves for Any<'_> {
    const IN_ORDER: bool = false;

    #[inline(always)]
    fn fetch<L: Lanes>(&self, leaf: u32) {
        L::fetch(self.mesh.mesh.packets(), leaf as usize);
    }

    #[inline(always)]
    fn visit<L: Lanes>(&mut self, leaf: u32, slabs: &Slabs) -> Option<f32> {
        L::apart(Visit { search: self, leaf, slabs })
    }
}

impl Work for Visit<'_, Any<'_>> {
    type Output = Option<f32>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Option<f32> {
        let Self { search, leaf, slabs } = self;
        search.test::<L>(leaf, slabs)
    }
}

impl Any<'_> {
    #[inline(always)]
    fn test<L: Lanes>(&mut self, leaf: u32, slabs: &Slabs) -> Option<f32> {
        let packet = self.mesh.mesh.packet(leaf);
        let (probe, limit) = (self.probe, &mut self.limit);
        let sheared = self.sheared.get_or_insert_with(|| {
            *limit = slabs.limit(self.t_max);
            Sheared::new(probe, slabs)
        });
        let sieve = sheared.sift::<L>(packet, self.limit);
        self.found = sieve.within != 0;
        let mut candidates = sieve.hit | sieve.unsure;
        while !self.found && candidates != 0 {
            let lane = candidates.trailing_zeros() as usize;
            candidates &= candidates - 1;
            let corners = self.mesh.mesh.packed_corners(packet, lane);
            let t = if covers(corners, probe) { depth(corners, probe) } else { None };
            self.found = t.is_some_and(|t| t > 0.0 && t < self.t_max);
        }
        if self.found { None } else { Some(self.limit) }
    }
}
