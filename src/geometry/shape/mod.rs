//! Shapes: ray hits, and surfaces with their error bounds.
//!
//! A closed list with one file per shape; [`Geometric`] is their interface. The transform of an object leads from the
//! shape's space to the world. Most shapes stay in their class under most transforms: a moved sphere is a sphere.
//! Those are moved once per change of geometry by [`Geometric::transformed`]. For the others, rays are moved instead.

mod lane_hit;
mod lane_ray;
mod lane_search;
mod lane_surface;
mod stored_rays;
mod torus_interval;
mod cone;
mod cuboid;
mod cylinder;
mod disk;
mod flat;
mod frame;
mod frustum;
mod geometric;
mod memory;
mod mesh;
mod nearest_part;
mod parameters;
mod part_search;
mod particles;
mod plane;
mod rectangle;
#[cfg(test)]
mod round_tests;
mod side_filter;
mod solid;
mod sphere;
#[cfg(test)]
mod support_tests;
mod surface;
mod taper;
mod torus;
mod triangle;
mod coincidence_range;

pub use coincidence_range::CoincidenceRange;
pub use cone::Cone;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use flat::{axes as flat_axes, placed as flat_surface, spans_a_plane};
pub use frustum::{End as FrustumEnd, Frustum};
pub use geometric::{Geometric, OneRay};
pub use lane_hit::{LaneHit, select_bits};
use lane_ray::exit;
pub use lane_ray::{PreparedRay, RayInterval};
pub use lane_surface::LaneSurface;
pub use mesh::{Mesh, MeshStep};
pub use parameters::Parameters;
use part_search::{any_part_of_each, every_part, nearest_part_of_each};
pub use part_search::{any_part_on, nearest_part_on};
pub use particles::{ParticleRows, ParticleSet, ParticleTracks, Particles, SameTime};
pub use plane::Plane;
pub use rectangle::{Rectangle, RectangleLanes};
pub use solid::{Operation, Solid, encloses, part_count};
pub use sphere::{Sphere, SphereLanes};
pub use stored_rays::{StoredRays, store_lanes};
pub use surface::{ShapeHit, Surface};
pub use torus::Torus;
pub use triangle::{Triangle, TriangleLanes};

use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::lanes::{Level, Mask, Real, Row, Select, Vec3, lanes, out_of_line};
use crate::base::math::{Aabb, DAffine3, DVec2, DVec3, LaneRay, Ray};
use crate::geometry::bvh::{Stack, TraversalRay};
use crate::geometry::mesh::ArrayKey;
use crate::sampling::FrameAxes;
use bevy_ecs::component::Component;

/// Declares [`Shape`] with the dispatch to all visible shapes.
macro_rules! shapes {
    ($($shape:ident),* $(,)?) => {
        /// Any shape.
        #[derive(Clone, Component, Debug, PartialEq, Content)]
        #[warn(missing_docs)]
        pub enum Shape {
            $(#[doc = concat!("The shape `", stringify!($shape), "`.")] $shape($shape),)*
            /// Invisible: a frame of reference for the objects that name it as their parent.
            Group,
        }

        macro_rules! each_shape {
            ($on:expr, $inner:ident => $call:expr, Group => $group:expr) => {
                match $on {
                    $(Shape::$shape($inner) => $call,)*
                    Shape::Group => $group,
                }
            };
        }

        #[warn(missing_docs)]
        impl Shape {
            /// The names of shapes in files.
            pub const NAMES: &[&str] = &[$($shape::NAME,)* "Group"];

            /// Reads the shape called `name`. None if there is no such shape, or if its parameters are wrong, which
            /// has been reported.
            pub fn read(name: &str, parameters: &mut impl Parameters) -> Option<Self> {
                $(if name == $shape::NAME {
                    return $shape::read(parameters).map(Self::$shape);
                })*
                (name == "Group").then_some(Self::Group)
            }

            /// The shape transformed by an affine map; none if the result is not in its class.
            // Passed through memory, the result takes longer to read than to compute.
            #[inline(always)]
            pub fn transformed(&self, affine: &DAffine3) -> Option<Self> {
                if *affine == DAffine3::IDENTITY {
                    return Some(self.clone());
                }
                match self {
                    $(Self::$shape(shape) => shape.transformed(affine).map(Self::$shape),)*
                    Self::Group => Some(Self::Group),
                }
            }
        }
    };
}

// The list. Adding a shape here makes it readable, visible, transformable and usable as a light.
shapes!(Sphere, Plane, Rectangle, Disk, Triangle, Cuboid, Cylinder, Cone, Torus, Mesh, Particles, Solid);

impl OneRay for Shape {
    fn intersect_up_to(&self, ray: &TraversalRay, t_max: f64) -> Option<ShapeHit> {
        each_shape!(self, shape => OneRay::intersect_up_to(shape, ray, t_max), Group => None)
    }

    fn occludes_up_to(&self, ray: &TraversalRay, t_max: f64) -> bool {
        each_shape!(self, shape => OneRay::occludes_up_to(shape, ray, t_max), Group => false)
    }

    fn surface_at(&self, ray: &Ray, at: ShapeHit) -> Surface {
        self.surface(&LaneRay::from(ray), at.into(), 0.0).into()
    }

    fn uv_at(&self, point: DVec3, part: u32) -> DVec2 {
        DVec2::from_array(self.uv::<f64>(point.into(), part))
    }
}

out_of_line! {
    fn uv_of_lanes<'k, F>(shape: &'k Shape, point: Vec3<F>, part: F::U32) -> [F; 2] {
        shape.uv(point, part)
    }
}

#[warn(missing_docs)]
impl Shape {
    /// See [`Geometric::intersect`].
    #[inline(always)]
    pub fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        each_shape!(self, shape => shape.intersect(ray, within), Group => LaneHit::none())
    }

    /// See [`Geometric::occludes`].
    #[inline(always)]
    pub fn occludes<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> F::Mask {
        each_shape!(self, shape => shape.occludes(ray, within), Group => F::Mask::splat(false))
    }

    /// [`Shape::intersect`] of one ray.
    #[inline(always)]
    pub fn intersect_on<L: Level>(
        &self,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        stack: Option<&mut Stack>,
    ) -> Option<ShapeHit> {
        match self {
            Self::Mesh(mesh) => nearest_part_on::<L>(mesh, ray, within, stack),
            Self::Particles(particles) => nearest_part_on::<L>(particles, ray, within, stack),
            _ => self.intersect::<f64>(&PreparedRay::splat(ray), within).one(),
        }
    }

    /// [`Shape::occludes`] of one ray.
    #[inline(always)]
    pub fn occludes_on<L: Level>(
        &self,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        stack: Option<&mut Stack>,
    ) -> bool {
        match self {
            Self::Mesh(mesh) => any_part_on::<L>(mesh, ray, within, stack),
            Self::Particles(particles) => any_part_on::<L>(particles, ray, within, stack),
            _ => self.occludes::<f64>(&PreparedRay::splat(ray), within),
        }
    }

    /// [`Shape::intersect`] for rays that go different ways, along one after the other. None for shapes without trees.
    #[inline(always)]
    pub fn intersect_apart<F: Real>(
        &self,
        ray: &LaneRay<F>,
        within: RayInterval<F>,
        stack: &mut Stack,
    ) -> Option<LaneHit<F>> {
        match self {
            Self::Mesh(mesh) => Some(nearest_part_of_each(mesh, ray, within, stack)),
            Self::Particles(particles) => Some(nearest_part_of_each(particles, ray, within, stack)),
            _ => None,
        }
    }

    /// [`Shape::occludes`], as in [`Shape::intersect_apart`].
    #[inline(always)]
    pub fn occludes_apart<F: Real>(
        &self,
        ray: &LaneRay<F>,
        within: RayInterval<F>,
        stack: &mut Stack,
    ) -> Option<F::Mask> {
        match self {
            Self::Mesh(mesh) => Some(any_part_of_each(mesh, ray, within, stack)),
            Self::Particles(particles) => Some(any_part_of_each(particles, ray, within, stack)),
            _ => None,
        }
    }

    /// Passes all hits of one ray within bounds to `take`. The ray keeps its origin and only the minimum of t grows, so
    /// each hit is found, however close hits are. A triangle in several leaves of its tree may be passed for each of
    /// them.
    pub fn each_crossing(
        &self,
        ray: &TraversalRay,
        mut within: RayInterval<f64>,
        take: &mut dyn FnMut(ShapeHit),
    ) {
        match self {
            Self::Mesh(mesh) => return every_part(mesh, ray, within, take),
            Self::Particles(particles) => return every_part(particles, ray, within, take),
            Self::Solid(solid) => return solid.each_hit(ray, within, take),
            _ => {}
        }
        let ray = PreparedRay::<f64>::splat(ray);
        while let Some(at) = self.intersect(&ray, within).one() {
            take(at);
            within.min = at.t;
        }
    }

    /// Whether the shape has a tree of its own.
    pub fn has_tree(&self) -> bool {
        matches!(self, Self::Mesh(_) | Self::Particles(_))
    }

    /// Whether the shape may have data: see [`Shape::number`].
    pub fn has_data(&self) -> bool {
        self.has_tree() || matches!(self, Self::Solid(_))
    }

    /// The mesh that the shape is, or those of which it is made.
    pub fn meshes(&self) -> Vec<&Mesh> {
        match self {
            Self::Mesh(mesh) => vec![mesh],
            Self::Solid(solid) => solid.parts().iter().flat_map(Self::meshes).collect(),
            _ => Vec::new(),
        }
    }

    /// The corners of a part that is a triangle of a mesh.
    pub fn triangle_of(&self, part: u32) -> Option<[DVec3; 3]> {
        match self {
            Self::Mesh(mesh) => Some(mesh.mesh.corners(part)),
            Self::Solid(solid) => solid.triangle_of(part),
            _ => None,
        }
    }

    /// The slot of the material of a part, if it is a triangle of a mesh with materials.
    pub fn material_of(&self, part: u32) -> Option<u16> {
        match self {
            Self::Mesh(mesh) => mesh.mesh.material_of(part),
            Self::Solid(solid) => solid.material_of(part),
            _ => None,
        }
    }

    /// A number of the data at a point of a part: of a mesh, or of a particle.
    pub fn number(&self, key: &ArrayKey, point: DVec3, part: u32) -> Option<f64> {
        match self {
            Self::Mesh(mesh) => mesh.array_at(key, point, part),
            Self::Particles(Particles(set)) => set.number(key, part),
            Self::Solid(solid) => solid.number(key, point, part),
            _ => None,
        }
    }

    /// See [`Geometric::surface`].
    #[inline(always)]
    pub fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, origin_error: f64) -> LaneSurface<F> {
        each_shape!(self, shape => shape.surface(ray, at, origin_error), Group => LaneSurface::nowhere())
    }

    /// See [`Geometric::bounds`]; none for groups too.
    #[inline]
    pub fn bounds(&self) -> Option<Aabb> {
        each_shape!(self, shape => shape.bounds(), Group => None)
    }

    /// See [`Geometric::support`]; none for groups too.
    pub fn support(&self, direction: DVec3) -> Option<f64> {
        each_shape!(self, shape => shape.support(direction), Group => None)
    }

    /// See [`Geometric::uv`].
    #[inline(always)]
    pub fn uv<F: Real>(&self, point: Vec3<F>, part: F::U32) -> [F; 2] {
        each_shape!(self, shape => shape.uv(point, part), Group => [F::splat(0.0); 2])
    }

    /// [`Shape::uv`] in the lanes `wanted`. The other lanes are arbitrary.
    #[inline(always)]
    pub fn uv_in<F: Real>(&self, point: Vec3<F>, part: F::U32, wanted: F::Mask) -> [F; 2] {
        let bits = wanted.bits();
        // Shapes of many parts look these up lane by lane, and for a single lane, one number is faster than eight.
        if !self.has_data() && bits & bits.wrapping_sub(1) != 0 {
            return uv_of_lanes(self, point, F::U32::select(wanted, part, F::U32::splat(0)));
        }
        let (points, parts) = (point.store(), part.to_array());
        let zero = F::splat(0.0).to_array();
        let (mut u, mut v) = (zero, zero);
        for lane in lanes(bits) {
            [u[lane], v[lane]] = self.uv_at(points[lane], parts[lane]).into();
        }
        [F::from_array(u), F::from_array(v)]
    }

    /// See [`Geometric::uv_ends`].
    pub fn uv_ends(&self, part: u32) -> [bool; 2] {
        each_shape!(self, shape => shape.uv_ends(part), Group => [true; 2])
    }

    /// The vertex colour at a point of the surface; white if there is none. Arguments as in [`Geometric::uv`].
    pub fn color(&self, point: DVec3, part: u32) -> Rgb {
        each_shape!(self, shape => shape.color(point, part), Group => Rgb::ONE)
    }

    /// See [`Geometric::area`].
    pub fn area(&self) -> Option<f64> {
        each_shape!(self, shape => shape.area(), Group => None)
    }

    /// See [`Geometric::sample_area`].
    #[inline(always)]
    pub fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        each_shape!(self, shape => shape.sample_area(u, v), Group => {
            (LaneSurface::nowhere(), F::U32::splat(0))
        })
    }

    /// See [`Geometric::sample_from`].
    #[inline(always)]
    pub fn sample_from<F: Real>(
        &self,
        from: Vec3<F>,
        eye: &FrameAxes<F>,
        u: F,
        v: F,
    ) -> (LaneSurface<F>, F::U32, F) {
        each_shape!(self, shape => shape.sample_from(from, eye, u, v), Group => {
            (LaneSurface::nowhere(), F::U32::splat(0), F::splat(0.0))
        })
    }

    /// See [`Geometric::pdf_from`].
    #[inline(always)]
    pub fn pdf_from<F: Real>(&self, from: Vec3<F>, at: &LaneSurface<F>) -> F {
        each_shape!(self, shape => shape.pdf_from(from, at), Group => F::splat(0.0))
    }
}
