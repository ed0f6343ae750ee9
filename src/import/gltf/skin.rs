//! Skins: the joints that deform a mesh.

use super::GltfResult;
use super::accessor::Accessor;
use super::buffers::Buffers;
use super::json::Item;
use super::mesh::GltfMesh;
use super::node::GltfNode;
use crate::base::math::{DAffine3, DMat3, DVec3, ROUNDED};
use std::collections::HashMap;
use std::sync::Arc;

/// The joints of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct GltfSkin {
    /// Each joint as an index into the nodes of the scene, with the map from the mesh at rest into its node.
    pub joints: Arc<[(usize, DAffine3)]>,
}

/// The largest number of joints: vertices name theirs with 16 bits.
const MOST_JOINTS: usize = 1 << 16;

/// Reads all skins. None for those with a joint outside the scene, which no node of the scene may use.
pub fn skins(
    root: &Item<'_>,
    buffers: &Buffers<'_>,
    nodes: &[GltfNode],
) -> GltfResult<Vec<Option<GltfSkin>>> {
    let places: HashMap<usize, usize> =
        nodes.iter().enumerate().map(|(place, node)| (node.index, place)).collect();
    let skin = |item: &Item<'_>| {
        let joints = item.indices("joints", ("nodes", root.len_of("nodes")))?;
        if joints.is_empty() || joints.len() > MOST_JOINTS {
            return Err(item.error(format!("it has {} joints, not 1 to {MOST_JOINTS}", joints.len())));
        }
        let rest = match item.index("inverseBindMatrices", ("accessors", root.len_of("accessors")))? {
            Some(index) => Accessor::new(root, buffers, index)?.elements::<16>()?,
            None => vec![IDENTITY; joints.len()],
        };
        if rest.len() < joints.len() {
            return Err(item.error(format!("it has {} matrices for {} joints", rest.len(), joints.len())));
        }
        if let Some(at) = rest.iter().take(joints.len()).position(|matrix| !has_last_row(matrix)) {
            return Err(item.error(format!("the last row of its inverse bind matrix {at} is not 0, 0, 0, 1")));
        }
        let placed =
            joints.iter().zip(&rest).map(|(joint, matrix)| Some((*places.get(joint)?, affine(matrix))));
        Ok(placed.collect::<Option<Arc<[_]>>>().map(|joints| GltfSkin { joints }))
    };
    root.list("skins")?.iter().map(skin).collect()
}

const IDENTITY: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Whether the last row of a matrix is (0, 0, 0, 1), up to rounding.
fn has_last_row(matrix: &[f64; 16]) -> bool {
    let last = [3, 7, 11, 15].map(|at: usize| matrix[at]);
    last.into_iter().zip([0.0, 0.0, 0.0, 1.0]).all(|(found, exact)| (found - exact).abs() <= ROUNDED)
}

/// A matrix that is written column by column. Its last row is (0, 0, 0, 1).
fn affine(matrix: &[f64; 16]) -> DAffine3 {
    let column = |at: usize| DVec3::new(matrix[4 * at], matrix[4 * at + 1], matrix[4 * at + 2]);
    DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation: column(3) }
}

/// Checks that every skinned node has the joints that its mesh names.
pub fn check(
    root: &Item<'_>,
    nodes: &[GltfNode],
    meshes: &[Option<GltfMesh>],
    skins: &[Option<GltfSkin>],
) -> GltfResult<()> {
    for node in nodes {
        let mesh = node.mesh.and_then(|mesh| meshes[mesh].as_ref());
        let (Some(skin), Some(mesh)) = (node.skin, mesh) else { continue };
        let error = |why: String| Err(root.entry("nodes", node.index)?.error(why));
        match &skins[skin] {
            None => return error("a joint of its skin is not in the scene".to_owned()),
            Some(skin) if mesh.joints > skin.joints.len() => {
                let (named, there) = (mesh.joints - 1, skin.joints.len());
                return error(format!("its mesh names the joint {named}, but its skin has {there} joints"));
            }
            Some(_) => {}
        }
    }
    Ok(())
}
