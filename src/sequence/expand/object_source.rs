//! Where an object was written whose fields are changed: in a file, or in a named value.

use super::parts::Part;
use super::scope::Value;
use super::state::{Context, State};
use std::ops::Range;
use std::rc::Rc;

/// The text of an object, or of one of its fields.
#[derive(Clone)]
pub enum ObjectSource {
    File,
    /// The value, and the place that uses it.
    Value(Value, Range<usize>),
}

impl ObjectSource {
    /// The parts of a place of the text.
    pub fn parts<'s>(&self, state: &State<'s>, span: Range<usize>, context: &Context<'_>) -> Vec<Part<'s>> {
        match self {
            _ if span.is_empty() => Vec::new(),
            Self::File => state.parts_at(span, context.used),
            Self::Value(value, place) => vec![Part::Slice(Rc::clone(&value.fragment), span, place.clone())],
        }
    }

    /// A place of the text among all sources.
    pub fn place(&self, span: Range<usize>) -> Range<usize> {
        match self {
            Self::File => span,
            Self::Value(value, _) => value.written_at(&span),
        }
    }
}
