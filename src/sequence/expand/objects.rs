//! Expands entries of `objects` and `lights`: repeated ones, and objects of templates.

use super::super::fault::Fault;
use super::super::fields::Fields;
use super::super::names::Entry;
use super::super::node::{Node, NodeContent};
use super::count::{Steps, count, steps};
use super::misplaced::report_misplaced;
use super::object_source::ObjectSource;
use super::object_text::ObjectText;
use super::parts::Part;
use super::scope::{Indices, Scope};
use super::source::quoted;
use super::source_map::UseKind;
use super::state::{Context, Meaning, Open, State};
use super::template::{Instance, TEMPLATE, WITH};
use super::writer::Fragment;

/// The word of entries that stand for several.
pub const REPEAT: &str = "Repeat";

/// What an entry describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EntryKind {
    Object,
    Light,
    /// Cannot be repeated.
    Other,
}

/// Separates entries that have no separator in a file.
const SEPARATOR: &str = ",\n        ";

/// Writes an entry and everything that it stands for, with `separator` in front and without a comma at its end. It may
/// stand for nothing; then nothing is written.
pub fn entry<'s>(
    state: &State<'s>,
    out: &mut Fragment,
    entry: &Entry<'s>,
    kind: EntryKind,
    separator: &str,
    context: &Context<'_>,
) {
    // A name that is not valid has been reported.
    if entry.name.is_empty() {
        return;
    }
    if entry.value.word() == REPEAT && kind != EntryKind::Other {
        repeated(state, out, entry, kind, separator, context);
        return;
    }
    if let Some(prepared) = Prepared::new(state, entry.value, None, kind, context) {
        prepared.write(state, out, entry, separator, "", context);
    }
}

/// Writes the copies of `Repeat(count: .., step: .., object: ..)`.
fn repeated<'s>(
    state: &State<'s>,
    out: &mut Fragment,
    entry: &Entry<'s>,
    kind: EntryKind,
    mut separator: &str,
    context: &Context<'_>,
) {
    let Some(mut fields) = Fields::of(entry.value, "`Repeat`") else { return };
    let count = fields.required("count", |node| count(state, node, context));
    let dimensions = count.map_or(1, |count| count.dimensions);
    // Expressions may use the indices of the copies.
    let inside = |numbers| Context {
        scope: Scope { indices: Indices { numbers, dimensions }, ..context.scope },
        ..*context
    };
    let shift = match kind {
        EntryKind::Object if count.is_some() => {
            fields.optional("step", |node| steps(state, node, dimensions, &inside([0; 3])))
        }
        EntryKind::Object => {
            fields.ignore("step");
            None
        }
        _ => Some(None),
    };
    let (name, place) = if kind == EntryKind::Light {
        ("light", fields.place("light"))
    } else {
        ("object", fields.place("object"))
    };
    let value = fields.required(name, Some);
    fields.finish();
    let (Some(count), Some(shift), Some(value)) = (count, shift, value) else { return };
    if value.word() == REPEAT {
        let fault = Fault::new(value.head(), "`Repeat` cannot stand directly in `Repeat`", "one too many");
        value.fault(
            fault.help("write two or three counts, such as `count: (3, 4)`, with the indices `i` and `j`"),
        );
        return;
    }
    let Some(prepared) = Prepared::new(state, value, shift.as_ref(), kind, &inside([0; 3])) else { return };
    let mut is_first = true;
    for indices in count.copies() {
        if state.ledger.is_full() {
            return;
        }
        let (found, different) = (state.report.found(), state.report.len());
        let before = if is_first { state.found_faults() } else { 0 };
        let copy = UseKind::Copy { indices: indices.numbers, dimensions };
        let context =
            Context { used: state.ledger.used(context.used, &place, copy), ..inside(indices.numbers) };
        let numbers = indices.numbers.iter().take(dimensions.into()).map(u32::to_string);
        let suffix = format!("[{}]", numbers.collect::<Vec<_>>().join(","));
        prepared.write(state, out, entry, separator, &suffix, &context);
        separator = SEPARATOR;
        // Further copies would have the same faults, and would take long to report them.
        let has_known = state.report.found() > found && state.report.len() == different;
        if has_known || is_first && state.found_faults() > before && state.report.len() == different {
            return;
        }
        is_first = false;
    }
}

/// An entry that is ready to be written many times.
struct Prepared<'s> {
    /// The value of the entry itself.
    parts: Vec<Part<'s>>,
    /// The template whose objects follow.
    instance: Option<Instance<'s>>,
}

impl<'s> Prepared<'s> {
    /// Nothing if the entry has a fault, which is reported.
    fn new(
        state: &State<'s>,
        node: Node<'s>,
        shift: Option<&Steps>,
        kind: EntryKind,
        context: &Context<'_>,
    ) -> Option<Self> {
        let is_changed = shift.is_some() || context.group.is_some();
        if kind != EntryKind::Object {
            return Some(Self { parts: state.parts(node, context.used), instance: None });
        }
        match state.meaning(node, context) {
            Meaning::Value(value) if is_changed => {
                let source = ObjectSource::Value(value.clone(), node.span());
                let prepare = |node: Node<'_>| Self::object(state, node, &source, shift, context);
                state.decoded(value, "", &node.span(), context, prepare)
            }
            Meaning::Faulty => None,
            _ => Self::object(state, node, &ObjectSource::File, shift, context),
        }
    }

    fn object(
        state: &State<'s>,
        node: Node<'_>,
        source: &ObjectSource,
        shift: Option<&Steps>,
        context: &Context<'_>,
    ) -> Option<Self> {
        let is_value = matches!(source, ObjectSource::Value(..));
        if is_value && node.word() == REPEAT {
            report_misplaced(node, node.head(), REPEAT);
            return None;
        }
        let fields = match node.content()? {
            NodeContent::Fields(fields) => fields,
            NodeContent::Tuple(items) if items.is_empty() => Vec::new(),
            // The decoder explains what is wrong with it.
            _ => return Some(Self { parts: source.parts(state, node.span(), context), instance: None }),
        };
        let field = |name| fields.iter().find(|(found, _)| *found == name).map(|(_, node)| *node);
        let instance = match (field(TEMPLATE), field(WITH)) {
            (Some(template), _) if is_value => {
                report_misplaced(node, template.span(), TEMPLATE);
                return None;
            }
            (Some(template), with) => {
                if let Some(shape) = field("shape").or(field("material")) {
                    let title = "an object of a template has the shapes and materials of the template";
                    let fault = Fault::new(shape.span(), title, "remove this");
                    node.fault(
                        fault
                            .also(template.span(), "the template")
                            .help("pass them to a parameter by `with`"),
                    );
                    return None;
                }
                Some(Instance::new(state, template, with, context)?)
            }
            // The decoder reports a `with` without a template.
            (None, _) => None,
        };
        if instance.is_none() && context.group.is_none() && shift.is_none() {
            return Some(Self { parts: source.parts(state, node.span(), context), instance });
        }
        let own = ObjectText { state, node, fields: &fields, source, context };
        Some(Self { parts: own.parts(shift, instance.is_some())?, instance })
    }

    /// Writes the entry under its name with this suffix, and the objects of its template behind it.
    fn write(
        &self,
        state: &State<'s>,
        out: &mut Fragment,
        entry: &Entry<'s>,
        separator: &str,
        suffix: &str,
        context: &Context<'_>,
    ) {
        let place = entry.key.span();
        let name = context.full_name(&format!("{}{suffix}", entry.name));
        if suffix.is_empty() && context.group.is_none() && separator.is_empty() {
            out.copy(&state.ledger, entry.key.text(), place.start, context.used);
            out.made(&state.ledger, ": ", &place, context.used);
        } else {
            out.made(&state.ledger, &format!("{separator}{}: ", quoted(&name)), &place, context.used);
        }
        state.write(out, &self.parts, context);
        if let Some(instance) = &self.instance {
            write_objects(state, out, instance, &name, context);
        }
    }
}

/// Writes the objects of a template.
fn write_objects<'s>(
    state: &State<'s>,
    out: &mut Fragment,
    instance: &Instance<'s>,
    name: &str,
    context: &Context<'_>,
) {
    let held = state.ledger.held();
    let (values, template) = (instance.values(state, context), &instance.template);
    let Some(entries) = template.entries() else { return };
    let open = Open {
        template: &template.name,
        objects: template.names(),
        place: template.place.clone(),
        around: context.open,
    };
    let file = state.values_of(template.module);
    let inside = Context {
        scope: Scope { parameters: Some(&values), file, indices: Indices::default() },
        used: state.ledger.used(context.used, &instance.place, UseKind::Template),
        module: template.module,
        group: Some(name),
        open: Some(&open),
    };
    for object in entries {
        if state.ledger.is_full() {
            return;
        }
        entry(state, out, object, EntryKind::Object, SEPARATOR, &inside);
    }
    // The values of the parameters are gone.
    state.ledger.release(held);
}
