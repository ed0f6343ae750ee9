//! A builder of HTML pages.

/// The text of a page so far.
#[derive(Default)]
pub struct Html(pub String);

impl Html {
    pub fn raw(&mut self, text: &str) {
        self.0.push_str(text);
    }

    /// Adds an element with text, which is escaped.
    pub fn tag(&mut self, name: &str, text: &str) {
        self.0 += &format!("<{name}>{}</{name}>\n", escaped(text));
    }

    /// Adds a table; rows with `true` are highlighted.
    pub fn table(&mut self, class: &str, head: &[&str], rows: impl IntoIterator<Item = (bool, Vec<String>)>) {
        self.0 += &format!("<table class=\"{class}\"><tr>");
        head.iter().for_each(|cell| self.tag("th", cell));
        self.raw("</tr>\n");
        for (best, cells) in rows {
            self.raw(if best { "<tr class=\"best\">" } else { "<tr>" });
            cells.iter().for_each(|cell| self.tag("td", cell));
            self.raw("</tr>\n");
        }
        self.raw("</table>\n");
    }

    /// Adds a list of terms and their definitions.
    pub fn list(&mut self, entries: impl IntoIterator<Item = (String, String)>) {
        self.raw("<dl>\n");
        for (word, meaning) in entries {
            self.0 += &format!("<dt>{}</dt><dd>{}</dd>\n", escaped(&word), escaped(&meaning));
        }
        self.raw("</dl>\n");
    }

    pub fn head(&mut self, title: &str) {
        self.raw("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n");
        self.raw("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
        self.tag("title", title);
        self.raw("<style>\n");
        self.raw(include_str!("../page.css"));
        self.raw("</style></head><body><main>\n");
    }
}

/// Text with HTML's special characters escaped.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
