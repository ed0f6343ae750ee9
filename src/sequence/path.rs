//! Decodes `path`: the steps of a camera path.

use super::easing::path_ease;
use super::fault::Fault;
use super::fields::Fields;
use super::keys::keyed;
use super::node::Node;
use super::values::{
    angle, between, field_of_view, list, number, positive, switch, world_direction, world_vector,
};
use super::words::{Variants, variant};
use crate::base::math::DVec3;
use crate::camera::path::{Aim, Dolly, Keys, Orbit, SplinePath, Step, Zoom, ZoomBy};
use crate::track::{Animated, Ease, LogScale};

/// Maximum number of points of a spline, because the length of each segment is measured.
const MAX_POINTS: usize = 10_000;

/// A list of steps, or a single step.
pub fn path(node: Node<'_>) -> Option<Vec<Step>> {
    if node.opens_with('[') { list(node, "steps", step) } else { step(node).map(|step| vec![step]) }
}

fn step(node: Node<'_>) -> Option<Step> {
    let table: &Variants<'_, Step> =
        &[("Orbit", orbit), ("Zoom", zoom), ("Dolly", dolly), ("Keys", keys), ("Spline", spline)];
    variant(node, "path step", table)
}

/// The fields about the viewing direction, which every step has.
fn aim(fields: &mut Fields<'_>) -> Option<Aim> {
    let target = fields.optional("target", keyed(world_vector));
    let up = fields.optional("up", keyed(world_direction));
    let roll = fields.optional("roll", keyed(angle));
    Some(Aim { target: target?, up: up?, roll: roll? })
}

fn orbit(node: Node<'_>) -> Option<Step> {
    let mut fields = Fields::of(node, "`Orbit`")?;
    let aim = aim(&mut fields);
    let axis = fields.or("axis", world_direction, DVec3::Y);
    let radius = fields.optional("radius", keyed(positive));
    let elevation = fields.optional("elevation", keyed(angle));
    // An azimuth replaces the default turn.
    let turns = if fields.has("azimuth") { 0.0 } else { 1.0 };
    let azimuth = fields.optional("azimuth", keyed(angle));
    let turns = fields.or("turns", between(-1e6..=1e6), turns);
    let ease = fields.or("ease", path_ease, Ease::Linear);
    fields.finish();
    Some(Step::Orbit(Orbit {
        aim: aim?,
        axis: axis?,
        radius: radius?,
        elevation: elevation?,
        azimuth: azimuth?,
        turns: turns?,
        ease: ease?,
    }))
}

fn zoom(node: Node<'_>) -> Option<Step> {
    let mut fields = Fields::of(node, "`Zoom`")?;
    let aim = aim(&mut fields);
    let given: Vec<_> = ["fov", "factor", "distance"].into_iter().filter(|name| fields.has(name)).collect();
    match given[..] {
        [_] => {}
        [] => {
            let title = "`Zoom` needs one of `fov`, `factor` and `distance`";
            node.fault(Fault::new(node.head(), title, "does not say what to zoom"));
        }
        [first, .., last] => {
            let title = "`Zoom` takes only one of `fov`, `factor` and `distance`";
            let fault = Fault::new(fields.place(last), title, "one too many");
            node.fault(fault.also(fields.place(first), "the zoom is already given here"));
        }
    }
    let fov =
        fields.optional("fov", keyed(|node| field_of_view(node).map(|fov| LogScale(fov.half_tangent()))));
    let scale = |node| positive(node).map(LogScale);
    let factor = fields.optional("factor", keyed(scale));
    let distance = fields.optional("distance", keyed(scale));
    fields.finish();
    let by = match (fov?, factor?, distance?) {
        (Some(tangent), None, None) => ZoomBy::HalfTangent(tangent),
        (None, Some(factor), None) => ZoomBy::Factor(factor),
        (None, None, Some(distance)) => ZoomBy::Distance(distance),
        _ => return None,
    };
    Some(Step::Zoom(Zoom { aim: aim?, by }))
}

fn dolly(node: Node<'_>) -> Option<Step> {
    let mut fields = Fields::of(node, "`Dolly`")?;
    let aim = aim(&mut fields);
    let [forward, right, upward]: [Option<Animated<f64>>; 3] =
        ["forward", "right", "upward"].map(|name| fields.or(name, keyed(number), 0.0));
    fields.finish();
    Some(Step::Dolly(Dolly { aim: aim?, forward: forward?, right: right?, upward: upward? }))
}

fn keys(node: Node<'_>) -> Option<Step> {
    let mut fields = Fields::of(node, "`Keys`")?;
    let aim = aim(&mut fields);
    let position = fields.optional("position", keyed(world_vector));
    fields.finish();
    Some(Step::Keys(Keys { aim: aim?, position: position? }))
}

fn spline(node: Node<'_>) -> Option<Step> {
    let mut fields = Fields::of(node, "`Spline`")?;
    let aim = aim(&mut fields);
    let mut place = node;
    let points = fields.required("points", |node| {
        place = node;
        list(node, "points (x, y, z)", world_vector)
    });
    let closed = fields.or("closed", switch, false);
    let look_ahead = fields.or("look_ahead", switch, false);
    let ease = fields.or("ease", path_ease, Ease::Linear);
    fields.finish();
    let points = points?;
    if points.len() > MAX_POINTS {
        let label = format!("has {} points, but {MAX_POINTS} are the most", points.len());
        place.fault(Fault::new(place.head(), "this spline has too many points", label));
        return None;
    }
    let path = SplinePath::new(points, closed?, aim?, ease?, look_ahead?);
    if path.is_none() {
        let label = "needs at least two different points";
        place.fault(Fault::new(place.span(), "this spline leads nowhere", label));
    }
    path.map(Step::Spline)
}
