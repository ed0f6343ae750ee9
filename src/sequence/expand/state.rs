//! What all parts of an expansion share.

use super::super::fault::Fault;
use super::super::node::Node;
use super::evaluate::{evaluate, unknown};
use super::expression::{Expression, PI};
use super::number::Number;
use super::parts::{Part, is_expression, parts};
use super::report::Report;
use super::scope::{Indices, Scope, Value, Values};
use super::template::Template;
use super::writer::{Fragment, Ledger};
use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

/// The names that a file defines, and those of the files that it includes.
#[derive(Default)]
pub struct Module<'s> {
    pub values: Values,
    pub templates: HashMap<String, Rc<Template<'s>>>,
    /// The use that includes the file.
    pub used: u32,
}

/// The state of an expansion.
pub struct State<'s> {
    pub ledger: Ledger,
    pub report: Report,
    /// By the index of the file.
    pub modules: Vec<Module<'s>>,
}

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

    /// Where the entries of a file are expanded that are used by `used`.
    pub fn context(&self, index: usize, used: u32) -> Context<'_> {
        let values = self.modules.get(index).map(|module| &module.values);
        let scope = Scope { values: [values, None], indices: Indices::default() };
        Context { scope, used, module: index, group: None, open: None }
    }

    /// The parts of a value.
    pub fn parts(&self, node: Node<'s>, used: u32) -> Vec<Part<'s>> {
        self.parts_of(node.text(), node.span().start, used)
    }

    /// The parts of a text that begins at byte `from` of all sources.
    pub fn parts_of(&self, text: &'s str, from: usize, used: u32) -> Vec<Part<'s>> {
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
        if let Expression::Name(name, at) = expression
            && context.scope.indices.get(name).is_none()
            && name != PI
        {
            let Some(value) = context.scope.value(name) else {
                self.fault(unknown(name, at, &context.scope), context.used);
                return None;
            };
            out.insert(&self.ledger, &value.fragment, place, context.used);
            return value.number;
        }
        let number = self.number(expression, context)?;
        out.made(&self.ledger, &number.text(), place, context.used);
        Some(number)
    }

    /// The value of an expression. Reports why there is none.
    pub fn number(&self, expression: &Expression, context: &Context<'_>) -> Option<Number> {
        evaluate(expression, &context.scope).map_err(|fault| self.fault(fault, context.used)).ok()
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
    pub fn operand(&self, node: Node<'s>, used: u32) -> Option<Expression> {
        if !is_expression(node.text()) {
            return Number::parse(node.text()).map(Expression::Number);
        }
        match self.parts(node, used).pop() {
            Some(Part::Value(expression, _)) => Some(expression),
            _ => None,
        }
    }
}
