//! Reports of finished frames: what each has taken since the frame before.

use super::stages::Stats;
use crate::base::machine::cpu_time;
use crate::base::stats::FRAME_EVENTS;
use std::time::Instant;
use tracing::{Level, info};

/// The state of a run when its last frame was finished.
#[derive(Debug)]
pub struct FrameMark {
    at: Instant,
    cpu: f64,
    stats: Stats,
}

impl Default for FrameMark {
    fn default() -> Self {
        Self { at: Instant::now(), cpu: cpu_time().unwrap_or_default(), stats: Stats::default() }
    }
}

impl FrameMark {
    /// Reports a frame, if somebody listens.
    pub fn report(&mut self, frame: u32, film: &'static str, stats: &Stats) {
        if !tracing::enabled!(target: FRAME_EVENTS, Level::INFO) {
            return;
        }
        let now = Self { at: Instant::now(), cpu: cpu_time().unwrap_or_default(), stats: stats.clone() };
        let (old, new) = (&self.stats.counts, &now.stats.counts);
        let wall = (now.at - self.at).as_secs_f64();
        let rays = new.rays.total() - old.rays.total();
        info!(
            target: FRAME_EVENTS,
            frame,
            film,
            wall_s = wall,
            cpu_s = now.cpu - self.cpu,
            rays.camera = new.rays.camera - old.rays.camera,
            rays.mirror = new.rays.mirror - old.rays.mirror,
            rays.transmitted = new.rays.transmitted - old.rays.transmitted,
            rays.scattered = new.rays.scattered - old.rays.scattered,
            rays.shadow = new.rays.shadow - old.rays.shadow,
            rays.total = rays,
            light_samples = new.evaluations.light_samples - old.evaluations.light_samples,
            bvh_builds = now.stats.bvh_builds - self.stats.bvh_builds,
            bvh_refits = now.stats.bvh_refits - self.stats.bvh_refits,
            "rendered"
        );
        tracing::trace!(target: "kinora::counter", rays_per_second = rays as f64 / wall.max(1e-9));
        *self = now;
    }
}
