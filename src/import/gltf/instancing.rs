//! Instances of the extension `EXT_mesh_gpu_instancing`: one mesh at many places of its node.

use super::GltfResult;
use super::accessor::Accessor;
use super::buffers::Buffers;
use super::json::Item;
use crate::base::math::{DQuat, DVec3, unit_quaternion};

/// The extension.
pub const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// Where an instance is in its node, as [`GltfNode`](super::GltfNode) states it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GltfInstance {
    pub translation: DVec3,
    pub rotation: DQuat,
    pub scale: DVec3,
}

/// Reads the instances of a node that has the extension.
pub fn instances(root: &Item<'_>, item: &Item<'_>, buffers: &Buffers<'_>) -> GltfResult<Vec<GltfInstance>> {
    let attributes = item.required("attributes")?;
    let accessor = |name: &str| {
        let index = attributes.index(name, ("accessors", root.len_of("accessors")))?;
        index.map(|index| Accessor::new(root, buffers, index)).transpose()
    };
    let (translations, rotations, scales) =
        (accessor("TRANSLATION")?, accessor("ROTATION")?, accessor("SCALE")?);
    // Attributes that a program has made up say the number of instances as well.
    let counts: Vec<usize> = attributes
        .members()
        .map(|name| Ok(accessor(name)?.map_or(0, |accessor| accessor.count)))
        .collect::<GltfResult<_>>()?;
    let Some(&count) = counts.first() else { return Err(attributes.error("there are no attributes")) };
    if counts.iter().any(|other| *other != count) {
        return Err(attributes.error("its attributes differ in their number of instances"));
    }
    let vectors = |accessor: Option<Accessor<'_>>, otherwise: f64| match accessor {
        Some(accessor) => accessor.elements::<3>(),
        None => Ok(vec![[otherwise; 3]; count]),
    };
    let rotations = match rotations {
        Some(rotations) => rotations.elements::<4>()?,
        None => vec![[0.0, 0.0, 0.0, 1.0]; count],
    };
    let (translations, scales) = (vectors(translations, 0.0)?, vectors(scales, 1.0)?);
    let instance = |((translation, rotation), scale): (([f64; 3], [f64; 4]), [f64; 3])| {
        let rotation = unit_quaternion(rotation)
            .ok_or_else(|| attributes.error("a rotation is zero, which is no rotation"))?;
        let (translation, scale) = (DVec3::from_array(translation), DVec3::from_array(scale));
        Ok(GltfInstance { translation, rotation, scale })
    };
    translations.into_iter().zip(rotations).zip(scales).map(instance).collect()
}
