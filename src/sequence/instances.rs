//! Decodes `Instances`: one shape, or a group of objects, at many places.

use super::fault::Fault;
use super::fields::Fields;
use super::node::Node;
use super::pose_columns::{ColumnName, PoseColumns, column, columns, given_columns};
use super::pose_tracks::{LastRow, Placement, PlacementColumns, PoseFault, at_row, placements, values};
use super::poses::table;
use super::shape::{ShapeOverTime, shape};
use super::suggest::shortened;
use super::values::{LARGEST, SHORTEST, each, file_path, is_number, number, tuple};
use crate::base::math::DVec3;
use crate::geometry::shape::Shape;
use crate::import::table::Table;

/// What instances show, and where they are over time.
pub struct Instances<'n> {
    pub shown: Shown<'n>,
    pub placements: Vec<Placement>,
}

/// What every instance shows.
pub enum Shown<'n> {
    Shape(ShapeOverTime),
    /// The object of this name, and all below it.
    Object(Node<'n>),
}

/// The scale of all instances, or its columns.
enum Scale {
    Number(f64),
    Even(ColumnName),
    Axes([ColumnName; 3]),
}

/// Decodes instances.
pub fn instances(node: Node<'_>) -> Option<Instances<'_>> {
    let mut fields = Fields::of(node, "`Instances`")?;
    let shown = match fields.has("of") {
        true => shown_object(&mut fields),
        false => fields.required("shape", instance_shape).map(Shown::Shape),
    };
    let (mut place, mut name) = (node.span(), String::new());
    let table = fields.required("file", |node| {
        place = node.span();
        name = file_path(node)?;
        table(node, &name)
    });
    let id = fields.optional("id", column);
    let scale = fields.optional("scale", scale);
    let given = given_columns(&mut fields);
    let poses = table.as_ref().and_then(|table| columns(given, &fields, table, &place));
    fields.finish();
    let table = table?;
    let (id, poses) = (id?, poses?);
    let usual = |name: &str| ColumnName { name: name.to_owned(), place: place.clone() };
    let known = |name: &str| table.has(name).then(|| usual(name));
    let scale = scale?.or_else(|| known("scale").map(Scale::Even)).unwrap_or(Scale::Number(1.0));
    match placed(&table, &poses, id.or_else(|| known("id")), &scale, node) {
        Ok(placements) => Some(Instances { shown: shown?, placements }),
        Err((place, error)) => {
            let title = format!("cannot use the instances in {:?}", shortened(&name));
            node.fault(Fault::new(place, title, error.to_string()));
            None
        }
    }
}

/// The name of the object that all instances show.
fn shown_object<'n>(fields: &mut Fields<'n>) -> Option<Shown<'n>> {
    let of = fields.required("of", |node| {
        if !node.is_text() {
            node.expected("the name of an object in quotes");
            return None;
        }
        Some(node)
    });
    if fields.is_given("shape") {
        let title = "instances show a `shape`, or the object of a name: `of`";
        fields.node().fault(Fault::new(fields.place("shape"), title, "one too many"));
        fields.ignore("shape");
        return None;
    }
    of.map(Shown::Object)
}

/// The shape of all instances, which is visible.
pub fn instance_shape(node: Node<'_>) -> Option<ShapeOverTime> {
    let decoded = shape(node)?;
    if decoded.shape == Shape::Group {
        node.fault(Fault::new(node.span(), "instances need a visible shape", "this one is invisible"));
        return None;
    }
    Some(decoded)
}

/// A factor above 0, a column of factors, or a column for each axis.
fn scale(node: Node<'_>) -> Option<Scale> {
    if is_number(node) {
        let factor = number(node)?;
        if !is_factor(factor) {
            node.expected("a factor that is not 0");
            return None;
        }
        return Some(Scale::Number(factor));
    }
    if node.is_text() {
        return column(node).map(Scale::Even);
    }
    let what = "a factor, the name of a column in quotes, or three names (x, y, z)";
    each(tuple(node, what)?, column).map(Scale::Axes)
}

fn is_factor(factor: f64) -> bool {
    (SHORTEST..=LARGEST).contains(&factor.abs())
}

fn placed(
    table: &Table,
    poses: &PoseColumns,
    id: Option<ColumnName>,
    scale: &Scale,
    node: Node<'_>,
) -> Result<Vec<Placement>, PoseFault> {
    let scales = match scale {
        Scale::Number(factor) => vec![DVec3::splat(*factor); table.rows()],
        Scale::Even(name) => factors(table, name)?.iter().map(|factor| DVec3::splat(*factor)).collect(),
        Scale::Axes([x, y, z]) => {
            let (x, y, z) = (factors(table, x)?, factors(table, y)?, factors(table, z)?);
            (0..table.rows()).map(|row| DVec3::new(x[row], y[row], z[row])).collect()
        }
    };
    let last_row = LastRow::HoldsUntilNext;
    placements(table, PlacementColumns { poses, id: id.as_ref(), scales, last_row }, node.file.clock.get())
}

/// A column of factors.
fn factors<'t>(table: &'t Table, name: &ColumnName) -> Result<&'t [f64], PoseFault> {
    let factors = values(table, name)?;
    match factors.iter().position(|factor| !is_factor(*factor)) {
        Some(row) => {
            let why = format!("expected a factor from 1e-30 to 1e30, found {}", factors[row]);
            Err(at_row(table, row, name, why))
        }
        None => Ok(factors),
    }
}
