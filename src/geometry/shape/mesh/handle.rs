//! A mesh as a shape: shared data, and the normals for shading.

use crate::base::digest::{Content, Digest, Digester};
use crate::base::math::Aabb;
use crate::geometry::mesh::{Normals, TriangleMesh};
use std::sync::Arc;

/// A mesh with its kind of normals. Meshes are large and immutable, so they are shared and compared by address. The
/// part of a hit is the index of its triangle.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub mesh: Arc<TriangleMesh>,
    pub normals: Normals,
    /// If the mesh is one of a series: which one.
    pub step: Option<MeshStep>,
}

/// What is known of a mesh of a series before it is loaded. Until then, another mesh of the series takes its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshStep {
    /// The digest of the mesh with all its data.
    pub digest: Digest,
    /// A box around the mesh.
    pub bounds: Aabb,
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        let Self { mesh, normals, step } = other;
        Arc::ptr_eq(&self.mesh, mesh) && self.normals == *normals && self.step == *step
    }
}

impl Mesh {
    pub fn new(mesh: Arc<TriangleMesh>, normals: Normals) -> Self {
        Self { mesh, normals, step: None }
    }

    /// Whether the mesh is shaded with vertex normals.
    pub fn is_smooth(&self) -> bool {
        match self.normals {
            Normals::File => self.mesh.has_normals(),
            Normals::Smooth => true,
            Normals::Flat => false,
        }
    }
}

impl Content for Mesh {
    fn feed(&self, into: &mut Digester) {
        let Self { mesh, normals, step } = self;
        step.map_or_else(|| mesh.digest(), |step| step.digest).feed(into);
        normals.feed(into);
    }
}
