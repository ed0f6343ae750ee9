//! Eight rays in lanes get the same results from a primitive as single rays, to the last bit and on all levels.

use super::{Finish, Primitive};
use crate::appearance::material::MaterialBinding;
use crate::base::lanes::tests::on_all_levels;
use crate::base::lanes::{Level, Mask, Real, Row, Select, SimdKernel, Vec3, dispatch};
use crate::base::math::{DAffine3, DVec3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::mesh::{self, Normals, generate};
use crate::geometry::shape::{
    Cone, Cuboid, Cylinder, Disk, Mesh, Operation, Particles, Plane, PreparedRay, RayInterval, Rectangle,
    Shape, ShapeHit, Solid, Sphere, Surface, Torus, Triangle,
};
use crate::sampling::FrameAxes;
use crate::testing::{Random, eight_rays, eight_vectors};
use std::sync::Arc;

/// Groups of eight queries per primitive.
const ROUNDS: u32 = if cfg!(debug_assertions) { 100 } else { 4000 };

/// The results of one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RayResult {
    hit: Option<ShapeHit>,
    is_blocked: bool,
    /// At the hit, or else at t = 1: the surface, the surface for transmitted rays, and u and v.
    surface: Surface,
    passed: Surface,
    uv: [f64; 2],
}

/// A sample of a light: the point, its part, its density, and the density that `pdf_from` returns for the point.
type LightSampleResult = (Surface, u32, f64, f64);

/// The arguments that differ between eight lanes.
struct Queries {
    rays: [Ray; 8],
    span: [[f64; 8]; 2],
    from: [DVec3; 8],
    /// Unit vectors.
    to_eye: [DVec3; 8],
    u: [[f64; 8]; 2],
}

impl Queries {
    fn new(random: &mut Random) -> Self {
        let reach = if random.unit() < 0.3 { 0.3 } else { 4.0 };
        let rays = std::array::from_fn(|_| {
            let origin = random.point(reach);
            let direction = match (6.0 * random.unit()) as u32 {
                0 => DVec3::new(0.0, -1.0, -0.0),
                // Equally long along two axes or three.
                1 => DVec3::new(-1.0, 1.0, 0.5),
                2 => DVec3::new(1.0, -1.0, 1.0),
                _ => random.point(1.0) - origin,
            };
            Ray { origin, direction }
        });
        let min = [0; 8].map(|_| if random.unit() < 0.6 { 0.0 } else { 2.0 * random.unit() });
        let max = [0; 8].map(|_| if random.unit() < 0.6 { f64::INFINITY } else { 4.0 * random.unit() });
        Self {
            rays,
            span: [min, max],
            from: [0; 8].map(|_| random.point(reach)),
            to_eye: [0; 8].map(|_| random.direction().normalize()),
            u: [0; 2].map(|_| [0; 8].map(|_| random.unit())),
        }
    }

    /// The results of one lane.
    fn query_one(&self, primitive: &Primitive, lane: usize) -> (RayResult, LightSampleResult) {
        let ray = PreparedRay::<f64>::splat(&TraversalRay::new(self.rays[lane]));
        let within = RayInterval { min: self.span[0][lane], max: self.span[1][lane] };
        let (from, to_eye) = (self.from[lane].into(), self.to_eye[lane].into());
        let drawn = draw(primitive, [from, to_eye], self.u.map(|u| u[lane]));
        (meet(primitive, &ray, within)[0], drawn[0])
    }

    fn query_all(&self, primitive: &Primitive) -> Vec<(RayResult, LightSampleResult)> {
        let (met, drawn) = (dispatch(Meet(primitive, self)), dispatch(Draw(primitive, self)));
        met.into_iter().zip(drawn).collect()
    }
}

struct Meet<'a>(&'a Primitive, &'a Queries);

impl SimdKernel for Meet<'_> {
    type Output = Vec<RayResult>;

    #[inline(always)]
    fn run<L: Level>(self) -> Vec<RayResult> {
        let Self(primitive, Queries { rays, span, .. }) = self;
        let [min, max] = span.map(L::F64::from_array);
        meet(primitive, &PreparedRay::new(eight_rays::<L>(rays)), RayInterval { min, max })
    }
}

struct Draw<'a>(&'a Primitive, &'a Queries);

impl SimdKernel for Draw<'_> {
    type Output = Vec<LightSampleResult>;

    #[inline(always)]
    fn run<L: Level>(self) -> Vec<LightSampleResult> {
        let Self(primitive, Queries { from, to_eye, u, .. }) = self;
        let points = [eight_vectors::<L>(*from), eight_vectors::<L>(*to_eye)];
        draw(primitive, points, u.map(L::F64::from_array))
    }
}

#[inline(always)]
fn meet<F: Real>(primitive: &Primitive, ray: &PreparedRay<F>, within: RayInterval<F>) -> Vec<RayResult> {
    let mut at = primitive.intersect(ray, within);
    let (is_hit, t, coincident) = (at.is_hit().bits(), at.t.to_array(), at.coincident.bits());
    let blocked = primitive.occludes(ray, within).bits();
    // Of a miss, neither t nor the part means anything.
    at.part = F::U32::select(at.is_hit(), at.part, F::U32::splat(0));
    at.t = F::select(at.is_hit(), at.t, F::splat(1.0));
    let (surface, parts) = (primitive.surface(&ray.ray, at), at.part.to_array());
    let passed = primitive.passed(surface, at.part).store();
    let uv = primitive.shape.uv(surface.point, at.part).map(F::to_array);
    let surfaces = surface.store();
    let met = |lane: usize| {
        let is = |bits: u32| bits >> lane & 1 == 1;
        RayResult {
            hit: is(is_hit).then(|| {
                let hit = ShapeHit::of_part(t[lane], parts[lane]);
                ShapeHit { coincident: is(coincident), ..hit }
            }),
            is_blocked: is(blocked),
            surface: surfaces[lane],
            passed: passed[lane],
            uv: [uv[0][lane], uv[1][lane]],
        }
    };
    (0..F::LANES).map(met).collect()
}

#[inline(always)]
fn draw<F: Real>(
    primitive: &Primitive,
    [from, to_eye]: [Vec3<F>; 2],
    [u, v]: [F; 2],
) -> Vec<LightSampleResult> {
    let eye = FrameAxes::from_z_near_x(to_eye, [DVec3::X, DVec3::Y]);
    let (surface, part, pdf) = primitive.sample_from(from, &eye, u, v);
    let density = primitive.pdf_from(from, &surface).to_array();
    let (surfaces, parts, pdf) = (surface.store(), part.to_array(), pdf.to_array());
    (0..F::LANES).map(|lane| (surfaces[lane], parts[lane], pdf[lane], density[lane])).collect()
}

fn shapes() -> Vec<Shape> {
    // Bundles sweep the BVH of the first one, and walk that of the other.
    let mesh = |levels, normals| {
        let mesh = mesh::TriangleMesh::new(generate::displaced_sphere(levels, 5)).expect("a mesh");
        Shape::Mesh(Mesh::new(Arc::new(mesh), normals))
    };
    let (a, b, c) = (DVec3::new(-0.7, -0.6, 0.1), DVec3::new(0.8, -0.2, -0.3), DVec3::new(0.1, 0.9, 0.4));
    let cylinder = |capped| Shape::Cylinder(Cylinder::new(a, b, 0.4, capped).expect("a cylinder"));
    let ball = |center, radius| Shape::Sphere(Sphere { center, radius });
    let cone = |top| Shape::Cone(Cone::new(a, c, 0.7, top, true).expect("a cone"));
    vec![
        Shape::Sphere(Sphere { center: a, radius: 0.8 }),
        Shape::Plane(Plane { point: a, normal: c.normalize() }),
        Shape::Rectangle(Rectangle { corner: a, u: b - a, v: c - a }),
        Shape::Disk(Disk { center: b, normal: c.normalize(), radius: 1.1 }),
        Shape::Triangle(Triangle { corners: [a, b, c] }),
        Shape::Cuboid(Cuboid { min: a, max: DVec3::new(0.3, 0.7, 0.9) }),
        cylinder(true),
        cylinder(false),
        cone(0.0),
        cone(0.3),
        Shape::Torus(Torus::new(b, c.normalize(), 1.0, 0.3)),
        mesh(2, Normals::Smooth),
        mesh(4, Normals::Flat),
        Shape::Particles(Particles::still([a, b, c].map(|center| Sphere { center, radius: 0.6 }).repeat(4))),
        Shape::Solid(Solid::new(Operation::Difference, vec![ball(a, 1.1), ball(b, 0.9)])),
        Shape::Solid(Solid::cut(
            &mesh(2, Normals::Smooth),
            [Plane { point: DVec3::ZERO, normal: c.normalize() }],
        )),
    ]
}

#[test]
fn eight_rays_agree_with_single_rays() {
    let mut random = Random(31);
    let turn = DAffine3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.0);
    let uneven = turn * DAffine3::from_scale(DVec3::new(1.5, -0.7, 1.0)) * turn;
    let places = [DAffine3::IDENTITY, uneven];
    for (shape, place) in shapes().iter().flat_map(|shape| places.map(|place| (shape, place))) {
        let finish = Finish::Material(MaterialBinding::One(0));
        let primitive = Primitive::new(shape, place, finish).expect("a primitive");
        let mut hits = 0;
        for _ in 0..ROUNDS {
            let queries = Queries::new(&mut random);
            let expected: Vec<_> = (0..8).map(|lane| queries.query_one(&primitive, lane)).collect();
            for (level, answers) in on_all_levels(|| queries.query_all(&primitive)) {
                for lane in 0..8 {
                    assert_eq!(answers[lane], expected[lane], "{level:?}, {:?}", queries.rays[lane]);
                }
            }
            hits += expected.iter().filter(|(met, _)| met.hit.is_some()).count();
        }
        assert!(hits as u32 > ROUNDS / 4, "{hits} hits of {:?}", primitive.shape);
    }
}
