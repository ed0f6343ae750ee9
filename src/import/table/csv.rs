//! CSV files: a line of names, then lines of cells.

use super::{Table, TableError, cell};
use crate::base::files;
use crate::import::lines::{parsed, quoted};
use ::csv::{ByteRecord, Error, ErrorKind, Position, ReaderBuilder, Trim};
use std::cell::{Cell, RefCell};
use std::io::{self, BufRead, Cursor, Read};

/// Bytes of the first line that decide about the separator.
const SEPARATOR_BYTES: u64 = 1 << 16;

/// Reads a file whose first line names the columns.
pub fn read(mut input: impl BufRead) -> Result<Table, TableError> {
    let mut first = Vec::new();
    while first.trim_ascii().is_empty()
        && input.by_ref().take(SEPARATOR_BYTES).read_until(b'\n', &mut first)? > 0
    {}
    let text = super::text_without_mark(&first)?;
    let separator = separator(text);
    let (numbers, quotes) = (LineNumbers::default(), Quotes::new(separator));
    let input = Cursor::new(text).chain(input);
    let rows = FilledLines { input, line: Vec::new(), at: 0, numbers: &numbers, quotes: &quotes };
    let mut reader = ReaderBuilder::new().delimiter(separator).trim(Trim::All).from_reader(rows);
    let line = |position: Option<&Position>| numbers.of(position.map_or(1, Position::line));
    let unreadable = |error: &Error| match (error.kind(), quotes.unclosed()) {
        (ErrorKind::Io(_), Some(line)) => {
            TableError::at_line(line, "a quote opens in this line, and is never closed")
        }
        (ErrorKind::Io(error), None) => TableError::new(files::describe(error)),
        (ErrorKind::UnequalLengths { pos, expected_len, len }, _) => {
            let why = format!("expected {expected_len} cells, as in the line of names, found {len}");
            TableError::at_line(line(pos.as_ref()), why)
        }
        _ => TableError::new(error.to_string()),
    };
    let header = reader.byte_headers().map_err(|error| unreadable(&error))?;
    let head = line(header.position());
    if header.is_empty() {
        return Err(TableError::new("it is empty; the first line names the columns"));
    }
    if header.iter().all(|cell| parsed::<f64>(cell).is_some()) {
        let why = format!("expected the names of the columns, found {}", quoted(text.trim_ascii()));
        return Err(TableError::at_line(head, why));
    }
    let names = header.iter().map(|cell| name(cell, head)).collect::<Result<Vec<_>, _>>()?;
    let mut table = Table::with_columns(names, head)?;
    let mut row = ByteRecord::new();
    while reader.read_byte_record(&mut row).map_err(|error| unreadable(&error))? {
        table.push(line(row.position()), row.iter().map(cell))?;
    }
    Ok(table)
}

/// The separator that the line of names contains most outside of quotes: a comma, a semicolon or a tab.
fn separator(line: &[u8]) -> u8 {
    // Parts between quotes are in turn outside and inside.
    let outside = || line.split(|byte| *byte == b'"').step_by(2).flatten();
    let count = |separator: u8| outside().filter(|byte| **byte == separator).count();
    // Of equal counts, the last one is the greatest.
    [b'\t', b';', b','].into_iter().max_by_key(|separator| count(*separator)).unwrap_or(b',')
}

fn name(cell: &[u8], line: u64) -> Result<String, TableError> {
    let name = std::str::from_utf8(cell).map_err(|_| {
        TableError::at_line(line, format!("the name of a column is not UTF-8 text: {}", quoted(cell)))
    })?;
    Ok(name.to_owned())
}

/// The lines of a file that are not blank, each ending with `\n`. The parser places a row at the end of the row before,
/// which is another line if blank lines or `\r\n` are between.
struct FilledLines<'a, R> {
    input: R,
    line: Vec<u8>,
    /// Bytes of the line that have been read.
    at: usize,
    numbers: &'a LineNumbers,
    quotes: &'a Quotes,
}

impl<R: BufRead> Read for FilledLines<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.at == self.line.len() {
            self.line.clear();
            self.at = 0;
            if self.input.read_until(b'\n', &mut self.line)? == 0 {
                // The parser would take the rest of the file as one cell.
                return if self.quotes.unclosed().is_some() {
                    Err(io::ErrorKind::InvalidData.into())
                } else {
                    Ok(0)
                };
            }
            if self.line.trim_ascii().is_empty() {
                self.numbers.skip();
                self.line.clear();
                continue;
            }
            self.numbers.keep();
            self.quotes.read(&self.line, self.numbers.now());
            if self.line.ends_with(b"\r\n") {
                self.line.truncate(self.line.len() - 2);
                self.line.push(b'\n');
            }
        }
        let read = (&self.line[self.at..]).read(buffer)?;
        self.at += read;
        Ok(read)
    }
}

/// Follows the quotes of cells as the parser does: a quote opens at the begin of a cell only, and two quotes inside stand
/// for one.
struct Quotes {
    separator: u8,
    state: Cell<QuoteState>,
}

#[derive(Clone, Copy)]
enum QuoteState {
    CellBegin,
    Unquoted,
    /// Behind a quote that opens in this line.
    Quoted(u64),
    /// Behind a second quote, which closes unless another one follows.
    Closing(u64),
}

impl Quotes {
    fn new(separator: u8) -> Self {
        Self { separator, state: Cell::new(QuoteState::CellBegin) }
    }

    /// Reads a line with its end.
    fn read(&self, text: &[u8], line: u64) {
        let next = |state: QuoteState, byte: u8| match (state, byte) {
            (QuoteState::CellBegin, b'"') => QuoteState::Quoted(line),
            (QuoteState::Quoted(opened), b'"') => QuoteState::Closing(opened),
            (QuoteState::Closing(opened), b'"') => QuoteState::Quoted(opened),
            (QuoteState::Quoted(_), _) => state,
            (_, b'\n' | b'\r') => QuoteState::CellBegin,
            _ if byte == self.separator => QuoteState::CellBegin,
            _ => QuoteState::Unquoted,
        };
        self.state.set(text.iter().copied().fold(self.state.get(), next));
    }

    /// The line of the quote that is open.
    fn unclosed(&self) -> Option<u64> {
        match self.state.get() {
            QuoteState::Quoted(line) => Some(line),
            _ => None,
        }
    }
}

/// The numbers of lines in the file, by their numbers among the lines that are not blank. All count from 1.
#[derive(Default)]
struct LineNumbers(RefCell<Skipped>);

#[derive(Default)]
struct Skipped {
    kept: u64,
    skipped: u64,
    /// Where blank lines have been skipped: the number of the next kept line, and how many are skipped before it.
    jumps: Vec<(u64, u64)>,
}

impl LineNumbers {
    fn keep(&self) {
        let skipped = &mut *self.0.borrow_mut();
        skipped.kept += 1;
        if skipped.jumps.last().map_or(0, |(_, before)| *before) != skipped.skipped {
            skipped.jumps.push((skipped.kept, skipped.skipped));
        }
    }

    fn skip(&self) {
        self.0.borrow_mut().skipped += 1;
    }

    /// The number of the last line.
    fn now(&self) -> u64 {
        let Skipped { kept, skipped, .. } = *self.0.borrow();
        kept + skipped
    }

    fn of(&self, kept: u64) -> u64 {
        let jumps = &self.0.borrow().jumps;
        let next = jumps.partition_point(|(line, _)| *line <= kept);
        kept + next.checked_sub(1).map_or(0, |last| jumps[last].1)
    }
}
