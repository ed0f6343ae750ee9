//! Decodes maps from names to values: lights, cameras, materials, objects.

use super::Named;
use super::fault::Fault;
use super::node::Node;
use super::schema::Ask;
use super::source_file::Form;
use super::suggest::shortened;
use super::values::text;
use super::words::report_unknown;
use std::collections::HashMap;
use std::ops::Range;

/// A named entry of a map.
pub struct Entry<'s> {
    pub name: String,
    pub key: Node<'s>,
    pub value: Node<'s>,
}

/// Decodes `{ "name": value, ... }`. `what` names the entries in messages, such as "light".
pub fn entries<'s>(node: Node<'s>, what: &str) -> Option<Vec<Entry<'s>>> {
    node.note_form(Form::Map);
    node.ask(|| Ask::Map { what: what.to_owned() });
    let Some(map) = node.map() else {
        node.expected(format!("{what}s with their names, written {{ \"name\": ... }}"));
        return None;
    };
    let mut all = Vec::with_capacity(map.len());
    for (key, value) in map {
        match entry_name(key, what) {
            Some(name) => all.push(Entry { name, key, value }),
            // The value may have faults too, so it is decoded under an empty name, which nothing can refer to.
            None => all.push(Entry { name: String::new(), key, value }),
        }
    }
    let mut first: HashMap<&str, Node<'_>> = HashMap::new();
    for Entry { name, key, .. } in all.iter().filter(|entry| !entry.name.is_empty()) {
        if let Some(before) = first.insert(name, *key) {
            let title = format!("two {what}s are named `{}`", shortened(name));
            let fault = Fault::new(key.span(), title, "named again here");
            key.fault(fault.also(before.span(), "first named here"));
        }
    }
    Some(all)
}

fn entry_name(key: Node<'_>, what: &str) -> Option<String> {
    if let Some(word) = key.bare_word() {
        let help = format!("write \"{}\"", shortened(word));
        key.fault(key.mismatch(format!("the {what}'s name in quotes")).help(help));
        return None;
    }
    let name = text(key)?;
    if name.trim().is_empty() {
        key.expected(format!("a name for the {what}"));
        return None;
    }
    Some(name)
}

/// The places of the names of entries.
pub fn places_of(entries: &[Entry<'_>]) -> Vec<Range<usize>> {
    entries.iter().map(|entry| entry.key.span()).collect()
}

/// A value under the name of its entry.
pub fn named<T>(entry: &Entry<'_>, value: Option<T>) -> Option<Named<T>> {
    Some(Named { name: entry.name.clone(), value: value? })
}

/// All values, or None if any is missing. Takes a list instead of an iterator, so that all values have been decoded.
pub fn decoded<T>(values: Vec<Option<T>>) -> Option<Vec<T>> {
    values.into_iter().collect()
}

/// Names of entries, each with its index.
pub struct Names<'n> {
    what: &'static str,
    in_order: Vec<&'n str>,
    indices: HashMap<&'n str, usize>,
    /// Entries whose own entries could not be read. Names behind theirs and a `/` may be right.
    unread: Vec<&'n str>,
}

impl<'n> Names<'n> {
    pub fn new(what: &'static str, entries: &'n [Entry<'_>]) -> Self {
        let in_order: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
        let indices = in_order.iter().enumerate().map(|(index, name)| (*name, index)).collect();
        // Entries with an invalid name have an empty one.
        let in_order = in_order.into_iter().filter(|name| !name.is_empty()).collect();
        Self { what, in_order, indices, unread: Vec::new() }
    }

    /// Adds further names behind `count` entries.
    pub fn and(mut self, count: usize, names: impl Iterator<Item = &'n str>) -> Self {
        for (index, name) in names.enumerate() {
            self.indices.insert(name, count + index);
            self.in_order.push(name);
        }
        self
    }

    /// Entries whose own entries could not be read, which has been reported. Names of these are not reported again.
    pub fn unread(self, unread: impl Iterator<Item = &'n str>) -> Self {
        Self { unread: unread.collect(), ..self }
    }

    /// Names in the order of the entries.
    pub fn of(what: &'static str, names: impl Iterator<Item = &'n str>) -> Self {
        let in_order: Vec<&str> = names.collect();
        let indices = in_order.iter().enumerate().map(|(index, name)| (*name, index)).collect();
        Self { what, in_order, indices, unread: Vec::new() }
    }

    /// Whether an entry has this name.
    pub fn has(&self, name: &str) -> bool {
        !name.is_empty() && self.indices.contains_key(name)
    }

    /// The index of the quoted name at `node`.
    pub fn index(&self, node: Node<'_>) -> Option<usize> {
        self.index_or(node, |name, known| report_unknown(node, self.what, name, known.iter().copied()))
    }

    /// [`Names::index`] with a report of its own, which gets the name and the known ones.
    pub fn index_or(&self, node: Node<'_>, report: impl FnOnce(&str, &[&str])) -> Option<usize> {
        let name = text(node)?;
        let index = self.indices.get(name.as_str()).copied().filter(|_| !name.is_empty());
        let is_below = |entry: &&str| name.strip_prefix(*entry).is_some_and(|rest| rest.starts_with('/'));
        if index.is_none() && !self.unread.iter().any(is_below) {
            report(&name, &self.in_order);
        }
        index
    }
}
