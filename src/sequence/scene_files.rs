//! The glTF files that a sequence names, each read once.

use super::material_description::MeshMaterials;
use crate::base::files::{self, Root};
use crate::import::LoadProgress;
use crate::import::gltf::{self, GltfScene};
use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// The files read so far.
pub struct SceneFiles {
    folder: PathBuf,
    root: Root,
    pub meter: Arc<LoadProgress>,
    read: RefCell<HashMap<PathBuf, SceneResult>>,
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
        Self { folder: folder.to_owned(), root, meter: Arc::default(), read: RefCell::default() }
    }

    /// Reads a file, or returns the result of the first time.
    pub fn scene(&self, name: &str) -> SceneResult {
        if !gltf::is_gltf(Path::new(name)) {
            return Err("scenes are read from .gltf and .glb files".to_owned());
        }
        let path = self.root.admit(&self.folder.join(name)).map_err(|error| files::describe(&error))?;
        let mut read = self.read.borrow_mut();
        let scene = read.entry(path).or_insert_with_key(|path| {
            let scene = gltf::load(path, &self.root, &self.meter).map_err(|error| error.to_string())?;
            Ok(Rc::new(SceneFile { scene, materials: OnceCell::new() }))
        });
        scene.clone()
    }
}

impl SceneFile {
    /// The materials, created once. None if that failed, which has been reported.
    pub fn materials(&self, make: impl FnOnce() -> Option<MeshMaterials>) -> Option<MeshMaterials> {
        self.materials.get_or_init(make).clone()
    }
}
