//! Files whose names hold a number.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The most files of a series.
const MAX_FILES: usize = 100_000;

/// The most missing files that are named.
const MOST_NAMES: usize = 4;

/// Names of files around a number, such as `wave_####.ply`: one `#` for each digit, filled up with zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Pattern<'a> {
    before: &'a str,
    digits: usize,
    after: &'a str,
}

/// Why files cannot be numbered.
#[derive(Debug)]
pub enum NumberedError {
    /// The name has no `#`, or `#` in several places or in the name of the folder.
    NoPattern,
    Unreadable(io::Error),
    /// No file has such a name, or none within the wanted numbers.
    None,
    TooMany,
    /// Files between the first and the last are missing.
    Missing {
        /// The first names.
        names: Vec<String>,
        /// The number of all that are missing.
        missing: u64,
        /// The greatest common divisor of the differences of the numbers that are there; 0 if there is one number.
        apart: u64,
    },
}

impl<'a> Pattern<'a> {
    fn parse(name: &'a str) -> Option<Self> {
        let start = name.find('#')?;
        let digits = name[start..].bytes().take_while(|byte| *byte == b'#').count();
        let (before, after) = (&name[..start], &name[start + digits..]);
        (!after.contains('#')).then_some(Self { before, digits, after })
    }

    /// The number in a name.
    fn number(&self, name: &str) -> Option<u64> {
        let number = name.strip_prefix(self.before)?.strip_suffix(self.after)?;
        let is_number = number.bytes().all(|byte| byte.is_ascii_digit());
        let fits = number.len() == self.digits || number.len() > self.digits && !number.starts_with('0');
        number.parse().ok().filter(|_| is_number && fits)
    }

    /// The numbers of all files in a folder, ascending.
    fn numbers_in(&self, folder: &Path) -> io::Result<Vec<u64>> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let mut numbers = Vec::new();
        for entry in fs::read_dir(folder)? {
            numbers.extend(entry?.file_name().to_str().and_then(|name| self.number(name)));
        }
        numbers.sort_unstable();
        Ok(numbers)
    }

    fn name(&self, number: u64) -> String {
        let Self { before, digits, after } = self;
        format!("{before}{number:0digits$}{after}")
    }
}

/// Which numbers a series has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NumberRange {
    /// The first and the last number; none for the lowest and the highest that are there.
    pub first: Option<u64>,
    pub last: Option<u64>,
    /// From one number to the next, at least 1. Files with other numbers do not belong to the series.
    pub step: u64,
}

impl Default for NumberRange {
    fn default() -> Self {
        Self { first: None, last: None, step: 1 }
    }
}

/// The files with the names of a pattern, in the order of their numbers.
///
/// # Errors
/// If files are missing between the first and the last, or if there are none.
pub fn numbered(path: &Path, range: NumberRange) -> Result<Vec<PathBuf>, NumberedError> {
    let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let folder = path.parent().unwrap_or(Path::new(""));
    let pattern = Pattern::parse(&name).filter(|_| !folder.to_string_lossy().contains('#'));
    let pattern = pattern.ok_or(NumberedError::NoPattern)?;
    let all = pattern.numbers_in(folder).map_err(NumberedError::Unreadable)?;
    let within = |number: &u64| {
        range.first.is_none_or(|first| first <= *number) && range.last.is_none_or(|last| *number <= last)
    };
    let mut numbers: Vec<u64> = all.into_iter().filter(within).collect();
    let (Some(&low), Some(&high)) = (numbers.first(), numbers.last()) else {
        return Err(NumberedError::None);
    };
    let (first, last) = (range.first.unwrap_or(low), range.last.unwrap_or(high));
    numbers.retain(|number| (number - first).is_multiple_of(range.step));
    let count = (last - first) / range.step + 1;
    let wanted = (0..count).map(|index| first + index * range.step);
    let missing = count - numbers.len() as u64;
    if missing > 0 {
        let apart = numbers.windows(2).map(|pair| pair[1] - pair[0]).fold(0, divisor);
        let absent = wanted.filter(|number| numbers.binary_search(number).is_err());
        let names = absent.take(MOST_NAMES).map(|number| pattern.name(number)).collect();
        return Err(NumberedError::Missing { names, missing, apart });
    }
    if numbers.len() > MAX_FILES {
        return Err(NumberedError::TooMany);
    }
    Ok(wanted.map(|number| folder.join(pattern.name(number))).collect())
}

/// The greatest common divisor (Euclid).
fn divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(names: &[&str], pattern: &str, range: NumberRange) -> Result<Vec<String>, NumberedError> {
        let folder = tempfile::tempdir().expect("a folder");
        names.iter().for_each(|name| fs::write(folder.path().join(name), "").expect("a disk"));
        let name = |path: &PathBuf| path.file_name().expect("a name").to_string_lossy().into_owned();
        numbered(&folder.path().join(pattern), range).map(|found| found.iter().map(name).collect())
    }

    fn range(first: u64, last: u64, step: u64) -> NumberRange {
        NumberRange { first: Some(first), last: Some(last), step }
    }

    const ALL: NumberRange = NumberRange { first: None, last: None, step: 1 };

    #[test]
    fn numbers_order_the_files() {
        let names =
            ["a_9999.ply", "a_10000.ply", "a_9998.ply", "a_09999.ply", "a_998.ply", "a_x.ply", "b_0001.ply"];
        let all = found(&names, "a_####.ply", ALL).expect("files");
        assert_eq!(all, ["a_9998.ply", "a_9999.ply", "a_10000.ply"]);
        let some = found(&names, "a_####.ply", range(9999, 10_000, 1)).expect("files");
        assert_eq!(some, ["a_9999.ply", "a_10000.ply"]);
        let fives = found(&["s0", "s7", "s10", "s5"], "s#", NumberRange { step: 5, ..ALL }).expect("files");
        assert_eq!(fives, ["s0", "s5", "s10"]);
    }

    #[test]
    fn missing_files_are_named() {
        let missing = |names: &[&str], range| match found(names, "a##.ply", range) {
            Err(NumberedError::Missing { names, missing, apart }) => (names.join(" "), missing, apart),
            other => panic!("{other:?}"),
        };
        assert_eq!(missing(&["a00.ply", "a01.ply", "a03.ply"], ALL), ("a02.ply".to_owned(), 1, 1));
        let tens = ["a00.ply", "a10.ply", "a30.ply"];
        assert_eq!(missing(&tens, NumberRange { step: 10, ..ALL }), ("a20.ply".to_owned(), 1, 10));
        assert_eq!(missing(&tens, ALL), ("a01.ply a02.ply a03.ply a04.ply".to_owned(), 28, 10));
        let two = ["a00.ply", "a01.ply"];
        assert_eq!(missing(&two, range(0, 2, 1)).0, "a02.ply");
        assert!(matches!(found(&two, "a##.ply", range(40, 50, 1)), Err(NumberedError::None)));
    }

    #[test]
    fn patterns_have_one_number() {
        for pattern in ["a.ply", "a#b#.ply", "#/a#.ply"] {
            assert!(matches!(found(&[], pattern, ALL), Err(NumberedError::NoPattern)), "{pattern}");
        }
        assert!(matches!(found(&[], "a#.ply", ALL), Err(NumberedError::None)));
    }
}
