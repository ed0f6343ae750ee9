//! Animations: keys of nodes' places and visibility, and of lights.
//!
//! Sources: glTF 2.0 specification, sections 3.11 and C, and the extension `KHR_animation_pointer`.

use super::GltfResult;
use super::accessor::{Accessor, Number};
use super::buffers::Buffers;
use super::features::LeftOut;
use super::json::Item;
use super::key_time::exact_time;
use super::light::LIGHTS;
use super::mesh::morph_targets;
use crate::base::escape;
use crate::base::lists::shortened;
use crate::base::machine;
use crate::base::math::{DQuat, unit_quaternion};
use crate::base::time::Time;
use std::collections::HashMap;
use std::sync::Arc;

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
    pub times: Arc<[Time]>,
    /// The number of numbers per value.
    pub width: usize,
    /// One value per key. With cubic splines three: the incoming tangent, the value, and the outgoing tangent.
    pub values: Arc<[f64]>,
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
    /// The rotation of a key; none if it is zero, or if the values are no rotations.
    pub fn rotation(&self, key: usize) -> Option<DQuat> {
        unit_quaternion(self.value(key, 1).try_into().ok()?)
    }

    /// The numbers of the value of a key, or of its incoming (0) or outgoing (2) tangent.
    pub fn value(&self, key: usize, part: usize) -> &[f64] {
        let at = match self.interpolation {
            Interpolation::Cubic => 3 * key + part,
            _ => key,
        };
        self.values.get(at * self.width..(at + 1) * self.width).unwrap_or_default()
    }
}

/// The memory in bytes that a key and each of its numbers take as a part of a track.
const KEY_SIZE: u64 = 64;
const NUMBER_SIZE: u64 = 16;

/// Memory is checked whenever this many bytes more are needed.
const CHECK_STEP: u64 = 16 << 20;

/// Reads all animations.
pub fn animations(
    root: &Item<'_>,
    buffers: &Buffers<'_>,
    left_out: &mut LeftOut,
) -> GltfResult<Vec<GltfAnimation>> {
    let mut reader =
        Reader { root, buffers, times: HashMap::new(), values: HashMap::new(), size: 0, checked: 0 };
    root.list("animations")?.iter().map(|item| animation(&mut reader, item, left_out)).collect()
}

/// Reads channels. Many of them may name the same few accessors.
struct Reader<'a> {
    root: &'a Item<'a>,
    buffers: &'a Buffers<'a>,
    /// The times and the values of accessors by their indices. Values of another width are an error.
    times: HashMap<usize, Arc<[Time]>>,
    values: HashMap<(usize, usize), Arc<[f64]>>,
    /// The memory in bytes of all keys so far, when each channel has become a track.
    size: u64,
    /// The size at which memory is checked next.
    checked: u64,
}

fn animation(reader: &mut Reader<'_>, item: &Item<'_>, left_out: &mut LeftOut) -> GltfResult<GltfAnimation> {
    let root = reader.root;
    let samplers = item.list("samplers")?;
    let mut channels = Vec::new();
    let mut end = Time::from_integer(0);
    for part in item.list("channels")? {
        let index = part.index("sampler", ("samplers", samplers.len()))?;
        let index = index.ok_or_else(|| part.error("it has no `sampler`"))?;
        let Some(target) = target(root, &part.required("target")?, left_out)? else { continue };
        let Some(target) = with_morph_targets(root, target, left_out)? else { continue };
        let channel = reader.channel(&samplers[index], target)?;
        end = channel.times.last().map_or(end, |last| end.max(*last));
        channels.push(channel);
    }
    Ok(GltfAnimation { name: item.name()?, channels, end })
}

/// The property of a channel; none if Kinora has no such property, which is noted, or if the channel has no target.
fn target(root: &Item<'_>, item: &Item<'_>, left_out: &mut LeftOut) -> GltfResult<Option<GltfTarget>> {
    let path = item.text("path")?.ok_or_else(|| item.error("it has no `path`"))?;
    if path == "pointer" {
        let pointer = item.extension("KHR_animation_pointer")?;
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
        left_out.note(format!("the animation of `{}`", cleaned(path)), "channel");
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
    let lights = root.extension(LIGHTS)?.map_or(0, |lights| lights.len_of("lights"));
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
        left_out.note(format!("the animation of `{}`", cleaned(pointer)), "channel");
    }
    Ok(target)
}

/// A name of the file for messages.
fn cleaned(name: &str) -> String {
    escape::line(&shortened(name)).into_owned()
}

/// A property, with the number of numbers per value. None for the weights of a mesh without morph targets, which is
/// noted.
fn with_morph_targets(
    root: &Item<'_>,
    target: GltfTarget,
    left_out: &mut LeftOut,
) -> GltfResult<Option<(GltfTarget, usize)>> {
    if let Some(width) = target.width() {
        return Ok(Some((target, width)));
    }
    let GltfTarget::Weights(node) = target else { return Ok(None) };
    let mesh = root.entry("nodes", node)?.index("mesh", ("meshes", root.len_of("meshes")))?;
    let targets = match mesh {
        Some(mesh) => morph_targets(&root.entry("meshes", mesh)?)?,
        None => 0,
    };
    if targets == 0 {
        left_out.note("the animation of weights without morph targets", "channel");
    }
    Ok((targets > 0).then_some((target, targets)))
}

impl Reader<'_> {
    fn channel(&mut self, item: &Item<'_>, (target, width): (GltfTarget, usize)) -> GltfResult<GltfChannel> {
        let interpolation = match item.text("interpolation")? {
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::Cubic,
            Some(_) => return Err(item.error("its `interpolation` is none of LINEAR, STEP and CUBICSPLINE")),
        };
        let times = self.times(item)?;
        let per_key = if interpolation == Interpolation::Cubic { 3 } else { 1 };
        let numbers = (times.len() * per_key).saturating_mul(width);
        self.size = self.size.saturating_add(
            (times.len() as u64).saturating_mul(KEY_SIZE).saturating_add(numbers as u64 * NUMBER_SIZE),
        );
        // Reading the free memory takes longer than most channels.
        if self.size >= self.checked {
            machine::check_memory(self.size)?;
            self.checked = self.size + CHECK_STEP;
        }
        let values = self.values(item, target, (times.len(), numbers))?;
        // Visibility only steps. Values of another interpolation hold as well.
        let interpolation = match target {
            GltfTarget::Visible(_) if interpolation == Interpolation::Linear => Interpolation::Step,
            _ => interpolation,
        };
        let channel = GltfChannel { target, interpolation, times, width, values };
        if matches!(target, GltfTarget::Rotation(_))
            && let Some(key) = (0..channel.times.len()).find(|key| channel.rotation(*key).is_none())
        {
            return Err(item.error(format!("the rotation of its key {key} is zero, which is no rotation")));
        }
        Ok(channel)
    }

    /// The accessor that a member of a sampler names, and its index.
    fn accessor(&self, item: &Item<'_>, key: &str) -> GltfResult<(usize, Accessor<'_>)> {
        let index = item.index(key, ("accessors", self.root.len_of("accessors")))?;
        let index = index.ok_or_else(|| item.error(format!("it has no `{key}`")))?;
        Ok((index, Accessor::new(self.root, self.buffers, index)?))
    }

    fn times(&mut self, item: &Item<'_>) -> GltfResult<Arc<[Time]>> {
        let (index, input) = self.accessor(item, "input")?;
        if let Some(known) = self.times.get(&index) {
            return Ok(Arc::clone(known));
        }
        let times: Arc<[Time]> = times(item, &input)?.into();
        self.times.insert(index, Arc::clone(&times));
        Ok(times)
    }

    /// The values of a number of keys, which have so many numbers together.
    fn values(
        &mut self,
        item: &Item<'_>,
        target: GltfTarget,
        (keys, numbers): (usize, usize),
    ) -> GltfResult<Arc<[f64]>> {
        let (index, output) = self.accessor(item, "output")?;
        // All weights of a key are one value, of numbers that are elements of their own.
        let part = target.width().unwrap_or(1);
        let needed = numbers / part;
        if output.count != needed {
            let why = format!("its {keys} keys need {needed} values, not {}", output.count);
            return Err(item.error(why));
        }
        if let Some(known) = self.values.get(&(index, part)) {
            return Ok(Arc::clone(known));
        }
        let values: Arc<[f64]> = match part {
            1 => output.elements::<1>()?.into_flattened().into(),
            3 => output.elements::<3>()?.into_flattened().into(),
            _ => output.elements::<4>()?.into_flattened().into(),
        };
        self.values.insert((index, part), Arc::clone(&values));
        Ok(values)
    }
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
