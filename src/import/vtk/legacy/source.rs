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

    /// Skips the lines up to a blank one.
    pub fn skip_section(&mut self) {
        while self.line().is_some_and(|line| !line.is_empty()) {}
    }

    /// Skips texts, which are `what`: one per line or, in binary files, each after its length.
    pub fn skip_texts(&mut self, amount: u64, what: &str) -> Result<(), MeshError> {
        for index in 0..amount {
            let skipped = if self.binary { self.skip_binary_text() } else { self.advance() };
            if !skipped {
                let (index, amount) = (count(index), count(amount));
                return Err(self.fault(format!("the file ends after {index} of {amount} texts of {what}")));
            }
        }
        self.at = self.line.len();
        Ok(())
    }

    /// Skips a text after its length; false if the file is too short. The two highest bits of the length state its own
    /// size: 3 for one byte, 2 for two, 1 for four and 0 for eight.
    fn skip_binary_text(&mut self) -> bool {
        let Some(&first) = self.rest.first() else { return false };
        let size = 1 << (3 - (first >> 6));
        let Some(bytes) = self.rest.get(..size) else { return false };
        let length = bytes.iter().fold(0, |length: u64, byte| length << 8 | u64::from(*byte));
        let length = length & (u64::MAX >> (64 - 8 * size + 2));
        let end = usize::try_from(length).ok().and_then(|length| length.checked_add(size));
        let Some(end) = end.filter(|end| *end <= self.rest.len()) else { return false };
        self.take(end);
        (self.line, self.at) = (&[], 0);
        true
    }

    /// The place of the current line. Lines have no numbers after binary data.
    pub fn place(&self) -> MeshLocation {
        if self.binary { MeshLocation::Byte(self.begin) } else { MeshLocation::Line(self.number) }
    }

    /// An error at the current line.
    pub fn fault(&self, why: impl Into<String>) -> MeshError {
        MeshError::at(self.place(), why)
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
