//! The columns of a table as data: what textures may read of particles and of instances.

use crate::geometry::table_rows::TableColumns;
use crate::import::table::Table;

/// The columns of numbers, of which some may be missing; and the names of the others, with what they hold instead.
#[derive(Default)]
pub struct DataColumns {
    pub numbers: Vec<(String, Vec<f64>)>,
    pub unusable: Vec<(String, String)>,
}

impl DataColumns {
    pub fn of(table: &Table) -> Self {
        let mut columns = Self::default();
        for name in table.names() {
            match table.column_with_gaps(name) {
                Ok(values) => columns.numbers.push((name.to_owned(), values.to_vec())),
                Err(error) => columns.unusable.push((name.to_owned(), error.to_string())),
            }
        }
        columns
    }
}

impl From<DataColumns> for TableColumns {
    fn from(columns: DataColumns) -> Self {
        Self::new(columns.numbers, columns.unusable)
    }
}
