//! Writes the tree as text.

use super::tree::{Brackets, Comment, Document, Entry, Part};

/// The longest row in characters, and the indentation within brackets.
const WIDTH: usize = 160;
const INDENTATION: usize = 4;

/// The text of a file.
pub fn text(document: &Document, end_of_line: &str) -> String {
    let mut page = Page::default();
    page.above(&document.entry);
    if document.entry.is_apart {
        page.blank_row();
    }
    page.new_row();
    page.entry(&document.entry, 0);
    page.behind(&document.entry);
    page.comments(&document.comments);
    page.into_text(end_of_line)
}

/// Rows of text. The last one is being written.
#[derive(Default)]
struct Page {
    rows: Vec<Row>,
    indentation: usize,
}

#[derive(Default)]
struct Row {
    text: String,
    /// Behind the text.
    comment: String,
}

impl Page {
    /// Begins a row if the last one is not empty.
    fn new_row(&mut self) {
        if self.rows.last().is_none_or(|row| !row.text.is_empty()) {
            self.rows.push(Row::default());
        }
        let indentation = self.indentation;
        self.last().text = " ".repeat(indentation);
    }

    fn blank_row(&mut self) {
        if !self.rows.is_empty() {
            self.rows.push(Row::default());
            self.rows.push(Row::default());
        }
    }

    fn last(&mut self) -> &mut Row {
        if self.rows.is_empty() {
            self.rows.push(Row::default());
        }
        let last = self.rows.len() - 1;
        &mut self.rows[last]
    }

    fn push(&mut self, text: &str) {
        self.last().text.push_str(text);
    }

    /// The column behind the last row.
    fn column(&self) -> usize {
        self.rows.last().map_or(0, |row| width_of_last_line(&row.text))
    }

    fn above(&mut self, entry: &Entry) {
        for comment in &entry.above {
            self.comment(comment);
        }
    }

    fn comments(&mut self, comments: &[Comment]) {
        comments.iter().for_each(|comment| self.comment(comment));
    }

    /// A comment in a row of its own.
    fn comment(&mut self, comment: &Comment) {
        if comment.is_apart {
            self.blank_row();
        }
        self.new_row();
        self.push(comment.text);
    }

    /// Comments behind an entry. All but the first have rows of their own.
    fn behind(&mut self, entry: &Entry) {
        let mut comments = entry.behind.iter();
        if let Some(first) = comments.next() {
            self.last().comment = (*first).to_owned();
        }
        for text in comments {
            self.comment(&Comment { text, is_apart: false });
        }
    }

    /// Writes an entry in the current row, as far as it fits with `more` characters behind it.
    fn entry(&mut self, entry: &Entry, more: usize) {
        let fits = flat_width(&entry.parts).is_some_and(|width| self.column() + width + more <= WIDTH);
        if fits {
            return self.push(&flat(&entry.parts));
        }
        let last = entry.parts.iter().rposition(|part| matches!(part, Part::Brackets(_)));
        let mut is_deeper = false;
        for (index, part) in entry.parts.iter().enumerate() {
            let before = index.checked_sub(1).map(|before| &entry.parts[before]);
            match (before, part) {
                // The rest of the line is a comment.
                (Some(Part::Comment(comment)), _) if comment.starts_with("//") => {
                    self.indentation += if is_deeper { 0 } else { INDENTATION };
                    is_deeper = true;
                    self.new_row();
                }
                (before, part) => self.push(gap(before, part)),
            }
            match part {
                Part::Brackets(brackets) if Some(index) == last || brackets_width(brackets).is_none() => {
                    self.broken(brackets);
                }
                part => self.push(&flat(std::slice::from_ref(part))),
            }
        }
        self.indentation -= if is_deeper { INDENTATION } else { 0 };
    }

    /// Writes brackets with rows of their own for their entries.
    fn broken(&mut self, brackets: &Brackets) {
        self.push(brackets.open);
        if brackets.entries.is_empty() && brackets.comments.is_empty() {
            return self.push(brackets.close);
        }
        let has_rows = has_rows(brackets);
        if !has_rows && shares_rows(brackets) {
            for (index, entry) in brackets.entries.iter().enumerate() {
                self.push(if index > 0 { ", " } else { "" });
                self.entry(entry, brackets.close.len() + 1);
            }
            return self.push(brackets.close);
        }
        self.indentation += INDENTATION;
        // Brackets that were in one row get a row for each named entry, and full rows of other entries.
        let mut ends_row = true;
        for (index, entry) in brackets.entries.iter().enumerate() {
            self.above(entry);
            if entry.is_apart {
                self.blank_row();
            }
            let is_named = entry.parts.iter().any(|part| matches!(part, Part::Colon));
            let width = flat_width(&entry.parts);
            let fits = width.is_some_and(|width| self.column() + " ,".len() + width <= WIDTH);
            let begins = if has_rows { entry.begins_row } else { is_named };
            if index == 0 || begins || ends_row || !fits || entry.is_apart {
                self.new_row();
            } else {
                self.push(" ");
            }
            let first = self.rows.len();
            self.entry(entry, ",".len());
            self.push(",");
            ends_row = self.rows.len() > first || !entry.behind.is_empty();
            self.behind(entry);
        }
        self.comments(&brackets.comments);
        self.indentation -= INDENTATION;
        self.new_row();
        self.push(brackets.close);
    }

    fn into_text(self, end_of_line: &str) -> String {
        let mut text = String::new();
        let mut rows = self.rows.as_slice();
        while let [row, ..] = rows {
            // Comments behind neighbouring rows stand below each other.
            let same = rows.iter().take_while(|row| !row.comment.is_empty()).count().max(1);
            let column =
                rows[..same].iter().map(|row| width_of_last_line(&row.text)).max().unwrap_or_default();
            let longest =
                rows[..same].iter().map(|row| row.comment.chars().count()).max().unwrap_or_default();
            let column = if column + 1 + longest <= WIDTH { column } else { 0 };
            if row.comment.is_empty() {
                text.push_str(row.text.trim_end());
                text.push_str(end_of_line);
            } else {
                for row in &rows[..same] {
                    let gap = column.saturating_sub(width_of_last_line(&row.text)) + 1;
                    text.push_str(&format!("{}{:gap$}{}{end_of_line}", row.text, "", row.comment));
                }
            }
            rows = &rows[same..];
        }
        text
    }
}

/// What separates two parts of an entry.
fn gap(before: Option<&Part>, part: &Part) -> &'static str {
    match (before, part) {
        (None, _) | (_, Part::Colon) | (Some(Part::Atom(_)), Part::Brackets(_)) => "",
        _ => " ",
    }
}

/// The width of parts in one row. None if they contain a break.
fn flat_width(parts: &[Part]) -> Option<usize> {
    let mut width = 0;
    for (index, part) in parts.iter().enumerate() {
        width += gap(index.checked_sub(1).map(|before| &parts[before]), part).len();
        width += match part {
            Part::Colon => 1,
            Part::Comment(text) if text.starts_with("//") => return None,
            Part::Atom(text) | Part::Comment(text) if text.contains('\n') => return None,
            Part::Atom(text) | Part::Comment(text) => text.chars().count(),
            Part::Brackets(brackets) => brackets_width(brackets)?,
        };
    }
    Some(width)
}

fn brackets_width(brackets: &Brackets) -> Option<usize> {
    if has_rows(brackets) {
        return None;
    }
    let mut width = 2 + 2 * padding(brackets).len();
    for (index, entry) in brackets.entries.iter().enumerate() {
        width += if index > 0 { ", ".len() } else { 0 } + flat_width(&entry.parts)?;
    }
    Some(width)
}

/// Whether brackets have breaks between their entries, or comments in lines of their own.
fn has_rows(brackets: &Brackets) -> bool {
    let breaks = |entry: &Entry| entry.begins_row || !entry.above.is_empty() || !entry.behind.is_empty();
    !brackets.comments.is_empty() || brackets.entries.iter().any(breaks)
}

/// Whether brackets stand in the rows of those at their end: `Track(ease: Smooth, keys: [`. That is so if only these have
/// rows, or if nothing else is in the brackets: `Cuts([`.
fn shares_rows(brackets: &Brackets) -> bool {
    let Some((last, before)) = brackets.entries.split_last() else { return false };
    let Some(Part::Brackets(inner)) = last.parts.last() else { return false };
    let is_named = last.parts.iter().any(|part| matches!(part, Part::Colon));
    let is_alone = before.is_empty() && !is_named;
    let has_rows_within = has_rows(inner) || shares_rows(inner) && flat_width(&last.parts).is_none();
    brackets.open == "("
        && (is_alone || has_rows_within)
        && before.iter().all(|entry| flat_width(&entry.parts).is_some())
}

fn padding(brackets: &Brackets) -> &'static str {
    if brackets.open == "{" && !brackets.entries.is_empty() { " " } else { "" }
}

/// Parts in one row.
fn flat(parts: &[Part]) -> String {
    let mut text = String::new();
    for (index, part) in parts.iter().enumerate() {
        text.push_str(gap(index.checked_sub(1).map(|before| &parts[before]), part));
        match part {
            Part::Colon => text.push(':'),
            Part::Atom(part) | Part::Comment(part) => text.push_str(part),
            Part::Brackets(brackets) => {
                let entries: Vec<String> = brackets.entries.iter().map(|entry| flat(&entry.parts)).collect();
                let padding = padding(brackets);
                for part in [brackets.open, padding, &entries.join(", "), padding, brackets.close] {
                    text.push_str(part);
                }
            }
        }
    }
    text
}

/// The characters behind the last line break.
fn width_of_last_line(text: &str) -> usize {
    text.rsplit('\n').next().unwrap_or_default().chars().count()
}
