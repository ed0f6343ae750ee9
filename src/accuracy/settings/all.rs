//! Creates an experiment with all axes that apply to a sequence.

use super::experiment::{Experiment, SceneFacts, Scope};
use crate::sequence::quality::Quality;

impl Experiment {
    /// All settings for a sequence, without those of its layers, parts and remedies.
    pub fn new(own: &Quality, facts: SceneFacts, scope: Scope) -> Self {
        let (all, left_out) = (Vec::new(), Vec::new());
        let mut settings = Self { all, left_out, random: facts.random, reference: 0, scope, facts };
        if facts.random {
            settings.samples(own);
            settings.targets(own);
        } else {
            settings.grids(own);
        }
        settings.bounces(own);
        settings.roulette(own);
        settings.integrators(own);
        settings
    }
}
