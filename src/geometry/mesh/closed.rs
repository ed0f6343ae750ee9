//! Whether a mesh encloses a volume.

use super::TriangleMesh;
use std::collections::HashMap;

impl TriangleMesh {
    /// Whether every edge has as many triangles on one side as on the other. Vertices at the same place count as one.
    pub fn is_closed(&self) -> bool {
        *self.closed.get_or_init(|| {
            // The number of triangles that run along an edge from the smaller to the larger vertex, less those that run
            // back.
            let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
            let place = super::first_equal(self.positions());
            for corners in self.triangles() {
                let [a, b, c] = corners.map(|corner| place[corner as usize]);
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
                }
            }
            edges.values().all(|sum| *sum == 0)
        })
    }
}
