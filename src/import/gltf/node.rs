//! Nodes: the hierarchy of a scene, and where each node is in its parent.

use super::GltfResult;
use super::buffers::Buffers;
use super::instancing::{GltfInstance, INSTANCING, instances};
use super::json::Item;
use super::light::LIGHTS;
use crate::base::math::{DMat3, DQuat, DVec3, NotRigid, rotation_and_scale, unit_quaternion};
use std::collections::HashSet;

/// A node of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct GltfNode {
    /// The index of the node in the file.
    pub index: usize,
    /// Empty if it has none.
    pub name: String,
    /// The index of its parent among the nodes of the scene.
    pub parent: Option<usize>,
    /// A point p goes to `translation` + `rotation` · (`scale` · p).
    pub translation: DVec3,
    /// A unit quaternion.
    pub rotation: DQuat,
    pub scale: DVec3,
    pub visible: bool,
    /// Indices of what it shows.
    pub mesh: Option<usize>,
    pub camera: Option<usize>,
    pub light: Option<usize>,
    /// The places of its mesh in it. None: the mesh is at its origin.
    pub instances: Option<Vec<GltfInstance>>,
    pub skin: Option<usize>,
    /// The weights of the morph targets of its mesh; empty for those of the mesh.
    pub weights: Vec<f64>,
}

/// The largest number of nodes and instances.
const MOST_NODES: usize = 1_000_000;

/// Reads the nodes of the file's own scene, parents before children: of the first scene if the file names none, and of
/// nodes without parents if it has no scene.
pub fn nodes(root: &Item<'_>, buffers: &Buffers<'_>) -> GltfResult<Vec<GltfNode>> {
    let items = root.list("nodes")?;
    if items.len() > MOST_NODES {
        return Err(root.error(format!("it has more than {MOST_NODES} nodes")));
    }
    let all = ("nodes", items.len());
    let children = items.iter().map(|item| item.indices("children", all)).collect::<GltfResult<Vec<_>>>()?;
    let mut parents = vec![None; items.len()];
    for (parent, children) in children.iter().enumerate() {
        for &child in children {
            if parents[child].replace(parent).is_some() {
                return Err(items[child].error("it is a child of two nodes"));
            }
        }
    }
    // Also a node that is its own ancestor has a parent. So a walk from the roots ends, and meets every node once.
    let mut walk: Vec<(usize, Option<usize>)> =
        roots(root, &children, &parents)?.into_iter().map(|node| (node, None)).collect();
    let mut nodes: Vec<GltfNode> = Vec::new();
    let (mut at, mut count) = (0, 0);
    while let Some(&(index, parent)) = walk.get(at) {
        let next = node((root, buffers), &items[index], (index, parent))?;
        count += next.instances.as_ref().map_or(0, Vec::len);
        if count > MOST_NODES {
            return Err(items[index].error(format!("there are more than {MOST_NODES} instances")));
        }
        nodes.push(next);
        walk.extend(children[index].iter().map(|child| (*child, Some(at))));
        at += 1;
    }
    Ok(nodes)
}

/// The nodes of the scene that are below no other ones of it. Listed nodes should have no parents, but some exporters
/// list children of nodes that they leave out, which are roots then, or children of other listed nodes.
fn roots(root: &Item<'_>, children: &[Vec<usize>], parents: &[Option<usize>]) -> GltfResult<Vec<usize>> {
    let scenes = ("scenes", root.len_of("scenes"));
    let Some(scene) = root.index("scene", scenes)?.or((scenes.1 > 0).then_some(0)) else {
        return Ok((0..parents.len()).filter(|node| parents[*node].is_none()).collect());
    };
    let scene = root.entry("scenes", scene)?;
    let listed = scene.indices("nodes", ("nodes", parents.len()))?;
    let unique: HashSet<usize> = listed.iter().copied().collect();
    if unique.len() < listed.len() {
        return Err(scene.error("it names a node twice"));
    }
    // From nodes without parents downwards: nodes that are their own ancestors are not met.
    let (mut met, mut roots) = (HashSet::new(), HashSet::new());
    let mut walk: Vec<(usize, bool)> =
        (0..parents.len()).filter(|node| parents[*node].is_none()).map(|node| (node, false)).collect();
    while let Some((node, is_below)) = walk.pop() {
        met.insert(node);
        let is_listed = unique.contains(&node);
        if is_listed && !is_below {
            roots.insert(node);
        }
        walk.extend(children[node].iter().map(|child| (*child, is_below || is_listed)));
    }
    if let Some(own) = listed.iter().find(|node| !met.contains(node)) {
        return Err(scene.error(format!("its nodes[{own}] is its own ancestor, or below such a node")));
    }
    Ok(listed.into_iter().filter(|node| roots.contains(node)).collect())
}

fn node(
    (root, buffers): (&Item<'_>, &Buffers<'_>),
    item: &Item<'_>,
    (index, parent): (usize, Option<usize>),
) -> GltfResult<GltfNode> {
    let (translation, rotation, scale) = place(item)?;
    let lights = root.extension(LIGHTS)?.map_or(0, |lights| lights.len_of("lights"));
    let light = match item.extension(LIGHTS)? {
        Some(light) => light.index("light", ("lights", lights))?,
        None => None,
    };
    let visible = match item.extension("KHR_node_visibility")? {
        Some(visibility) => visibility.flag("visible", true)?,
        None => true,
    };
    let instances = item.extension(INSTANCING)?.map(|item| instances(root, &item, buffers)).transpose()?;
    Ok(GltfNode {
        index,
        name: item.name()?,
        parent,
        translation,
        rotation,
        scale,
        visible,
        mesh: item.index("mesh", ("meshes", root.len_of("meshes")))?,
        camera: item.index("camera", ("cameras", root.len_of("cameras")))?,
        light,
        instances,
        skin: item.index("skin", ("skins", root.len_of("skins")))?,
        weights: item.real_list("weights")?,
    })
}

/// Translation, rotation and scale.
fn place(item: &Item<'_>) -> GltfResult<(DVec3, DQuat, DVec3)> {
    if let Some(matrix) = item.numbers::<16>("matrix")? {
        return decomposed(&matrix).map_err(|why| item.error(why));
    }
    let translation = DVec3::from_array(item.numbers("translation")?.unwrap_or([0.0; 3]));
    let scale = DVec3::from_array(item.numbers("scale")?.unwrap_or([1.0; 3]));
    let rotation = item.numbers("rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let rotation = unit_quaternion(rotation)
        .ok_or_else(|| item.error("its `rotation` is zero, which is no rotation"))?;
    Ok((translation, rotation, scale))
}

/// Decomposes a matrix, which is written column by column.
fn decomposed(matrix: &[f64; 16]) -> Result<(DVec3, DQuat, DVec3), String> {
    let column = |at: usize| DVec3::new(matrix[4 * at], matrix[4 * at + 1], matrix[4 * at + 2]);
    let columns = [0, 1, 2].map(column);
    if [matrix[3], matrix[7], matrix[11], matrix[15]] != [0.0, 0.0, 0.0, 1.0] {
        return Err("the last row of its `matrix` is not 0, 0, 0, 1".to_owned());
    }
    let lengths = DVec3::from_array(columns.map(DVec3::length));
    let (rotation, scale) = rotation_and_scale(completed(columns)).map_err(|why| match why {
        NotRigid::Flat => "a column of its `matrix` is shorter than 1e-30 or longer than 1e30".to_owned(),
        NotRigid::Sheared(angle) => {
            format!("its `matrix` shears: two of its columns meet at {angle:.4} degrees, not at 90")
        }
    })?;
    // Lengths near 1 are exact in a file, unlike in a table of rounded numbers.
    Ok((column(3), rotation, lengths * if scale.x < 0.0 { -1.0 } else { 1.0 }))
}

/// The matrix of these columns. Columns of 0, which hide what the node shows, become unit vectors at right angles to the
/// others, so that the rotation is known.
fn completed(columns: [DVec3; 3]) -> DMat3 {
    let is_zero = columns.map(|column| column == DVec3::ZERO);
    let mut columns = columns;
    if is_zero == [true; 3] {
        return DMat3::IDENTITY;
    }
    for axis in (0..3).filter(|axis| is_zero[*axis]) {
        let (next, last) = (columns[(axis + 1) % 3], columns[(axis + 2) % 3]);
        // With two such columns, the other one of them is 0 still.
        let any = if next == DVec3::ZERO { last } else { next };
        let across = next.normalize_or_zero().cross(last.normalize_or_zero());
        columns[axis] = across.try_normalize().unwrap_or_else(|| any.normalize().any_orthonormal_vector());
    }
    let [x, y, z] = columns;
    DMat3::from_cols(x, y, z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::DAffine3;
    use crate::testing::Random;

    /// A matrix with columns of 0 is the same as a rotation and a scale with zeros.
    #[test]
    fn flat_matrices_have_a_rotation_and_a_scale() {
        let mut random = Random(17);
        for flat in 0..8 {
            let rotation = DQuat::from_axis_angle(random.point(1.0).normalize(), random.unit());
            let scale = DVec3::from_array(
                [1, 2, 4].map(|bit| if flat & bit != 0 { 0.0 } else { 1.0 + random.unit() }),
            );
            let translation = random.point(1.0);
            let matrix = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
            let columns = matrix.matrix3.to_cols_array_2d().into_iter().chain([translation.to_array()]);
            let rows = columns.zip([0.0, 0.0, 0.0, 1.0]).flat_map(|([x, y, z], w)| [x, y, z, w]);
            let matrix: Vec<f64> = rows.collect();
            let (at, turn, size) = decomposed(&std::array::from_fn(|i| matrix[i])).expect("a place");
            let found = DMat3::from_quat(turn) * DMat3::from_diagonal(size);
            let expected = DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
            assert!(found.abs_diff_eq(expected, 1e-12), "{flat}: {found} {expected}");
            assert_eq!((at, size.cmpeq(DVec3::ZERO)), (translation, scale.cmpeq(DVec3::ZERO)));
            assert!((turn.length() - 1.0).abs() < 1e-12);
        }
    }
}
