//! The records of an element, read in parts.

use super::header::{Element, Encoding, Scalar};
use super::scalars::{Binary, Scalars, Text};
use super::vertices::incomplete;
use crate::mesh::MeshError;
use rayon::prelude::*;
use std::io::{BufRead, ErrorKind, Read};
use std::ops::Range;

/// What is made of records.
pub trait Reader: Sync {
    /// What they give.
    type Output: Default + Send;

    /// Reads the records with these numbers and adds what they give.
    fn read(
        &self,
        records: Range<u64>,
        values: &mut impl Scalars,
        into: &mut Self::Output,
    ) -> Result<(), MeshError>;

    /// Moves what a part of the records gave behind what those before did.
    fn append(whole: &mut Self::Output, part: &mut Self::Output);
}

/// Where records come from.
pub trait Records {
    /// Reads all records of an element.
    fn read<T: Reader>(&mut self, element: &Element, reader: &T) -> Result<T::Output, MeshError>;
}

impl<R: BufRead> Records for Text<R> {
    fn read<T: Reader>(&mut self, element: &Element, reader: &T) -> Result<T::Output, MeshError> {
        let mut output = T::Output::default();
        reader.read(0..element.count, self, &mut output)?;
        Ok(output)
    }
}

/// Bytes read at once.
const BLOCK: usize = 1 << 20;

/// Bytes of records that one thread reads at a time.
const TOGETHER: usize = 1 << 15;

/// Binary records, in blocks whose parts are read in parallel.
pub struct Blocks<R> {
    input: R,
    encoding: Encoding,
    buffer: Vec<u8>,
    /// What of the buffer is still to be read.
    rest: Range<usize>,
    /// Nothing follows behind the buffer.
    ended: bool,
}

impl<R: Read> Blocks<R> {
    pub fn new(input: R, encoding: Encoding) -> Self {
        Self { input, encoding, buffer: vec![0; BLOCK], rest: 0..0, ended: false }
    }

    /// Fills the buffer behind what is still to be read, and makes it larger if that is all of it.
    fn fill(&mut self) -> Result<(), MeshError> {
        self.buffer.copy_within(self.rest.clone(), 0);
        self.rest = 0..self.rest.len();
        if self.rest.end == self.buffer.len() {
            self.buffer.resize(2 * self.rest.end, 0);
        }
        while !self.ended && self.rest.end < self.buffer.len() {
            match self.input.read(&mut self.buffer[self.rest.end..]) {
                Ok(read) => (self.rest.end, self.ended) = (self.rest.end + read, read == 0),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }
}

impl<R: Read> Blocks<R> {
    /// The whole records that are in the buffer, in parts: which they are, and where.
    fn parts(&mut self, size: &Size, records: &mut Range<u64>) -> Vec<(Range<u64>, Range<usize>)> {
        let (mut parts, bytes) = (Vec::new(), &self.buffer[..self.rest.end]);
        loop {
            let (first, begin) = (records.start, self.rest.start);
            while !records.is_empty()
                && self.rest.start - begin < TOGETHER
                && let Some(end) = size.end(bytes, self.rest.start, self.encoding)
            {
                self.rest.start = end;
                records.start += 1;
            }
            if records.start == first {
                return parts;
            }
            parts.push((first..records.start, begin..self.rest.start));
        }
    }
}

impl<R: Read> Records for Blocks<R> {
    fn read<T: Reader>(&mut self, element: &Element, reader: &T) -> Result<T::Output, MeshError> {
        let (mut whole, mut outputs) = (T::Output::default(), Vec::new());
        let (size, encoding) = (Size::of(element), self.encoding);
        let mut records = 0..element.count;
        while !records.is_empty() {
            self.fill().map_err(|error| incomplete(error, element, records.start))?;
            let mut parts = self.parts(&size, &mut records);
            if parts.is_empty() && self.ended {
                // A record that breaks off is read like the others: it may be wrong before it ends.
                parts.push((std::mem::take(&mut records), self.rest.clone()));
            }
            // Outputs are used again for the next parts, with the memory that they have.
            outputs.resize_with(parts.len().max(outputs.len()), T::Output::default);
            let read = |((records, bytes), output): (_, &mut T::Output)| {
                reader.read(records, &mut Binary { bytes: &self.buffer[bytes], encoding }, output)
            };
            let done: Vec<_> = parts.into_par_iter().zip(&mut outputs).map(read).collect();
            for (done, output) in done.into_iter().zip(&mut outputs) {
                done?;
                T::append(&mut whole, output);
            }
        }
        Ok(whole)
    }
}

/// How long binary records are, by the counts of their lists alone.
struct Size {
    lists: Vec<List>,
    /// Bytes behind the last list.
    after: usize,
}

struct List {
    /// Bytes between the list before, or the record's beginning, and the count.
    before: usize,
    count: Scalar,
    /// Bytes of an item.
    item: usize,
}

impl Size {
    fn of(element: &Element) -> Self {
        let mut size = Self { lists: Vec::new(), after: 0 };
        for property in &element.properties {
            let item = property.item.size();
            match property.list {
                Some(count) => size.lists.push(List { before: std::mem::take(&mut size.after), count, item }),
                None => size.after += item,
            }
        }
        size
    }

    /// Where the record ends that begins at a place, if it is all there.
    #[inline]
    fn end(&self, bytes: &[u8], mut at: usize, encoding: Encoding) -> Option<usize> {
        for List { before, count, item } in &self.lists {
            at += before;
            let items = Binary { bytes: bytes.get(at..)?, encoding }.next(*count).ok()? as usize;
            at = items.checked_mul(*item)?.checked_add(at + count.size())?;
        }
        Some(at + self.after).filter(|&end| end <= bytes.len())
    }
}
