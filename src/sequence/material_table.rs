//! The materials of a sequence: those with names, then those of objects, meshes and scenes.

use super::Named;
use super::material_description::{MaterialDescription, MeshMaterials};
use super::object::MaterialSource;
use crate::appearance::material::{MaterialBinding, MaterialTracks};
use std::collections::HashMap;
use std::rc::Rc;

/// The materials so far.
pub struct MaterialTable<'a> {
    default: &'a MaterialDescription,
    materials: Vec<Named<MaterialTracks>>,
    /// The index of the default material, if it is in use.
    default_index: Option<u32>,
    /// The materials of each list, by its address. The file keeps all lists, so addresses are unique.
    lists: HashMap<*const (String, MaterialDescription), MaterialBinding>,
}

impl<'a> MaterialTable<'a> {
    /// The materials with names. `default` gives the fields that others leave out.
    pub fn new(default: &'a MaterialDescription, named: &[Named<MaterialDescription>]) -> Self {
        let resolved = named.iter().map(|m| Named { name: m.name.clone(), value: m.value.over(default) });
        Self { default, materials: resolved.collect(), default_index: None, lists: HashMap::new() }
    }

    fn append(&mut self, name: String, given: &MaterialDescription) -> u32 {
        self.materials.push(Named { name, value: given.over(self.default) });
        self.materials.len() as u32 - 1
    }

    /// The binding of the material of the object called `name`. Appends inline materials, those of a mesh or a scene at
    /// its first object, and the default material if it is used.
    pub fn bind(&mut self, source: MaterialSource, name: &str) -> MaterialBinding {
        match source {
            MaterialSource::Named(index) => MaterialBinding::One(index as u32),
            MaterialSource::Inline(given) => {
                MaterialBinding::One(self.append(format!("objects.{name:?}.material"), &given))
            }
            MaterialSource::Mesh(given) => self.list(&given, name),
            MaterialSource::Default => MaterialBinding::One(match self.default_index {
                Some(index) => index,
                None => {
                    let index = self.append("default_material".to_owned(), &MaterialDescription::default());
                    *self.default_index.insert(index)
                }
            }),
        }
    }

    /// Whether each of these materials may refract light.
    pub fn refract(&self, indices: [u32; 2]) -> bool {
        indices.iter().all(|index| {
            let material = &self.materials[*index as usize].value;
            material.refraction.strength.values().any(|strength| *strength != 0.0)
        })
    }

    fn list(&mut self, given: &MeshMaterials, name: &str) -> MaterialBinding {
        let address = Rc::as_ptr(given).cast();
        if let Some(known) = self.lists.get(&address) {
            return *known;
        }
        let first = self.materials.len() as u32;
        for (slot, given) in given.iter() {
            self.append(format!("objects.{name:?}.shape.materials.{slot:?}"), given);
        }
        let count = given.len() as u32 - 1;
        self.lists.insert(address, MaterialBinding::Slots { first, count });
        MaterialBinding::Slots { first, count }
    }

    pub fn finish(self) -> Vec<Named<MaterialTracks>> {
        self.materials
    }
}
