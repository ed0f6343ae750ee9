//! Whether rays that go different ways are searched in bundles or one by one.

use crate::geometry::bvh::BundleWork;

/// The choice between bundles and single rays. Both find the same hits, so the choice may follow what took less work
/// lately: of every [`PERIOD`] bundles, the first [`TRIAL`] are searched together, and show how many of their rays
/// visit a node.
#[derive(Default)]
pub struct Grouping {
    /// The number of the next bundle in its period.
    next: u32,
    /// The work of the trial.
    trial: BundleWork,
    apart: bool,
}

const PERIOD: u32 = 1024;
const TRIAL: u32 = 8;

/// With at least so many rays at a node, on average, bundles take less time. Measured with 1.7 rays (thousands of
/// spheres, bundles take 1.15 of the time), 2.9 (a molecule of cylinders, 1.00), 3.3 (a room of boxes and balls, 0.90), 4.2
/// (a bar chart, 0.88) and 5.4 (hundreds of spheres on a plane, 0.77).
const ENOUGH: f64 = 2.5;

impl Grouping {
    /// Whether the next rays are searched together.
    #[inline(always)]
    pub fn together(&mut self) -> bool {
        let number = self.next;
        self.next = (number + 1) % PERIOD;
        match number {
            0 => self.trial = BundleWork::default(),
            TRIAL => self.apart = f64::from(self.trial.rays) < ENOUGH * f64::from(self.trial.nodes),
            _ => {}
        }
        number < TRIAL || !self.apart
    }

    /// Adds the work of rays that were searched together.
    #[inline(always)]
    pub fn add(&mut self, work: BundleWork) {
        if self.next <= TRIAL {
            self.trial.nodes += work.nodes;
            self.trial.rays += work.rays;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bundles of so many rays per node: the share of rows that are searched together.
    fn share(rays: u32) -> f64 {
        let (mut grouping, rows) = (Grouping::default(), 4 * PERIOD);
        let together = (0..rows).filter(|_| {
            let together = grouping.together();
            if together {
                grouping.add(BundleWork { nodes: 3, rays: 3 * rays });
            }
            together
        });
        together.count() as f64 / f64::from(rows)
    }

    #[test]
    fn rays_stay_together_where_nodes_are_shared() {
        assert_eq!([8, 5, 3].map(share), [1.0; 3]);
        assert_eq!([1, 2].map(share), [f64::from(TRIAL) / f64::from(PERIOD); 2]);
    }
}
