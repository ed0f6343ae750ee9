//! File names with a placeholder for the frame number.

use super::place::{folder_of, same_file};
use crate::base::escape;
use std::ffi::{OsStr, OsString};
use std::fmt;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The widest placeholder. No frame number has more digits.
const MAX_DIGITS: usize = 20;

/// A path whose file name holds at most one placeholder for the frame number: a run of `#`, one per digit, or `%d` or
/// `%04d` as in printf. Folder names have no placeholders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramePattern {
    /// The path as the user wrote it.
    text: PathBuf,
    folder: PathBuf,
    before: OsString,
    placeholder: Option<Placeholder>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Placeholder {
    /// Minimum number of digits; larger numbers have more.
    digits: usize,
    after: OsString,
}

/// Why a text is not a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatternError {
    NoFileName,
    TwoPlaceholders,
    /// `%4d` would pad with spaces, which are inconvenient in file names.
    PadsWithSpaces,
    TooWide,
    /// On systems whose file names are not bytes, only valid Unicode can be split.
    NotText,
}

impl FramePattern {
    /// Parses a pattern. A relative path is relative to the working directory.
    pub fn parse(text: impl AsRef<Path>) -> Result<Self, PatternError> {
        let text = text.as_ref();
        let name = text.file_name().ok_or(PatternError::NoFileName)?;
        let folder = text.parent().map(Path::to_path_buf).unwrap_or_default();
        let bytes = name.as_encoded_bytes();
        let (before, placeholder) = match find_placeholder(bytes)? {
            None => (name.to_owned(), None),
            Some(found) => {
                if find_placeholder(&bytes[found.end..])?.is_some() {
                    return Err(PatternError::TwoPlaceholders);
                }
                let after = part(name, found.end..bytes.len())?;
                (part(name, 0..found.start)?, Some(Placeholder { digits: found.digits, after }))
            }
        };
        Ok(Self { text: text.to_owned(), folder, before, placeholder })
    }

    /// The path as the user wrote it.
    pub fn name(&self) -> &Path {
        &self.text
    }

    /// Whether different frames have different names.
    pub fn has_placeholder(&self) -> bool {
        self.placeholder.is_some()
    }

    /// The file of `frame`.
    pub fn path(&self, frame: u32) -> PathBuf {
        let mut name = self.before.clone();
        if let Some(Placeholder { digits, after }) = &self.placeholder {
            name.push(format!("{frame:0digits$}"));
            name.push(after);
        }
        self.folder.join(name)
    }

    /// The numbers of the frames whose files exist, in ascending order.
    pub fn numbers(&self) -> io::Result<Vec<u32>> {
        let mut numbers = Vec::new();
        for entry in folder_of(&self.folder.join("any")).read_dir()? {
            let name = entry?.file_name();
            let number = self.number(&name);
            // Names with other padding parse to the same number, so only the frame's exact name counts.
            numbers.extend(number.filter(|&n| self.path(n).file_name() == Some(&name)));
        }
        numbers.sort_unstable();
        Ok(numbers)
    }

    /// Whether a path is the file of a frame.
    pub fn matches(&self, path: &Path) -> bool {
        let number = path.file_name().and_then(|name| self.number(name));
        number.is_some_and(|number| same_file(&self.path(number), path))
    }

    /// The number in a name of this pattern.
    fn number(&self, name: &OsStr) -> Option<u32> {
        let placeholder = self.placeholder.as_ref()?;
        let rest = name.as_encoded_bytes().strip_prefix(self.before.as_encoded_bytes())?;
        let digits = rest.strip_suffix(placeholder.after.as_encoded_bytes())?;
        // `parse` would accept a sign.
        digits.iter().all(u8::is_ascii_digit).then(|| str::from_utf8(digits).ok()?.parse().ok())?
    }

    /// The same name with a placeholder before the extension, for messages.
    pub fn suggestion(&self) -> String {
        let mut name = self.text.file_stem().unwrap_or_default().to_owned();
        name.push("_####.");
        name.push(self.text.extension().unwrap_or_default());
        escape::path(self.folder.join(name))
    }
}

impl fmt::Display for FramePattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&escape::path(&self.text))
    }
}

/// A placeholder at the bytes `start..end` of a name, and its number of digits.
struct PlaceholderMatch {
    start: usize,
    end: usize,
    digits: usize,
}

/// A part of a name. Its ends must be next to ASCII characters.
#[cfg(unix)]
fn part(name: &OsStr, range: Range<usize>) -> Result<OsString, PatternError> {
    use std::os::unix::ffi::OsStrExt;
    Ok(OsStr::from_bytes(&name.as_bytes()[range]).to_owned())
}

#[cfg(not(unix))]
fn part(name: &OsStr, range: Range<usize>) -> Result<OsString, PatternError> {
    name.to_str().and_then(|name| name.get(range)).map(Into::into).ok_or(PatternError::NotText)
}

fn find_placeholder(name: &[u8]) -> Result<Option<PlaceholderMatch>, PatternError> {
    for (start, letter) in name.iter().enumerate() {
        let rest = &name[start + 1..];
        let found = match letter {
            b'#' => {
                let digits = 1 + rest.iter().take_while(|&&b| b == b'#').count();
                PlaceholderMatch { start, end: start + digits, digits }
            }
            b'%' => {
                let number = rest.iter().take_while(|b| b.is_ascii_digit()).count();
                if rest.get(number) != Some(&b'd') {
                    continue;
                }
                if number > 0 && !rest.starts_with(b"0") {
                    return Err(PatternError::PadsWithSpaces);
                }
                let digits = str::from_utf8(&rest[..number]).ok().and_then(|digits| digits.parse().ok());
                let digits = if number == 0 { 1 } else { digits.unwrap_or(usize::MAX) };
                PlaceholderMatch { start, end: start + number + 2, digits }
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
        escape::path(FramePattern::parse(pattern).expect(pattern).path(frame))
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
    fn large_numbers_have_more_digits() {
        assert_eq!(path("##.png", 12_345), "12345.png");
        assert_eq!(path("%02d.png", u32::MAX), "4294967295.png");
    }

    #[test]
    fn only_the_file_name_has_a_placeholder() {
        assert_eq!(path("c#/%d/f_##.png", 3), "c#/%d/f_03.png");
        assert!(!FramePattern::parse("c#/100%.png").expect("a still's name").has_placeholder());
    }

    #[test]
    fn refusals() {
        let error = |text| FramePattern::parse(text).expect_err(text);
        assert_eq!(error("a_##_##.png"), PatternError::TwoPlaceholders);
        assert_eq!(error("a_%d_##.png"), PatternError::TwoPlaceholders);
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
        let pattern = FramePattern::parse(dir.path().join("f_####.png")).expect("a pattern");
        assert_eq!(pattern.numbers().expect("a folder"), [7, 10, 12_345]);
    }

    #[cfg(unix)]
    #[test]
    fn names_need_not_be_unicode() {
        use std::os::unix::ffi::OsStrExt;
        let name = |bytes: &'static [u8]| Path::new(OsStr::from_bytes(bytes));
        let pattern = FramePattern::parse(name(b"o\xff/a\xff_##\xfe.png")).expect("a pattern");
        assert_eq!(pattern.path(7), name(b"o\xff/a\xff_07\xfe.png"));
        assert_eq!(pattern.number(name(b"a\xff_12\xfe.png").as_os_str()), Some(12));
        assert_eq!(pattern.to_string(), r"o\xff/a\xff_##\xfe.png");
    }

    #[test]
    fn paths_of_frames_are_recognized() {
        let pattern = FramePattern::parse("a/f_##.png").expect("a pattern");
        for (path, own) in [
            ("a/f_05.png", true),
            ("./a/f_123.png", true),
            ("a/f_5.png", false),
            ("a/f_005.png", false),
            ("a/g_05.png", false),
            ("f_05.png", false),
        ] {
            assert_eq!(pattern.matches(Path::new(path)), own, "{path}");
        }
    }

    #[test]
    fn suggestions_keep_the_folder() {
        let pattern = FramePattern::parse("out/frame.png").expect("a still's name");
        assert_eq!(pattern.suggestion(), "out/frame_####.png");
    }
}
