//! XML files that list other files.

use crate::geometry::mesh::{MeshError, MeshLocation};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// An element of such a file.
pub struct ListElement<'b> {
    bytes: &'b [u8],
    at: usize,
    line: u64,
    element: BytesStart<'b>,
}

/// Visits the elements with a name below `<VTKFile type="...">`, whose type must be one of `types`.
///
/// # Errors
/// If it is no such file, and those of `visit`.
pub fn each<'b>(
    bytes: &'b [u8],
    types: &[&str],
    name: &str,
    mut visit: impl FnMut(&ListElement<'b>) -> Result<(), MeshError>,
) -> Result<(), MeshError> {
    let mut reader = Reader::from_reader(bytes);
    let (mut root, mut line, mut counted) = (false, 1, 0);
    loop {
        let at = reader.buffer_position() as usize;
        line += feeds(&bytes[counted..at]);
        counted = at;
        let event = reader.read_event();
        let event = event.map_err(|error| fault(bytes, reader.error_position() as usize, not_xml(error)))?;
        let element = match event {
            Event::Start(element) | Event::Empty(element) => ListElement { bytes, at, line, element },
            Event::Eof => return Ok(()),
            _ => continue,
        };
        let known = |kind: String| types.contains(&kind.as_str());
        let tag = element.element.name();
        if tag.as_ref() == "VTKFile" && element.attribute("type")?.is_some_and(known) {
            root = true;
        } else if !root {
            let expected: Vec<_> = types.iter().map(|kind| format!("`<VTKFile type=\"{kind}\">`")).collect();
            return Err(element.fault(format!("expected {}", expected.join(" or "))));
        } else if tag.as_ref() == name {
            visit(&element)?;
        }
    }
}

impl ListElement<'_> {
    /// The value of an attribute, if it is there.
    pub fn attribute(&self, name: &str) -> Result<Option<String>, MeshError> {
        for attribute in self.element.attributes() {
            let attribute = attribute.map_err(|error| self.fault(not_xml(error)))?;
            if attribute.key.as_ref() == name {
                let value = quick_xml::escape::unescape(&attribute.value);
                return Ok(Some(
                    value.map_or_else(|_| attribute.value.clone().into_owned(), |value| value.into_owned()),
                ));
            }
        }
        Ok(None)
    }

    /// The name of a file in an attribute.
    pub fn file(&self, name: &str) -> Result<String, MeshError> {
        let file = self.attribute(name)?.filter(|file| !file.is_empty());
        file.ok_or_else(|| self.fault(format!("expected the attribute `{name}`")))
    }

    /// The line of the element, from 1.
    pub fn line(&self) -> u64 {
        self.line
    }

    pub fn fault(&self, why: String) -> MeshError {
        fault(self.bytes, self.at, why)
    }
}

fn not_xml(error: impl std::fmt::Display) -> String {
    format!("it is no valid XML: {error}")
}

/// The number of line feeds.
fn feeds(bytes: &[u8]) -> u64 {
    bytes.iter().filter(|byte| **byte == b'\n').count() as u64
}

fn fault(bytes: &[u8], at: usize, why: String) -> MeshError {
    // Elements follow the blanks of their line.
    let blanks = bytes[at.min(bytes.len())..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    MeshError::at(MeshLocation::Line(1 + feeds(&bytes[..(at + blanks).min(bytes.len())])), why)
}
