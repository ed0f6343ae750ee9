//! A primitive: a shape, its transform, and its material or light.

use super::instance_transform::{InstanceTransform, transformed};
use crate::appearance::material::MaterialBinding;
use crate::base::digest::Content;
use crate::base::lanes::{Level, Mask, Real, Select, Vec3, out_of_line};
use crate::base::math::{Aabb, DAffine3, DMat3, DVec3, LaneRay, Ray, inverse};
use crate::geometry::bvh::{CLEARANCE, Stack, TraversalRay};
use crate::geometry::ray_kinds::{RayKind, RayKinds};
use crate::geometry::shape::{
    LaneHit, LaneSurface, PreparedRay, RayInterval, Shape, ShapeHit, Surface, TriangleLanes,
};
use crate::sampling::FrameAxes;

/// A shape in the world. Most shapes are transformed once ([`Shape::transformed`]). The others keep their own space,
/// and rays are moved into it.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct Primitive {
    pub shape: Shape,
    pub transform: Option<Box<InstanceTransform>>,
    pub finish: Finish,
    /// The rays that see it.
    pub rays: RayKinds,
}

/// The material of a primitive, or its light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Content)]
#[warn(missing_docs)]
pub enum Finish {
    /// The primitive shows these materials.
    Material(MaterialBinding),
    /// Index into the scene's lights: the primitive is that light.
    Light(u32),
    /// Neither: the slot is empty.
    Empty,
}

#[warn(missing_docs)]
impl Finish {
    /// The indices of all materials.
    pub fn materials(self) -> impl Iterator<Item = u32> {
        let Self::Material(made_of) = self else { return None.into_iter().flatten() };
        Some(made_of.indices()).into_iter().flatten()
    }
}

impl Primitive {
    /// The content of an empty slot: nothing hits it.
    pub const EMPTY: Self =
        Self { shape: Shape::Group, transform: None, finish: Finish::Empty, rays: RayKinds::ALL };

    /// A shape transformed by `to_world`. None if that flattens it: a scale of 0 hides an object.
    pub fn new(shape: &Shape, to_world: DAffine3, finish: Finish) -> Option<Self> {
        let mut primitive = Self::EMPTY;
        primitive.replace(shape, (&to_world, &inverse(&to_world)?.matrix3), (finish, RayKinds::ALL));
        Some(primitive)
    }

    /// Replaces the primitive by a shape transformed by `to_world`, whose inverse for directions is `back`. Returns
    /// whether it differs.
    pub(super) fn replace(
        &mut self,
        shape: &Shape,
        (to_world, back): (&DAffine3, &DMat3),
        (finish, rays): (Finish, RayKinds),
    ) -> bool {
        let mut differs = self.finish != finish || self.rays != rays;
        (self.finish, self.rays) = (finish, rays);
        match shape.transformed(to_world) {
            Some(shape) => {
                differs |= self.transform.take().is_some();
                if self.shape != shape {
                    (self.shape, differs) = (shape, true);
                }
            }
            None => {
                let transform = InstanceTransform::new(shape, *to_world, *back);
                if self.transform.as_deref() != Some(&transform) {
                    (self.transform, differs) = (Some(Box::new(transform)), true);
                }
                if self.shape != *shape {
                    (self.shape, differs) = (shape.clone(), true);
                }
            }
        }
        differs
    }

    /// Whether the slot is empty: its object is hidden or flattened.
    pub fn is_empty(&self) -> bool {
        self.finish == Finish::Empty
    }

    /// Whether rays of a kind pass it by: the slot is empty, or they do not see it. `None` stands for all rays.
    pub fn is_absent(&self, kind: Option<RayKind>) -> bool {
        self.is_empty() || kind.is_some_and(|kind| !self.rays.has(kind))
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
                Some(first + self.shape.material_of(part).map_or(count, u32::from))
            }
            Finish::Material(MaterialBinding::Capped { first, count, cap }) => match &self.shape {
                Shape::Solid(solid) if solid.is_cap(part) => Some(cap),
                // A material of the file has one slot, whatever slots the mesh has.
                shape => Some(first + shape.material_of(part).map_or(count, u32::from).min(count)),
            },
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
            Some(transform) if self.shape.has_tree() => {
                self.shape.intersect_on::<L>(&transform.traversal_ray_to_object(ray), within, stack)
            }
            Some(transform) => {
                let own = transform.ray_to_object(&LaneRay::from(&ray.ray));
                self.shape.intersect::<f64>(&PreparedRay::new(own), within).one()
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
            Some(transform) if self.shape.has_tree() => {
                self.shape.occludes_on::<L>(&transform.traversal_ray_to_object(ray), within, stack)
            }
            Some(transform) => {
                let own = transform.ray_to_object(&LaneRay::from(&ray.ray));
                self.shape.occludes::<f64>(&PreparedRay::new(own), within)
            }
        }
    }

    /// [`Primitive::intersect`]. Given a stack, shapes with trees are searched along one ray after the other, for rays
    /// that go different ways.
    #[inline(always)]
    pub fn intersect_with<F: Real>(
        &self,
        ray: &PreparedRay<F>,
        within: RayInterval<F>,
        apart: Option<&mut Stack>,
    ) -> LaneHit<F> {
        if let Some(stack) = apart
            && self.shape.has_tree()
            && let Some(found) = self.shape.intersect_apart(&self.own_ray(&ray.ray), within, stack)
        {
            return found;
        }
        self.intersect(ray, within)
    }

    /// [`Primitive::occludes`], as in [`Primitive::intersect_with`].
    #[inline(always)]
    pub fn occludes_with<F: Real>(
        &self,
        ray: &PreparedRay<F>,
        within: RayInterval<F>,
        apart: Option<&mut Stack>,
    ) -> F::Mask {
        if let Some(stack) = apart
            && self.shape.has_tree()
            && let Some(found) = self.shape.occludes_apart(&self.own_ray(&ray.ray), within, stack)
        {
            return found;
        }
        self.occludes(ray, within)
    }

    /// Rays in the shape's own space.
    #[inline(always)]
    fn own_ray<F: Real>(&self, ray: &LaneRay<F>) -> LaneRay<F> {
        match &self.transform {
            None => *ray,
            Some(transform) => transform.ray_to_object(ray),
        }
    }

    /// [`Shape::each_crossing`] of a ray in the world.
    pub fn each_crossing(
        &self,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        take: &mut dyn FnMut(ShapeHit),
    ) {
        let own = self.transform.as_ref().map(|transform| transform.traversal_ray_to_object(ray));
        self.shape.each_crossing(own.as_ref().unwrap_or(ray), within, take);
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
        let (mut corners, is_triangle) = match &self.shape {
            Shape::Mesh(shape) => (shape.triangle(part).corners, F::Mask::splat(true)),
            Shape::Solid(solid) => solid.triangles(part),
            _ => return surface,
        };
        if let Some(transform) = &self.transform {
            for corner in &mut corners {
                *corner = transformed(&transform.to_world, *corner);
            }
        }
        let moved = TriangleLanes { corners }.clear_of_edges(surface).point;
        LaneSurface { point: Vec3::select(is_triangle, moved, surface.point), ..surface }
    }

    /// The length in the world below which a segment through an [isolated](ShapeHit::isolated) hit crosses no other
    /// part; 0 if no hit is isolated.
    pub fn clearance(&self) -> f64 {
        let Shape::Mesh(mesh) = &self.shape else { return 0.0 };
        let own = CLEARANCE * mesh.mesh.tree().space().size;
        self.transform.as_ref().map_or(own, |transform| own / transform.most_growth_to_object())
    }

    /// Samples points that `from` may see. Returns the points, their parts and their densities per steradian at
    /// `from`; 0 if no point is visible. Only for shapes that have an [area](Primitive::has_area).
    #[inline(always)]
    pub fn sample_from<F: Real>(
        &self,
        from: Vec3<F>,
        eye: &FrameAxes<F>,
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
    #[inline]
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
        eye: &'k FrameAxes<F>,
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

    /// The unit normal of the [surface](Primitive::surface_at). Of meshes, nothing else is computed.
    pub fn normal_at(&self, ray: &Ray, at: ShapeHit) -> DVec3 {
        let Shape::Mesh(mesh) = &self.shape else { return self.surface_at(ray, at).normal };
        let own = mesh.triangle::<f64>(at.part).normal();
        self.transform.as_ref().map_or(own, |transform| transform.moved_normal(own)).into()
    }
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
