//! What all parts of an expansion share.

use super::super::fault::Fault;
use super::super::node::Node;
use super::super::source_file::File;
use super::super::syntax::MAX_ENTRIES;
use super::super::{outline, suggest::shortened};
use super::evaluate::{Failure, evaluate, unknown, unknown_title};
use super::expression::{Expression, PI};
use super::number::Number;
use super::parts::{Part, is_expression, parts};
use super::report::Report;
use super::scope::{Indices, Scope, Value};
use super::source::Sources;
use super::source_map;
use super::template::Template;
use super::visibility::{Definitions, FileSet, Seen};
use super::writer::{Fragment, Ledger};
use crate::base::files::Root;
use std::collections::HashSet;
use std::ops::Range;
use std::path::Path;
use std::rc::Rc;

/// Faults after which messages about unknown names do not list the known ones, which takes long if there are many.
const EXPLAINED: usize = 1000;

/// A file.
#[derive(Default)]
pub struct Module {
    /// The file itself, and those that it includes, directly or through others.
    pub reach: FileSet,
    /// The use that includes the file.
    pub used: u32,
}

/// The state of an expansion.
pub struct State<'s> {
    pub sources: &'s Sources,
    /// All sources for decoders.
    pub files: &'s [File<'s>],
    pub root: &'s Root,
    pub ledger: Ledger,
    pub report: Report,
    /// By the index of the file.
    pub modules: Vec<Module>,
    pub values: Definitions<Value>,
    /// None for templates with a fault, which has been reported.
    pub templates: Definitions<Option<Rc<Template<'s>>>>,
}

/// What a value of a file stands for.
pub enum Meaning<'c> {
    /// What is written there.
    Itself,
    Value(&'c Value),
    /// It has a fault, which has been reported.
    Faulty,
}

/// Help about an expression where the file takes none.
pub const NO_EXPRESSION: &str = "no expression can stand here";

/// Where an entry is expanded.
#[derive(Clone, Copy)]
pub struct Context<'c> {
    pub scope: Scope<'c>,
    /// The use that it is within.
    pub used: u32,
    /// The index of its file.
    pub module: usize,
    /// The name of the template's object that it belongs to.
    pub group: Option<&'c str>,
    /// The templates that it is within.
    pub open: Option<&'c Open<'c>>,
}

/// A template that is being used, and those around it.
pub struct Open<'c> {
    pub template: &'c str,
    /// The names of its objects.
    pub objects: &'c HashSet<String>,
    /// The place of its definition.
    pub place: Range<usize>,
    pub around: Option<&'c Open<'c>>,
}

impl<'c> Open<'c> {
    /// This template and those around it.
    pub fn chain(&'c self) -> impl Iterator<Item = &'c Open<'c>> {
        std::iter::successors(Some(self), |open| open.around)
    }
}

impl Context<'_> {
    /// The name of an entry in the whole sequence.
    pub fn full_name(&self, name: &str) -> String {
        self.group.map_or_else(|| name.to_owned(), |group| format!("{group}/{name}"))
    }
}

impl<'s> State<'s> {
    pub fn fault(&self, fault: Fault, used: u32) {
        self.report.push(fault, &self.ledger, used);
    }

    /// How often faults were found, in all files.
    pub fn found_faults(&self) -> usize {
        self.report.found() + self.files.iter().map(File::fault_count).sum::<usize>()
    }

    /// Where the entries of a file are expanded that are used by `used`.
    pub fn context(&self, index: usize, used: u32) -> Context<'_> {
        let scope = Scope { parameters: None, file: self.values_of(index), indices: Indices::default() };
        Context { scope, used, module: index, group: None, open: None }
    }

    /// The values that a file sees.
    pub fn values_of(&self, index: usize) -> Option<Seen<'_, Value>> {
        self.modules.get(index).map(|module| self.values.seen(&module.reach))
    }

    /// The templates that a file sees.
    pub fn templates_of(&self, index: usize) -> Option<Seen<'_, Option<Rc<Template<'s>>>>> {
        self.modules.get(index).map(|module| self.templates.seen(&module.reach))
    }

    /// The parts of a place in a file.
    pub fn parts_at(&self, place: Range<usize>, used: u32) -> Vec<Part<'s>> {
        self.parts_of(self.sources.of(place.start).part(&place), place.start, used)
    }

    /// The parts of a value.
    pub fn parts<'t>(&self, node: Node<'t>, used: u32) -> Vec<Part<'t>> {
        self.parts_of(node.text(), node.span().start, used)
    }

    /// The parts of a text that begins at byte `from` of all sources.
    fn parts_of<'t>(&self, text: &'t str, from: usize, used: u32) -> Vec<Part<'t>> {
        let mut faults = Vec::new();
        let parts = parts(text, from, &mut faults);
        faults.into_iter().for_each(|fault| self.fault(fault, used));
        parts
    }

    /// Writes parts with the values of their expressions.
    pub fn write(&self, out: &mut Fragment, parts: &[Part<'s>], context: &Context<'_>) {
        for part in parts {
            match part {
                Part::Copy(text, from) => out.copy(&self.ledger, text, *from, context.used),
                Part::Made(text, place) => out.made(&self.ledger, text, place, context.used),
                Part::Value(expression, place) => {
                    self.write_value(out, expression, place, context);
                }
                Part::Slice(fragment, part, place) => {
                    out.insert(&self.ledger, fragment, part.clone(), place, context.used);
                }
                Part::Faulty => out.is_faulty = true,
            }
        }
    }

    /// Writes the value of an expression, and returns it if it is a number. A name alone may stand for any value.
    fn write_value(
        &self,
        out: &mut Fragment,
        expression: &Expression,
        place: &Range<usize>,
        context: &Context<'_>,
    ) -> Option<Number> {
        if let Some(name) = name_alone(expression, context) {
            let value = self.named(name, context);
            let Some(value) = value else {
                out.is_faulty = true;
                return None;
            };
            out.insert(&self.ledger, &value.fragment, 0..value.fragment.text.len(), place, context.used);
            return value.number;
        }
        let Some(number) = self.number(expression, context) else {
            out.is_faulty = true;
            return None;
        };
        out.made(&self.ledger, &number.text(), place, context.used);
        Some(number)
    }

    /// The value with a name. Reports that there is none.
    fn named<'c>(&self, (name, at): (&str, &Range<usize>), context: &Context<'c>) -> Option<&'c Value> {
        let value = context.scope.value(name);
        if value.is_none() {
            self.report_unknown(name, at, context);
        }
        value
    }

    fn report_unknown(&self, name: &str, place: &Range<usize>, context: &Context<'_>) {
        let title = unknown_title(name);
        if context.scope.is_partial() || self.report.repeats(place, title.clone()) {
            return;
        }
        let fault = match self.report.len() < EXPLAINED {
            true => unknown(name, place, &context.scope),
            false => Fault::new(place.clone(), title, "unknown"),
        };
        self.fault(fault, context.used);
    }

    /// The value of an expression. Reports why there is none.
    pub fn number(&self, expression: &Expression, context: &Context<'_>) -> Option<Number> {
        match evaluate(expression, &context.scope) {
            Ok(number) => return Some(number),
            Err(Failure::Fault(fault)) => self.fault(fault, context.used),
            Err(Failure::Unknown(name, place)) => self.report_unknown(name, place, context),
            Err(Failure::Reported) => {}
        }
        None
    }

    /// What a value of a file stands for. Reports the fault of its expression.
    pub fn meaning<'c>(&self, node: Node<'_>, context: &Context<'c>) -> Meaning<'c> {
        if !is_expression(node.text()) {
            return Meaning::Itself;
        }
        let Some(expression) = self.operand(node, context.used) else { return Meaning::Faulty };
        let Some(name) = name_alone(&expression, context) else { return Meaning::Itself };
        match self.named(name, context) {
            Some(value) if !value.fragment.is_faulty => Meaning::Value(value),
            _ => Meaning::Faulty,
        }
    }

    /// Decodes a named value that is used at `place`, in this field unless it is empty. Its faults are reported where it was written.
    pub fn decoded<T>(
        &self,
        value: &Value,
        field: &str,
        place: &Range<usize>,
        context: &Context<'_>,
        decode: impl FnOnce(Node<'_>) -> T,
    ) -> T {
        let text = value.fragment.text.as_str();
        let is_common = outline::is_common(text, MAX_ENTRIES);
        let file = File::new(text, Path::new(""), self.root.clone(), is_common);
        let decoded = decode(file.root());
        for mut fault in file.take_faults() {
            if !field.is_empty() {
                fault.name_field(field);
            }
            let used = vec![(place.clone(), "the value is used here".to_owned())];
            self.fault(fault.relocated(|span| value.written_at(&span), used), context.used);
        }
        decoded
    }

    /// Decodes a field of a file, which may be the name of a value.
    pub fn field<T>(
        &self,
        node: Node<'_>,
        name: &str,
        context: &Context<'_>,
        decode: impl FnOnce(Node<'_>) -> Option<T>,
    ) -> Option<T> {
        match self.meaning(node, context) {
            Meaning::Itself => decode(node),
            Meaning::Value(value) => self.decoded(value, name, &node.span(), context, decode),
            Meaning::Faulty => None,
        }
    }

    /// Reports an expression where the file takes none.
    pub fn refuse_expression(&self, node: Node<'_>, what: &str, context: &Context<'_>) -> bool {
        let refused = is_expression(node.text());
        if refused {
            let fault = Fault::expected(node.span(), what, format!("found {}", shortened(node.text())));
            self.fault(fault.help(NO_EXPRESSION), context.used);
        }
        refused
    }

    /// A named value, whose name is at `place`.
    pub fn value(&self, node: Node<'s>, place: Range<usize>, context: &Context<'_>) -> Value {
        self.value_of(&self.parts(node, context.used), place, context)
    }

    /// [`State::value`] of a value that is split already.
    pub fn value_of(&self, parts: &[Part<'s>], place: Range<usize>, context: &Context<'_>) -> Value {
        let mut fragment = Fragment::default();
        let number = match parts {
            [Part::Value(expression, at)] => self.write_value(&mut fragment, expression, at, context),
            _ => {
                self.write(&mut fragment, parts, context);
                Number::parse(fragment.text.trim())
            }
        };
        Value { number, fragment: Rc::new(fragment), place }
    }

    /// A number of the file as an operand of expressions; None for other values, without a report.
    pub fn operand(&self, node: Node<'_>, used: u32) -> Option<Expression> {
        if !is_expression(node.text()) {
            return Number::parse(node.text()).map(Expression::Number);
        }
        match self.parts(node, used).pop() {
            Some(Part::Value(expression, _)) => Some(expression),
            _ => None,
        }
    }
}

impl Value {
    /// The place in the sources of a part of its text.
    pub fn written_at(&self, part: &Range<usize>) -> Range<usize> {
        source_map::place(&self.fragment.pieces, part).span
    }
}

/// The name of a value, with its place, if an expression consists of it alone.
fn name_alone<'e>(expression: &'e Expression, context: &Context<'_>) -> Option<(&'e str, &'e Range<usize>)> {
    match expression {
        Expression::Name(name, place) if context.scope.indices.get(name).is_none() && name != PI => {
            Some((name, place))
        }
        _ => None,
    }
}
