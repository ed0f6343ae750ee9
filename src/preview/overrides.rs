//! What a session changes without the file: switches of lights, and quality.

use crate::base::color::Rgb;
use crate::base::time::Time;
use crate::sequence::{LightLayers, Sequence};
use std::collections::BTreeMap;

/// Changes of the session. An absent one leaves the file's setting.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// Whether lights are on, by their names.
    pub lights: BTreeMap<String, bool>,
    pub size: Option<(u32, u32)>,
    pub bounces: Option<u32>,
    pub antialias: Option<u32>,
    pub samples: Option<u32>,
}

impl Overrides {
    /// The sequence with these settings; switches of lights are weights, see [`Overrides::weigh`].
    pub fn apply(&self, mut sequence: Sequence) -> Sequence {
        let quality = &mut sequence.quality;
        quality.bounces = self.bounces.unwrap_or(quality.bounces);
        quality.antialias = self.antialias.unwrap_or(quality.antialias);
        if let Some(samples) = self.samples {
            (quality.samples, quality.noise) = (samples, None);
        }
        sequence.output.size = self.size.unwrap_or(sequence.output.size);
        sequence
    }

    /// Changes the weights of a frame that starts at `time` for the lights that are switched. Lights that share a layer
    /// keep their weight.
    pub fn weigh(&self, sequence: &Sequence, layers: &LightLayers, time: Time, weights: &mut [Rgb]) {
        for (light, layer) in sequence.lights.iter().zip(&layers.lights) {
            let Some(on) = self.lights.get(&light.name) else { continue };
            let shared = layers.lights.iter().filter(|other| *other == layer).count() > 1;
            let tracks = &light.value;
            let keyed = tracks.color.is_keyed() && tracks.intensity.is_keyed() && layer.index() > 0;
            if shared || !(keyed && tracks.on.is_keyed()) {
                continue;
            }
            let intensity = tracks.intensity.at(time).max(0.0) as f32;
            let radiance = tracks.color.at(time).max(Rgb::ZERO) * intensity;
            weights[layer.index()] = if *on { radiance } else { Rgb::ZERO };
        }
    }
}
