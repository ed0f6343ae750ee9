//! Decodes axes, grids, triads and scales.

use super::anchor::world_anchor;
use super::common::{common, common_over, position, share};
use super::scene_names::SceneNames;
use crate::annotate::{
    Annotation, AnnotationKind, Axes, AxesBox, GridMark, MAX_LINES, PanelPlace, ScaleBar, Style, Triad,
};
use crate::base::color::Rgb;
use crate::base::math::{Aabb, DVec3};
use crate::sequence::fault::Fault;
use crate::sequence::fields::Fields;
use crate::sequence::node::Node;
use crate::sequence::values::{each, number, positive, switch, text, tuple, vector, whole, world_vector};
use crate::sequence::words::word;

const NAMES: [&str; 3] = ["x", "y", "z"];

/// Three texts.
fn titles(node: Node<'_>) -> Option<[String; 3]> {
    each(tuple(node, "three texts (\"x\", \"y\", \"z\")")?, text)
}

/// Axes around a box.
pub fn axes(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "`Axes`")?;
    let common = common(&mut fields);
    let of_object = fields.has("object");
    if of_object == (fields.has("min") || fields.has("max")) {
        let title = "axes stand around an `object`, or around a box from `min` to `max`";
        node.fault(Fault::new(
            node.head(),
            title,
            if of_object { "one too many" } else { "needs one of them" },
        ));
        return None;
    }
    let around = match of_object {
        true => fields.required("object", |node| scene.object(node)).map(AxesBox::Object),
        false => {
            let (min, max) = (fields.required("min", vector), fields.required("max", vector));
            let (min, max) = (min?, max?);
            if !min.cmple(max).all() {
                let fault = Fault::new(fields.place("max"), "`max` must not be below `min`", "below `min`");
                node.fault(fault.also(fields.place("min"), "`min` is here"));
                return None;
            }
            Some(AxesBox::Box(Aabb { min, max }))
        }
    };
    let titles = fields.or("titles", titles, NAMES.map(str::to_owned));
    let ticks = fields.or("ticks", whole(1..=50), 6u32);
    let edges = fields.or("edges", switch, true);
    fields.finish();
    let kind = Axes { around: around?, titles: titles?, ticks: ticks? as usize, edges: edges? };
    Some(common?.with(AnnotationKind::Axes(kind)))
}

/// Axes from a point.
pub fn origin(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "`Origin`")?;
    let common = common(&mut fields);
    let at = fields.or("at", world_anchor(scene), crate::annotate::Anchor::World(DVec3::ZERO.into()));
    let lengths =
        fields.or("lengths", |node| each(tuple(node, "three lengths (x, y, z)")?, positive), [1.0; 3]);
    let titles = fields.or("titles", titles, NAMES.map(str::to_owned));
    let ticks = fields.or("ticks", whole(1..=50), 4u32);
    fields.finish();
    let around = AxesBox::From(at?, DVec3::from_array(lengths?));
    let kind = Axes { around, titles: titles?, ticks: ticks? as usize, edges: false };
    Some(common?.with(AnnotationKind::Axes(kind)))
}

pub fn grid(node: Node<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "`Grid`")?;
    let style = Style { color: Rgb::splat(0.5).into(), line_width: 0.002, ..Style::default() };
    let common = common_over(&mut fields, style);
    let center = fields.or("center", world_vector, DVec3::ZERO);
    let flat = match node.file.up.get() {
        crate::base::math::UpAxis::Y => (DVec3::X, DVec3::Z),
        crate::base::math::UpAxis::Z => (DVec3::X, DVec3::Y),
    };
    let planes = [("XY", (DVec3::X, DVec3::Y)), ("XZ", (DVec3::X, DVec3::Z)), ("YZ", (DVec3::Y, DVec3::Z))];
    let sides = fields.or("plane", |node| word(node, "plane", &planes), flat);
    let size =
        fields.or("extent", |node| each(tuple(node, "two lengths (width, length)")?, positive), [10.0; 2]);
    let step = fields.or("step", positive, 1.0);
    let place = fields.place("step");
    fields.finish();
    if let (Some(size), Some(step)) = (size, step)
        && size.iter().any(|side| side / step > MAX_LINES)
    {
        let title = format!("a grid has at most {MAX_LINES} lines a side");
        let fault = Fault::new(place, title, "more lines than that");
        node.fault(fault.help("write a longer `step`, or a smaller `extent`"));
        return None;
    }
    let up = node.file.up.get();
    let (a, b) = sides?;
    let sides = [a, b].map(|side| up.to_y_up(side));
    Some(common?.with(AnnotationKind::Grid(GridMark { center: center?, sides, size: size?, step: step? })))
}

pub fn triad(node: Node<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "`Triad`")?;
    let common = common(&mut fields);
    let position = position(&mut fields, PanelPlace::BottomLeft);
    let length = fields.or("length", share, 0.07);
    fields.finish();
    let kind = Triad { position: position?, length: length? };
    Some(common?.with(AnnotationKind::Triad(kind)))
}

pub fn scale_bar(node: Node<'_>, scene: &SceneNames<'_>) -> Option<Annotation> {
    let mut fields = Fields::of(node, "`ScaleBar`")?;
    let common = common(&mut fields);
    let position = position(&mut fields, PanelPlace::BottomRight);
    let length = fields.optional("length", positive);
    let at = fields.optional("at", world_anchor(scene));
    let unit = fields.or("unit", text, String::new());
    fields.finish();
    let kind = ScaleBar { position: position?, length: length?, at: at?, unit: unit? };
    Some(common?.with(AnnotationKind::ScaleBar(kind)))
}

/// Two numbers, the first below the second.
pub fn range(node: Node<'_>) -> Option<[f64; 2]> {
    let range = each(tuple(node, "two numbers (lowest, highest)")?, number)?;
    if range[0] < range[1] {
        return Some(range);
    }
    node.expected("two numbers (lowest, highest), the first one below the second");
    None
}
