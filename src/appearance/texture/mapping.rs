//! Mappings from surfaces to patterns and images: scaled, then rotated, then moved, like an object.

use super::{AxisWrap, Footprint, LaneWrap, Wrap};
use crate::base::digest::Content;
use crate::base::lanes::{Mask, Real, Vec3, transform_vector};
use crate::base::math::{DMat3, DQuat, DVec3, gamma};
use crate::base::time::Time;
use crate::geometry::transform::Rotation;
use crate::track::Animated;

/// The coordinates in which a pattern is laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Content)]
pub enum TextureSpace {
    /// Points of the object before it is moved, as in a solid texture.
    #[default]
    Object,
    /// (u, v, 0): the pattern lies on the surface.
    Uv,
}

/// A mapping over time. The point p of the pattern appears at offset + R(scale · p).
#[derive(Clone, Debug, PartialEq)]
pub struct TextureMappingTracks {
    pub offset: Animated<DVec3>,
    pub rotation: Rotation,
    pub scale: Animated<DVec3>,
    /// A map of (u, v, 1) before everything else. Its last row is (0, 0, 1).
    pub first: Option<DMat3>,
}

impl Default for TextureMappingTracks {
    fn default() -> Self {
        Self {
            offset: DVec3::ZERO.into(),
            rotation: Rotation::Quaternion(DQuat::IDENTITY.into()),
            scale: DVec3::ONE.into(),
            first: None,
        }
    }
}

impl TextureMappingTracks {
    /// Whether any part has keys.
    pub fn is_keyed(&self) -> bool {
        let Self { offset, rotation, scale, first: _ } = self;
        offset.is_keyed() || rotation.is_keyed() || scale.is_keyed()
    }
}

/// A mapping at one moment, from the surface back to the pattern.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct TextureMapping {
    offset: DVec3,
    inverse: DMat3,
}

/// How an image repeats along one of its axes, on any surface.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct SurfaceWrap {
    /// On a surface that ends at 0 and 1 of u and v. If the surface ends with a copy of the image, up to rounding, no
    /// other copy follows.
    closed: AxisWrap,
    /// Whether u, and whether v, changes the position along the axis.
    leads: [bool; 2],
}

impl SurfaceWrap {
    /// The same wrap on every surface.
    pub fn fixed(wrap: Wrap) -> Self {
        Self { closed: wrap.into(), leads: [false; 2] }
    }

    /// The wrap on a surface. `ends` says whether the surface ends at 0 and 1 of u, and of v.
    #[inline(always)]
    pub fn resolve<F: Real>(&self, ends: [F::Mask; 2]) -> LaneWrap<F> {
        let leads = self.leads.map(F::Mask::splat);
        self.closed.endless_in((leads[0] & !ends[0]) | (leads[1] & !ends[1]))
    }
}

impl TextureMappingTracks {
    pub fn at(&self, time: Time) -> TextureMapping {
        // If a keyed scale is 0, no point of the pattern is finite.
        let unscaled = DMat3::from_diagonal(self.scale.at(time).recip());
        let inverse = unscaled * self.rotation.at(time).transpose();
        let offset = self.offset.at(time);
        let Some(DMat3 { x_axis, y_axis, z_axis }) = self.first else {
            return TextureMapping { offset, inverse };
        };
        // A p + b - offset is A (p - A⁻¹ (offset - b)). A map that flattens gives no finite point.
        let flat = |v: DVec3| DVec3::new(v.x, v.y, 0.0);
        let linear = DMat3::from_cols(flat(x_axis), flat(y_axis), DVec3::Z);
        TextureMapping { offset: linear.inverse() * (offset - flat(z_axis)), inverse: inverse * linear }
    }
}

impl TextureMapping {
    /// Maps a point of the surface, known within `error`, to the pattern, with its error bound there. The bound
    /// includes a few more roundings than this function makes: those of decimal numbers in the file.
    #[inline(always)]
    pub fn local<F: Real>(&self, point: Vec3<F>, error: Vec3<F>) -> (Vec3<F>, Vec3<F>) {
        let rounding = (point.abs() + Vec3::splat(self.offset.abs())) * F::splat(gamma(10));
        let at = transform_vector(&self.inverse, point - Vec3::splat(self.offset));
        (at, transform_vector(&self.inverse.abs(), error + rounding))
    }

    /// [`TextureMapping::local`] of a point that is known exactly.
    pub fn local_point(&self, point: DVec3) -> (DVec3, DVec3) {
        let (at, error) = self.local::<f64>(point.into(), Vec3::zero());
        (at.into(), error.into())
    }

    /// How a repeated image continues along one of its axes, x or y.
    pub fn surface_wrap(&self, axis: usize) -> SurfaceWrap {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y];
        let corners = corners.map(|corner| {
            let (at, error) = self.local_point(corner);
            (at[axis], error[axis])
        });
        let whole = |(at, error): (f64, f64)| {
            let whole = at.round();
            ((at - whole).abs() <= error).then_some(whole)
        };
        let first = corners.into_iter().fold(corners[0], |a, b| if b.0 < a.0 { b } else { a });
        let last = corners.into_iter().fold(corners[0], |a, b| if b.0 > a.0 { b } else { a });
        let (from, to) = (whole(first).unwrap_or(f64::NEG_INFINITY), whole(last).unwrap_or(f64::INFINITY));
        let closed = if from < to { AxisWrap::repeating(from, to) } else { Wrap::Repeat.into() };
        SurfaceWrap { closed, leads: [0, 1].map(|of: usize| self.inverse.col(of)[axis] != 0.0) }
    }

    /// The footprint in the pattern's coordinates.
    #[inline(always)]
    pub fn footprint<F: Real>(&self, footprint: &Footprint<F>) -> Footprint<F> {
        footprint.moved(&self.inverse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Angle;

    fn placed(offset: DVec3, degrees: f64, scale: DVec3) -> TextureMapping {
        let rotation = Rotation::AxisAngle { axis: DVec3::Z.into(), angle: Angle(degrees).into() };
        TextureMappingTracks { offset: offset.into(), rotation, scale: scale.into(), first: None }
            .at(Time::from_integer(0))
    }

    #[test]
    fn placed_like_an_object() {
        let mapping = placed(DVec3::new(5.0, 0.0, 0.0), 90.0, DVec3::new(2.0, 1.0, 1.0));
        // The pattern's (1, 0, 0) is scaled to (2, 0, 0), turned to (0, 2, 0) and moved to (5, 2, 0).
        assert_eq!(mapping.local_point(DVec3::new(5.0, 2.0, 0.0)).0, DVec3::X);
    }

    #[test]
    fn an_affine_map_comes_first() {
        let first = DMat3::from_cols(
            DVec3::new(0.5, 2.0, 0.0),
            DVec3::new(-1.0, 0.25, 0.0),
            DVec3::new(3.0, -4.0, 1.0),
        );
        let tracks = TextureMappingTracks {
            offset: DVec3::new(1.0, 2.0, 0.0).into(),
            scale: DVec3::splat(2.0).into(),
            first: Some(first),
            ..TextureMappingTracks::default()
        };
        let (at, _) = tracks.at(Time::from_integer(0)).local_point(DVec3::new(0.3, 0.7, 0.0));
        let mapped = first * DVec3::new(0.3, 0.7, 1.0);
        let expected = DVec3::new(0.5 * (mapped.x - 1.0), 0.5 * (mapped.y - 2.0), 0.0);
        assert!((at - expected).length() < 1e-14, "{at} {expected}");
    }

    #[test]
    fn no_placement_changes_nothing() {
        let mapping = TextureMappingTracks::default().at(Time::from_integer(0));
        let point = DVec3::new(0.1, -2.3, 1e9);
        assert_eq!(mapping.local_point(point).0, point);
    }

    #[test]
    fn images_end_where_surfaces_do() {
        let ends = |mapping: &TextureMapping, ends: [bool; 2]| {
            [0, 1].map(|axis| mapping.surface_wrap(axis).resolve::<f64>(ends))
        };
        let repeating = |from: f64, to: f64| AxisWrap::repeating(from, to).splat();
        let on = AxisWrap::from(Wrap::Repeat).splat();
        let one = TextureMappingTracks::default().at(Time::from_integer(0));
        assert_eq!(ends(&one, [true, true]), [repeating(0.0, 1.0); 2]);
        assert_eq!(ends(&one, [false, true]), [on, repeating(0.0, 1.0)]);
        assert_eq!(ends(&one, [false, false]), [on; 2]);
        // Ten copies, although a tenth is not a binary number.
        let small = placed(DVec3::ZERO, 0.0, DVec3::splat(0.1));
        assert_eq!(ends(&small, [true, true]), [repeating(0.0, 10.0); 2]);
        let turned = placed(DVec3::ZERO, 90.0, DVec3::ONE);
        assert_eq!(ends(&turned, [false, true]), [repeating(0.0, 1.0), on]);
        assert_eq!(ends(&turned, [true, true]), [repeating(0.0, 1.0), repeating(-1.0, 0.0)]);
        // If the image is moved by a fraction of itself, it repeats on both sides.
        let moved = placed(DVec3::new(0.25, 0.0, 0.0), 0.0, DVec3::new(1.0, 0.7, 1.0));
        let open = repeating(0.0, f64::INFINITY);
        assert_eq!(ends(&moved, [true, true]), [on, open]);
        assert_eq!(ends(&placed(DVec3::ZERO, 30.0, DVec3::ONE), [true, false]), [on; 2]);
        assert_eq!(
            ends(&placed(DVec3::ZERO, 0.0, DVec3::ZERO), [true, true]),
            [on; 2],
            "while it is nothing"
        );
    }

    #[test]
    fn bounds_cover_decimal_numbers() {
        // In decimals, (0.6 - 0.4) / 0.2 and 0.6 / 0.3 are whole numbers. In binary they are not.
        for (at, offset, scale, whole) in [(0.6, 0.4, 0.2, 1.0), (0.6, 0.0, 0.3, 2.0), (0.7, 0.1, 0.1, 6.0)] {
            let mapping = placed(DVec3::splat(offset), 0.0, DVec3::splat(scale));
            let (point, error) = mapping.local_point(DVec3::splat(at));
            assert!((point - whole).abs().cmple(error).all() && error.max_element() < 1e-13);
        }
    }
}
