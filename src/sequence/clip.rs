//! Decodes `clip` and `cap` of an object: planes that cut it open.

use super::fault::Fault;
use super::fields::Fields;
use super::keys::keyed;
use super::material_table::MaterialTable;
use super::names::Names;
use super::node::Node;
use super::object::{MaterialSource, material_source};
use super::values::{direction, list, vector};
use super::words::{Variants, variant};
use super::{Named, Object};
use crate::base::math::DVec3;
use crate::geometry::clip::ClipPlane;
use crate::geometry::shape::Shape;

/// What cuts an object open, and the material of its cut faces.
#[derive(Default)]
pub struct ClipDraft {
    pub planes: Vec<ClipPlane>,
    pub cap: Option<MaterialSource>,
}

/// Decodes `clip` and `cap` among the fields of an object.
pub fn clip(fields: &mut Fields<'_>, materials: &Names<'_>) -> Option<ClipDraft> {
    let planes = fields.or("clip", |node| list(node, "planes", plane), Vec::new());
    let cap = fields.optional("cap", |node| material_source(node, materials));
    // The cut may be that of an object above.
    if fields.is_given("cap") && !fields.is_given("clip") && !fields.is_given("parent") {
        let title = "`cap` is the material of the faces at which `clip` cuts an object open";
        fields.node().fault(
            Fault::new(fields.place("cap"), title, "this object has no `clip`")
                .help("give it one, such as clip: [Plane(point: (0, 0, 0), normal: (1, 0, 0))]"),
        );
        return None;
    }
    Some(ClipDraft { planes: planes?, cap: cap? })
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

/// Gives objects the material of their cut faces: their own, or that of the nearest object above that has one.
pub fn bind_caps(
    table: &mut MaterialTable<'_>,
    objects: &mut [Named<Object>],
    caps: Vec<Option<MaterialSource>>,
) {
    let bound: Vec<_> = caps
        .into_iter()
        .zip(objects.iter())
        .map(|(cap, object)| {
            let materials = table.bind(cap?, &format!("{} cap", object.name));
            materials.indices().last()
        })
        .collect();
    if bound.iter().all(Option::is_none) {
        return;
    }
    for index in 0..objects.len() {
        let above = std::iter::successors(Some(index), |&at| objects[at].value.parent).take(objects.len());
        let cap = above.filter_map(|at| bound.get(at).copied().flatten()).next();
        let object = &mut objects[index].value;
        if let Some(cap) = cap
            && object.shape != Shape::Group
        {
            object.made_of = object.made_of.capped(cap);
        }
    }
}
