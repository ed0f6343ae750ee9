//! JSON Lines: one object per line. The first one names the columns.

use super::error::NoNumber;
use super::{Table, TableError};
use crate::import::lines::{Lines, quoted};
use serde_json::{Map, Value};
use std::io::BufRead;

/// The maximum length of a line in bytes. Parsed, an object takes much more memory than its text.
const MAX_LINE: usize = 1 << 20;

/// Reads a file. Empty lines are skipped, as are fields that the first object does not have.
pub fn read(input: impl BufRead) -> Result<Table, TableError> {
    let mut lines = Lines::new(input, false);
    let mut table: Option<Table> = None;
    while let Some((number, line)) = lines.next()? {
        let line = if number == 1 { super::text_without_mark(line)? } else { line };
        if line.trim_ascii().is_empty() {
            continue;
        }
        let row = object(number, line)?;
        if table.is_none() {
            table = Some(Table::with_columns(row.keys().cloned().collect(), number)?);
        }
        if let Some(table) = &mut table {
            if !row.keys().any(|name| table.has(name)) {
                let why = format!("it has none of the columns of line {}", table.head);
                return Err(TableError::at_line(number, why));
            }
            let cells: Vec<_> = table.names().map(|name| cell(row.get(name))).collect();
            table.push(number, cells)?;
        }
    }
    table.ok_or_else(|| {
        TableError::new("it is empty; every line holds an object such as {\"t\": 0, \"x\": 1}")
    })
}

fn object(number: u64, line: &[u8]) -> Result<Map<String, Value>, TableError> {
    if line.len() > MAX_LINE {
        return Err(TableError::at_line(number, format!("{} bytes; {MAX_LINE} are the most", line.len())));
    }
    serde_json::from_slice(line).map_err(|error| {
        let found = quoted(line);
        let why = match error.is_data() {
            true => format!("expected an object such as {{\"t\": 0, \"x\": 1}}, found {found}"),
            false if error.is_eof() => {
                format!("the object does not end in its line, {found}; every line holds a whole one")
            }
            // The message of the parser ends with a place in the line, counted from 1.
            false => {
                format!("{} in {found}", error.to_string().replace(" at line 1 column ", " at character "))
            }
        };
        TableError::at_line(number, why)
    })
}

fn cell(value: Option<&Value>) -> Result<f64, NoNumber> {
    match value {
        None => Err(NoNumber::Missing("nothing".to_owned())),
        Some(Value::Null) => Err(NoNumber::Missing("`null`".to_owned())),
        Some(value) => value
            .as_f64()
            .filter(|number| number.is_finite())
            .ok_or_else(|| NoNumber::Other(quoted(value.to_string().as_bytes()))),
    }
}
