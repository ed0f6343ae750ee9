//! The named values that expressions see.

use super::number::Number;
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
    /// From the inside out.
    pub values: [Option<&'v Values>; 2],
    pub indices: Indices,
}

impl<'v> Scope<'v> {
    pub fn value(&self, name: &str) -> Option<&'v Value> {
        self.values.iter().flatten().find_map(|values| values.get(name))
    }

    /// All names, sorted.
    pub fn names(&self) -> Vec<&'v str> {
        let mut names: Vec<_> =
            self.values.iter().flatten().flat_map(|values| values.keys()).map(String::as_str).collect();
        names.extend(super::expression::INDICES.iter().take(self.indices.dimensions.into()));
        names.sort_unstable();
        names
    }
}
