//! Tables of numbers: CSV files and JSON Lines as named columns.

mod csv;
mod error;
mod json_lines;
#[cfg(test)]
mod tests;

pub use error::TableError;

use super::LoadProgress;
use super::load::MeteredRead;
use crate::base::escape;
use crate::base::files;
use crate::base::machine;
use error::BadCell;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// The maximum size of a table file in bytes.
const MAX_FILE_SIZE: u64 = 2 << 30;

/// The maximum number of columns. Their names are compared with each other.
const MAX_COLUMNS: usize = 1000;

/// Bytes of memory per byte of a file: a cell of one digit and its separator becomes a number of eight bytes, and a
/// growing column briefly exists twice.
const MEMORY_PER_BYTE: u64 = 8;

/// Named columns of equal length. Every row has the number of its line.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    columns: Vec<Column>,
    lines: Vec<u64>,
}

/// One column. Cells may hold something other than a number as long as nobody asks for the column.
#[derive(Clone, Debug, PartialEq)]
struct Column {
    name: String,
    values: Vec<f64>,
    /// The first cell without a finite number.
    bad: Option<BadCell>,
}

/// The formats of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// Comma-separated values (RFC 4180) with a line of names. Semicolons and tabs separate, too.
    Csv,
    /// One JSON object per line.
    JsonLines,
}

impl TableFormat {
    /// The format that the extension of a file names.
    ///
    /// # Errors
    /// If tables are not read from such files.
    pub fn of(path: &Path) -> Result<Self, TableError> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("csv" | "tsv") => Ok(Self::Csv),
            Some("jsonl" | "ndjson") => Ok(Self::JsonLines),
            _ => Err(TableError::new("tables are read from .csv, .tsv, .jsonl and .ndjson files")),
        }
    }
}

impl Table {
    /// Reads a table file of at most 2 GiB.
    ///
    /// # Errors
    /// If the file cannot be read, is too large for the free memory, or is not a table.
    pub fn load(path: &Path, meter: &LoadProgress) -> Result<Self, TableError> {
        let format = TableFormat::of(path)?;
        let (file, size) = files::open(path, MAX_FILE_SIZE)?;
        machine::check_memory(size.saturating_mul(MEMORY_PER_BYTE))?;
        let name = escape::path(path.file_name().unwrap_or(path.as_os_str()));
        meter.start(format!("loading {name}"), size);
        Self::read(BufReader::new(MeteredRead { input: file.take(size), meter }), format)
    }

    /// Reads a table.
    ///
    /// # Errors
    /// If the input is not a table. Cells that are not numbers are errors of [`Table::column`].
    pub fn read(input: impl BufRead, format: TableFormat) -> Result<Self, TableError> {
        let table = match format {
            TableFormat::Csv => csv::read(input)?,
            TableFormat::JsonLines => json_lines::read(input)?,
        };
        if table.lines.is_empty() {
            return Err(TableError::new("it has no rows"));
        }
        Ok(table)
    }

    /// A table without rows. Names must differ.
    fn with_columns(names: Vec<String>, line: u64) -> Result<Self, TableError> {
        if names.len() > MAX_COLUMNS {
            let why = format!("{} columns; {MAX_COLUMNS} are the most", names.len());
            return Err(TableError::at_line(line, why));
        }
        let twice = (0..names.len()).find(|&at| names[..at].contains(&names[at]));
        if let Some(at) = twice {
            return Err(TableError::at_line(line, format!("two columns are named {:?}", names[at])));
        }
        let column = |name| Column { name, values: Vec::new(), bad: None };
        Ok(Self { columns: names.into_iter().map(column).collect(), lines: Vec::new() })
    }

    /// Appends the cells of one row, one for each column.
    fn push(&mut self, line: u64, cells: impl IntoIterator<Item = Result<f64, String>>) {
        self.lines.push(line);
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            let value = cell.unwrap_or_else(|found| {
                column.bad.get_or_insert(BadCell { line, found });
                f64::NAN
            });
            column.values.push(value);
        }
    }

    /// The number of rows; at least 1.
    pub fn rows(&self) -> usize {
        self.lines.len()
    }

    /// The line of each row in the file, counted from 1.
    pub fn lines(&self) -> &[u64] {
        &self.lines
    }

    /// The names of the columns, in the order of the file.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| column.name.as_str())
    }

    /// Whether there is a column of this name.
    pub fn has(&self, name: &str) -> bool {
        self.names().any(|known| known == name)
    }

    /// The finite numbers of a column, one per row.
    ///
    /// # Errors
    /// If there is no such column, or if a cell does not hold a finite number.
    pub fn column(&self, name: &str) -> Result<&[f64], TableError> {
        let Some(column) = self.columns.iter().find(|column| column.name == name) else {
            return Err(TableError::no_column(name, self.names()));
        };
        match &column.bad {
            None => Ok(&column.values),
            Some(BadCell { line, found }) => {
                let why = format!("expected a finite number, found {found}");
                Err(TableError { line: Some(*line), column: Some(name.to_owned()), why })
            }
        }
    }
}

/// A finite number, or a quotation of something else.
fn cell(text: &[u8]) -> Result<f64, String> {
    let text = text.trim_ascii();
    let number = super::lines::parsed::<f64>(text).filter(|number| number.is_finite());
    number.ok_or_else(|| if text.is_empty() { "nothing".to_owned() } else { super::lines::quoted(text) })
}
