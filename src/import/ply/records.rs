//! The records of an element, read in parts.

use super::header::{Element, Encoding, Scalar};
use super::scalars::{Binary, Scalars, Text};
use super::vertices::incomplete;
use crate::geometry::mesh::MeshError;
use rayon::prelude::*;
use std::io::{self, BufRead, ErrorKind, Read};
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

/// Bytes of a block.
const BLOCK: usize = 1 << 20;

/// Bytes of records that one thread reads at a time.
const TOGETHER: usize = 1 << 15;

/// Binary records, in blocks whose parts are read in parallel.
pub struct Blocks<R> {
    input: R,
    encoding: Encoding,
    /// Whether nothing follows.
    ended: bool,
    /// What was had from the input, and behind its records is still to be read.
    last: Block,
}

#[derive(Default)]
struct Block {
    buffer: Vec<u8>,
    /// Bytes in the buffer.
    filled: usize,
    /// Bytes of its records.
    used: usize,
    /// Which records there are, in parts, and where.
    parts: Vec<(Range<u64>, Range<usize>)>,
}

impl<R: Read> Blocks<R> {
    pub fn new(input: R, encoding: Encoding) -> Self {
        Self { input, encoding, ended: false, last: Block::default() }
    }

    /// The block behind another one, with the next of these records.
    fn follow(
        &mut self,
        before: &Block,
        block: &mut Block,
        size: &Size,
        records: &mut Range<u64>,
    ) -> Result<(), MeshError> {
        let rest = &before.buffer[before.used..before.filled];
        block.parts.clear();
        block.buffer.resize(BLOCK.max(rest.len()), 0);
        block.buffer[..rest.len()].copy_from_slice(rest);
        (block.filled, block.used) = (rest.len(), 0);
        while block.parts.is_empty() && !records.is_empty() {
            if block.filled == block.buffer.len() {
                block.buffer.resize(2 * block.filled, 0);
            }
            self.fill(block)?;
            block.cut(size, self.encoding, records);
            if block.parts.is_empty() && self.ended {
                // A record that breaks off is read like the others: it may be wrong before it ends.
                block.parts.push((std::mem::take(records), 0..block.filled));
            }
        }
        Ok(())
    }

    fn fill(&mut self, block: &mut Block) -> io::Result<()> {
        while !self.ended && block.filled < block.buffer.len() {
            match self.input.read(&mut block.buffer[block.filled..]) {
                Ok(0) => self.ended = true,
                Ok(read) => block.filled += read,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

impl Block {
    /// Finds the whole records.
    fn cut(&mut self, size: &Size, encoding: Encoding, records: &mut Range<u64>) {
        let bytes = &self.buffer[..self.filled];
        loop {
            let (first, begin) = (records.start, self.used);
            while !records.is_empty()
                && self.used - begin < TOGETHER
                && let Some(end) = size.end(bytes, self.used, encoding)
            {
                self.used = end;
                records.start += 1;
            }
            if records.start == first {
                return;
            }
            self.parts.push((first..records.start, begin..self.used));
        }
    }

    /// Reads all parts, in parallel. Of several faults it is the first one.
    fn read<T: Reader>(
        &self,
        reader: &T,
        encoding: Encoding,
        outputs: &mut Vec<T::Output>,
    ) -> Result<(), MeshError> {
        outputs.resize_with(self.parts.len(), T::Output::default);
        let read = |((records, bytes), output): (&(Range<u64>, Range<usize>), &mut T::Output)| {
            let mut values = Binary { bytes: &self.buffer[bytes.clone()], encoding };
            reader.read(records.clone(), &mut values, output)
        };
        let done: Vec<_> = self.parts.par_iter().zip(outputs).map(read).collect();
        done.into_iter().collect()
    }
}

impl<R: Read + Send> Records for Blocks<R> {
    fn read<T: Reader>(&mut self, element: &Element, reader: &T) -> Result<T::Output, MeshError> {
        let (size, encoding, mut records) = (Size::of(element), self.encoding, 0..element.count);
        let (mut now, mut soon) = (std::mem::take(&mut self.last), Block::default());
        let mut whole = T::Output::default();
        // Both are used again and again, with the memory that they have.
        let (mut outputs, mut done) = (Vec::new(), Vec::new());
        now.parts.clear();
        loop {
            // While a block is read, what the one before gave is put in its place, and the next one is made ready.
            let (read, follows) = rayon::join(
                || now.read(reader, encoding, &mut outputs),
                || {
                    done.iter_mut().for_each(|part| T::append(&mut whole, part));
                    let next = records.start;
                    let follows = self.follow(&now, &mut soon, &size, &mut records);
                    follows.map_err(|error| incomplete(error, element, next))
                },
            );
            read?;
            follows?;
            (now, soon) = (soon, now);
            (outputs, done) = (done, outputs);
            if now.parts.is_empty() && done.is_empty() {
                self.last = now;
                return Ok(whole);
            }
        }
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
            let items = match count {
                // What most files have, by the shortest way: all that follows waits for it.
                Scalar::U8 => usize::from(*bytes.get(at)?),
                _ => Binary { bytes: bytes.get(at..)?, encoding }.next(*count).ok()? as usize,
            };
            at = items.checked_mul(*item)?.checked_add(at + count.size())?;
        }
        Some(at + self.after).filter(|&end| end <= bytes.len())
    }
}
