//! The media on the two sides of refracting surfaces.

use super::bsdf::Boundary;
use super::coincident::{Events, ISOLATED};
use super::context::TraceContext;
use super::interaction::SurfaceInteraction;
use super::medium::{Enclosure, MediaLists, Passage};
use super::spawn::spawn;
use crate::base::lanes::{Bits, Mask, Real, Row, Vec3, lanes};

/// The two sides of a surface in each lane.
#[derive(Clone, Copy)]
pub struct Interface<F: Real> {
    pub boundary: Boundary<F>,
    /// Lanes in which a medium of higher priority fills both sides, so that the surface is invisible.
    pub is_hidden: F::Mask,
    /// The media around rays after they pass ([`MediaLists`]).
    pub behind: F::U32,
}

/// The spawn origins on both sides of surfaces.
#[derive(Clone, Copy)]
struct Sides<F: Real> {
    origins: [Vec3<F>; 2],
    /// A bit for each lane in which no other part of the surface's shape lies between them: those of isolated hits, if
    /// the segment is shorter than the clearance. Where the error of the hit moves it along the face, the search covers
    /// that: its filters' error bounds grow with the same coordinates.
    clear: u32,
}

impl<F: Real> Sides<F> {
    #[inline(always)]
    fn new(context: &TraceContext, surface: &SurfaceInteraction<F>, wanted: F::Mask) -> Self {
        let out = surface.surface.normal;
        let origins = [spawn(&surface.surface, out).origin, spawn(&surface.surface, -out).origin];
        let isolated = wanted & surface.event.eq(F::U32::splat(ISOLATED));
        let clearance = context.scene.geometry.clearances::<F>(surface.primitive, isolated);
        let clear = isolated & (origins[1] - origins[0]).length().lt(clearance);
        Self { origins, clear: clear.bits() }
    }

    /// Whether the ray of a lane [grazes an edge](TraceContext::grazes_an_edge).
    #[inline(always)]
    fn graze(
        &self,
        context: &TraceContext,
        surface: &SurfaceInteraction<F>,
        lane: usize,
        enters: bool,
    ) -> bool {
        let origins = self.origins.map(|origin| origin.lane(lane));
        let primitive = surface.primitive.to_array()[lane];
        context.grazes_an_edge(primitive, origins, surface.surface.normal.lane(lane), enters)
    }
}

impl<F: Real> Interface<F> {
    /// For surfaces without refraction.
    #[inline(always)]
    pub fn none(inside: F::U32) -> Self {
        let boundary = Boundary { eta: F::splat(1.0) };
        Self { boundary, is_hidden: F::Mask::splat(false), behind: inside }
    }

    /// The interfaces of refracting surfaces in the lanes of a mask, for rays inside these media.
    #[inline(always)]
    pub fn gather(
        context: &TraceContext,
        (media, events): (&mut MediaLists, &Events),
        surface: &SurfaceInteraction<F>,
        inside: F::U32,
        wanted: F::Mask,
    ) -> Self {
        let (inside, outside) = (inside.to_array(), surface.outside.bits());
        let (primitives, materials) = (surface.primitive.to_array(), surface.material.to_array());
        let (mut etas, mut behind, mut hidden) = (F::splat(1.0).to_array(), inside, 0);
        let events_of = surface.event.to_array();
        let (all, mut sides) = (&context.scene.shading.materials, None::<Sides<F>>);
        for lane in lanes(wanted.bits()) {
            let transition = match events.get(events_of[lane]) {
                Some(event) => media.pass_all(inside[lane], &event.passages, all),
                None => {
                    let of = Enclosure { primitive: primitives[lane], material: materials[lane] };
                    let (enters, mut grazes) = (outside >> lane & 1 == 1, false);
                    if context.may_graze(of.primitive) {
                        // No closure: it would be compiled without the level's instructions.
                        if sides.is_none() {
                            sides = Some(Sides::new(context, surface, wanted));
                        }
                        if let Some(sides) = &sides {
                            grazes =
                                sides.clear >> lane & 1 == 0 && sides.graze(context, surface, lane, enters);
                        }
                    }
                    media.pass(inside[lane], Passage { of, enters, grazes }, all)
                }
            };
            (etas[lane], behind[lane]) = (transition.eta, transition.behind);
            hidden |= u32::from(transition.hidden) << lane;
        }
        Self {
            boundary: Boundary { eta: F::from_array(etas) },
            is_hidden: F::Mask::from_bits(hidden),
            behind: F::U32::from_array(behind),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::material::MaterialBinding;
    use crate::appearance::optics::Fresnel;
    use crate::base::color::Rgb;
    use crate::base::lanes::{Level, Select, SimdKernel, dispatch};
    use crate::base::math::{DAffine3, DMat3, DVec3, Ray, look_at};
    use crate::camera::{Camera, Projection};
    use crate::film::AovSet;
    use crate::film::filter::FilterSampler;
    use crate::geometry::mesh::{Normals, TriangleMesh, generate};
    use crate::geometry::shape::{Mesh, RayInterval, Shape};
    use crate::scene::top_level::{Bvh, Coherence, NOTHING, Stacks};
    use crate::scene::{Finish, Geometry, Scene, Shading, Weights};
    use crate::sequence::quality::Quality;
    use crate::testing::{Random, eight_rays, glass};
    use crate::trace::TraceSettings;
    use std::sync::Arc;

    /// The first hits of eight rays with a mesh: how many there are, and how many are clear. None of these grazes an
    /// edge.
    struct Clear<'a> {
        context: &'a TraceContext<'a>,
        bvh: &'a Bvh,
        rays: &'a [Ray; 8],
        after: f64,
    }

    impl SimdKernel for Clear<'_> {
        type Output = [u32; 2];

        #[inline(always)]
        fn run<L: Level>(self) -> [u32; 2] {
            let Self { context, bvh, rays, after } = self;
            let (ray, mut stacks) = (eight_rays::<L>(rays), Stacks::default());
            stacks.find_isolated(true);
            let within = RayInterval { min: L::F64::splat(after), max: L::F64::splat(f64::INFINITY) };
            let all = L::Mask::splat(true);
            let geometry = context.scene.geometry;
            let hits = bvh.intersect::<L>(geometry, &ray, within, all, Coherence::Incoherent, &mut stacks);
            let found = !hits.primitive.eq(L::U32::splat(NOTHING));
            let (zero, first) = (L::F64::splat(0.0), L::U32::splat(0));
            let mut surface =
                SurfaceInteraction::new(context, &ray, (hits.at, hits.primitive, first), zero, found);
            surface.event =
                L::U32::select(L::Mask::from_bits(hits.at.isolated), L::U32::splat(ISOLATED), first);
            let sides = Sides::new(context, &surface, found);
            for lane in lanes(sides.clear) {
                let enters = surface.outside.bits() >> lane & 1 == 1;
                assert!(!sides.graze(context, &surface, lane, enters), "{:?}", rays[lane]);
            }
            [found.bits().count_ones(), sides.clear.count_ones()]
        }
    }

    /// Of meshes wherever and however they are placed, along rays from near, from far and from inside, that aim at
    /// faces, edges and corners.
    #[test]
    fn clear_hits_graze_no_edge() {
        let turn = DAffine3::from_mat3(DMat3::from_rotation_y(1.0) * DMat3::from_rotation_x(0.5));
        let scale = |x: f64, y: f64, z: f64| DAffine3::from_scale(DVec3::new(x, y, z));
        let moved =
            |distance: f64| DAffine3::from_translation(DVec3::new(distance, -distance, 0.3 * distance));
        let places = [
            (DAffine3::IDENTITY, true),
            (turn, true),
            (scale(0.02, 3.0, 40.0), true),
            (turn * scale(-1.0, 2.0, 0.5), true),
            (scale(1e-6, 1e-6, 1e-6), true),
            // The errors of points reach beyond the clearance.
            (turn * scale(1e-3, 1.0, 1.0), false),
            (moved(1e3) * turn, false),
            (moved(1e6) * scale(1e-2, 1e-2, 1e-2), false),
        ];
        let mut random = Random(9);
        let basis = look_at(DVec3::ZERO, DVec3::Z, DVec3::Y).expect("a frame");
        let projection = Projection::Perspective { half_height: 0.1 };
        let camera = Camera { position: DVec3::ZERO, basis, projection, lens: None };
        let (weights, quality) = (Weights(vec![Rgb::ONE]), Quality::default());
        let shading = Shading { materials: vec![glass(1.5, 0, Fresnel::Exact)], ..Shading::default() };
        for ((place, is_even), own) in places.into_iter().flat_map(|place| [(place, false), (place, true)]) {
            let mut parts = generate::displaced_sphere(3, 7);
            let to_world = if own { DAffine3::IDENTITY } else { place };
            if own {
                parts.positions.iter_mut().for_each(|position| *position = place.transform_point3(*position));
            }
            let mesh = Mesh::new(Arc::new(TriangleMesh::new(parts).expect("a mesh")), Normals::Flat);
            let mut geometry = Geometry::default();
            let finish = Finish::Material(MaterialBinding::One(0));
            geometry.push(&Shape::Mesh(mesh.clone()), to_world, finish);
            let scene = Scene { geometry: &geometry, shading: &shading, weights: &weights, camera: &camera };
            let filter = FilterSampler::new(quality.filter);
            let settings =
                TraceSettings { size: (8, 1), quality, filter, aovs: AovSet::default(), first_sample: 0 };
            let bvh = Bvh::build(&geometry);
            let context = TraceContext::new(&scene, &bvh, &settings);
            let (mut hits, mut clear) = (0, 0);
            for round in 0..400 {
                let distance = [0.0, 3.0, 1e4][round % 3];
                let rays = std::array::from_fn(|_| {
                    let part = (random.unit() * mesh.mesh.triangles().len() as f64) as u32;
                    let [a, b, c] = mesh.mesh.corners(part);
                    // Corners, points of edges, and points of faces.
                    let [u, v] = match round % 4 {
                        0 => [0.0, 0.0],
                        1 => [random.unit(), 0.0],
                        _ => [random.unit() * 0.5, random.unit() * 0.5],
                    };
                    let aim = to_world.transform_point3(a + (b - a) * u + (c - a) * v);
                    let from = place.transform_point3(random.direction() * distance);
                    Ray { origin: from, direction: aim - from }
                });
                let after = if round % 5 == 0 { 0.5 } else { 0.0 };
                let [found, seen] = dispatch(Clear { context: &context, bvh: &bvh, rays: &rays, after });
                (hits, clear) = (hits + found, clear + seen);
            }
            assert!(hits > 2000, "{hits}");
            assert!(!is_even || clear > hits / 5, "{clear} of {hits} at {place:?}");
        }
    }
}
