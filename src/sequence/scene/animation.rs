//! Animations of a scene as keys.

use super::nodes::SceneNode;
use crate::appearance::light::LightTracks;
use crate::base::math::{DQuat, DVec3, unit_quaternion};
use crate::base::time::Time;
use crate::geometry::transform::Rotation;
use crate::import::gltf::{GltfChannel, GltfScene, GltfTarget, Interpolation};
use crate::track::{Animate, Animated, Ease, Key, Repeat, Track};
use std::collections::HashMap;

/// When an animation plays.
#[derive(Clone, Copy, Debug)]
pub struct Playback {
    /// The time of the sequence at which it begins.
    pub start: Time,
    /// Its seconds per second of the sequence, above 0.
    pub speed: Time,
    pub repeat: Repeat,
}

/// The largest denominator of a time of a key. Finer times are rounded to it.
const FINEST: i128 = 1_000_000_000;

impl Playback {
    /// A time of the animation as one of the sequence.
    pub fn time(&self, time: Time) -> Time {
        let exact = self.start + time / self.speed;
        if *exact.denom() <= FINEST {
            return exact;
        }
        let finest = Time::from_integer(FINEST);
        (exact * finest).round() / finest
    }
}

/// The channels that play, by what they change. Of several for one property, the last one counts.
pub struct Channels<'a> {
    by_target: HashMap<GltfTarget, (&'a GltfChannel, Time)>,
    playback: Playback,
}

impl<'a> Channels<'a> {
    /// Those of the animations with these indices.
    pub fn of(scene: &'a GltfScene, animations: &[usize], playback: Playback) -> Self {
        let animations = animations.iter().map(|index| &scene.animations[*index]);
        let channels = animations.flat_map(|animation| {
            animation.channels.iter().map(|channel| (channel.target, (channel, animation.end)))
        });
        Self { by_target: channels.collect(), playback }
    }

    /// Animates the object of the node with this index in the file.
    pub fn animate_node(&self, index: usize, object: &mut SceneNode) {
        let vector = |v: &[f64]| DVec3::from_slice(v);
        self.set(GltfTarget::Translation(index), &mut object.transform.translation, vector, vector);
        self.set(GltfTarget::Scale(index), &mut object.transform.scale, vector, vector);
        if let Rotation::Quaternion(rotation) = &mut object.transform.rotation {
            // Tangents have any length.
            let tangent = |v: &[f64]| DQuat::from_slice(v);
            let value = |v: &[f64]| v.try_into().ok().and_then(unit_quaternion).unwrap_or(DQuat::IDENTITY);
            self.set(GltfTarget::Rotation(index), rotation, value, tangent);
        }
        let is_visible = |v: &[f64]| v.iter().any(|number| *number != 0.0);
        self.set(GltfTarget::Visible(index), &mut object.visible, is_visible, is_visible);
    }

    /// Animates the weights of the morph targets of the node with this index in the file.
    pub fn animate_weights(&self, index: usize, weights: &mut [Animated<f64>]) {
        for (number, weight) in weights.iter_mut().enumerate() {
            let one = |v: &[f64]| v.get(number).copied().unwrap_or(0.0);
            self.set(GltfTarget::Weights(index), weight, one, one);
        }
    }

    /// Animates the light with this index in the file. `intensity` is what an intensity of 1 comes to.
    pub fn animate_light(&self, index: usize, light: &mut LightTracks, intensity: f64) {
        let brightness = |v: &[f64]| v.iter().sum::<f64>() * intensity;
        self.set(GltfTarget::LightIntensity(index), &mut light.intensity, brightness, brightness);
        let color = |v: &[f64]| DVec3::from_slice(v).as_vec3();
        self.set(GltfTarget::LightColor(index), &mut light.color, color, color);
    }

    /// Replaces a value by the track of a property, if there is one. `value` and `tangent` read numbers.
    fn set<T: Animate>(
        &self,
        target: GltfTarget,
        to: &mut Animated<T>,
        value: impl Fn(&[f64]) -> T,
        tangent: impl Fn(&[f64]) -> T,
    ) {
        if let Some((channel, end)) = self.by_target.get(&target) {
            *to = self.track(channel, *end, value, tangent);
        }
    }

    fn track<T: Animate>(
        &self,
        channel: &GltfChannel,
        end: Time,
        value: impl Fn(&[f64]) -> T,
        tangent: impl Fn(&[f64]) -> T,
    ) -> Animated<T> {
        let ease = if channel.interpolation == Interpolation::Step { Ease::Step } else { Ease::Linear };
        let key = |(index, time): (usize, &Time)| Key {
            time: self.playback.time(*time),
            value: value(channel.value(index, 1)),
            ease,
        };
        let mut keys: Vec<Key<T>> = channel.times.iter().enumerate().map(key).collect();
        let mut curves = match channel.interpolation {
            Interpolation::Cubic => self.curves(channel, tangent),
            _ => Vec::new(),
        };
        drop_earlier(&mut keys, &mut curves);
        if self.playback.repeat != Repeat::Hold {
            self.fill(&mut keys, &mut curves, end);
        }
        let first = keys[0].value.clone();
        if curves.is_empty() && keys.iter().all(|key| key.value == first) {
            return first.into();
        }
        let track = Track::new(keys, self.playback.repeat, false);
        track.map_or(first.into(), |track| Animated::Keyed(track.with_curves(curves)))
    }

    /// The tangents at both ends of each segment, times its length in seconds of the animation.
    fn curves<T: Animate>(&self, channel: &GltfChannel, tangent: impl Fn(&[f64]) -> T) -> Vec<[T; 2]> {
        let segment = |(from, times): (usize, &[Time])| {
            let length = times[1] - times[0];
            let length = *length.numer() as f64 / *length.denom() as f64;
            let scaled = |key: usize, part: usize| {
                let numbers: Vec<f64> =
                    channel.value(key, part).iter().map(|number| number * length).collect();
                tangent(&numbers)
            };
            [scaled(from, 2), scaled(from + 1, 0)]
        };
        channel.times.windows(2).enumerate().map(segment).collect()
    }

    /// Lets keys last from the start to the end of the animation, so that all of them repeat together.
    fn fill<T: Animate>(&self, keys: &mut Vec<Key<T>>, curves: &mut Vec<[T; 2]>, end: Time) {
        let (start, end) = (self.playback.time(Time::from_integer(0)), self.playback.time(end));
        let hold =
            |curves: &Vec<[T; 2]>, value: &T| (!curves.is_empty()).then(|| [value.clone(), value.clone()]);
        if let Some(first) = keys.first().filter(|first| first.time > start).map(|first| first.value.clone())
        {
            if let Some(unused) = hold(curves, &first) {
                curves.insert(0, unused);
            }
            keys.insert(0, Key { time: start, value: first, ease: Ease::Step });
        }
        if let Some(last) = keys.last_mut().filter(|last| last.time < end) {
            last.ease = Ease::Step;
            let value = last.value.clone();
            if let Some(unused) = hold(curves, &value) {
                curves.push(unused);
            }
            keys.push(Key { time: end, value, ease: Ease::Step });
        }
    }
}

/// Of keys at the same time, keeps the last one. Times of fast animations are rounded, so keys may meet.
fn drop_earlier<T>(keys: &mut Vec<Key<T>>, curves: &mut Vec<[T; 2]>) {
    let is_kept: Vec<bool> =
        (0..keys.len()).map(|at| keys.get(at + 1).is_none_or(|next| next.time > keys[at].time)).collect();
    if is_kept.iter().all(|kept| *kept) {
        return;
    }
    // The curve from one key to the next one goes with the former.
    let mut kept = is_kept.iter();
    curves.retain(|_| *kept.next().unwrap_or(&true));
    let mut kept = is_kept.iter();
    keys.retain(|_| *kept.next().unwrap_or(&true));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_keys_at_one_time_the_last_one_stays() {
        let key = |(time, value)| Key { time: Time::from_integer(time), value, ease: Ease::Linear };
        let mut keys: Vec<Key<f64>> = [(0, 0.0), (1, 1.0), (1, 2.0), (1, 3.0), (2, 4.0)].map(key).into();
        let mut curves = vec![[0.0, 0.5], [1.0, 1.5], [2.0, 2.5], [3.0, 3.5]];
        drop_earlier(&mut keys, &mut curves);
        assert_eq!(keys, [(0, 0.0), (1, 3.0), (2, 4.0)].map(key));
        assert_eq!(curves, [[0.0, 0.5], [3.0, 3.5]]);
        let mut none: [Vec<Key<f64>>; 1] = [vec![key((0, 1.0)), key((1, 1.0))]];
        drop_earlier(&mut none[0], &mut Vec::new());
        assert_eq!(none[0].len(), 2);
    }
}
