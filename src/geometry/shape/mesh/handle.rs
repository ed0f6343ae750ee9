//! A mesh as a shape: shared data, and the normals for shading.

use crate::base::digest::{Content, Digester};
use crate::geometry::mesh::{Normals, TriangleMesh};
use std::sync::Arc;

/// A mesh with its kind of normals. Meshes are large and immutable, so they are shared and compared by address. The
/// part of a hit is the index of its triangle.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub mesh: Arc<TriangleMesh>,
    pub normals: Normals,
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh) && self.normals == other.normals
    }
}

impl Mesh {
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
        let Self { mesh, normals } = self;
        mesh.digest().feed(into);
        normals.feed(into);
    }
}
