//! The numbers of a PLY file, one after another, however they are written.

use super::header::{Encoding, Scalar};
use crate::geometry::mesh::{MeshError, Place};
use crate::import::lines::{Lines, parsed, quoted};
use std::io::BufRead;

/// Numbers in records. Every type of number fits into f64.
pub trait Scalars {
    /// Goes to the next record.
    fn begin(&mut self) -> Result<(), MeshError>;

    /// The next number of the record.
    fn next(&mut self, scalar: Scalar) -> Result<f64, MeshError>;

    /// A whole record, instead of all from `begin` to `end`, that is a list of three whole numbers below a limit; none if
    /// it is another one, or of types or in an order of bytes that few files have. Then nothing has been read.
    fn triangle(&mut self, _count: Scalar, _item: Scalar, _below: u64) -> Option<[u32; 3]> {
        None
    }

    /// A whole record of floats, instead of all from `begin` to `end`; false if it cannot be read at once. Then nothing has
    /// been read.
    fn floats(&mut self, _into: &mut [f32]) -> bool {
        false
    }

    /// The record is over.
    fn end(&mut self) -> Result<(), MeshError>;

    /// The line that a record stands in, if it does.
    fn line(&self) -> Option<u64>;
}

/// Records as lines of text.
pub struct Text<R> {
    lines: Lines<R>,
    /// The record, and how far it has been read.
    line: Vec<u8>,
    at: usize,
    number: u64,
}

impl<R: BufRead> Text<R> {
    pub fn new(lines: Lines<R>) -> Self {
        Self { lines, line: Vec::new(), at: 0, number: 0 }
    }

    fn fault(&self, why: String) -> MeshError {
        MeshError::at(Place::Line(self.number), why)
    }

    fn word(&mut self) -> Option<&[u8]> {
        let rest = &self.line[self.at..];
        let start = self.at + rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let rest = &self.line[start..];
        self.at = start + rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        Some(&self.line[start..self.at])
    }
}

impl<R: BufRead> Scalars for Text<R> {
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

    /// Floats are rounded to f32 as they would be in a binary file.
    fn next(&mut self, scalar: Scalar) -> Result<f64, MeshError> {
        let Some(word) = self.word() else {
            return Err(self.fault(format!("the line ends too early: {}", quoted(&self.line))));
        };
        let value = match scalar {
            Scalar::F32 => parsed::<f32>(word).map(f64::from),
            Scalar::F64 => parsed(word),
            // Some programs write whole numbers as `3.0`.
            _ => parsed(word).filter(|value: &f64| value.fract() == 0.0),
        };
        let Some(value) = value else {
            let what =
                if matches!(scalar, Scalar::F32 | Scalar::F64) { "a number" } else { "a whole number" };
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
pub struct Binary<'b> {
    pub bytes: &'b [u8],
    pub encoding: Encoding,
}

impl Binary<'_> {
    /// The next `N` bytes, the lowest first.
    #[inline(always)]
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], MeshError> {
        let Some((bytes, rest)) = self.bytes.split_first_chunk() else {
            return Err(ends());
        };
        self.bytes = rest;
        let mut bytes = *bytes;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl Scalars for Binary<'_> {
    fn begin(&mut self) -> Result<(), MeshError> {
        Ok(())
    }

    #[inline(always)]
    fn next(&mut self, scalar: Scalar) -> Result<f64, MeshError> {
        Ok(match scalar {
            Scalar::I8 => i8::from_le_bytes(self.bytes()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.bytes()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.bytes()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.bytes()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.bytes()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.bytes()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.bytes()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    #[inline(always)]
    fn floats(&mut self, into: &mut [f32]) -> bool {
        let Some((bytes, rest)) = self.bytes.split_at_checked(4 * into.len()) else { return false };
        if self.encoding != Encoding::LittleEndian {
            return false;
        }
        for (float, bytes) in into.iter_mut().zip(bytes.as_chunks().0) {
            *float = f32::from_le_bytes(*bytes);
        }
        self.bytes = rest;
        true
    }

    #[inline(always)]
    fn triangle(&mut self, count: Scalar, item: Scalar, below: u64) -> Option<[u32; 3]> {
        let whole = matches!((count, item), (Scalar::U8 | Scalar::I8, Scalar::U32 | Scalar::I32));
        if !whole || self.encoding != Encoding::LittleEndian {
            return None;
        }
        let ([3, indices @ ..], rest) = self.bytes.split_first_chunk::<13>()? else { return None };
        // What is negative reads as what no signed number is.
        let below = if item == Scalar::I32 { below.min(1 << 31) } else { below };
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
