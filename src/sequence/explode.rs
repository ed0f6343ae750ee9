//! Decodes `explode` of an object: an exploded view of the objects below it.

use super::fields::Fields;
use super::keys::keyed;
use super::node::Node;
use super::placement::{chain, children};
use super::source_file::File;
use super::suggest::shortened;
use super::values::{number, unit_vector, vector};
use super::words::{Variants, variant};
use super::{Named, Object};
use crate::base::math::{Aabb, DAffine3, DVec3};
use crate::base::time::Time;
use crate::geometry::shape::Shape;
use crate::geometry::transform::ExplodeOffset;
use crate::track::Animated;
use std::collections::HashSet;

/// The exploded view of the parts of an object.
#[derive(Clone)]
pub struct ExplodeDraft {
    factor: Animated<f64>,
    /// None: from the middle of all parts.
    from: Option<Origin>,
    /// Only in this direction, and in the opposite one.
    along: Option<DVec3>,
    /// Where it stands in the source.
    place: usize,
}

/// What parts move away from.
#[derive(Clone)]
enum Origin {
    Point(DVec3),
    /// Straight away from a line through a point, which has a direction of length 1.
    Axis(DVec3, DVec3),
}

/// Decodes `explode` among the fields of an object.
pub fn explode(fields: &mut Fields<'_>) -> Option<Option<Box<ExplodeDraft>>> {
    fields.optional("explode", |node| {
        let mut fields = Fields::of(node, "`explode`")?;
        let factor = fields.required("factor", keyed(number));
        let from = fields.optional("from", origin);
        let along = fields.optional("along", unit_vector);
        fields.finish();
        let place = node.span().start;
        Some(Box::new(ExplodeDraft { factor: factor?, from: from?, along: along?, place }))
    })
}

fn origin(node: Node<'_>) -> Option<Origin> {
    if node.opens_with('(') && node.word().is_empty() {
        return vector(node).map(Origin::Point);
    }
    let table: &Variants<'_, Origin> = &[("Axis", axis)];
    variant(node, "centre", table)
}

fn axis(node: Node<'_>) -> Option<Origin> {
    let mut fields = Fields::of(node, "`Axis`")?;
    let point = fields.or("point", vector, DVec3::ZERO);
    let direction = fields.required("direction", unit_vector);
    fields.finish();
    Some(Origin::Axis(point?, direction?))
}

/// Gives the parts of objects their offsets in exploded views.
pub fn add_offsets(file: &File<'_>, objects: &mut [Named<Object>], drafts: Vec<Option<Box<ExplodeDraft>>>) {
    if drafts.iter().all(Option::is_none) {
        return;
    }
    let bounds = bounds_within_parents(objects);
    let explodes: Vec<bool> = drafts.iter().map(Option::is_some).collect();
    let mut below = children(objects);
    below.iter_mut().for_each(|parts| parts.retain(|part| objects[*part].value.skin_of.is_none()));
    let mut noted = HashSet::new();
    for (object, draft) in drafts.into_iter().enumerate() {
        let Some(draft) = draft else { continue };
        let parts = parts_of(objects, object, &below, &explodes);
        // Copies of a group have its field.
        if parts.is_empty() && noted.insert(draft.place) {
            let name = shortened(&objects[object].name);
            file.warn(
                draft.place,
                format!("`explode` of `{name}` moves nothing: no object has it as its `parent`"),
            );
        }
        let middles: Vec<DVec3> = parts.iter().map(|&part| middle(objects, &bounds, part)).collect();
        let all = parts.iter().filter_map(|&part| bounds[part]).reduce(Aabb::union);
        let center = all.map_or(DVec3::ZERO, |all| all.center());
        for (part, middle) in parts.into_iter().zip(middles) {
            let offset = draft.offset(middle, center);
            let transform = &mut objects[part].value.transform;
            transform.explode = Some(ExplodeOffset { offset, factor: draft.factor.clone() });
        }
    }
}

impl ExplodeDraft {
    /// The offset of a part with this middle at a factor of 1.
    fn offset(&self, middle: DVec3, center: DVec3) -> DVec3 {
        let away = match self.from {
            None => middle - center,
            Some(Origin::Point(point)) => middle - point,
            Some(Origin::Axis(point, direction)) => (middle - point).reject_from_normalized(direction),
        };
        self.along.map_or(away, |along| away.project_onto_normalized(along))
    }
}

/// The objects right below an object. If that is only one, a group that does not explode itself, those below it: such as
/// the root of a scene. Meshes that move with other objects are not parts: what carries them moves them.
fn parts_of(objects: &[Named<Object>], object: usize, below: &[Vec<usize>], explodes: &[bool]) -> Vec<usize> {
    let mut above = object;
    for _ in 0..objects.len() {
        let parts = &below[above];
        match parts[..] {
            [only]
                if objects[only].value.shape == Shape::Group
                    && !explodes.get(only).is_some_and(|own| *own) =>
            {
                above = only;
            }
            _ => return parts.clone(),
        }
    }
    Vec::new()
}

/// The bounds of each object and all below it at time 0, in the coordinates of its parent. None without a bounded shape.
fn bounds_within_parents(objects: &[Named<Object>]) -> Vec<Option<Aabb>> {
    let start = Time::from_integer(0);
    let mut all: Vec<Option<Aabb>> = vec![None; objects.len()];
    for (index, Named { value: object, .. }) in objects.iter().enumerate() {
        let own = match &object.tracks {
            Some(tracks) => tracks.bounds_at(start),
            None => object.shape.bounds(),
        };
        let Some(mut bounds) = own else { continue };
        for above in chain(objects, index) {
            let within: DAffine3 = objects[above].value.transform.at(start);
            bounds = bounds.transformed(&within);
            all[above] = Some(all[above].map_or(bounds, |sum| sum.union(bounds)));
        }
    }
    all
}

/// The middle of a part in the coordinates of its parent. Without bounds, its origin.
fn middle(objects: &[Named<Object>], bounds: &[Option<Aabb>], part: usize) -> DVec3 {
    let origin = || objects[part].value.transform.at(Time::from_integer(0)).translation;
    bounds[part].map_or_else(origin, |bounds| bounds.center())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::parse;

    /// Three balls in a row, of which the second and third are one part, in a group with this field.
    fn positions(explode: &str, seconds: i128) -> Vec<DVec3> {
        let text = format!(
            r#"(timeline: (frames: 4, fps: 1), objects: {{
                "all": (shape: Group, explode: {explode}),
                "a": (shape: Sphere(radius: 0.5), parent: "all", translation: (-3, 1, 0)),
                "b": (shape: Sphere(center: (0, 1, 1), radius: 0.5), parent: "all"),
                "c": (shape: Sphere(center: (3, 0, 0), radius: 0.5), parent: "b", translation: (0, 1, 0)),
            }})"#
        );
        let sequence = parse("test.ron", &text).expect("a sequence");
        let time = Time::from_integer(seconds);
        (1..4).map(|object| sequence.to_world(object, time).translation).collect()
    }

    /// Bounds are padded by their rounding.
    #[track_caller]
    fn assert_close(found: &[DVec3], expected: &[DVec3]) {
        let apart = found.iter().zip(expected).map(|(a, b)| (*a - *b).length());
        assert!(apart.fold(0.0, f64::max) < 1e-12, "{found:?} {expected:?}");
    }

    #[test]
    fn views_and_cuts_without_effect_are_noted() {
        let text = r#"(objects: { "a": (shape: Sphere(), explode: (factor: 1)), "b": (shape: Sphere(), clip: []) })"#;
        let notes = parse("test.ron", text).expect("a sequence").notes().join("\n");
        let expected = [
            "`explode` of `a` moves nothing: no object has it as its `parent`",
            "`clip` without planes cuts nothing",
        ];
        assert!(expected.iter().all(|note| notes.contains(note)), "{notes}");
    }

    #[test]
    fn parts_depart_from_the_middle() {
        let factor = "(factor: [(0, 0), (2, 1)])";
        let places = [DVec3::new(-3.0, 1.0, 0.0), DVec3::ZERO, DVec3::Y];
        assert_eq!(positions(factor, 0), places);
        // The boxes of the parts are x -3.5 to -2.5, and -0.5 to 3.5; both are in the middle at y 1. The second part is
        // z -0.5 to 1.5, so all are.
        let (a, b) = (DVec3::new(-3.0, 0.0, -0.5), DVec3::new(1.5, 0.0, 0.0));
        let moved = |share: f64| [places[0] + a * share, places[1] + b * share, places[2] + b * share];
        assert_close(&positions(factor, 2), &moved(1.0));
        assert_close(&positions(factor, 1), &moved(0.5));
    }

    #[test]
    fn parts_depart_from_points_and_axes_and_along_directions() {
        let away = |fields: &str| {
            let [a, b, _] = positions(&format!("(factor: 1, {fields})"), 0)[..] else {
                panic!("three objects")
            };
            [a - DVec3::new(-3.0, 1.0, 0.0), b]
        };
        let (a, b) = (DVec3::new(-3.0, 1.0, 0.0), DVec3::new(1.5, 1.0, 0.5));
        assert_close(&away("from: (0, 0, 0)"), &[a, b]);
        assert_close(&away("from: Axis(direction: (0, 2, 0))"), &[a.with_y(0.0), b.with_y(0.0)]);
        assert_close(&away("from: (0, 0, 0), along: (0, 0, 3)"), &[a, b].map(|away| away * DVec3::Z));
    }

    /// A single group in between is not a part.
    #[test]
    fn single_groups_stand_for_what_is_below() {
        let text = r#"(objects: {
            "all": (shape: Group, explode: (factor: 1)),
            "root": (shape: Group, parent: "all"),
            "a": (shape: Sphere(center: (-1, 0, 0)), parent: "root"),
            "b": (shape: Sphere(center: (1, 0, 0)), parent: "root"),
        })"#;
        let sequence = parse("test.ron", text).expect("a sequence");
        let moved = [1, 2, 3].map(|object| sequence.to_world(object, Time::from_integer(0)).translation);
        assert_eq!(moved, [DVec3::ZERO, DVec3::NEG_X, DVec3::X]);
    }
}
