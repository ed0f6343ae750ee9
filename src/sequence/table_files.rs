//! The tables that a sequence names, each read once.

use crate::base::files::{self, Root};
use crate::import::LoadProgress;
use crate::import::table::{Table, TableFormat};
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// The tables read so far.
pub struct TableFiles {
    folder: PathBuf,
    root: Root,
    pub meter: Arc<LoadProgress>,
    read: RefCell<HashMap<PathBuf, TableResult>>,
}

/// A table, or the reason why it cannot be read.
type TableResult = Result<Rc<Table>, String>;

impl TableFiles {
    pub fn new(folder: &Path, root: Root) -> Self {
        Self { folder: folder.to_owned(), root, meter: Arc::default(), read: RefCell::default() }
    }

    /// Reads a file, or returns the result of the first read.
    pub fn table(&self, name: &str) -> TableResult {
        TableFormat::of(Path::new(name)).map_err(|error| error.to_string())?;
        let path = self.root.admit(&self.folder.join(name)).map_err(|error| files::describe(&error))?;
        let mut read = self.read.borrow_mut();
        let table = read.entry(path).or_insert_with_key(|path| {
            Table::load(path, &self.meter).map(Rc::new).map_err(|error| error.to_string())
        });
        table.clone()
    }
}
