//! One thing to hit: a shape, where it is, and what it is made of.

use crate::camera::Ray;
use crate::digest::content;
use crate::material::MadeOf;
use crate::math::{Aabb, DAffine3, DMat3, DVec2, DVec3, dot_plus, gamma};
use crate::sampling::Frame;
use crate::shape::{Crossing, Crossings, Rays, Shape, Surface, Surfaces};
use crate::simd::Lanes;
use crate::tree::{Probe, Stack};

/// A shape in the world. Most shapes are moved there once ([`Shape::transformed`]); the others keep their own
/// space and have rays moved into it.
#[derive(Clone, Debug, PartialEq)]
pub struct Primitive {
    pub shape: Shape,
    pub placement: Option<Box<Placement>>,
    pub finish: Finish,
}

content!(struct Primitive { shape, placement, finish });

/// What a primitive looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    Material(MadeOf),
    /// Index into the scene's lights: the primitive is that light.
    Light(u32),
}

content!(
    enum Finish {
        Material(made_of),
        Light(index),
    }
);

/// A shape's own space within the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    pub to_world: DAffine3,
    /// The way back of directions. That of points begins with the difference to where the shape's origin is in the world, so
    /// that what rounding does to them does not grow with their distance from the world's origin.
    back: DMat3,
    /// How far a ray that starts at a point of the surface may start from there in the shape's space.
    apart: f64,
}

content!(struct Placement { to_world, back, apart });

impl Primitive {
    /// `shape` placed by `to_world`; none if that flattens it (a scale of 0 hides an object).
    pub fn new(shape: &Shape, to_world: DAffine3, finish: Finish) -> Option<Self> {
        let to_object = inverse(&to_world)?;
        Some(match shape.transformed(&to_world) {
            Some(shape) => Self { shape, placement: None, finish },
            None => {
                let placement = Some(Box::new(Placement::new(shape, to_world, to_object.matrix3)));
                Self { shape: shape.clone(), placement, finish }
            }
        })
    }

    /// Index of the material of a part of the shape; none for lights.
    #[inline]
    pub fn material(&self, part: u32) -> Option<u32> {
        match self.finish {
            Finish::Material(MadeOf::One(index)) => Some(index),
            Finish::Material(MadeOf::Slots { first, count }) => {
                let slot = match &self.shape {
                    Shape::Mesh(shape) => shape.mesh.material_of(part),
                    _ => None,
                };
                Some(first + slot.map_or(count, u32::from))
            }
            Finish::Light(_) => None,
        }
    }

    /// Indices of all materials that are seen somewhere on it.
    pub fn materials(&self) -> impl Iterator<Item = u32> {
        let Finish::Material(made_of) = self.finish else { return None.into_iter().flatten() };
        Some(made_of.indices()).into_iter().flatten()
    }

    /// The smallest t in 0 < t < `t_max` at which the ray meets the primitive. A ray moved into the shape's
    /// space keeps its t, as its direction is not normalised.
    #[inline]
    pub fn hit(&self, probe: &Probe, t_max: f64) -> Option<Crossing> {
        self.hit_after(probe, 0.0, t_max)
    }

    /// [`Primitive::hit`] beyond another t, as [`Geometric::hit_after`](crate::shape::Geometric::hit_after) has it.
    #[inline]
    pub fn hit_after(&self, probe: &Probe, after: f64, t_max: f64) -> Option<Crossing> {
        match &self.placement {
            None => self.shape.hit_after(probe, after, t_max),
            Some(placement) => {
                self.shape.hit_after(&Probe::new(placement.ray_to_object(&probe.ray)), after, t_max)
            }
        }
    }

    /// Adds all crossings in `after` < t < `t_max`.
    pub fn crossings(&self, probe: &Probe, after: f64, t_max: f64, found: &mut Vec<Crossing>) {
        match &self.placement {
            None => self.shape.crossings(probe, after, t_max, found),
            Some(placement) => {
                self.shape.crossings(&Probe::new(placement.ray_to_object(&probe.ray)), after, t_max, found);
            }
        }
    }

    /// [`Primitive::hit`] on lanes that are at work already.
    #[inline(always)]
    pub fn hit_on<L: Lanes>(&self, probe: &Probe, t_max: f64, stack: &mut Stack) -> Option<Crossing> {
        match (&self.shape, &self.placement) {
            (Shape::Mesh(mesh), None) => mesh.hit_on::<L>(probe, t_max, stack),
            (Shape::Mesh(mesh), Some(placement)) => {
                mesh.hit_on::<L>(&Probe::new(placement.ray_to_object(&probe.ray)), t_max, stack)
            }
            _ => self.hit(probe, t_max),
        }
    }

    /// [`Primitive::blocks`] likewise.
    #[inline(always)]
    pub fn blocks_on<L: Lanes>(&self, probe: &Probe, t_max: f64, stack: &mut Stack) -> bool {
        match (&self.shape, &self.placement) {
            (Shape::Mesh(mesh), None) => mesh.blocks_on::<L>(probe, t_max, stack),
            (Shape::Mesh(mesh), Some(placement)) => {
                mesh.blocks_on::<L>(&Probe::new(placement.ray_to_object(&probe.ray)), t_max, stack)
            }
            _ => self.blocks(probe, t_max),
        }
    }

    /// [`Primitive::hit`] of those of eight rays whose bits are set.
    #[inline(always)]
    pub fn hit_together<L: Lanes>(&self, rays: &Rays, wanted: u32, limit: &[f64; 8]) -> Crossings {
        match &self.placement {
            None => self.shape.hit_together::<L>(rays, wanted, limit),
            Some(placement) => self.shape.hit_together::<L>(&placement.rays_to_object(rays), wanted, limit),
        }
    }

    /// [`Primitive::blocks`] of those of eight rays whose bits are set, a bit each.
    #[inline(always)]
    pub fn blocks_together<L: Lanes>(&self, rays: &Rays, wanted: u32, t_max: &[f64; 8]) -> u32 {
        match &self.placement {
            None => self.shape.blocks_together::<L>(rays, wanted, t_max),
            Some(placement) => {
                self.shape.blocks_together::<L>(&placement.rays_to_object(rays), wanted, t_max)
            }
        }
    }

    /// [`Primitive::surface`] where those of eight rays meet the primitive whose bits are set.
    #[inline(always)]
    pub fn surface_together<L: Lanes>(&self, rays: &Rays, at: &Crossings, wanted: u32) -> Surfaces {
        if self.placement.is_none() {
            return self.shape.surface_together::<L>(rays, at, wanted);
        }
        Surfaces::one_by_one(wanted, |lane| self.surface(&rays.one(lane), at.one(lane)))
    }

    /// Whether the ray meets the primitive in 0 < t < `t_max`.
    #[inline]
    pub fn blocks(&self, probe: &Probe, t_max: f64) -> bool {
        match &self.placement {
            None => self.shape.blocks(probe, t_max),
            Some(placement) => self.shape.blocks(&Probe::new(placement.ray_to_object(&probe.ray)), t_max),
        }
    }

    /// The surface where [`Primitive::hit`] found the ray to meet it.
    pub fn surface(&self, ray: &Ray, at: Crossing) -> Surface {
        match &self.placement {
            None => self.shape.surface(ray, at),
            Some(placement) => placement.surface(&self.shape, ray, at),
        }
    }

    /// The surface for a ray that passes it, a little off the edges of its triangle if it is one of a mesh: so far inside
    /// that the ray starts beyond its neighbours as well, which it meets in the same place if it comes to an edge. Of a
    /// closed mesh it then enters one triangle, not two.
    pub fn passed(&self, surface: Surface, part: u32) -> Surface {
        let Shape::Mesh(shape) = &self.shape else { return surface };
        let corners = shape.mesh.corners(part);
        match &self.placement {
            None => surface.clear_of_edges(corners),
            Some(placement) => {
                surface.clear_of_edges(corners.map(|corner| placement.to_world.transform_point3(corner)))
            }
        }
    }

    /// A point of the surface that `from` may see, with its part and its density per solid angle there; none
    /// if the shape has no area to choose from. See [`Geometric::sample_from`](crate::shape::Geometric::sample_from).
    pub fn sample_from(&self, from: DVec3, frame: &Frame, u: DVec2) -> Option<(Surface, u32, f64)> {
        let Some(placement) = &self.placement else { return self.shape.sample_from(from, frame, u) };
        let (local, part) = self.shape.sample_area(u)?;
        let surface = placement.moved(&local);
        let density = self.density_from(from, &surface)?;
        Some((surface, part, density))
    }

    /// The density per solid angle with which [`Primitive::sample_from`] gives the point `at`.
    pub fn density_from(&self, from: DVec3, at: &Surface) -> Option<f64> {
        match &self.placement {
            None => self.shape.density_from(from, at),
            Some(placement) => {
                at.density_from(from, 1.0 / (self.shape.area()? * placement.stretch(at.normal)))
            }
        }
    }

    /// Whether [`Primitive::sample_from`] can find points.
    pub fn has_area(&self) -> bool {
        self.shape.area().is_some()
    }

    /// A box of the world around the primitive; none if it is infinite.
    pub fn bounds(&self) -> Option<Aabb> {
        let bounds = self.shape.bounds()?;
        Some(self.placement.as_ref().map_or(bounds, |placement| bounds.transformed(&placement.to_world)))
    }
}

impl Placement {
    fn new(shape: &Shape, to_world: DAffine3, back: DMat3) -> Self {
        let placement = Self { to_world, back, apart: 0.0 };
        let apart = shape.bounds().map_or(0.0, |bounds| placement.apart(bounds));
        Self { apart, ..placement }
    }

    /// How far the origin of a ray that starts at a point of a shape within `bounds` may lie from that point in the
    /// shape's space: the point's error in the world, the way along the normal past it, and the rounding of the way
    /// back. No shape states a larger error of its own than gamma(64) of its coordinates.
    fn apart(&self, bounds: Aabb) -> f64 {
        let farthest = bounds.min.abs().max(bounds.max.abs());
        let (back, reach) = (self.back.abs(), self.to_world.matrix3.abs() * farthest);
        let error = self.error(farthest, DVec3::splat(farthest.length() * gamma(64)), reach);
        let in_world = reach + self.to_world.translation.abs();
        let moved = DVec3::splat(2.0 * error.length() + in_world.max_element() * gamma(2));
        (back * moved).length() + (back * reach * gamma(5)).length()
    }

    fn ray_to_object(&self, ray: &Ray) -> Ray {
        let origin = self.back * (ray.origin - self.to_world.translation);
        Ray { origin, direction: self.back * ray.direction }
    }

    #[inline(never)]
    fn rays_to_object(&self, rays: &Rays) -> Rays {
        let each: [_; 8] = std::array::from_fn(|lane| self.ray_to_object(&rays.one(lane)));
        Rays::gather(8, |lane| &each[lane])
    }

    /// The shape's own error moved to the world, plus the rounding of the move there and, as the next ray
    /// from this point is moved back into the shape's space, of the way back.
    fn surface(&self, shape: &Shape, ray: &Ray, at: Crossing) -> Surface {
        self.moved(&shape.surface_apart(&self.ray_to_object(ray), at, self.apart))
    }

    /// By how much areas across the world's unit vector `normal` have grown: those across a moved normal
    /// change by the determinant times the length of M⁻ᵀ n, and the way back is the inverse.
    fn stretch(&self, normal: DVec3) -> f64 {
        let back = (self.to_world.matrix3.transpose() * normal).length();
        self.to_world.matrix3.determinant().abs() / back
    }

    /// The error in the world of a point that is known to `error` in the shape's space; of the point, and of its way from
    /// the shape's origin in the world, the absolute values.
    fn error(&self, local: DVec3, error: DVec3, way: DVec3) -> DVec3 {
        let (forth, back) = (abs(&self.to_world), self.back.abs());
        let there = forth.transform_point3(local) * gamma(5);
        // A difference, three products, and the matrix.
        let and_back = forth.transform_vector3(back * way) * gamma(5);
        forth.transform_vector3(error) + there + and_back
    }

    fn moved(&self, local: &Surface) -> Surface {
        let point = self.to_world.transform_point3(local.point);
        let way = (point - self.to_world.translation).abs();
        let error = self.error(local.point.abs(), local.error, way);
        let turned = |normal: DVec3| (self.back.transpose() * normal).normalize_or(normal);
        // An uneven scale may turn the shading normal past the surface's horizon.
        let lift = self.to_world.transform_vector3(local.lift);
        Surface { lift, ..Surface::new(point, error, turned(local.normal)).shaded(turned(local.shading)) }
    }
}

/// The inverse of an affine map, refined once; none if it is singular or not finite.
pub(super) fn inverse(affine: &DAffine3) -> Option<DAffine3> {
    let m = affine.matrix3;
    let determinant = m.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    let first = m.inverse();
    // Newton's step squares the error that cancellation left in the cofactors of a badly scaled matrix, if what is left to
    // the identity has its digits.
    let rows = m.transpose();
    let left = |column: DVec3, unit: DVec3| {
        let minus = |row: DVec3, one: f64| dot_plus(-row, column, one);
        let DVec3 { x, y, z } = unit;
        DVec3::new(minus(rows.x_axis, x), minus(rows.y_axis, y), minus(rows.z_axis, z))
    };
    let left = DMat3::from_cols(
        left(first.x_axis, DVec3::X),
        left(first.y_axis, DVec3::Y),
        left(first.z_axis, DVec3::Z),
    );
    let matrix3 = first + first * left;
    let inverse = DAffine3 { matrix3, translation: -(matrix3 * affine.translation) };
    inverse.is_finite().then_some(inverse)
}

pub(super) fn abs(affine: &DAffine3) -> DAffine3 {
    DAffine3 { matrix3: affine.matrix3.abs(), translation: affine.translation.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::UNIT_ROUNDOFF;
    use crate::shape::Sphere;

    const UNIT: Shape = Shape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 });

    #[test]
    fn xf_02_ellipsoids_are_hit_in_world_units() {
        let scale = DAffine3::from_scale(DVec3::new(3.0, 1.0, 0.5));
        let ray = Ray { origin: DVec3::new(10.0, 0.2, 0.1), direction: DVec3::NEG_X };
        let hit = |affine: DAffine3, ray: Ray| {
            let primitive =
                Primitive::new(&UNIT, affine, Finish::Material(MadeOf::One(0))).expect("a primitive");
            primitive.hit(&Probe::new(ray), f64::INFINITY).expect("a hit").t
        };
        let t = hit(scale, ray);
        assert!((t - 7.122_501_086_012_368).abs() <= 8.0 * UNIT_ROUNDOFF * t, "{t}");
        let turn = DAffine3::from_mat3_translation(
            crate::math::axis_angle(DVec3::Z, crate::math::Angle(30.0)),
            DVec3::new(100.0, 0.0, 0.0),
        );
        let moved = Ray {
            origin: turn.transform_point3(ray.origin),
            direction: turn.transform_vector3(ray.direction),
        };
        let t = hit(turn * scale, moved);
        assert!((t - 7.122_501_086_012_368).abs() <= 8.0 * UNIT_ROUNDOFF * 110.0, "{t}");
    }

    #[test]
    fn xf_04_badly_scaled_transforms_invert() {
        let turn = crate::math::axis_angle(DVec3::new(0.6, 0.48, 0.64), crate::math::Angle(40.0));
        let m = DMat3::from_diagonal(DVec3::new(1e3, 1e-3, 1.0)) * turn;
        let back = inverse(&DAffine3::from_mat3(m)).expect("an inverse");
        let off = (m * back.matrix3 - DMat3::IDENTITY).abs();
        assert!(off.x_axis.max(off.y_axis).max(off.z_axis).max_element() <= 1e-9);
        assert_eq!(inverse(&DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))), None);
        assert_eq!(inverse(&DAffine3::from_scale(DVec3::new(1.0, f64::NAN, 1.0))), None);
    }

    #[test]
    fn xf_01_normals_of_uneven_scales() {
        let affine = DAffine3::from_scale(DVec3::new(2.0, 1.0, 1.0));
        let primitive = Primitive::new(&UNIT, affine, Finish::Material(MadeOf::One(0))).expect("a primitive");
        let n = DVec3::new(1.0, 1.0, 0.0).normalize();
        let ray = Ray { origin: affine.transform_point3(n * 3.0), direction: -affine.transform_vector3(n) };
        let surface = primitive.surface(&ray, Crossing::at(2.0));
        assert!((surface.normal - DVec3::new(1.0, 2.0, 0.0).normalize()).length() < 1e-15);
    }
}
