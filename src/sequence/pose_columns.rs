//! Which columns of a table hold poses: named by the file, or found by their usual names.

use super::fault::Fault;
use super::fields::Fields;
use super::node::Node;
use super::suggest::listed;
use super::values::{each, list, text, tuple};
use super::words::{Variants, variant, word};
use crate::import::table::{Table, TableError};
use std::ops::Range;

/// A column, and where the file names it.
#[derive(Clone)]
pub struct ColumnName {
    pub name: String,
    pub place: Range<usize>,
}

/// The columns of orientations.
pub enum RotationColumns {
    /// w, x, y and z.
    Quaternion([ColumnName; 4]),
    Matrix {
        columns: Vec<ColumnName>,
        order: MatrixOrder,
    },
}

/// The order of the columns of a matrix for column vectors, whose translation is its last column.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum MatrixOrder {
    /// One row after the other.
    Row,
    /// One column after the other. This is also the order of a matrix for row vectors, one row after the other.
    Column,
}

/// The columns of poses.
pub struct PoseColumns {
    pub time: Option<ColumnName>,
    pub position: Option<[ColumnName; 3]>,
    pub rotation: Option<RotationColumns>,
}

/// The numbers of columns of matrices: rotations, and affine maps without and with the last row.
const MATRIX_SIZES: [usize; 3] = [9, 12, 16];

/// Usual names, in the order in which they are looked for.
pub const TIMES: [&str; 2] = ["t", "time"];
pub const POSITIONS: [[&str; 3]; 3] = [["x", "y", "z"], ["px", "py", "pz"], ["tx", "ty", "tz"]];
const QUATERNION: [&str; 4] = ["qw", "qx", "qy", "qz"];

/// Row after row.
const MATRIX: [&str; 16] = [
    "m00", "m01", "m02", "m03", "m10", "m11", "m12", "m13", "m20", "m21", "m22", "m23", "m30", "m31", "m32",
    "m33",
];

impl RotationColumns {
    /// Whether the columns hold a translation, too.
    fn translate(&self) -> bool {
        matches!(self, Self::Matrix { columns, .. } if columns.len() > 9)
    }
}

impl ColumnName {
    pub fn values<'t>(&self, table: &'t Table) -> Result<&'t [f64], TableError> {
        table.column(&self.name)
    }
}

/// The columns that the file names. Of each None if it is wrong and reported.
pub struct GivenColumns {
    time: Option<Option<ColumnName>>,
    position: Option<Option<[ColumnName; 3]>>,
    rotation: Option<Option<RotationColumns>>,
}

/// Reads the names of columns.
pub fn given_columns(fields: &mut Fields<'_>) -> GivenColumns {
    let time = fields.optional("time", column);
    let position = fields.optional("position", |node| each(tuple(node, "three names of columns")?, column));
    let rotation = fields.optional("rotation", rotation);
    GivenColumns { time, position, rotation }
}

/// [`columns`], with a column of times.
pub fn timed_columns(
    given: GivenColumns,
    fields: &Fields<'_>,
    table: &Table,
    place: &Range<usize>,
) -> Option<(ColumnName, PoseColumns)> {
    let columns = all_columns(given, fields, (table, place), true)?;
    Some((columns.time.clone()?, columns))
}

/// All columns. Those that the file does not name have their usual names.
pub fn columns(
    given: GivenColumns,
    fields: &Fields<'_>,
    table: &Table,
    place: &Range<usize>,
) -> Option<PoseColumns> {
    all_columns(given, fields, (table, place), false)
}

/// [`columns`]. `is_timed` states whether there must be a column of times.
fn all_columns(
    given: GivenColumns,
    fields: &Fields<'_>,
    (table, place): (&Table, &Range<usize>),
    is_timed: bool,
) -> Option<PoseColumns> {
    let usual = |name: &str| ColumnName { name: name.to_owned(), place: place.clone() };
    let (time, position, rotation) = (given.time?, given.position?, given.rotation?);
    if position.is_some() && rotation.as_ref().is_some_and(RotationColumns::translate) {
        let title = "a matrix of 12 or 16 columns holds the position";
        fields.node().fault(Fault::new(fields.place("position"), title, "one too many"));
        return None;
    }
    let has_all = |names: &[&str]| names.iter().all(|name| table.has(name));
    let time = time.or_else(|| TIMES.into_iter().find(|name| table.has(name)).map(usual));
    if is_timed && time.is_none() {
        report_missing(fields, table, place, "no column of times `t` or `time`", "`time: \"name\"`");
        return None;
    }
    let rotation = rotation.or_else(|| {
        if has_all(&QUATERNION) {
            return Some(RotationColumns::Quaternion(QUATERNION.map(usual)));
        }
        let all = position.is_none() && has_all(&MATRIX);
        all.then(|| RotationColumns::Matrix { columns: MATRIX.map(usual).into(), order: MatrixOrder::Row })
    });
    let translates = rotation.as_ref().is_some_and(RotationColumns::translate);
    let position = position.or_else(|| {
        let known = POSITIONS.into_iter().find(|names| has_all(names)).filter(|_| !translates)?;
        Some(known.map(usual))
    });
    let of_positions = POSITIONS.iter().filter(|_| position.is_none() && !translates).map(|names| &names[..]);
    let of_rotations = [&QUATERNION[..], &MATRIX[..]].into_iter().filter(|_| rotation.is_none());
    if let Some(names) = of_positions.chain(of_rotations).find(|names| is_incomplete(table, names)) {
        report_incomplete(fields, table, place, names);
        return None;
    }
    if position.is_none() && rotation.is_none() {
        let what = "no columns `x`, `y`, `z`, no `qw`, `qx`, `qy`, `qz`, and no `m00` to `m33`";
        report_missing(fields, table, place, what, "`position: (\"name\", ...)` and `rotation`");
        return None;
    }
    Some(PoseColumns { time, position, rotation })
}

/// Whether a table has several columns of a set, but not all.
fn is_incomplete(table: &Table, names: &[&str]) -> bool {
    (2..names.len()).contains(&names.iter().filter(|name| table.has(name)).count())
}

fn report_incomplete(fields: &Fields<'_>, table: &Table, place: &Range<usize>, names: &[&str]) {
    let missing = listed(names.iter().copied().filter(|name| !table.has(name)));
    let there = listed(names.iter().copied().filter(|name| table.has(name)));
    let what = format!("it has {there}, but not {missing}");
    let fault = Fault::new(place.clone(), "this table has only some of the columns of poses", what);
    let help =
        "name the columns in Poses(file: ...) with `position` or `rotation`, or rename those of the table";
    fields.node().fault(fault.help(help));
}

fn report_missing(fields: &Fields<'_>, table: &Table, place: &Range<usize>, what: &str, write: &str) {
    let names = listed(table.names());
    let usual = || TIMES.iter().chain(POSITIONS.as_flattened()).chain(&QUATERNION).chain(&MATRIX);
    let in_capitals = |name: &&str| usual().any(|known| name != known && name.eq_ignore_ascii_case(known));
    let hint = match table.names().find(in_capitals) {
        Some(name) => format!(" (capitals matter: `{name}` is not `{}`)", name.to_lowercase()),
        None => String::new(),
    };
    let help = format!("its columns are {names}{hint}; write Poses(file: ...) with {write}");
    let fault = Fault::new(place.clone(), "this table has no poses that Kinora recognises", what);
    fields.node().fault(fault.help(help));
}

pub fn column(node: Node<'_>) -> Option<ColumnName> {
    text(node).map(|name| ColumnName { name, place: node.span() })
}

fn rotation(node: Node<'_>) -> Option<RotationColumns> {
    let table: &Variants<'_, RotationColumns> = &[("Quaternion", quaternion), ("Matrix", matrix)];
    variant(node, "rotation of poses", table)
}

fn quaternion(node: Node<'_>) -> Option<RotationColumns> {
    let mut fields = Fields::of(node, "`Quaternion`")?;
    let names = ["w", "x", "y", "z"].map(|name| fields.required(name, column));
    fields.finish();
    let [w, x, y, z] = names;
    Some(RotationColumns::Quaternion([w?, x?, y?, z?]))
}

fn matrix(node: Node<'_>) -> Option<RotationColumns> {
    let mut fields = Fields::of(node, "`Matrix`")?;
    let columns = fields.required("columns", |node| {
        let columns = list(node, "names of columns", column)?;
        if MATRIX_SIZES.contains(&columns.len()) {
            return Some(columns);
        }
        let fault = Fault::expected(node.span(), "9, 12 or 16 names", format!("found {}", columns.len()));
        node.fault(fault.help("a rotation has 9, an affine map 12, or 16 with its last row or column"));
        None
    });
    let orders = [("Row", MatrixOrder::Row), ("Column", MatrixOrder::Column)];
    let order = fields.required("order", |node| word(node, "order", &orders));
    fields.finish();
    Some(RotationColumns::Matrix { columns: columns?, order: order? })
}
