//! Errors of meshes and their locations.

pub use crate::base::files::NO_FILE;

use crate::base::files;
use std::fmt;
use std::io;

/// Why a mesh is invalid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshError {
    /// The file with the error, if it is not the mesh's own.
    pub file: Option<String>,
    pub place: Option<MeshLocation>,
    /// What is wrong, and what would be right.
    pub why: String,
}

/// A location in a mesh file. Lines count from 1; bytes, vertices and faces count from 0 in the order of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshLocation {
    Line(u64),
    Byte(u64),
    Vertex(u64),
    Face(u64),
}

impl MeshError {
    /// An error of the whole mesh.
    pub fn new(why: impl Into<String>) -> Self {
        Self { file: None, place: None, why: why.into() }
    }

    pub fn at(place: MeshLocation, why: impl Into<String>) -> Self {
        Self { file: None, place: Some(place), why: why.into() }
    }

    /// The same error in a named file.
    pub fn in_file(self, name: &str) -> Self {
        Self { file: Some(name.to_owned()), ..self }
    }
}

impl From<io::Error> for MeshError {
    fn from(error: io::Error) -> Self {
        Self::new(files::describe(&error))
    }
}

impl fmt::Display for MeshLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(number) => write!(f, "line {number}"),
            Self::Byte(number) => write!(f, "byte {number}"),
            Self::Vertex(number) => write!(f, "vertex {number}"),
            Self::Face(number) => write!(f, "face {number}"),
        }
    }
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.file, self.place) {
            (Some(file), Some(place)) => write!(f, "{file}, {place}: {}", self.why),
            (Some(file), None) => write!(f, "{file}: {}", self.why),
            (None, Some(place)) => write!(f, "{place}: {}", self.why),
            (None, None) => f.write_str(&self.why),
        }
    }
}

impl std::error::Error for MeshError {}
