//! The named values that expressions see.

use super::number::Number;
use super::visibility::{Seen, sort_first};
use super::writer::Fragment;
use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

/// A named value: any value of the file. Only numbers can be used in arithmetic.
#[derive(Clone, Debug)]
pub struct Value {
    pub number: Option<Number>,
    pub fragment: Rc<Fragment>,
    /// The place of its name.
    pub place: Range<usize>,
}

pub type Values = HashMap<String, Value>;

/// The numbers of a copy: those of the first `dimensions` indices.
#[derive(Clone, Copy, Debug, Default)]
pub struct Indices {
    pub numbers: [u32; 3],
    pub dimensions: u8,
}

impl Indices {
    /// The number of the index with this name.
    pub fn get(&self, name: &str) -> Option<u32> {
        let used = super::expression::INDICES.iter().zip(self.numbers).take(self.dimensions.into());
        used.into_iter().find(|(index, _)| **index == name).map(|(_, number)| number)
    }
}

/// The values that an expression sees.
#[derive(Clone, Copy)]
pub struct Scope<'v> {
    /// Those of the parameters of its template. They hide values of the file.
    pub parameters: Option<&'v Values>,
    /// Those of its file.
    pub file: Option<Seen<'v, Value>>,
    pub indices: Indices,
}

impl<'v> Scope<'v> {
    pub fn value(&self, name: &str) -> Option<&'v Value> {
        self.parameters.and_then(|values| values.get(name)).or_else(|| self.file?.get(name))
    }

    /// All names, the first of them sorted.
    pub fn names(&self) -> Vec<&'v str> {
        let mut names: Vec<_> =
            self.parameters.into_iter().flat_map(|values| values.keys()).map(String::as_str).collect();
        let hidden = |name: &&str| !self.parameters.is_some_and(|values| values.contains_key(*name));
        names.extend(self.file.into_iter().flat_map(|file| file.names()).filter(hidden));
        names.extend(super::expression::INDICES.iter().take(self.indices.dimensions.into()));
        sort_first(&mut names);
        names
    }

    /// Whether names may be missing, because a section has a fault.
    pub fn is_partial(&self) -> bool {
        self.file.is_some_and(|file| file.is_partial())
    }
}
