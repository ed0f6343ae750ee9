//! Importance sampling of skies.

use super::LightSample;
use crate::appearance::environment::{Environment, EnvironmentDistribution};
use crate::base::lanes::Real;
use std::f64::consts::PI;

/// Samples light of the sky, mostly from bright directions.
#[inline(always)]
pub fn sample<F: Real>(
    environment: &Environment,
    table: &EnvironmentDistribution,
    u: [F; 2],
) -> LightSample<F> {
    let (direction, pdf) = environment.sample(table, u);
    let each = (F::splat(1.0) / (F::splat(PI) * pdf)).to_f32();
    LightSample::distant(direction, environment.radiance(direction) * each, pdf)
}
