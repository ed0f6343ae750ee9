//! What decoders ask of a value: the facts of which the schema is made.

use serde_json::Value;
use std::cell::RefCell;
use std::collections::BTreeSet;

/// The description of a key: its time, its value, and possibly its easing.
pub const KEY: &str = "a key";

/// One thing that a decoder accepts in a value, or looks for in it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Ask {
    /// A number, text or boolean: its schema as JSON text.
    Plain(String),
    /// A word, alone or in front of brackets, and the description of such words.
    Word { what: String, word: String },
    /// This number of values in brackets, and their description.
    Tuple { what: String, count: usize },
    /// A list of what is described.
    List { what: String },
    /// A list of keys.
    Keys,
    /// A map from names to what is described.
    Map { what: String },
    /// Named fields, and their owner.
    Fields { what: String },
    /// A field that is read or known.
    Field(&'static str),
    /// A field without which the value is refused.
    Required(&'static str),
    /// A former name of a field.
    Former(&'static str),
    /// A field whose presence decides how others are read.
    Sibling(String),
    /// All fields have been read: any other is refused.
    NoOthers,
}

impl Ask {
    /// A plain value with this schema.
    pub fn plain(schema: &Value) -> Self {
        Self::Plain(schema.to_string())
    }
}

/// Collects what decoders ask of the value at one byte of the source.
#[derive(Default)]
pub struct Watch {
    at: usize,
    asked: RefCell<BTreeSet<Ask>>,
}

impl Watch {
    pub fn at(at: usize) -> Self {
        Self { at, asked: RefCell::default() }
    }

    /// Takes down a question about the value at a byte.
    pub fn note(&self, at: usize, ask: impl FnOnce() -> Ask) {
        if at == self.at {
            self.asked.borrow_mut().insert(ask());
        }
    }

    pub fn into_asked(self) -> BTreeSet<Ask> {
        self.asked.into_inner()
    }
}
