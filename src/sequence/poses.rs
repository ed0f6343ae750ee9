//! Decodes `poses`: positions and orientations from a table, for objects and cameras.

use super::easing::ease;
use super::fault::Fault;
use super::fields::Fields;
use super::keys::repeat;
use super::node::Node;
use super::pose_columns::{given_columns, timed_columns};
use super::pose_tracks::{Interpolation, PoseTracks, tracks};
use super::suggest::shortened;
use super::values::{PATHS, file_path};
use super::words::word;
use crate::base::math::{DQuat, UpAxis};
use crate::camera::path::PosePath;
use crate::geometry::mesh::NO_FILE;
use crate::geometry::transform::{Rotation, TransformTracks};
use crate::import::table::Table;
use crate::track::{Animate, Animated, Ease, Key, Repeat};
use std::rc::Rc;

/// Which way a camera looks in its own axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ViewAxes {
    /// Along -z, with y up.
    OpenGl,
    /// Along z, with y down.
    OpenCv,
}

/// The poses of an object: a file's name, or `Poses(...)`.
pub fn object_poses(node: Node<'_>) -> Option<PoseTracks> {
    poses(node, true, |_| Some(())).map(|(tracks, ())| tracks)
}

/// The transform of an object with poses. Its other fields apply before.
pub fn posed(poses: PoseTracks, given: TransformTracks) -> TransformTracks {
    let scale = poses.scale.unwrap_or(given.scale);
    let rotation = Rotation::Quaternion(poses.rotation);
    TransformTracks { translation: poses.position, rotation, scale, ..given }
}

/// The poses of a camera.
pub fn camera_poses(node: Node<'_>) -> Option<PosePath> {
    let axes = [("OpenGl", ViewAxes::OpenGl), ("OpenCv", ViewAxes::OpenCv)];
    let axes =
        |fields: &mut Fields<'_>| fields.or("axes", |node| word(node, "axes", &axes), ViewAxes::OpenGl);
    let (tracks, axes) = poses(node, false, axes)?;
    let up = node.file.up.get();
    // Half a turn about x.
    let view = if axes == ViewAxes::OpenCv { DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0) } else { DQuat::IDENTITY };
    let world = if up == UpAxis::Z { DQuat::from_mat3(&up.matrix()) } else { DQuat::IDENTITY };
    let rotation = mapped(tracks.rotation, |rotation| world * rotation * view);
    Some(PosePath { position: mapped(tracks.position, |position| up.to_y_up(position)), rotation })
}

/// The same track with other values.
fn mapped<T: Animate>(track: Animated<T>, change: impl Fn(T) -> T) -> Animated<T> {
    match track {
        Animated::Constant(value) => Animated::Constant(change(value)),
        Animated::Keyed(track) => {
            let changed = |Key { time, value, ease }| Key { time, value: change(value), ease };
            Animated::Keyed(track.map(changed))
        }
    }
}

/// Decodes poses, and the fields that only this kind of poses has.
fn poses<'s, T>(
    node: Node<'s>,
    may_scale: bool,
    more: impl Fn(&mut Fields<'s>) -> Option<T>,
) -> Option<(PoseTracks, T)> {
    if !node.begins_with("Poses") && !node.is_text() {
        node.expected("the name of a table in quotes, or Poses(file: \"name.csv\", ...)");
        return None;
    }
    // The text alone stands for all fields with their defaults.
    let mut fields = if node.is_text() {
        Fields::only(node, "`Poses`", "file")
    } else {
        Fields::of_or_only(node, "`Poses`", "file")?
    };
    let mut place = node.span();
    let mut name = String::new();
    let table = fields.required("file", |node| {
        place = node.span();
        name = file_path(node)?;
        table(node, &name)
    });
    let ease = fields.or("ease", ease, Ease::Linear);
    let repeat = fields.or("repeat", repeat, Repeat::Hold);
    let more = more(&mut fields);
    let given = given_columns(&mut fields);
    let columns = table.as_ref().and_then(|table| timed_columns(given, &fields, table, &place));
    fields.finish();
    let table = table?;
    let ((time, columns), how) = (columns?, Interpolation { ease: ease?, repeat: repeat? });
    match tracks(&table, (&time, &columns), how, node.file.clock.get(), may_scale) {
        Ok(tracks) => Some((tracks, more?)),
        Err((place, error)) => {
            let title = format!("cannot use the poses in {:?}", shortened(&name));
            node.fault(Fault::new(place, title, error.to_string()));
            None
        }
    }
}

/// The table in the file with the quoted name.
pub fn table(node: Node<'_>, name: &str) -> Option<Rc<Table>> {
    match node.file.tables.table(name) {
        Ok(table) => Some(table),
        Err(why) => {
            let missing = why == NO_FILE;
            let fault = Fault::new(node.span(), format!("cannot read the table {:?}", shortened(name)), why);
            node.fault(if missing { fault.help(PATHS) } else { fault });
            None
        }
    }
}
