//! Eight triangles at a time: the f32 filter before the f64 test of triangles.
//!
//! A filter only says what is sure. Its error bound holds for whatever rounding does to corners, rays and products, so
//! that what it calls missed is missed by the f64 test, and what it calls hit is hit by that.

use super::Parts;
use crate::base::lanes::{Level, Real, Row, Single};
use crate::base::math::DVec3;
use crate::geometry::bvh::{BundleSlabs, Probe, Slabs, Space};

/// The triangles of a leaf, in the space of its tree, one row of numbers after the other.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Packet {
    /// Of each corner, along each axis.
    corners: [[[f32; 8]; 3]; 3],
    parts: [u32; 8],
}

impl Packet {
    pub fn new(space: &Space, leaf: &[u32], parts: &Parts) -> Self {
        // What is no number is not met.
        let mut packet = Self { corners: [[[f32::NAN; 8]; 3]; 3], parts: [u32::MAX; 8] };
        for (lane, &part) in leaf.iter().enumerate().take(8) {
            packet.parts[lane] = part;
            for (rows, corner) in packet.corners.iter_mut().zip(parts.triangles[part as usize]) {
                let rounded = space.point(parts.positions[corner as usize]).as_vec3();
                rows.iter_mut().zip(rounded.to_array()).for_each(|(row, value)| row[lane] = value);
            }
        }
        packet
    }

    /// The corners of a lane's triangle in f64, from what is here and in units of `size`. Only for meshes whose positions
    /// are the same in f32 in their tree's space: the others' must be looked up.
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

    /// How many triangles there are, in the first lanes.
    #[inline(always)]
    pub fn count(&self) -> usize {
        let mut count = 0;
        for part in self.parts {
            count += usize::from(part != u32::MAX);
        }
        count
    }
}

/// A ray as the filter sees it: sheared onto the axis along which it is longest, as Woop, Benthin and Wald (2013) do.
#[derive(Clone, Copy, Debug)]
pub struct Sheared {
    axes: [usize; 3],
    shear: [f32; 2],
    /// 1 / direction along the last axis: depths are t.
    inverse: f32,
    origin: [f32; 3],
    /// How far off sheared coordinates may be, and depths with what rounds them.
    error: f32,
    margin: f32,
    /// The ray's t = 0 as a depth, rounded down, and rounded up by more than that.
    start: f32,
    after_start: f32,
}

/// How a ray passes eight triangles.
pub struct Passed<S> {
    edges: Edges<S>,
    /// Of the corners, and how far those are apart.
    depths: [S; 3],
    extent: S,
    /// No corner is nearer, or farther.
    near: S,
    far: S,
    /// A bit for each triangle that may be met, and for each of them through which the ray's line passes for sure.
    live: u32,
    inside: u32,
}

/// What the filter says of eight triangles, a bit each.
#[derive(Clone, Copy, Debug)]
pub struct Sieve<L> {
    /// Hit by the ray's line for sure.
    pub hit: u32,
    /// To be tested in f64.
    pub unsure: u32,
    /// No hit of those that are sure is nearer, or farther.
    pub near: L,
    far: L,
}

/// Half the distance from 1 to the next f32.
const ROUNDOFF: f32 = f32::EPSILON / 2.0;

/// By more than this share both ends of a ray are not rounded outwards.
const INWARDS: f32 = 16.0 * ROUNDOFF;

impl Sheared {
    /// Coordinates of corners are off by 1 u, those of the origin by `reach` u, and their difference by the sum of both;
    /// the shear is at most 1 and adds as much again, its own rounding, and those of the product and the difference.
    #[inline(always)]
    pub fn new(probe: &Probe, slabs: &Slabs) -> Self {
        // No closures, and no indices into vectors, which are branches.
        let ([x, y, z], [dx, dy]) = (probe.axes, probe.shear);
        let origin = slabs.origin.to_array();
        let reach = 1.0 + slabs.origin.abs().max_element() as f32;
        let error = reach * (8.0 * ROUNDOFF) + 2.0 * slabs.error as f32;
        let start = slabs.start();
        Self {
            axes: probe.axes,
            shear: [dx as f32, dy as f32],
            inverse: slabs.inverse_along(z),
            origin: [origin[x] as f32, origin[y] as f32, origin[z] as f32],
            error,
            margin: 2.0 * error,
            start,
            after_start: start + (start.abs() + 1.0) * INWARDS,
        }
    }

    /// A corner of eight triangles, sheared, with its depth. Both coordinates are turned round, which leaves their
    /// products as they are.
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

    /// Which of a packet's triangles the ray passes through, as far as they may be met before `limit`.
    #[inline(always)]
    pub fn pass<S: Single<Array = [f32; 8]>>(&self, packet: &Packet, limit: f32) -> Passed<S> {
        // No closures here: they would be compiled for less than the lanes need.
        let (ax, ay, az) = self.place::<S>(&packet.corners[0]);
        let (bx, by, bz) = self.place::<S>(&packet.corners[1]);
        let (cx, cy, cz) = self.place::<S>(&packet.corners[2]);
        let edges = Edges::new([(ax, ay), (bx, by), (cx, cy)], S::splat(self.error));
        let (first, last) = (az.min(bz).min(cz), az.max(bz).max(cz));
        let margin = S::splat(self.margin);
        let (near, far) = (first - margin, last + margin);
        let (start, limit) = (S::splat(self.start), S::splat(limit));
        let live = !edges.missed & near.le_bits(limit) & start.le_bits(far);
        let inside = live & (edges.off.lt_bits(edges.low) | edges.high.lt_bits(-edges.off));
        Passed { edges, depths: [az, bz, cz], extent: last - first, near, far, live, inside }
    }

    /// Sifts the triangles by their depths.
    #[inline(always)]
    pub fn sift<S: Single>(&self, passed: &Passed<S>, limit: f32) -> Sieve<S> {
        let &Passed { edges: Edges { numbers: [u, v, w], off, .. }, near, live, inside, .. } = passed;
        if inside == 0 {
            return Sieve { hit: 0, unsure: live, near, far: near };
        }
        // The depth at the hit, between the corners' by weights: v and w are off by `off`, and so, three times, is
        // what they are divided by; their sums with what rounds depths.
        let [a, b, c] = passed.depths;
        let sum = u + v + w;
        let t = a + (v * (b - a) + w * (c - a)) / sum;
        let spread = passed.extent * off * S::splat(6.0);
        let least = sum.abs() - off * S::splat(3.0);
        let slack = spread / least + S::splat(self.margin) * S::splat(3.0);
        let (near, far) = ((t - slack).max(near), t + slack);
        let hit = inside & near.le_bits(S::splat(limit)) & S::splat(self.start).le_bits(far);
        Sieve { hit, unsure: live & !inside, near, far }
    }

    /// Which of the triangles that are hit for sure are so between both ends of the ray.
    #[inline(always)]
    pub fn within<S: Single>(&self, sieve: &Sieve<S>, limit: f32) -> u32 {
        sieve.hit & self.between(sieve.near, sieve.far, limit)
    }

    /// Triangles that are so already because all of them lies there.
    #[inline(always)]
    pub fn within_whole<S: Single>(&self, passed: &Passed<S>, limit: f32) -> u32 {
        passed.inside & self.between(passed.near, passed.far, limit)
    }

    #[inline(always)]
    fn between<S: Single>(&self, near: S, far: S, limit: f32) -> u32 {
        let (start, limit) = (S::splat(self.after_start), S::splat(limit - limit.abs() * INWARDS));
        start.lt_bits(near) & far.lt_bits(limit)
    }
}

/// On which sides of a triangle's edges a ray passes, in eight lanes: either the triangles or the rays differ.
struct Edges<S> {
    /// Of each edge, 0 on it.
    numbers: [S; 3],
    /// How far off they may be.
    off: S,
    low: S,
    high: S,
    /// A bit for each lane in which the ray passes for sure.
    missed: u32,
}

impl<S: Single> Edges<S> {
    /// Of corners that are sheared, whose coordinates are off by `error`. An edge's number is off by 4·size·error for
    /// these and by 4u·size² for its roundings, and the coordinates are at most 1 / (4u) of the error.
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
        Self { numbers: [u, v, w], off, low, high, missed }
    }
}

/// Eight rays that are all longest along the same axis, as [`Sheared`] has one: one triangle is tested with all of them.
pub struct ShearedRays<L: Level> {
    axes: [usize; 3],
    shear: [L::F32; 2],
    inverse: L::F32,
    origin: [L::F32; 3],
    error: L::F32,
    margin: L::F32,
}

impl<L: Level> ShearedRays<L> {
    /// Of rays that are longest along the last of the axes, with their shears onto that.
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

    /// The rays that may hit a packet's triangle from where they start, near its tree, up to their limits, a bit each: by
    /// the bounds of [`Sheared::sift`].
    #[inline(always)]
    pub fn sift(&self, packet: &Packet, lane: usize, limit: L::F32) -> u32 {
        let lane = lane & 7;
        let (ax, ay, az) = self.place(&packet.corners[0], lane);
        let (bx, by, bz) = self.place(&packet.corners[1], lane);
        let (cx, cy, cz) = self.place(&packet.corners[2], lane);
        let Edges { missed, .. } = Edges::new([(ax, ay), (bx, by), (cx, cy)], self.error);
        let near = az.min(bz).min(cz) - self.margin;
        let far = az.max(bz).max(cz) + self.margin;
        !missed & near.le_bits(limit) & L::F32::splat(0.0).le_bits(far)
    }
}
