//! Values over time as keys of glTF.
//!
//! Tracks whose interpolation glTF has keep their keys: steps, linear ones, and cubic curves. All others are sampled at
//! every frame.

use super::document::Document;
use crate::base::color::Rgb;
use crate::base::math::{DQuat, DVec3};
use crate::base::time::{Time, Timeline};
use crate::track::{Animate, Animated, Ease, Modes, Repeat, Track};
use serde_json::{Value, json};

/// A value as numbers.
pub trait Numbers: Animate {
    const QUATERNION: bool = false;

    fn numbers(&self) -> Vec<f64>;
}

impl Numbers for f64 {
    fn numbers(&self) -> Vec<f64> {
        vec![*self]
    }
}

impl Numbers for bool {
    fn numbers(&self) -> Vec<f64> {
        vec![f64::from(u8::from(*self))]
    }
}

impl Numbers for DVec3 {
    fn numbers(&self) -> Vec<f64> {
        self.to_array().to_vec()
    }
}

impl Numbers for Rgb {
    fn numbers(&self) -> Vec<f64> {
        self.as_dvec3().to_array().to_vec()
    }
}

impl Numbers for DQuat {
    const QUATERNION: bool = true;

    fn numbers(&self) -> Vec<f64> {
        self.to_array().to_vec()
    }
}

/// How values change between keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Interpolation {
    Step,
    Linear,
    Cubic,
}

/// The keys of one property. With cubic curves, each has three values: the incoming tangent, the value and the outgoing
/// tangent.
#[derive(Clone, Debug, PartialEq)]
pub struct Keys {
    interpolation: Interpolation,
    times: Vec<f64>,
    values: Vec<Vec<f64>>,
    /// The numbers of the first key.
    first: Vec<f64>,
}

fn seconds(time: Time) -> f64 {
    *time.numer() as f64 / *time.denom() as f64
}

impl Keys {
    /// The keys of a value; none if it does not change.
    pub fn of<T: Numbers>(value: &Animated<T>, timeline: &Timeline) -> Option<Self> {
        let Animated::Keyed(track) = value else { return None };
        if let Some(exact) = Self::exact(track) {
            return Some(exact).filter(Self::changes);
        }
        let steps = T::MODES == Modes::Step || track.keys().iter().any(|key| key.ease == Ease::Step);
        Self::sampled(timeline, steps, T::QUATERNION, |time| track.at(time).numbers())
    }

    /// The keys of a function of time, one for each frame and for the end, but those that the others imply; none if it does
    /// not change. With the end, a closed motion repeats without a gap.
    pub fn sampled(
        timeline: &Timeline,
        steps: bool,
        quaternion: bool,
        at: impl Fn(Time) -> Vec<f64>,
    ) -> Option<Self> {
        let times: Vec<Time> = (0..=timeline.frames).map(|frame| timeline.clock(frame).time).collect();
        let mut values: Vec<Vec<f64>> = times.iter().map(|time| at(*time)).collect();
        if quaternion {
            nearest_signs(&mut values);
        }
        let same = |a: usize, b: usize| values[a] == values[b];
        let is_implied = |at: usize| match steps {
            true => at > 0 && same(at, at - 1),
            false => at > 0 && same(at, at - 1) && (at + 1 == values.len() || same(at, at + 1)),
        };
        let kept: Vec<usize> = (0..values.len()).filter(|at| !is_implied(*at)).collect();
        let keys = Self {
            interpolation: if steps { Interpolation::Step } else { Interpolation::Linear },
            times: kept.iter().map(|at| seconds(times[*at])).collect(),
            first: values.first()?.clone(),
            values: kept.iter().map(|at| values[*at].clone()).collect(),
        };
        Some(keys).filter(Self::changes)
    }

    /// The same keys, if glTF has their interpolation.
    fn exact<T: Numbers>(track: &Track<T>) -> Option<Self> {
        let keys = track.keys();
        let times: Vec<f64> = keys.iter().map(|key| seconds(key.time)).collect();
        let ascending = times.windows(2).all(|pair| (pair[0] as f32) < pair[1] as f32);
        if track.repeat() != Repeat::Hold || times[0] < 0.0 || !ascending {
            return None;
        }
        let eases = || keys[..keys.len() - 1].iter().enumerate().map(|(at, key)| (at, key.ease));
        let interpolation = if T::MODES == Modes::Step || eases().all(|(_, ease)| ease == Ease::Step) {
            Interpolation::Step
        } else if eases().all(|(at, ease)| ease == Ease::Linear && track.curve(at).is_none()) {
            Interpolation::Linear
        } else {
            let curved = |(at, ease)| match ease {
                // The cubic curve of a quaternion's components is not the arc between two of them.
                Ease::Linear => !T::QUATERNION || track.curve(at).is_some(),
                Ease::Smooth => !T::QUATERNION,
                _ => false,
            };
            eases().all(curved).then_some(Interpolation::Cubic)?
        };
        let values = keys.iter().enumerate().flat_map(|(at, key)| match interpolation {
            Interpolation::Cubic => {
                let arriving = at.checked_sub(1).map(|from| tangents(track, &times, from)[1].clone());
                let leaving = (at + 1 < times.len()).then(|| tangents(track, &times, at)[0].clone());
                let still = || vec![0.0; key.value.numbers().len()];
                let [arriving, leaving] = [arriving, leaving].map(|tangent| tangent.unwrap_or_else(still));
                vec![arriving, key.value.numbers(), leaving]
            }
            _ => vec![key.value.numbers()],
        });
        Some(Self { interpolation, first: keys[0].value.numbers(), values: values.collect(), times })
    }

    fn changes(&self) -> bool {
        self.interpolation == Interpolation::Cubic || self.values.iter().any(|value| *value != self.first)
    }

    /// Each value as other numbers. Tangents lack what `offset` adds.
    pub fn scaled(mut self, factor: f64, offset: &[f64]) -> Self {
        let is_tangent = |at: usize| self.interpolation == Interpolation::Cubic && at % 3 != 1;
        let change = |(at, value): (usize, &mut Vec<f64>)| {
            for (number, offset) in value.iter_mut().zip(offset) {
                *number = *number * factor + if is_tangent(at) { 0.0 } else { *offset };
            }
        };
        self.values.iter_mut().enumerate().for_each(change);
        self.first.iter_mut().zip(offset).for_each(|(number, offset)| *number = *number * factor + offset);
        self
    }

    /// Adds the keys to a file. Returns the sampler.
    pub fn sampler(&self, document: &mut Document) -> Value {
        let input = document.floats(self.times.iter().map(|time| [*time]), None, true);
        let rows = || self.values.iter();
        let output = match self.first.len() {
            1 => document.floats(rows().map(|row| [row[0]]), None, false),
            3 => document.floats(rows().map(|row| [row[0], row[1], row[2]]), None, false),
            _ => document.floats(rows().map(|row| [row[0], row[1], row[2], row[3]]), None, false),
        };
        let interpolation = match self.interpolation {
            Interpolation::Step => "STEP",
            Interpolation::Linear => "LINEAR",
            Interpolation::Cubic => "CUBICSPLINE",
        };
        json!({ "input": input, "output": output, "interpolation": interpolation })
    }
}

/// The tangents per second at both ends of a segment.
fn tangents<T: Numbers>(track: &Track<T>, times: &[f64], from: usize) -> [Vec<f64>; 2] {
    let (a, b) = (&track.keys()[from], &track.keys()[from + 1]);
    let length = times[from + 1] - times[from];
    let per_second = |numbers: Vec<f64>| numbers.into_iter().map(|number| number / length).collect();
    if let Some(tangents) = track.curve(from) {
        return [per_second(tangents[0].numbers()), per_second(tangents[1].numbers())];
    }
    let (from, to) = (a.value.numbers(), b.value.numbers());
    let straight: Vec<f64> = from.iter().zip(&to).map(|(a, b)| b - a).collect();
    // Smooth: no speed at both ends.
    let tangent = if a.ease == Ease::Smooth { vec![0.0; straight.len()] } else { per_second(straight) };
    [tangent.clone(), tangent]
}

/// Gives each quaternion the sign that is nearest to the one before.
fn nearest_signs(values: &mut [Vec<f64>]) {
    for at in 1..values.len() {
        let product: f64 = values[at].iter().zip(&values[at - 1]).map(|(a, b)| a * b).sum();
        if product < 0.0 {
            values[at].iter_mut().for_each(|number| *number = -*number);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::time::Rate;
    use crate::track::Key;

    fn track(eases: &[Ease]) -> Animated<f64> {
        let key = |(at, ease): (i128, &Ease)| Key {
            time: Time::from_integer(at),
            value: (at * at) as f64,
            ease: *ease,
        };
        let keys = (0..).zip(eases).map(key).collect();
        Animated::Keyed(Track::new(keys, Repeat::Hold, false).expect("a track"))
    }

    fn keys(eases: &[Ease]) -> Keys {
        let timeline = Timeline::of_frames(25, Rate::new(12, 1).expect("a rate"));
        Keys::of(&track(eases), &timeline).expect("keys")
    }

    #[test]
    fn steps_lines_and_cubic_curves_keep_their_keys() {
        use Ease::{Linear, Smooth, Step};
        assert_eq!(keys(&[Step, Step, Linear]).interpolation, Interpolation::Step);
        assert_eq!(keys(&[Linear, Linear, Step]).values, [[0.0], [1.0], [4.0]]);
        let cubic = keys(&[Smooth, Linear, Linear]);
        assert_eq!((cubic.interpolation, cubic.times.len()), (Interpolation::Cubic, 3));
        // The tangents before and after the second key: it arrives without speed and leaves at 3 per second.
        assert_eq!(cubic.values[3..6], [[0.0], [1.0], [3.0]]);
    }

    #[test]
    fn other_easings_are_sampled_at_every_frame() {
        let sampled = keys(&[Ease::Smoother, Ease::Linear, Ease::Linear]);
        assert_eq!((sampled.interpolation, sampled.times.len()), (Interpolation::Linear, 25));
        let stepped = keys(&[Ease::Step, Ease::Smoother, Ease::Linear]);
        // One value for the first second, then one for each frame from the step on.
        assert_eq!((stepped.interpolation, stepped.times.len()), (Interpolation::Step, 14));
    }
}
