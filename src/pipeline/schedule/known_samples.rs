//! The samples that a run keeps for neighbours in time. The plan counts with the same rules.

use super::frame_state::SampledState;
use crate::base::digest::Digest;
use crate::film::LayerId;

/// The samples of some frames. `T` is what is kept of each.
pub struct KnownSamples<T>(Vec<Known<T>>);

/// The samples of a frame.
struct Known<T> {
    digest: Digest,
    /// The layers that they hold, ascending.
    lit: Vec<LayerId>,
    samples: T,
}

impl<T> Default for KnownSamples<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T> KnownSamples<T> {
    /// Forgets the samples that none of these frames needs.
    pub fn keep_for(&mut self, frames: &[SampledState]) {
        self.0.retain(|known| frames.iter().any(|frame| frame.digest() == known.digest));
    }

    /// The samples of a frame and the layers that they hold, if these are all that it is sampled for, and `lit`.
    pub fn find(&self, frame: &SampledState, lit: &[LayerId]) -> Option<(&T, &[LayerId])> {
        let known = self.0.iter().find(|known| known.digest == frame.digest())?;
        let mut wanted = frame.lit.iter().chain(lit);
        wanted.all(|layer| known.lit.contains(layer)).then_some((&known.samples, &known.lit))
    }

    /// Adds the samples of a frame with these layers, in place of those with fewer.
    pub fn insert(&mut self, frame: &SampledState, lit: Vec<LayerId>, samples: T) {
        let digest = frame.digest();
        self.0.retain(|known| known.digest != digest);
        self.0.push(Known { digest, lit, samples });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::schedule::FrameState;

    fn frame(scene: u128, lit: &[u32]) -> SampledState {
        let state = FrameState { scene_hash: Digest(scene), ..FrameState::default() };
        SampledState { state, lit: lit.iter().copied().map(LayerId).collect() }
    }

    #[test]
    fn samples_serve_frames_with_no_more_layers() {
        let mut known = KnownSamples::default();
        known.insert(&frame(1, &[0]), vec![LayerId(0)], "few");
        assert_eq!(known.find(&frame(1, &[0]), &[]).map(|(samples, _)| *samples), Some("few"));
        assert!(
            known.find(&frame(1, &[0]), &[LayerId(2)]).is_none() && known.find(&frame(2, &[]), &[]).is_none()
        );
        let both = [LayerId(0), LayerId(2)];
        known.insert(&frame(1, &[0]), both.to_vec(), "all");
        assert_eq!(known.find(&frame(1, &[2]), &[LayerId(0)]), Some((&"all", &both[..])));
        known.insert(&frame(2, &[0]), vec![LayerId(0)], "other");
        known.keep_for(&[frame(1, &[0]), frame(3, &[0])]);
        assert_eq!(known.0.len(), 1);
    }
}
