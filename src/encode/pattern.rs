//! File names with a place for the frame number.

use super::atomic::folder_of;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// The widest place that is taken for one; no sequence has more digits in its frame numbers.
const MAX_DIGITS: usize = 20;

/// A path whose file name holds at most one place for the frame number: a run of `#` (as many digits as
/// it is long) or `%d` and `%04d` as printf has them. Folders are taken as they are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramePattern {
    /// What the user wrote.
    text: String,
    folder: PathBuf,
    before: String,
    place: Option<Place>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Place {
    /// Smallest number of digits; longer numbers just grow.
    digits: usize,
    after: String,
}

/// Why a text is no pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatternError {
    NoFileName,
    TwoPlaces,
    /// `%4d` would pad with spaces, which no one wants in a file name.
    PadsWithSpaces,
    TooWide,
}

impl FramePattern {
    /// Reads a pattern; the path is relative to the working directory as given.
    pub fn parse(text: &str) -> Result<Self, PatternError> {
        let path = Path::new(text);
        let name = path.file_name().and_then(|name| name.to_str()).ok_or(PatternError::NoFileName)?;
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        let (before, place) = match find_place(name)? {
            None => (name.to_owned(), None),
            Some(found) => {
                let after = &name[found.end..];
                if find_place(after)?.is_some() {
                    return Err(PatternError::TwoPlaces);
                }
                let place = Place { digits: found.digits, after: after.to_owned() };
                (name[..found.start].to_owned(), Some(place))
            }
        };
        Ok(Self { text: text.to_owned(), folder, before, place })
    }

    /// Whether different frames get different names.
    pub fn has_place(&self) -> bool {
        self.place.is_some()
    }

    /// The file of `frame`.
    pub fn path(&self, frame: u32) -> PathBuf {
        let name = match &self.place {
            None => self.before.clone(),
            Some(Place { digits, after }) => format!("{}{frame:0digits$}{after}", self.before),
        };
        self.folder.join(name)
    }

    /// The numbers of the frames whose files are there, in rising order.
    pub fn numbers(&self) -> io::Result<Vec<u32>> {
        let mut numbers = Vec::new();
        for entry in folder_of(&self.folder.join("any")).read_dir()? {
            let name = entry?.file_name();
            let number = name.to_str().and_then(|name| self.number(name));
            // Other names may read as the same number; a frame's own is the one that it would be given.
            numbers.extend(number.filter(|&n| self.path(n).file_name() == Some(&name)));
        }
        numbers.sort_unstable();
        Ok(numbers)
    }

    /// The number in a name of this pattern.
    fn number(&self, name: &str) -> Option<u32> {
        let place = self.place.as_ref()?;
        let digits = name.strip_prefix(&self.before)?.strip_suffix(&place.after)?;
        digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse().ok())?
    }

    /// The same name with a place before the extension, to suggest.
    pub fn suggestion(&self) -> String {
        let path = Path::new(&self.text);
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        self.folder.join(format!("{stem}_####.{extension}")).display().to_string()
    }
}

impl fmt::Display for FramePattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Bytes `start..end` of a name, and the digits they ask for.
struct Found {
    start: usize,
    end: usize,
    digits: usize,
}

fn find_place(name: &str) -> Result<Option<Found>, PatternError> {
    for (start, c) in name.char_indices() {
        let rest = &name[start + c.len_utf8()..];
        let found = match c {
            '#' => {
                let digits = 1 + rest.bytes().take_while(|&b| b == b'#').count();
                Found { start, end: start + digits, digits }
            }
            '%' => {
                let number = rest.bytes().take_while(u8::is_ascii_digit).count();
                if rest.as_bytes().get(number) != Some(&b'd') {
                    continue;
                }
                if number > 0 && !rest.starts_with('0') {
                    return Err(PatternError::PadsWithSpaces);
                }
                let digits = if number == 0 { 1 } else { rest[..number].parse().unwrap_or(usize::MAX) };
                Found { start, end: start + number + 2, digits }
            }
            _ => continue,
        };
        return if found.digits > MAX_DIGITS { Err(PatternError::TooWide) } else { Ok(Some(found)) };
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(pattern: &str, frame: u32) -> String {
        FramePattern::parse(pattern).expect(pattern).path(frame).display().to_string()
    }

    #[test]
    fn both_notations() {
        assert_eq!(path("out/frame_####.png", 7), "out/frame_0007.png");
        assert_eq!(path("frame_%04d.png", 7), "frame_0007.png");
        assert_eq!(path("frame_%d.png", 7), "frame_7.png");
        assert_eq!(path("#.png", 7), "7.png");
        assert_eq!(path("bild-ä-##-é.png", 7), "bild-ä-07-é.png");
    }

    #[test]
    fn wide_numbers_grow() {
        assert_eq!(path("##.png", 12_345), "12345.png");
        assert_eq!(path("%02d.png", u32::MAX), "4294967295.png");
    }

    #[test]
    fn only_the_file_name_has_a_place() {
        assert_eq!(path("c#/%d/f_##.png", 3), "c#/%d/f_03.png");
        assert!(!FramePattern::parse("c#/100%.png").expect("a still's name").has_place());
    }

    #[test]
    fn refusals() {
        let error = |text| FramePattern::parse(text).expect_err(text);
        assert_eq!(error("a_##_##.png"), PatternError::TwoPlaces);
        assert_eq!(error("a_%d_##.png"), PatternError::TwoPlaces);
        assert_eq!(error("a_%4d.png"), PatternError::PadsWithSpaces);
        assert_eq!(error("a_%099999999999999999999d.png"), PatternError::TooWide);
        assert_eq!(error(".."), PatternError::NoFileName);
        assert_eq!(error(""), PatternError::NoFileName);
    }

    #[test]
    fn frames_are_found_by_their_own_names() {
        let dir = tempfile::tempdir().expect("a folder");
        for name in
            ["f_0007.png", "f_0010.png", "f_12345.png", "f_11.png", "f_.png", "g_0001.png", "f_-001.png"]
        {
            std::fs::write(dir.path().join(name), "").expect("a disk");
        }
        let pattern =
            FramePattern::parse(&dir.path().join("f_####.png").to_string_lossy()).expect("a pattern");
        assert_eq!(pattern.numbers().expect("a folder"), [7, 10, 12_345]);
    }

    #[test]
    fn suggestions_keep_the_folder() {
        let pattern = FramePattern::parse("out/frame.png").expect("a still's name");
        assert_eq!(pattern.suggestion(), "out/frame_####.png");
    }
}
