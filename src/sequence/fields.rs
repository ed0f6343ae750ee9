//! Named fields, and messages about unknown and missing ones.

use super::fault::Fault;
use super::node::{Node, NodeContent};
use super::schema::Ask;
use super::suggest::{listed, shortened};
use super::words::{is_literal, suggestion};
use std::borrow::Cow;
use std::collections::HashMap;

/// Up to this number, names are compared one by one.
const FEW: usize = 16;

/// The fields of one value. Read each known field; then [`Fields::finish`] reports the rest.
pub struct Fields<'s> {
    node: Node<'s>,
    /// The owner of the fields for messages: "a material", "`Sphere`".
    what: Cow<'static, str>,
    entries: Vec<(&'s str, Option<Node<'s>>)>,
    known: Vec<&'static str>,
    /// Former names of known fields, each with the name of today. They are accepted, but not listed in messages.
    former: Vec<(&'static str, &'static str)>,
    named_in_faults: bool,
    /// Whether the value stands for its only field, so that the schema learns about no others.
    stands_for_one: bool,
}

impl<'s> Fields<'s> {
    /// Reads `(name: value, ...)`, with or without a word in front.
    pub fn of(node: Node<'s>, what: impl Into<Cow<'static, str>>) -> Option<Self> {
        let (what, node) = (what.into(), node.as_word());
        let fields = match node.content()? {
            NodeContent::Fields(fields) => fields,
            NodeContent::Tuple(items) if items.is_empty() => Vec::new(),
            NodeContent::Plain if node.bare_word().is_some_and(|word| !is_literal(word)) => Vec::new(),
            content => {
                let fault = node.mismatch(format!("the fields of {what}, written (name: value, ...)"));
                let nameless = matches!(content, NodeContent::Tuple(_)) && !node.word().is_empty();
                node.fault(if nameless { fault.label("found values without names") } else { fault });
                return None;
            }
        };
        // Comparing a few names takes less time than hashing them.
        let differ =
            |(index, (name, _)): (usize, &(&str, _))| fields[..index].iter().all(|(other, _)| other != name);
        if fields.len() > FEW || !fields.iter().enumerate().all(differ) {
            report_duplicates(node, fields.iter().map(|(name, _)| (*name, *name)), "field");
        }
        node.ask(|| Ask::Fields { what: what.to_string() });
        let entries = fields.into_iter().map(|(name, value)| (name, Some(value))).collect();
        Some(Self {
            node,
            what,
            entries,
            known: Vec::new(),
            former: Vec::new(),
            named_in_faults: true,
            stands_for_one: false,
        })
    }

    /// [`Fields::of`] for values that may also be a single value in parentheses. That value is the field `only`, whose
    /// name has no place.
    pub fn of_or_only(
        node: Node<'s>,
        what: impl Into<Cow<'static, str>>,
        only: &'static str,
    ) -> Option<Self> {
        node.ask(|| Ask::Tuple { what: String::new(), count: 1 });
        if let NodeContent::Tuple(items) = node.content()?
            && let [item] = items[..]
        {
            return Some(Self { node, ..Self::only(item, what, only) });
        }
        Self::of(node, what)
    }

    /// The fields of a value that stands for its field `only`.
    pub fn only(node: Node<'s>, what: impl Into<Cow<'static, str>>, only: &'static str) -> Self {
        Self {
            node,
            what: what.into(),
            entries: vec![(only, Some(node))],
            known: Vec::new(),
            former: Vec::new(),
            named_in_faults: true,
            stands_for_one: true,
        }
    }

    /// Faults in these fields name the enclosing field instead.
    pub fn unnamed(mut self) -> Self {
        self.named_in_faults = false;
        self
    }

    /// Whether the field exists.
    pub fn has(&self, name: &str) -> bool {
        self.ask(|| Ask::Sibling(name.to_owned()));
        self.is_given(name)
    }

    /// [`Fields::has`] for a field that the schema need not know.
    pub fn is_given(&self, name: &str) -> bool {
        self.entries.iter().any(|(found, _)| *found == name)
    }

    fn ask(&self, ask: impl FnOnce() -> Ask) {
        if !self.stands_for_one {
            self.node.ask(ask);
        }
    }

    /// The place of a field's name, or of the whole value if the field is absent.
    pub fn place(&self, name: &str) -> std::ops::Range<usize> {
        let found = self.entries.iter().find(|(found, _)| *found == name);
        found.map_or_else(|| self.node.head(), |(name, _)| self.node.file.span_of(name))
    }

    pub fn node(&self) -> Node<'s> {
        self.node
    }

    /// Accepts a field without reading it, because its owner has a fault already.
    pub fn ignore(&mut self, name: &'static str) {
        self.ask(|| Ask::Field(name));
        self.known.push(name);
    }

    /// Accepts a field that only RON has, and that is used up before anything is decoded.
    pub fn used_up(&mut self, name: &'static str) {
        self.known.push(name);
    }

    /// Leaves out a field that is reported already. Messages do not list it.
    pub fn pass_over(&mut self, name: &str) {
        self.entries.retain(|(found, _)| *found != name);
    }

    fn take(&mut self, name: &'static str) -> Option<Node<'s>> {
        self.ask(|| Ask::Field(name));
        self.known.push(name);
        self.entries.iter_mut().find(|(found, _)| *found == name).and_then(|(_, value)| value.take())
    }

    /// Decodes a field. Returns `Some(None)` if it is absent, and `None` if it is wrong and reported.
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

    /// [`Fields::optional`] for a field that had the name `former`. A file may still use that name; the reader then
    /// warns. Both names together are a fault.
    pub fn renamed<T>(
        &mut self,
        name: &'static str,
        former: &'static str,
        decode: impl FnOnce(Node<'s>) -> Option<T>,
    ) -> Option<Option<T>> {
        self.former.push((former, name));
        self.ask(|| Ask::Former(former));
        if !self.is_given(former) {
            return self.optional(name, decode);
        }
        self.known.push(name);
        if self.is_given(name) {
            let title = format!("`{former}` is the former name of `{name}`");
            let fault = Fault::new(self.place(former), title, "remove this");
            self.node.fault(fault.also(self.place(name), "the same field is given here"));
            return None;
        }
        let (place, what) = (self.place(former), &self.what);
        let warning =
            format!("{what}: the field `{former}` is now called `{name}`; the old name still works");
        self.node.file.warn(place.start, warning);
        let value = self.optional(former, decode);
        self.known.retain(|known| *known != former);
        value
    }

    /// Decodes a field, with a default.
    pub fn or<T>(
        &mut self,
        name: &'static str,
        decode: impl FnOnce(Node<'s>) -> Option<T>,
        default: impl Into<T>,
    ) -> Option<T> {
        self.optional(name, decode).map(|value| value.unwrap_or_else(|| default.into()))
    }

    /// Decodes a field that must exist.
    pub fn required<T>(
        &mut self,
        name: &'static str,
        decode: impl FnOnce(Node<'s>) -> Option<T>,
    ) -> Option<T> {
        self.ask(|| Ask::Required(name));
        let value = self.optional(name, decode)?;
        if value.is_none() {
            let title = format!("{} has no `{name}`", self.what);
            self.node.fault(Fault::new(self.node.head(), title, format!("needs the field `{name}`")));
        }
        value
    }

    /// Reports every unknown field.
    pub fn finish(self) {
        self.ask(|| Ask::NoOthers);
        let accepted =
            |name: &str| self.known.contains(&name) || self.former.iter().any(|(old, _)| *old == name);
        for (name, _) in self.entries.iter().filter(|(name, _)| !accepted(name)) {
            let title = format!("{} has no field `{}`", self.what, shortened(name));
            let span = self.node.file.span_of(name);
            let known = || self.known.iter().copied();
            let names = known().map(|name| (name, name)).chain(self.former.iter().copied());
            let fault = Fault::new(span, title, suggestion(self.node, name, names));
            let help = match self.known.len() {
                0 => format!("{} has no fields", self.what),
                1 => format!("the only field of {} is {}", self.what, listed(known())),
                _ => format!("the fields of {} are {}", self.what, listed(known())),
            };
            self.node.fault(fault.help(help));
        }
    }
}

/// Reports names that occur twice. Takes each name with its text in the source.
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
