//! The parts on a turntable: what their files hold.

use super::Up;
use crate::base::files::{self, Root};
use crate::base::math::{Aabb, DVec3, UpAxis};
use crate::geometry::shape::Shape;
use crate::import::{self, LoadProgress, gltf};
use crate::sequence::{LoadError, Sequence, ShapeTracks, load_text, quoted_value};
use std::path::Path;
use std::sync::Arc;

/// A mesh file, or a glTF file.
pub struct Part {
    /// The name of the object.
    pub name: String,
    /// The path in the sequence, with `/` between folders.
    pub file: String,
    /// Whether the file holds a scene of several meshes, not one mesh.
    pub is_scene: bool,
    pub up: UpAxis,
    /// Around its vertices, with y up.
    pub bounds: Aabb,
    /// Whether the file has materials or colours.
    pub has_colors: bool,
    pub has_normals: bool,
}

impl Part {
    /// Reads what is needed to write a sequence. `folder` is the folder of the sequence if it is written.
    ///
    /// # Errors
    /// Why the file cannot be used.
    pub fn load(
        path: &Path,
        folder: Option<&Path>,
        up: Option<Up>,
        root: &Root,
        meter: &Arc<LoadProgress>,
    ) -> Result<Self, String> {
        let part = match gltf::is_gltf(path) {
            true => Self::scene(path, up, root, meter),
            false => Self::mesh(path, up, root, meter),
        }?;
        if part.bounds.is_empty() {
            return Err("it has no triangles".to_owned());
        }
        let name = path.file_stem().map_or_else(|| "part".into(), |stem| stem.to_string_lossy());
        Ok(Self { name: name.into_owned(), file: written(path, folder)?, ..part })
    }

    /// A mesh file.
    fn mesh(path: &Path, up: Option<Up>, root: &Root, meter: &LoadProgress) -> Result<Self, String> {
        let data = import::load_data(path, root, meter).map_err(|error| error.to_string())?;
        let is_stl = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("stl"));
        let up = up_axis(up, if is_stl { UpAxis::Z } else { UpAxis::Y });
        Ok(Self {
            name: String::new(),
            file: String::new(),
            is_scene: false,
            up,
            bounds: bounds_of(&data.triangles, &data.positions, |corner| up.to_y_up(corner)),
            has_colors: !data.materials.is_empty() || !data.colors.is_empty(),
            has_normals: data.normals.is_some(),
        })
    }

    /// A glTF file: its scene, without animations and lights.
    fn scene(path: &Path, up: Option<Up>, root: &Root, meter: &Arc<LoadProgress>) -> Result<Self, String> {
        let up = up_axis(up, UpAxis::Y);
        let text = format!("(objects: {{ \"part\": {} }})", scene_object(&written(path, None)?, up, ""));
        let sequence = load_text(Path::new("part.ron"), &text, root.clone(), meter);
        // What is wrong with the file alone does not name a sequence.
        let explained = |error: LoadError| match gltf::load(path, root, meter) {
            Err(own) => own.to_string(),
            Ok(_) => error.to_string(),
        };
        Ok(Self {
            name: String::new(),
            file: String::new(),
            is_scene: true,
            up,
            bounds: bounds(&sequence.map_err(explained)?),
            // Of materials, glTF files have at least their default.
            has_colors: true,
            has_normals: true,
        })
    }
}

fn up_axis(given: Option<Up>, usual: UpAxis) -> UpAxis {
    match given {
        Some(Up::Y) => UpAxis::Y,
        Some(Up::Z) => UpAxis::Z,
        None => usual,
    }
}

/// An object that shows the scene of a glTF file upright, with more fields.
pub fn scene_object(file: &str, up: UpAxis, more: &str) -> String {
    let upright = if up == UpAxis::Z { ", rotation: AxisAngle(axis: (1, 0, 0), angle: -90)" } else { "" };
    format!("(shape: Scene(file: {}, animation: Off, lights: false){upright}{more})", quoted_value(file))
}

/// Around the vertices of all visible meshes at the start.
fn bounds(sequence: &Sequence) -> Aabb {
    let start = sequence.timeline.clock(0).time;
    let visible = (0..sequence.objects.len()).filter(|&index| sequence.is_visible(index, start));
    visible.fold(Aabb::EMPTY, |bounds, index| {
        let object = &sequence.objects[index].value;
        let deformed = match &object.tracks {
            Some(ShapeTracks::Deformed(mesh)) => mesh.named(start),
            _ => None,
        };
        let mesh = match (&deformed, &object.shape) {
            (Some(mesh), _) | (None, Shape::Mesh(mesh)) => &mesh.mesh,
            _ => return bounds,
        };
        let to_world = sequence.to_world(index, start);
        let place = |corner| to_world.transform_point3(corner);
        bounds.union(bounds_of(mesh.triangles(), mesh.positions(), place))
    })
}

/// Around the corners of triangles, each at its place.
fn bounds_of(triangles: &[[u32; 3]], positions: &[DVec3], place: impl Fn(DVec3) -> DVec3) -> Aabb {
    let corners = triangles.as_flattened().iter().filter_map(|&at| positions.get(at as usize));
    Aabb::around(corners.map(|corner| place(*corner)))
}

/// A path relative to the folder of the sequence.
fn written(path: &Path, folder: Option<&Path>) -> Result<String, String> {
    let relative = match (folder, path.parent(), path.file_name()) {
        (Some(folder), Some(own), Some(name)) => {
            files::relative_path(folder, own).map_err(|error| files::describe(&error))?.join(name)
        }
        _ => path.to_owned(),
    };
    let text = relative.to_str().ok_or("its path is not UTF-8 text, as sequences need")?;
    Ok(if cfg!(windows) { text.replace('\\', "/") } else { text.to_owned() })
}
