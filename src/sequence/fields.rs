//! Named fields, named entries and named variants: what is known, what is missing, what was meant.

use super::fault::Fault;
use super::node::{Content, Node};
use super::suggest::{either, listed, nearest, shortened};
use std::collections::HashMap;

/// The fields of one value. Ask for every field, then [`Fields::finish`] reports those that nobody asked for.
pub struct Fields<'s> {
    node: Node<'s>,
    /// What has these fields, for messages: "a material", "`Sphere`".
    what: &'static str,
    entries: Vec<(&'s str, Option<Node<'s>>)>,
    known: Vec<&'static str>,
    named_in_faults: bool,
}

impl<'s> Fields<'s> {
    /// Reads `(name: value, ...)`, with or without a word in front.
    pub fn of(node: Node<'s>, what: &'static str) -> Option<Self> {
        let fields = match node.content()? {
            Content::Fields(fields) => fields,
            Content::Tuple(items) if items.is_empty() => Vec::new(),
            Content::Plain if node.bare_word().is_some_and(|word| !is_literal(word)) => Vec::new(),
            _ => {
                node.expected(format!("the fields of {what}, written (name: value, ...)"));
                return None;
            }
        };
        report_duplicates(node, fields.iter().map(|(name, _)| (*name, *name)), "field");
        let entries = fields.into_iter().map(|(name, value)| (name, Some(value))).collect();
        Some(Self { node, what, entries, known: Vec::new(), named_in_faults: true })
    }

    /// Faults in these fields name the field around them instead.
    pub fn unnamed(mut self) -> Self {
        self.named_in_faults = false;
        self
    }

    /// Whether the field is there.
    pub fn has(&self, name: &str) -> bool {
        self.entries.iter().any(|(found, _)| *found == name)
    }

    /// The place of a field's name, or of the whole if it is absent.
    pub fn place(&self, name: &str) -> std::ops::Range<usize> {
        let found = self.entries.iter().find(|(found, _)| *found == name);
        found.map_or_else(|| self.node.head(), |(name, _)| self.node.file.span_of(name))
    }

    pub fn node(&self) -> Node<'s> {
        self.node
    }

    fn take(&mut self, name: &'static str) -> Option<Node<'s>> {
        self.known.push(name);
        self.entries.iter_mut().find(|(found, _)| *found == name).and_then(|(_, value)| value.take())
    }

    /// The field, decoded: `Some(None)` if it is absent, `None` if it is wrong (and reported).
    pub fn optional<T>(
        &mut self,
        name: &'static str,
        decode: impl FnOnce(Node<'s>) -> Option<T>,
    ) -> Option<Option<T>> {
        let Some(node) = self.take(name) else { return Some(None) };
        let first = node.file.fault_count();
        let value = decode(node);
        if self.named_in_faults {
            node.file.name_faults(first, name);
        }
        value.map(Some)
    }

    /// The field, or its default.
    pub fn or<T>(
        &mut self,
        name: &'static str,
        decode: impl FnOnce(Node<'s>) -> Option<T>,
        default: impl Into<T>,
    ) -> Option<T> {
        self.optional(name, decode).map(|value| value.unwrap_or_else(|| default.into()))
    }

    /// The field, which must be there.
    pub fn required<T>(
        &mut self,
        name: &'static str,
        decode: impl FnOnce(Node<'s>) -> Option<T>,
    ) -> Option<T> {
        let value = self.optional(name, decode)?;
        if value.is_none() {
            let title = format!("{} has no `{name}`", self.what);
            self.node.fault(Fault::new(self.node.head(), title, format!("needs the field `{name}`")));
        }
        value
    }

    /// Reports every field that is not known.
    pub fn finish(self) {
        for (name, _) in self.entries.iter().filter(|(name, _)| !self.known.contains(name)) {
            let title = format!("{} has no field `{}`", self.what, shortened(name));
            let span = self.node.file.span_of(name);
            let known = || self.known.iter().copied();
            let fault = Fault::new(span, title, suggestion(self.node, name, known()));
            self.node.fault(fault.help(format!("the fields of {} are {}", self.what, listed(known()))));
        }
    }
}

/// Which name may have been meant.
fn suggestion<'n>(node: Node<'_>, wrong: &str, candidates: impl IntoIterator<Item = &'n str>) -> String {
    // A file with this many faults needs something else than suggestions, which take their time.
    let meant = if node.file.fault_count() < 1000 { nearest(wrong, candidates) } else { None };
    meant.map_or_else(|| "unknown".to_owned(), |name| format!("did you mean `{}`?", shortened(name)))
}

/// The fault of an unknown name at `node`, with the nearest of the known ones.
pub fn unknown<'n>(
    node: Node<'_>,
    what: &str,
    wrong: &str,
    known: impl IntoIterator<Item = &'n str>,
) -> Fault {
    let title = format!("there is no {what} `{}`", shortened(wrong));
    let span = if node.word().is_empty() { node.span() } else { node.head() };
    Fault::new(span, title, suggestion(node, wrong, known))
}

/// Reports an unknown name together with all that are known.
pub fn report_unknown<'n, C>(node: Node<'_>, what: &str, wrong: &str, known: C)
where
    C: IntoIterator<Item = &'n str> + Clone,
{
    let all = listed(known.clone());
    let help =
        if all == "nothing" { format!("the file has no {what}") } else { format!("known here: {all}") };
    node.fault(unknown(node, what, wrong, known).help(help));
}

/// Words of the notation itself.
fn is_literal(word: &str) -> bool {
    matches!(word, "true" | "false" | "inf" | "NaN" | "None")
}

/// Names that come twice: (name, its text in the source).
fn report_duplicates<'s>(node: Node<'s>, names: impl Iterator<Item = (&'s str, &'s str)>, what: &str) {
    let mut first: HashMap<&str, &str> = HashMap::new();
    for (name, text) in names {
        if let Some(before) = first.insert(name, text) {
            let (here, there) = (node.file.span_of(text), node.file.span_of(before));
            let title = format!("the {what} `{}` is given twice", shortened(name));
            node.fault(Fault::new(here, title, "given again here").also(there, "first given here"));
        }
    }
}

/// A named entry of a map.
pub struct Entry<'s> {
    pub name: String,
    pub key: Node<'s>,
    pub value: Node<'s>,
}

/// Reads `{ "name": value, ... }`; `what` is what the map holds ("light").
pub fn entries<'s>(node: Node<'s>, what: &str) -> Option<Vec<Entry<'s>>> {
    let Some(Content::Map(map)) = (match node.word() {
        "" => Some(node.content()?),
        _ => None,
    }) else {
        node.expected(format!("{what}s with their names, written {{ \"name\": ... }}"));
        return None;
    };
    let mut all = Vec::with_capacity(map.len());
    for (key, value) in map {
        match entry_name(key, what) {
            Some(name) => all.push(Entry { name, key, value }),
            // The value may be wrong as well: it is read under a name that nothing can refer to.
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
    let name = super::values::text(key)?;
    if name.trim().is_empty() {
        key.expected(format!("a name for the {what}"));
        return None;
    }
    Some(name)
}

/// Words and the decoders of the values that start with them.
pub type Variants<'s, T> = [(&'static str, fn(Node<'s>) -> Option<T>)];

/// Decodes a value that starts with a word by the decoder of that word.
pub fn variant<'s, T>(node: Node<'s>, what: &str, table: &Variants<'s, T>) -> Option<T> {
    let known = table.iter().map(|(name, _)| *name);
    if node.word().is_empty() || is_literal(node.word()) {
        report_no_word(node, known);
        return None;
    }
    let Some((_, decode)) = table.iter().find(|(name, _)| *name == node.word()) else {
        report_unknown(node, what, node.word(), known.collect::<Vec<_>>());
        return None;
    };
    decode(node)
}

/// Reports a value where one of a few words was expected.
fn report_no_word<'n>(node: Node<'_>, known: impl Iterator<Item = &'n str> + Clone) {
    let fault = node.mismatch(either(known.clone()));
    let quoted = node.is_text() && known.into_iter().any(|name| node.text().trim_matches('"') == name);
    node.fault(if quoted { fault.help("write it without quotes") } else { fault });
}

/// Decodes a word that stands for a value.
pub fn word<T: Copy>(node: Node<'_>, what: &str, table: &[(&'static str, T)]) -> Option<T> {
    let known = table.iter().map(|(name, _)| *name);
    let Some(word) = node.bare_word() else {
        report_no_word(node, known);
        return None;
    };
    let found = table.iter().find(|(name, _)| *name == word).map(|(_, value)| *value);
    if found.is_none() {
        report_unknown(node, what, word, known.collect::<Vec<_>>());
    }
    found
}
