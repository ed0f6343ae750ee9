//! Skies that are brighter in some directions.

use super::LightSample;
use crate::appearance::environment::{Environment, SkyTable};
use crate::base::lanes::Real;
use std::f64::consts::PI;

/// Light from a direction of the sky, likely where that is bright.
#[inline(always)]
pub fn sample<F: Real>(environment: &Environment, table: &SkyTable, u: [F; 2]) -> LightSample<F> {
    let (direction, pdf) = environment.sample(table, u);
    let each = (F::splat(1.0) / (F::splat(PI) * pdf)).to_f32();
    LightSample::distant(direction, environment.radiance(direction) * each, pdf)
}
