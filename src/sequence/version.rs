//! The oldest version of Kinora that reads a file: `kinora: "0.2"`.
//!
//! A file for a newer version may hold fields that this one does not know. So the version is compared before anything
//! else is read, and a file that is too new has this fault alone. The version changes nothing that is rendered.

use super::expand::include::top_field;
use super::fault::Fault;
use super::node::Node;
use super::source_file::File;
use super::suggest::shortened;
use super::values::text;
use std::fmt;

/// The field at the top of a file.
pub const FIELD: &str = "kinora";

/// Major, minor and patch number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version([u64; 3]);

/// The version of this program. A suffix of a version in development does not count.
const THIS: Version = Version([
    number(env!("CARGO_PKG_VERSION_MAJOR")),
    number(env!("CARGO_PKG_VERSION_MINOR")),
    number(env!("CARGO_PKG_VERSION_PATCH")),
]);

/// A number that cargo has written.
const fn number(digits: &str) -> u64 {
    let (digits, mut at, mut number) = (digits.as_bytes(), 0, 0);
    while at < digits.len() {
        number = 10 * number + (digits[at] - b'0') as u64;
        at += 1;
    }
    number
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self([major, minor, patch]) = self;
        write!(f, "{major}.{minor}.{patch}")
    }
}

impl Version {
    /// Reads `0.2` or `0.2.1`. Numbers that no version will ever reach count as the largest one.
    fn read(text: &str) -> Option<Self> {
        let number = |part: &str| {
            let is_plain = !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
            let is_short = part == "0" || !part.starts_with('0');
            (is_plain && is_short).then(|| part.parse().unwrap_or(u64::MAX))
        };
        let numbers: Option<Vec<u64>> = text.split('.').map(number).collect();
        match numbers?[..] {
            [major, minor] => Some(Self([major, minor, 0])),
            [major, minor, patch] => Some(Self([major, minor, patch])),
            _ => None,
        }
    }
}

/// Decodes the version that a file needs.
pub fn version(node: Node<'_>) -> Option<Version> {
    if !node.is_text() {
        let fault = node.mismatch(EXPECTED);
        let is_bare = Version::read(node.text()).is_some();
        node.fault(if is_bare { fault.help(format!("write \"{}\"", node.text())) } else { fault });
        return None;
    }
    let written = text(node)?;
    let Some(needed) = Version::read(&written) else {
        node.expected(EXPECTED);
        return None;
    };
    if needed > THIS {
        node.fault(newer(node, &written));
        return None;
    }
    Some(needed)
}

const EXPECTED: &str = "a version of Kinora such as \"0.1\" or \"0.1.2\"";

/// The fault of a file that needs a newer version of Kinora. The decoder reports all other faults of the field.
pub fn too_new(file: &File<'_>) -> Option<Fault> {
    let root = file.root();
    // Splitting the whole file takes time.
    let node = root.text().contains(FIELD).then(|| top_field(root, FIELD)).flatten()?;
    let written = node.text().strip_prefix('"')?.strip_suffix('"')?;
    (Version::read(written)? > THIS).then(|| newer(node, written))
}

fn newer(node: Node<'_>, needed: &str) -> Fault {
    let title = format!("`{FIELD}`: this file needs Kinora {} or newer", shortened(needed));
    let help =
        "install a newer Kinora; if the file uses nothing new, lower this version or leave the field out";
    Fault::new(node.span(), title, format!("this is Kinora {THIS}")).help(help)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::{Sequence, parse};

    fn message(name: &str, text: &str) -> String {
        parse(name, text).expect_err(text).to_string()
    }

    #[test]
    fn versions_are_two_or_three_numbers() {
        let version = |text| Version::read(text).map(|version| version.0);
        assert_eq!(version("0.2"), Some([0, 2, 0]));
        assert_eq!(version("10.0.3"), Some([10, 0, 3]));
        assert_eq!(version("0.99999999999999999999"), Some([0, u64::MAX, 0]));
        for text in [
            "", "1", "0.2.", ".2", "0.2.1.0", "0.02", "00.2", "v0.2", "0.2-dev", "+0.2", "0. 2", "0,2", "٠.٢",
        ] {
            assert_eq!(version(text), None, "{text}");
        }
        // A version in development has a suffix.
        assert!(env!("CARGO_PKG_VERSION").starts_with(&THIS.to_string()), "{THIS}");
    }

    #[test]
    fn numbers_are_compared_as_numbers() {
        let ordered = ["0.0.9", "0.1", "0.1.1", "0.2", "0.10", "1.0", "1.0.1", "10.0"];
        let versions = ordered.map(|text| Version::read(text).expect(text));
        assert!(versions.is_sorted_by(|a, b| a < b), "{versions:?}");
        assert_eq!(Version::read("0.1"), Version::read("0.1.0"));
    }

    /// The version says who may read the file, and nothing about what is rendered.
    #[test]
    fn older_and_equal_versions_change_nothing() {
        let read = |name: &str, text: &str| -> Sequence { parse(name, text).expect(text) };
        let plain = read("a.ron", "(objects: { \"o\": (shape: Sphere()) })");
        for version in ["0.0", "0.0.7", "0.1", &THIS.to_string()] {
            let ron = format!("(kinora: {version:?}, objects: {{ \"o\": (shape: Sphere()) }})");
            assert_eq!(read("a.ron", &ron), plain);
            let json =
                format!("{{\"kinora\": {version:?}, \"objects\": {{\"o\": {{\"shape\": \"Sphere\"}}}}}}");
            assert_eq!(read("a.json", &json), plain);
            let expanded = format!("(let: {{ \"r\": 1 }}, {}", &ron[1..].replace("()", "(radius: \"=r\")"));
            assert_eq!(read("a.ron", &expanded), plain);
        }
    }

    /// What a newer version added is unknown here, and no mistake of the file.
    #[test]
    fn a_newer_version_is_the_only_fault() {
        let unknown = "sound: \"a.ogg\", let: { \"a\": \"=flute(1)\" }, objects: { \"o\": (shape: Cloud()) }";
        let message = message("a.ron", &format!("(\n    kinora: \"9999.1\",\n    {unknown},\n)"));
        assert_eq!(message.matches("error:").count(), 1, "{message}");
        for part in ["a.ron:2:13", "`kinora`: this file needs Kinora 9999.1 or newer", "lower this version"] {
            assert!(message.contains(part), "{message}");
        }
        assert!(message.contains(&format!("this is Kinora {THIS}")), "{message}");
    }

    #[test]
    fn json_files_may_name_their_version() {
        let newer = message("a.json", "{\"kinora\": \"9999.1\", \"let\": {}}");
        assert!(newer.contains("a.json:1:12") && newer.contains("needs Kinora 9999.1"), "{newer}");
        assert_eq!(newer.matches("error:").count(), 1, "{newer}");
        let number = message("a.json", "{\"kinora\": 0.1}");
        assert!(
            number.contains("`kinora`: expected a version") && number.contains("write \"0.1\""),
            "{number}"
        );
    }

    /// Other ways to write a text are compared when the field is decoded.
    #[test]
    fn raw_texts_are_versions_too() {
        assert!(parse("a.ron", "(kinora: r\"0.1\")").is_ok());
        let newer = message("a.ron", "(kinora: r#\"9999.1\"#)");
        assert!(newer.contains("needs Kinora 9999.1"), "{newer}");
    }
}
