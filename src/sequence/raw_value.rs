//! serde visitors that decode one level of RON, and leave nested values as raw text.

use ron::value::RawValue;
use serde::de::{MapAccess, SeqAccess, Visitor};
use std::fmt;

/// Named fields, or a list of values.
pub enum RawContent<'s> {
    Fields(Vec<(&'s str, &'s RawValue)>),
    Items(Vec<&'s RawValue>),
}

/// Visits parentheses and lists.
pub struct ContentVisitor;

impl<'s> Visitor<'s> for ContentVisitor {
    type Value = RawContent<'s>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("values in parentheses or a list")
    }

    fn visit_unit<E>(self) -> Result<Self::Value, E> {
        Ok(RawContent::Items(Vec::new()))
    }

    fn visit_seq<A: SeqAccess<'s>>(self, mut items: A) -> Result<Self::Value, A::Error> {
        let mut all = Vec::new();
        while let Some(item) = items.next_element()? {
            all.push(item);
        }
        Ok(RawContent::Items(all))
    }

    fn visit_map<A: MapAccess<'s>>(self, mut fields: A) -> Result<Self::Value, A::Error> {
        let mut all = Vec::new();
        while let Some(field) = fields.next_entry()? {
            all.push(field);
        }
        Ok(RawContent::Fields(all))
    }
}

/// Visits maps, whose keys are values too.
pub struct MapVisitor;

impl<'s> Visitor<'s> for MapVisitor {
    type Value = Vec<(&'s RawValue, &'s RawValue)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a map")
    }

    fn visit_map<A: MapAccess<'s>>(self, mut entries: A) -> Result<Self::Value, A::Error> {
        let mut all = Vec::new();
        while let Some(entry) = entries.next_entry()? {
            all.push(entry);
        }
        Ok(all)
    }
}
