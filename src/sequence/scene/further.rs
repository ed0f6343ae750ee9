//! Objects besides those of the nodes: skinned meshes and instances.

use super::UniqueNames;
use super::animation::Channels;
use super::nodes::{NodeMaterial, SceneNode};
use crate::geometry::shape::Shape;
use crate::geometry::transform::{Rotation, TransformTracks};
use crate::import::gltf::GltfScene;
use crate::sequence::deformations::DeformationDraft;
use crate::track::Animated;
use std::rc::Rc;
use std::sync::Arc;

/// Deforms the meshes of nodes by morph targets and skins. A skinned mesh becomes an object of its own below that of the
/// scene, because only its joints place it; it is visible with its node. `first` is the index of the first node's object.
pub fn add_deformations(
    scene: &GltfScene,
    channels: &Channels<'_>,
    (first, objects): (usize, &mut Vec<SceneNode>),
    names: &mut UniqueNames,
) {
    for (index, node) in (first..).zip(&scene.nodes) {
        let Some(mesh) = node.mesh.and_then(|mesh| scene.meshes[mesh].as_ref()) else { continue };
        let Some(deformer) = &mesh.deformer else { continue };
        let given = if node.weights.is_empty() { &mesh.weights } else { &node.weights };
        let weight = |number: usize| given.get(number).copied().unwrap_or(0.0).into();
        let mut weights: Vec<Animated<f64>> = (0..deformer.targets()).map(weight).collect();
        channels.animate_weights(node.index, &mut weights);
        let skin = node.skin.filter(|_| mesh.joints > 0).and_then(|skin| scene.skins[skin].as_ref());
        let joints = skin.map_or_else(|| Arc::from([]), |skin| Arc::clone(&skin.joints));
        if joints.is_empty() && weights.iter().all(|weight| *weight == Animated::Constant(0.0)) {
            if mesh.is_flat {
                objects[index].shape = Shape::Group;
            }
            continue;
        }
        let deformation = Some(Rc::new(DeformationDraft { deformer: Arc::clone(deformer), weights, joints }));
        if skin.is_none() {
            objects[index].deformation = deformation;
            continue;
        }
        let own = &mut objects[index];
        let shape = std::mem::replace(&mut own.shape, Shape::Group);
        let name = names.take(format!("{}/skin", own.name));
        let (material, transform) = (NodeMaterial::Of(index), TransformTracks::default());
        let (parent, visible, skin_of) = ((first > 0).then_some(0), true.into(), Some(index));
        objects.push(SceneNode { name, parent, shape, material, transform, visible, deformation, skin_of });
    }
}

/// Adds the instances of nodes: objects below that of the node, which shows nothing then. `first` is the index of the
/// first node's object.
pub fn add_instances(scene: &GltfScene, first: usize, objects: &mut Vec<SceneNode>, names: &mut UniqueNames) {
    for (index, node) in (first..).zip(&scene.nodes) {
        let Some(instances) = &node.instances else { continue };
        let shape = std::mem::replace(&mut objects[index].shape, Shape::Group);
        let deformation = objects[index].deformation.take();
        let name = objects[index].name.clone();
        objects.extend(instances.iter().enumerate().map(|(number, instance)| SceneNode {
            name: names.take(format!("{name}[{number}]")),
            parent: Some(index),
            shape: shape.clone(),
            material: NodeMaterial::Of(index),
            transform: TransformTracks {
                translation: instance.translation.into(),
                rotation: Rotation::Quaternion(instance.rotation.into()),
                scale: instance.scale.into(),
                ..TransformTracks::default()
            },
            visible: true.into(),
            deformation: deformation.clone(),
            skin_of: None,
        }));
    }
}
