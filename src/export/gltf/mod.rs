//! A sequence as a glTF 2.0 file.
//!
//! Objects become nodes with the same parents, shapes meshes, and tracks keys where glTF interpolates as they do.
//! Cameras and moving lights are sampled at every frame, in world space.

mod cameras;
mod document;
mod keys;
mod left_out;
mod lights;
mod materials;
mod meshes;
mod nodes;
#[cfg(test)]
mod tests;
mod textures;

use crate::base::math::{DAffine3, DVec3};
use crate::geometry::shape::Shape;
use crate::sequence::{LightUnit, Sequence};
use document::Document;
use left_out::LeftOut;

/// The two forms of glTF files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Container {
    /// One binary file, `.glb`.
    Binary,
    /// One text file, `.gltf`, with its data in base64.
    Text,
}

/// Settings of an export.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    pub container: Container,
    /// The largest distance between round shapes and their meshes, as a fraction of their radius: above 0, below 1.
    pub tolerance: f64,
    /// The unit of the lights.
    pub light_unit: LightUnit,
}

/// An exported file.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    pub bytes: Vec<u8>,
    pub nodes: usize,
    pub meshes: usize,
    pub triangles: usize,
    pub materials: usize,
    pub cameras: usize,
    pub lights: usize,
    /// The number of keyed properties.
    pub channels: usize,
    /// What the file does not hold, or holds approximately.
    pub left_out: Vec<String>,
}

/// Why a sequence cannot be exported.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExportError {
    /// The file would have this number of bytes; binary ones count them with 32 bits.
    TooLarge(u64),
    /// A frame in which a camera with this name is wrong, and why.
    Camera { name: String, frame: u32, why: String },
}

impl std::error::Error for ExportError {}

impl std::fmt::Display for ExportError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::TooLarge(bytes) => {
                write!(f, "the file would have {bytes} bytes, and .glb files have at most 4294967295; ")?;
                f.write_str("export as .gltf, or with a larger --tolerance")
            }
            Self::Camera { name, frame, why } => write!(f, "frame {frame} has no camera {name:?}: {why}"),
        }
    }
}

/// What the parts of an export share.
struct Exporter<'a> {
    sequence: &'a Sequence,
    options: Options,
    document: Document,
    left_out: LeftOut,
    roots: Vec<usize>,
    /// How far infinite planes reach.
    reach: f64,
}

/// The sequence as a glTF file.
///
/// # Errors
/// If a camera is wrong in any frame, or if the file would be too large.
pub fn exported(sequence: &Sequence, options: Options) -> Result<Exported, ExportError> {
    let (document, left_out) = Default::default();
    let reach = PLANE_REACH * extent(sequence);
    let mut exporter = Exporter { sequence, options, document, left_out, roots: Vec::new(), reach };
    exporter.note_environment();
    let materials = exporter.materials();
    let triangles = exporter.objects(&materials);
    exporter.lights();
    exporter.cameras()?;
    let Exporter { document, left_out, roots, .. } = exporter;
    let count = |list| document.count(list);
    let counts = [count("nodes"), count("meshes"), count("materials"), count("cameras")];
    let [nodes, meshes, materials, cameras] = counts;
    let (lights, channels) = (document.light_count(), document.channel_count());
    let bytes = match options.container {
        Container::Binary => document.binary(&sequence.name, &roots)?,
        Container::Text => document.text(&sequence.name, &roots),
    };
    let left_out = left_out.listed();
    Ok(Exported { bytes, nodes, meshes, triangles, materials, cameras, lights, channels, left_out })
}

/// How far infinite planes reach, in units of the scene's extent.
const PLANE_REACH: f64 = 50.0;

/// The largest distance from the origin of any camera or object at the start; at least 1.
fn extent(sequence: &Sequence) -> f64 {
    let start = sequence.timeline.clock(0);
    let mut farthest: f64 = 1.0;
    let mut reach = |point: DVec3| {
        if point.is_finite() {
            farthest = farthest.max(point.length());
        }
    };
    (0..sequence.cameras.len()).for_each(|index| reach(sequence.fitted_camera(index).pose(&start).position));
    for object in sequence.objects.iter().filter(|object| object.value.shape != Shape::Group) {
        let above = std::iter::successors(Some(&object.value), |object| {
            object.parent.map(|parent| &sequence.objects[parent].value)
        });
        let placed = above
            .take(sequence.objects.len())
            .fold(DAffine3::IDENTITY, |inner, object| object.transform.at(start.time) * inner);
        if let Some(bounds) = object.value.shape.bounds() {
            bounds.corners().into_iter().for_each(|corner| reach(placed.transform_point3(corner)));
        }
    }
    farthest
}

impl Exporter<'_> {
    /// The extent of the scene; at least 1.
    fn extent(&self) -> f64 {
        self.reach / PLANE_REACH
    }

    /// Notes what surrounds the objects, which glTF does not have.
    fn note_environment(&mut self) {
        let (sequence, left_out) = (self.sequence, &mut self.left_out);
        let start = sequence.timeline.clock(0).time;
        left_out.note("the background");
        if sequence.fog.is_some() {
            left_out.note("the fog");
        }
        if sequence.ambient.at(start) != crate::base::color::Rgb::ZERO {
            left_out.note("the ambient light");
        }
        if !sequence.annotations.is_empty() {
            left_out.note("the annotations");
        }
        if sequence.active_camera.active.is_keyed() {
            left_out.note("cuts between cameras");
        }
    }
}
