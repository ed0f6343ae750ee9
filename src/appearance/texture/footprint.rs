//! The footprint of a ray on a surface, and the contrast that is left of cells below its size.

use crate::base::lanes::{Real, Select, Vec3, transform_vector};
use crate::base::math::{DMat3, DVec2, DVec3};

/// The ellipse that a ray cone covers on a surface, by two diameters that span it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint<F = f64>(pub [Vec3<F>; 2]);

/// The longest diameter. A longer one would change nothing.
const LONGEST: f64 = 1e60;

impl<F: Real> Footprint<F> {
    /// That of a point.
    #[inline(always)]
    pub fn zero() -> Self {
        Self([Vec3::zero(); 2])
    }

    /// The footprint of a round beam of this width along a unit vector, on a surface with this unit normal.
    #[inline(always)]
    pub fn new(width: F, direction: Vec3<F>, normal: Vec3<F>) -> Self {
        let across = normal.cross(direction).normalize_or(any_across(normal));
        // At grazing angles the footprint grows without bound.
        let long = (width / normal.dot(direction).abs()).min(F::splat(LONGEST));
        let found = Self([across * width, normal.cross(across) * long]);
        Self::select(width.eq(F::splat(0.0)), Self::zero(), found)
    }

    #[inline(always)]
    pub fn moved(&self, by: &DMat3) -> Self {
        let [a, b] = self.0;
        Self([transform_vector(by, a), transform_vector(by, b)])
    }

    /// The extent along each axis, from side to side.
    #[inline(always)]
    pub fn extent(&self) -> Vec3<F> {
        let [a, b] = self.0;
        let squares = a.mul_each(a) + b.mul_each(b);
        Vec3::new(squares.x.sqrt(), squares.y.sqrt(), squares.z.sqrt())
    }
}

/// A unit vector across a unit vector (Duff et al., "Building an orthonormal basis, revisited", 2017).
#[inline(always)]
fn any_across<F: Real>(n: Vec3<F>) -> Vec3<F> {
    let sign = F::splat(1.0).copysign(n.z);
    let a = F::splat(-1.0) / (sign + n.z);
    Vec3::new(n.x * n.y * a, sign + n.y * n.y * a, -n.y)
}

impl<F: Real> Select<F::Mask> for Footprint<F> {
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        let ([a, b], [c, d]) = (yes.0, no.0);
        Self([Vec3::select(mask, a, c), Vec3::select(mask, b, d)])
    }
}

impl Footprint {
    /// The footprint in the coordinates `uv` of points near `at`. Differences are taken on both sides of the point, and
    /// the smaller one counts: a seam of the coordinates affects only one side.
    pub fn to_uv(&self, at: DVec3, uv: impl Fn(DVec3) -> DVec2) -> Self {
        let here = uv(at);
        let span = |diameter: Vec3<f64>| {
            let diameter = DVec3::from(diameter);
            let (forth, back) = (uv(at + diameter * 0.5) - here, here - uv(at - diameter * 0.5));
            (forth.abs().min(back.abs()) * 2.0).extend(0.0).into()
        };
        let [a, b] = self.0;
        Self([span(a), span(b)])
    }
}

/// The contrast that is left of alternating cells of width 1 if a pixel covers `width` of them. It is 1 up to half a
/// cell and 0 from one cell on, where the pixels no longer resolve the cells (Nyquist). NaN gives 0.
pub fn contrast(width: f64) -> f64 {
    if width <= 0.5 { 1.0 } else { (2.0 - 2.0 * width).max(0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// Reference: points all around the beam, each projected to the surface.
    #[test]
    fn footprints_reach_as_far_as_their_beams() {
        let mut random = Random(31);
        for _ in 0..200 {
            let (direction, normal) = (random.direction(), random.direction());
            let (u, v) = direction.any_orthonormal_pair();
            let mut reach = DVec3::ZERO;
            for k in 0..3600 {
                let turn = crate::base::math::Angle(0.1 * f64::from(k)).cos_sin();
                let edge = (u * turn.x + v * turn.y) * 0.35;
                reach = reach.max((edge - direction * (edge.dot(normal) / direction.dot(normal))).abs());
            }
            let extent = DVec3::from(Footprint::new(0.7, direction.into(), normal.into()).extent());
            assert!((extent - reach * 2.0).abs().max_element() <= 1e-5 * extent.max_element(), "{extent}");
        }
    }

    #[test]
    fn footprints_ignore_the_seam_of_coordinates() {
        let around = |p: DVec3| DVec2::new(p.x.rem_euclid(1.0), 2.0 * p.y);
        let footprint = Footprint([DVec3::X * 0.125, DVec3::Y * 0.25].map(Vec3::from));
        for x in [0.0, 0.0625, 0.5, 0.96875] {
            let extent = footprint.to_uv(DVec3::X * x, around).extent();
            assert_eq!(extent, DVec3::new(0.125, 0.5, 0.0).into());
        }
    }

    #[test]
    fn contrast_ends_at_cells_of_one_pixel() {
        let left = [0.0, 0.5, 0.75, 1.0, 9.0, f64::INFINITY, f64::NAN].map(contrast);
        assert_eq!(left, [1.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0]);
    }
}
