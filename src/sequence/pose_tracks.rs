//! Rows of a table as keys of positions, rotations and scales.

use super::key_clock::KeyClock;
use super::keys::row_time;
use super::pose_columns::{ColumnName, MatrixOrder, PoseColumns, RotationColumns};
use super::table_columns::DataColumns;
use super::values::LARGEST;
use crate::base::math::{DMat3, DQuat, DVec3, NotRigid, ROUNDED, rotation_and_scale, unit_quaternion};
use crate::base::time::Time;
use crate::geometry::table_rows::{RowTrack, TableColumns};
use crate::geometry::transform::{Rotation, TransformTracks};
use crate::import::table::{Table, TableError};
use crate::track::{Animate, Animated, Ease, Key, Repeat, Track};
use std::ops::Range;
use std::sync::Arc;

/// Maximum number of poses of one table, as of keys in one list; and of objects that it makes.
const MOST_ROWS: usize = 1_000_000;

/// Poses over time. Tracks without columns are constant.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseTracks {
    pub position: Animated<DVec3>,
    pub rotation: Animated<DQuat>,
    /// None if the table holds no scale other than 1.
    pub scale: Option<Animated<DVec3>>,
}

/// How keys are connected.
#[derive(Clone, Copy)]
pub struct Interpolation {
    pub ease: Ease,
    pub repeat: Repeat,
}

/// Why a table holds no poses: the place in the sequence file, and the fault.
pub type PoseFault = (Range<usize>, TableError);

/// One row's rotation, position and scale.
struct Row {
    rotation: DQuat,
    position: Option<DVec3>,
    scale: DVec3,
}

/// Makes tracks of a table's rows. Those of cameras may not scale.
pub fn tracks(
    table: &Table,
    (time, columns): (&ColumnName, &PoseColumns),
    how: Interpolation,
    clock: KeyClock,
    may_scale: bool,
) -> Result<PoseTracks, PoseFault> {
    let times = times(table, time, clock)?;
    let (position, rows) = places(table, columns)?;
    if let Some(RotationColumns::Matrix { columns, .. }) = &columns.rotation
        && let Some(row) =
            rows.iter().flatten().position(|row| row.scale != DVec3::ONE).filter(|_| !may_scale)
    {
        let why =
            "the columns of the matrix have other lengths than 1, but the poses of a camera have no scale";
        return Err(at_row(table, row, &columns[0], why.to_owned()));
    }
    // Quaternions take every easing except `CatmullRom`.
    let turns = if how.ease == Ease::CatmullRom { Ease::Linear } else { how.ease };
    let scales = rows.iter().flatten().any(|row| row.scale != DVec3::ONE);
    let scale = rows.as_ref().filter(|_| scales).map(|rows| rows.iter().map(|row| row.scale).collect());
    let rotation = rows.map(|rows| rows.into_iter().map(|row| row.rotation).collect());
    let track_of = |ease| Tracks { times: &times, ease, repeat: how.repeat };
    Ok(PoseTracks {
        position: track_of(how.ease).through(position.unwrap_or_default(), DVec3::ZERO),
        rotation: track_of(turns).through(rotation.unwrap_or_default(), DQuat::IDENTITY),
        scale: scale.map(|scale| track_of(how.ease).through(scale, DVec3::ONE)),
    })
}

/// Makes a track of the numbers of a column.
pub fn number_track(
    table: &Table,
    time: &ColumnName,
    value: &ColumnName,
    clock: KeyClock,
) -> Result<Animated<f64>, PoseFault> {
    let times = times(table, time, clock)?;
    let values = values(table, value)?.to_vec();
    Ok(Tracks { times: &times, ease: Ease::Linear, repeat: Repeat::Hold }.through(values, 0.0))
}

/// The positions and the rotations of all rows, as far as there are columns for them.
fn places(table: &Table, columns: &PoseColumns) -> Result<Places, PoseFault> {
    let position = columns.position.as_ref().map(|names| vectors(table, names)).transpose()?;
    let rows = columns.rotation.as_ref().map(|rotation| rows(table, rotation)).transpose()?;
    let position = position.or_else(|| rows.as_ref()?.iter().map(|row| row.position).collect());
    Ok((position, rows))
}

type Places = (Option<Vec<DVec3>>, Option<Vec<Row>>);

/// Where one of many is over time, and its rows of the table.
pub struct Placement {
    pub transform: TransformTracks,
    pub visible: Animated<bool>,
    pub row: RowTrack,
}

/// How a table holds placements.
pub struct PlacementColumns<'a> {
    pub poses: &'a PoseColumns,
    pub id: Option<&'a ColumnName>,
    /// The scale of each row.
    pub scales: Vec<DVec3>,
    pub last_row: LastRow,
}

/// When those vanish whose last row is before the last time of the table.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum LastRow {
    /// Right after it.
    Ends,
    /// At the next time of the table.
    HoldsUntilNext,
}

/// Makes a placement of every row, or of all rows of one `id` if there are several times.
pub fn placements(
    table: &Table,
    columns: PlacementColumns<'_>,
    clock: KeyClock,
) -> Result<Vec<Placement>, PoseFault> {
    let PlacementColumns { poses, id, scales, last_row } = columns;
    let (position, rotation) = places(table, poses)?;
    let data = Arc::new(TableColumns::from(DataColumns::of(table)));
    let place = |row: usize| -> (DVec3, DQuat, DVec3) {
        let own = rotation.as_ref().map(|rows| &rows[row]);
        let center = position.as_ref().map_or(DVec3::ZERO, |position| position[row]);
        let turn = own.map_or(DQuat::IDENTITY, |own| own.rotation);
        (center, turn, own.map_or(DVec3::ONE, |own| own.scale) * scales[row])
    };
    let rows = TimedRows::of(table, poses.time.as_ref(), clock)?;
    if rows.times.len() <= 1 {
        let still = |row| {
            let (center, turn, scale) = place(row);
            let rotation = Rotation::Quaternion(turn.into());
            let transform = TransformTracks {
                translation: center.into(),
                rotation,
                scale: scale.into(),
                ..TransformTracks::default()
            };
            let row = RowTrack::still(Arc::clone(&data), row as u32);
            Placement { transform, visible: true.into(), row }
        };
        at_most(table.rows(), "rows", poses.position.as_ref().map(|names| &names[0]))?;
        return Ok((0..table.rows()).map(still).collect());
    }
    let groups = rows.by_id(table, poses.time.as_ref(), id)?;
    at_most(groups.len(), "numbers of particles or instances", id)?;
    Ok(groups.iter().map(|group| placement(&rows, group, (&data, last_row), &place)).collect())
}

/// Limits the number of poses or objects of a table.
fn at_most(count: usize, what: &str, column: Option<&ColumnName>) -> Result<(), PoseFault> {
    if count <= MOST_ROWS {
        return Ok(());
    }
    let place = column.map_or(0..0, |column| column.place.clone());
    Err((place, TableError::new(format!("it has {count} {what}; {MOST_ROWS} are the most"))))
}

/// The placement of rows of ascending time.
fn placement(
    rows: &TimedRows,
    group: &[usize],
    (data, last_row): (&Arc<TableColumns>, LastRow),
    place: &impl Fn(usize) -> (DVec3, DQuat, DVec3),
) -> Placement {
    let times: Vec<Time> = group.iter().map(|row| rows.time(*row)).collect();
    let tracks = Tracks { times: &times, ease: Ease::Linear, repeat: Repeat::Hold };
    let all = || group.iter().map(|row| place(*row));
    let transform = TransformTracks {
        translation: tracks.through(all().map(|place| place.0).collect(), DVec3::ZERO),
        rotation: Rotation::Quaternion(tracks.through(all().map(|place| place.1).collect(), DQuat::IDENTITY)),
        scale: tracks.through(all().map(|place| place.2).collect(), DVec3::ONE),
        ..TransformTracks::default()
    };
    let (first, last) = (rows.of_row[group[0]] as usize, rows.of_row[group[group.len() - 1]] as usize);
    let key = |(time, value)| Key { time, value, ease: Ease::Step };
    // Hidden before the first row, and after the last one.
    let born = (first > 0).then(|| [(rows.times[0], false), (rows.times[first], true)]);
    let dead = rows.times.get(last + 1).map(|next| match last_row {
        LastRow::HoldsUntilNext => (*next, false),
        // Times of tables have nine decimal places, so that no moment of a frame that they mean is between.
        LastRow::Ends => {
            let gap = *next - rows.times[last];
            (rows.times[last] + (gap / 2).min(Time::new(1, 1_000_000_000)), false)
        }
    });
    let start = if first > 0 || dead.is_none() { None } else { Some((rows.times[0], true)) };
    let keys: Vec<_> = born.into_iter().flatten().chain(start).chain(dead).map(key).collect();
    let visible = Track::new(keys, Repeat::Hold, false).map_or(true.into(), Animated::Keyed);
    let group = group.iter().map(|row| *row as u32).collect();
    Placement { transform, visible, row: RowTrack::new(Arc::clone(data), group, times) }
}

/// The times of a table's rows, in any order.
pub struct TimedRows {
    /// All different times, ascending. Empty without a column of times.
    pub times: Vec<Time>,
    /// The index of each row's time.
    pub of_row: Vec<u32>,
}

impl TimedRows {
    pub fn of(table: &Table, column: Option<&ColumnName>, clock: KeyClock) -> Result<Self, PoseFault> {
        let Some(column) = column else { return Ok(Self { times: Vec::new(), of_row: Vec::new() }) };
        let all = values(table, column)?;
        let mut distinct = all.to_vec();
        distinct.sort_unstable_by(f64::total_cmp);
        distinct.dedup();
        let (mut times, mut places): (Vec<Time>, Vec<u32>) = (Vec::new(), Vec::with_capacity(distinct.len()));
        for value in &distinct {
            let time = row_time(*value, clock).ok_or_else(|| {
                let row = all.iter().position(|other| other == value).unwrap_or(0);
                at_row(table, row, column, format!("expected a time between -1e9 and 1e9, found {value}"))
            })?;
            // Times that differ by less than 1e-9 are one time.
            if times.last() != Some(&time) {
                times.push(time);
            }
            places.push(times.len() as u32 - 1);
        }
        let place = |value: &f64| places[distinct.partition_point(|known| known < value)];
        Ok(Self { times, of_row: all.iter().map(place).collect() })
    }

    pub fn time(&self, row: usize) -> Time {
        self.times[self.of_row[row] as usize]
    }

    /// The column of ids, which several times need.
    pub fn ids<'t>(
        table: &'t Table,
        time: Option<&ColumnName>,
        id: Option<&ColumnName>,
    ) -> Result<&'t [f64], PoseFault> {
        let why = "its rows have several times, but no column `id` says which rows belong together; write \
                   `id: \"name\"`";
        let place = time.map_or(0..0, |time| time.place.clone());
        values(table, id.ok_or_else(|| (place, TableError::new(why)))?)
    }

    /// The fault of two rows with the same id and time.
    pub fn same_time(
        table: &Table,
        id: Option<&ColumnName>,
        ids: &[f64],
        [first, second]: [usize; 2],
    ) -> PoseFault {
        let (number, line) = (ids[first], table.lines()[first]);
        let why = format!("{number} has a row of this time already, in line {line}");
        let column = ColumnName { name: String::new(), place: 0..0 };
        at_row(table, second, id.unwrap_or(&column), why)
    }

    /// The rows of each id in the order of their times.
    fn by_id(
        &self,
        table: &Table,
        time: Option<&ColumnName>,
        id: Option<&ColumnName>,
    ) -> Result<Vec<Vec<usize>>, PoseFault> {
        let ids = Self::ids(table, time, id)?;
        let mut order: Vec<usize> = (0..ids.len()).collect();
        order.sort_by(|&a, &b| ids[a].total_cmp(&ids[b]).then(self.of_row[a].cmp(&self.of_row[b])));
        let twice =
            |pair: &&[usize]| ids[pair[0]] == ids[pair[1]] && self.of_row[pair[0]] == self.of_row[pair[1]];
        if let Some(pair) = order.windows(2).find(twice) {
            return Err(Self::same_time(table, id, ids, [pair[0], pair[1]]));
        }
        Ok(order.chunk_by(|a, b| ids[*a] == ids[*b]).map(<[usize]>::to_vec).collect())
    }
}

/// What the tracks of one table share.
struct Tracks<'a> {
    times: &'a [Time],
    ease: Ease,
    repeat: Repeat,
}

impl Tracks<'_> {
    /// A track through values, or a constant if nothing changes. Without values it is `otherwise`.
    fn through<T: Animate>(&self, values: Vec<T>, otherwise: T) -> Animated<T> {
        let first = values.first().cloned().unwrap_or(otherwise);
        if values.iter().all(|value| *value == first) {
            return Animated::Constant(first);
        }
        let key = |(time, value): (&Time, T)| Key { time: *time, value, ease: self.ease };
        let keys = self.times.iter().zip(values).map(key).collect();
        // Times have been checked, so there is a track.
        Track::new(keys, self.repeat, false).map_or(Animated::Constant(first), Animated::Keyed)
    }
}

pub fn at_row(table: &Table, row: usize, column: &ColumnName, why: String) -> PoseFault {
    let error = TableError { line: Some(table.lines()[row]), column: Some(column.name.clone()), why };
    (column.place.clone(), error)
}

pub fn values<'t>(table: &'t Table, column: &ColumnName) -> Result<&'t [f64], PoseFault> {
    column.values(table).map_err(|error| (column.place.clone(), error))
}

/// Ascending times.
fn times(table: &Table, column: &ColumnName, clock: KeyClock) -> Result<Vec<Time>, PoseFault> {
    at_most(table.rows(), "rows", Some(column))?;
    let mut times: Vec<Time> = Vec::with_capacity(table.rows());
    let values = values(table, column)?;
    for (row, value) in values.iter().enumerate() {
        let time = row_time(*value, clock).ok_or_else(|| {
            let why = format!(
                "expected a time between -1e9 and 1e9, found {value}; subtract the first row's time from those of all rows"
            );
            at_row(table, row, column, why)
        })?;
        if times.last().is_some_and(|last| time <= *last) {
            let before = table.lines()[row - 1];
            let rounded = if *value > values[row - 1] { ", rounded to 9 decimal places," } else { "" };
            let why =
                format!("times must ascend, but {value}{rounded} is not after the time of line {before}");
            return Err(at_row(table, row, column, why));
        }
        times.push(time);
    }
    Ok(times)
}

pub fn vectors(table: &Table, names: &[ColumnName; 3]) -> Result<Vec<DVec3>, PoseFault> {
    let mut vectors = vec![DVec3::ZERO; table.rows()];
    for (axis, name) in names.iter().enumerate() {
        for (row, value) in values(table, name)?.iter().enumerate() {
            if value.abs() > LARGEST {
                let why = format!("expected a number between -1e30 and 1e30, found {value:e}");
                return Err(at_row(table, row, name, why));
            }
            vectors[row][axis] = *value;
        }
    }
    Ok(vectors)
}

fn rows(table: &Table, rotation: &RotationColumns) -> Result<Vec<Row>, PoseFault> {
    match rotation {
        RotationColumns::Quaternion(names) => quaternions(table, names),
        RotationColumns::Matrix { columns, order } => matrices(table, columns, *order),
    }
}

fn quaternions(table: &Table, names: &[ColumnName; 4]) -> Result<Vec<Row>, PoseFault> {
    let [w, x, y, z] = [0, 1, 2, 3].map(|at: usize| values(table, &names[at]));
    let (w, x, y, z) = (w?, x?, y?, z?);
    let row = |row: usize| {
        let parts = [x[row], y[row], z[row], w[row]];
        let zero =
            || at_row(table, row, &names[0], "the quaternion is zero, which is no rotation".to_owned());
        let rotation = unit_quaternion(parts).ok_or_else(zero)?;
        Ok(Row { rotation, position: None, scale: DVec3::ONE })
    };
    (0..table.rows()).map(row).collect()
}

fn matrices(table: &Table, names: &[ColumnName], order: MatrixOrder) -> Result<Vec<Row>, PoseFault> {
    let columns = names.iter().map(|name| values(table, name)).collect::<Result<Vec<_>, _>>()?;
    // Elements of the matrix by row and column. A matrix of twelve columns is written without its last row.
    let width = if names.len() == 9 { 3 } else { 4 };
    let height = if names.len() == 16 { 4 } else { 3 };
    let at = |row: usize, r: usize, c: usize| match order {
        MatrixOrder::Row => columns[r * width + c][row],
        MatrixOrder::Column => columns[c * height + r][row],
    };
    let mut mirrored = None;
    let row = |row: usize| {
        let fault = |why: String| at_row(table, row, &names[0], why);
        if height == 4 {
            let last = [0, 1, 2, 3].map(|c| at(row, 3, c));
            if last.iter().zip([0.0, 0.0, 0.0, 1.0]).any(|(found, exact)| (found - exact).abs() > ROUNDED) {
                let other = if order == MatrixOrder::Row { "Column" } else { "Row" };
                let why = format!(
                    "the last row of the matrix is {last:?}, not [0, 0, 0, 1]; is its order {other}?"
                );
                return Err(fault(why));
            }
        }
        let vector = |c: usize| DVec3::new(at(row, 0, c), at(row, 1, c), at(row, 2, c));
        let (rotation, scale) = rotation_and_scale(DMat3::from_cols(vector(0), vector(1), vector(2)))
            .map_err(|why| fault(explained(why)))?;
        if *mirrored.get_or_insert(scale.x < 0.0) != (scale.x < 0.0) {
            let why =
                "the matrix mirrors, unlike those before; no motion leads from one to the other".to_owned();
            let other =
                "the matrix does not mirror, unlike those before; no motion leads from one to the other";
            return Err(fault(if scale.x < 0.0 { why } else { other.to_owned() }));
        }
        let position = (width == 4).then(|| vector(3));
        if position.is_some_and(|position| position.abs().max_element() > LARGEST) {
            return Err(fault("the translation of the matrix is beyond 1e30".to_owned()));
        }
        Ok(Row { rotation, position, scale })
    };
    (0..table.rows()).map(row).collect()
}

fn explained(why: NotRigid) -> String {
    match why {
        NotRigid::Flat => {
            "the matrix flattens space: one of its columns has no length, or a length beyond 1e30".to_owned()
        }
        NotRigid::Sheared(degrees) => format!(
            "the matrix shears: two of its columns meet at {degrees:.4} degrees, not at 90; only rotations, scales along \
             the object's axes and translations are poses"
        ),
    }
}
