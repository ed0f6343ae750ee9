//! The data of points and cells in legacy files.

use super::super::number::NumberType;
use super::Reader;
use crate::base::math::DVec3;
use crate::geometry::mesh::{Centering, DataArray, MeshError};

impl Reader<'_> {
    /// Reads an attribute, of which `rest` are the words after the keyword.
    pub(super) fn attribute(
        &mut self,
        keyword: &str,
        rest: &[&str],
        centering: Centering,
        entries: u64,
    ) -> Result<(), MeshError> {
        match (keyword, rest) {
            ("SCALARS", [name, kind, components @ ..]) => {
                let components = components.first().map_or(Ok(1), |word| self.count(word))?;
                let kind = self.kind(kind)?;
                // The table is named always, and defined in few files.
                let words = self.source.words().unwrap_or_default();
                if !words.first().is_some_and(|word| word.eq_ignore_ascii_case("LOOKUP_TABLE")) {
                    return Err(self.source.unexpected("`LOOKUP_TABLE` after `SCALARS`"));
                }
                self.array(name, (entries, components), kind, centering)
            }
            ("COLOR_SCALARS", [name, components]) => {
                let kind = if self.source.binary { NumberType::U8 } else { NumberType::F32 };
                let components = self.count(components)?;
                self.array(name, (entries, components), kind, centering)
            }
            ("LOOKUP_TABLE", [_, size]) => {
                let kind = if self.source.binary { NumberType::U8 } else { NumberType::F32 };
                let size = self.count(size)?;
                self.source.numbers(size.saturating_mul(4), kind, "`LOOKUP_TABLE`").map(drop)
            }
            ("VECTORS", [name, kind]) => {
                let kind = self.kind(kind)?;
                self.array(name, (entries, 3), kind, centering)
            }
            ("NORMALS", [name, kind]) => {
                let kind = self.kind(kind)?;
                self.array(name, (entries, 3), kind, centering)?;
                self.take_normals(centering)
            }
            ("TENSORS", [name, kind]) => {
                let kind = self.kind(kind)?;
                self.array(name, (entries, 9), kind, centering)
            }
            ("TENSORS6", [name, kind]) => {
                let kind = self.kind(kind)?;
                self.array(name, (entries, 6), kind, centering)
            }
            ("TEXTURE_COORDINATES", [name, components, kind]) => {
                let (components, kind) = (self.count(components)?, self.kind(kind)?);
                self.array(name, (entries, components), kind, centering)
            }
            ("GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS", [name, kind]) => {
                let kind = self.kind(kind)?;
                self.array(name, (entries, 1), kind, centering)
            }
            _ => Err(self.source.unexpected("data such as `SCALARS`, `VECTORS` or `FIELD`")),
        }
    }

    /// Reads the arrays of a `FIELD`. Those before the data of points and cells belong to the whole file and are
    /// skipped.
    pub(super) fn fields(&mut self, amount: &str) -> Result<(), MeshError> {
        for _ in 0..self.count(amount)? {
            let mut words = self.source.words().unwrap_or_default();
            while words.first().is_some_and(|word| word.eq_ignore_ascii_case("METADATA")) {
                self.source.skip_section();
                words = self.source.words().unwrap_or_default();
            }
            let [name, components, entries, kind] = &words[..] else {
                return Err(self.source.unexpected("an array of the `FIELD`: a name, two counts and a type"));
            };
            let (components, entries) = (self.count(components)?, self.count(entries)?);
            if kind.eq_ignore_ascii_case("string") {
                // Texts have no colours.
                self.source.skip_texts(entries.saturating_mul(components), &format!("`{name}`"))?;
                continue;
            }
            let kind = self.kind(kind)?;
            match self.data {
                Some((centering, _)) => self.array(name, (entries, components), kind, centering)?,
                None => drop(self.source.numbers(entries.saturating_mul(components), kind, "`FIELD`")?),
            }
        }
        Ok(())
    }

    fn array(
        &mut self,
        name: &str,
        (entries, components): (u64, u64),
        kind: NumberType,
        centering: Centering,
    ) -> Result<(), MeshError> {
        let name = decoded(name);
        if components == 0 {
            return Err(self.source.fault(format!("the data `{name}` has no components")));
        }
        let place = self.source.place();
        let values = self.source.numbers(entries.saturating_mul(components), kind, &format!("`{name}`"))?;
        let components = components as usize;
        self.grid.arrays.push(DataArray { name, centering, components, values: values.into() });
        self.array_places.push(place);
        Ok(())
    }

    /// Makes the last array the normals of the points. Normals of cells stay data.
    fn take_normals(&mut self, centering: Centering) -> Result<(), MeshError> {
        let Some(array) = self.grid.arrays.pop_if(|_| centering == Centering::Points) else { return Ok(()) };
        let place = self.array_places.pop().unwrap_or(self.source.place());
        let points = self.grid.positions.len();
        if array.entries() != points {
            let (name, entries) = (&array.name, array.entries());
            return Err(MeshError::at(
                place,
                format!("the normals `{name}` have {entries} entries for {points} points"),
            ));
        }
        let normal = |entry: usize| [0, 1, 2].map(|k| array.values.get(3 * entry + k));
        self.grid.normals = (0..points).map(|entry| DVec3::from(normal(entry)).as_vec3()).collect();
        Ok(())
    }
}

/// A name in which blanks and some signs are written as % and two hexadecimal digits.
fn decoded(name: &str) -> String {
    let (mut bytes, mut rest) = (Vec::new(), name.as_bytes());
    while let [first, tail @ ..] = rest {
        let code = tail.get(..2).and_then(|digits| std::str::from_utf8(digits).ok());
        match code.filter(|_| *first == b'%').and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            None => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
