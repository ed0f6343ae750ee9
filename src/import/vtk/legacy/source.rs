//! The lines and numbers of a legacy file, as text or in binary.

use super::super::number::NumberType;
use crate::base::machine;
use crate::base::units::count;
use crate::geometry::mesh::{MeshError, MeshLocation};
use crate::import::lines::quoted;
use std::borrow::Cow;

/// A file that is read from its start.
pub struct Source<'b> {
    pub binary: bool,
    /// The bytes that are not read yet.
    rest: &'b [u8],
    /// The current line and its number.
    line: &'b [u8],
    number: u64,
    /// The bytes of the current line whose words are read.
    at: usize,
    /// The place of the current line, and of the rest, in bytes.
    begin: u64,
    byte: u64,
}

impl<'b> Source<'b> {
    pub fn new(bytes: &'b [u8]) -> Self {
        Self { binary: false, rest: bytes, line: &[], number: 0, at: 0, begin: 0, byte: 0 }
    }

    /// Reads the next line; false at the end of the file.
    fn advance(&mut self) -> bool {
        let end = self.rest.iter().position(|&byte| byte == b'\n').map_or(self.rest.len(), |end| end + 1);
        self.line = self.take(end);
        (self.number, self.at) = (self.number + 1, 0);
        end > 0
    }

    /// Takes some of the remaining bytes.
    fn take(&mut self, amount: usize) -> &'b [u8] {
        let (taken, rest) = self.rest.split_at(amount);
        (self.begin, self.byte) = (self.byte, self.byte + amount as u64);
        self.rest = rest;
        taken
    }

    /// The next line without surrounding blanks. None at the end of the file.
    pub fn line(&mut self) -> Option<Cow<'b, str>> {
        if !self.advance() {
            return None;
        }
        self.at = self.line.len();
        Some(String::from_utf8_lossy(self.line.trim_ascii()))
    }

    /// The words of the next line that is not blank, or of the rest of the current one. None at the end of the file.
    pub fn words(&mut self) -> Option<Vec<String>> {
        loop {
            let rest = self.line[self.at..].trim_ascii();
            if !rest.is_empty() {
                let words =
                    String::from_utf8_lossy(rest).split_ascii_whitespace().map(str::to_owned).collect();
                self.at = self.line.len();
                return Some(words);
            }
            if !self.advance() {
                return None;
            }
        }
    }

    /// Whether the next line that is not blank begins with `OFFSETS`.
    pub fn offsets_follow(&self) -> bool {
        // A binary number may begin with a byte that is a blank, but no number with this word.
        let next = if self.binary { self.rest } else { self.rest.trim_ascii_start() };
        next.get(..7).is_some_and(|start| start.eq_ignore_ascii_case(b"OFFSETS"))
    }

    /// An error at the current line. Lines have no numbers after binary data.
    pub fn fault(&self, why: impl Into<String>) -> MeshError {
        let place =
            if self.binary { MeshLocation::Byte(self.begin) } else { MeshLocation::Line(self.number) };
        MeshError::at(place, why)
    }

    /// The error of a line that should be `what`.
    pub fn unexpected(&self, what: &str) -> MeshError {
        self.fault(format!("expected {what}, found {}", quoted(self.line.trim_ascii())))
    }

    /// Reads numbers of one type, which are `what`.
    pub fn numbers(&mut self, amount: u64, kind: NumberType, what: &str) -> Result<Vec<f64>, MeshError> {
        let least = match self.binary {
            true => amount.saturating_mul(kind.bits()).div_ceil(8),
            // A digit and a separator each, but for the last.
            false => amount.saturating_mul(2).saturating_sub(1),
        };
        if least > self.left() {
            let (amount, left) = (count(amount), count(self.left()));
            return Err(
                self.fault(format!("{amount} numbers of {what} do not fit into the remaining {left} bytes"))
            );
        }
        machine::check_memory(amount.saturating_mul(8))?;
        if !self.binary {
            return self.text_numbers(amount, what);
        }
        let mut numbers = kind.numbers(self.take(least as usize), true);
        // Bits fill whole bytes.
        numbers.truncate(amount as usize);
        (self.line, self.at) = (&[], 0);
        Ok(numbers)
    }

    /// The bytes that may hold numbers. In text, these begin in the current line.
    fn left(&self) -> u64 {
        let line = if self.binary { 0 } else { self.line.len() - self.at };
        (self.rest.len() + line) as u64
    }

    fn text_numbers(&mut self, amount: u64, what: &str) -> Result<Vec<f64>, MeshError> {
        let mut numbers = Vec::with_capacity(amount as usize);
        while (numbers.len() as u64) < amount {
            let rest = &self.line[self.at..];
            let Some(start) = rest.iter().position(|byte| !byte.is_ascii_whitespace()) else {
                if !self.advance() {
                    let (found, amount) = (count(numbers.len() as u64), count(amount));
                    return Err(
                        self.fault(format!("the file ends after {found} of {amount} numbers of {what}"))
                    );
                }
                continue;
            };
            let word = &rest[start..];
            let word = &word[..word.iter().position(u8::is_ascii_whitespace).unwrap_or(word.len())];
            let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
            let Some(number) = number else {
                let why = format!(
                    "expected number {} of {} of {what}, found {}",
                    numbers.len() + 1,
                    amount,
                    quoted(word)
                );
                return Err(self.fault(why));
            };
            numbers.push(number);
            self.at += start + word.len();
        }
        Ok(numbers)
    }
}
