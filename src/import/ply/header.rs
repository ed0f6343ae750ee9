//! The header of a PLY file: which elements there are, and what each consists of.

use crate::geometry::mesh::{MeshError, Place};
use crate::import::lines::{Lines, parsed, quoted, split_word, unlike, words};
use std::io::BufRead;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
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
    pub item: Scalar,
    /// The type of the count in front of a list; none for a single value.
    pub list: Option<Scalar>,
}

/// A kind of records, and how many of them there are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
}

impl Header {
    /// Reads the lines up to `end_header`.
    pub fn read(lines: &mut Lines<impl BufRead>) -> Result<Self, MeshError> {
        match lines.next()? {
            Some((_, b"ply")) => {}
            _ => return Err(MeshError::new("it is no PLY file: those begin with a line `ply`")),
        }
        let (mut encoding, mut elements) = (None, Vec::new());
        while let Some((number, line)) = lines.next()? {
            let (word, rest) = split_word(line);
            match word {
                b"end_header" => {
                    let why = "the header has no line `format`, such as `format ascii 1.0`";
                    let encoding = encoding.ok_or_else(|| MeshError::at(Place::Line(number), why))?;
                    return Ok(Self { encoding, elements });
                }
                b"comment" | b"obj_info" | b"" => {}
                b"format" => encoding = Some(format(rest).map_err(|what| unlike(number, line, what))?),
                b"element" => elements.push(element(rest).map_err(|what| unlike(number, line, what))?),
                b"property" => {
                    let property = property(rest).map_err(|what| unlike(number, line, what))?;
                    let Some(element): Option<&mut Element> = elements.last_mut() else {
                        return Err(unlike(number, line, "`element` before its properties"));
                    };
                    element.properties.push(property);
                }
                _ => return Err(unlike(number, line, "`element`, `property` or `end_header`")),
            }
        }
        Err(MeshError::new("the header has no end: a line `end_header`"))
    }
}

fn format(rest: &[u8]) -> Result<Encoding, &'static str> {
    match words(rest).next() {
        Some(b"ascii") => Ok(Encoding::Ascii),
        Some(b"binary_little_endian") => Ok(Encoding::LittleEndian),
        Some(b"binary_big_endian") => Ok(Encoding::BigEndian),
        _ => Err("`format ascii`, `format binary_little_endian` or `format binary_big_endian`"),
    }
}

fn element(rest: &[u8]) -> Result<Element, &'static str> {
    let mut words = words(rest);
    let name = words.next().map(|name| String::from_utf8_lossy(name).into_owned());
    match (name, words.next().and_then(parsed)) {
        (Some(name), Some(count)) => Ok(Element { name, count, properties: Vec::new() }),
        _ => Err("`element`, a name and a count"),
    }
}

fn property(rest: &[u8]) -> Result<Property, &'static str> {
    let words: Vec<_> = words(rest).collect();
    let name = |name: &[u8]| String::from_utf8_lossy(name).into_owned();
    let found = match words[..] {
        [b"list", count, item, called] => match (scalar(count), scalar(item)) {
            (Some(count), Some(item)) if count != Scalar::F32 && count != Scalar::F64 => {
                Some(Property { name: name(called), item, list: Some(count) })
            }
            _ => None,
        },
        [item, called] => scalar(item).map(|item| Property { name: name(called), item, list: None }),
        _ => None,
    };
    found.ok_or("`property`, a type such as float, and a name; or `property list`, two types and a name")
}

fn scalar(word: &[u8]) -> Option<Scalar> {
    Some(match word {
        b"char" | b"int8" => Scalar::I8,
        b"uchar" | b"uint8" => Scalar::U8,
        b"short" | b"int16" => Scalar::I16,
        b"ushort" | b"uint16" => Scalar::U16,
        b"int" | b"int32" => Scalar::I32,
        b"uint" | b"uint32" => Scalar::U32,
        b"float" | b"float32" => Scalar::F32,
        b"double" | b"float64" => Scalar::F64,
        _ => return None,
    })
}

impl Header {
    /// Bytes that the records take at least: empty lists and, in text, numbers of one digit with a blank behind
    /// each; the last one needs none.
    pub fn least_size(&self) -> u128 {
        let size = |scalar: Scalar| match self.encoding {
            Encoding::Ascii => 2,
            Encoding::LittleEndian | Encoding::BigEndian => scalar.size() as u128,
        };
        let record = |element: &Element| -> u128 {
            element.properties.iter().map(|property| size(property.list.unwrap_or(property.item))).sum()
        };
        let all =
            self.elements.iter().map(|element| u128::from(element.count) * record(element)).sum::<u128>();
        if self.encoding == Encoding::Ascii { all.saturating_sub(1) } else { all }
    }
}

impl Scalar {
    /// Bytes of a binary number.
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
    /// The fault of an element without one of the properties in `needed`.
    pub fn lacks(&self, needed: &str) -> MeshError {
        let has: Vec<_> = self.properties.iter().map(|property| quoted(property.name.as_bytes())).collect();
        MeshError::new(format!("its {} has no {needed}, but {}", self.name, has.join(", ")))
    }
}
