//! Errors of tables.

use crate::base::files;
use crate::base::lists::{listed, shortened};
use std::fmt;
use std::io;

/// Why a table cannot be used, with the place in its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableError {
    /// Counted from 1.
    pub line: Option<u64>,
    pub column: Option<String>,
    /// What is wrong, and what would be right.
    pub why: String,
}

/// The content of a cell that is no finite number.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum NoNumber {
    /// The cell says that its number is missing: it is empty, NaN, NA or null. How messages call it.
    Missing(String),
    /// Anything else, quoted.
    Other(String),
}

/// The first cell of a column without a finite number.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BadCell {
    pub line: u64,
    /// How messages call its content.
    pub found: String,
}

impl TableError {
    /// An error of the whole file.
    pub fn new(why: impl Into<String>) -> Self {
        Self { line: None, column: None, why: why.into() }
    }

    pub fn at_line(line: u64, why: impl Into<String>) -> Self {
        Self { line: Some(line), ..Self::new(why) }
    }

    pub(super) fn no_column<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> Self {
        Self::new(format!("it has no column `{}`; its columns are {}", shortened(name), listed(known)))
    }
}

impl From<io::Error> for TableError {
    fn from(error: io::Error) -> Self {
        Self::new(files::describe(&error))
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}")?;
            if let Some(column) = &self.column {
                write!(f, ", column {column:?}")?;
            }
            f.write_str(": ")?;
        }
        f.write_str(&self.why)
    }
}

impl std::error::Error for TableError {}
