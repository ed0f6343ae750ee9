//! Animations: keys of nodes' places and visibility, and of lights.
//!
//! Sources: glTF 2.0 specification, sections 3.11 and C, and the extension `KHR_animation_pointer`.

use super::GltfResult;
use super::accessor::{Accessor, Number};
use super::buffers::Buffers;
use super::features::LeftOut;
use super::json::Item;
use super::key_time::exact_time;
use crate::base::lists::shortened;
use crate::base::time::Time;

/// An animation. Its time begins at 0.
#[derive(Clone, Debug, PartialEq)]
pub struct GltfAnimation {
    /// Empty if it has none.
    pub name: String,
    pub channels: Vec<GltfChannel>,
    /// The time of its last key.
    pub end: Time,
}

/// The keys of one property.
#[derive(Clone, Debug, PartialEq)]
pub struct GltfChannel {
    pub target: GltfTarget,
    pub interpolation: Interpolation,
    /// Ascending; at least one.
    pub times: Vec<Time>,
    /// The number of numbers per value.
    pub width: usize,
    /// One value per key. With cubic splines three: the incoming tangent, the value, and the outgoing tangent.
    pub values: Vec<f64>,
}

/// A property, with the index of its node or light in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GltfTarget {
    Translation(usize),
    Rotation(usize),
    Scale(usize),
    Visible(usize),
    LightIntensity(usize),
    LightColor(usize),
    /// The weights of the morph targets of a node's mesh.
    Weights(usize),
}

/// How values change between keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    Step,
    Linear,
    Cubic,
}

impl GltfTarget {
    /// The number of numbers per value; none for weights, whose number is that of the morph targets.
    fn width(self) -> Option<usize> {
        match self {
            Self::Translation(_) | Self::Scale(_) | Self::LightColor(_) => Some(3),
            Self::Rotation(_) => Some(4),
            Self::Visible(_) | Self::LightIntensity(_) => Some(1),
            Self::Weights(_) => None,
        }
    }
}

impl GltfChannel {
    /// The numbers of the value of a key, or of its incoming (0) or outgoing (2) tangent.
    pub fn value(&self, key: usize, part: usize) -> &[f64] {
        let at = match self.interpolation {
            Interpolation::Cubic => 3 * key + part,
            _ => key,
        };
        self.values.get(at * self.width..(at + 1) * self.width).unwrap_or_default()
    }
}

/// Reads all animations.
pub fn animations(
    root: &Item<'_>,
    buffers: &Buffers<'_>,
    left_out: &mut LeftOut,
) -> GltfResult<Vec<GltfAnimation>> {
    root.list("animations")?.iter().map(|item| animation(root, item, buffers, left_out)).collect()
}

fn animation(
    root: &Item<'_>,
    item: &Item<'_>,
    buffers: &Buffers<'_>,
    left_out: &mut LeftOut,
) -> GltfResult<GltfAnimation> {
    let samplers = item.list("samplers")?;
    let mut channels = Vec::new();
    let mut end = Time::from_integer(0);
    for part in item.list("channels")? {
        let index = part.index("sampler", ("samplers", samplers.len()))?;
        let index = index.ok_or_else(|| part.error("it has no `sampler`"))?;
        let Some(target) = target(root, &part.required("target")?, left_out)? else { continue };
        let channel = channel(root, &samplers[index], buffers, target)?;
        end = channel.times.last().map_or(end, |last| end.max(*last));
        channels.push(channel);
    }
    Ok(GltfAnimation { name: item.name()?, channels, end })
}

/// The property of a channel; none if Kinora has no such property, which is noted, or if the channel has no target.
fn target(root: &Item<'_>, item: &Item<'_>, left_out: &mut LeftOut) -> GltfResult<Option<GltfTarget>> {
    let path = item.text("path")?.ok_or_else(|| item.error("it has no `path`"))?;
    if path == "pointer" {
        let pointer = item.extension("KHR_animation_pointer");
        let pointer = match &pointer {
            Some(pointer) => pointer.text("pointer")?,
            None => None,
        };
        let pointer = pointer.ok_or_else(|| item.error("it has no `KHR_animation_pointer`"))?;
        return pointed(root, item, pointer, left_out);
    }
    // Without a node, the channel has no effect.
    let Some(node) = item.index("node", ("nodes", root.len_of("nodes")))? else { return Ok(None) };
    let target = of_node(path, node);
    if target.is_none() {
        left_out.note(format!("the animation of {}", shortened(path)), "channel");
    }
    Ok(target)
}

fn of_node(path: &str, node: usize) -> Option<GltfTarget> {
    match path {
        "translation" => Some(GltfTarget::Translation(node)),
        "rotation" => Some(GltfTarget::Rotation(node)),
        "scale" => Some(GltfTarget::Scale(node)),
        "weights" => Some(GltfTarget::Weights(node)),
        "extensions/KHR_node_visibility/visible" => Some(GltfTarget::Visible(node)),
        _ => None,
    }
}

/// The property at a JSON pointer (RFC 6901).
fn pointed(
    root: &Item<'_>,
    item: &Item<'_>,
    pointer: &str,
    left_out: &mut LeftOut,
) -> GltfResult<Option<GltfTarget>> {
    let indexed = |list: &str, count: usize| {
        let (index, rest) = pointer.strip_prefix(list)?.split_once('/')?;
        let index: usize = index.parse().ok()?;
        Some((index, rest, index < count))
    };
    let lights = root.extension("KHR_lights_punctual").map_or(0, |lights| lights.len_of("lights"));
    let node = indexed("/nodes/", root.len_of("nodes"));
    let light = indexed("/extensions/KHR_lights_punctual/lights/", lights);
    if let Some((index, _, false)) = node.or(light) {
        return Err(item.error(format!("its pointer names the entry {index} of a list that is shorter")));
    }
    let of_light = light.and_then(|(index, rest, _)| match rest {
        "intensity" => Some(GltfTarget::LightIntensity(index)),
        "color" => Some(GltfTarget::LightColor(index)),
        _ => None,
    });
    let target = node.and_then(|(index, rest, _)| of_node(rest, index)).or(of_light);
    if target.is_none() {
        let name = pointer.rsplit('/').next().unwrap_or(pointer);
        left_out.note(format!("the animation of {}", shortened(name)), "channel");
    }
    Ok(target)
}

fn channel(
    root: &Item<'_>,
    item: &Item<'_>,
    buffers: &Buffers<'_>,
    target: GltfTarget,
) -> GltfResult<GltfChannel> {
    let interpolation = match item.text("interpolation")? {
        None | Some("LINEAR") => Interpolation::Linear,
        Some("STEP") => Interpolation::Step,
        Some("CUBICSPLINE") => Interpolation::Cubic,
        Some(_) => return Err(item.error("its `interpolation` is none of LINEAR, STEP and CUBICSPLINE")),
    };
    let accessors = ("accessors", root.len_of("accessors"));
    let accessor = |key: &str| {
        let index = item.index(key, accessors)?.ok_or_else(|| item.error(format!("it has no `{key}`")))?;
        Accessor::new(root, buffers, index)
    };
    let (input, output) = (accessor("input")?, accessor("output")?);
    let times = times(item, &input)?;
    let per_key = if interpolation == Interpolation::Cubic { 3 } else { 1 };
    let values = times.len() * per_key;
    // All weights of a key are one value, of numbers that are elements of their own.
    let (width, elements) = match target.width() {
        Some(width) => (width, values),
        None => (output.count / values, output.count / values * values),
    };
    if output.count != elements || width == 0 {
        let why = format!("its {} keys need {values} values, not {}", times.len(), output.count);
        return Err(item.error(why));
    }
    let values = match target.width().unwrap_or(1) {
        1 => output.elements::<1>()?.into_flattened(),
        3 => output.elements::<3>()?.into_flattened(),
        _ => output.elements::<4>()?.into_flattened(),
    };
    // Visibility only steps. Values of another interpolation hold as well.
    let interpolation = match target {
        GltfTarget::Visible(_) if interpolation == Interpolation::Linear => Interpolation::Step,
        _ => interpolation,
    };
    Ok(GltfChannel { target, interpolation, times, width, values })
}

/// Times that ascend from 0 or later on.
fn times(item: &Item<'_>, accessor: &Accessor<'_>) -> GltfResult<Vec<Time>> {
    if accessor.layout() != (Number::F32, false, 1) {
        return Err(item.error("the times of its keys are no floats"));
    }
    let seconds = accessor.elements::<1>()?.into_flattened();
    let time = |seconds: &f64| exact_time(*seconds as f32);
    let times: Option<Vec<Time>> = seconds.iter().map(time).collect();
    let Some(times) = times.filter(|times| !times.is_empty()) else {
        return Err(item.error("it needs keys at times from 0 to 1e9 seconds"));
    };
    match times.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(at) => Err(item.error(format!("the time of its key {} is not after the one before", at + 1))),
        None => Ok(times),
    }
}
