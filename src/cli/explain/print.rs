//! The reference as plain text.

use super::markdown::{Block, Reference, Section, Table};
use super::search::Found;
use std::fmt::Write;

/// The longest line, in characters.
const WIDTH: usize = 100;

/// What was found, with blank lines between.
pub fn found(found: &[Found]) -> String {
    let texts = found.iter().map(|found| match found {
        Found::Row { section, table, row } => {
            format!("{} · {}\n{}", row[0], section.path(), cells(table, row))
        }
        Found::Section(section) => whole(section),
    });
    texts.collect::<Vec<_>>().join("\n")
}

/// A row as sentences, or the first paragraph of a section.
pub fn sentences(found: &Found) -> Option<String> {
    let (table, row) = match found {
        Found::Row { table, row, .. } => (table, row),
        Found::Section(section) => {
            let text = section.blocks.iter().find_map(|block| match block {
                Block::Text(text) => Some(text),
                Block::Table(_) => None,
            });
            return text.and_then(|text| text.split("\n\n").next()).map(|text| text.replace('\n', " "));
        }
    };
    let cells = table.columns.iter().zip(*row).skip(1).filter(|(_, cell)| !cell.is_empty());
    let sentences = cells.map(|(column, cell)| match column.as_str() {
        "" | "meaning" => format!("{cell}."),
        column => format!("{column}: {cell}."),
    });
    let text = sentences.collect::<Vec<_>>().join(" ");
    (!text.is_empty()).then_some(text)
}

/// The titles of all sections, those within others indented.
pub fn titles(reference: &Reference) -> String {
    let mut text = String::new();
    for section in &reference.sections {
        let _ = writeln!(text, "{:1$}{2}", "", 2 * (section.level - 1), section.name());
    }
    text
}

fn whole(section: &Section) -> String {
    let mut text = format!("{}\n", section.path());
    for block in &section.blocks {
        text.push('\n');
        match block {
            Block::Text(lines) => {
                let _ = writeln!(text, "{lines}");
            }
            Block::Table(table) => {
                for row in &table.rows {
                    let _ = write!(text, "{}\n{}", row[0], cells(table, row));
                }
            }
        }
    }
    text
}

/// All cells of a row but its first, each under the name of its column.
fn cells(table: &Table, row: &[String]) -> String {
    let mut text = String::new();
    for (column, cell) in table.columns.iter().zip(row).skip(1).filter(|(_, cell)| !cell.is_empty()) {
        let label = match column.as_str() {
            "" | "meaning" => String::new(),
            column => format!("{column}: "),
        };
        wrap(&mut text, &format!("{label}{cell}"));
    }
    text
}

/// Appends a paragraph, indented, in lines of at most [`WIDTH`] characters where words allow it.
fn wrap(text: &mut String, paragraph: &str) {
    let mut length = 0;
    for word in paragraph.split(' ') {
        let letters = word.chars().count();
        if length > 0 && length + 1 + letters > WIDTH {
            text.push('\n');
            length = 0;
        }
        text.push_str(if length == 0 { "  " } else { " " });
        length += if length == 0 { 2 } else { 1 } + letters;
        text.push_str(word);
    }
    text.push('\n');
}
