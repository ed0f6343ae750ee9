//! Mesh files → [`TriangleMesh`].

use super::vtk_files::{self, VtkKind};
use super::{LoadProgress, obj, ply, stl};
use crate::base::escape;
use crate::base::files::{self, Root};
use crate::base::machine;
use crate::geometry::mesh::{MeshData, MeshError, Preparation, TriangleMesh};
use std::cell::RefCell;
use std::collections::HashSet;
use std::ffi::OsStr;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

/// The maximum size of a mesh file in bytes.
pub(super) const MAX_FILE_SIZE: u64 = 8 << 30;

/// The maximum size of a material library in bytes. Libraries are text without geometry.
const MAX_LIBRARY_SIZE: u64 = 64 << 20;

/// The minimum memory per triangle in bytes after the file is read: for packets, for the tree and for building the
/// tree.
const TRIANGLE_SIZE: u64 = 128;

/// The memory per triangle and per vertex in bytes that crease normals take while they are made: normals, edges, fans,
/// sums and indices; and the equal vertices.
const CREASE_SIZES: [u64; 2] = [216, 56];

/// The size of the read buffer in bytes.
const BUFFER_SIZE: usize = 1 << 18;

/// Checks that meshes can be read from files with this extension.
pub fn known_format(path: &Path) -> Result<(), MeshError> {
    Format::of(path).map(|_| ())
}

/// Reads the mesh in an OBJ, PLY, STL or VTK file, by its extension. Its material libraries must be in `root`.
pub fn load(path: &Path, root: &Root, meter: &LoadProgress) -> Result<TriangleMesh, MeshError> {
    load_prepared(path, root, meter, &Preparation::default())
}

/// Reads the data of a mesh without building its tree. Everything is as for [`load`].
pub fn load_data(path: &Path, root: &Root, meter: &LoadProgress) -> Result<MeshData, MeshError> {
    read(path, root, &name(path), meter)
}

/// [`load_data`] of a mesh that lies in one or several files. Several must be VTK files.
pub fn load_parts(paths: &[PathBuf], root: &Root, meter: &LoadProgress) -> Result<MeshData, MeshError> {
    match paths {
        [path] => load_data(path, root, meter),
        _ => vtk_files::read(paths, root, meter),
    }
}

/// The name of a file for messages.
pub(super) fn name(path: &Path) -> String {
    escape::path(path.file_name().unwrap_or(path.as_os_str()))
}

/// [`load`], with other axes, another origin or unit, or crease normals.
pub fn load_prepared(
    path: &Path,
    root: &Root,
    meter: &LoadProgress,
    preparation: &Preparation,
) -> Result<TriangleMesh, MeshError> {
    let name = name(path);
    let mut parts = load_data(path, root, meter)?;
    if preparation.crease.is_some() {
        let [of_triangle, of_vertex] = CREASE_SIZES;
        machine::check_memory(
            parts.triangles.len() as u64 * of_triangle + parts.positions.len() as u64 * of_vertex,
        )?;
    }
    preparation.apply(&mut parts);
    meter.start(format!("building the tree of {name}"), 0);
    build(parts, None)
}

/// Builds a mesh if there is enough memory: [`TriangleMesh::after`] the mesh `before`, or a new one.
pub(super) fn build(parts: MeshData, before: Option<&TriangleMesh>) -> Result<TriangleMesh, MeshError> {
    machine::check_memory(parts.triangles.len() as u64 * TRIANGLE_SIZE)?;
    TriangleMesh::after(parts, before)
}

fn read(path: &Path, root: &Root, name: &str, meter: &LoadProgress) -> Result<MeshData, MeshError> {
    let open = || -> Result<_, MeshError> {
        let (file, size) = files::open(path, MAX_FILE_SIZE)?;
        // The mesh in memory takes about as much as the file, or more.
        machine::check_memory(size)?;
        meter.start(format!("loading {name}"), size);
        let input = MeteredRead { input: file.take(size), meter };
        Ok((BufReader::with_capacity(BUFFER_SIZE, input), size))
    };
    match Format::of(path)? {
        Format::Ply => open().and_then(|(input, size)| ply::read_sized(input, size)),
        Format::Stl => open().and_then(|(input, size)| stl::read(input, size)),
        Format::Obj => {
            let (input, _) = open()?;
            let folder = path.parent().unwrap_or(Path::new(""));
            let libraries = Libraries { folder, root, read: RefCell::default() };
            let mut parts = obj::read(input, &|library| libraries.read(library))?;
            for (_, map) in parts.materials.iter_mut().flat_map(|material| &mut material.maps) {
                map.file = folder.join(&map.file).to_string_lossy().into_owned();
            }
            Ok(parts)
        }
        Format::Vtk => vtk_files::read(&[path.to_owned()], root, meter),
    }
}

enum Format {
    Obj,
    Ply,
    Stl,
    Vtk,
}

impl Format {
    fn of(path: &Path) -> Result<Self, MeshError> {
        match path.extension().map(|extension| extension.to_ascii_lowercase()) {
            Some(extension) if extension == "obj" => Ok(Self::Obj),
            Some(extension) if extension == "ply" => Ok(Self::Ply),
            Some(extension) if extension == "stl" => Ok(Self::Stl),
            _ if VtkKind::of(path).is_some() => Ok(Self::Vtk),
            extension => {
                let meshes = "meshes are read from .obj, .ply, .stl, .vtk, .vtp, .vtu, .pvtp and .pvtu files";
                let hint = match extension.as_deref().and_then(OsStr::to_str) {
                    Some("glb" | "gltf") => "; `Scene(\"...\")` shows the scene of a glTF file",
                    Some("pvd") => "; `Mesh(series: \"...\")` shows the meshes that a .pvd file lists",
                    _ => "",
                };
                Err(MeshError::new(format!("{meshes}{hint}")))
            }
        }
    }
}

/// The material libraries of a mesh, relative to its folder. Each is read once.
struct Libraries<'a> {
    folder: &'a Path,
    root: &'a Root,
    read: RefCell<HashSet<PathBuf>>,
}

impl Libraries<'_> {
    /// The bytes of a library; empty if it was read before, under any name.
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let path = self.root.admit(&self.folder.join(name))?;
        if self.read.borrow().contains(&path) {
            return Ok(Vec::new());
        }
        let bytes = files::read(&path, MAX_LIBRARY_SIZE)?;
        self.read.borrow_mut().insert(path);
        Ok(bytes)
    }
}

/// Counts the bytes that are read through it.
pub(super) struct MeteredRead<'a, R> {
    pub input: R,
    pub meter: &'a LoadProgress,
}

impl<R: Read> Read for MeteredRead<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.input.read(buffer)?;
        self.meter.advance(read as u64);
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::generate;
    use std::fs;

    #[test]
    fn libraries_are_read_once_under_all_their_names() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("a.mtl"), "newmtl a").expect("a disk");
        let libraries =
            Libraries { folder: folder.path(), root: &Root::anywhere(), read: RefCell::default() };
        let again = ["a.mtl", "a.mtl", "./a.mtl"].map(|name| libraries.read(name).expect("a library").len());
        assert_eq!(again, [8, 0, 0]);
        assert_eq!(libraries.read("b.mtl").expect_err("no file").kind(), io::ErrorKind::NotFound);
    }

    #[test]
    fn the_extension_names_the_format() {
        let meter = LoadProgress::default();
        let fault =
            |name: &str| load(name.as_ref(), &Root::anywhere(), &meter).expect_err("a fault").to_string();
        assert_eq!(
            fault("mesh.3ds"),
            "meshes are read from .obj, .ply, .stl, .vtk, .vtp, .vtu, .pvtp and .pvtu files"
        );
        assert_eq!(fault("no/such/file.obj"), "there is no such file");
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("SPHERE.PLY");
        let parts = generate::icosphere(1);
        ply::write(std::fs::File::create(&path).expect("a file"), &parts).expect("a disk");
        let mesh = load(&path, &Root::anywhere(), &meter).expect("a mesh");
        assert_eq!(mesh.triangles(), parts.triangles);
        assert_eq!(meter.what(), "building the tree of SPHERE.PLY");
        assert_eq!(meter.bytes(), None);
    }
}
