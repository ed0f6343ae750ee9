//! Rows of tables as data of shapes: numbers of particles and instances that textures read.

use crate::base::digest::{Content, Digester};
use crate::base::time::{Fraction, Time};
use crate::geometry::mesh::{ArrayKey, ArrayValues, Centering, DataArray};
use bevy_ecs::component::Component;
use std::sync::Arc;

/// The columns of a table. NaN stands for a missing number.
#[derive(Debug, Default)]
pub struct TableColumns {
    arrays: Vec<DataArray>,
    /// The names of columns that do not hold numbers, and why not.
    unusable: Vec<(String, String)>,
}

impl TableColumns {
    /// Columns of equal length by their names, and the names of those that do not hold numbers, with the reason.
    pub fn new(columns: Vec<(String, Vec<f64>)>, unusable: Vec<(String, String)>) -> Self {
        let array = |(name, values): (String, Vec<f64>)| DataArray {
            name,
            centering: Centering::Points,
            components: 1,
            values: ArrayValues::from(values),
        };
        Self { arrays: columns.into_iter().map(array).collect(), unusable }
    }

    /// The columns of numbers.
    pub fn arrays(&self) -> &[DataArray] {
        &self.arrays
    }

    /// The columns of these names alone.
    pub fn only(&self, names: &[&str]) -> Self {
        let is_read = |array: &&DataArray| names.contains(&array.name.as_str());
        Self { arrays: self.arrays.iter().filter(is_read).cloned().collect(), unusable: Vec::new() }
    }

    /// Why a column cannot be read, if it has another content than numbers.
    pub fn unusable(&self, name: &str) -> Option<&str> {
        self.unusable.iter().find(|(known, _)| known == name).map(|(_, why)| why.as_str())
    }

    /// The column with these numbers.
    pub fn find(&self, key: &ArrayKey) -> Option<&DataArray> {
        key.find_in(&self.arrays).map(|index| &self.arrays[index])
    }
}

/// A number between two rows of a column: that of the first one at a share of 0, of the second one at 1. The second row is
/// not read at a share of 0.
pub fn interpolated(column: &DataArray, rows: [u32; 2], share: f64) -> f64 {
    let [a, b] = rows.map(|row| row as usize);
    let a = column.values.get(a);
    if share == 0.0 {
        return a;
    }
    let b = column.values.get(b);
    let value = a + (b - a) * share;
    // Rounding may lead beyond the ends. `max` and `min` would hide an end that is not a number.
    if value.is_nan() { value } else { value.max(a.min(b)).min(a.max(b)) }
}

/// The rows that an object has over time: a single one, or those of ascending times.
#[derive(Clone, Component, Debug)]
pub struct RowTrack {
    columns: Arc<TableColumns>,
    /// The index of each row.
    rows: Arc<[u32]>,
    /// The time of each row; empty for a single one.
    times: Arc<[Time]>,
}

/// Compared by the address of the table, as meshes are.
impl PartialEq for RowTrack {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.columns, &other.columns) && self.rows == other.rows && self.times == other.times
    }
}

impl RowTrack {
    /// A row that is the same at all times.
    pub fn still(columns: Arc<TableColumns>, row: u32) -> Self {
        Self { columns, rows: [row].into(), times: [].into() }
    }

    /// At least one row, each with its time, ascending. They hold before the first time and after the last one.
    pub fn new(columns: Arc<TableColumns>, rows: Vec<u32>, times: Vec<Time>) -> Self {
        debug_assert!(!rows.is_empty() && rows.len() == times.len(), "every row has a time");
        Self { columns, rows: rows.into(), times: times.into() }
    }

    /// The columns of the table.
    pub fn columns(&self) -> &Arc<TableColumns> {
        &self.columns
    }

    /// The same rows of fewer columns of the table.
    pub fn with_columns(&self, columns: Arc<TableColumns>) -> Self {
        Self { columns, ..self.clone() }
    }

    /// Whether the numbers change over time.
    pub fn is_keyed(&self) -> bool {
        let first = self.rows[0] as usize;
        let changes = |column: &DataArray| {
            let first = column.values.get(first).to_bits();
            self.rows.iter().any(|row| column.values.get(*row as usize).to_bits() != first)
        };
        self.times.len() > 1 && self.columns.arrays.iter().any(changes)
    }

    /// The row at a time, interpolated linearly.
    pub fn at(&self, time: Time) -> TableRow {
        let after = self.times.partition_point(|known| *known <= time);
        let low = after.saturating_sub(1);
        let (rows, share) = match (self.times.get(low), self.times.get(after)) {
            (Some(&from), Some(&to)) if from < time && after > 0 => {
                ([self.rows[low], self.rows[after]], Fraction::between(time, from, to).value())
            }
            _ => ([self.rows[low]; 2], 0.0),
        };
        let numbers = self.columns.arrays.iter().map(|column| interpolated(column, rows, share)).collect();
        TableRow { columns: Arc::clone(&self.columns), numbers }
    }
}

/// The numbers that an object has at one moment: one of each column.
#[derive(Clone, Component, Debug)]
pub struct TableRow {
    columns: Arc<TableColumns>,
    numbers: Arc<[f64]>,
}

/// Equal numbers of one table.
impl PartialEq for TableRow {
    fn eq(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|row| row.numbers.iter().map(|number| number.to_bits()));
        Arc::ptr_eq(&self.columns, &other.columns) && own.eq(others)
    }
}

impl TableRow {
    /// One of the numbers; none if there is no such column.
    pub fn number(&self, key: &ArrayKey) -> Option<f64> {
        key.find_in(&self.columns.arrays).map(|index| self.numbers[index])
    }
}

/// The names and the numbers, wherever in a table they are.
impl Content for TableRow {
    fn feed(&self, into: &mut Digester) {
        for (DataArray { name, .. }, number) in self.columns.arrays.iter().zip(&*self.numbers) {
            (name.as_str(), *number).feed(into);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::digest::Digest;

    fn columns(heat: &[f64]) -> Arc<TableColumns> {
        let time = (0..heat.len()).map(|row| row as f64).collect();
        let columns = vec![("t".to_owned(), time), ("heat".to_owned(), heat.to_vec())];
        Arc::new(TableColumns::new(columns, Vec::new()))
    }

    #[test]
    fn rows_vary_linearly_between_their_times() {
        let times = [1, 3].map(Time::from_integer).to_vec();
        let track = RowTrack::new(columns(&[0.0, 10.0, 20.0]), vec![2, 1], times);
        let heat = ArrayKey::whole("heat".to_owned());
        let at = |half: i128| track.at(Time::new(half, 2)).number(&heat);
        assert_eq!([0, 2, 4, 5, 6, 9].map(at), [20.0, 20.0, 15.0, 12.5, 10.0, 10.0].map(Some));
        assert_eq!(track.at(Time::from_integer(2)).number(&ArrayKey::whole("cold".to_owned())), None);
        assert!(track.is_keyed());
    }

    #[test]
    fn only_the_columns_that_are_read_count() {
        let times = || [0, 1].map(Time::from_integer).to_vec();
        let all = columns(&[5.0, 5.0]);
        let track = RowTrack::new(Arc::clone(&all), vec![0, 1], times());
        assert!(track.is_keyed(), "the column of times changes");
        let read = track.with_columns(Arc::new(all.only(&["heat"])));
        assert!(!read.is_keyed());
        let [first, last] = [0, 1].map(|time| read.at(Time::from_integer(time)));
        assert_eq!(first, last);
        assert_eq!(first.number(&ArrayKey::whole("t".to_owned())), None);
    }

    #[test]
    fn digests_are_those_of_the_numbers() {
        let digest = |heat: &[f64], row| {
            let track = RowTrack::still(Arc::new(columns(heat).only(&["heat"])), row);
            Digest::of(&track.at(Time::from_integer(0)))
        };
        assert_eq!(digest(&[1.0, 2.0], 1), digest(&[2.0], 0));
        assert_ne!(digest(&[1.0, 2.0], 1), digest(&[1.0, 2.0], 0));
    }
}
