//! Collects what the files of a sequence define: values, templates and sections.

use super::super::fault::Fault;
use super::super::fields::Fields;
use super::super::names::{Entry, entries};
use super::super::node::{File, Node, NodeContent};
use super::super::suggest::shortened;
use super::include::{Included, top_field};
use super::objects::EntryKind;
use super::source_map::{NO_USE, UseKind};
use super::state::{Module, State};
use super::template::{check_name, template};
use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

/// The sections that included files may have, each with the noun of its entries.
pub const SECTIONS: [(&str, &str, EntryKind); 4] = [
    ("materials", "material", EntryKind::Other),
    ("lights", "light", EntryKind::Light),
    ("objects", "object", EntryKind::Object),
    ("annotations", "annotation", EntryKind::Other),
];

/// The fields of a sequence that its expansion uses up.
pub const OWN_FIELDS: [&str; 3] = ["include", "let", "templates"];

/// The sections of included files by name: the index of the file, and the section.
pub type Sections<'s> = HashMap<&'static str, Vec<(usize, Node<'s>)>>;

/// Collects the names that each file defines, and the sections of included files.
pub fn define<'s>(
    state: State<'s>,
    included: &'s Included,
    files: &'s [File<'s>],
) -> (State<'s>, Sections<'s>) {
    let mut definer = Definer { included, files, state, sections: Sections::new() };
    definer.define();
    (definer.state, definer.sections)
}

struct Definer<'s> {
    included: &'s Included,
    files: &'s [File<'s>],
    state: State<'s>,
    sections: Sections<'s>,
}

impl<'s> Definer<'s> {
    fn define(&mut self) {
        for &index in &self.included.order {
            let Some(file) = self.files.get(index) else { continue };
            self.inherit(index);
            let root = file.root();
            let (values, templates) = match index {
                0 => {
                    report_twice(root);
                    (top_field(root, "let"), top_field(root, "templates"))
                }
                _ => {
                    let Some(mut fields) = Fields::of(root, "an included file") else { continue };
                    fields.ignore("include");
                    let mut node = |name| fields.optional(name, Some).flatten();
                    let own = (node("let"), node("templates"));
                    for (name, ..) in SECTIONS {
                        let section = node(name);
                        self.sections
                            .entry(name)
                            .or_default()
                            .extend(section.map(|section| (index, section)));
                    }
                    fields.finish();
                    own
                }
            };
            if let Some(node) = values {
                self.define_values(index, node);
            }
            if let Some(node) = templates {
                self.define_templates(index, node);
            }
        }
    }

    /// Makes the names of included files known to the file that includes them.
    fn inherit(&mut self, index: usize) {
        let mut own = std::mem::take(self.module(index));
        own.used = NO_USE;
        for (other, place) in &self.included.sources.get(index).includes {
            let Some(other) = self.state.modules.get(*other) else { continue };
            for (name, value) in &other.values {
                if let Some(before) = own.values.insert(name.clone(), value.clone())
                    && before.place != value.place
                {
                    let fault = twice("value", name, &value.place, &before.place);
                    self.state.fault(fault.used(place.clone(), "included here"), NO_USE);
                }
            }
            for (name, template) in &other.templates {
                if let Some(before) = own.templates.insert(name.clone(), Rc::clone(template))
                    && before.place != template.place
                {
                    let fault = twice("template", name, &template.place, &before.place);
                    self.state.fault(fault.used(place.clone(), "included here"), NO_USE);
                }
            }
        }
        *self.module(index) = own;
        // The entries of a file are used where it is first included.
        for (other, place) in &self.included.sources.get(index).includes {
            if self.state.modules.get(*other).is_some_and(|module| module.used == NO_USE) {
                let used = self.state.ledger.used(NO_USE, place, UseKind::Include);
                self.module(*other).used = used;
            }
        }
    }

    fn module(&mut self, index: usize) -> &mut Module<'s> {
        if index >= self.state.modules.len() {
            self.state.modules.resize_with(index + 1, Module::default);
        }
        &mut self.state.modules[index]
    }

    /// Values may use those above them, and those of included files.
    fn define_values(&mut self, index: usize, node: Node<'s>) {
        for Entry { name, key, value } in entries(node, "value").unwrap_or_default() {
            if name.is_empty() || !check_name(key, &name, "value") {
                continue;
            }
            let value = self.state.value(value, key.span(), &self.state.context(index, NO_USE));
            let before = self.module(index).values.insert(name.clone(), value);
            // Two names in one `let` have been reported.
            if let Some(before) = before.filter(|before| !is_within(&before.place, &node.span())) {
                self.state.fault(twice("value", &name, &key.span(), &before.place), NO_USE);
            }
        }
    }

    fn define_templates(&mut self, index: usize, node: Node<'s>) {
        for Entry { name, key, value } in entries(node, "template").unwrap_or_default() {
            let Some(template) = template(value, &name, key.span(), index) else { continue };
            let before = self.module(index).templates.insert(name.clone(), Rc::new(template));
            if let Some(before) = before.filter(|before| !is_within(&before.place, &node.span())) {
                self.state.fault(twice("template", &name, &key.span(), &before.place), NO_USE);
            }
        }
    }
}

/// Reports fields that are given twice. The decoder does not see them.
fn report_twice(root: Node<'_>) {
    let Some(NodeContent::Fields(fields)) = root.content() else { return };
    for own in OWN_FIELDS {
        let mut places =
            fields.iter().filter(|(name, _)| *name == own).map(|(name, _)| root.file.span_of(name));
        let Some(first) = places.next() else { continue };
        for again in places {
            let fault = Fault::new(again, format!("the field `{own}` is given twice"), "given again here");
            root.fault(fault.also(first.clone(), "first given here"));
        }
    }
}

fn is_within(inner: &Range<usize>, outer: &Range<usize>) -> bool {
    outer.contains(&inner.start)
}

/// The fault of a name that two files define.
fn twice(what: &str, name: &str, here: &Range<usize>, before: &Range<usize>) -> Fault {
    let title = format!("two {what}s are named `{}`", shortened(name));
    Fault::new(here.clone(), title, "named again here").also(before.clone(), "first named here")
}
