//! What annotations may refer to.

use crate::appearance::material::MaterialTracks;
use crate::appearance::texture::DataTexture;
use crate::base::time::Timeline;
use crate::sequence::fault::Fault;
use crate::sequence::names::Names;
use crate::sequence::node::Node;
use crate::sequence::placement::shown_by;
use crate::sequence::{Named, Object};

/// Objects and materials.
type SceneParts<'a> = (&'a [Named<Object>], &'a [Named<MaterialTracks>]);

/// The scene whose parts annotations name. None if it could not be read; then names are not checked.
pub struct SceneNames<'a> {
    parts: Option<SceneParts<'a>>,
    objects: Names<'a>,
    materials: Names<'a>,
    pub timeline: Option<Timeline>,
}

impl<'a> SceneNames<'a> {
    pub fn new(parts: Option<SceneParts<'a>>, timeline: Option<Timeline>) -> Self {
        let (objects, materials) = parts.unwrap_or_default();
        Self {
            parts,
            objects: Names::of("object", objects.iter().map(|object| object.name.as_str())),
            materials: Names::of("material", materials.iter().map(|material| material.name.as_str())),
            timeline,
        }
    }

    /// The index of the object with the quoted name; of a node whose mesh joints place, that of its mesh.
    pub fn object(&self, node: Node<'_>) -> Option<usize> {
        let (objects, _) = self.parts?;
        self.objects.index(node).map(|index| shown_by(objects, index))
    }

    pub fn object_at(&self, index: usize) -> Option<&'a Object> {
        self.parts.and_then(|(objects, _)| objects.get(index)).map(|object| &object.value)
    }

    /// The texture that shows numbers of the material with the quoted name.
    pub fn data_of_material(&self, node: Node<'_>) -> Option<DataTexture> {
        let (_, materials) = self.parts?;
        let index = self.materials.index(node)?;
        data_in(node, [&materials[index].value])
    }

    /// The texture that shows numbers of the object with the quoted name.
    pub fn data_of_object(&self, node: Node<'_>) -> Option<DataTexture> {
        let (objects, materials) = self.parts?;
        let made_of = objects[self.objects.index(node)?].value.made_of;
        data_in(node, made_of.indices().filter_map(|index| Some(&materials.get(index as usize)?.value)))
    }
}

/// The first texture of materials that shows numbers.
fn data_in<'m>(
    node: Node<'_>,
    materials: impl IntoIterator<Item = &'m MaterialTracks>,
) -> Option<DataTexture> {
    let mut found = None;
    for material in materials {
        material.clone().each_data(&mut |texture| {
            found.get_or_insert_with(|| texture.clone());
        });
    }
    if found.is_none() {
        let fault = Fault::new(node.span(), "a colour bar explains numbers", "this shows none");
        node.fault(fault.help("its material needs a colour such as Scalar(\"pressure\")"));
    }
    found
}
