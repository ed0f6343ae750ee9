//! PVD files, in which ParaView lists the files of a series with their times.

use crate::geometry::mesh::{MeshError, MeshLocation};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// A file of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct PvdStep {
    pub time: f64,
    /// Relative to the folder of the PVD file.
    pub file: String,
    /// The line in the PVD file, from 1.
    pub line: u64,
}

/// Reads the list, in ascending order of time. Each time has one file.
///
/// # Errors
/// If it is no PVD file, or lists nothing.
pub fn read(bytes: &[u8]) -> Result<Vec<PvdStep>, MeshError> {
    let mut reader = Reader::from_reader(bytes);
    let (mut steps, mut root): (Vec<PvdStep>, bool) = (Vec::new(), false);
    loop {
        let at = reader.buffer_position() as usize;
        let event = reader.read_event();
        let event = event.map_err(|error| fault(bytes, reader.error_position() as usize, not_xml(error)))?;
        let (Event::Start(element) | Event::Empty(element)) = event else {
            if matches!(event, Event::Eof) {
                break;
            }
            continue;
        };
        match element.name().as_ref() {
            "VTKFile" if attribute(&element, "type", bytes, at)?.as_deref() == Some("Collection") => {
                root = true
            }
            _ if !root => {
                return Err(fault(bytes, at, "expected `<VTKFile type=\"Collection\">`".to_owned()));
            }
            "DataSet" => {
                let step = step(&element, bytes, at)?;
                if let Some(before) = steps.last().filter(|before| step.time <= before.time) {
                    return Err(fault(bytes, at, out_of_order(before, &step)));
                }
                steps.push(step);
            }
            _ => {}
        }
    }
    if steps.is_empty() {
        return Err(MeshError::new("it lists no `DataSet`"));
    }
    Ok(steps)
}

fn step(element: &BytesStart<'_>, bytes: &[u8], at: usize) -> Result<PvdStep, MeshError> {
    let time = attribute(element, "timestep", bytes, at)?.unwrap_or_default();
    let number = time.trim().parse().ok().filter(|time: &f64| time.is_finite());
    let time = number.ok_or_else(|| {
        fault(bytes, at, format!("expected a `timestep` that is a finite number, found `{time}`"))
    })?;
    let file = attribute(element, "file", bytes, at)?.filter(|file| !file.is_empty());
    let file = file.ok_or_else(|| fault(bytes, at, "expected the attribute `file`".to_owned()))?;
    Ok(PvdStep { time, file, line: line(bytes, at) })
}

fn out_of_order(before: &PvdStep, step: &PvdStep) -> String {
    let (time, line) = (step.time, before.line);
    match step.time == before.time {
        true => {
            format!("line {line} has a file for the time {time} already; parts of one time are not joined")
        }
        false => format!("times must ascend, but {time} is not after the time of line {line}"),
    }
}

fn attribute(
    element: &BytesStart<'_>,
    name: &str,
    bytes: &[u8],
    at: usize,
) -> Result<Option<String>, MeshError> {
    for attribute in element.attributes() {
        let attribute = attribute.map_err(|error| fault(bytes, at, not_xml(error)))?;
        if attribute.key.as_ref() == name {
            let value = quick_xml::escape::unescape(&attribute.value);
            return Ok(Some(
                value.map_or_else(|_| attribute.value.clone().into_owned(), |value| value.into_owned()),
            ));
        }
    }
    Ok(None)
}

fn not_xml(error: impl std::fmt::Display) -> String {
    format!("it is no valid XML: {error}")
}

fn line(bytes: &[u8], at: usize) -> u64 {
    1 + bytes[..at.min(bytes.len())].iter().filter(|byte| **byte == b'\n').count() as u64
}

fn fault(bytes: &[u8], at: usize, why: String) -> MeshError {
    // Elements follow the blanks of their line.
    let blanks = bytes[at.min(bytes.len())..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    MeshError::at(MeshLocation::Line(line(bytes, at + blanks)), why)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(steps: &str) -> Result<Vec<PvdStep>, String> {
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n{steps}\n</Collection>\n</VTKFile>\n"
        );
        read(text.as_bytes()).map_err(|error| error.to_string())
    }

    #[test]
    fn files_have_times() {
        let steps = list(
            "  <DataSet timestep=\"0\" group=\"\" part=\"0\" file=\"a_0.vtu\"/>\n  <DataSet timestep='1e-1' file='b&amp;c.vtu'></DataSet>",
        );
        let step = |time, file: &str, line| PvdStep { time, file: file.to_owned(), line };
        assert_eq!(steps, Ok(vec![step(0.0, "a_0.vtu", 4), step(0.1, "b&c.vtu", 5)]));
    }

    #[test]
    fn errors_name_the_line() {
        let two = |a: &str, b: &str| {
            list(&format!("<DataSet timestep=\"{a}\" file=\"a\"/>\n<DataSet timestep=\"{b}\" file=\"b\"/>"))
        };
        let fault = |list: Result<_, String>| list.expect_err("a fault");
        assert!(fault(two("1", "0.5")).starts_with("line 5: times must ascend, but 0.5 is not after"));
        assert!(fault(two("1", "1")).starts_with("line 5: line 4 has a file for the time 1 already"));
        assert!(fault(two("1", "x")).starts_with("line 5: expected a `timestep`"));
        assert!(
            fault(list("<DataSet timestep=\"1\"/>")).starts_with("line 4: expected the attribute `file`")
        );
        assert_eq!(fault(list("")), "it lists no `DataSet`");
        let other = read(b"<VTKFile type=\"PolyData\"></VTKFile>").expect_err("a fault").to_string();
        assert!(other.starts_with("line 1: expected `<VTKFile type=\"Collection\">`"), "{other}");
        assert!(read(b"<VTKFile type=\"Collection\"><DataSet").is_err());
        assert!(read(b"").is_err());
    }
}
