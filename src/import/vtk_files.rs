//! The VTK files of a mesh: one, those of its parts, or lists of these.

use super::load::{MAX_FILE_SIZE, MeteredRead, name};
use super::{LoadProgress, vtk};
use crate::base::escape;
use crate::base::files::{self, Root};
use crate::base::machine;
use crate::geometry::mesh::{MeshData, MeshError};
use std::io::Read;
use std::path::{Path, PathBuf};

/// What a file with VTK's extension holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VtkKind {
    Mesh,
    /// The names of the files of a mesh's parts.
    List,
}

impl VtkKind {
    /// The kind of files with this extension.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_ascii_lowercase();
        match extension.to_str()? {
            "vtk" | "vtp" | "vtu" => Some(Self::Mesh),
            "pvtp" | "pvtu" => Some(Self::List),
            _ => None,
        }
    }
}

/// Reads the mesh whose parts lie in these files. Errors name the file if it is not the only one.
pub fn read(paths: &[PathBuf], root: &Root, meter: &LoadProgress) -> Result<MeshData, MeshError> {
    let mut files = VtkFiles { root, meter, parts: vtk::PartReader::default() };
    match paths {
        [path] => files.add(path)?,
        _ => paths.iter().try_for_each(|path| {
            files.add(path).map_err(|error| error.in_file(&escape::quoted(&name(path))))
        })?,
    }
    files.parts.finish()
}

struct VtkFiles<'a> {
    root: &'a Root,
    meter: &'a LoadProgress,
    parts: vtk::PartReader,
}

impl VtkFiles<'_> {
    fn add(&mut self, path: &Path) -> Result<(), MeshError> {
        match VtkKind::of(path) {
            Some(VtkKind::Mesh) => self.parts.add(&self.bytes(path)?),
            Some(VtkKind::List) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                vtk::pieces(&self.bytes(path)?)?.iter().try_for_each(|piece| {
                    self.add_piece(&folder.join(piece)).map_err(|error| error.in_file(&escape::quoted(piece)))
                })
            }
            None => {
                Err(MeshError::new("parts of a mesh are read from .vtk, .vtp, .vtu, .pvtp and .pvtu files"))
            }
        }
    }

    /// Adds a file of a list, which names no further list: that could go round in circles.
    fn add_piece(&mut self, path: &Path) -> Result<(), MeshError> {
        match VtkKind::of(path) {
            Some(VtkKind::Mesh) => self.parts.add(&self.bytes(&self.root.admit(path)?)?),
            _ => Err(MeshError::new("the parts of a list are .vtk, .vtp or .vtu files")),
        }
    }

    fn bytes(&self, path: &Path) -> Result<Vec<u8>, MeshError> {
        let (file, size) = files::open(path, MAX_FILE_SIZE)?;
        // The mesh in memory takes about as much as the file, or more.
        machine::check_memory(size)?;
        self.meter.start(format!("loading {}", name(path)), size);
        let mut bytes = Vec::with_capacity(size as usize);
        MeteredRead { input: file.take(size), meter: self.meter }.read_to_end(&mut bytes)?;
        Ok(bytes)
    }
}
