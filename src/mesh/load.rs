//! Mesh files → [`Mesh`].

use super::{LoadMeter, Mesh, MeshError, Parts, obj, ply};
use std::fs::{self, File};
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

/// Files larger than this are refused.
const LARGEST_FILE: u64 = 8 << 30;

/// Bytes read at once.
const BLOCK: usize = 1 << 18;

/// Reads the mesh in an OBJ or PLY file, whichever its extension says.
pub fn load(path: &Path, meter: &LoadMeter) -> Result<Mesh, MeshError> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let parts = read(path, &name, meter)?;
    meter.start(format!("building the tree of {name}"), 0);
    Mesh::new(parts)
}

fn read(path: &Path, name: &str, meter: &LoadMeter) -> Result<Parts, MeshError> {
    let format = Format::of(path)?;
    let (file, size) = open(path)?;
    meter.start(format!("loading {name}"), size);
    let input = BufReader::with_capacity(BLOCK, Metered { input: file.take(size), meter });
    match format {
        Format::Ply => ply::read(input),
        Format::Obj => {
            let folder = path.parent().map_or_else(PathBuf::new, Path::to_owned);
            let mut parts = obj::read(input, &|library| fs::read(folder.join(library)))?;
            for name in parts.materials.iter_mut().filter_map(|material| material.diffuse_map.as_mut()) {
                *name = folder.join(&name).to_string_lossy().into_owned();
            }
            Ok(parts)
        }
    }
}

enum Format {
    Obj,
    Ply,
}

impl Format {
    fn of(path: &Path) -> Result<Self, MeshError> {
        match path.extension().map(|extension| extension.to_ascii_lowercase()) {
            Some(extension) if extension == "obj" => Ok(Self::Obj),
            Some(extension) if extension == "ply" => Ok(Self::Ply),
            _ => Err(MeshError::new("meshes are read from .obj and .ply files")),
        }
    }
}

/// A file with its size. What has no end, such as a device, is none.
fn open(path: &Path) -> Result<(File, u64), MeshError> {
    let what = fs::metadata(path)?;
    if !what.is_file() {
        return Err(MeshError::new(if what.is_dir() { "it is a folder" } else { "it is no file" }));
    }
    if what.len() > LARGEST_FILE {
        return Err(MeshError::new(format!("it is larger than {} GiB", LARGEST_FILE >> 30)));
    }
    Ok((File::open(path)?, what.len()))
}

/// Counts the bytes that go through it.
struct Metered<'a, R> {
    input: R,
    meter: &'a LoadMeter,
}

impl<R: Read> Read for Metered<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.input.read(buffer)?;
        self.meter.advance(read as u64);
        Ok(read)
    }
}
