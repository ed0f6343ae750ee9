//! Decodes maps from names to values: lights, cameras, materials, objects.

use super::Named;
use super::fault::Fault;
use super::node::Node;
use super::schema::Ask;
use super::source_file::Form;
use super::suggest::shortened;
use super::values::text;
use super::words::report_unknown;
use std::cell::OnceCell;
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
    let mut first: HashMap<&str, Node<'_>> = HashMap::with_capacity(all.len());
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
    /// Hashed when a name is looked up first: most files refer to few names, or to none.
    indices: OnceCell<HashMap<&'n str, usize>>,
    /// Entries whose own entries could not be read. Names behind theirs and a `/` may be right.
    unread: Vec<&'n str>,
}

impl<'n> Names<'n> {
    pub fn new(what: &'static str, entries: &'n [Entry<'_>]) -> Self {
        Self::of(what, entries.iter().map(|entry| entry.name.as_str()))
    }

    /// Adds further names behind those of all entries.
    pub fn and(mut self, names: impl Iterator<Item = &'n str>) -> Self {
        self.in_order.extend(names);
        Self { indices: OnceCell::new(), ..self }
    }

    /// Entries whose own entries could not be read, which has been reported. Names of these are not reported again.
    pub fn unread(self, unread: impl Iterator<Item = &'n str>) -> Self {
        Self { unread: unread.collect(), ..self }
    }

    /// Names in the order of the entries.
    pub fn of(what: &'static str, names: impl Iterator<Item = &'n str>) -> Self {
        Self { what, in_order: names.collect(), indices: OnceCell::new(), unread: Vec::new() }
    }

    /// The index of an entry. Entries with an invalid name have an empty one.
    fn find(&self, name: &str) -> Option<usize> {
        let hashed = || self.in_order.iter().enumerate().map(|(index, name)| (*name, index)).collect();
        self.indices.get_or_init(hashed).get(name).copied().filter(|_| !name.is_empty())
    }

    /// Whether an entry has this name.
    pub fn has(&self, name: &str) -> bool {
        self.find(name).is_some()
    }

    /// The index of the quoted name at `node`.
    pub fn index(&self, node: Node<'_>) -> Option<usize> {
        self.index_or(node, |name, known| report_unknown(node, self.what, name, known.iter().copied()))
    }

    /// [`Names::index`] with a report of its own, which gets the name and the known ones.
    pub fn index_or(&self, node: Node<'_>, report: impl FnOnce(&str, &[&str])) -> Option<usize> {
        let name = text(node)?;
        let index = self.find(&name);
        let is_below = |entry: &&str| name.strip_prefix(*entry).is_some_and(|rest| rest.starts_with('/'));
        if index.is_none() && !self.unread.iter().any(is_below) {
            let known: Vec<&str> = self.in_order.iter().copied().filter(|name| !name.is_empty()).collect();
            report(&name, &known);
        }
        index
    }
}
