//! Expands the whole sequence: merges the sections of all files into one text.

use super::super::fault::Fault;
use super::super::names::entries;
use super::super::node::{Node, NodeContent};
use super::super::source_file::File;
use super::super::symbols::Symbols;
use super::definitions::{OWN_FIELDS, SECTIONS, Sections, define};
use super::include::{Included, file};
use super::objects::{EntryKind, REPEAT, entry};
use super::parts::{is_expression, without_comma};
use super::report::Report;
use super::source_map::{NO_USE, SourceMap};
use super::state::{Context, Meaning, Module, State};
use super::template::TEMPLATE;
use super::visibility::Definitions;
use super::writer::{Fragment, Ledger};
use crate::base::files::Root;
use std::ops::Range;
use std::path::Path;

/// An expanded sequence.
pub struct Expanded {
    pub text: String,
    pub map: SourceMap,
}

/// Whether a file uses anything that must be expanded.
pub fn is_needed(root: Node<'_>) -> bool {
    let text = root.text();
    if super::parts::has_expressions(text) {
        return true;
    }
    if !OWN_FIELDS.iter().chain(&[REPEAT, TEMPLATE]).any(|word| text.contains(word)) {
        return false;
    }
    let Some(NodeContent::Fields(fields)) = root.content() else { return false };
    fields.iter().any(|(name, value)| match *name {
        name if OWN_FIELDS.contains(&name) => true,
        "objects" | "lights" => match value.content() {
            Some(NodeContent::Map(entries)) => entries.iter().any(|(_, value)| is_special(*value)),
            _ => false,
        },
        _ => false,
    })
}

/// Whether an entry stands for several.
fn is_special(value: Node<'_>) -> bool {
    value.word() == REPEAT
        || value.text().contains(TEMPLATE)
            && matches!(value.content(), Some(NodeContent::Fields(fields)) if fields.iter().any(|(name, _)| *name == TEMPLATE))
}

/// Expands a sequence.
///
/// # Errors
/// All faults of the expansion.
pub fn expand(included: &Included, folder: &Path, root: &Root) -> Result<Expanded, Vec<Fault>> {
    let files: Vec<_> = included.sources.iter().map(|source| file(source, folder, root)).collect();
    let state = State {
        sources: &included.sources,
        files: &files,
        root,
        ledger: Ledger::default(),
        report: Report::default(),
        modules: files.iter().map(|_| Module { used: NO_USE, ..Module::default() }).collect(),
        values: Definitions::default(),
        templates: Definitions::default(),
    };
    let (state, sections) = define(state, included, &files);
    let mut out = Fragment { is_output: true, ..Fragment::default() };
    Writer { included, files: &files, state: &state, sections }.write(&mut out);
    let State { ledger, report, .. } = state;
    for file in &files {
        file.take_faults().into_iter().for_each(|fault| report.push(fault, &ledger, NO_USE));
    }
    if let Some((limit, place)) = ledger.full_at() {
        report.push(Fault::new(place, limit.message(), "too much from here on"), &ledger, NO_USE);
    }
    let faults = report.into_faults();
    if faults.is_empty() {
        let map = SourceMap { pieces: out.pieces, uses: ledger.into_uses() };
        return Ok(Expanded { text: out.text, map });
    }
    Err(faults)
}

/// Writes the expanded text.
struct Writer<'w, 's> {
    included: &'s Included,
    files: &'s [File<'s>],
    state: &'w State<'s>,
    sections: Sections<'s>,
}

impl<'s> Writer<'_, 's> {
    /// Writes the sequence's own fields, with the sections of all files.
    fn write(&self, out: &mut Fragment) {
        let Some(file) = self.files.first() else { return };
        let root = file.root();
        let Some(NodeContent::Fields(fields)) = root.content() else {
            // The decoder explains what is wrong with it.
            return self.copy(out, root.span(), NO_USE);
        };
        // Comments around the sequence stay, too.
        self.copy(out, 0..root.span().start, NO_USE);
        let mut at = root.span().start;
        let mut is_behind_own = false;
        for (name, value) in &fields {
            let place = file.span_of(name);
            self.write_gap(out, at..place.start, is_behind_own);
            at = value.span().end;
            is_behind_own = OWN_FIELDS.contains(name);
            if is_behind_own {
                continue;
            }
            self.copy(out, place.start..value.span().start, NO_USE);
            match SECTIONS.iter().find(|(section, ..)| section == name) {
                Some((_, noun, kind)) => self.write_section(out, name, noun, *kind, Some(*value)),
                None => {
                    let parts = self.state.parts(*value, NO_USE);
                    self.state.write(out, &parts, &self.state.context(0, NO_USE));
                }
            }
            out.made(&self.state.ledger, ",", &place, NO_USE);
        }
        for (name, noun, kind) in SECTIONS {
            let is_new = !fields.iter().any(|(found, _)| *found == name);
            if is_new && self.sections.get(name).is_some_and(|sections| !sections.is_empty()) {
                out.made(&self.state.ledger, &format!("\n    {name}: "), &root.head(), NO_USE);
                self.write_section(out, name, noun, kind, None);
                out.made(&self.state.ledger, ",", &root.head(), NO_USE);
            }
        }
        self.write_gap(out, at..root.span().end, is_behind_own);
        self.copy(out, root.span().end..self.included.sources.get(0).text.len(), NO_USE);
    }

    /// Writes the entries of a section: those of included files, then those of the sequence.
    fn write_section(
        &self,
        out: &mut Fragment,
        name: &str,
        noun: &str,
        kind: EntryKind,
        own: Option<Node<'s>>,
    ) {
        let included = self.sections.get(name).map(Vec::as_slice).unwrap_or_default();
        if let Some(node) = own
            && included.is_empty()
            && (!node.opens_with('{') || kind == EntryKind::Other)
        {
            // The decoder explains what is wrong with a section that is no map.
            let parts = self.state.parts(node, NO_USE);
            return self.state.write(out, &parts, &self.state.context(0, NO_USE));
        }
        let place = own.or(included.first().map(|(_, node)| *node)).map_or(0..0, |node| node.head());
        out.made(&self.state.ledger, "{", &place, NO_USE);
        for (index, node) in included.iter().copied().chain(own.map(|node| (0, node))) {
            let used = self.state.modules.get(index).map_or(NO_USE, |module| module.used);
            let context = self.state.context(index, used);
            match is_expression(node.text()) {
                true => self.write_value(out, node, (name, noun), &context),
                false => self.write_entries(out, node, noun, kind, &context),
            }
        }
        if own.is_none() {
            out.made(&self.state.ledger, "\n    ", &place, NO_USE);
        }
        out.made(&self.state.ledger, "}", &place, NO_USE);
    }

    /// Writes the entries of one file's section, with the blanks and comments between them.
    fn write_entries(
        &self,
        out: &mut Fragment,
        node: Node<'s>,
        noun: &str,
        kind: EntryKind,
        context: &Context<'_>,
    ) {
        let Some(all) = entries(node, noun) else { return };
        let mut at = node.span().start + 1;
        for object in &all {
            self.write_gap(out, at..object.key.span().start, false);
            at = object.value.span().end;
            let before = out.text.len();
            entry(self.state, out, object, kind, "", context);
            // An entry may stand for none.
            if out.text.len() > before {
                out.made(&self.state.ledger, ",", &object.key.span(), context.used);
            }
        }
        let is_own = context.module == 0;
        if is_own {
            self.write_gap(out, at..node.span().end - 1, false);
        }
    }

    /// Writes the entries of a section that is a named value.
    fn write_value(
        &self,
        out: &mut Fragment,
        node: Node<'s>,
        (name, noun): (&str, &str),
        context: &Context<'_>,
    ) {
        let value = match self.state.meaning(node, context) {
            Meaning::Value(value) => value,
            Meaning::Itself => {
                entries(node, noun);
                return;
            }
            Meaning::Faulty => return,
        };
        let inside = self.state.decoded(value, name, &node.span(), context, |node| {
            entries(node, noun)?;
            let last = Symbols::new(&node.text()[1..node.text().len() - 1]).last();
            let needs_comma = last.is_some_and(|(_, last)| last != ',');
            Some((node.span().start + 1..node.span().end - 1, needs_comma))
        });
        if let Some((inside, needs_comma)) = inside {
            out.insert(&self.state.ledger, &value.fragment, inside, &node.span(), context.used);
            if needs_comma {
                out.made(&self.state.ledger, ",", &node.span(), context.used);
            }
        }
    }

    /// Writes what is between two entries without its comma. Behind a field that is left out, only comments.
    fn write_gap(&self, out: &mut Fragment, place: Range<usize>, is_behind_own: bool) {
        let source = self.included.sources.of(place.start);
        let text = source.part(&place);
        let (before, behind) = without_comma(text);
        if is_behind_own && !text.contains("//") && !text.contains("/*") {
            // The bracket that closes the file is in the last gap.
            let closing = text.trim_start_matches(|c: char| c.is_ascii_whitespace() || c == ',');
            return self.copy(out, place.end - closing.len()..place.end, NO_USE);
        }
        self.copy(out, place.start..place.start + before.len(), NO_USE);
        self.copy(out, place.end - behind.len()..place.end, NO_USE);
    }

    fn copy(&self, out: &mut Fragment, place: Range<usize>, used: u32) {
        let text = self.included.sources.of(place.start).part(&place);
        out.copy(&self.state.ledger, text, place.start, used);
    }
}
