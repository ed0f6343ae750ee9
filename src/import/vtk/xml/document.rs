//! The elements of an XML file.

use super::fault;
use crate::geometry::mesh::MeshError;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::ops::Range;

/// A file, with the places of its arrays.
pub struct Document<'b> {
    pub bytes: &'b [u8],
    pub big_endian: bool,
    /// The size of the numbers in headers of binary arrays: 4 or 8 bytes.
    pub header_size: usize,
    pub compressor: Compressor,
    pub pieces: Vec<Piece>,
    /// The appended bytes, and whether they are base64.
    pub appended: Option<(Range<usize>, bool)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compressor {
    None,
    Zlib,
    Lz4,
}

/// A part of the data set.
pub struct Piece {
    pub at: usize,
    /// Attributes such as `NumberOfPoints`.
    pub counts: Vec<(String, u64)>,
    pub arrays: Vec<Array>,
}

/// An array of numbers in the file.
pub struct Array {
    /// The place of its element.
    pub at: usize,
    /// The element around it, such as `PointData`.
    pub group: String,
    pub name: String,
    pub kind: String,
    pub components: u64,
    pub place: Place,
    /// Whether it is the active normals of its group.
    pub normals: bool,
}

/// The place and the encoding of an array's numbers.
pub enum Place {
    Text(Range<usize>),
    Base64(Range<usize>),
    Appended(u64),
}

impl<'b> Document<'b> {
    pub fn read(bytes: &'b [u8]) -> Result<Self, MeshError> {
        let document = Self {
            bytes,
            big_endian: false,
            header_size: 4,
            compressor: Compressor::None,
            pieces: Vec::new(),
            appended: None,
        };
        let mut parser = Parser { document, groups: Vec::new(), normals: None, open: false };
        let mut reader = Reader::from_reader(bytes);
        loop {
            let at = reader.buffer_position() as usize;
            let event = reader.read_event().map_err(|error| {
                fault(bytes, reader.error_position() as usize, format!("it is no valid XML: {error}"))
            })?;
            let end = reader.buffer_position() as usize;
            match event {
                Event::Start(element) if element.name().as_ref() == "AppendedData" => {
                    parser.appended(&element, at, end)?;
                    return Ok(parser.document);
                }
                Event::Start(element) => parser.start(&element, at, end)?,
                Event::Empty(element) => {
                    parser.start(&element, at, end)?;
                    parser.end();
                }
                Event::End(_) => parser.end(),
                Event::Text(_) => parser.text(at..end),
                Event::Eof if parser.groups.is_empty() && !parser.document.pieces.is_empty() => {
                    return Ok(parser.document);
                }
                Event::Eof => return Err(fault(bytes, bytes.len(), parser.ended())),
                _ => {}
            }
        }
    }

    pub fn fault(&self, at: usize, why: impl Into<String>) -> MeshError {
        fault(self.bytes, at, why)
    }
}

impl Piece {
    pub fn count(&self, name: &str) -> Option<u64> {
        self.counts.iter().find(|(known, _)| known == name).map(|(_, count)| *count)
    }

    /// Whether the piece states that it has no points and no cells. Parallel programs write such pieces.
    pub fn is_empty(&self) -> bool {
        self.count("NumberOfPoints") == Some(0) && self.counts.iter().all(|(_, count)| *count == 0)
    }
}

struct Parser<'b> {
    document: Document<'b>,
    /// The elements around the current place.
    groups: Vec<String>,
    /// The name of the active normals of the current group.
    normals: Option<String>,
    /// Whether the text of the current array is expected.
    open: bool,
}

impl Parser<'_> {
    fn start(&mut self, element: &BytesStart<'_>, at: usize, end: usize) -> Result<(), MeshError> {
        let name = element.name().as_ref().to_owned();
        let attributes = self.attributes(element, at)?;
        let value =
            |name: &str| attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str());
        match name.as_str() {
            _ if self.groups.is_empty() && name != "VTKFile" => {
                let why = format!("expected the element `VTKFile`, found `{name}`");
                return Err(self.document.fault(at, why));
            }
            "VTKFile" => self.header(at, value)?,
            "Piece" => {
                let counts = self.counts(&attributes, at)?;
                self.document.pieces.push(Piece { at, counts, arrays: Vec::new() });
            }
            "PointData" | "CellData" => self.normals = value("Normals").map(str::to_owned),
            "DataArray" => self.array(at, end, value)?,
            _ => {}
        }
        self.groups.push(name);
        Ok(())
    }

    fn attributes(&self, element: &BytesStart<'_>, at: usize) -> Result<Vec<(String, String)>, MeshError> {
        let attributes = element.attributes().map(|attribute| {
            let attribute =
                attribute.map_err(|error| self.document.fault(at, format!("it is no valid XML: {error}")))?;
            let value = match quick_xml::escape::unescape(&attribute.value) {
                Ok(value) => value.into_owned(),
                Err(_) => attribute.value.clone().into_owned(),
            };
            Ok((attribute.key.as_ref().to_owned(), value))
        });
        attributes.collect()
    }

    /// The attributes of a piece that count.
    fn counts(&self, attributes: &[(String, String)], at: usize) -> Result<Vec<(String, u64)>, MeshError> {
        let counts = attributes.iter().filter(|(name, _)| name.starts_with("NumberOf"));
        let parsed = counts.map(|(name, value)| match value.trim().parse() {
            Ok(count) => Ok((name.clone(), count)),
            Err(_) => Err(self.document.fault(at, format!("expected a count in `{name}`, found `{value}`"))),
        });
        parsed.collect()
    }

    fn header<'v>(&mut self, at: usize, value: impl Fn(&str) -> Option<&'v str>) -> Result<(), MeshError> {
        let bytes = self.document.bytes;
        let fault = |what: &str, found: Option<&str>| {
            Err(fault(bytes, at, format!("expected {what}, found `{}`", found.unwrap_or_default())))
        };
        match value("type") {
            Some("PolyData" | "UnstructuredGrid") => {}
            found => return fault("`type=\"PolyData\"` or `\"UnstructuredGrid\"`", found),
        }
        self.document.big_endian = match value("byte_order") {
            None | Some("LittleEndian") => false,
            Some("BigEndian") => true,
            found => return fault("`byte_order=\"LittleEndian\"` or `\"BigEndian\"`", found),
        };
        self.document.header_size = match value("header_type") {
            None | Some("UInt32") => 4,
            Some("UInt64") => 8,
            found => return fault("`header_type=\"UInt32\"` or `\"UInt64\"`", found),
        };
        self.document.compressor = match value("compressor") {
            None | Some("") => Compressor::None,
            Some("vtkZLibDataCompressor") => Compressor::Zlib,
            Some("vtkLZ4DataCompressor") => Compressor::Lz4,
            found => return fault("the compressor `vtkZLibDataCompressor` or `vtkLZ4DataCompressor`", found),
        };
        Ok(())
    }

    fn array<'v>(
        &mut self,
        at: usize,
        end: usize,
        value: impl Fn(&str) -> Option<&'v str>,
    ) -> Result<(), MeshError> {
        let place = match value("format") {
            None | Some("ascii") => Place::Text(end..end),
            Some("binary") => Place::Base64(end..end),
            Some("appended") => match value("offset").map(str::parse) {
                Some(Ok(offset)) => Place::Appended(offset),
                _ => return Err(self.document.fault(at, "expected an `offset` of the appended array")),
            },
            Some(format) => {
                let why = format!("expected the format `ascii`, `binary` or `appended`, found `{format}`");
                return Err(self.document.fault(at, why));
            }
        };
        let components = match value("NumberOfComponents").map(str::parse) {
            None => 1,
            Some(Ok(components)) if components > 0 => components,
            _ => return Err(self.document.fault(at, "expected `NumberOfComponents` of 1 or more")),
        };
        let name = value("Name").unwrap_or_default().to_owned();
        let group = self.groups.last().cloned().unwrap_or_default();
        let normals = group == "PointData" && self.normals.as_ref() == Some(&name);
        let kind = value("type").unwrap_or_default().to_owned();
        // Arrays outside of pieces belong to the whole file.
        if let Some(piece) =
            self.document.pieces.last_mut().filter(|_| self.groups.iter().any(|group| group == "Piece"))
        {
            piece.arrays.push(Array { at, group, name, kind, components, place, normals });
            self.open = true;
        }
        Ok(())
    }

    /// Ends the innermost element.
    fn end(&mut self) {
        self.open &= self.groups.pop().is_none_or(|group| group != "DataArray");
    }

    /// Takes the place of an array's text. Other elements may stand before or after it.
    fn text(&mut self, place: Range<usize>) {
        let blank = self.document.bytes[place.clone()].trim_ascii().is_empty();
        if blank || !self.open || self.groups.last().is_none_or(|group| group != "DataArray") {
            return;
        }
        let array = self.document.pieces.last_mut().and_then(|piece| piece.arrays.last_mut());
        if let Some(Array { place: Place::Text(text) | Place::Base64(text), .. }) = array {
            *text = place;
            self.open = false;
        }
    }

    /// The appended data begins after an underscore, and may be any bytes.
    fn appended(&mut self, element: &BytesStart<'_>, at: usize, end: usize) -> Result<(), MeshError> {
        let attributes = self.attributes(element, at)?;
        let encoding =
            attributes.iter().find(|(name, _)| name == "encoding").map(|(_, value)| value.as_str());
        let base64 = match encoding {
            Some("base64") => true,
            Some("raw") => false,
            _ => return Err(self.document.fault(at, "expected `encoding=\"raw\"` or `\"base64\"`")),
        };
        let bytes = self.document.bytes;
        let blanks = bytes[end..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        if bytes.get(end + blanks) != Some(&b'_') {
            return Err(self.document.fault(end, "expected `_` before the appended data"));
        }
        self.document.appended = Some((end + blanks + 1..bytes.len(), base64));
        Ok(())
    }

    /// Why the end of the file comes too early.
    fn ended(&self) -> String {
        match self.groups.last() {
            Some(group) => format!("the file ends in the element `{group}`"),
            None => "it has no `Piece`".to_owned(),
        }
    }
}
