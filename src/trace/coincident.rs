//! Surfaces that lie in one: a glass on a table, two slabs face to face.
//!
//! A ray that has passed a surface starts beyond all that rounding may have done to it, and so beyond whatever lies in
//! the same place. What it would miss is looked for across the place, from one side of the rounding to the other.

use super::spawn::spawn;
use super::tracer::{Met, Tracer};
use crate::bvh::Hit;
use crate::camera::Ray;
use crate::math::DVec3;
use crate::shape::Surface;
use crate::tree::Probe;

/// Surfaces in one place that are told apart; more are passed as one.
const MOST: usize = 4;

/// Where a ray has just passed a surface, or several that lie in one.
#[derive(Clone, Copy, Debug)]
pub struct Crossed {
    /// Across the place, t from 0 to 1.
    way: Ray,
    primitives: [u32; MOST],
    count: usize,
}

impl Crossed {
    /// The place where a ray in a direction has passed a surface of a primitive; `before` is what it had passed last.
    pub fn new(before: Option<Self>, primitive: u32, surface: &Surface, direction: DVec3) -> Self {
        let near = spawn(surface, -direction).origin;
        let across = spawn(surface, direction).origin - near;
        // Other surfaces have errors of their own, about as large.
        let way = Ray { origin: near - across, direction: across * 3.0 };
        let reach = 4.0 * across.length();
        let mut all = before
            .filter(|before| (before.way.at(0.5) - surface.point).length() <= reach)
            .unwrap_or(Self { way, primitives: [u32::MAX; MOST], count: 0 });
        all.primitives[all.count % MOST] = primitive;
        all.count += 1;
        Self { way, ..all }
    }

    fn primitives(&self) -> &[u32] {
        &self.primitives[..self.count.min(MOST)]
    }
}

impl<'a> Tracer<'a> {
    /// What lies in the surfaces that a ray has just passed, and has not been passed yet.
    pub fn lying_in(&self, crossed: Option<&Crossed>) -> Option<Met<'a>> {
        let crossed = crossed.filter(|crossed| crossed.count < MOST)?;
        let hit: Hit =
            self.bvh.closest_but(self.scene.geometry, &Probe::new(crossed.way), 1.0, crossed.primitives())?;
        Some(self.met(&crossed.way, hit))
    }
}
