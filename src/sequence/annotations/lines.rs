//! Decodes lines, trails, lengths and angles.

use super::anchor::{anchor, world_anchor};
use super::common::{common, template};
use super::scene_names::SceneNames;
use crate::annotate::{
    AngleArc, Annotation, AnnotationKind, CurveMark, CurvePoints, Dimension, HeadStyle, LineMark,
};
use crate::encode::Template;
use crate::sequence::fault::Fault;
use crate::sequence::fields::Fields;
use crate::sequence::keys::interval;
use crate::sequence::node::Node;
use crate::sequence::pose_columns::{POSITIONS, column};
use crate::sequence::pose_tracks::vectors;
use crate::sequence::poses::table;
use crate::sequence::values::{between, each, file_path, list, positive, switch, tuple, world_vector};
use crate::track::Animated;

/// A line, or an arrow with a head at its end.
pub fn line(node: Node<'_>, scene: &SceneNames<'_>, is_arrow: bool) -> Option<Annotation> {
    let mut fields = Fields::of(node, if is_arrow { "an arrow" } else { "a line" })?;
    let common = common(&mut fields);
    let from = fields.required("from", anchor(scene));
    let to = fields.required("to", anchor(scene));
    let both = if is_arrow { fields.or("both", switch, false) } else { Some(false) };
    fields.finish();
    let style = |shown| if shown { HeadStyle::Arrow } else { HeadStyle::None };
    let heads = [style(both?), style(is_arrow)];
    Some(common?.with(AnnotationKind::Line(LineMark { from: from?, to: to?, heads })))
}

pub fn polyline(node: Node<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "a polyline")?;
    let common = common(&mut fields);
    let (in_file, in_list) = (fields.has("file"), fields.has("points"));
    if in_file == in_list {
        let title = "a polyline has either `points` or a `file`";
        let label = if in_file { "one too many" } else { "needs one of them" };
        node.fault(Fault::new(fields.place("file"), title, label));
        return None;
    }
    let points = match in_list {
        true => fields.required("points", |node| list(node, "points", world_vector)),
        false => from_file(&mut fields),
    };
    let dot = fields.or("dot", switch, false);
    fields.finish();
    let kind = CurveMark { points: CurvePoints::Points(points?), dot: dot? };
    Some(common?.with(AnnotationKind::Curve(kind)))
}

/// Points in the columns of a table.
fn from_file(fields: &mut Fields<'_>) -> Option<Vec<crate::base::math::DVec3>> {
    let mut place = fields.place("file");
    let table = fields.required("file", |node| {
        place = node.span();
        table(node, &file_path(node)?)
    });
    let position = fields.optional("position", |node| each(tuple(node, "three names of columns")?, column));
    let (table, position) = (table?, position?);
    let usual = || {
        let known = POSITIONS.into_iter().find(|names| names.iter().all(|name| table.has(name)))?;
        Some(known.map(|name| crate::sequence::pose_columns::ColumnName {
            name: name.to_owned(),
            place: place.clone(),
        }))
    };
    let Some(position) = position.or_else(usual) else {
        let fault =
            Fault::new(place.clone(), "this table has no columns `x`, `y` and `z`", "needs `position`");
        fields.node().fault(fault.help("write position: (\"name\", \"name\", \"name\")"));
        return None;
    };
    let up = fields.node().file.up.get();
    match vectors(&table, &position) {
        Ok(points) => Some(points.into_iter().map(|point| up.to_y_up(point)).collect()),
        Err((place, error)) => {
            fields.node().fault(Fault::new(place, "cannot use the points of this table", error.to_string()));
            None
        }
    }
}

pub fn trail(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Annotation> {
    let mut fields = Fields::of_or_only(node, "a trail", "of")?;
    let common = common(&mut fields);
    let of = fields.required("of", world_anchor(scene));
    let last = fields.optional("last", interval);
    let dot = fields.or("dot", switch, false);
    fields.finish();
    let kind = CurveMark { points: CurvePoints::Trail(of?, last?), dot: dot? };
    Some(common?.with(AnnotationKind::Curve(kind)))
}

/// The text of a length or an angle. Its own number has a name.
fn measured(
    fields: &mut Fields<'_>,
    common: Option<&super::common::Common>,
    own: &str,
    usual: &str,
) -> Option<Animated<Template>> {
    let names = common.map(|common| common.names(&[own])).unwrap_or_else(|| vec![own]);
    let usual = Template::with_values(usual, &names).unwrap_or_default();
    fields.or("text", template(&names), usual)
}

pub fn dimension(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "a dimension")?;
    let common = common(&mut fields);
    let from = fields.required("from", world_anchor(scene));
    let to = fields.required("to", world_anchor(scene));
    let offset = fields.or("offset", between(-1.0..=1.0), 0.08);
    let text = measured(&mut fields, common.as_ref(), "length", "{length}");
    fields.finish();
    let kind = Dimension { from: from?, to: to?, offset: offset?, text: text? };
    Some(common?.with(AnnotationKind::Dimension(kind)))
}

pub fn angle(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "an angle")?;
    let common = common(&mut fields);
    let [at, from, to] = ["at", "from", "to"].map(|name| fields.required(name, world_anchor(scene)));
    let radius = fields.or("radius", positive, 0.5);
    let text = measured(&mut fields, common.as_ref(), "angle", "{angle:.1}°");
    fields.finish();
    let kind = AngleArc { at: at?, from: from?, to: to?, radius: radius?, text: text? };
    Some(common?.with(AnnotationKind::Angle(kind)))
}
