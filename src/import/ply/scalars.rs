//! The numbers of PLY records, in all formats.

use super::header::{PlyFormat, Property, ScalarType};
use crate::geometry::mesh::{MeshError, MeshLocation};
use crate::import::lines::{Lines, parsed, quoted};
use std::io::BufRead;

/// Reads the numbers of records. f64 represents every type of number exactly.
pub trait Scalars {
    /// Starts the next record.
    fn begin(&mut self) -> Result<(), MeshError>;

    /// The next number of the record.
    fn next(&mut self, scalar: ScalarType) -> Result<f64, MeshError>;

    /// Reads a whole record, in place of the calls from `begin` to `end`, if it is a list of three integers below a
    /// limit. Otherwise, and for types or byte orders that few files have, it reads nothing and returns none.
    fn triangle(&mut self, _count: ScalarType, _item: ScalarType, _below: u64) -> Option<[u32; 3]> {
        None
    }

    /// Reads a whole record of floats, in place of the calls from `begin` to `end`. If it cannot read them at once,
    /// it reads nothing and returns false.
    fn floats(&mut self, _into: &mut [f32]) -> bool {
        false
    }

    /// Ends the record.
    fn end(&mut self) -> Result<(), MeshError>;

    /// The number of the record's line; `None` for binary records.
    fn line(&self) -> Option<u64>;
}

/// Records as lines of text.
pub struct AsciiScalars<R> {
    lines: Lines<R>,
    /// The current record.
    line: Vec<u8>,
    /// The number of bytes of the record that are read.
    at: usize,
    number: u64,
}

impl<R: BufRead> AsciiScalars<R> {
    pub fn new(lines: Lines<R>) -> Self {
        Self { lines, line: Vec::new(), at: 0, number: 0 }
    }

    fn fault(&self, why: String) -> MeshError {
        MeshError::at(MeshLocation::Line(self.number), why)
    }

    fn word(&mut self) -> Option<&[u8]> {
        let rest = &self.line[self.at..];
        let start = self.at + rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let rest = &self.line[start..];
        self.at = start + rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        Some(&self.line[start..self.at])
    }
}

impl<R: BufRead> Scalars for AsciiScalars<R> {
    fn begin(&mut self) -> Result<(), MeshError> {
        loop {
            let Some((number, line)) = self.lines.next()? else {
                return Err(ends());
            };
            if !line.is_empty() {
                self.line.clear();
                self.line.extend_from_slice(line);
                (self.at, self.number) = (0, number);
                return Ok(());
            }
        }
    }

    /// Rounds floats to f32, as in a binary file.
    fn next(&mut self, scalar: ScalarType) -> Result<f64, MeshError> {
        let Some(word) = self.word() else {
            return Err(self.fault(format!("the line ends too early: {}", quoted(&self.line))));
        };
        let value = match scalar {
            ScalarType::F32 => parsed::<f32>(word).map(f64::from),
            ScalarType::F64 => parsed(word),
            // Some programs write integers as `3.0`.
            _ => parsed(word).filter(|value: &f64| value.fract() == 0.0),
        };
        let Some(value) = value else {
            let what = if matches!(scalar, ScalarType::F32 | ScalarType::F64) {
                "a number"
            } else {
                "a whole number"
            };
            let why = format!("expected {what}, found {}", quoted(word));
            return Err(self.fault(why));
        };
        Ok(value)
    }

    fn end(&mut self) -> Result<(), MeshError> {
        match self.word().map(quoted) {
            None => Ok(()),
            Some(more) => Err(self.fault(format!("the line should end before {more}"))),
        }
    }

    fn line(&self) -> Option<u64> {
        Some(self.number)
    }
}

#[cold]
fn ends() -> MeshError {
    MeshError::new("the file ends")
}

/// Records as bytes.
pub struct BinaryScalars<'b> {
    pub bytes: &'b [u8],
    pub format: PlyFormat,
}

impl BinaryScalars<'_> {
    /// The next `N` bytes, in little-endian order.
    #[inline(always)]
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], MeshError> {
        let Some((bytes, rest)) = self.bytes.split_first_chunk() else {
            return Err(ends());
        };
        self.bytes = rest;
        let mut bytes = *bytes;
        if self.format == PlyFormat::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl Scalars for BinaryScalars<'_> {
    fn begin(&mut self) -> Result<(), MeshError> {
        Ok(())
    }

    #[inline(always)]
    fn next(&mut self, scalar: ScalarType) -> Result<f64, MeshError> {
        Ok(match scalar {
            ScalarType::I8 => i8::from_le_bytes(self.bytes()?).into(),
            ScalarType::U8 => u8::from_le_bytes(self.bytes()?).into(),
            ScalarType::I16 => i16::from_le_bytes(self.bytes()?).into(),
            ScalarType::U16 => u16::from_le_bytes(self.bytes()?).into(),
            ScalarType::I32 => i32::from_le_bytes(self.bytes()?).into(),
            ScalarType::U32 => u32::from_le_bytes(self.bytes()?).into(),
            ScalarType::F32 => f32::from_le_bytes(self.bytes()?).into(),
            ScalarType::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    #[inline(always)]
    fn floats(&mut self, into: &mut [f32]) -> bool {
        let Some((bytes, rest)) = self.bytes.split_at_checked(4 * into.len()) else { return false };
        if self.format != PlyFormat::LittleEndian {
            return false;
        }
        for (float, bytes) in into.iter_mut().zip(bytes.as_chunks().0) {
            *float = f32::from_le_bytes(*bytes);
        }
        self.bytes = rest;
        true
    }

    #[inline(always)]
    fn triangle(&mut self, count: ScalarType, item: ScalarType, below: u64) -> Option<[u32; 3]> {
        let whole =
            matches!((count, item), (ScalarType::U8 | ScalarType::I8, ScalarType::U32 | ScalarType::I32));
        if !whole || self.format != PlyFormat::LittleEndian {
            return None;
        }
        let ([3, indices @ ..], rest) = self.bytes.split_first_chunk::<13>()? else { return None };
        // A negative i32 reads as a u32 of at least 2^31.
        let below = if item == ScalarType::I32 { below.min(1 << 31) } else { below };
        let mut triangle = [0; 3];
        for (vertex, bytes) in triangle.iter_mut().zip(indices.as_chunks::<4>().0) {
            *vertex = u32::from_le_bytes(*bytes);
        }
        let known = triangle.iter().all(|vertex| u64::from(*vertex) < below);
        known.then(|| {
            self.bytes = rest;
            triangle
        })
    }

    fn end(&mut self) -> Result<(), MeshError> {
        Ok(())
    }

    fn line(&self) -> Option<u64> {
        None
    }
}

/// Skips a list.
pub fn skip_list(property: &Property, count: ScalarType, values: &mut impl Scalars) -> Result<(), MeshError> {
    let count = values.next(count)?;
    (0..count as u64).try_for_each(|_| values.next(property.item).map(|_| ()))
}
