//! The records of an element, which are read in blocks and parts.

use super::header::{Element, PlyFormat, ScalarType};
use super::scalars::{AsciiScalars, BinaryScalars, Scalars};
use crate::geometry::mesh::MeshError;
use rayon::prelude::*;
use std::io::{self, BufRead, ErrorKind, Read};
use std::ops::Range;

/// Converts records to output.
pub trait RecordReader: Sync {
    /// The output of a range of records.
    type Output: Default + Send;

    /// Reads the records with these numbers and appends their output to `into`.
    fn read(
        &self,
        records: Range<u64>,
        values: &mut impl Scalars,
        into: &mut Self::Output,
    ) -> Result<(), MeshError>;

    /// Moves the output of a part to the end of the output of all records before it.
    fn append(whole: &mut Self::Output, part: &mut Self::Output);
}

/// A source of records.
pub trait RecordSource {
    /// Reads all records of an element.
    fn read<T: RecordReader>(&mut self, element: &Element, reader: &T) -> Result<T::Output, MeshError>;
}

impl<R: BufRead> RecordSource for AsciiScalars<R> {
    fn read<T: RecordReader>(&mut self, element: &Element, reader: &T) -> Result<T::Output, MeshError> {
        let mut output = T::Output::default();
        reader.read(0..element.count, self, &mut output)?;
        Ok(output)
    }
}

/// The size of a block in bytes.
const BLOCK_SIZE: usize = 1 << 20;

/// The size of a part in bytes. One thread reads one part at a time.
const PART_SIZE: usize = 1 << 15;

/// Binary records, in blocks whose parts are read in parallel.
pub struct BlockReader<R> {
    input: R,
    format: PlyFormat,
    /// Whether the input has ended.
    ended: bool,
    /// The last block. The bytes after its records are not read yet.
    last: Block,
}

#[derive(Default)]
struct Block {
    buffer: Vec<u8>,
    /// The number of valid bytes in the buffer.
    filled: usize,
    /// The number of bytes of its whole records.
    used: usize,
    /// The parts: their records and their bytes.
    parts: Vec<(Range<u64>, Range<usize>)>,
}

impl<R: Read> BlockReader<R> {
    pub fn new(input: R, format: PlyFormat) -> Self {
        Self { input, format, ended: false, last: Block::default() }
    }

    /// Fills `block` with the input after the block `before`, and takes its records from `records`.
    fn read_block(
        &mut self,
        before: &Block,
        block: &mut Block,
        size: &RecordSize,
        records: &mut Range<u64>,
    ) -> Result<(), MeshError> {
        let rest = &before.buffer[before.used..before.filled];
        block.parts.clear();
        block.buffer.resize(BLOCK_SIZE.max(rest.len()), 0);
        block.buffer[..rest.len()].copy_from_slice(rest);
        (block.filled, block.used) = (rest.len(), 0);
        while block.parts.is_empty() && !records.is_empty() {
            if block.filled == block.buffer.len() {
                block.buffer.resize(2 * block.filled, 0);
            }
            self.fill(block)?;
            block.split(size, self.format, records);
            if block.parts.is_empty() && self.ended {
                // Read a truncated record like the others: it may have an error before its end.
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
    /// Splits the whole records into parts.
    fn split(&mut self, size: &RecordSize, format: PlyFormat, records: &mut Range<u64>) {
        let bytes = &self.buffer[..self.filled];
        loop {
            let (first, begin) = (records.start, self.used);
            while !records.is_empty()
                && self.used - begin < PART_SIZE
                && let Some(end) = size.end(bytes, self.used, format)
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

    /// Reads all parts in parallel. If several have errors, returns the first one.
    fn read<T: RecordReader>(
        &self,
        reader: &T,
        format: PlyFormat,
        outputs: &mut Vec<T::Output>,
    ) -> Result<(), MeshError> {
        outputs.resize_with(self.parts.len(), T::Output::default);
        let read = |((records, bytes), output): (&(Range<u64>, Range<usize>), &mut T::Output)| {
            let mut values = BinaryScalars { bytes: &self.buffer[bytes.clone()], format };
            reader.read(records.clone(), &mut values, output)
        };
        let done: Vec<_> = self.parts.par_iter().zip(outputs).map(read).collect();
        done.into_iter().collect()
    }
}

impl<R: Read + Send> RecordSource for BlockReader<R> {
    fn read<T: RecordReader>(&mut self, element: &Element, reader: &T) -> Result<T::Output, MeshError> {
        let (size, format, mut records) = (RecordSize::of(element), self.format, 0..element.count);
        let (mut current, mut next_block) = (std::mem::take(&mut self.last), Block::default());
        let mut whole = T::Output::default();
        // Both are reused to keep their memory.
        let (mut outputs, mut done) = (Vec::new(), Vec::new());
        current.parts.clear();
        loop {
            // While a block is read, append the output of the block before it and fill the next block.
            let (read, follows) = rayon::join(
                || current.read(reader, format, &mut outputs),
                || {
                    done.iter_mut().for_each(|part| T::append(&mut whole, part));
                    let next = records.start;
                    let follows = self.read_block(&current, &mut next_block, &size, &mut records);
                    follows.map_err(|error| element.in_record(error, next))
                },
            );
            read?;
            follows?;
            (current, next_block) = (next_block, current);
            (outputs, done) = (done, outputs);
            if current.parts.is_empty() && done.is_empty() {
                self.last = current;
                return Ok(whole);
            }
        }
    }
}

/// Computes the length of binary records from the counts of their lists.
struct RecordSize {
    lists: Vec<ListSize>,
    /// The number of bytes after the last list.
    after: usize,
}

struct ListSize {
    /// The number of bytes before the count, from the list before or from the start of the record.
    before: usize,
    count: ScalarType,
    /// The size of an item in bytes.
    item: usize,
}

impl RecordSize {
    fn of(element: &Element) -> Self {
        let mut size = Self { lists: Vec::new(), after: 0 };
        for property in &element.properties {
            let item = property.item.size();
            match property.list {
                Some(count) => {
                    size.lists.push(ListSize { before: std::mem::take(&mut size.after), count, item })
                }
                None => size.after += item,
            }
        }
        size
    }

    /// The end of the record that starts at `at`; `None` if it is incomplete.
    #[inline]
    fn end(&self, bytes: &[u8], mut at: usize, format: PlyFormat) -> Option<usize> {
        for ListSize { before, count, item } in &self.lists {
            at += before;
            let items = match count {
                // The type of most files has a fast path, because everything else waits for this count.
                ScalarType::U8 => usize::from(*bytes.get(at)?),
                _ => BinaryScalars { bytes: bytes.get(at..)?, format }.next(*count).ok()? as usize,
            };
            at = items.checked_mul(*item)?.checked_add(at + count.size())?;
        }
        Some(at + self.after).filter(|&end| end <= bytes.len())
    }
}
