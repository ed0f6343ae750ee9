//! Decodes `objects`: shapes with a material, a transform and a parent.

use super::clip::{ClipDraft, clip};
use super::expand::{REPEAT, TEMPLATE, WITH, report_misplaced};
use super::explode::{ExplodeDraft, explode};
use super::fault::Fault;
use super::fields::Fields;
use super::group_instances::GroupDraft;
use super::instances::{Instances, Shown};
use super::keys::keyed;
use super::material::{is_material, material, resembles_a_kind};
use super::material_description::{MaterialDescription, MeshMaterials};
use super::mesh::file_place;
use super::mtl::mesh_materials;
use super::names::{Entry, Names};
use super::node::Node;
use super::pose_tracks::Placement;
use super::scene::{SceneDraft, is_scene};
use super::shape::{ShapeOverTime, ShownShape, shown_shape};
use super::shape_tracks::ShapeTracks;
use super::suggest::{listed, nearest, shortened};
use super::transform::transform;
use super::transform_limits::TransformPlace;
use super::values::switch;
use super::words::{report_unknown, unknown};
use crate::geometry::ray_kinds::RayVisibility;
use crate::geometry::shape::{Mesh, Shape};
use crate::geometry::transform::TransformTracks;
use crate::track::Animated;
use std::ops::Range;
use std::rc::Rc;

/// An object whose material has no index yet. Most objects have none of the parts that are boxes.
pub struct ObjectDraft {
    pub shape: ShapeOverTime,
    /// The places of its instances. None if the object itself has the shape.
    pub placements: Option<Vec<Placement>>,
    /// The object that it shows at several places.
    pub group: Option<Box<GroupDraft>>,
    /// The nodes of the scene that it shows.
    pub scene: Option<Box<SceneDraft>>,
    pub material: MaterialSource,
    pub transform: TransformTracks,
    pub visible: Animated<bool>,
    pub rays: RayVisibility,
    pub clip: ClipDraft,
    pub explode: Option<Box<ExplodeDraft>>,
    pub place: TransformPlace,
    /// The place of the field `material`.
    pub material_place: Range<usize>,
}

/// The source of an object's material.
pub enum MaterialSource {
    Default,
    /// Index into the named materials.
    Named(usize),
    Inline(Box<MaterialDescription>),
    /// The materials of the mesh's file.
    Mesh(MeshMaterials),
}

/// The parent that an object names.
#[derive(Clone)]
pub struct Parent {
    /// An object, or behind those of the file a node of a scene.
    pub index: usize,
    pub place: Range<usize>,
}

/// The index of the parent with the quoted name.
fn parent(node: Node<'_>, objects: &Names<'_>) -> Option<usize> {
    objects.index_or(node, |name, known| {
        // The expansion wrote the name of a template's object, which is that of its group, `/`, and its own.
        let group = name.rfind('/').filter(|_| node.file.is_computed(&node.span()));
        let Some(group) = group else { return report_unknown(node, "object", name, known.iter().copied()) };
        let own: Vec<_> = known.iter().copied().filter(|known| known.starts_with(&name[..=group])).collect();
        let help =
            format!("the parents of a template's objects are in the template, here {}", listed(own.clone()));
        node.fault(unknown(node, "object", name, own).help(help));
    })
}

/// Decodes an object and its parent. The parent is returned even if the object has faults. `scene` is the scene that it
/// shows, if it shows one that could be read.
pub fn object(
    node: Node<'_>,
    scene: Option<Box<SceneDraft>>,
    materials: &Names<'_>,
    objects: &Names<'_>,
) -> (Option<Box<ObjectDraft>>, Option<Parent>) {
    // Repeated objects and those of templates have been expanded, unless they are in a named value.
    if node.word() == REPEAT {
        report_misplaced(node, node.head(), REPEAT);
        return (None, None);
    }
    if !node.word().is_empty() && nearest(node.word(), [REPEAT]).is_some() {
        node.fault(unknown(node, "kind of object", node.word(), [REPEAT]));
        return (None, None);
    }
    let Some(mut fields) = Fields::of(node, "an object") else { return (None, None) };
    if fields.is_given(TEMPLATE) {
        report_misplaced(node, fields.place(TEMPLATE), TEMPLATE);
        return (None, None);
    }
    let (mut place, mut placements, mut group) = (fields.place("shape"), None, None);
    let shape = fields.required("shape", |node| {
        let one = if is_scene(&node) {
            // Its faults are reported already.
            scene.as_ref()?;
            ShapeOverTime { shape: Shape::Group, tracks: None }
        } else {
            match shown_shape(node)? {
                ShownShape::Single(shape) => shape,
                ShownShape::Instances(Instances { shown: Shown::Shape(shape), placements: at }) => {
                    placements = Some(at);
                    shape
                }
                ShownShape::Instances(Instances { shown: Shown::Object(name), placements }) => {
                    let of = objects.index(name)?;
                    group = Some(Box::new(GroupDraft { of, place: name.span(), placements }));
                    ShapeOverTime { shape: Shape::Group, tracks: None }
                }
            }
        };
        if let Shape::Mesh(_) = one.shape {
            place = file_place(node);
        }
        Some(one)
    });
    let material_place = fields.place("material");
    let material = fields.or("material", |node| material_source(node, materials), MaterialSource::Default);
    let material = match (&shape, material) {
        (Some(ShapeOverTime { shape: Shape::Mesh(mesh), tracks }), Some(MaterialSource::Default)) => {
            mesh_source(node, place, mesh, tracks.as_ref())
        }
        (_, Some(MaterialSource::Default)) if scene.is_some() => {
            scene.as_ref().map(|scene| MaterialSource::Mesh(Rc::clone(&scene.materials)))
        }
        (_, material) => material,
    };
    if group.is_some() && fields.is_given("material") {
        let title = "the objects of a group have materials of their own";
        node.fault(Fault::new(material_place.clone(), title, "no instance has this one"));
    }
    let place_of = |name| fields.place(name);
    let placed = TransformPlace { scale: place_of("scale"), translation: place_of("translation") };
    let transform = transform(&mut fields);
    let visible = fields.or("visible", keyed(switch), true);
    let shadows = fields.or("casts_shadow", keyed(switch), true);
    let seen = fields.or("seen_by", seen_by, [true.into(), true.into()]);
    let clip = clip(&mut fields, materials);
    let explode = explode(&mut fields);
    // These names are known for suggestions.
    fields.used_up(TEMPLATE);
    fields.used_up(WITH);
    if fields.is_given(WITH) {
        let title = "`with` gives values to the parameters of a `template`";
        node.fault(Fault::new(fields.place(WITH), title, "this object has no `template`"));
    }
    let parent = fields
        .optional("parent", |node| parent(node, objects).map(|index| Parent { index, place: node.span() }));
    fields.finish();
    let rays = shadows.zip(seen).map(|(shadows, [camera, reflections])| RayVisibility {
        camera,
        reflections,
        shadows,
    });
    let draft = || {
        let (Some(_), shape) = (&parent, shape?) else { return None };
        // Drafts are large, and pass through several lists.
        Some(Box::new(ObjectDraft {
            shape,
            placements,
            group,
            scene,
            material: material?,
            transform: transform?,
            visible: visible?,
            rays: rays?,
            clip: clip?,
            explode: explode?,
            place: placed,
            material_place,
        }))
    };
    (draft(), parent.flatten())
}

/// The rays that see an object: those of the camera, and reflections.
fn seen_by(node: Node<'_>) -> Option<[Animated<bool>; 2]> {
    let mut fields = Fields::of(node, "`seen_by`")?;
    let [camera, reflections] = ["camera", "reflections"].map(|name| fields.or(name, keyed(switch), true));
    fields.finish();
    Some([camera?, reflections?])
}

/// The source of the material of a mesh whose object names none.
fn mesh_source(
    node: Node<'_>,
    place: Range<usize>,
    shape: &Mesh,
    tracks: Option<&ShapeTracks>,
) -> Option<MaterialSource> {
    let mesh = &shape.mesh;
    if let Some(ShapeTracks::Series(series)) = tracks
        && let Some(other) = series.other_materials()
    {
        let file = other.file_name().unwrap_or(other.as_os_str()).to_string_lossy();
        let title = "all files of a series need the same materials";
        let label = format!("those of {:?} differ from those of the first file", shortened(&file));
        node.fault(Fault::new(place, title, label).help("give the object a `material`"));
        return None;
    }
    let any = !mesh.materials().is_empty() || mesh.has_colors();
    if any {
        node.file.meshes.materials_of(mesh, || mesh_materials(node, &place, mesh)).map(MaterialSource::Mesh)
    } else {
        Some(MaterialSource::Default)
    }
}

/// A name of a material, or a material in place.
pub fn material_source(node: Node<'_>, materials: &Names<'_>) -> Option<MaterialSource> {
    if node.is_text() {
        return materials.index(node).map(MaterialSource::Named);
    }
    let misspelt = |word: &str| !materials.has(word) && resembles_a_kind(word);
    if is_material(node) || node.bare_word().is_some_and(misspelt) {
        return material(node).map(|given| MaterialSource::Inline(Box::new(given)));
    }
    let fault = node.mismatch("a material's name in quotes, its fields in ( ), or a kind such as Metal( )");
    node.fault(match node.bare_word() {
        Some(word) => fault.help(format!("write \"{}\"", shortened(word))),
        None => fault,
    });
    None
}

/// Reports each cycle of parents once.
pub fn report_circles(node: Node<'_>, names: &[Entry<'_>], parents: &[Option<Parent>]) {
    // 0: not visited. Otherwise, the number of the first walk that visited the object.
    let mut walks = vec![0usize; parents.len()];
    for start in 0..parents.len() {
        let mut at = start;
        while walks[at] == 0 {
            walks[at] = start + 1;
            let Some(parent) = &parents[at] else { break };
            at = parent.index;
            if walks[at] == start + 1 {
                report_circle(node, names, parents, at);
            }
        }
    }
}

fn report_circle(node: Node<'_>, names: &[Entry<'_>], parents: &[Option<Parent>], on: usize) {
    // The message starts at the cycle's first object in the file.
    let round = |from: usize| {
        std::iter::successors(Some(from), |&at| parents[at].as_ref().map(|parent| parent.index))
            .take(parents.len())
            .enumerate()
            .take_while(move |&(step, at)| step == 0 || at != from)
            .map(|(_, at)| at)
    };
    let first = round(on).min().unwrap_or(on);
    let Some(parent) = &parents[first] else { return };
    let way: Vec<String> = round(first).take(8).map(|at| format!("`{}`", names[at].name)).collect();
    let way = match round(first).count() {
        1 => "an object cannot be its own parent".to_owned(),
        2..=8 => format!("the chain of parents is {} and `{}` again", way.join(", "), names[first].name),
        more => format!("the chain of parents is {} and {} more", way.join(", "), more - 8),
    };
    node.fault(Fault::new(parent.place.clone(), "parents form a cycle", way));
}
