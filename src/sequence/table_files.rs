//! The tables that a sequence names, each read once.

use super::file_cache::FileCache;
use crate::base::files::{self, Root};
use crate::import::LoadProgress;
use crate::import::table::{Table, TableFormat};
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

pub struct TableFiles {
    files: FileCache<TableResult>,
    pub meter: Arc<LoadProgress>,
}

/// A table, or the reason why it cannot be read.
type TableResult = Result<Rc<Table>, String>;

impl TableFiles {
    pub fn new(folder: &Path, root: Root) -> Self {
        Self { files: FileCache::new(folder, root), meter: Arc::default() }
    }

    /// Reads a file, or returns the result of the first read.
    pub fn table(&self, name: &str) -> TableResult {
        TableFormat::of(Path::new(name)).map_err(|error| error.to_string())?;
        let path = self.files.admit(name).map_err(|error| files::describe(&error))?;
        self.files.get(path, (), |path, ()| {
            Table::load(path, &self.meter).map(Rc::new).map_err(|error| error.to_string())
        })
    }
}
