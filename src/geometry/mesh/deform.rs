//! Meshes that morph targets and joints deform.
//!
//! Source: glTF 2.0 specification, sections 3.7.2.2 (morph targets) and 3.7.3 (skins).

use super::build::{has_area, is_placed};
use super::corners::FEW;
use super::{Corners, MeshData};
use crate::base::digest::{Content, Digest, Digester};
use crate::base::math::{Aabb, DAffine3, DMat3, DVec3};
use glam::Vec3;
use rayon::prelude::*;

/// A mesh at rest, and what deforms it.
#[derive(Debug)]
pub struct Deformer {
    /// Its normals, if there are any, are one per position.
    data: MeshData,
    targets: Vec<MorphTarget>,
    /// For each vertex the same number of joints with their weights; none if joints do not move the mesh.
    influences: Vec<Influence>,
    /// The number of joints of each vertex.
    width: usize,
    /// The vertices of triangles, ascending. Files may have others, which no triangle shows.
    used: Vec<u32>,
    digest: Digest,
}

/// Differences that a weight multiplies, one for each vertex; normals may be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    pub positions: Vec<DVec3>,
    pub normals: Vec<Vec3>,
}

/// How much a joint moves a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Influence {
    pub joint: u16,
    pub weight: f64,
}

impl Content for MorphTarget {
    fn feed(&self, into: &mut Digester) {
        let Self { positions, normals } = self;
        positions.feed(into);
        normals.feed(into);
    }
}

impl Content for Influence {
    fn feed(&self, into: &mut Digester) {
        let Self { joint, weight } = self;
        joint.feed(into);
        weight.feed(into);
    }
}

impl Deformer {
    /// `influences` holds `width` joints for each vertex, or nothing. Weights of a vertex are scaled to a sum of 1; without
    /// any, its first joint moves it.
    pub fn new(
        data: MeshData,
        targets: Vec<MorphTarget>,
        mut influences: Vec<Influence>,
        width: usize,
    ) -> Self {
        for of_vertex in influences.chunks_mut(width.max(1)) {
            let sum: f64 = of_vertex.iter().map(|influence| influence.weight).sum();
            if sum > 0.0 {
                of_vertex.iter_mut().for_each(|influence| influence.weight /= sum);
            } else if let Some(first) = of_vertex.first_mut() {
                first.weight = 1.0;
            }
        }
        let digest = Digest::of(&((super::build::digest(&data), width), &targets, &influences));
        let mut is_used = vec![false; data.positions.len()];
        data.triangles.iter().flatten().for_each(|vertex| is_used[*vertex as usize] = true);
        let used = (0..).zip(is_used).filter(|(_, used)| *used).map(|(vertex, _)| vertex).collect();
        Self { data, targets, influences, width, used, digest }
    }

    /// The digest of everything.
    pub fn digest(&self) -> Digest {
        self.digest
    }

    /// The number of morph targets.
    pub fn targets(&self) -> usize {
        self.targets.len()
    }

    /// The number of vertices that triangles show.
    pub fn vertices(&self) -> usize {
        self.used.len()
    }

    fn position(&self, vertex: usize, weights: &[f64], joints: &[DAffine3]) -> DVec3 {
        let deltas = self.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
        let delta = |target: &MorphTarget| target.positions.get(vertex).copied().unwrap_or_default();
        let rest = self.data.positions[vertex];
        let morphed = deltas.fold(rest, |sum, (target, weight)| sum + delta(target) * *weight);
        self.map(vertex, joints).map_or(morphed, |map| map.transform_point3(morphed))
    }

    /// The positions with these weights of morph targets, and these maps of joints.
    fn positions(&self, weights: &[f64], joints: &[DAffine3]) -> Vec<DVec3> {
        let all = (0..self.data.positions.len()).into_par_iter().with_min_len(FEW);
        all.map(|vertex| self.position(vertex, weights, joints)).collect()
    }

    /// The positions of the vertices that triangles show.
    pub fn used_positions(&self, weights: &[f64], joints: &[DAffine3]) -> Vec<DVec3> {
        let used = self.used.par_iter().with_min_len(FEW);
        used.map(|vertex| self.position(*vertex as usize, weights, joints)).collect()
    }

    fn normals(&self, rest: &[Vec3], weights: &[f64], joints: &[DAffine3]) -> Vec<Vec3> {
        let normal = |(vertex, rest): (usize, &Vec3)| {
            let delta =
                |target: &MorphTarget| target.normals.get(vertex).copied().unwrap_or_default().as_dvec3();
            let targets = self.targets.iter().zip(weights);
            let morphed =
                targets.fold(rest.as_dvec3(), |sum, (target, weight)| sum + delta(target) * *weight);
            let turned = self.map(vertex, joints).map_or(morphed, |map| cofactors(map.matrix3) * morphed);
            turned.normalize_or_zero().as_vec3()
        };
        rest.par_iter().with_min_len(FEW).enumerate().map(normal).collect()
    }

    /// The weighted sum of the maps of a vertex's joints.
    fn map(&self, vertex: usize, joints: &[DAffine3]) -> Option<DAffine3> {
        let influences = self.influences.get(vertex * self.width..(vertex + 1) * self.width)?;
        let mut sum = DAffine3::ZERO;
        for Influence { joint, weight } in influences.iter().filter(|influence| influence.weight != 0.0) {
            let map = joints.get(usize::from(*joint)).copied().unwrap_or(DAffine3::IDENTITY);
            sum.matrix3 += map.matrix3 * *weight;
            sum.translation += map.translation * *weight;
        }
        (self.width > 0).then_some(sum)
    }

    /// A box around the deformed mesh; none if no triangle has an area. Positions outside the range of the arithmetic
    /// have a box, so that they are not taken for a mesh that vanishes.
    pub fn bounds(&self, weights: &[f64], joints: &[DAffine3]) -> Option<Aabb> {
        let positions = self.positions(weights, joints);
        let corners = |triangle: &[u32; 3]| triangle.map(|vertex| positions[vertex as usize]);
        let shows = |triangle: &[u32; 3]| {
            has_area(corners(triangle)) || !corners(triangle).into_iter().all(is_placed)
        };
        let is_visible = self.data.triangles.iter().any(shows);
        is_visible.then(|| Aabb::around(self.used.iter().map(|vertex| positions[*vertex as usize])))
    }

    /// The deformed mesh.
    pub fn deformed(&self, weights: &[f64], joints: &[DAffine3]) -> MeshData {
        let normals = self.data.normals.as_ref();
        let normals = normals.map(|rest| Corners::per_vertex(self.normals(rest.values(), weights, joints)));
        MeshData { positions: self.positions(weights, joints), normals, ..self.data.clone() }
    }
}

/// The matrix that maps normals as `matrix` maps surfaces: its inverse transpose times its determinant, which exists for
/// every matrix. The sign keeps normals on their side if the matrix mirrors.
fn cofactors(matrix: DMat3) -> DMat3 {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = matrix;
    let sign = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
    DMat3::from_cols(y.cross(z) * sign, z.cross(x) * sign, x.cross(y) * sign)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> MeshData {
        // The last vertex is in no triangle.
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::splat(50.0)];
        MeshData { positions, triangles: vec![[0, 1, 2]], ..MeshData::default() }
    }

    fn morphing(to: [DVec3; 3]) -> Deformer {
        let rest = triangle().positions;
        let positions = to.iter().zip(rest).map(|(to, rest)| *to - rest).chain([DVec3::ZERO]).collect();
        Deformer::new(triangle(), vec![MorphTarget { positions, normals: Vec::new() }], Vec::new(), 0)
    }

    /// Weights as files hold them: floats whose sum is not exactly 1. Three joints that move alike must move the mesh like
    /// one. The shares of the sum differ from exact ones by at most 3 u each, the products and their sum by 3 u more.
    #[test]
    fn joints_that_move_alike_move_like_one() {
        let far = 1e8;
        let weights = [0.1f32, 0.2, 0.7].map(f64::from);
        let influences: Vec<Influence> = (0..4)
            .flat_map(|_| [0, 1, 2].map(|joint| Influence { joint, weight: weights[usize::from(joint)] }))
            .collect();
        let deformer = Deformer::new(triangle(), Vec::new(), influences, 3);
        let joints = [DAffine3::from_translation(DVec3::X * far); 3];
        let found = deformer.used_positions(&[], &joints);
        let bound = far * 6.0 * f64::EPSILON / 2.0;
        for (found, rest) in found.into_iter().zip(triangle().positions) {
            let error = (found - (rest + DVec3::X * far)).length();
            assert!(error <= bound, "{error:e} {bound:e}");
        }
    }

    #[test]
    fn bounds_know_when_no_triangle_has_an_area() {
        let line = morphing([DVec3::ZERO, DVec3::X, DVec3::X * 2.0]);
        assert_eq!(line.bounds(&[1.0], &[]), None);
        assert_eq!(line.bounds(&[0.0], &[]), Some(Aabb { min: DVec3::ZERO, max: DVec3::new(1.0, 1.0, 0.0) }));
        // Out of range is not flat.
        assert!(line.bounds(&[1e31], &[]).is_some_and(|bounds| bounds.max.x > 1e30));
        assert!(line.bounds(&[f64::INFINITY], &[]).is_some());
        assert_eq!(line.vertices(), 3);
    }
}
