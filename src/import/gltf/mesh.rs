//! Meshes: the primitives of each as one triangle mesh, whose triangles name their materials.

use super::GltfResult;
use super::accessor::Accessor;
use super::buffers::Buffers;
use super::features::LeftOut;
use super::json::Item;
use super::material::GltfMaterial;
use super::node::GltfNode;
use super::primitive::{Primitive, Topology, primitive};
use crate::base::color::Rgb;
use crate::base::lists::shortened;
use crate::base::machine;
use crate::base::math::{DVec2, DVec3};
use crate::base::units::counted;
use crate::geometry::mesh::build::has_area;
use crate::geometry::mesh::deform::{Deformer, Influence, MorphTarget};
use crate::geometry::mesh::{Corners, MeshData, TriangleMesh};
use crate::import::{LoadProgress, load};
use glam::Vec3;
use std::sync::Arc;

/// A mesh.
#[derive(Clone, Debug)]
pub struct GltfMesh {
    /// Empty if it has none.
    pub name: String,
    pub mesh: Arc<TriangleMesh>,
    /// Whether no triangle has an area at rest. Then `mesh` takes the place of what the deformer makes of it.
    pub is_flat: bool,
    pub material: MeshMaterial,
    /// All materials of its triangles, ascending.
    pub materials: Vec<usize>,
    /// What deforms the mesh: morph targets, and joints if a node has a skin for them.
    pub deformer: Option<Arc<Deformer>>,
    /// The weights of the morph targets, unless a node has others.
    pub weights: Vec<f64>,
    /// The number of joints that the mesh needs.
    pub joints: usize,
}

/// The materials of a mesh, as indices into [`GltfScene::materials`](super::GltfScene::materials).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshMaterial {
    One(usize),
    /// The slots of its triangles are the indices.
    Slots,
}

/// The memory in bytes that a vertex and a triangle take while they are read.
const VERTEX_SIZE: u64 = 256;
const TRIANGLE_SIZE: u64 = 64;

/// The memory in bytes that a vertex of a morph target takes.
const TARGET_SIZE: u64 = 64;

/// Reads the meshes that nodes show.
pub fn meshes(
    root: &Item<'_>,
    buffers: &Buffers<'_>,
    nodes: &[GltfNode],
    (materials, left_out): (&mut [GltfMaterial], &mut LeftOut),
    meter: &LoadProgress,
) -> GltfResult<Vec<Option<GltfMesh>>> {
    let items = root.list("meshes")?;
    let mut is_shown = vec![false; items.len()];
    nodes.iter().filter_map(|node| node.mesh).for_each(|mesh| is_shown[mesh] = true);
    check_size(
        (root, buffers),
        items.iter().zip(&is_shown).filter(|(_, shown)| **shown).map(|(item, _)| item),
    )?;
    let read = |(item, shown): (&Item<'_>, bool)| match shown {
        true => mesh((root, item), buffers, (&mut *materials, &mut *left_out), meter),
        false => Ok(None),
    };
    items.iter().zip(is_shown).map(read).collect()
}

/// Checks the memory for all meshes together. Many primitives may show the same few bytes.
fn check_size<'a>(
    (root, buffers): (&Item<'_>, &Buffers<'_>),
    meshes: impl Iterator<Item = &'a Item<'a>>,
) -> GltfResult<()> {
    let accessors = ("accessors", root.len_of("accessors"));
    let count = |item: &Item<'_>, key: &str| -> GltfResult<u64> {
        let Some(index) = item.index(key, accessors)? else { return Ok(0) };
        // It checks that the buffer holds as many: a wrong number would be called a lack of memory.
        Ok(Accessor::new(root, buffers, index)?.count as u64)
    };
    let mut size = 0u64;
    for mesh in meshes {
        for item in mesh.list("primitives")? {
            let vertices = count(&item.required("attributes")?, "POSITION")?;
            let corners = count(&item, "indices")?.max(vertices);
            let bytes =
                vertices.saturating_mul(VERTEX_SIZE).saturating_add(corners.saturating_mul(TRIANGLE_SIZE));
            let targets =
                (item.len_of("targets") as u64).saturating_mul(vertices.saturating_mul(TARGET_SIZE));
            size = size.saturating_add(bytes).saturating_add(targets);
        }
    }
    Ok(machine::check_memory(size)?)
}

fn mesh(
    (root, item): (&Item<'_>, &Item<'_>),
    buffers: &Buffers<'_>,
    (materials, left_out): (&mut [GltfMaterial], &mut LeftOut),
    meter: &LoadProgress,
) -> GltfResult<Option<GltfMesh>> {
    let name = item.name()?;
    let mut merged = Merged::default();
    for part in item.list("primitives")? {
        let topology = Topology::of(&part)?;
        if let Some(what) = match topology {
            Topology::Points => Some("points"),
            Topology::Lines => Some("lines"),
            _ => None,
        } {
            left_out.note(what, "primitive");
            continue;
        }
        let none = materials.len() - 1;
        let material = part.index("material", ("materials", none))?.unwrap_or(none);
        let read = primitive((root, &part), buffers, (topology, materials[material].coordinates()))?;
        materials[material].vertex_colors |= !read.colors.is_empty();
        for (what, is_there) in [
            ("alpha of vertex colours", read.has_alpha),
            ("joints beyond the fourth set", read.has_more_joints),
        ] {
            if is_there {
                left_out.note(what, "primitive");
            }
        }
        merged.push(read, material).ok_or_else(|| item.error("it has more than 4294967295 vertices"))?;
    }
    let (data, mut used, deformation) = merged.finish();
    let (joints, targets) = (deformation.joints(), deformation.targets.len());
    let is_deformed = joints > 0 || targets > 0;
    let is_flat = !data
        .triangles
        .iter()
        .any(|triangle| has_area(triangle.map(|vertex| data.positions[vertex as usize])));
    let stand_in = if is_flat && is_deformed { stand_in(&data) } else { None };
    if is_flat && stand_in.is_none() {
        // Meshes of points and lines alone have been noted.
        if !data.triangles.is_empty() {
            left_out.note("surfaces without an area", "mesh");
        }
        return Ok(None);
    }
    let named = if name.is_empty() { item.to_string() } else { format!("{:?}", shortened(&name)) };
    meter.start(format!("building the tree of mesh {named}"), 0);
    used.sort_unstable();
    used.dedup();
    let (material, slots) = match used[..] {
        [one] => (MeshMaterial::One(one), Vec::new()),
        _ => (MeshMaterial::Slots, data.slots),
    };
    let data = MeshData { slots, ..data };
    let deformer = is_deformed.then(|| Arc::new(deformation.deformer(data.clone())));
    let mut weights = item.real_list("weights")?;
    check_weights(item, weights.len(), targets)?;
    weights.resize(targets, 0.0);
    let data = stand_in.unwrap_or(data);
    let mesh = load::build(data, None).map_err(|error| item.error(error.to_string()))?;
    let mesh = Arc::new(mesh);
    Ok(Some(GltfMesh { name, mesh, is_flat, material, materials: used, deformer, weights, joints }))
}

/// Checks the number of weights of a mesh, or of a node that shows it. There may be none.
pub fn check_weights(item: &Item<'_>, weights: usize, targets: usize) -> GltfResult<()> {
    if weights == 0 || weights == targets {
        return Ok(());
    }
    let (weights, targets) = (counted(weights as u64, "weight"), counted(targets as u64, "morph target"));
    Err(item.error(format!("it has {weights} for {targets}")))
}

/// The number of morph targets of a mesh, the largest of its primitives.
pub fn morph_targets(mesh: &Item<'_>) -> GltfResult<usize> {
    Ok(mesh.list("primitives")?.iter().map(|part| part.len_of("targets")).max().unwrap_or(0))
}

/// A mesh of one triangle with an area, in place of a mesh that has none before it is deformed. None if no triangle has
/// three vertices: then nothing gives it an area.
fn stand_in(data: &MeshData) -> Option<MeshData> {
    let differ = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    let face = data.triangles.iter().position(differ)?;
    let mut positions = vec![DVec3::ZERO; data.positions.len()];
    let triangle = data.triangles[face];
    for (vertex, corner) in triangle.into_iter().zip([DVec3::ZERO, DVec3::X, DVec3::Y]) {
        positions[vertex as usize] = corner;
    }
    Some(MeshData { positions, triangles: vec![triangle], slots: Vec::new(), ..data.clone() })
}

/// Primitives in one mesh. Attributes that only some primitives have are filled up.
#[derive(Default)]
struct Merged {
    data: MeshData,
    normals: Vec<Vec3>,
    uvs: Vec<DVec2>,
    materials: Vec<usize>,
    deformation: Deformation,
}

/// Morph targets and joints of all vertices so far.
#[derive(Default)]
struct Deformation {
    targets: Vec<MorphTarget>,
    influences: Vec<Vec<Influence>>,
}

impl Deformation {
    /// Adds those of a primitive, whose vertices are from `before` to `count`.
    fn push(
        &mut self,
        targets: Vec<MorphTarget>,
        influences: Vec<Vec<Influence>>,
        (before, count): (usize, usize),
    ) {
        self.targets.resize(self.targets.len().max(targets.len()), MorphTarget::default());
        let mut targets = targets.into_iter();
        for all in &mut self.targets {
            let MorphTarget { positions, normals } = targets.next().unwrap_or_default();
            append(&mut all.positions, positions, (before, count), DVec3::ZERO);
            append(&mut all.normals, normals, (before, count), Vec3::ZERO);
        }
        if !(influences.is_empty() && self.influences.is_empty()) {
            self.influences.resize(before, Vec::new());
            self.influences.extend(influences);
            self.influences.resize(count, Vec::new());
        }
    }

    /// The number of joints that vertices name.
    fn joints(&self) -> usize {
        let joints = self.influences.iter().flatten().map(|influence| usize::from(influence.joint) + 1);
        joints.max().unwrap_or(0)
    }

    fn deformer(self, data: MeshData) -> Deformer {
        let width = self.influences.iter().map(Vec::len).max().unwrap_or(0);
        let padded = self.influences.into_iter().flat_map(|mut of_vertex| {
            of_vertex.resize(width, Influence { joint: 0, weight: 0.0 });
            of_vertex
        });
        Deformer::new(data, self.targets, padded.collect(), width)
    }
}

impl Merged {
    /// Adds a primitive. None if there are too many vertices.
    fn push(&mut self, part: Primitive, material: usize) -> Option<()> {
        let data = &mut self.data;
        let before = data.positions.len();
        let first = u32::try_from(before).ok()?;
        u32::try_from(before + part.positions.len()).ok()?;
        add(&mut data.positions, part.positions);
        let count = data.positions.len();
        append(&mut self.normals, part.normals, (before, count), Vec3::ZERO);
        append(&mut self.uvs, part.uvs, (before, count), DVec2::ZERO);
        append(&mut data.colors, part.colors, (before, count), Rgb::ONE);
        data.slots.resize(data.slots.len() + part.triangles.len(), material as u16);
        let moved = part.triangles.into_iter().map(|triangle| triangle.map(|vertex| first + vertex));
        add(&mut data.triangles, moved.collect());
        self.materials.push(material);
        self.deformation.push(part.targets, part.influences, (before, count));
        Some(())
    }

    /// The whole mesh, the materials of its primitives, and what deforms it.
    fn finish(self) -> (MeshData, Vec<usize>, Deformation) {
        let Self { data, normals, uvs, materials, deformation } = self;
        let normals = (!normals.is_empty()).then(|| Corners::per_vertex(normals));
        let uvs = (!uvs.is_empty()).then(|| Corners::per_vertex(uvs));
        (MeshData { normals, uvs, ..data }, materials, deformation)
    }
}

/// Appends values of vertices, such that there are `count`, or none at all.
fn append<T: Clone>(all: &mut Vec<T>, part: Vec<T>, (before, count): (usize, usize), missing: T) {
    if part.is_empty() && all.is_empty() {
        return;
    }
    all.resize(before, missing.clone());
    add(all, part);
    all.resize(count, missing);
}

/// Adds values at the end. Those of the first primitive are moved: most meshes have only one, and writing to new memory
/// takes long.
fn add<T>(all: &mut Vec<T>, part: Vec<T>) {
    match all.is_empty() {
        true => *all = part,
        false => all.extend(part),
    }
}
