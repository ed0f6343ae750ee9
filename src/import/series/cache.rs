//! The meshes of a series that are in memory.

use super::StepError;
use super::ahead::Ahead;
use crate::base::digest::Digest;
use crate::geometry::mesh::{MeshData, TriangleMesh};
use std::sync::Arc;

/// Meshes that are kept besides the first one: an open shutter may return to the one before.
const MESHES: usize = 2;

/// The last meshes by their digest, and the data between which they were blended by step.
#[derive(Debug, Default)]
pub struct Cache {
    meshes: Vec<(Option<Digest>, Arc<TriangleMesh>)>,
    data: Vec<(usize, Arc<MeshData>)>,
    ahead: Ahead,
}

impl Cache {
    /// The mesh of a digest, which `load` makes if it is not there.
    pub fn mesh(
        &mut self,
        digest: Option<Digest>,
        load: impl FnOnce(&mut Self) -> Result<TriangleMesh, StepError>,
    ) -> Result<Arc<TriangleMesh>, StepError> {
        if let Some(at) = self.meshes.iter().position(|(known, _)| *known == digest) {
            // The last one is the one that was used last.
            let found = self.meshes.remove(at);
            self.meshes.push(found);
        } else {
            // Before the next one is loaded, so that memory never holds more.
            if self.meshes.len() == MESHES {
                self.meshes.remove(0);
            }
            let mesh = Arc::new(load(self)?);
            self.meshes.push((digest, mesh));
        }
        let (_, mesh) = &self.meshes[self.meshes.len() - 1];
        Ok(Arc::clone(mesh))
    }

    /// The mesh that was made or used last.
    pub fn last(&self) -> Option<&TriangleMesh> {
        self.meshes.last().map(|(_, mesh)| &**mesh)
    }

    /// What is read ahead.
    pub fn ahead(&mut self) -> &mut Ahead {
        &mut self.ahead
    }

    /// The data of a step, which `load` reads if it is not there. Only the data of the steps `wanted` stays.
    pub fn data(
        &mut self,
        step: usize,
        wanted: [usize; 2],
        load: impl FnOnce(&mut Ahead) -> Result<MeshData, StepError>,
    ) -> Result<Arc<MeshData>, StepError> {
        self.data.retain(|(known, _)| wanted.contains(known));
        if let Some((_, data)) = self.data.iter().find(|(known, _)| *known == step) {
            return Ok(Arc::clone(data));
        }
        let data = Arc::new(load(&mut self.ahead)?);
        self.data.push((step, Arc::clone(&data)));
        Ok(data)
    }
}
