//! Expands a sequence: values with names, expressions, repeated objects, templates and included files.
//!
//! In: the texts of the files, in which expressions are texts such as `"= 2 * r"`. Out: one plain text that the
//! decoders read, and a source map that leads from its places to those of the files.

mod angles;
mod count;
mod definitions;
mod document;
mod evaluate;
mod expression;
mod functions;
pub mod include;
mod misplaced;
mod number;
mod object_text;
mod object_source;
mod objects;
mod parts;
mod report;
mod rounding;
mod scope;
pub mod source;
pub mod source_map;
mod state;
mod template;
mod visibility;
mod writer;

pub use definitions::OWN_FIELDS;
pub use document::{Expanded, expand, is_needed};
pub use misplaced::report_misplaced;
pub use objects::REPEAT;
pub use template::{TEMPLATE, WITH};
