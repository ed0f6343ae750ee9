//! PVD files, in which ParaView lists the files of a series with their times.

use crate::geometry::mesh::MeshError;
use crate::import::xml_list::{self, ListElement};

/// A time of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct PvdStep {
    pub time: f64,
    /// Several if programs that ran in parallel wrote a part each. At least one.
    pub files: Vec<PvdFile>,
}

/// A file of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct PvdFile {
    /// Relative to the folder of the PVD file.
    pub name: String,
    /// The line of the PVD file that names it, from 1.
    pub line: u64,
}

impl PvdStep {
    /// The line of the first file in the PVD file, from 1.
    pub fn line(&self) -> u64 {
        self.files[0].line
    }
}

/// Reads the list, in ascending order of time.
///
/// # Errors
/// If it is no PVD file, or lists nothing.
pub fn read(bytes: &[u8]) -> Result<Vec<PvdStep>, MeshError> {
    let mut steps: Vec<PvdStep> = Vec::new();
    xml_list::each(bytes, &["Collection"], "DataSet", |element| {
        let step = step(element)?;
        match steps.last_mut() {
            Some(last) if last.time == step.time => {
                let file = &step.files[0].name;
                if last.files.iter().any(|known| known.name == *file) {
                    let line = last.line();
                    return Err(
                        element.fault(format!("the time of line {line} has the file `{file}` already"))
                    );
                }
                last.files.extend(step.files);
            }
            Some(last) if step.time < last.time => {
                let (time, line) = (step.time, last.line());
                let why = format!("times must ascend, but {time} is before the time of line {line}");
                return Err(element.fault(why));
            }
            _ => steps.push(step),
        }
        Ok(())
    })?;
    if steps.is_empty() {
        return Err(MeshError::new("it lists no `DataSet`"));
    }
    Ok(steps)
}

fn step(element: &ListElement<'_>) -> Result<PvdStep, MeshError> {
    let time = element.attribute("timestep")?.unwrap_or_default();
    let number = time.trim().parse().ok().filter(|time: &f64| time.is_finite());
    let time = number.ok_or_else(|| {
        element.fault(format!("expected a `timestep` that is a finite number, found `{time}`"))
    })?;
    Ok(PvdStep { time, files: vec![PvdFile { name: element.file("file")?, line: element.line() }] })
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
        let step =
            |time, name: &str, line| PvdStep { time, files: vec![PvdFile { name: name.into(), line }] };
        assert_eq!(steps, Ok(vec![step(0.0, "a_0.vtu", 4), step(0.1, "b&c.vtu", 5)]));
    }

    #[test]
    fn times_may_have_several_parts() {
        let part = |time, file: &str| format!("<DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>\n");
        let steps =
            list(&[part(0, "a0"), part(0, "a1"), part(1, "b0"), part(1, "b1"), part(1, "b2")].concat());
        let named = |step: PvdStep| {
            let file = |file: PvdFile| format!("{}:{}", file.name, file.line);
            (step.time, step.files.into_iter().map(file).collect::<Vec<_>>().join(" "))
        };
        let files: Vec<_> = steps.expect("a list").into_iter().map(named).collect();
        assert_eq!(files, [(0.0, "a0:4 a1:5".to_owned()), (1.0, "b0:6 b1:7 b2:8".to_owned())]);
        let twice = list(&[part(0, "a0"), part(0, "a1"), part(0, "a0")].concat()).expect_err("a fault");
        assert_eq!(twice, "line 6: the time of line 4 has the file `a0` already");
    }

    #[test]
    fn errors_name_the_line() {
        let two = |a: &str, b: &str| {
            list(&format!("<DataSet timestep=\"{a}\" file=\"a\"/>\n<DataSet timestep=\"{b}\" file=\"b\"/>"))
        };
        let fault = |list: Result<_, String>| list.expect_err("a fault");
        assert!(fault(two("1", "0.5")).starts_with("line 5: times must ascend, but 0.5 is before"));
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
