//! Eight spheres at a time: the f32 filter before the f64 test of spheres.
//!
//! A filter only says what is sure: its error bound holds for whatever rounding does to spheres, rays and products, so
//! that what it calls missed is missed by the f64 test.

use crate::scene::{Geometry, Primitive};
use crate::shape::Shape;
use crate::simd::{Lanes, Octo, Vector};
use crate::tree::{BundleSlabs, Contents, Probe, Slabs, Space};

/// The packs of a tree's leaves.
#[derive(Clone, Debug, Default)]
pub struct Packs {
    /// The pack of each leaf, or [`NONE`]; nothing at all if there are none.
    of_leaves: Vec<u32>,
    balls: Vec<Balls>,
}

const NONE: u32 = u32::MAX;

impl Packs {
    /// Of leaves with several things, all of which are such as [`is_ball`] says.
    pub fn new(space: &Space, leaves: &Contents, geometry: &Geometry) -> Self {
        let mut packs = Self::default();
        for leaf in 0..leaves.len() as u32 {
            let things = leaves.leaf(leaf);
            if things.len() > 1 {
                packs.of_leaves.resize(leaf as usize, NONE);
                packs.of_leaves.push(packs.balls.len() as u32);
                packs.balls.push(Balls::new(space, things, geometry));
            }
        }
        packs
    }

    pub fn is_empty(&self) -> bool {
        self.balls.is_empty()
    }

    #[inline(always)]
    pub fn of(&self, leaf: u32) -> Option<&Balls> {
        let pack = self.of_leaves.get(leaf as usize)?;
        self.balls.get(*pack as usize)
    }
}

/// Whether a primitive is a sphere as it is, not one with a space of its own.
pub fn is_ball(primitive: &Primitive) -> bool {
    matches!(primitive, Primitive { shape: Shape::Sphere(_), placement: None, .. })
}

/// Up to eight spheres in the space of a tree, one row of numbers after the other.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Balls {
    center: [[f32; 8]; 3],
    radius: [f32; 8],
    primitives: [u32; 8],
    count: usize,
}

impl Balls {
    fn new(space: &Space, things: &[u32], geometry: &Geometry) -> Self {
        // What is no number is not met.
        let mut balls = Self {
            center: [[f32::NAN; 8]; 3],
            radius: [f32::NAN; 8],
            primitives: [0; 8],
            count: things.len().min(8),
        };
        for (lane, &thing) in things.iter().enumerate().take(8) {
            if let Shape::Sphere(sphere) = &geometry.primitives[thing as usize].shape {
                let center = space.point(sphere.center).as_vec3().to_array();
                balls.center.iter_mut().zip(center).for_each(|(row, value)| row[lane] = value);
                balls.radius[lane] = (sphere.radius * space.per) as f32;
                balls.primitives[lane] = thing;
            }
        }
        balls
    }

    #[inline(always)]
    pub fn primitive(&self, lane: usize) -> u32 {
        self.primitives[lane & 7]
    }

    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }
}

/// Half the distance from 1 to the next f32.
const ROUNDOFF: f32 = f32::EPSILON / 2.0;

/// By how much spheres are widened, for rays whose origin is off by `error` and, along each axis, within R - 1 of the
/// tree's centre; spheres are within 1 of it.
///
/// The vector f from the origin to a centre has components below R, each off by 2uR + `error` for the roundings of both
/// ends and of the difference: 3.5uR + 1.8 `error` in length. The direction d, at its longest component 1 to 2, is off by
/// u of its length; f·d / d² by 9u of |f| / |d|; and the vector from the centre to the line by u of |f| for the product and
/// by as much for the difference. With |f| at most 1.8R that is E = 26uR + 2 `error` in all. The way to where the line
/// enters a sphere is off by no more, if half its chord is taken as that of a sphere that is wider by 2E; and the
/// squares that are compared are off by 4u each, which is as if radii were off by 4u.
/// What the f64 test rounds, a few u² of the way, is below `error`.
#[inline(always)]
fn widening<L: Lanes>(reach: L, error: L) -> L {
    reach.times(L::splat(64.0 * ROUNDOFF)).plus(error.times(L::splat(8.0)))
}

/// A ray as the filter sees it.
pub struct Line {
    origin: [f32; 3],
    direction: [f32; 3],
    per_square: f32,
    /// The largest of the origin's coordinates and 1, and how far off the origin is.
    reach: f32,
    error: f32,
    start: f32,
}

impl Line {
    #[inline(always)]
    pub fn new(slabs: &Slabs, probe: &Probe) -> Self {
        let (origin, direction) = (slabs.origin.as_vec3(), slabs.direction(probe).as_vec3());
        Self {
            origin: origin.to_array(),
            direction: direction.to_array(),
            per_square: 1.0 / direction.length_squared(),
            reach: 1.0 + origin.abs().max_element(),
            error: slabs.widened_error() as f32,
            start: slabs.start(),
        }
    }

    /// The spheres that may be met before `limit`, a bit each, and where at the earliest.
    #[inline(always)]
    pub fn sift<L: Lanes>(&self, balls: &Balls, limit: f32) -> (u32, L) {
        // No closures here: they would be compiled for less than the lanes need.
        let [dx, dy, dz] =
            [L::splat(self.direction[0]), L::splat(self.direction[1]), L::splat(self.direction[2])];
        let x = L::load(&balls.center[0]).minus(L::splat(self.origin[0]));
        let y = L::load(&balls.center[1]).minus(L::splat(self.origin[1]));
        let z = L::load(&balls.center[2]).minus(L::splat(self.origin[2]));
        let middle = x.times(dx).plus(y.times(dy)).plus(z.times(dz)).times(L::splat(self.per_square));
        let (x, y, z) = (dx.times_minus(middle, x), dy.times_minus(middle, y), dz.times_minus(middle, z));
        let apart = x.times(x).plus(y.times(y)).plus(z.times(z));
        let radius = L::load(&balls.radius).plus(widening(L::splat(self.reach), L::splat(self.error)));
        let near = middle.minus(radius);
        let ahead = L::splat(self.start).at_most(middle.plus(radius));
        (apart.at_most(radius.times(radius)) & near.at_most(L::splat(limit)) & ahead, near)
    }
}

/// Eight rays as the filter sees them.
pub struct Lines<L> {
    origin: [L; 3],
    direction: [L; 3],
    per_square: L,
    widening: L,
}

impl<L: Lanes> Lines<L> {
    /// Rays that are near the tree.
    #[inline(always)]
    pub fn new(slabs: &BundleSlabs<L>, direction: Vector<L::Quad>) -> Self {
        let per = Octo::splat(1.0) / direction.longest().power_of_two();
        let [x, y, z] = [
            L::load(&(direction.x * per).narrow()),
            L::load(&(direction.y * per).narrow()),
            L::load(&(direction.z * per).narrow()),
        ];
        let square = x.times(x).plus(y.times(y)).plus(z.times(z));
        let [a, b, c] = slabs.origin();
        let reach = L::splat(1.0).plus(a.absolute().larger(b.absolute()).larger(c.absolute()));
        Self {
            origin: [a, b, c],
            direction: [x, y, z],
            per_square: L::splat(1.0).over(square),
            widening: widening(reach, slabs.error()),
        }
    }

    /// The rays that may meet a sphere before their limits, a bit each.
    #[inline(always)]
    pub fn meeting(&self, balls: &Balls, lane: usize, limit: L) -> u32 {
        let lane = lane & 7;
        let [dx, dy, dz] = self.direction;
        let x = L::splat(balls.center[0][lane]).minus(self.origin[0]);
        let y = L::splat(balls.center[1][lane]).minus(self.origin[1]);
        let z = L::splat(balls.center[2][lane]).minus(self.origin[2]);
        let middle = x.times(dx).plus(y.times(dy)).plus(z.times(dz)).times(self.per_square);
        let (x, y, z) = (dx.times_minus(middle, x), dy.times_minus(middle, y), dz.times_minus(middle, z));
        let apart = x.times(x).plus(y.times(y)).plus(z.times(z));
        let radius = L::splat(balls.radius[lane]).plus(self.widening);
        let ahead = L::splat(0.0).at_most(middle.plus(radius));
        apart.at_most(radius.times(radius)) & middle.minus(radius).at_most(limit) & ahead
    }
}
