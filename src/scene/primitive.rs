//! A primitive: a shape, its transform, and its material or light.

use crate::appearance::material::MaterialBinding;
use crate::base::digest::Content;
use crate::base::lanes::{Level, Real, Vec3, out_of_line, transform_vector};
use crate::base::math::{Aabb, DAffine3, DMat3, DVec3, LaneRay, Ray, dot_plus, gamma};
use crate::geometry::bvh::{Stack, TraversalRay};
use crate::geometry::shape::{
    LaneHit, LaneSurface, PreparedRay, RayInterval, Shape, ShapeHit, Surface, TriangleLanes,
};
use crate::sampling::LocalFrame;

/// A shape in the world. Most shapes are transformed once ([`Shape::transformed`]). The others keep their own space,
/// and rays are moved into it.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct Primitive {
    pub shape: Shape,
    pub transform: Option<Box<InstanceTransform>>,
    pub finish: Finish,
}

/// The material of a primitive, or its light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Content)]
pub enum Finish {
    Material(MaterialBinding),
    /// Index into the scene's lights: the primitive is that light.
    Light(u32),
    /// Neither: the slot is empty.
    Empty,
}

impl Finish {
    /// The indices of all materials.
    pub fn materials(self) -> impl Iterator<Item = u32> {
        let Self::Material(made_of) = self else { return None.into_iter().flatten() };
        Some(made_of.indices()).into_iter().flatten()
    }
}

/// The transform between the world and a shape that keeps its own space.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct InstanceTransform {
    pub to_world: DAffine3,
    /// The inverse for directions. For points, the origin of the shape in the world is subtracted first. So rounding
    /// does not grow with the distance from the world's origin.
    back: DMat3,
    /// Distance in the shape's space between a point of the surface and the origin of a ray that starts there, at
    /// most.
    origin_error: f64,
}

impl Primitive {
    /// The content of an empty slot: nothing hits it.
    pub const EMPTY: Self = Self { shape: Shape::Group, transform: None, finish: Finish::Empty };

    /// A shape transformed by `to_world`. None if that flattens it: a scale of 0 hides an object.
    pub fn new(shape: &Shape, to_world: DAffine3, finish: Finish) -> Option<Self> {
        inverse(&to_world).map(|to_object| Self::placed(shape, to_world, &to_object, finish))
    }

    /// [`Primitive::new`] with the inverse of the transform.
    pub(super) fn placed(shape: &Shape, to_world: DAffine3, to_object: &DAffine3, finish: Finish) -> Self {
        match shape.transformed(&to_world) {
            Some(shape) => Self { shape, transform: None, finish },
            None => {
                let transform = Some(Box::new(InstanceTransform::new(shape, to_world, to_object.matrix3)));
                Self { shape: shape.clone(), transform, finish }
            }
        }
    }

    /// Whether the slot is empty: its object is hidden or flattened.
    pub fn is_empty(&self) -> bool {
        self.finish == Finish::Empty
    }

    /// Whether the primitive is a light.
    pub fn is_light(&self) -> bool {
        matches!(self.finish, Finish::Light(_))
    }

    /// The index of the material of a part; none for lights.
    #[inline]
    pub fn material(&self, part: u32) -> Option<u32> {
        match self.finish {
            Finish::Material(MaterialBinding::One(index)) => Some(index),
            Finish::Material(MaterialBinding::Slots { first, count }) => {
                let slot = match &self.shape {
                    Shape::Mesh(shape) => shape.mesh.material_of(part),
                    _ => None,
                };
                Some(first + slot.map_or(count, u32::from))
            }
            Finish::Light(_) | Finish::Empty => None,
        }
    }

    /// The indices of all materials that may be visible on it.
    pub fn materials(&self) -> impl Iterator<Item = u32> {
        self.finish.materials()
    }

    /// The smallest t within bounds at which each ray hits the primitive. Directions are not normalised, so rays that
    /// are moved into the shape's space keep their t.
    #[inline(always)]
    pub fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        match &self.transform {
            None => self.shape.intersect(ray, within),
            Some(transform) => intersect_placed(&self.shape, transform, ray, within),
        }
    }

    /// The rays that hit the primitive within bounds.
    #[inline(always)]
    pub fn occludes<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> F::Mask {
        match &self.transform {
            None => self.shape.occludes(ray, within),
            Some(transform) => occludes_placed(&self.shape, transform, ray, within),
        }
    }

    /// [`Primitive::intersect`] of one ray.
    #[inline(always)]
    pub fn intersect_on<L: Level>(
        &self,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        stack: Option<&mut Stack>,
    ) -> Option<ShapeHit> {
        match &self.transform {
            None => self.shape.intersect_on::<L>(ray, within, stack),
            Some(transform) => {
                self.shape.intersect_on::<L>(&transform.traversal_ray_to_object(ray), within, stack)
            }
        }
    }

    /// [`Primitive::occludes`] of one ray.
    #[inline(always)]
    pub fn occludes_on<L: Level>(
        &self,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        stack: Option<&mut Stack>,
    ) -> bool {
        match &self.transform {
            None => self.shape.occludes_on::<L>(ray, within, stack),
            Some(transform) => {
                self.shape.occludes_on::<L>(&transform.traversal_ray_to_object(ray), within, stack)
            }
        }
    }

    /// Passes all hits of one ray within bounds to `take`. The ray keeps its origin and only the minimum of t grows,
    /// so each hit is found once, however close hits are.
    pub fn each_crossing<L: Level>(
        &self,
        ray: &TraversalRay,
        mut within: RayInterval<f64>,
        take: &mut dyn FnMut(ShapeHit),
    ) {
        let own = self.transform.as_ref().map(|transform| transform.traversal_ray_to_object(ray));
        let ray = own.as_ref().unwrap_or(ray);
        if let Shape::Mesh(mesh) = &self.shape {
            return mesh.each(ray, within, take);
        }
        while let Some(at) = self.shape.intersect_on::<L>(ray, within, None) {
            take(at);
            within.min = at.t;
        }
    }

    /// The surface at the hits of [`Primitive::intersect`].
    #[inline(always)]
    pub fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>) -> LaneSurface<F> {
        let transform = self.transform.as_deref();
        // No closures: they would be compiled without the level's instructions.
        let (own, origin_error) = match transform {
            Some(transform) => (transform.ray_to_object(ray), transform.origin_error),
            None => (*ray, 0.0),
        };
        let local = self.shape.surface(&own, at, origin_error);
        match transform {
            Some(transform) => transform.moved(&local),
            None => local,
        }
    }

    /// The surface for transmitted rays. On a mesh, points are moved away from the edges of their triangles. So a ray
    /// at an edge also starts beyond the neighbouring triangles, which it would hit at the same place. It then enters
    /// one triangle of a closed mesh, not two.
    #[inline(always)]
    pub fn passed<F: Real>(&self, surface: LaneSurface<F>, part: F::U32) -> LaneSurface<F> {
        let Shape::Mesh(shape) = &self.shape else { return surface };
        let mut corners = shape.triangle(part).corners;
        if let Some(transform) = &self.transform {
            for corner in &mut corners {
                *corner = transformed(&transform.to_world, *corner);
            }
        }
        TriangleLanes { corners }.clear_of_edges(surface)
    }

    /// Samples points that `from` may see. Returns the points, their parts and their densities per steradian at
    /// `from`; 0 if no point is visible. Only for shapes that have an [area](Primitive::has_area).
    #[inline(always)]
    pub fn sample_from<F: Real>(
        &self,
        from: Vec3<F>,
        eye: &LocalFrame<F>,
        u: F,
        v: F,
    ) -> (LaneSurface<F>, F::U32, F) {
        sample(self, from, eye, u, v)
    }

    /// The density per steradian with which [`Primitive::sample_from`] samples the points `at`.
    #[inline(always)]
    pub fn pdf_from<F: Real>(&self, from: Vec3<F>, at: &LaneSurface<F>) -> F {
        match (&self.transform, self.shape.area()) {
            (None, _) => self.shape.pdf_from(from, at),
            (Some(transform), Some(area)) => {
                let per_area = F::splat(1.0) / (F::splat(area) * transform.stretch(at.normal));
                at.pdf_from(from, per_area)
            }
            (Some(_), None) => F::splat(0.0),
        }
    }

    /// Whether [`Primitive::sample_from`] can sample points.
    pub fn has_area(&self) -> bool {
        self.shape.area().is_some()
    }

    /// The bounds in the world; none if the primitive is infinite.
    pub fn bounds(&self) -> Option<Aabb> {
        let bounds = self.shape.bounds()?;
        Some(self.transform.as_ref().map_or(bounds, |transform| bounds.transformed(&transform.to_world)))
    }
}

out_of_line! {
    fn intersect_placed<'k, F>(
        shape: &'k Shape,
        transform: &'k InstanceTransform,
        ray: &'k PreparedRay<F>,
        within: RayInterval<F>,
    ) -> LaneHit<F> {
        shape.intersect(&PreparedRay::new(transform.ray_to_object(&ray.ray)), within)
    }
}

out_of_line! {
    fn occludes_placed<'k, F>(
        shape: &'k Shape,
        transform: &'k InstanceTransform,
        ray: &'k PreparedRay<F>,
        within: RayInterval<F>,
    ) -> F::Mask {
        shape.occludes(&PreparedRay::new(transform.ray_to_object(&ray.ray)), within)
    }
}

out_of_line! {
    fn sample<'k, F>(
        primitive: &'k Primitive,
        from: Vec3<F>,
        eye: &'k LocalFrame<F>,
        u: F,
        v: F,
    ) -> (LaneSurface<F>, F::U32, F) {
        let Some(transform) = &primitive.transform else {
            return primitive.shape.sample_from(from, eye, u, v);
        };
        let (local, part) = primitive.shape.sample_area(u, v);
        let surface = transform.moved(&local);
        let pdf = primitive.pdf_from(from, &surface);
        (surface, part, pdf)
    }
}

/// Queries with a single ray in the world.
impl Primitive {
    /// The first hit of a ray before `t_max`.
    pub fn intersect_up_to(&self, ray: &TraversalRay, t_max: f64) -> Option<ShapeHit> {
        self.intersect(&PreparedRay::<f64>::splat(ray), RayInterval::up_to(t_max)).one()
    }

    /// Whether a ray hits the primitive before `t_max`.
    pub fn occludes_up_to(&self, ray: &TraversalRay, t_max: f64) -> bool {
        self.occludes(&PreparedRay::<f64>::splat(ray), RayInterval::up_to(t_max))
    }

    /// The surface at a hit of a ray.
    pub fn surface_at(&self, ray: &Ray, at: ShapeHit) -> Surface {
        self.surface(&LaneRay::from(ray), at.into()).into()
    }
}

impl InstanceTransform {
    fn new(shape: &Shape, to_world: DAffine3, back: DMat3) -> Self {
        let transform = Self { to_world, back, origin_error: 0.0 };
        let origin_error = shape.bounds().map_or(0.0, |bounds| transform.origin_error(bounds));
        Self { origin_error, ..transform }
    }

    /// Largest distance in the shape's space between a point of a shape within `bounds` and the origin of a ray that
    /// starts there. It covers the point's error in the world, the offset along the normal, and the rounding of the
    /// inverse. No shape has an error above gamma(64) of its coordinates.
    fn origin_error(&self, bounds: Aabb) -> f64 {
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
            origin: transform_vector(&self.back, ray.origin - Vec3::splat(self.to_world.translation)),
            direction: transform_vector(&self.back, ray.direction),
        }
    }

    #[inline(always)]
    fn traversal_ray_to_object(&self, ray: &TraversalRay) -> TraversalRay {
        let LaneRay { origin, direction } = self.ray_to_object(&LaneRay::from(&ray.ray));
        TraversalRay::new(Ray { origin: origin.into(), direction: direction.into() })
    }

    /// The factor by which areas perpendicular to the world's unit vectors `normal` have grown. It is the determinant
    /// times the length of M⁻ᵀ n for the shape's normal n; here n is derived from the world's normal.
    #[inline(always)]
    fn stretch<F: Real>(&self, normal: Vec3<F>) -> F {
        let back = transform_vector(&self.to_world.matrix3.transpose(), normal).length();
        F::splat(self.to_world.matrix3.determinant().abs()) / back
    }

    /// The error in the world of a point that is known to `error` in the shape's space. `local` and `way` are absolute
    /// values: the point, and its offset in the world from the shape's origin.
    #[inline(always)]
    fn error<F: Real>(&self, local: Vec3<F>, error: Vec3<F>, way: Vec3<F>) -> Vec3<F> {
        let forth = abs(&self.to_world);
        let there = transformed(&forth, local) * F::splat(gamma(5));
        // A difference, three products, and the matrix.
        let and_back =
            transform_vector(&forth.matrix3, transform_vector(&self.back.abs(), way)) * F::splat(gamma(5));
        transform_vector(&forth.matrix3, error) + there + and_back
    }

    /// The surface in the world. Its error is the shape's own error, the rounding of the map, and that of the inverse,
    /// because the next ray from this point is moved back into the shape's space.
    #[inline(always)]
    fn moved<F: Real>(&self, local: &LaneSurface<F>) -> LaneSurface<F> {
        let point = transformed(&self.to_world, local.point);
        let way = (point - Vec3::splat(self.to_world.translation)).abs();
        let error = self.error(local.point.abs(), local.error, way);
        let back = self.back.transpose();
        let normal = transform_vector(&back, local.normal).normalize_or(local.normal);
        // A non-uniform scale may turn the shading normal past the surface's horizon.
        let shading = transform_vector(&back, local.shading).normalize_or(local.shading);
        let shading = shading.negate_where(shading.dot(normal).lt(F::splat(0.0)));
        let lift = transform_vector(&self.to_world.matrix3, local.lift);
        LaneSurface { point, error, normal, shading, lift }
    }
}

/// A point transformed by an affine map, in glam's order of operations.
#[inline(always)]
fn transformed<F: Real>(affine: &DAffine3, point: Vec3<F>) -> Vec3<F> {
    transform_vector(&affine.matrix3, point) + Vec3::splat(affine.translation)
}

/// The inverse of an affine map, refined once. None if the map is singular or not finite.
pub(super) fn inverse(affine: &DAffine3) -> Option<DAffine3> {
    let matrix3 = inverse_matrix(affine.matrix3)?;
    let inverse = DAffine3 { matrix3, translation: -(matrix3 * affine.translation) };
    inverse.is_finite().then_some(inverse)
}

/// The inverse of a matrix, refined once. None if it is singular or not finite.
fn inverse_matrix(m: DMat3) -> Option<DMat3> {
    let bits = |m: &DMat3| m.to_cols_array().map(f64::to_bits);
    // Most objects are only moved. A negative zero is left to the general case, which may keep it.
    if bits(&m) == bits(&DMat3::IDENTITY) {
        return Some(m);
    }
    let determinant = m.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    let first = m.inverse();
    // Cancellation leaves an error in the cofactors of a badly scaled matrix. A Newton step squares this error, if the
    // difference from the identity is computed exactly enough.
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
    Some(first + first * left)
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
            let primitive = Primitive::new(&UNIT, affine, Finish::Material(MaterialBinding::One(0)))
                .expect("a primitive");
            primitive.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY).expect("a hit").t
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
        let primitive =
            Primitive::new(&UNIT, affine, Finish::Material(MaterialBinding::One(0))).expect("a primitive");
        let n = DVec3::new(1.0, 1.0, 0.0).normalize();
        let ray = Ray { origin: affine.transform_point3(n * 3.0), direction: -affine.transform_vector3(n) };
        let surface = primitive.surface_at(&ray, ShapeHit::at(2.0));
        assert!((surface.normal - DVec3::new(1.0, 2.0, 0.0).normalize()).length() < 1e-15);
    }
}
