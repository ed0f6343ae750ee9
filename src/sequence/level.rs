//! serde visitors that read one level of RON and leave what is nested as raw text.

use ron::value::RawValue;
use serde::de::{MapAccess, SeqAccess, Visitor};
use std::fmt;

/// Fields with their names, or values in a row.
pub enum Raw<'s> {
    Fields(Vec<(&'s str, &'s RawValue)>),
    Items(Vec<&'s RawValue>),
}

/// Reads parentheses and lists.
pub struct Parts;

impl<'s> Visitor<'s> for Parts {
    type Value = Raw<'s>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("values in parentheses or a list")
    }

    fn visit_unit<E>(self) -> Result<Self::Value, E> {
        Ok(Raw::Items(Vec::new()))
    }

    fn visit_seq<A: SeqAccess<'s>>(self, mut items: A) -> Result<Self::Value, A::Error> {
        let mut all = Vec::new();
        while let Some(item) = items.next_element()? {
            all.push(item);
        }
        Ok(Raw::Items(all))
    }

    fn visit_map<A: MapAccess<'s>>(self, mut fields: A) -> Result<Self::Value, A::Error> {
        let mut all = Vec::new();
        while let Some(field) = fields.next_entry()? {
            all.push(field);
        }
        Ok(Raw::Fields(all))
    }
}

/// Reads maps, whose keys are values themselves.
pub struct Entries;

impl<'s> Visitor<'s> for Entries {
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
