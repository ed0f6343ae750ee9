//! Collects what the files of a sequence define: values, templates and sections.

use super::super::fault::Fault;
use super::super::fields::Fields;
use super::super::names::{Entry, entries};
use super::super::node::{Node, NodeContent};
use super::super::source_file::File;
use super::super::suggest::shortened;
use super::super::version;
use super::super::words::report_word;
use super::include::{Included, top_field};
use super::misplaced::report_misplaced;
use super::objects::{EntryKind, REPEAT};
use super::scope::Value;
use super::source_map::{NO_USE, UseKind};
use super::state::{Module, State};
use super::template::{check_name, template};
use super::visibility::Definition;
use super::writer::Fragment;
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

/// Faults after which messages about names in two files do not say which file includes both.
const EXPLAINED: usize = 1000;

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
        // First, because messages about names in two files name the file that includes both.
        for &index in &self.included.order {
            self.reach(index);
        }
        for &index in &self.included.order {
            let Some(file) = self.files.get(index) else { continue };
            let root = file.root();
            let (values, templates) = match index {
                0 => {
                    report_twice(root);
                    (top_field(root, "let"), top_field(root, "templates"))
                }
                _ => {
                    report_word(root);
                    let Some(mut fields) = Fields::of(root, "an included file") else {
                        self.state.values.miss(index);
                        self.state.templates.miss(index);
                        continue;
                    };
                    fields.optional(version::FIELD, version::version);
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

    /// Notes which files a file includes, after those.
    fn reach(&mut self, index: usize) {
        let mut own = Module { used: NO_USE, ..Module::default() };
        own.reach.insert(index);
        for (other, place) in &self.included.sources.get(index).includes {
            let Some(module) = self.state.modules.get_mut(*other) else { continue };
            own.reach.add(&module.reach);
            // The entries of a file are used where it is first included.
            if module.used == NO_USE {
                module.used = self.state.ledger.used(NO_USE, place, UseKind::Include);
            }
        }
        if let Some(module) = self.state.modules.get_mut(index) {
            *module = own;
        }
    }

    /// Values may use those above them, and those of included files.
    fn define_values(&mut self, index: usize, node: Node<'s>) {
        let Some(entries) = entries(node, "value") else { return self.state.values.miss(index) };
        for Entry { name, key, value } in entries {
            if name.is_empty() || !check_name(key, &name, "value") {
                continue;
            }
            let (place, context) = (key.span(), self.state.context(index, NO_USE));
            let value = match value.word() {
                REPEAT => {
                    report_misplaced(value, value.head(), REPEAT);
                    let fragment = Fragment { is_faulty: true, ..Fragment::default() };
                    Value { number: None, fragment: Rc::new(fragment), place: place.clone() }
                }
                _ => self.state.value(value, place.clone(), &context),
            };
            let definition = Definition { file: index, place: place.clone(), value };
            let before = self.state.values.insert(name.clone(), definition);
            self.report_clash("value", &name, (index, place), before);
        }
    }

    fn define_templates(&mut self, index: usize, node: Node<'s>) {
        let Some(entries) = entries(node, "template") else { return self.state.templates.miss(index) };
        for Entry { name, key, value } in entries {
            // Expressions of templates that nothing uses may have faults, too.
            self.state.parts(value, NO_USE);
            let (place, template) = (key.span(), template(value, &name, key.span(), index));
            let definition = Definition { file: index, place: place.clone(), value: template.map(Rc::new) };
            let before = self.state.templates.insert(name.clone(), definition);
            self.report_clash("template", &name, (index, place), before);
        }
    }

    /// Reports a name that two files define. The sequence sees both.
    fn report_clash(
        &self,
        what: &str,
        name: &str,
        (file, place): (usize, Range<usize>),
        before: Option<(usize, Range<usize>)>,
    ) {
        let Some((other, first)) = before.filter(|_| !name.is_empty()) else { return };
        let title = format!("two {what}s are named `{}`", shortened(name));
        let fault = Fault::new(place, title, "named again here").also(first, "first named here");
        let reaches = |index: usize, file| {
            self.state.modules.get(index).is_some_and(|module| module.reach.contains(file))
        };
        // The first file that includes both. The search would take long in files with this many faults.
        let is_few = self.state.report.len() < EXPLAINED;
        let order = self.included.order.iter().filter(|_| is_few && !reaches(file, other));
        let both = order.copied().find(|index| reaches(*index, file) && reaches(*index, other));
        let includes = both.map(|index| self.included.sources.get(index).includes.as_slice());
        let place = includes.unwrap_or_default().iter().find(|(index, _)| reaches(*index, file));
        self.state.fault(
            match place {
                Some((_, place)) => fault.used(place.clone(), "included here"),
                None => fault,
            },
            NO_USE,
        );
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
