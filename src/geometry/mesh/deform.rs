//! Meshes that morph targets and joints deform.
//!
//! Source: glTF 2.0 specification, sections 3.7.2.2 (morph targets) and 3.7.3 (skins).

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
    pub weight: f32,
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
            let sum: f32 = of_vertex.iter().map(|influence| influence.weight).sum();
            if sum > 0.0 {
                of_vertex.iter_mut().for_each(|influence| influence.weight /= sum);
            } else if let Some(first) = of_vertex.first_mut() {
                first.weight = 1.0;
            }
        }
        let digest = Digest::of(&((super::build::digest(&data), width), &targets, &influences));
        Self { data, targets, influences, width, digest }
    }

    /// The digest of everything.
    pub fn digest(&self) -> Digest {
        self.digest
    }

    /// The number of morph targets.
    pub fn targets(&self) -> usize {
        self.targets.len()
    }

    /// The positions with these weights of morph targets, and these maps of joints.
    fn positions(&self, weights: &[f64], joints: &[DAffine3]) -> Vec<DVec3> {
        let position = |(vertex, rest): (usize, &DVec3)| {
            let deltas = self.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
            let delta = |target: &MorphTarget| target.positions.get(vertex).copied().unwrap_or_default();
            let morphed = deltas.fold(*rest, |sum, (target, weight)| sum + delta(target) * *weight);
            self.map(vertex, joints).map_or(morphed, |map| map.transform_point3(morphed))
        };
        self.data.positions.par_iter().with_min_len(FEW).enumerate().map(position).collect()
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
            let weight = f64::from(*weight);
            sum.matrix3 += map.matrix3 * weight;
            sum.translation += map.translation * weight;
        }
        (self.width > 0).then_some(sum)
    }

    /// A box around all positions.
    pub fn bounds(&self, weights: &[f64], joints: &[DAffine3]) -> Aabb {
        Aabb::around(self.positions(weights, joints))
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
