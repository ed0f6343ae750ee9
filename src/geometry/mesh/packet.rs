//! Triangle tests, eight at a time: a conservative f32 filter before the f64 test.
//!
//! The filter only reports certain results. Its error bound covers the rounding of corners, rays and products. What it
//! calls a miss is a miss of the f64 test, and what it calls a hit is a hit.

use super::data::MeshData;
use crate::base::lanes::{Level, Real, Row, Single};
use crate::base::math::DVec3;
use crate::geometry::bvh::{BundleSlabs, Slabs, TraversalRay, TreeSpace};

/// The triangles of a leaf, in the space of its tree, as structure of arrays.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Packet {
    /// For each corner, the coordinates along each axis.
    corners: [[[f32; 8]; 3]; 3],
    parts: [u32; 8],
}

impl Packet {
    pub fn new(space: &TreeSpace, leaf: &[u32], data: &MeshData) -> Self {
        // No ray hits unused lanes, which hold NaN.
        let mut packet = Self { corners: [[[f32::NAN; 8]; 3]; 3], parts: [u32::MAX; 8] };
        for (lane, &part) in leaf.iter().enumerate().take(8) {
            packet.parts[lane] = part;
            for (rows, corner) in packet.corners.iter_mut().zip(data.triangles[part as usize]) {
                let rounded = space.point(data.positions[corner as usize]).as_vec3();
                rows.iter_mut().zip(rounded.to_array()).for_each(|(row, value)| row[lane] = value);
            }
        }
        packet
    }

    /// The f64 corners of a lane's triangle: the f32 corners times `size`. Only for meshes whose positions f32 holds
    /// exactly in their tree's space. Otherwise the corners must be looked up.
    #[inline(always)]
    pub fn exact(&self, lane: usize, size: f64) -> [DVec3; 3] {
        let [a, b, c] = &self.corners;
        let lane = lane & 7;
        let corner = |rows: &[[f32; 8]; 3]| {
            DVec3::new(rows[0][lane].into(), rows[1][lane].into(), rows[2][lane].into())
        };
        [corner(a) * size, corner(b) * size, corner(c) * size]
    }

    #[inline(always)]
    pub fn part(&self, lane: usize) -> u32 {
        self.parts[lane & 7]
    }

    /// All its triangles.
    pub fn parts(&self) -> &[u32] {
        &self.parts[..self.count()]
    }

    /// The number of triangles. They fill the first lanes.
    #[inline(always)]
    pub fn count(&self) -> usize {
        let mut count = 0;
        for part in self.parts {
            count += usize::from(part != u32::MAX);
        }
        count
    }
}

/// A ray for the filter, sheared onto the axis along which it is longest (Woop, Benthin, Wald 2013).
#[derive(Clone, Copy, Debug)]
pub struct ShearedRay {
    axes: [usize; 3],
    shear: [f32; 2],
    /// 1 / direction along the last axis, which turns depths into t.
    inverse: f32,
    origin: [f32; 3],
    /// Error bound of sheared coordinates; `margin` bounds the error of depths, with their rounding.
    error: f32,
    margin: f32,
    /// The ray's t = 0 as a depth, rounded down, and rounded up by more than that.
    start: f32,
    after_start: f32,
}

/// The edge tests of one ray and eight triangles.
pub struct EdgeTest<S> {
    edges: EdgeFunctions<S>,
    /// The depths of the corners, and the difference between the largest and the smallest.
    depths: [S; 3],
    extent: S,
    /// Bounds of the corners' depths.
    near: S,
    far: S,
    /// One bit per triangle: those that may be hit, and those whose inside the ray's line passes for certain.
    live: u32,
    inside: u32,
}

/// The filter's result for eight triangles, one bit each.
#[derive(Clone, Copy, Debug)]
pub struct Classification<L> {
    /// The ray's line hits them for certain.
    pub hit: u32,
    /// To be tested in f64.
    pub unsure: u32,
    /// Bounds of the depths of the certain hits.
    pub near: L,
    far: L,
}

/// Half the distance from 1 to the next f32.
const ROUNDOFF: f32 = f32::EPSILON / 2.0;

/// Relative amount by which both ends of a ray are moved inwards, so that rounding does not cross them.
const INWARDS: f32 = 16.0 * ROUNDOFF;

impl ShearedRay {
    /// Error bounds: corners are off by 1 u, the origin by `reach` u, and their difference by the sum. The shear is at
    /// most 1. It adds the same error again, its own rounding, and that of the product and the difference.
    #[inline(always)]
    pub fn new(ray: &TraversalRay, slabs: &Slabs) -> Self {
        // No closures, and no indexed vectors, which compile to branches.
        let ([x, y, z], [dx, dy]) = (ray.axes, ray.shear);
        let origin = slabs.origin.to_array();
        let reach = 1.0 + slabs.origin.abs().max_element() as f32;
        let error = reach * (8.0 * ROUNDOFF) + 2.0 * slabs.error as f32;
        let start = slabs.start();
        Self {
            axes: ray.axes,
            shear: [dx as f32, dy as f32],
            inverse: slabs.inverse_along(z),
            origin: [origin[x] as f32, origin[y] as f32, origin[z] as f32],
            error,
            margin: 2.0 * error,
            start,
            after_start: start + (start.abs() + 1.0) * INWARDS,
        }
    }

    /// A corner of eight triangles, sheared, with its depth. Both coordinates are negated, which keeps their products.
    #[inline(always)]
    fn place<S: Single<Array = [f32; 8]>>(&self, corner: &[[f32; 8]; 3]) -> (S, S, S) {
        let [x, y, z] = self.axes;
        let x = S::from_array(corner[x]) - S::splat(self.origin[0]);
        let y = S::from_array(corner[y]) - S::splat(self.origin[1]);
        let depth = S::from_array(corner[z]) - S::splat(self.origin[2]);
        let x = S::splat(self.shear[0]).mul_sub(depth, x);
        let y = S::splat(self.shear[1]).mul_sub(depth, y);
        (x, y, depth * S::splat(self.inverse))
    }

    /// Tests the edges of a packet's triangles that may be hit before `limit`.
    #[inline(always)]
    pub fn test_edges<S: Single<Array = [f32; 8]>>(&self, packet: &Packet, limit: f32) -> EdgeTest<S> {
        // No closures here: they would be compiled without the level's instructions.
        let (ax, ay, az) = self.place::<S>(&packet.corners[0]);
        let (bx, by, bz) = self.place::<S>(&packet.corners[1]);
        let (cx, cy, cz) = self.place::<S>(&packet.corners[2]);
        let edges = EdgeFunctions::new([(ax, ay), (bx, by), (cx, cy)], S::splat(self.error));
        let (first, last) = (az.min(bz).min(cz), az.max(bz).max(cz));
        let margin = S::splat(self.margin);
        let (near, far) = (first - margin, last + margin);
        let (start, limit) = (S::splat(self.start), S::splat(limit));
        let live = !edges.missed & near.le_bits(limit) & start.le_bits(far);
        let inside = live & (edges.off.lt_bits(edges.low) | edges.high.lt_bits(-edges.off));
        EdgeTest { edges, depths: [az, bz, cz], extent: last - first, near, far, live, inside }
    }

    /// Bounds of the depths of the triangles, with a margin for the rounding of a depth that is compared with them.
    #[inline(always)]
    pub fn depths<S: Single<Array = [f32; 8]>>(&self, edge_test: &EdgeTest<S>) -> [[f32; 8]; 2] {
        let margin = S::splat(self.margin);
        [(edge_test.near - margin).to_array(), (edge_test.far + margin).to_array()]
    }

    /// Classifies the triangles by their depths.
    #[inline(always)]
    pub fn classify<S: Single>(&self, edge_test: &EdgeTest<S>, limit: f32) -> Classification<S> {
        let &EdgeTest { edges: EdgeFunctions { values: [u, v, w], off, .. }, near, live, inside, .. } =
            edge_test;
        if inside == 0 {
            return Classification { hit: 0, unsure: live, near, far: near };
        }
        // The depth of the hit is a weighted mean of the corners' depths. v and w are off by `off`, their divisor by
        // three times that, and the products by the rounding of depths.
        let [a, b, c] = edge_test.depths;
        let sum = u + v + w;
        let t = a + (v * (b - a) + w * (c - a)) / sum;
        let spread = edge_test.extent * off * S::splat(6.0);
        let least = sum.abs() - off * S::splat(3.0);
        let slack = spread / least + S::splat(self.margin) * S::splat(3.0);
        let (near, far) = ((t - slack).max(near), t + slack);
        let hit = inside & near.le_bits(S::splat(limit)) & S::splat(self.start).le_bits(far);
        Classification { hit, unsure: live & !inside, near, far }
    }

    /// The certain hits that lie between both ends of the ray for certain.
    #[inline(always)]
    pub fn within<S: Single>(&self, classes: &Classification<S>, limit: f32) -> u32 {
        classes.hit & self.between(classes.near, classes.far, limit)
    }

    /// Triangles that the ray hits for certain, because all of the triangle lies between both ends of the ray.
    #[inline(always)]
    pub fn within_whole<S: Single>(&self, edge_test: &EdgeTest<S>, limit: f32) -> u32 {
        edge_test.inside & self.between(edge_test.near, edge_test.far, limit)
    }

    #[inline(always)]
    fn between<S: Single>(&self, near: S, far: S, limit: f32) -> u32 {
        let (start, limit) = (S::splat(self.after_start), S::splat(limit - limit.abs() * INWARDS));
        start.lt_bits(near) & far.lt_bits(limit)
    }
}

/// The edge functions of triangles for a ray, in eight lanes: either the triangles or the rays differ.
struct EdgeFunctions<S> {
    /// The value for each edge; 0 if the ray passes through the edge.
    values: [S; 3],
    /// Error bound of the values.
    off: S,
    low: S,
    high: S,
    /// A bit for each lane in which the ray misses for certain.
    missed: u32,
}

impl<S: Single> EdgeFunctions<S> {
    /// The edge functions of sheared corners, whose coordinates are off by `error`. An edge function is off by
    /// 4·size·error because of the corners and by 4u·size² because of its own rounding. The coordinates are at most 1
    /// / (4u) times the error.
    #[inline(always)]
    fn new([(ax, ay), (bx, by), (cx, cy)]: [(S, S); 3], error: S) -> Self {
        let u = cx.mul_sub(by, cy * bx);
        let v = ax.mul_sub(cy, ay * cx);
        let w = bx.mul_sub(ay, by * ax);
        let size = ax.abs().max(ay.abs());
        let size = size.max(bx.abs().max(by.abs()));
        let size = size.max(cx.abs().max(cy.abs()));
        let off = (size + error) * error * S::splat(8.0);
        let (low, high) = (u.min(v).min(w), u.max(v).max(w));
        let missed = low.lt_bits(-off) & off.lt_bits(high);
        Self { values: [u, v, w], off, low, high, missed }
    }
}

/// Eight rays that are all longest along the same axis, like [`ShearedRay`], to be tested with one triangle.
pub struct ShearedRays<L: Level> {
    axes: [usize; 3],
    shear: [L::F32; 2],
    inverse: L::F32,
    origin: [L::F32; 3],
    error: L::F32,
    margin: L::F32,
}

impl<L: Level> ShearedRays<L> {
    /// The rays must be longest along the last of the axes, onto which `shear` shears them.
    #[inline(always)]
    pub fn new(slabs: &BundleSlabs<L>, axes: [usize; 3], shear: [L::F64; 2]) -> Self {
        let [x, y, z] = axes;
        let all = slabs.origin();
        let reach = all[0].abs().max(all[1].abs()).max(all[2].abs());
        let rounding = (L::F32::splat(1.0) + reach) * L::F32::splat(8.0 * ROUNDOFF);
        let error = rounding + slabs.error() * L::F32::splat(2.0);
        Self {
            axes,
            shear: [shear[0].to_f32(), shear[1].to_f32()],
            inverse: slabs.inverse_along(z),
            origin: [all[x], all[y], all[z]],
            error,
            margin: error * L::F32::splat(2.0),
        }
    }

    #[inline(always)]
    fn place(&self, corner: &[[f32; 8]; 3], lane: usize) -> (L::F32, L::F32, L::F32) {
        let [x, y, z] = self.axes;
        let x = L::F32::splat(corner[x][lane]) - self.origin[0];
        let y = L::F32::splat(corner[y][lane]) - self.origin[1];
        let depth = L::F32::splat(corner[z][lane]) - self.origin[2];
        let x = self.shear[0].mul_sub(depth, x);
        let y = self.shear[1].mul_sub(depth, y);
        (x, y, depth * self.inverse)
    }

    /// The rays that may hit one triangle of a packet up to their limits, a bit each. The rays start near the tree.
    /// The error bounds are those of [`ShearedRay::classify`].
    #[inline(always)]
    pub fn classify(&self, packet: &Packet, lane: usize, limit: L::F32) -> u32 {
        let lane = lane & 7;
        let (ax, ay, az) = self.place(&packet.corners[0], lane);
        let (bx, by, bz) = self.place(&packet.corners[1], lane);
        let (cx, cy, cz) = self.place(&packet.corners[2], lane);
        let EdgeFunctions { missed, .. } = EdgeFunctions::new([(ax, ay), (bx, by), (cx, cy)], self.error);
        let near = az.min(bz).min(cz) - self.margin;
        let far = az.max(bz).max(cz) + self.margin;
        !missed & near.le_bits(limit) & L::F32::splat(0.0).le_bits(far)
    }
}
