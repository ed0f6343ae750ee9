//! The surfaces that eight paths have come to.

use crate::bvh::Hit;
use crate::math::DVec3;
use crate::sampling::Frame;
use crate::scene::Primitive;
use crate::shape::{Rays, Shape, Surface, Surfaces, on_spheres};
use crate::simd::{Lanes, Octo, Quad, Rows, Vector};
use crate::trace::tracer::Tracer;

/// Surfaces, turned towards where paths came from.
pub struct Ground<Q: Quad> {
    pub surfaces: Surfaces,
    /// From points to the smooth surfaces that they stand for, if that is anywhere.
    pub lift: Option<Rows>,
    /// To shade with.
    pub normal: Vector<Q>,
    /// Unit vectors, as the paths go.
    direction: Vector<Q>,
}

impl<Q: Quad> Ground<Q> {
    #[inline(always)]
    pub fn of<L: Lanes<Quad = Q>>(tracer: &Tracer, rays: &Rays, at: &[Hit; 8]) -> Self {
        let (mut surfaces, lift) = surfaces::<L>(tracer, rays, at);
        let direction = Vector::load(&rays.direction);
        let (normal, shading) = (Vector::load(&surfaces.normal), Vector::load(&surfaces.shading));
        let zero = Octo::splat(0.0);
        let outside = normal.dot(direction).at_most(zero);
        let (normal, shading) = (normal.pick(outside, -normal), shading.pick(outside, -shading));
        (surfaces.normal, surfaces.shading) = (normal.store(), shading.store());
        let normal = shading.pick(zero.below(shading.dot(-direction)), normal);
        Self { surfaces, lift, normal, direction }
    }

    /// [`Seen::frame`](crate::trace::shade::Seen::frame) for paths that take these tangents along.
    #[inline(always)]
    pub fn frame(&self, tangents: &Rows) -> Frame<Vector<Q>> {
        Frame::carried(Vector::load(tangents), -self.direction, self.normal)
    }

    /// [`Seen::mirrored`](crate::trace::shade::Seen::mirrored).
    #[inline(always)]
    pub fn mirrored(&self) -> Vector<Q> {
        let Self { normal, direction, .. } = *self;
        direction - normal * (Octo::splat(2.0) * normal.dot(direction))
    }

    /// The cosines of directions, and a bit for each in which light falls on what is seen.
    #[inline(always)]
    pub fn cosines(&self, to_light: Vector<Q>) -> (Octo<Q>, u32) {
        let zero = Octo::splat(0.0);
        let cosine = self.normal.dot(to_light);
        let mut above = zero.below(Vector::load(&self.surfaces.normal).dot(to_light));
        if let Some(lift) = &self.lift {
            let lifted = zero.below(Vector::load(lift).longest());
            above = above | (lifted & zero.below(Vector::load(&self.surfaces.shading).dot(to_light)));
        }
        (cosine, (zero.below(cosine) & above).bits())
    }
}

/// Where rays meet surfaces, and from there to the smooth ones that these stand for.
#[inline(always)]
fn surfaces<L: Lanes>(tracer: &Tracer, rays: &Rays, at: &[Hit; 8]) -> (Surfaces, Option<Rows>) {
    let primitives = &tracer.scene.geometry.primitives;
    let t = at.map(|hit| hit.at.t);
    if let Primitive { shape: Shape::Mesh(mesh), placement: None, .. } = &primitives[at[0].primitive as usize]
        && at.iter().all(|hit| hit.primitive == at[0].primitive)
        && let Some((surfaces, lift)) = mesh.surfaces_of::<L>(rays, &t, &at.map(|hit| hit.at.part))
    {
        let lifted = tracer.quality.smooth_terminator && lift.0.iter().flatten().any(|way| *way != 0.0);
        return (surfaces, lifted.then_some(lift));
    }
    let (mut centers, mut radii, mut spheres) = (Rows::ZERO, [0.0; 8], true);
    for lane in 0..8 {
        match &primitives[at[lane].primitive as usize] {
            Primitive { shape: Shape::Sphere(sphere), placement: None, .. } => {
                centers.set(lane, sphere.center);
                radii[lane] = sphere.radius;
            }
            _ => {
                spheres = false;
                break;
            }
        }
    }
    if spheres {
        return (on_spheres::<L>(&centers, &radii, rays, &t), None);
    }
    one_by_one(tracer, rays, at)
}

#[inline(never)]
fn one_by_one(tracer: &Tracer, rays: &Rays, at: &[Hit; 8]) -> (Surfaces, Option<Rows>) {
    let each: [Surface; 8] = std::array::from_fn(|lane| tracer.surface(&rays.one(lane), &at[lane]));
    let lift = each.map(|surface| surface.lift);
    let lifted = lift.iter().any(|lift| *lift != DVec3::ZERO);
    (Surfaces::of(&each), lifted.then(|| Rows::of(&lift)))
}
