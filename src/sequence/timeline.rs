//! Decodes `timeline`: number of frames, rate, and the unit of key times.

use super::decimal::exact;
use super::fault::Fault;
use super::fields::Fields;
use super::key_clock::KeyClock;
use super::node::Node;
use super::values::{each, exact_above_zero, text, tuple, whole};
use super::words::word;
use crate::base::time::{Rate, Time, Timeline};

/// Maximum number of frames of a sequence.
const MAX_FRAMES: u32 = 10_000_000;

/// Maximum numerator and denominator of a rate.
const LARGEST_PART: u32 = 1_000_000;

#[derive(Clone, Copy)]
enum KeyUnit {
    Seconds,
    Frames,
}

/// The timeline of a file without one: one frame.
pub fn still() -> Timeline {
    Timeline::of_frames(1, Rate::default())
}

/// Decodes the timeline, and sets the unit of all following key times.
pub fn timeline(node: Node<'_>) -> Option<Timeline> {
    let mut fields = Fields::of(node, "the timeline")?;
    let rate = fields.or("fps", rate, Rate::default());
    let (has_frames, twice) = (fields.has("frames"), fields.has("frames") && fields.has("duration"));
    if twice {
        let (here, there) = (fields.place("duration"), fields.place("frames"));
        let fault = Fault::new(here, "a timeline has either `frames` or `duration`", "one too many");
        node.fault(fault.also(there, "the length is already given here"));
    }
    let frames = fields.or("frames", whole(1..=MAX_FRAMES), 1u32);
    let duration = fields.optional("duration", |node| {
        let duration = duration(node)?;
        let (false, Some(rate)) = (has_frames, rate) else { return None };
        let timeline = Timeline::of_duration(duration, rate).filter(|t| t.frames <= MAX_FRAMES);
        if timeline.is_none() {
            let frames = format!("makes more than {MAX_FRAMES} frames at {rate} per second");
            node.fault(Fault::new(node.span(), "the sequence is too long", frames));
        }
        timeline
    });
    let units = [("Seconds", KeyUnit::Seconds), ("Frames", KeyUnit::Frames)];
    let unit = fields.or("keys", |node| word(node, "unit of key times", &units), KeyUnit::Seconds);
    fields.finish();
    if let Some(KeyUnit::Frames) = unit {
        node.file.clock.set(KeyClock::Frames(rate.unwrap_or_default()));
    }
    let (rate, frames) = (rate?, frames?);
    Some(duration?.unwrap_or_else(|| Timeline::of_frames(frames, rate)))
}

fn duration(node: Node<'_>) -> Option<Time> {
    let duration = exact_above_zero(node, 9)?;
    if duration <= Time::from_integer(0) || duration > Time::from_integer(1_000_000_000) {
        node.expected("a number of seconds above 0, at most 1e9");
        return None;
    }
    Some(duration)
}

/// `24`, `29.97`, `(30000, 1001)` or `"30000/1001"`.
fn rate(node: Node<'_>) -> Option<Rate> {
    let rate = if node.is_text() {
        quoted_rate(node)?
    } else if node.opens_with('(') {
        let parts = tuple(node, "a rate (frames, seconds)")?;
        let [frames, seconds] = each(parts, whole(1..=LARGEST_PART))?;
        Time::new(frames.into(), seconds.into())
    } else {
        exact_above_zero(node, 6)?
    };
    let limits = Time::new(1, LARGEST_PART.into())..=Time::from_integer(LARGEST_PART.into());
    if !limits.contains(&rate) || *rate.numer() > 1_000_000_000 {
        node.expected("a number of frames per second above 0, at most 1000000");
        return None;
    }
    Rate::from_ratio(rate)
}

fn quoted_rate(node: Node<'_>) -> Option<Time> {
    let text = text(node)?;
    let part = |text: &str| {
        let part = exact(text.trim(), 0).ok()?;
        let limit = Time::from_integer(LARGEST_PART.into());
        (part > Time::from_integer(0) && part <= limit).then_some(part)
    };
    let (frames, seconds) = text.split_once('/').unwrap_or((&text, "1"));
    let rate = part(frames).zip(part(seconds)).map(|(frames, seconds)| frames / seconds);
    if rate.is_none() {
        node.expected("a rate such as \"30000/1001\", of whole numbers from 1 to 1000000");
    }
    rate
}
