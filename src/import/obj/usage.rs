//! The materials of an OBJ file, and the material of each triangle.

use crate::base::files;
use crate::geometry::mesh::{MeshError, MeshLocation, MtlMaterial, NO_MATERIAL};
use crate::import::lines::{quoted, unexpected};
use crate::import::mtl;
use std::collections::HashMap;
use std::io::{self, ErrorKind};

/// Returns the bytes of a material library, given its name in the OBJ file.
pub type OpenLibrary<'a> = dyn Fn(&str) -> io::Result<Vec<u8>> + 'a;

/// The materials in use, and their slots.
#[derive(Default)]
pub struct MaterialUsage {
    /// The materials of the libraries read so far, by name; `None` before the first library.
    known: Option<HashMap<String, MtlMaterial>>,
    /// The error of the first missing library. It matters only to callers that need the materials.
    missing: Option<MeshError>,
    /// The names in use, in the order of their slots, with the lines of their first use.
    used: Vec<(String, u64)>,
    slots: HashMap<String, u16>,
    current: Option<u16>,
    /// The slot of each triangle; empty until a material is in use.
    triangles: Vec<u16>,
    count: usize,
}

impl MaterialUsage {
    /// Reads `usemtl name`.
    pub fn use_material(&mut self, number: u64, line: &[u8], rest: &[u8]) -> Result<(), MeshError> {
        if rest.is_empty() {
            return Err(unexpected(number, line, "a name after `usemtl`"));
        }
        let name = String::from_utf8_lossy(rest).into_owned();
        if let Some(&slot) = self.slots.get(&name) {
            self.current = Some(slot);
            return Ok(());
        }
        let slot = self.used.len() as u16;
        if self.used.len() >= usize::from(NO_MATERIAL) {
            let why = format!("more than {NO_MATERIAL} materials are in use");
            return Err(MeshError::at(MeshLocation::Line(number), why));
        }
        self.slots.insert(name.clone(), slot);
        self.used.push((name, number));
        self.current = Some(slot);
        Ok(())
    }

    /// Assigns the current material to the next `count` triangles.
    pub fn assign(&mut self, count: usize) {
        let slot = self.current.unwrap_or(NO_MATERIAL);
        if slot != NO_MATERIAL || !self.triangles.is_empty() {
            self.triangles.resize(self.count, NO_MATERIAL);
            self.triangles.resize(self.count + count, slot);
        }
        self.count += count;
    }

    /// Reads `mtllib file`, or several files. Names may contain blanks, so the whole line is tried as one name first.
    pub fn read_libraries(
        &mut self,
        number: u64,
        line: &[u8],
        rest: &[u8],
        open: &OpenLibrary<'_>,
    ) -> Result<(), MeshError> {
        if rest.is_empty() {
            return Err(unexpected(number, line, "the name of a file after `mtllib`"));
        }
        let whole = String::from_utf8_lossy(rest).replace('\\', "/");
        if self.open(&whole, number, open)? {
            return Ok(());
        }
        let names: Vec<_> = whole.split_ascii_whitespace().collect();
        for name in &names {
            if names.len() == 1 || !self.open(name, number, open)? {
                let why = format!("there is no file {} for the materials", quoted(name.as_bytes()));
                self.missing.get_or_insert_with(|| MeshError::at(MeshLocation::Line(number), why));
            }
        }
        Ok(())
    }

    /// Reads a library; false if the file does not exist.
    fn open(&mut self, name: &str, number: u64, open: &OpenLibrary<'_>) -> Result<bool, MeshError> {
        let bytes = match open(name) {
            Ok(bytes) => bytes,
            // Several names may be too long for one name.
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::InvalidFilename) => {
                return Ok(false);
            }
            Err(error) => {
                let why = format!("{} cannot be read: {}", quoted(name.as_bytes()), files::describe(&error));
                return Err(MeshError::at(MeshLocation::Line(number), why));
            }
        };
        let materials = mtl::read(&bytes[..]).map_err(|error| error.in_file(name))?;
        let known = self.known.get_or_insert_default();
        for material in materials {
            // The first of several materials with the same name counts.
            known.entry(material.name.clone()).or_insert(material);
        }
        Ok(true)
    }

    /// The slot of each triangle, and the materials of the slots. Without a library, materials have only names.
    pub fn resolved(self) -> Result<(Vec<u16>, Vec<MtlMaterial>), MeshError> {
        let Self { known, mut used, triangles, missing, .. } = self;
        let any = known.is_some() && missing.is_none();
        let (mut known, missing) = (known.unwrap_or_default(), missing.map(|error| error.to_string()));
        if missing.is_some() && used.is_empty() {
            used.push((String::new(), 0));
        }
        // Every name has one slot.
        let material = |(name, line): (String, u64)| match known.remove(&name) {
            Some(material) => Ok(MtlMaterial { missing: missing.clone(), ..material }),
            None if any => {
                let why = format!("no material library defines {}", quoted(name.as_bytes()));
                Err(MeshError::at(MeshLocation::Line(line), why))
            }
            None => Ok(MtlMaterial { name, missing: missing.clone(), ..MtlMaterial::default() }),
        };
        let materials: Result<Vec<_>, _> = used.into_iter().map(material).collect();
        Ok((triangles, materials?))
    }
}
