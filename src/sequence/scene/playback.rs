//! Decodes which animations of a scene play, and when.

use super::animation::Playback;
use crate::base::time::Time;
use crate::import::gltf::GltfScene;
use crate::sequence::fault::Fault;
use crate::sequence::fields::Fields;
use crate::sequence::keys::key_time;
use crate::sequence::node::Node;
use crate::sequence::suggest::listed;
use crate::sequence::values::{exact_above_zero, is_number, list, switch, text, whole};
use crate::sequence::words::{report_unknown, word};
use crate::track::Repeat;

/// More animations than messages name.
const MOST_NAMES: usize = 100;

/// The latest time of a key in seconds.
const LATEST: i128 = 1_000_000_000;

/// The slowest and the fastest speed, as the larger part of a fraction with 1.
const FASTEST: i128 = 1000;

/// The animations that play, as indices, and when.
pub struct Playing {
    pub animations: Vec<usize>,
    pub playback: Playback,
}

/// Decodes the fields about animations. `scene` is None if the file could not be read. Without `animation`, a file's only
/// animation plays.
pub fn playing(fields: &mut Fields<'_>, scene: Option<&GltfScene>) -> Option<Playing> {
    let names: Option<Vec<&str>> =
        scene.map(|scene| scene.animations.iter().map(|animation| animation.name.as_str()).collect());
    let place = fields.place("file");
    let chosen = fields.optional("animation", |node| chosen(node, names.as_deref()));
    let start = fields.or("start", key_time, Time::from_integer(0));
    let speed = fields.or("speed", speed, Time::from_integer(1));
    let repeat =
        fields.or("loop", |node| Some(if switch(node)? { Repeat::Loop } else { Repeat::Hold }), Repeat::Hold);
    let playback = Playback { start: start?, speed: speed?, repeat: repeat? };
    let animations = chosen?.unwrap_or_else(|| match names.as_deref() {
        Some([_]) => vec![0],
        Some(names @ [_, _, ..]) => {
            let note =
                format!("the scene stands still; its animations are {}; `animation` chooses", choices(names));
            fields.node().file.warn(place.start, note);
            Vec::new()
        }
        _ => Vec::new(),
    });
    let ends =
        scene.into_iter().flat_map(|scene| animations.iter().map(|index| scene.animations[*index].end));
    if ends.max().is_some_and(|end| playback.time(end) > Time::from_integer(LATEST)) {
        let title = "the animation ends too late";
        let fault = Fault::new(fields.place("speed"), title, "its keys would be after 1e9 seconds");
        fields.node().fault(fault);
        return None;
    }
    Some(Playing { animations, playback })
}

/// The names of animations. Those without a name, or with one that stands for another, have their numbers.
fn choices(names: &[&str]) -> String {
    let is_unique = |index: usize| !names[index].is_empty() && !names[..index].contains(&names[index]);
    let name = |index: usize| if is_unique(index) { names[index].to_owned() } else { index.to_string() };
    // Of long lists, a few names are shown.
    let shown: Vec<String> = (0..names.len().min(MOST_NAMES)).map(name).collect();
    listed(shown.iter().map(String::as_str).chain(names.iter().skip(MOST_NAMES).copied()))
}

/// A name or a number, a list of these, `All` or `Off`.
fn chosen(node: Node<'_>, names: Option<&[&str]>) -> Option<Vec<usize>> {
    if node.opens_with('[') {
        let lists = list(node, "names of animations", |node| one(node, names))?;
        return Some(lists.concat());
    }
    if node.is_text() || is_number(node) {
        return one(node, names);
    }
    if node.word().is_empty() {
        node.expected("the name of an animation in quotes, its number, a list of these, `All` or `Off`");
        return None;
    }
    let all = word(node, "choice of animations", &[("All", true), ("Off", false)])?;
    Some(if all { (0..names.map_or(0, <[_]>::len)).collect() } else { Vec::new() })
}

/// The animation of this name or number.
fn one(node: Node<'_>, names: Option<&[&str]>) -> Option<Vec<usize>> {
    if is_number(node) { numbered(node, names) } else { named(node, names) }
}

/// The animation of this number, counted from 0.
fn numbered(node: Node<'_>, names: Option<&[&str]>) -> Option<Vec<usize>> {
    // The faults of the file are already reported.
    let Some(names) = names else { return Some(Vec::new()) };
    let Some(last) = names.len().checked_sub(1) else {
        node.fault(Fault::new(node.span(), "the scene has no animations", "cannot play any"));
        return None;
    };
    Some(vec![whole(0..=u32::try_from(last).unwrap_or(u32::MAX))(node)? as usize])
}

/// The first animation of this name.
fn named(node: Node<'_>, names: Option<&[&str]>) -> Option<Vec<usize>> {
    let name = text(node)?;
    // The faults of the file are already reported.
    let Some(names) = names else { return Some(Vec::new()) };
    let found = names.iter().position(|known| *known == name);
    match found {
        None if names.is_empty() => {
            node.fault(Fault::new(node.span(), "the scene has no animations", "cannot play any"));
        }
        None => report_unknown(node, "animation", &name, names.iter().copied()),
        Some(_) => {}
    }
    found.map(|index| vec![index])
}

/// A speed above 0.
fn speed(node: Node<'_>) -> Option<Time> {
    let speed = exact_above_zero(node, 9)?;
    let (slowest, fastest) = (Time::new(1, FASTEST), Time::from_integer(FASTEST));
    if !(slowest..=fastest).contains(&speed) {
        node.expected("a speed from 0.001 to 1000");
        return None;
    }
    Some(speed)
}
