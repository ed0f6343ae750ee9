//! Finds the rows and sections that a name means.

use super::markdown::{Block, Reference, Section, Table};
use std::collections::BTreeSet;

/// A name, possibly with its owner in front: `lights.intensity`.
pub struct Query<'n> {
    owners: Vec<&'n str>,
    name: &'n str,
}

/// What a name means.
pub enum Found<'r> {
    Row { section: &'r Section, table: &'r Table, row: &'r [String] },
    Section(&'r Section),
}

impl<'n> Query<'n> {
    pub fn new(text: &'n str) -> Self {
        let mut parts: Vec<&str> = text.trim().split('.').map(str::trim).collect();
        let name = parts.pop().unwrap_or_default();
        Self { owners: parts, name }
    }

    pub fn name(&self) -> &'n str {
        self.name
    }

    /// Rows that the name heads, and sections with it as their title. If there is none, rows that name it among their
    /// fields.
    pub fn find<'r>(&self, reference: &'r Reference) -> Vec<Found<'r>> {
        let rows = |of: fn(&[String], &str) -> bool| {
            let rows = reference.sections.iter().flat_map(rows_of);
            rows.filter(move |found| {
                found.row().is_some_and(|row| of(row, self.name)) && self.is_owner(found)
            })
        };
        let sections = reference
            .sections
            .iter()
            .filter(|section| self.owners.is_empty() && has_title(section, self.name));
        let heads: Vec<Found> = rows(is_head).chain(sections.map(Found::Section)).collect();
        // The fields of a kind may have the name of a field of a section.
        match self.owners.is_empty() && heads.iter().any(|found| matches!(found, Found::Section(_))) {
            true => heads,
            false => heads.into_iter().chain(rows(is_inside)).collect(),
        }
    }

    /// What the query means if its owners are all those around the name in a file, which titles of the reference need not
    /// name. None if the reference describes several things of that name, and none of them belongs to one of the owners.
    pub fn best<'r>(&self, reference: &'r Reference) -> Option<Found<'r>> {
        let name = self.name;
        let found = Self { owners: Vec::new(), name }.find(reference);
        // Names without an owner are those of sections.
        if let Some(section) = found.iter().position(|found| matches!(found, Found::Section(_)))
            && self.owners.is_empty()
        {
            return found.into_iter().nth(section);
        }
        let is_only = found.len() == 1;
        let count = |found: &Found| {
            self.owners.iter().filter(|owner| Self { owners: vec![owner], name }.is_owner(found)).count()
        };
        // The first one of those with the most owners.
        let counted = found.into_iter().rev().map(|found| (count(&found), found));
        let (count, best) = counted.max_by_key(|(count, _)| *count)?;
        (count > 0 || is_only).then_some(best)
    }

    /// Whether what was found belongs to all owners of the query.
    fn is_owner(&self, found: &Found) -> bool {
        let path = found.section().path();
        let titles: Vec<&str> = path.split(" › ").flat_map(words).collect();
        let kinds = found.row().map(|row| identifiers(&row[0])).unwrap_or_default();
        let columns = found.columns().map(|columns| identifiers(&columns[0])).unwrap_or_default();
        let is_one = |owner: &str| {
            let names = titles.iter().copied().chain(kinds.iter().chain(&columns).copied());
            names.into_iter().any(|name| name != self.name && is_same(name, owner))
        };
        self.owners.iter().all(|owner| is_one(owner))
    }
}

impl<'r> Found<'r> {
    pub fn section(&self) -> &'r Section {
        match self {
            Self::Row { section, .. } | Self::Section(section) => section,
        }
    }

    fn row(&self) -> Option<&'r [String]> {
        match self {
            Self::Row { row, .. } => Some(row),
            Self::Section(_) => None,
        }
    }

    fn columns(&self) -> Option<&'r [String]> {
        match self {
            Self::Row { table, .. } => Some(&table.columns),
            Self::Section(_) => None,
        }
    }

    /// The section, or the kind in a section that names it among its fields.
    pub fn owner(&self) -> String {
        self.section().name()
    }
}

/// Names that can be asked for.
pub fn names(reference: &Reference) -> BTreeSet<String> {
    let rows = reference.sections.iter().flat_map(rows_of);
    let heads = rows.flat_map(|found| found.row().map(|row| identifiers(&row[0])).unwrap_or_default());
    let titles = reference.sections.iter().map(Section::name);
    heads.map(str::to_owned).chain(titles).collect()
}

fn rows_of(section: &Section) -> impl Iterator<Item = Found<'_>> {
    // Tables of notation and of files have examples of fields and kinds, which mean nothing by themselves.
    let tables = section.blocks.iter().filter_map(|block| match block {
        Block::Table(table) if !matches!(table.columns[0].as_str(), "notation" | "file") => Some(table),
        _ => None,
    });
    tables.flat_map(move |table| {
        let rows = table.rows.iter().filter(|row| !row.is_empty());
        rows.map(move |row| Found::Row { section, table, row })
    })
}

/// Whether the first cell of a row is about the name.
fn is_head(row: &[String], name: &str) -> bool {
    let heads = identifiers(&row[0]).into_iter().chain(inner_fields(&row[0]));
    heads.into_iter().any(|head| head.eq_ignore_ascii_case(name))
}

/// The fields in pieces of code such as `projection: fov`.
fn inner_fields(cell: &str) -> impl Iterator<Item = &str> {
    let inner = cell.split('`').skip(1).step_by(2).filter_map(|code| Some(code.split_once(": ")?.1));
    inner.filter(|field| field.chars().all(|c| c.is_ascii_lowercase() || c == '_'))
}

/// Whether a further cell describes a field of this name: `` `radius: 1` `` or `` `position` ``.
fn is_inside(row: &[String], name: &str) -> bool {
    !is_head(row, name) && row[1..].iter().any(|cell| identifiers(cell).contains(&name))
}

/// Whether a title is the name, or lists it.
fn has_title(section: &Section, name: &str) -> bool {
    let title = section.name();
    section.level > 1 && (title.eq_ignore_ascii_case(name) || words(&title).any(|word| is_same(word, name)))
}

/// The parts of a title: `materials, default_material`, and `Scalar` of `Scalar: numbers as colours`.
fn words(title: &str) -> impl Iterator<Item = &str> {
    title.split(": ").next().unwrap_or_default().split(", ")
}

/// Whether two names are the same, up to the case and a plural.
fn is_same(name: &str, other: &str) -> bool {
    let singular = |name: &str| name.strip_suffix('s').unwrap_or(name).to_ascii_lowercase();
    singular(name) == singular(other)
}

/// The identifiers at the start of each piece of code in a cell.
fn identifiers(cell: &str) -> Vec<&str> {
    let code = cell.split('`').skip(1).step_by(2);
    let end = |code: &str| code.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(code.len());
    code.map(|code| &code[..end(code)]).filter(|name| !name.is_empty()).collect()
}
