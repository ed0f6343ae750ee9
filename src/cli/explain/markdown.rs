//! The pages of the reference as sections with text and tables.

/// All pages.
pub struct Reference {
    pub sections: Vec<Section>,
}

/// A heading, and what is between it and the next one.
pub struct Section {
    /// The number of `#` in front of it.
    pub level: usize,
    title: String,
    /// The titles of the headings above it, without that of the page.
    above: Vec<String>,
    pub blocks: Vec<Block>,
}

pub enum Block {
    /// Lines as they are, without links.
    Text(String),
    Table(Table),
}

pub struct Table {
    pub columns: Vec<String>,
    /// One cell per column.
    pub rows: Vec<Vec<String>>,
}

impl Reference {
    pub fn read(pages: &[&str]) -> Self {
        Self { sections: pages.iter().flat_map(|page| sections(page)).collect() }
    }
}

impl Section {
    /// The title without the marks of code.
    pub fn name(&self) -> String {
        self.title.replace('`', "")
    }

    /// The titles on the way to this section, without the marks of code.
    pub fn path(&self) -> String {
        let titles = self.above.iter().chain([&self.title]);
        titles.map(|title| title.replace('`', "")).collect::<Vec<_>>().join(" › ")
    }
}

fn sections(page: &str) -> Vec<Section> {
    let mut sections: Vec<Section> = Vec::new();
    let (mut lines, mut in_code) = (Vec::new(), false);
    for line in page.lines() {
        in_code ^= line.starts_with("```");
        let level = if in_code { 0 } else { line.chars().take_while(|c| *c == '#').count() };
        if level == 0 {
            lines.push(line);
            continue;
        }
        close(&mut sections, &mut lines);
        let title = without_links(line[level..].trim());
        let mut above: Vec<String> = Vec::new();
        let mut inner = level;
        for section in sections.iter().rev() {
            if section.level < inner && section.level > 1 {
                above.insert(0, section.title.clone());
                inner = section.level;
            }
        }
        sections.push(Section { level, title, above, blocks: Vec::new() });
    }
    close(&mut sections, &mut lines);
    sections
}

/// Gives the lines to the last section.
fn close(sections: &mut [Section], lines: &mut Vec<&str>) {
    if let Some(section) = sections.last_mut() {
        section.blocks = blocks(lines);
    }
    lines.clear();
}

fn blocks(lines: &[&str]) -> Vec<Block> {
    let (mut blocks, mut text): (Vec<Block>, Vec<&str>) = Default::default();
    let mut rest = lines;
    while let [line, after @ ..] = rest {
        rest = after;
        let is_table = line.starts_with('|') && after.first().is_some_and(|next| next.starts_with("|--"));
        if !is_table {
            text.push(line);
            continue;
        }
        add_text(&mut blocks, &mut text);
        let count = after.iter().take_while(|line| line.starts_with('|')).count();
        let rows = after[1..count].iter().map(|row| cells(row)).collect();
        blocks.push(Block::Table(Table { columns: cells(line), rows }));
        rest = &after[count..];
    }
    add_text(&mut blocks, &mut text);
    blocks
}

fn add_text(blocks: &mut Vec<Block>, lines: &mut Vec<&str>) {
    let text = without_links(lines.join("\n").trim());
    if !text.is_empty() {
        blocks.push(Block::Text(text));
    }
    lines.clear();
}

/// The cells of a row. A bar within code is no border.
fn cells(row: &str) -> Vec<String> {
    let row = row.trim().trim_start_matches('|');
    let row = row.strip_suffix('|').unwrap_or(row);
    let mut in_code = false;
    let is_border = |c: char| {
        in_code ^= c == '`';
        c == '|' && !in_code
    };
    row.split(is_border).map(|cell| without_links(cell.trim())).collect()
}

/// Replaces every `[text](place)` by its text.
fn without_links(text: &str) -> String {
    let (mut plain, mut rest) = (String::new(), text);
    while let Some(start) = rest.find("](") {
        let Some(end) = rest[start..].find(')').map(|end| start + end) else { break };
        let Some(open) = rest[..start].rfind('[') else {
            plain.push_str(&rest[..end + 1]);
            rest = &rest[end + 1..];
            continue;
        };
        plain.push_str(&rest[..open]);
        plain.push_str(&rest[open + 1..start]);
        rest = &rest[end + 1..];
    }
    plain + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "# Page\nfirst\n\n## `a`, `b`\ntext with [a link](#there), and\nmore\n\n| field | meaning |\n|---|---|\n| `x` | one \
                        `|` bar |\n| `y` | |\nbelow\n```\n# no heading\n```\n### Inner\n## Last\n";

    #[test]
    fn sections_have_text_and_tables() {
        let sections = Reference::read(&[PAGE]).sections;
        let titles: Vec<(usize, String)> =
            sections.iter().map(|section| (section.level, section.path())).collect();
        let expected = [(1, "Page"), (2, "a, b"), (3, "a, b › Inner"), (2, "Last")];
        assert_eq!(titles, expected.map(|(level, title)| (level, title.to_owned())));
        let [Block::Text(text), Block::Table(table), Block::Text(below)] = &sections[1].blocks[..] else {
            panic!("three blocks")
        };
        assert_eq!(text, "text with a link, and\nmore");
        assert_eq!(table.columns, ["field", "meaning"]);
        assert_eq!(table.rows, [["`x`", "one `|` bar"], ["`y`", ""]]);
        assert_eq!(below, "below\n```\n# no heading\n```");
    }

    #[test]
    fn brackets_that_are_no_links_stay() {
        for text in ["[a, b]", "a](b", "](c)", "f(x) [1](", ""] {
            assert_eq!(without_links(text), text);
        }
        assert_eq!(without_links("[`a`](x), `[b]` [c](d)"), "`a`, `[b]` c");
    }
}
