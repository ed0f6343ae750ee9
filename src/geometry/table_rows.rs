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

    /// Why a column cannot be read, if it has another content than numbers.
    pub fn unusable(&self, name: &str) -> Option<&str> {
        self.unusable.iter().find(|(known, _)| known == name).map(|(_, why)| why.as_str())
    }

    /// The column with these numbers.
    pub fn find(&self, key: &ArrayKey) -> Option<&DataArray> {
        let index = key.index(self.arrays.iter().map(|column| (column.name.as_str(), column.centering)))?;
        Some(&self.arrays[index]).filter(|column| column.has(key.component))
    }

    /// A number between two rows: that of the first one at a share of 0, of the second one at 1. The second row is not
    /// read at a share of 0.
    pub fn number(&self, key: &ArrayKey, rows: [u32; 2], share: f64) -> Option<f64> {
        let column = self.find(key)?;
        let of_row = |row: u32| column.value(row as usize, key.component);
        let a = of_row(rows[0]);
        if share == 0.0 {
            return Some(a);
        }
        let b = of_row(rows[1]);
        let value = a + (b - a) * share;
        // Rounding may lead beyond the ends. `max` and `min` would hide an end that is not a number.
        Some(if value.is_nan() { value } else { value.max(a.min(b)).min(a.max(b)) })
    }
}

/// The rows that an object has over time: a single one, or those of ascending times.
#[derive(Clone, Component, Debug)]
pub struct RowTrack {
    columns: Arc<TableColumns>,
    /// The index of each row.
    rows: Vec<u32>,
    /// The time of each row; empty for a single one.
    times: Vec<Time>,
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
        Self { columns, rows: vec![row], times: Vec::new() }
    }

    /// At least one row, each with its time, ascending. They hold before the first time and after the last one.
    pub fn new(columns: Arc<TableColumns>, rows: Vec<u32>, times: Vec<Time>) -> Self {
        debug_assert!(!rows.is_empty() && rows.len() == times.len(), "every row has a time");
        Self { columns, rows, times }
    }

    /// The columns of the table.
    pub fn columns(&self) -> &TableColumns {
        &self.columns
    }

    /// Whether the row changes over time.
    pub fn is_keyed(&self) -> bool {
        self.times.len() > 1
    }

    /// The row at a time, interpolated linearly.
    pub fn at(&self, time: Time) -> TableRow {
        let after = self.times.partition_point(|known| *known <= time);
        let low = after.saturating_sub(1);
        let a = self.rows[low];
        let (b, share) = match (self.times.get(low), self.times.get(after)) {
            (Some(&from), Some(&to)) if from < time && after > 0 => {
                (self.rows[after], Fraction::between(time, from, to).value())
            }
            _ => (a, 0.0),
        };
        TableRow { columns: Arc::clone(&self.columns), rows: [a, b], share }
    }
}

/// The numbers that an object has at one moment: those between two rows of a table.
#[derive(Clone, Component, Debug)]
pub struct TableRow {
    columns: Arc<TableColumns>,
    rows: [u32; 2],
    share: f64,
}

/// Equal places in one table.
impl PartialEq for TableRow {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.columns, &other.columns) && (self.rows, self.share) == (other.rows, other.share)
    }
}

impl TableRow {
    /// One of the numbers; none if there is no such column.
    pub fn number(&self, key: &ArrayKey) -> Option<f64> {
        self.columns.number(key, self.rows, self.share)
    }
}

/// The names and the numbers, wherever in a table they are.
impl Content for TableRow {
    fn feed(&self, into: &mut Digester) {
        for DataArray { name, .. } in self.columns.arrays() {
            let key = ArrayKey::whole(name.clone());
            (name.as_str(), self.number(&key)).feed(into);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::digest::Digest;

    fn columns(heat: &[f64]) -> Arc<TableColumns> {
        Arc::new(TableColumns::new(vec![("heat".to_owned(), heat.to_vec())], Vec::new()))
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
    fn digests_are_those_of_the_numbers() {
        let digest =
            |heat: &[f64], row| Digest::of(&RowTrack::still(columns(heat), row).at(Time::from_integer(0)));
        assert_eq!(digest(&[1.0, 2.0], 1), digest(&[2.0], 0));
        assert_ne!(digest(&[1.0, 2.0], 1), digest(&[1.0, 2.0], 0));
    }
}
