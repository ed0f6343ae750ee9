//! Decodes `Particles`: the rows of a table as spheres over time, or as another shape in the size of each particle.

use super::fault::Fault;
use super::fields::Fields;
use super::instances::instance_shape;
use super::node::Node;
use super::pose_columns::{ColumnName, POSITIONS, PoseColumns, TIMES, column};
use super::pose_tracks::{
    LastRow, Placement, PlacementColumns, PoseFault, TimedRows, at_row, placements, values, vectors,
};
use super::poses::table;
use super::shape::ShapeOverTime;
use super::suggest::{listed, shortened};
use super::table_columns::DataColumns;
use super::values::{each, file_path, is_number, positive, tuple};
use crate::base::math::DVec3;
use crate::geometry::shape::{ParticleRows, ParticleTracks, SameTime, Shape, Sphere};
use crate::import::table::{Table, TableError};
use std::ops::Range;
use std::sync::Arc;

/// The columns of particles.
struct Columns {
    time: Option<ColumnName>,
    id: Option<ColumnName>,
    position: [ColumnName; 3],
    radius: Radius,
}

/// The radius of all particles, or its column.
enum Radius {
    Number(f64),
    Column(ColumnName),
}

/// What particles show.
pub enum ShownParticles {
    Spheres(Arc<ParticleTracks>),
    /// Another shape, each an object of its own.
    Shapes(ShapeOverTime, Vec<Placement>),
}

/// Decodes particles from these fields.
pub fn particles(fields: &mut Fields<'_>) -> Option<ShownParticles> {
    let (mut place, mut name) = (fields.node().span(), String::new());
    let table = fields.required("file", |node| {
        place = node.span();
        name = file_path(node)?;
        table(node, &name)
    });
    let given = given_columns(fields);
    let shape = fields.optional("shape", instance_shape);
    let (table, node) = (table?, fields.node());
    let columns = columns(given, node, &table, &place)?;
    // A sphere of radius 1 in the size of a particle is what particles are without a shape.
    let unit_sphere = Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 });
    let shown = match shape?.filter(|given| given.shape != unit_sphere) {
        None => rows(&table, &columns, node).map(|tracks| ShownParticles::Spheres(Arc::new(tracks))),
        Some(shape) => scaled_placements(&table, columns, node)
            .map(|placements| ShownParticles::Shapes(shape, placements)),
    };
    match shown {
        Ok(shown) => Some(shown),
        Err((place, error)) => {
            let title = format!("cannot use the particles in {:?}", shortened(&name));
            node.fault(Fault::new(place, title, error.to_string()));
            None
        }
    }
}

/// The columns that the file names.
struct GivenColumns {
    time: Option<Option<ColumnName>>,
    id: Option<Option<ColumnName>>,
    position: Option<Option<[ColumnName; 3]>>,
    radius: Option<Option<Radius>>,
}

/// Reads the names of columns.
fn given_columns(fields: &mut Fields<'_>) -> GivenColumns {
    let time = fields.optional("time", column);
    let id = fields.optional("id", column);
    let position = fields.optional("position", |node| each(tuple(node, "three names of columns")?, column));
    let radius = fields.optional("radius", |node| match is_number(node) {
        true => positive(node).map(Radius::Number),
        false => column(node).map(Radius::Column),
    });
    GivenColumns { time, id, position, radius }
}

/// All columns. Those that the file does not name have their usual names.
fn columns(given: GivenColumns, node: Node<'_>, table: &Table, place: &Range<usize>) -> Option<Columns> {
    let usual = |name: &str| ColumnName { name: name.to_owned(), place: place.clone() };
    let known = |names: &[&str]| names.iter().find(|name| table.has(name)).map(|name| usual(name));
    let (time, id, position, radius) = (given.time?, given.id?, given.position?, given.radius?);
    let missing = |what: &str, write: &str| {
        let fault = Fault::new(place.clone(), "this table has no particles that Kinora recognises", what);
        let names = listed(table.names());
        node.fault(fault.help(format!("its columns are {names}; write {write}")));
    };
    let all = |names: &&[&str; 3]| names.iter().all(|name| table.has(name));
    let position = position.or_else(|| POSITIONS.iter().find(all).map(|names| names.map(usual)));
    let Some(position) = position else {
        missing("no columns `x`, `y`, `z`", "`position: (\"name\", ...)`");
        return None;
    };
    let Some(radius) = radius.or_else(|| known(&["radius", "r"]).map(Radius::Column)) else {
        missing("no column `radius`", "`radius: 0.1`, or the name of a column");
        return None;
    };
    let (time, id) = (time.or_else(|| known(&TIMES)), id.or_else(|| known(&["id"])));
    Some(Columns { time, id, position, radius })
}

fn rows(table: &Table, columns: &Columns, node: Node<'_>) -> Result<ParticleTracks, PoseFault> {
    let centers = vectors(table, &columns.position)?;
    let radii = radii(table, &columns.radius)?;
    let spheres = centers.into_iter().zip(radii).map(|(center, radius)| Sphere { center, radius }).collect();
    let timed = TimedRows::of(table, columns.time.as_ref(), node.file.clock.get())?;
    let DataColumns { numbers, unusable } = DataColumns::of(table);
    let mut rows = ParticleRows { spheres, columns: numbers, unusable, ..ParticleRows::default() };
    if timed.times.len() > 1 {
        let id = columns.id.as_ref();
        let ids = TimedRows::ids(table, columns.time.as_ref(), id)?;
        (rows.times, rows.time_of, rows.id_of) = (timed.times, timed.of_row, ids.to_vec());
        return ParticleTracks::new(rows)
            .map_err(|SameTime(first, second)| TimedRows::same_time(table, id, ids, [first, second]));
    }
    // Particles without times are not compared with each other.
    ParticleTracks::new(rows).map_err(|_| (node.span(), TableError::new("two rows are one particle")))
}

/// Where each particle is, in the size of its radius.
fn scaled_placements(table: &Table, columns: Columns, node: Node<'_>) -> Result<Vec<Placement>, PoseFault> {
    let Columns { time, id, position, radius } = columns;
    let scales = radii(table, &radius)?.into_iter().map(DVec3::splat).collect();
    let poses = &PoseColumns { time, position: Some(position), rotation: None };
    let placed = PlacementColumns { poses, id: id.as_ref(), scales, last_row: LastRow::Ends };
    placements(table, placed, node.file.clock.get())
}

fn radii(table: &Table, radius: &Radius) -> Result<Vec<f64>, PoseFault> {
    let name = match radius {
        Radius::Number(radius) => return Ok(vec![*radius; table.rows()]),
        Radius::Column(name) => name,
    };
    let radii = values(table, name)?;
    let wrong = |radius: &f64| !(*radius == 0.0 || (1e-30..=1e30).contains(radius));
    match radii.iter().position(wrong) {
        Some(row) => {
            let why = format!("expected a radius of 0, or from 1e-30 to 1e30, found {}", radii[row]);
            Err(at_row(table, row, name, why))
        }
        None => Ok(radii.to_vec()),
    }
}
