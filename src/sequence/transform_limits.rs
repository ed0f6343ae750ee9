//! Checks that transforms stay within the range of the arithmetic. Chains of parents multiply their scales.

use super::fault::Fault;
use super::placement;
use super::source_file::File;
use super::suggest::shortened;
use super::values::{LARGEST, SHORTEST};
use super::{Named, Object};
use crate::base::math::{DAffine3, DVec3, is_flat};
use crate::base::time::{Time, Timeline};
use crate::geometry::transform::TransformTracks;
use crate::track::{Animate, Animated};
use std::ops::Range;

/// Places of an object's transform in the file.
#[derive(Clone, Default)]
pub struct TransformPlace {
    pub scale: Range<usize>,
    pub translation: Range<usize>,
}

/// Bound of an easing's overshoot, as a share of the distance between two keys. The curves of easings.net stay below
/// 2, and Bézier curves with sensible control points below 10.
const OVERSHOOT: f64 = 10.0;

/// Maximum number of individually checked transforms: one or two seconds. Only transforms near the limits are checked
/// individually.
const MAX_CHECKS: u64 = 1 << 21;

/// Bounds of a transform over all times: the smallest and the largest scale factor, and the largest distance that it
/// moves the origin.
#[derive(Clone, Copy)]
struct ScaleBounds {
    least: f64,
    most: f64,
    moved: f64,
}

impl ScaleBounds {
    const NONE: Self = Self { least: 1.0, most: 1.0, moved: 0.0 };

    fn of(tracks: &TransformTracks) -> Self {
        let (least, most) =
            range(&tracks.scale, |scale: &DVec3| (scale.abs().min_element(), scale.abs().max_element()));
        let (_, moved) = range(&tracks.translation, |by: &DVec3| (by.length(), by.length()));
        let exploded = tracks.explode.as_ref().map_or(0.0, |explode| {
            range(&explode.factor, |factor| (0.0, factor.abs())).1 * explode.offset.length()
        });
        Self { least, most, moved: moved + exploded + tracks.pivot.length() * (1.0 + most) }
    }

    /// The bounds of an object within its parent.
    fn within(self, parent: Self) -> Self {
        Self {
            least: self.least * parent.least,
            most: self.most * parent.most,
            moved: self.moved * parent.most + parent.moved,
        }
    }

    /// Whether the bounds alone prove that everything is in range.
    fn is_safe(self) -> bool {
        self.least >= SHORTEST && self.most <= LARGEST && self.moved <= LARGEST
    }
}

/// The smallest and the largest value. Excludes zero from the smallest, because keys may pass through zero to hide an
/// object.
fn range<T: Animate>(values: &Animated<T>, of: impl Fn(&T) -> (f64, f64)) -> (f64, f64) {
    match values {
        Animated::Constant(value) => of(value),
        Animated::Keyed(track) => {
            let each = || track.keys().iter().map(|key| of(&key.value));
            let least = each().map(|(least, _)| least).filter(|least| *least > 0.0);
            // Curves have no other easing. They may pass through anything within their overshoot.
            let beyond = track.overshoot(|tangent| of(tangent).1);
            (
                (least.fold(f64::INFINITY, f64::min) - beyond).max(0.0),
                OVERSHOOT * each().map(|(_, most)| most).fold(0.0, f64::max) + beyond,
            )
        }
    }
}

/// Reports each object that is out of range, with the first such frame. Skips objects whose parent is out of range.
pub fn report_out_of_range(
    file: &File<'_>,
    timeline: &Timeline,
    objects: &[Named<Object>],
    places: &[TransformPlace],
) {
    let chain = |index: usize| placement::chain(objects, index).map(|at| &objects[at].value);
    let mut out = vec![false; objects.len()];
    let mut left = MAX_CHECKS;
    for (index, span) in spans(objects) {
        let inherited = objects[index].value.parent.is_some_and(|parent| out[parent]);
        if inherited || span.is_safe() {
            out[index] = inherited;
            continue;
        }
        let wrong =
            |time: Time| Some((time, fault_of(chain(index).map(|object| object.transform.at(time)))?));
        let still = chain(index).all(|object| !object.transform.is_keyed());
        let frames = if still { 1 } else { timeline.frames };
        let checks = u64::from(frames).saturating_mul(chain(index).count() as u64);
        let Some(rest) = left.checked_sub(checks) else {
            file.push(too_near(&objects[index], frames, places.get(index).cloned().unwrap_or_default()));
            return;
        };
        left = rest;
        // Values are largest at keys. Keys may be between frames, but open shutters and other frame rates see them.
        let keys = chain(index).flat_map(|object| object.transform.key_times());
        let within = keys.filter(|time| *time > Time::from_integer(0) && *time < timeline.duration);
        let times = (0..frames).map(|frame| timeline.clock(frame).time).chain(within);
        if let Some((time, what)) = times.filter_map(wrong).min_by_key(|(time, _)| *time) {
            out[index] = true;
            let when = if still { String::new() } else { format!(" at frame {}", timeline.frame_at(time)) };
            let place = places.get(index).cloned().unwrap_or_default();
            file.push(fault(&objects[index], what, &when, place, time));
        }
    }
}

/// The fault of an object whose check would take too long.
fn too_near(object: &Named<Object>, frames: u32, place: TransformPlace) -> Fault {
    let name = shortened(&object.name);
    let title = format!("object `{name}` is scaled or moved too near to 1e-30 or 1e30 for {frames} frames");
    Fault::new(place.scale, title, "it would take too long to check every frame")
        .help("stay farther from these limits with `scale` and `translation` of the object and its parents")
}

/// Bounds of the product of each object's transform and those of its parents, parents first. Excludes objects with
/// cyclic parents, which are reported elsewhere.
fn spans(objects: &[Named<Object>]) -> Vec<(usize, ScaleBounds)> {
    let mut known: Vec<Option<ScaleBounds>> = vec![None; objects.len()];
    let mut visited = vec![false; objects.len()];
    let mut spans = Vec::with_capacity(objects.len());
    for start in 0..objects.len() {
        let mut way = Vec::new();
        let mut at = Some(start);
        while let Some(index) = at.filter(|&index| !visited[index]) {
            visited[index] = true;
            way.push(index);
            at = objects[index].value.parent;
        }
        // An object that is visited but has no bounds is on a cycle, or has a parent on one.
        let Some(mut span) = at.map_or(Some(ScaleBounds::NONE), |index| known[index]) else { continue };
        for index in way.into_iter().rev() {
            span = ScaleBounds::of(&objects[index].value.transform).within(span);
            known[index] = Some(span);
            spans.push((index, span));
        }
    }
    spans
}

#[derive(Clone, Copy)]
enum OutOfRange {
    Large,
    Far,
    Small,
}

/// Checks the product of these transforms, the object's own first.
fn fault_of(chain: impl Iterator<Item = DAffine3>) -> Option<OutOfRange> {
    let (mut world, mut hidden) = (DAffine3::IDENTITY, false);
    for local in chain {
        // A keyed scale of zero hides an object on purpose.
        hidden |= is_flat(&local);
        world = local * world;
    }
    // Overflow may also lead to NaN.
    let within = |v: DVec3| v.is_finite() && v.abs().max_element() <= LARGEST;
    let axes = world.matrix3.to_cols_array_2d().map(DVec3::from_array);
    if !axes.into_iter().all(within) {
        return Some(OutOfRange::Large);
    }
    if !within(world.translation) {
        return Some(OutOfRange::Far);
    }
    let short = axes.into_iter().any(|axis| axis.abs().max_element() < SHORTEST);
    ((short || is_flat(&world)) && !hidden).then_some(OutOfRange::Small)
}

fn fault(object: &Named<Object>, what: OutOfRange, when: &str, place: TransformPlace, time: Time) -> Fault {
    let name = shortened(&object.name);
    let with = if object.value.parent.is_some() { "combined with those of its parents, " } else { "" };
    let (title, field, span) = match what {
        OutOfRange::Large => ("is scaled beyond 1e30", "`scale`", place.scale),
        OutOfRange::Small => ("is scaled below 1e-30", "`scale`", place.scale),
        OutOfRange::Far => ("is moved beyond 1e30", "`translation`", place.translation),
    };
    let own = match what {
        OutOfRange::Far => object.value.transform.translation.at(time),
        OutOfRange::Large | OutOfRange::Small => object.value.transform.scale.at(time),
    };
    let DVec3 { x, y, z } = own;
    let label =
        format!("{with}{field} is out of range here; the object's own value is ({x:e}, {y:e}, {z:e})");
    Fault::new(span, format!("object `{name}` {title}{when}"), label)
        .help("scales of a parent multiply those of its children")
}
