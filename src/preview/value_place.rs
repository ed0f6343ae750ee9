//! Where a value is written, for the page.

use super::places;
use super::session::Session;
use serde_json::{Value, json};

impl Session {
    /// The file, the line and the text of a value. Objects of included files and templates are found by their names.
    pub fn place(&self, names: &[String]) -> Result<Value, String> {
        let main = self.options.file.clone();
        let included = self.watched().keys().filter(|path| path.extension().is_some_and(|ext| ext == "ron"));
        for path in std::iter::once(&main).chain(included) {
            let Ok(text) = std::fs::read_to_string(path) else { continue };
            // The closest part that is written: a copy has no place of its own, but its section has.
            for count in (1..=names.len()).rev() {
                let names: Vec<&str> = names[..count].iter().map(String::as_str).collect();
                let Some(span) = places::find(&text, &names).filter(|_| count == names.len() || count > 1)
                else {
                    continue;
                };
                let line = places::line_of(&text, span.start);
                let first = line.saturating_sub(4);
                let lines: Vec<&str> = text.lines().skip(first).take(12).collect();
                return Ok(json!({
                    "file": path.to_string_lossy(),
                    "line": line,
                    "first": first + 1,
                    "lines": lines,
                }));
            }
        }
        Err(format!("`{}` is not written in the file as such", names.join("`, `")))
    }
}
