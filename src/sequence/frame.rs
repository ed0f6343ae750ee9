//! Decodes `frame` and `margin` of a camera: what the picture shows, instead of where the camera stands.

use super::camera::ObjectNames;
use super::fault::Fault;
use super::fields::Fields;
use super::node::{Node, NodeContent};
use super::values::{list, margin};
use crate::camera::path::{Aim, Dolly, Frame, Framed, Keys, Orbit, Step, Zoom, ZoomBy};

/// The margin of cameras that give none.
const MARGIN: f64 = 0.1;

/// Decodes the fields, and refuses a path that moves the camera to a place of its own.
pub fn frame(
    fields: &mut Fields<'_>,
    objects: Option<&ObjectNames<'_>>,
    path: &[Step],
) -> Option<Option<Frame>> {
    let place = fields.place("frame");
    let framed = fields.optional("frame", |node| {
        let framed = framed(node, objects)?;
        refuse_nothing(node, &framed, objects)?;
        Some(framed)
    });
    let margin = fields.optional("margin", margin);
    let (framed, margin) = (framed?, margin?);
    let Some(framed) = framed else {
        if margin.is_some() {
            let title = "`margin` belongs to `frame`";
            let fault = Fault::new(fields.place("margin"), title, "this camera frames nothing");
            fields.node().fault(fault.help("write `frame: All`, or the names of objects"));
            return None;
        }
        return Some(None);
    };
    if let Some(what) = path.iter().find_map(own_place) {
        let title = "`frame` finds where the camera stands, but its path moves it elsewhere";
        let fault = Fault::new(fields.place("path"), title, format!("{what} here"));
        fields.node().fault(fault.also(place, "the camera is fitted to this"));
        return None;
    }
    Some(Some(Frame { objects: framed, margin: margin.unwrap_or(MARGIN), fit: None }))
}

/// `All`, the name of an object, or a list of names.
fn framed(node: Node<'_>, objects: Option<&ObjectNames<'_>>) -> Option<Framed> {
    // The faults of the objects are already reported.
    let index = |node: Node<'_>| objects.map_or(Some(0), |objects| objects.names.index(node));
    node.ask_words("choice of objects", ["All"]);
    match node.content()? {
        NodeContent::List(_) if node.word().is_empty() => list(node, "names", index).map(Framed::Listed),
        _ if node.is_text() => index(node).map(|index| Framed::Listed(vec![index])),
        _ if node.bare_word() == Some("All") => Some(Framed::All),
        _ => {
            node.expected("`All`, the name of an object in quotes, or a list of names");
            None
        }
    }
}

/// Refuses objects none of which has bounds.
fn refuse_nothing(node: Node<'_>, framed: &Framed, objects: Option<&ObjectNames<'_>>) -> Option<()> {
    let Some(ObjectNames { objects, .. }) = objects else { return Some(()) };
    if !super::framing::framed(objects, framed).is_empty() {
        return Some(());
    }
    let fault = Fault::new(node.span(), "there is nothing to frame", "no shape with a size");
    node.fault(fault.help("planes are infinite, and a group needs objects that name it as their parent"));
    None
}

/// What a step says about the camera's place.
fn own_place(step: &Step) -> Option<&'static str> {
    let aims = |aim: &Aim, what| aim.target.is_some().then_some(what);
    match step {
        Step::Orbit(Orbit { radius: Some(_), .. }) => Some("`Orbit` has a `radius`"),
        Step::Orbit(Orbit { aim, .. }) => aims(aim, "`Orbit` has a `target`"),
        Step::Zoom(Zoom { by: ZoomBy::Distance(_), .. }) => Some("`Zoom` has a `distance`"),
        Step::Zoom(Zoom { aim, .. }) => aims(aim, "`Zoom` has a `target`"),
        Step::Dolly(Dolly { aim, .. }) => aims(aim, "`Dolly` has a `target`"),
        Step::Keys(Keys { position: Some(_), .. }) => Some("`Keys` has a `position`"),
        Step::Keys(Keys { aim, .. }) => aims(aim, "`Keys` has a `target`"),
        Step::Spline(_) => Some("`Spline` gives positions"),
        Step::Poses(_) => Some("the poses give positions"),
        Step::Carried(_) => Some("an object carries the camera"),
    }
}
