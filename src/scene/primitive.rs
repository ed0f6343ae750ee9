//! One thing to hit: a shape, where it is, and what it is made of.

use crate::appearance::material::MadeOf;
use crate::base::digest::content;
use crate::base::lanes::{Level, Real, Vec3, out_of_line, turned};
use crate::base::math::{Aabb, DAffine3, DMat3, DVec3, LaneRay, Ray, dot_plus, gamma};
use crate::geometry::bvh::{Probe, Stack};
use crate::geometry::shape::{
    Crossing, LaneHit, LaneSurface, PreparedRay, Shape, Span, Surface, TriangleLanes,
};
use crate::sampling::Frame;

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

    /// Whether it is a light.
    pub fn is_light(&self) -> bool {
        matches!(self.finish, Finish::Light(_))
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

    /// The smallest t within bounds at which each ray meets the primitive. Rays moved into the shape's
    /// space keep their t, as their directions are not normalised.
    #[inline(always)]
    pub fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: Span<F>) -> LaneHit<F> {
        match &self.placement {
            None => self.shape.intersect(ray, within),
            Some(placement) => intersect_placed(&self.shape, placement, ray, within),
        }
    }

    /// Rays that meet the primitive within bounds.
    #[inline(always)]
    pub fn occludes<F: Real>(&self, ray: &PreparedRay<F>, within: Span<F>) -> F::Mask {
        match &self.placement {
            None => self.shape.occludes(ray, within),
            Some(placement) => occludes_placed(&self.shape, placement, ray, within),
        }
    }

    /// [`Primitive::intersect`] of one ray.
    #[inline(always)]
    pub fn hit_one<L: Level>(
        &self,
        probe: &Probe,
        within: Span<f64>,
        stack: Option<&mut Stack>,
    ) -> Option<Crossing> {
        match &self.placement {
            None => self.shape.hit_one::<L>(probe, within, stack),
            Some(placement) => self.shape.hit_one::<L>(&placement.probe_to_object(probe), within, stack),
        }
    }

    /// [`Primitive::occludes`] of one ray.
    #[inline(always)]
    pub fn blocks_one<L: Level>(&self, probe: &Probe, within: Span<f64>, stack: Option<&mut Stack>) -> bool {
        match &self.placement {
            None => self.shape.blocks_one::<L>(probe, within, stack),
            Some(placement) => self.shape.blocks_one::<L>(&placement.probe_to_object(probe), within, stack),
        }
    }

    /// Gives all crossings of one ray within bounds to `take`. A ray that passes a surface straight on is asked for its next
    /// crossing, not moved: so each is found once, however near they are to each other.
    pub fn each_crossing<L: Level>(
        &self,
        probe: &Probe,
        mut within: Span<f64>,
        take: &mut dyn FnMut(Crossing),
    ) {
        let own = self.placement.as_ref().map(|placement| placement.probe_to_object(probe));
        let probe = own.as_ref().unwrap_or(probe);
        if let Shape::Mesh(mesh) = &self.shape {
            return mesh.each(probe, within, take);
        }
        while let Some(at) = self.shape.hit_one::<L>(probe, within, None) {
            take(at);
            within.min = at.t;
        }
    }

    /// The surface where [`Primitive::intersect`] found rays to meet it.
    #[inline(always)]
    pub fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>) -> LaneSurface<F> {
        let placement = self.placement.as_deref();
        // No closures: they would be compiled without the level's instructions.
        let (own, apart) = match placement {
            Some(placement) => (placement.ray_to_object(ray), placement.apart),
            None => (*ray, 0.0),
        };
        let local = self.shape.surface(&own, at, apart);
        match placement {
            Some(placement) => placement.moved(&local),
            None => local,
        }
    }

    /// The surface for rays that pass it, a little off the edges of its triangles if it is a mesh: so far inside
    /// that the ray starts beyond its neighbours as well, which it meets in the same place if it comes to an edge. Of a
    /// closed mesh it then enters one triangle, not two.
    #[inline(always)]
    pub fn passed<F: Real>(&self, surface: LaneSurface<F>, part: F::U32) -> LaneSurface<F> {
        let Shape::Mesh(shape) = &self.shape else { return surface };
        let mut corners = shape.triangle(part).corners;
        if let Some(placement) = &self.placement {
            for corner in &mut corners {
                *corner = transformed(&placement.to_world, *corner);
            }
        }
        surface.clear_of_edges(&TriangleLanes { corners })
    }

    /// Points of the surface that `from` may see, with their parts and their densities per steradian there; 0 where
    /// nothing is seen. Only for shapes that have an [area](Primitive::has_area).
    #[inline(always)]
    pub fn sample_from<F: Real>(
        &self,
        from: Vec3<F>,
        eye: &Frame<F>,
        u: F,
        v: F,
    ) -> (LaneSurface<F>, F::U32, F) {
        sample(self, from, eye, u, v)
    }

    /// The density per steradian with which [`Primitive::sample_from`] gives the points `at`.
    #[inline(always)]
    pub fn pdf_from<F: Real>(&self, from: Vec3<F>, at: &LaneSurface<F>) -> F {
        match (&self.placement, self.shape.area()) {
            (None, _) => self.shape.pdf_from(from, at),
            (Some(placement), Some(area)) => {
                let per_area = F::splat(1.0) / (F::splat(area) * placement.stretch(at.normal));
                at.pdf_from(from, per_area)
            }
            (Some(_), None) => F::splat(0.0),
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

out_of_line! {
    fn intersect_placed<'k, F>(
        shape: &'k Shape,
        placement: &'k Placement,
        ray: &'k PreparedRay<F>,
        within: Span<F>,
    ) -> LaneHit<F> {
        shape.intersect(&PreparedRay::new(placement.ray_to_object(&ray.ray)), within)
    }
}

out_of_line! {
    fn occludes_placed<'k, F>(
        shape: &'k Shape,
        placement: &'k Placement,
        ray: &'k PreparedRay<F>,
        within: Span<F>,
    ) -> F::Mask {
        shape.occludes(&PreparedRay::new(placement.ray_to_object(&ray.ray)), within)
    }
}

out_of_line! {
    fn sample<'k, F>(
        primitive: &'k Primitive,
        from: Vec3<F>,
        eye: &'k Frame<F>,
        u: F,
        v: F,
    ) -> (LaneSurface<F>, F::U32, F) {
        let Some(placement) = &primitive.placement else {
            return primitive.shape.sample_from(from, eye, u, v);
        };
        let (local, part) = primitive.shape.sample_area(u, v);
        let surface = placement.moved(&local);
        let pdf = primitive.pdf_from(from, &surface);
        (surface, part, pdf)
    }
}

/// One ray in the world.
impl Primitive {
    /// Where a ray first meets the primitive before `t_max`.
    pub fn hit(&self, probe: &Probe, t_max: f64) -> Option<Crossing> {
        self.intersect(&PreparedRay::<f64>::splat(probe), Span::up_to(t_max)).one()
    }

    /// Whether a ray meets the primitive before `t_max`.
    pub fn blocks(&self, probe: &Probe, t_max: f64) -> bool {
        self.occludes(&PreparedRay::<f64>::splat(probe), Span::up_to(t_max))
    }

    /// The surface where a ray meets it.
    pub fn surface_at(&self, ray: &Ray, at: Crossing) -> Surface {
        self.surface(&LaneRay::from(ray), at.into()).into()
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
        let own = DVec3::splat(farthest.length() * gamma(64));
        let error = DVec3::from(self.error::<f64>(farthest.into(), own.into(), reach.into()));
        let in_world = reach + self.to_world.translation.abs();
        let moved = DVec3::splat(2.0 * error.length() + in_world.max_element() * gamma(2));
        (back * moved).length() + (back * reach * gamma(5)).length()
    }

    #[inline(always)]
    fn ray_to_object<F: Real>(&self, ray: &LaneRay<F>) -> LaneRay<F> {
        LaneRay {
            origin: turned(&self.back, ray.origin - Vec3::splat(self.to_world.translation)),
            direction: turned(&self.back, ray.direction),
        }
    }

    #[inline(always)]
    fn probe_to_object(&self, probe: &Probe) -> Probe {
        let LaneRay { origin, direction } = self.ray_to_object(&LaneRay::from(&probe.ray));
        Probe::new(Ray { origin: origin.into(), direction: direction.into() })
    }

    /// By how much areas across the world's unit vectors `normal` have grown: those across a moved normal
    /// change by the determinant times the length of M⁻ᵀ n, and the way back is the inverse.
    #[inline(always)]
    fn stretch<F: Real>(&self, normal: Vec3<F>) -> F {
        let back = turned(&self.to_world.matrix3.transpose(), normal).length();
        F::splat(self.to_world.matrix3.determinant().abs()) / back
    }

    /// The error in the world of a point that is known to `error` in the shape's space; of the point, and of its way from
    /// the shape's origin in the world, the absolute values.
    #[inline(always)]
    fn error<F: Real>(&self, local: Vec3<F>, error: Vec3<F>, way: Vec3<F>) -> Vec3<F> {
        let forth = abs(&self.to_world);
        let there = transformed(&forth, local) * F::splat(gamma(5));
        // A difference, three products, and the matrix.
        let and_back = turned(&forth.matrix3, turned(&self.back.abs(), way)) * F::splat(gamma(5));
        turned(&forth.matrix3, error) + there + and_back
    }

    /// The shape's own error moved to the world, plus the rounding of the move there and, as the next ray
    /// from this point is moved back into the shape's space, of the way back.
    #[inline(always)]
    fn moved<F: Real>(&self, local: &LaneSurface<F>) -> LaneSurface<F> {
        let point = transformed(&self.to_world, local.point);
        let way = (point - Vec3::splat(self.to_world.translation)).abs();
        let error = self.error(local.point.abs(), local.error, way);
        let back = self.back.transpose();
        let normal = turned(&back, local.normal).normalize_or(local.normal);
        // An uneven scale may turn the shading normal past the surface's horizon.
        let shading = turned(&back, local.shading).normalize_or(local.shading);
        let shading = shading.negate_where(shading.dot(normal).lt(F::splat(0.0)));
        let lift = turned(&self.to_world.matrix3, local.lift);
        LaneSurface { point, error, normal, shading, lift }
    }
}

/// A point moved by an affine map, in glam's order of operations.
#[inline(always)]
fn transformed<F: Real>(affine: &DAffine3, point: Vec3<F>) -> Vec3<F> {
    turned(&affine.matrix3, point) + Vec3::splat(affine.translation)
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
    use crate::base::math::UNIT_ROUNDOFF;
    use crate::geometry::shape::Sphere;

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
            crate::base::math::axis_angle(DVec3::Z, crate::base::math::Angle(30.0)),
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
        let turn = crate::base::math::axis_angle(DVec3::new(0.6, 0.48, 0.64), crate::base::math::Angle(40.0));
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
        let surface = primitive.surface_at(&ray, Crossing::at(2.0));
        assert!((surface.normal - DVec3::new(1.0, 2.0, 0.0).normalize()).length() < 1e-15);
    }
}
