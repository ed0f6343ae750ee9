//! Objects whose meshes morph targets and joints deform.

use super::carriers::TreeBuilder;
use super::fault::Fault;
use super::source_file::File;
use super::suggest::shortened;
use super::{Named, Object, ShapeTracks};
use crate::base::math::DAffine3;
use crate::base::time::Time;
use crate::geometry::carrier::{LinkIndex, TransformTree};
use crate::geometry::deformation::{DeformedMesh, Joints};
use crate::geometry::mesh::deform::Deformer;
use crate::geometry::shape::{Mesh, Shape};
use crate::track::Animated;
use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

/// What deforms the mesh of an object, before the object has an index.
pub struct DeformationDraft {
    pub deformer: Arc<Deformer>,
    /// One for each morph target.
    pub weights: Vec<Animated<f64>>,
    /// Joints as indices of nodes of a scene, each with the map from the mesh at rest into its node.
    pub joints: Arc<[(usize, DAffine3)]>,
}

/// The deformations of the nodes of one scene.
pub struct SceneDeformations {
    /// Each with the index of its object.
    pub drafts: Vec<(usize, Rc<DeformationDraft>)>,
    /// The index of the object of the first node.
    pub first: usize,
    /// The object in whose space skinned meshes are.
    pub base: usize,
    /// The place of the scene in the file.
    pub place: Range<usize>,
}

/// What is the same for meshes that always look the same: addresses, or numbers that do not change.
#[derive(PartialEq, Eq, Hash)]
struct MeshKey {
    deformer: *const Deformer,
    joints: *const (usize, DAffine3),
    weights: WeightsKey,
}

#[derive(PartialEq, Eq, Hash)]
enum WeightsKey {
    Constant(Vec<u64>),
    Of(*const DeformationDraft),
}

impl MeshKey {
    fn of(draft: &Rc<DeformationDraft>) -> Self {
        let constant = draft.weights.iter().map(|weight| match weight {
            Animated::Constant(weight) => Some(weight.to_bits()),
            Animated::Keyed(_) => None,
        });
        let weights = constant.collect::<Option<_>>();
        Self {
            deformer: Arc::as_ptr(&draft.deformer),
            joints: draft.joints.first().map_or(std::ptr::null(), std::ptr::from_ref),
            weights: weights.map_or_else(|| WeightsKey::Of(Rc::as_ptr(draft)), WeightsKey::Constant),
        }
    }
}

/// Deforms the meshes of objects. Those that always look the same share one mesh.
pub fn deform(file: &File<'_>, objects: &mut [Named<Object>], scenes: Vec<SceneDeformations>) {
    for SceneDeformations { drafts, first, base, place } in scenes {
        let (tree, links) = joints(objects, &drafts, (first, base));
        let mut meshes: HashMap<MeshKey, Arc<DeformedMesh>> = HashMap::new();
        for (index, draft) in &drafts {
            let object = &mut objects[*index];
            let Shape::Mesh(Mesh { mesh, normals, .. }) = &object.value.shape else { continue };
            let new = || {
                let links = links.get(&Arc::as_ptr(&draft.joints)).cloned().unwrap_or_else(|| Arc::from([]));
                let joints = Joints { tree: Arc::clone(&tree), links };
                let (deformer, weights) = (Arc::clone(&draft.deformer), draft.weights.clone());
                Arc::new(DeformedMesh::new((Arc::clone(mesh), *normals), deformer, weights, joints))
            };
            let deformed = Arc::clone(meshes.entry(MeshKey::of(draft)).or_insert_with(new));
            show(file, object, deformed, &place);
        }
    }
}

/// The links of each list of joints, by the address of the list.
type LinksOfLists = HashMap<*const [(usize, DAffine3)], Arc<[(LinkIndex, DAffine3)]>>;

/// The tree of all joints, and their links in it. `first` is the index of the first node's object, and `base` the object
/// in whose space the meshes are.
fn joints(
    objects: &[Named<Object>],
    drafts: &[(usize, Rc<DeformationDraft>)],
    (first, base): (usize, usize),
) -> (Arc<TransformTree>, LinksOfLists) {
    let mut builder = TreeBuilder::within(objects, base);
    let mut links = LinksOfLists::new();
    for (_, draft) in drafts {
        links.entry(Arc::as_ptr(&draft.joints)).or_insert_with(|| {
            draft.joints.iter().map(|(joint, rest)| (builder.link(first + joint), *rest)).collect()
        });
    }
    (builder.finish(), links)
}

/// Lets an object show a deformed mesh. A mesh that cannot change is deformed once; programs may still move joints.
fn show(file: &File<'_>, object: &mut Named<Object>, mesh: Arc<DeformedMesh>, place: &Range<usize>) {
    let still = !mesh.is_keyed() && mesh.joints().links.is_empty();
    let shape = match mesh.loaded(Time::from_integer(0)) {
        Ok(shape) => shape,
        Err(why) => {
            let title = format!("cannot show the mesh of `{}`", shortened(&object.name));
            file.push(Fault::new(place.clone(), title, why.to_string()));
            return;
        }
    };
    if still {
        if shape.is_none() {
            let name = shortened(&object.name);
            file.warn(place.start, format!("the mesh of `{name}` is invisible: its weights leave no area"));
        }
        object.value.shape = shape.map_or(Shape::Group, |shape| Shape::Mesh(Mesh { step: None, ..shape }));
        return;
    }
    // Until it has an area, the mesh at rest takes its place, and is hidden when it is shown.
    if let Some(shape) = shape {
        object.value.shape = Shape::Mesh(shape);
    }
    object.value.tracks = Some(ShapeTracks::Deformed(mesh));
}

/// Updates the deformed meshes of which a joint is an object or below it.
pub fn refresh_joints(objects: &mut [Named<Object>], moved: usize) {
    let mut trees: HashMap<*const TransformTree, Option<Arc<TransformTree>>> = HashMap::new();
    // Meshes that were shared stay so. The old ones live until all are replaced.
    let mut meshes: HashMap<*const DeformedMesh, (Arc<DeformedMesh>, Arc<DeformedMesh>)> = HashMap::new();
    for index in 0..objects.len() {
        let Some(ShapeTracks::Deformed(mesh)) = &objects[index].value.tracks else { continue };
        let (mesh, old) = (Arc::clone(mesh), Arc::clone(&mesh.joints().tree));
        let tree = trees.entry(Arc::as_ptr(&old)).or_insert_with(|| {
            old.has(moved).then(|| Arc::new(old.replaced(|object| objects[object].value.transform.clone())))
        });
        let Some(tree) = tree else { continue };
        let new = || (Arc::clone(&mesh), Arc::new(mesh.with_tree(Arc::clone(tree))));
        let (_, new) = meshes.entry(Arc::as_ptr(&mesh)).or_insert_with(new);
        objects[index].value.tracks = Some(ShapeTracks::Deformed(Arc::clone(new)));
    }
}
