//! The parts on a turntable: what their files hold.

use super::Up;
use crate::base::files::{self, Root};
use crate::base::math::{Aabb, UpAxis};
use crate::import::{self, LoadProgress};
use std::path::Path;

/// A mesh file.
pub struct Part {
    /// The name of the object.
    pub name: String,
    /// The path in the sequence, with `/` between folders.
    pub file: String,
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
        meter: &LoadProgress,
    ) -> Result<Self, String> {
        let data = import::load_data(path, root, meter).map_err(|error| error.to_string())?;
        let is_stl = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("stl"));
        let up = match up {
            Some(Up::Y) => UpAxis::Y,
            Some(Up::Z) => UpAxis::Z,
            None => {
                if is_stl {
                    UpAxis::Z
                } else {
                    UpAxis::Y
                }
            }
        };
        let used =
            data.triangles.as_flattened().iter().filter_map(|&vertex| data.positions.get(vertex as usize));
        let bounds = Aabb::around(used.map(|position| up.to_y_up(*position)));
        if bounds.is_empty() {
            return Err("it has no triangles".to_owned());
        }
        let name = path.file_stem().map_or_else(|| "part".into(), |stem| stem.to_string_lossy());
        Ok(Self {
            name: name.into_owned(),
            file: written(path, folder)?,
            up,
            bounds,
            has_colors: !data.materials.is_empty() || !data.colors.is_empty(),
            has_normals: data.normals.is_some(),
        })
    }
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
