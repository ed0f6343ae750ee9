//! Triangle meshes: many triangles with a tree of their own.

#[cfg(test)]
mod tests;

use super::triangle::{covers, perpendicular, uniform_weights};
use super::{Crossing, Geometric, Parameters, Surface, flat};
use crate::camera::Ray;
use crate::color::Rgb;
use crate::math::{Aabb, DAffine3, DVec2, DVec3};
use crate::mesh::{self, Normals};
use crate::tree::Probe;
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
        let mut nearest: Option<Crossing> = None;
        self.mesh.tree().visit(probe, t_max, |leaf| {
            for &part in leaf {
                // One number beyond the best, so that an equally near triangle is found and the indices decide.
                let limit = nearest.map_or(t_max, |best| best.t.next_up());
                let Some(t) = self.cross(part, probe, limit) else { continue };
                if nearest.is_none_or(|best| t < best.t || part < best.part) {
                    nearest = Some(Crossing { t, part });
                }
            }
            nearest.map_or(t_max, |best| best.t)
        });
        nearest
    }

    fn blocks(&self, probe: &Probe, t_max: f64) -> bool {
        let mut found = false;
        self.mesh.tree().visit(probe, t_max, |leaf| {
            found = leaf.iter().any(|&part| self.cross(part, probe, t_max).is_some());
            // Nothing is nearer than a t below zero: the walk ends.
            if found { -1.0 } else { t_max }
        });
        found
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
    #[inline]
    fn cross(&self, part: u32, probe: &Probe, t_max: f64) -> Option<f64> {
        let corners = self.mesh.corners(part);
        if !covers(corners, probe) {
            return None;
        }
        flat::crossing(corners[0], perpendicular(corners), probe, t_max)
    }

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
