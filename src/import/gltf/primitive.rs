//! Primitives: the vertices and triangles of a part of a mesh that has one material.

use super::GltfResult;
use super::accessor::{Accessor, Number};
use super::buffers::Buffers;
use super::json::Item;
use crate::base::color::Rgb;
use crate::base::math::{DVec2, DVec3};
use crate::geometry::mesh::deform::{Influence, MorphTarget};
use glam::Vec3;

/// A primitive.
pub struct Primitive {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// One per position; empty if there are none.
    pub normals: Vec<Vec3>,
    pub uvs: Vec<DVec2>,
    pub colors: Vec<Rgb>,
    /// Whether a vertex colour has alpha below 1.
    pub has_alpha: bool,
    /// Whether there are more sets of joints than Kinora reads.
    pub has_more_joints: bool,
    pub targets: Vec<MorphTarget>,
    /// The joints of each vertex, four for each set of joints and weights; empty if there are none.
    pub influences: Vec<Vec<Influence>>,
}

/// What the points of a primitive are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topology {
    Points,
    Lines,
    Triangles,
    Strip,
    Fan,
}

impl Topology {
    pub fn of(item: &Item<'_>) -> GltfResult<Self> {
        Ok(match item.whole("mode")? {
            Some(0) => Self::Points,
            Some(1..=3) => Self::Lines,
            None | Some(4) => Self::Triangles,
            Some(5) => Self::Strip,
            Some(6) => Self::Fan,
            Some(_) => return Err(item.error("its `mode` is not from 0 to 6")),
        })
    }

    /// The triangles of vertices in their order (section 3.7.2.1 of the specification).
    fn triangles(self, vertices: &[u32]) -> Vec<[u32; 3]> {
        match self {
            Self::Points | Self::Lines => Vec::new(),
            Self::Triangles => vertices.as_chunks().0.to_vec(),
            Self::Strip => {
                let odd = |at: usize| at % 2 == 1;
                let corners = vertices.windows(3).enumerate();
                corners.map(|(at, v)| if odd(at) { [v[0], v[2], v[1]] } else { [v[0], v[1], v[2]] }).collect()
            }
            Self::Fan => match vertices {
                [center, rest @ ..] => rest.windows(2).map(|pair| [pair[0], pair[1], *center]).collect(),
                [] => Vec::new(),
            },
        }
    }
}

/// Reads a primitive of triangles. `coordinates` is the number of its texture coordinates.
pub fn primitive(
    (root, item): (&Item<'_>, &Item<'_>),
    buffers: &Buffers<'_>,
    (topology, coordinates): (Topology, u64),
) -> GltfResult<Primitive> {
    let accessors = ("accessors", root.len_of("accessors"));
    let attributes = item.required("attributes")?;
    let attribute = |name: &str| match attributes.index(name, accessors)? {
        Some(index) => Accessor::new(root, buffers, index).map(Some),
        None => Ok(None),
    };
    let positions = attribute("POSITION")?.ok_or_else(|| attributes.error("there is no `POSITION`"))?;
    let count = positions.count;
    let of_vertices = |name: &str| match attribute(name)? {
        Some(accessor) if accessor.count != count => {
            let why = format!("it has {count} positions, but {} of its `{name}`", accessor.count);
            Err(attributes.error(why))
        }
        other => Ok(other),
    };
    let normals = match of_vertices("NORMAL")? {
        Some(normals) => normals.elements::<3>()?,
        None => Vec::new(),
    };
    let uvs = match of_vertices(&format!("TEXCOORD_{coordinates}"))? {
        Some(uvs) => uvs.elements::<2>()?,
        None => Vec::new(),
    };
    let (colors, has_alpha) = match of_vertices("COLOR_0")? {
        Some(colors) => self::colors(&colors)?,
        None => (Vec::new(), false),
    };
    let vertices = match item.index("indices", accessors)? {
        Some(index) => {
            let indices = Accessor::new(root, buffers, index)?;
            indices.whole::<1>("indices", &[Number::U8, Number::U16, Number::U32])?.into_flattened()
        }
        None => (0..u32::try_from(count).unwrap_or(u32::MAX)).collect(),
    };
    if let Some(wrong) = vertices.iter().find(|vertex| **vertex as usize >= count) {
        return Err(item.error(format!("there is no vertex {wrong}; the primitive has {count}")));
    }
    if topology == Topology::Triangles && vertices.len() % 3 != 0 {
        return Err(item.error(format!("its {} vertices are no whole number of triangles", vertices.len())));
    }
    let targets = item.list("targets")?;
    let targets = targets.iter().map(|target| morph_target((root, target), buffers, count));
    let targets = targets.collect::<GltfResult<_>>()?;
    let influences = influences(|name| of_vertices(name), count)?;
    let has_more_joints = attributes.has(&format!("JOINTS_{MOST_SETS}"));
    Ok(Primitive {
        targets,
        influences,
        positions: positions.elements()?.into_iter().map(DVec3::from_array).collect(),
        triangles: topology.triangles(&vertices),
        normals: normals.into_iter().map(|normal| DVec3::from_array(normal).as_vec3()).collect(),
        // In glTF, v goes downwards.
        uvs: uvs.into_iter().map(|[u, v]| DVec2::new(u, 1.0 - v)).collect(),
        colors,
        has_alpha,
        has_more_joints,
    })
}

/// A morph target of `count` vertices.
fn morph_target(
    (root, item): (&Item<'_>, &Item<'_>),
    buffers: &Buffers<'_>,
    count: usize,
) -> GltfResult<MorphTarget> {
    let vectors = |name: &str| {
        let Some(index) = item.index(name, ("accessors", root.len_of("accessors")))? else {
            return Ok(Vec::new());
        };
        let accessor = Accessor::new(root, buffers, index)?;
        if accessor.count != count {
            return Err(item.error(format!("it has {} of its `{name}`, not {count}", accessor.count)));
        }
        Ok(accessor.elements::<3>()?.into_iter().map(DVec3::from_array).collect::<Vec<_>>())
    };
    let normals = vectors("NORMAL")?.into_iter().map(DVec3::as_vec3).collect();
    Ok(MorphTarget { positions: vectors("POSITION")?, normals })
}

/// The largest number of sets of joints and weights.
const MOST_SETS: usize = 4;

/// The joints of each vertex with their weights, from all sets.
fn influences<'a>(
    attribute: impl Fn(&str) -> GltfResult<Option<Accessor<'a>>>,
    count: usize,
) -> GltfResult<Vec<Vec<Influence>>> {
    let mut all = Vec::new();
    for set in 0..MOST_SETS {
        let (joints, weights) = (attribute(&format!("JOINTS_{set}"))?, attribute(&format!("WEIGHTS_{set}"))?);
        let (Some(joints), Some(weights)) = (joints, weights) else { break };
        let joints = joints.whole::<4>("joints", &[Number::U8, Number::U16])?;
        let weights = weights.elements::<4>()?;
        all.resize(count, Vec::new());
        for ((vertex, joints), weights) in all.iter_mut().zip(joints).zip(weights) {
            let pairs = joints.into_iter().zip(weights);
            // Joints are at most 65535.
            vertex.extend(
                pairs.map(|(joint, weight)| Influence { joint: joint as u16, weight: weight.max(0.0) }),
            );
        }
    }
    Ok(all)
}

/// Linear vertex colours of 0 or more, and whether any has alpha below 1.
fn colors(accessor: &Accessor<'_>) -> GltfResult<(Vec<Rgb>, bool)> {
    let color = |[r, g, b]: [f64; 3]| DVec3::new(r, g, b).max(DVec3::ZERO).as_vec3();
    let (number, _, width) = accessor.layout();
    if !matches!(number, Number::F32 | Number::U8 | Number::U16) {
        return Err(accessor.error(
            "colours have the component type 5126 (float), 5121 (unsigned byte) or 5123 (unsigned short)",
        ));
    }
    if width == 4 {
        let colors = accessor.elements::<4>()?;
        let has_alpha = colors.iter().any(|[.., alpha]| *alpha < 1.0);
        return Ok((colors.into_iter().map(|[r, g, b, _]| color([r, g, b])).collect(), has_alpha));
    }
    Ok((accessor.elements::<3>()?.into_iter().map(color).collect(), false))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_orientation() {
        let vertices = [0, 1, 2, 3, 4];
        assert_eq!(Topology::Strip.triangles(&vertices), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(Topology::Fan.triangles(&vertices), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
        assert_eq!(Topology::Triangles.triangles(&vertices[..3]), [[0, 1, 2]]);
        assert_eq!(Topology::Strip.triangles(&vertices[..2]), [[0u32; 3]; 0]);
        assert_eq!(Topology::Fan.triangles(&[]), [[0u32; 3]; 0]);
    }
}
