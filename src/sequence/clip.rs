//! Decodes `clip` and `cap` of an object: planes that cut it open.

use super::fault::Fault;
use super::fields::Fields;
use super::group_instances::CopiedObjects;
use super::keys::keyed;
use super::material_table::MaterialTable;
use super::names::Names;
use super::node::Node;
use super::object::{MaterialSource, material_source};
use super::source_file::File;
use super::values::{direction, list, vector};
use super::words::{Variants, variant};
use super::{Named, Object};
use crate::base::math::DVec3;
use crate::geometry::clip::ClipPlane;
use crate::geometry::shape::Shape;
use std::ops::Range;

/// What cuts an object open.
pub struct ClipDraft {
    pub planes: Vec<ClipPlane>,
    /// The place of the planes.
    pub place: Range<usize>,
    pub cap: Option<CapDraft>,
}

/// The material of cut faces, and its place.
pub struct CapDraft {
    material: MaterialSource,
    place: Range<usize>,
}

/// The place of the planes that cut an object, and the material of its cut faces.
pub type PlacedCap = (Range<usize>, Option<CapDraft>);

/// The most planes that cut one object. Each ray tests all of them.
const MOST: usize = 64;

/// Decodes `clip` and `cap` among the fields of an object.
pub fn clip(fields: &mut Fields<'_>, materials: &Names<'_>) -> Option<ClipDraft> {
    let [place, cap_place] = ["clip", "cap"].map(|field| fields.place(field));
    let planes = fields.or("clip", planes, Vec::new());
    let cap = fields.optional("cap", |node| {
        Some(CapDraft { material: material_source(node, materials)?, place: cap_place })
    });
    Some(ClipDraft { planes: planes?, place, cap: cap? })
}

fn planes(node: Node<'_>) -> Option<Vec<ClipPlane>> {
    let planes = list(node, "planes", plane)?;
    if planes.is_empty() {
        node.file.warn(node.span().start, "`clip` without planes cuts nothing".to_owned());
    }
    Some(planes)
}

fn plane(node: Node<'_>) -> Option<ClipPlane> {
    let table: &Variants<'_, ClipPlane> = &[("Plane", plane_fields)];
    variant(node, "kind of cut", table)
}

fn plane_fields(node: Node<'_>) -> Option<ClipPlane> {
    let mut fields = Fields::of(node, "`Plane`")?;
    let point = fields.or("point", keyed(vector), DVec3::ZERO);
    let normal = fields.required("normal", keyed(direction));
    fields.finish();
    Some(ClipPlane { point: point?, normal: normal? })
}

/// Gives objects the material of their cut faces: their own, or that of the nearest object above that has one. Planes
/// may be those of objects above. The drafts are those of the first objects; what scenes and instances add is below
/// these, or a copy.
pub fn bind_caps(
    file: &File<'_>,
    table: &mut MaterialTable<'_>,
    objects: &mut [Named<Object>],
    (drafts, copied): (Vec<PlacedCap>, &CopiedObjects),
) {
    let original = |at: usize| copied.originals[at];
    let (places, drafts): (Vec<_>, Vec<_>) = drafts.into_iter().unzip();
    let bind = |(draft, object): (Option<CapDraft>, &Named<Object>)| {
        let CapDraft { material, place } = draft?;
        let made_of = table.bind(material, &format!("{} cap", object.name));
        Some(Cap { material: made_of.indices().last()?, place, is_used: false })
    };
    let mut caps: Vec<Option<Cap>> = drafts.into_iter().zip(objects.iter()).map(bind).collect();
    for index in 0..objects.len() {
        let above = || std::iter::successors(Some(index), |&at| objects[at].value.parent).take(objects.len());
        let planes: usize = above().map(|at| objects[at].value.clip.len()).sum();
        if let Some(place) = places.get(original(index)).filter(|_| planes > MOST) {
            let (title, label) =
                ("too many planes cut this object", format!("{planes} planes; at most {MOST}"));
            file.push(Fault::new(place.clone(), title, label).help("planes of the objects above count too"));
            return;
        }
        let nearest = above().map(original).find(|at| matches!(caps.get(*at), Some(Some(_))));
        let Some(cap) = nearest.filter(|_| planes > 0).and_then(|at| caps[at].as_mut()) else { continue };
        cap.is_used = true;
        let object = &mut objects[index].value;
        if object.shape == Shape::Group {
            continue;
        }
        if object.made_of.indices().any(|own| own != cap.material && table.refract([own, cap.material])) {
            file.push(
                Fault::new(
                    cap.place.clone(),
                    "glass has one material on all sides",
                    "another glass than the object",
                )
                .help("leave out `cap`, or give the material of the object"),
            );
            continue;
        }
        object.made_of = object.made_of.capped(cap.material);
    }
    let title = "`cap` is the material of the faces at which `clip` cuts objects open";
    for cap in caps.into_iter().flatten().filter(|cap| !cap.is_used) {
        file.push(
            Fault::new(cap.place, title, "no `clip` cuts this object or one below it")
                .help("give it one, such as clip: [Plane(point: (0, 0, 0), normal: (1, 0, 0))]"),
        );
    }
}

/// A bound material of cut faces.
struct Cap {
    material: u32,
    place: Range<usize>,
    /// Whether planes cut the object or one below it.
    is_used: bool,
}
