//! Input of the tracer besides the scene: settings, and the moment of an open shutter.

use crate::film::AovSet;
use crate::film::filter::FilterSampler;
use crate::sequence::quality::Quality;

/// Settings of the tracer.
#[derive(Clone, Debug)]
#[warn(missing_docs)]
pub struct TraceSettings {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The work per pixel.
    pub quality: Quality,
    /// The sampler of the quality's reconstruction filter.
    pub filter: FilterSampler,
    /// What films record besides light.
    pub aovs: AovSet,
    /// The index of the first random sample of each pixel in its sequence. `quality` has the number of samples.
    pub first_sample: u32,
}

#[warn(missing_docs)]
impl TraceSettings {
    /// Settings of a film of light alone.
    pub fn new(size: (u32, u32), quality: Quality) -> Self {
        Self {
            size,
            quality,
            filter: FilterSampler::new(quality.filter),
            aovs: AovSet::default(),
            first_sample: 0,
        }
    }
}

/// One of the moments at which an open shutter samples motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moment {
    pub index: u32,
    /// The number of moments; 1 if nothing moves.
    pub of: u32,
}

impl Moment {
    pub const ONLY: Self = Self { index: 0, of: 1 };
}
