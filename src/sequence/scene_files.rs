//! The glTF files that a sequence names, each read once.

use super::file_cache::FileCache;
use super::material_description::MeshMaterials;
use crate::base::files::{self, Root};
use crate::import::LoadProgress;
use crate::import::gltf::{self, GltfScene};
use std::cell::OnceCell;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

pub struct SceneFiles {
    files: FileCache<SceneResult>,
    pub meter: Arc<LoadProgress>,
}

/// A file, or the reason why it cannot be read.
type SceneResult = Result<Rc<SceneFile>, String>;

/// A file and its materials, which all objects that show it share.
pub struct SceneFile {
    pub scene: GltfScene,
    materials: OnceCell<Option<MeshMaterials>>,
}

impl SceneFiles {
    pub fn new(folder: &Path, root: Root) -> Self {
        Self { files: FileCache::new(folder, root), meter: Arc::default() }
    }

    /// Reads a file, or returns the result of the first read.
    pub fn scene(&self, name: &str) -> SceneResult {
        if !gltf::is_gltf(Path::new(name)) {
            return Err("scenes are read from .gltf and .glb files".to_owned());
        }
        let path = self.files.admit(name).map_err(|error| files::describe(&error))?;
        self.files.get(path, (), |path, ()| {
            let scene = gltf::load(path, &self.files.root, &self.meter).map_err(|error| error.to_string())?;
            Ok(Rc::new(SceneFile { scene, materials: OnceCell::new() }))
        })
    }
}

impl SceneFile {
    /// The materials, created once. None if that failed, which has been reported.
    pub fn materials(&self, make: impl FnOnce() -> Option<MeshMaterials>) -> Option<MeshMaterials> {
        self.materials.get_or_init(make).clone()
    }
}
