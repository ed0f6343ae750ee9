//! Which material is on which triangle of an OBJ file.

use super::Open;
use crate::base::files;
use crate::geometry::mesh::{MeshError, MtlMaterial, NO_MATERIAL, Place};
use crate::import::lines::{quoted, unlike};
use crate::import::mtl;
use std::collections::HashMap;
use std::io::ErrorKind;

/// Materials by name and their slots.
#[derive(Default)]
pub struct Usage {
    /// The materials of the libraries read so far, by name; none if no library is named.
    known: Option<HashMap<String, MtlMaterial>>,
    /// The fault of the first library that is not there. It is one only for those who want the materials.
    missing: Option<MeshError>,
    /// The names in use in the order of their slots, with the lines that name them first.
    used: Vec<(String, u64)>,
    slots: HashMap<String, u16>,
    current: Option<u16>,
    /// A slot per triangle; empty until a material is in use.
    triangles: Vec<u16>,
    count: usize,
}

impl Usage {
    /// `usemtl name`
    pub fn choose(&mut self, number: u64, line: &[u8], rest: &[u8]) -> Result<(), MeshError> {
        if rest.is_empty() {
            return Err(unlike(number, line, "a name behind `usemtl`"));
        }
        let name = String::from_utf8_lossy(rest).into_owned();
        if let Some(&slot) = self.slots.get(&name) {
            self.current = Some(slot);
            return Ok(());
        }
        let slot = self.used.len() as u16;
        if self.used.len() >= usize::from(NO_MATERIAL) {
            let why = format!("more than {NO_MATERIAL} materials are in use");
            return Err(MeshError::at(Place::Line(number), why));
        }
        self.slots.insert(name.clone(), slot);
        self.used.push((name, number));
        self.current = Some(slot);
        Ok(())
    }

    /// The next `count` triangles have the current material.
    pub fn mark(&mut self, count: usize) {
        let slot = self.current.unwrap_or(NO_MATERIAL);
        if slot != NO_MATERIAL || !self.triangles.is_empty() {
            self.triangles.resize(self.count, NO_MATERIAL);
            self.triangles.resize(self.count + count, slot);
        }
        self.count += count;
    }

    /// `mtllib file`, or several files. Names may contain blanks, so the whole line is tried first.
    pub fn library(
        &mut self,
        number: u64,
        line: &[u8],
        rest: &[u8],
        open: &Open<'_>,
    ) -> Result<(), MeshError> {
        if rest.is_empty() {
            return Err(unlike(number, line, "the name of a file behind `mtllib`"));
        }
        let whole = String::from_utf8_lossy(rest).replace('\\', "/");
        if self.open(&whole, number, open)? {
            return Ok(());
        }
        let names: Vec<_> = whole.split_ascii_whitespace().collect();
        for name in &names {
            if names.len() == 1 || !self.open(name, number, open)? {
                let why = format!("there is no file {} for the materials", quoted(name.as_bytes()));
                self.missing.get_or_insert_with(|| MeshError::at(Place::Line(number), why));
            }
        }
        Ok(())
    }

    /// Reads a library; false if there is no such file.
    fn open(&mut self, name: &str, number: u64, open: &Open<'_>) -> Result<bool, MeshError> {
        let bytes = match open(name) {
            Ok(bytes) => bytes,
            // Several names in a row may be too long for one.
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::InvalidFilename) => {
                return Ok(false);
            }
            Err(error) => {
                let why = format!("{} cannot be read: {}", quoted(name.as_bytes()), files::why(&error));
                return Err(MeshError::at(Place::Line(number), why));
            }
        };
        let materials = mtl::read(&bytes[..]).map_err(|error| error.in_file(name))?;
        let known = self.known.get_or_insert_default();
        for material in materials {
            // Of materials with one name, the first counts.
            known.entry(material.name.clone()).or_insert(material);
        }
        Ok(true)
    }

    /// A slot per triangle, and the materials in the slots. Without a library, materials have only names.
    pub fn resolved(self) -> Result<(Vec<u16>, Vec<MtlMaterial>), MeshError> {
        let Self { known, mut used, triangles, missing, .. } = self;
        let any = known.is_some() && missing.is_none();
        let (mut known, missing) = (known.unwrap_or_default(), missing.map(|error| error.to_string()));
        if missing.is_some() && used.is_empty() {
            used.push((String::new(), 0));
        }
        // Every name is in use once.
        let material = |(name, line): (String, u64)| match known.remove(&name) {
            Some(material) => Ok(MtlMaterial { missing: missing.clone(), ..material }),
            None if any => {
                let why = format!("no material library has {}", quoted(name.as_bytes()));
                Err(MeshError::at(Place::Line(line), why))
            }
            None => Ok(MtlMaterial { name, missing: missing.clone(), ..MtlMaterial::default() }),
        };
        let materials: Result<Vec<_>, _> = used.into_iter().map(material).collect();
        Ok((triangles, materials?))
    }
}
