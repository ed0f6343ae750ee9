//! Decodes animated values: a constant, a list of keys, or a `Track` of keys with settings.

use super::decimal::exact;
use super::easing::ease;
use super::fault::Fault;
use super::fields::Fields;
use super::key_clock::KeyClock;
use super::node::{Node, NodeContent};
use super::schema::{Ask, KEY};
use super::source_file::Form;
use super::values::{exact_or_rounded, switch};
use super::words::word;
use crate::base::time::Time;
use crate::track::{Animate, Animated, Ease, Key, Modes, Repeat, Track};

/// Limits of key times: the absolute value in seconds or frames, and the number of decimal places. Within them,
/// differences and quotients of times fit into an `i128`.
const LARGEST_TIME: i128 = 1_000_000_000;
const TIME_PLACES: u32 = 9;

/// Turns a decoder for a constant into one for an animated value.
pub fn keyed<'s, T: Animate>(
    value: impl Fn(Node<'s>) -> Option<T>,
) -> impl Fn(Node<'s>) -> Option<Animated<T>> {
    move |node| animated(node, &value)
}

fn animated<'s, T: Animate>(node: Node<'s>, value: &impl Fn(Node<'s>) -> Option<T>) -> Option<Animated<T>> {
    if node.opens_with('[') {
        let keys = read_keys(node, value, default_ease::<T>())?;
        return track(node, keys, Repeat::Hold, false);
    }
    if !node.begins_with("Track") {
        return value(node).map(Animated::Constant);
    }
    let mut fields = Fields::of(node, "`Track`")?.unnamed();
    // First, because keys without an easing use this one.
    let ease = fields.or("ease", key_ease::<T>, default_ease::<T>());
    let mut list = None;
    let keys = fields.required("keys", |node| {
        list = Some(node);
        read_keys(node, value, ease.unwrap_or_default())
    });
    let repeat = fields.or("repeat", repeat, Repeat::Hold);
    let closed = fields.or("closed", switch, false);
    fields.finish();
    let (keys, _) = (keys?, ease?);
    track(list?, keys, repeat?, closed?)
}

/// What a track does outside its keys.
pub fn repeat(node: Node<'_>) -> Option<Repeat> {
    let repeats = [("Hold", Repeat::Hold), ("Loop", Repeat::Loop), ("PingPong", Repeat::PingPong)];
    word(node, "repeat", &repeats)
}

/// The parts of a key that could be decoded, with their places.
struct ReadKey<'s, T> {
    time: Option<(Time, Node<'s>)>,
    value: Option<(T, Node<'s>)>,
    ease: Option<Ease>,
}

/// Keys in order, and the place of the last value.
struct KeyList<'s, T> {
    keys: Vec<Key<T>>,
    last_value: Node<'s>,
}

fn read_keys<'s, T: Animate>(
    node: Node<'s>,
    value: &impl Fn(Node<'s>) -> Option<T>,
    ease: Ease,
) -> Option<KeyList<'s, T>> {
    node.note_form(Form::List);
    node.ask(|| Ask::Keys);
    let items = match node.content()? {
        NodeContent::List(items) if node.word().is_empty() => items,
        NodeContent::Tuple(items) if node.file.is_json && node.word().is_empty() => items,
        _ => {
            node.expected("a list of keys [(time, value), ...]");
            return None;
        }
    };
    if items.is_empty() {
        node.fault(Fault::new(node.span(), "there are no keys", "needs at least one key (time, value)"));
        return None;
    }
    if items.iter().all(|item| !item.opens_with('(')) {
        let help = "[ ] holds keys; write a constant alone, or in ( ) if it has several parts";
        node.fault(node.mismatch("keys [(time, value), ...]").help(help));
        return None;
    }
    let keys: Vec<_> = items.into_iter().map(|item| read_key(item, value, ease)).collect();
    let times = keys.iter().flatten().filter_map(|key| key.time);
    let sorted = report_unsorted(times);
    let mut last_value = node;
    let mut all = Vec::with_capacity(keys.len());
    for key in keys {
        let ReadKey { time: Some((time, _)), value: Some((value, at)), ease: Some(ease) } = key? else {
            return None;
        };
        last_value = at;
        all.push(Key { time, value, ease });
    }
    sorted.then_some(KeyList { keys: all, last_value })
}

/// Decodes `(t, v)`, `(t, v, Ease)` or `(t: .., v: .., ease: ..)`. None if the value has another form.
fn read_key<'s, T: Animate>(
    node: Node<'s>,
    value: &impl Fn(Node<'s>) -> Option<T>,
    default: Ease,
) -> Option<ReadKey<'s, T>> {
    let timed = |node: Node<'s>| key_time(node).map(|time| (time, node));
    let valued = |node: Node<'s>| value(node).map(|value| (value, node));
    let content = if node.word().is_empty() { node.content()? } else { NodeContent::Plain };
    if let NodeContent::Fields(_) = content {
        let mut fields = Fields::of(node, "a key")?.unnamed();
        let (time, value) = (fields.required("t", timed), fields.required("v", valued));
        let ease = fields.or("ease", key_ease::<T>, default);
        fields.finish();
        return Some(ReadKey { time, value, ease });
    }
    if let NodeContent::Tuple(items) = content {
        let count = items.len();
        match items[..] {
            [_, _] | [_, _, _] => node.ask(|| Ask::Tuple { what: KEY.to_owned(), count }),
            _ => {}
        }
        match items[..] {
            [t, v] => return Some(ReadKey { time: timed(t), value: valued(v), ease: Some(default) }),
            [t, v, ease] => {
                return Some(ReadKey { time: timed(t), value: valued(v), ease: key_ease::<T>(ease) });
            }
            _ => {}
        }
    }
    node.expected("a key (time, value) or (time, value, easing)");
    None
}

/// Whether the times ascend. Reports each time that does not.
pub fn report_unsorted<'s>(times: impl Iterator<Item = (Time, Node<'s>)>) -> bool {
    let (mut sorted, mut before): (bool, Option<(Time, Node<'s>)>) = (true, None);
    for (time, node) in times {
        if let Some((earlier, other)) = before.filter(|(earlier, _)| time <= *earlier) {
            sorted = false;
            let fault = if time == earlier {
                Fault::new(node.span(), "two keys at the same time", "this time has a key already")
                    .also(other.span(), "the first one is here")
            } else {
                let label = format!("this is before {}", other.text());
                Fault::new(node.span(), "keys must be in order of time", label)
                    .also(other.span(), "the key before it is here")
            };
            node.fault(fault);
        } else {
            before = Some((time, node));
        }
    }
    sorted
}

/// A key's time in seconds.
pub fn key_time(node: Node<'_>) -> Option<Time> {
    let time = exact_or_rounded(node, TIME_PLACES)?;
    if !is_allowed(time) {
        node.expected("a time between -1e9 and 1e9");
        return None;
    }
    Some(in_seconds(time, node.file.clock.get()))
}

/// A time between two keys in seconds, above 0.
pub fn interval(node: Node<'_>) -> Option<Time> {
    let time = exact_or_rounded(node, TIME_PLACES)?;
    if !is_allowed(time) || time <= Time::from_integer(0) {
        node.expected("a time above 0 and up to 1e9");
        return None;
    }
    Some(in_seconds(time, node.file.clock.get()))
}

/// The time of a row of a table, rounded to 9 decimal places, which decimals with fewer places keep. None beyond the
/// limits of key times.
pub fn row_time(value: f64, clock: KeyClock) -> Option<Time> {
    let time = exact(&format!("{value:.*}", TIME_PLACES as usize), TIME_PLACES).ok()?;
    is_allowed(time).then(|| in_seconds(time, clock))
}

/// Keys of numbers times a factor.
pub fn scaled(values: Animated<f64>, factor: f64) -> Animated<f64> {
    match values {
        Animated::Constant(value) => (value * factor).into(),
        Animated::Keyed(track) => Animated::Keyed(track.map(|key| Key { value: key.value * factor, ..key })),
    }
}

fn is_allowed(time: Time) -> bool {
    let limit = Time::from_integer(LARGEST_TIME);
    (-limit..=limit).contains(&time)
}

fn in_seconds(time: Time, clock: KeyClock) -> Time {
    match clock {
        KeyClock::Seconds => time,
        KeyClock::Frames(rate) => time / rate.per_second(),
    }
}

fn default_ease<T: Animate>() -> Ease {
    if T::MODES == Modes::Step { Ease::Step } else { Ease::Linear }
}

/// Decodes an easing that this type of value supports.
fn key_ease<T: Animate>(node: Node<'_>) -> Option<Ease> {
    let ease = ease(node)?;
    if T::MODES == Modes::Step && ease != Ease::Step {
        let help = "booleans and names change only at their keys; omit the easing";
        node.fault(node.mismatch("`Step` or no easing").help(help));
        return None;
    }
    if T::MODES == Modes::Ease && ease == Ease::CatmullRom {
        let help = "rotations and zooms ease from key to key, but follow no spline";
        node.fault(node.mismatch("an easing other than `CatmullRom`").help(help));
        return None;
    }
    Some(ease)
}

fn track<T: Animate>(
    node: Node<'_>,
    keys: KeyList<'_, T>,
    repeat: Repeat,
    closed: bool,
) -> Option<Animated<T>> {
    let KeyList { keys, last_value } = keys;
    if closed && keys.first().map(|key| &key.value) != keys.last().map(|key| &key.value) {
        let title = "the last key of a closed track must repeat the first one's value";
        node.fault(Fault::new(last_value.span(), title, "differs from the first value"));
        return None;
    }
    // Empty and unsorted lists are reported above.
    Track::new(keys, repeat, closed).ok().map(Animated::Keyed)
}
