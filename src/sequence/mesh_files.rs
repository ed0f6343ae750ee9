//! The mesh files that a sequence names, each read once for every preparation of its data.

use super::file_cache::FileCache;
use super::material_description::MeshMaterials;
use crate::base::files::{self, Root};
use crate::geometry::mesh::{self, Preparation, PreparationKey};
use crate::import::series::{MeshSeries, SeriesFiles, StepError};
use crate::import::{self, LoadProgress};
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

pub struct MeshFiles {
    files: FileCache<MeshResult, PreparationKey>,
    pub meter: Arc<LoadProgress>,
    series: RefCell<Vec<Arc<MeshSeries>>>,
    /// Materials by the address of their mesh. Keeps the mesh alive, so that no other mesh gets its address.
    materials: RefCell<HashMap<*const mesh::TriangleMesh, (Arc<mesh::TriangleMesh>, MeshMaterials)>>,
}

/// A mesh, or the reason why it cannot be read.
type MeshResult = Result<Arc<mesh::TriangleMesh>, String>;

impl MeshFiles {
    pub fn new(folder: &Path, root: Root) -> Self {
        Self {
            files: FileCache::new(folder, root),
            meter: Arc::default(),
            series: RefCell::default(),
            materials: RefCell::default(),
        }
    }

    /// The folder to which paths are relative.
    pub fn folder(&self) -> &Path {
        &self.files.folder
    }

    /// The canonical path of a file that the sequence may read.
    pub fn admit(&self, name: &str) -> Result<PathBuf, String> {
        self.files.admit(name).map_err(|error| files::describe(&error))
    }

    /// Checks the files of a series, or returns the same series of the first time.
    pub fn series(&self, mut files: SeriesFiles) -> Result<Arc<MeshSeries>, Vec<StepError>> {
        let mut errors = Vec::new();
        for path in files.steps.iter_mut().flatten() {
            let known = import::known_format(path).map_err(|error| error.to_string());
            let admitted =
                known.and_then(|()| self.files.root.admit(path).map_err(|error| files::describe(&error)));
            match admitted {
                Ok(admitted) => *path = admitted,
                Err(why) => errors.push(StepError { path: path.clone(), why }),
            }
        }
        if !errors.is_empty() {
            return Err(errors);
        }
        let mut read = self.series.borrow_mut();
        if let Some(known) = read.iter().find(|known| known.is_of(&files)) {
            return Ok(Arc::clone(known));
        }
        let series = Arc::new(MeshSeries::open(files, self.files.root.clone(), &self.meter)?);
        read.push(Arc::clone(&series));
        Ok(series)
    }

    /// Reads a file and prepares its data, or returns the result of the first read.
    pub fn mesh(&self, name: &str, preparation: &Preparation) -> MeshResult {
        import::known_format(Path::new(name)).map_err(|error| error.to_string())?;
        let path = self.admit(name)?;
        self.files.get(path, preparation.key(), |path, _| {
            let mesh = import::load_prepared(path, &self.files.root, &self.meter, preparation);
            mesh.map(Arc::new).map_err(|error| error.to_string())
        })
    }

    /// The materials of a mesh, created once. If creation fails, each object reports it again.
    pub fn materials_of(
        &self,
        mesh: &Arc<mesh::TriangleMesh>,
        make: impl FnOnce() -> Option<MeshMaterials>,
    ) -> Option<MeshMaterials> {
        if let Some((_, materials)) = self.materials.borrow().get(&Arc::as_ptr(mesh)) {
            return Some(Rc::clone(materials));
        }
        let materials = make()?;
        self.materials.borrow_mut().insert(Arc::as_ptr(mesh), (Arc::clone(mesh), Rc::clone(&materials)));
        Some(materials)
    }
}
