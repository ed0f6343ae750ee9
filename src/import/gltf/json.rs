//! Values of the JSON part of a file with their paths, for messages such as `nodes[3].mesh: there is no mesh 7`.

use super::GltfResult;
use crate::geometry::mesh::MeshError;
use serde_json::Value;

/// Maximum absolute value of a number, as in sequences: squares and products must not overflow.
pub const LARGEST: f64 = 1e30;

/// A value and its path from the root of the file.
#[derive(Clone)]
pub struct Item<'a> {
    value: &'a Value,
    path: String,
}

impl<'a> Item<'a> {
    pub fn root(value: &'a Value) -> Self {
        Self { value, path: String::new() }
    }

    /// The path of a member.
    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// A member, if there is one.
    fn get(&self, key: &str) -> Option<Self> {
        let value = self.value.get(key).filter(|value| !value.is_null())?;
        Some(Self { value, path: self.path_of(key) })
    }

    /// Whether there is a member.
    pub fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// A member that is an object, if there is one.
    pub fn object(&self, key: &str) -> GltfResult<Option<Self>> {
        self.get(key).map(Self::into_object).transpose()
    }

    fn into_object(self) -> GltfResult<Self> {
        if self.value.is_object() { Ok(self) } else { Err(self.error("expected an object, as { ... }")) }
    }

    /// A member that must exist, and is an object.
    pub fn required(&self, key: &str) -> GltfResult<Self> {
        self.object(key)?.ok_or_else(|| self.error(format!("it has no `{key}`")))
    }

    /// An extension of this object.
    pub fn extension(&self, name: &str) -> GltfResult<Option<Self>> {
        let Some(extensions) = self.object("extensions")? else { return Ok(None) };
        extensions.object(name)
    }

    /// The names of the members.
    pub fn members(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        self.value.as_object().into_iter().flat_map(|members| members.keys().map(String::as_str))
    }

    /// The entries of a list of objects; none if there is no such member.
    pub fn list(&self, key: &str) -> GltfResult<Vec<Self>> {
        self.entries(key)?.into_iter().map(Self::into_object).collect()
    }

    /// The entries of a list; none if there is no such member.
    fn entries(&self, key: &str) -> GltfResult<Vec<Self>> {
        let Some(member) = self.get(key) else { return Ok(Vec::new()) };
        let entries = member.value.as_array().ok_or_else(|| member.error("expected a list"))?;
        let entry = |(index, value)| Self { value, path: format!("{}[{index}]", member.path) };
        Ok(entries.iter().enumerate().map(entry).collect())
    }

    /// The length of a list; 0 if there is no such member.
    pub fn len_of(&self, key: &str) -> usize {
        self.value.get(key).and_then(Value::as_array).map_or(0, Vec::len)
    }

    /// An entry of a list whose index has been checked.
    pub fn entry(&self, key: &str, index: usize) -> GltfResult<Self> {
        let path = format!("{}[{index}]", self.path_of(key));
        match self.value.get(key).and_then(|list| list.get(index)) {
            Some(value) => Self { value, path }.into_object(),
            None => Err(self.error(format!("there is no {path}"))),
        }
    }

    pub fn text(&self, key: &str) -> GltfResult<Option<&'a str>> {
        self.read(key, "a text", Value::as_str)
    }

    /// A name; empty if there is none. Characters that steer terminals become `_`, because messages show names.
    pub fn name(&self) -> GltfResult<String> {
        let name = self.text("name")?.unwrap_or_default();
        Ok(name.chars().map(|letter| if letter.is_control() { '_' } else { letter }).collect())
    }

    pub fn flag(&self, key: &str, default: bool) -> GltfResult<bool> {
        self.read(key, "true or false", Value::as_bool).map(|flag| flag.unwrap_or(default))
    }

    pub fn number(&self, key: &str, default: f64) -> GltfResult<f64> {
        self.read(key, "a number from -1e30 to 1e30", bounded).map(|number| number.unwrap_or(default))
    }

    /// A number of 0 or more.
    pub fn not_negative(&self, key: &str, default: f64) -> GltfResult<f64> {
        let is_good = |number: &f64| *number >= 0.0;
        let number = self.read(key, "a number of 0 or more", |value| bounded(value).filter(is_good))?;
        Ok(number.unwrap_or(default))
    }

    /// A number from 0 to 1.
    pub fn share(&self, key: &str, default: f64) -> GltfResult<f64> {
        let is_good = |number: &f64| (0.0..=1.0).contains(number);
        let number = self.read(key, "a number from 0 to 1", |value| bounded(value).filter(is_good))?;
        Ok(number.unwrap_or(default))
    }

    /// Exactly `N` numbers.
    pub fn numbers<const N: usize>(&self, key: &str) -> GltfResult<Option<[f64; N]>> {
        self.read(key, &format!("{N} numbers from -1e30 to 1e30"), |value| {
            let numbers: Vec<f64> = value.as_array()?.iter().map(bounded).collect::<Option<_>>()?;
            numbers.try_into().ok()
        })
    }

    /// A list of numbers of any length; empty if there is no such member.
    pub fn real_list(&self, key: &str) -> GltfResult<Vec<f64>> {
        let numbers = self.read(key, "numbers from -1e30 to 1e30", |value| {
            value.as_array()?.iter().map(bounded).collect::<Option<Vec<_>>>()
        })?;
        Ok(numbers.unwrap_or_default())
    }

    /// A colour, each channel 0 or more.
    pub fn color<const N: usize>(&self, key: &str, default: [f64; N]) -> GltfResult<[f64; N]> {
        let color = self.numbers(key)?.unwrap_or(default);
        if color.iter().any(|channel| *channel < 0.0) {
            return Err(self.wrong(key, "colours of 0 or more"));
        }
        Ok(color)
    }

    pub fn whole(&self, key: &str) -> GltfResult<Option<u64>> {
        self.read(key, "a whole number of 0 or more", Value::as_u64)
    }

    /// The index of an entry of the list `list` of the file, which has `count` entries.
    pub fn index(&self, key: &str, (list, count): (&str, usize)) -> GltfResult<Option<usize>> {
        let Some(index) = self.whole(key)? else { return Ok(None) };
        match usize::try_from(index).ok().filter(|index| *index < count) {
            Some(index) => Ok(Some(index)),
            None => Err(missing(&self.path_of(key), index, (list, count))),
        }
    }

    /// A list of such indices.
    pub fn indices(&self, key: &str, (list, count): (&str, usize)) -> GltfResult<Vec<usize>> {
        let index = |entry: Self| {
            let index = entry.value.as_u64().ok_or_else(|| entry.error("expected an index"))?;
            let checked = usize::try_from(index).ok().filter(|index| *index < count);
            checked.ok_or_else(|| missing(&entry.path, index, (list, count)))
        };
        self.entries(key)?.into_iter().map(index).collect()
    }

    /// A list of texts.
    pub fn texts(&self, key: &str) -> GltfResult<Vec<&'a str>> {
        let text = |entry: Self| entry.value.as_str().ok_or_else(|| entry.error("expected a text"));
        self.entries(key)?.into_iter().map(text).collect()
    }

    fn read<T>(
        &self,
        key: &str,
        what: &str,
        read: impl FnOnce(&'a Value) -> Option<T>,
    ) -> GltfResult<Option<T>> {
        match self.value.get(key).filter(|value| !value.is_null()) {
            None => Ok(None),
            Some(value) => read(value).map(Some).ok_or_else(|| self.wrong(key, what)),
        }
    }

    /// The error of a member that is not what it should be.
    fn wrong(&self, key: &str, what: &str) -> MeshError {
        MeshError::new(format!("{}: expected {what}", self.path_of(key)))
    }

    /// An error at this place of the file.
    pub fn error(&self, why: impl AsRef<str>) -> MeshError {
        let why = why.as_ref();
        MeshError::new(if self.path.is_empty() { why.to_owned() } else { format!("{}: {why}", self.path) })
    }
}

/// The path.
impl std::fmt::Display for Item<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.path)
    }
}

fn bounded(value: &Value) -> Option<f64> {
    value.as_f64().filter(|number| number.abs() <= LARGEST)
}

fn missing(path: &str, index: u64, (list, count): (&str, usize)) -> MeshError {
    MeshError::new(format!("{path}: there is no {list}[{index}]; the file has {count} of them"))
}
