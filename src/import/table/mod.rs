//! Tables of numbers: CSV files and JSON Lines as named columns.

mod csv;
mod error;
mod json_lines;
#[cfg(test)]
mod tests;

pub use error::TableError;

use super::LoadProgress;
use super::lines::{is_utf16, without_mark};
use super::load::MeteredRead;
use crate::base::escape;
use crate::base::files;
use crate::base::machine;
use error::{BadCell, NoNumber};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// The maximum size of a table file in bytes.
const MAX_FILE_SIZE: u64 = 2 << 30;

/// The maximum number of columns. A line of few bytes may fill a row of all of them.
const MAX_COLUMNS: usize = 1000;

/// The number of rows for which memory is taken at first. Then it is doubled.
const FIRST_ROWS: usize = 1024;

/// Named columns of equal length. Every row has the number of its line.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    columns: Vec<Column>,
    /// The line that names the columns.
    head: u64,
    lines: Vec<u64>,
}

/// One column. Cells may hold something other than a number as long as nobody asks for the column.
#[derive(Clone, Debug, PartialEq)]
struct Column {
    name: String,
    values: Vec<f64>,
    /// The first cell without a finite number.
    bad: Option<BadCell>,
    /// The first one that does not say that its number is missing.
    other: Option<BadCell>,
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

    /// A table without rows.
    fn with_columns(names: Vec<String>, line: u64) -> Result<Self, TableError> {
        if names.len() > MAX_COLUMNS {
            let why = format!("{} columns; {MAX_COLUMNS} are the most", names.len());
            return Err(TableError::at_line(line, why));
        }
        let column = |name| Column { name, values: Vec::new(), bad: None, other: None };
        Ok(Self { columns: names.into_iter().map(column).collect(), head: line, lines: Vec::new() })
    }

    /// Appends the cells of one row, one for each column.
    fn push(
        &mut self,
        line: u64,
        cells: impl IntoIterator<Item = Result<f64, NoNumber>>,
    ) -> Result<(), TableError> {
        if self.lines.len() == self.lines.capacity() {
            self.grow()?;
        }
        self.lines.push(line);
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            let value = cell.unwrap_or_else(|found| {
                let (NoNumber::Missing(text) | NoNumber::Other(text)) = &found;
                let bad = || BadCell { line, found: text.clone() };
                column.bad.get_or_insert_with(bad);
                if matches!(found, NoNumber::Other(_)) {
                    column.other.get_or_insert_with(bad);
                }
                f64::NAN
            });
            column.values.push(value);
        }
        Ok(())
    }

    /// Takes memory for more rows, if it is free. Cells may be empty, so the size of the file does not bound it.
    fn grow(&mut self) -> Result<(), TableError> {
        let rows = self.lines.len().max(FIRST_ROWS);
        // A column that grows exists twice meanwhile.
        let needed = rows * (self.columns.len() + 2) * size_of::<f64>();
        machine::check_memory(needed as u64)?;
        self.lines.reserve_exact(rows);
        self.columns.iter_mut().for_each(|column| column.values.reserve_exact(rows));
        Ok(())
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
    /// If there is no such column, if there are several, or if a cell does not hold a finite number.
    pub fn column(&self, name: &str) -> Result<&[f64], TableError> {
        let column = self.named(name)?;
        column.bad.as_ref().map_or(Ok(&column.values), |bad| Err(column.error(bad)))
    }

    /// [`Table::column`] of a column that may lack numbers: NaN where a cell is empty, NaN, NA or null.
    ///
    /// # Errors
    /// If there is no such column, if there are several, or if a cell holds anything else.
    pub fn column_with_gaps(&self, name: &str) -> Result<&[f64], TableError> {
        let column = self.named(name)?;
        column.other.as_ref().map_or(Ok(&column.values), |bad| Err(column.error(bad)))
    }

    /// The one column of a name.
    fn named(&self, name: &str) -> Result<&Column, TableError> {
        let mut named = self.columns.iter().filter(|column| column.name == name);
        let Some(column) = named.next() else {
            return Err(TableError::no_column(name, self.names()));
        };
        if named.next().is_some() {
            return Err(TableError::at_line(self.head, format!("two columns are named {name:?}")));
        }
        Ok(column)
    }
}

impl Column {
    fn error(&self, BadCell { line, found }: &BadCell) -> TableError {
        let why = format!("expected a finite number, found {found}");
        TableError { line: Some(*line), column: Some(self.name.clone()), why }
    }
}

/// The first line of a file without its byte order mark.
fn text_without_mark(line: &[u8]) -> Result<&[u8], TableError> {
    match is_utf16(line) {
        true => Err(TableError::new("it is UTF-16 text; tables are UTF-8")),
        false => Ok(without_mark(line)),
    }
}

/// A finite number.
fn cell(text: &[u8]) -> Result<f64, NoNumber> {
    let text = text.trim_ascii();
    let number = super::lines::parsed::<f64>(text);
    if let Some(number) = number.filter(|number| number.is_finite()) {
        return Ok(number);
    }
    // As spreadsheets, pandas, R and JSON write what is missing.
    let says_so = ["na", "n/a", "null"].iter().any(|word| text.eq_ignore_ascii_case(word.as_bytes()));
    let is_missing = says_so || number.is_some_and(f64::is_nan);
    Err(match text {
        [] => NoNumber::Missing("nothing".to_owned()),
        _ if is_missing => NoNumber::Missing(super::lines::quoted(text)),
        _ => NoNumber::Other(super::lines::quoted(text)),
    })
}
