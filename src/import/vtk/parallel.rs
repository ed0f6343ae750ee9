//! Lists of the parts of a data set (`.pvtp`, `.pvtu`).

use crate::geometry::mesh::MeshError;
use crate::import::xml_list;

/// The files of the parts, relative to the folder of the list. Empty if a program wrote no part.
pub fn pieces(bytes: &[u8]) -> Result<Vec<String>, MeshError> {
    let mut files = Vec::new();
    xml_list::each(bytes, &["PPolyData", "PUnstructuredGrid"], "Piece", |element| {
        files.push(element.file("Source")?);
        Ok(())
    })?;
    match files.is_empty() {
        true => Err(MeshError::new("it lists no `Piece`")),
        false => Ok(files),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_name_files_or_the_fault() {
        let read = |kind: &str, parts: &str| {
            let text = format!(
                "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\">\n<{kind} GhostLevel=\"0\">\n{parts}</{kind}>\n</VTKFile>"
            );
            pieces(text.as_bytes()).map_err(|error| error.to_string())
        };
        let two = "<PPoints/>\n<Piece Source=\"a 0.vtu\"/>\n<Piece Source='b&lt;1.vtu'></Piece>\n";
        assert_eq!(read("PUnstructuredGrid", two), Ok(vec!["a 0.vtu".to_owned(), "b<1.vtu".to_owned()]));
        assert_eq!(read("PPolyData", ""), Err("it lists no `Piece`".to_owned()));
        assert_eq!(read("PPolyData", "<Piece/>"), Err("line 4: expected the attribute `Source`".to_owned()));
        let why = "line 2: expected `<VTKFile type=\"PPolyData\">` or `<VTKFile type=\"PUnstructuredGrid\">`";
        assert_eq!(read("PImageData", two), Err(why.to_owned()));
        assert!(pieces(b"<VTKFile").is_err() && pieces(b"").is_err());
    }
}
