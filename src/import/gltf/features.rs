//! What the reader follows, and the names of what it leaves out.

use super::GltfResult;
use super::json::Item;
use crate::base::escape;
use crate::base::lists::{listed, shortened};
use crate::base::units::counted;
use crate::geometry::mesh::MeshError;
use std::collections::BTreeMap;

/// The extensions that the reader follows.
const FOLLOWED: [&str; 14] = [
    "EXT_mesh_gpu_instancing",
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
    // Other data for the same picture: the usual data is there as well.
    "KHR_materials_variants",
    "KHR_xmp_json_ld",
];

/// Checks the version of the file, and that the reader has every extension that it needs.
pub fn check(root: &Item<'_>) -> GltfResult<()> {
    let asset = root.required("asset")?;
    let version = asset.text("version")?.ok_or_else(|| asset.error("it has no `version`"))?;
    // Files of a later minor version can be read as 2.0, unless they say which version they need.
    let (least, is_read) = match asset.text("minVersion")? {
        Some(least) => (least, least == "2.0"),
        None => (version, version.split('.').next() == Some("2")),
    };
    if !is_read {
        let version = shortened(least);
        return Err(asset.error(format!("it is of version {version:?} of glTF; Kinora reads version 2.0")));
    }
    let unknown = |name: &&str| !FOLLOWED.contains(name) && !is_of_materials(name);
    let needed: Vec<_> = root.texts("extensionsRequired")?.into_iter().filter(unknown).collect();
    if needed.is_empty() {
        return Ok(());
    }
    let names = listed(needed);
    Err(MeshError::new(format!("it needs {names}, which Kinora does not read; export it without")))
}

/// A name of the file for messages.
fn cleaned(name: &str) -> String {
    escape::line(&shortened(name)).into_owned()
}

/// Extensions of materials change how a surface looks, not how the file is read. So they may be left out.
fn is_of_materials(name: &str) -> bool {
    name.starts_with("KHR_materials_")
}

/// Features that the reader leaves out, each with the number of its users.
#[derive(Default)]
pub struct LeftOut {
    counts: BTreeMap<(String, &'static str), u64>,
    extensions: Vec<String>,
}

impl LeftOut {
    /// Notes one more user of a feature: "points" of a "primitive".
    pub fn note(&mut self, what: impl Into<String>, user: &'static str) {
        *self.counts.entry((what.into(), user)).or_default() += 1;
    }

    /// Notes the extensions that the file uses and the reader does not know. Those of materials are noted with their
    /// users.
    pub fn note_extensions(&mut self, root: &Item<'_>) -> GltfResult<()> {
        let used = root.texts("extensionsUsed")?.into_iter();
        let unknown = used.filter(|name| !FOLLOWED.contains(name) && !is_of_materials(name));
        self.extensions = unknown.map(cleaned).collect();
        Ok(())
    }

    /// Notes the extensions of a material that are not followed.
    pub fn note_material(&mut self, material: &Item<'_>) -> GltfResult<()> {
        let extensions = material.object("extensions")?;
        let names = extensions.iter().flat_map(Item::members);
        for name in names.filter(|name| !FOLLOWED.contains(name)) {
            self.note(cleaned(name), "material");
        }
        Ok(())
    }

    /// All notes, such as "transmission textures of 3 materials".
    pub fn listed(self) -> Vec<String> {
        let counts = self.counts.into_iter();
        let counted = counts.map(|((what, user), count)| format!("{what} of {}", counted(count, user)));
        counted.chain(self.extensions).collect()
    }
}
