//! The header of a PLY file: its elements and their properties.

use crate::geometry::mesh::{MeshError, MeshLocation};
use crate::import::lines::{Lines, parsed, quoted, split_word, unexpected, words};
use std::io::BufRead;

/// The encoding of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlyFormat {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// A property of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Property {
    pub name: String,
    pub item: ScalarType,
    /// The type of the count of a list; `None` for a single value.
    pub list: Option<ScalarType>,
}

/// A kind of records, and their number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    pub format: PlyFormat,
    pub elements: Vec<Element>,
}

impl Header {
    /// Reads the lines up to `end_header`.
    pub fn read(lines: &mut Lines<impl BufRead>) -> Result<Self, MeshError> {
        match lines.next()? {
            Some((_, b"ply")) => {}
            _ => return Err(MeshError::new("it is not a PLY file: its first line is not `ply`")),
        }
        let (mut format, mut elements) = (None, Vec::new());
        while let Some((number, line)) = lines.next()? {
            let (word, rest) = split_word(line);
            match word {
                b"end_header" => {
                    let why = "the header has no line `format`, such as `format ascii 1.0`";
                    let format = format.ok_or_else(|| MeshError::at(MeshLocation::Line(number), why))?;
                    return Ok(Self { format, elements });
                }
                b"comment" | b"obj_info" | b"" => {}
                b"format" => {
                    format = Some(parse_format(rest).map_err(|what| unexpected(number, line, what))?)
                }
                b"element" => {
                    elements.push(parse_element(rest).map_err(|what| unexpected(number, line, what))?)
                }
                b"property" => {
                    let property = parse_property(rest).map_err(|what| unexpected(number, line, what))?;
                    let Some(element): Option<&mut Element> = elements.last_mut() else {
                        return Err(unexpected(number, line, "`element` before its properties"));
                    };
                    element.properties.push(property);
                }
                _ => return Err(unexpected(number, line, "`element`, `property` or `end_header`")),
            }
        }
        Err(MeshError::new("the header has no line `end_header`"))
    }
}

fn parse_format(rest: &[u8]) -> Result<PlyFormat, &'static str> {
    match words(rest).next() {
        Some(b"ascii") => Ok(PlyFormat::Ascii),
        Some(b"binary_little_endian") => Ok(PlyFormat::LittleEndian),
        Some(b"binary_big_endian") => Ok(PlyFormat::BigEndian),
        _ => Err("`format ascii`, `format binary_little_endian` or `format binary_big_endian`"),
    }
}

fn parse_element(rest: &[u8]) -> Result<Element, &'static str> {
    let mut words = words(rest);
    let name = words.next().map(|name| String::from_utf8_lossy(name).into_owned());
    match (name, words.next().and_then(parsed)) {
        (Some(name), Some(count)) => Ok(Element { name, count, properties: Vec::new() }),
        _ => Err("`element`, a name and a count"),
    }
}

fn parse_property(rest: &[u8]) -> Result<Property, &'static str> {
    let words: Vec<_> = words(rest).collect();
    let name = |name: &[u8]| String::from_utf8_lossy(name).into_owned();
    let found = match words[..] {
        [b"list", count, item, called] => match (scalar(count), scalar(item)) {
            (Some(count), Some(item)) if count != ScalarType::F32 && count != ScalarType::F64 => {
                Some(Property { name: name(called), item, list: Some(count) })
            }
            _ => None,
        },
        [item, called] => scalar(item).map(|item| Property { name: name(called), item, list: None }),
        _ => None,
    };
    found.ok_or("`property`, a type such as float, and a name; or `property list`, two types and a name")
}

fn scalar(word: &[u8]) -> Option<ScalarType> {
    Some(match word {
        b"char" | b"int8" => ScalarType::I8,
        b"uchar" | b"uint8" => ScalarType::U8,
        b"short" | b"int16" => ScalarType::I16,
        b"ushort" | b"uint16" => ScalarType::U16,
        b"int" | b"int32" => ScalarType::I32,
        b"uint" | b"uint32" => ScalarType::U32,
        b"float" | b"float32" => ScalarType::F32,
        b"double" | b"float64" => ScalarType::F64,
        _ => return None,
    })
}

impl Header {
    /// The minimum size of the records in bytes: with empty lists and, in text, one digit and one separator per
    /// number. The last number needs no separator.
    pub fn least_size(&self) -> u128 {
        let size = |scalar: ScalarType| match self.format {
            PlyFormat::Ascii => 2,
            PlyFormat::LittleEndian | PlyFormat::BigEndian => scalar.size() as u128,
        };
        let record = |element: &Element| -> u128 {
            element.properties.iter().map(|property| size(property.list.unwrap_or(property.item))).sum()
        };
        let all =
            self.elements.iter().map(|element| u128::from(element.count) * record(element)).sum::<u128>();
        if self.format == PlyFormat::Ascii { all.saturating_sub(1) } else { all }
    }
}

impl ScalarType {
    /// The size of a binary number in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

impl Element {
    /// The error of an element that lacks the properties `needed`.
    pub fn lacks(&self, needed: &str) -> MeshError {
        let has: Vec<_> = self.properties.iter().map(|property| quoted(property.name.as_bytes())).collect();
        MeshError::new(format!("its {} lacks {needed}; it has {}", self.name, has.join(", ")))
    }

    /// Adds the number of the record to an error that has no place.
    pub fn in_record(&self, error: MeshError, index: u64) -> MeshError {
        match error.place {
            Some(_) => error,
            None => MeshError::new(format!("{} in {} {index} of {}", error.why, self.name, self.count)),
        }
    }
}
