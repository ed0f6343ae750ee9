//! Objects whose meshes morph targets and joints deform.

use super::carriers::{carrier_within, chain};
use super::fault::Fault;
use super::node::File;
use super::suggest::shortened;
use super::{Named, Object, ShapeTracks};
use crate::base::math::DAffine3;
use crate::base::time::Time;
use crate::geometry::deformation::DeformedMesh;
use crate::geometry::mesh::deform::Deformer;
use crate::geometry::shape::{Mesh, Shape};
use crate::track::Animated;
use std::ops::Range;
use std::sync::Arc;

/// What deforms the mesh of an object, before the object has an index.
#[derive(Clone)]
pub struct DeformationDraft {
    pub deformer: Arc<Deformer>,
    /// One for each morph target.
    pub weights: Vec<Animated<f64>>,
    /// Joints as indices of nodes of a scene, each with the map from the mesh at rest into its node.
    pub joints: Vec<(usize, DAffine3)>,
}

/// The deformations of the nodes of one scene.
pub struct SceneDeformations {
    /// Each with the index of its object.
    pub drafts: Vec<(usize, DeformationDraft)>,
    /// The index of the object of the first node.
    pub first: usize,
    /// The object in whose space skinned meshes are.
    pub base: usize,
    /// The place of the scene in the file.
    pub place: Range<usize>,
}

/// Deforms the meshes of objects. Reports meshes that vanish at the start.
pub fn deform(file: &File<'_>, objects: &mut [Named<Object>], scenes: Vec<SceneDeformations>) {
    for SceneDeformations { drafts, first, base, place } in scenes {
        for (index, DeformationDraft { deformer, weights, joints }) in drafts {
            let joints =
                joints.into_iter().map(|(joint, rest)| (carrier_within(objects, first + joint, base), rest));
            let joints = joints.collect();
            let object = &mut objects[index];
            let Shape::Mesh(Mesh { mesh, normals, .. }) = &object.value.shape else { continue };
            let mesh = DeformedMesh::new((Arc::clone(mesh), *normals), deformer, weights, joints);
            if let Err(why) = show(&mut object.value, mesh) {
                let title = format!("cannot show the mesh of `{}`", shortened(&object.name));
                file.push(Fault::new(place.clone(), title, why));
            }
        }
    }
}

/// Lets an object show a deformed mesh. A mesh that cannot change is deformed once; programs may still move joints.
fn show(object: &mut Object, mesh: DeformedMesh) -> Result<(), String> {
    let shape = mesh.loaded(Time::from_integer(0)).map_err(|error| error.to_string())?;
    let still = !mesh.is_keyed() && mesh.joints().is_empty();
    let shape = if still { Mesh { step: None, ..shape } } else { shape };
    object.shape = Shape::Mesh(shape);
    object.tracks = (!still).then(|| ShapeTracks::Deformed(Arc::new(mesh)));
    Ok(())
}

/// Updates the deformed meshes of which a joint is an object or below it.
pub fn refresh_joints(objects: &mut [Named<Object>], moved: usize) {
    for index in 0..objects.len() {
        let Some(ShapeTracks::Deformed(mesh)) = &objects[index].value.tracks else { continue };
        let is_moved = |joint: usize| chain(objects, joint).any(|above| above == moved);
        if !mesh.joints().iter().any(|(carrier, _)| is_moved(carrier.object)) {
            continue;
        }
        // Skinned meshes are directly below the object in whose space they are.
        let Some(base) = objects[index].value.parent else { continue };
        let joints = mesh
            .joints()
            .iter()
            .map(|(carrier, rest)| (carrier_within(objects, carrier.object, base), *rest));
        let mesh = mesh.with_joints(joints.collect());
        objects[index].value.tracks = Some(ShapeTracks::Deformed(Arc::new(mesh)));
    }
}
