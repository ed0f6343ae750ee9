//! The triangles of a mesh, with one vertex for each combination of position, normal and texture coordinates.

use super::{Attributes, Tessellation, Vertex};
use crate::base::math::{DVec2, DVec3};
use crate::geometry::shape::Mesh;
use std::collections::{BTreeMap, HashMap};

pub fn tessellated(shape: &Mesh) -> Tessellation {
    let mesh = &shape.mesh;
    let count = mesh.triangles().len() as u32;
    let has = Attributes {
        normals: shape.is_smooth(),
        uvs: count > 0 && mesh.corner_uvs(0).is_some(),
        colors: mesh.has_colors(),
    };
    let (mut known, mut vertices) = (HashMap::new(), Vec::new());
    let mut groups: BTreeMap<Option<u16>, Vec<[u32; 3]>> = BTreeMap::new();
    for part in 0..count {
        let corners = corners(shape, part);
        let triangle = corners.map(|vertex| {
            *known.entry(bits(&vertex)).or_insert_with(|| {
                vertices.push(vertex);
                vertices.len() as u32 - 1
            })
        });
        groups.entry(mesh.material_of(part)).or_default().push(triangle);
    }
    Tessellation { vertices, groups: groups.into_iter().collect(), has }
}

fn corners(shape: &Mesh, part: u32) -> [Vertex; 3] {
    let mesh = &shape.mesh;
    let positions = mesh.corners(part);
    let flat = (positions[1] - positions[0]).cross(positions[2] - positions[0]).normalize_or(DVec3::Y);
    // A corner without a normal has that of its triangle.
    let normals = mesh
        .corner_normals(part, shape.normals)
        .map(|normals| normals.map(|normal| normal.as_dvec3().try_normalize().unwrap_or(flat)));
    let normals = normals.unwrap_or([if shape.is_smooth() { flat } else { DVec3::ZERO }; 3]);
    let uvs = mesh.corner_uvs(part).unwrap_or([DVec2::ZERO; 3]);
    let colors = mesh.corner_colors(part).map(|colors| colors.map(|color| color.as_dvec3()));
    let colors = colors.unwrap_or([DVec3::ONE; 3]);
    [0, 1, 2].map(|at| Vertex {
        position: positions[at],
        normal: normals[at],
        uv: uvs[at],
        color: colors[at],
    })
}

/// The bits of all numbers of a vertex.
fn bits(vertex: &Vertex) -> [u64; 11] {
    let Vertex { position, normal, uv, color } = vertex;
    let mut bits = [0; 11];
    let numbers = [position.to_array(), normal.to_array(), color.to_array()];
    let numbers = numbers.into_iter().flatten().chain(uv.to_array());
    bits.iter_mut().zip(numbers).for_each(|(bits, number)| *bits = number.to_bits());
    bits
}
