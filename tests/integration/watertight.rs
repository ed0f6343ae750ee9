//! Nothing slips through closed surfaces: rays at shared edges, vertices and corners (INT-12, INT-09).

use crate::support::{Random, geometry};
use kinora::appearance::material::MaterialBinding;
use kinora::base::math::{DAffine3, DVec3, Ray};
use kinora::geometry::bvh::TraversalRay;
use kinora::geometry::mesh::generate;
use kinora::geometry::shape::{Cuboid, Shape, Triangle};
use kinora::scene::top_level::Bvh;
use kinora::scene::{Finish, Primitive};

/// Rays per configuration.
const RAYS: u32 = if cfg!(debug_assertions) { 5_000 } else { 100_000 };

/// The triangles of the unit icosphere.
fn icosphere(subdivisions: u32) -> Vec<[DVec3; 3]> {
    let parts = generate::icosphere(subdivisions);
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| parts.positions[vertex as usize]);
    parts.triangles.iter().map(corners).collect()
}

#[test]
fn int_12_no_ray_leaks_between_triangles() {
    let unit = icosphere(3);
    assert_eq!(unit.len(), 1280);
    for (scale, offset) in [(1.0, 0.0), (1.0, 100.0), (1.0, 1e4), (1000.0, 0.0), (1e-6, 1.0)] {
        let center = DVec3::new(1.0, 0.7, -0.3) * offset;
        let mesh: Vec<_> = unit.iter().map(|corners| corners.map(|p| center + p * scale)).collect();
        let geometry = geometry(mesh.iter().map(|&corners| Shape::Triangle(Triangle { corners })));
        assert_eq!(geometry.primitives.len(), mesh.len());
        let bvh = Bvh::build(&geometry);
        let mut random = Random(12);
        let mut leaks = 0;
        for ray in 0..RAYS {
            let origin = center + random.point(0.17) * scale;
            let [a, b, _] = mesh[(random.unit() * mesh.len() as f64) as usize];
            let aim = if ray % 2 == 0 { a } else { a + (b - a) * random.unit() };
            let direction = if ray % 4 < 2 { aim - origin } else { (aim - origin).normalize() };
            let probe = TraversalRay::new(Ray { origin, direction });
            leaks += u32::from(bvh.intersect_one(&geometry, &probe).is_none());
            leaks += u32::from(!bvh.occludes_one(&geometry, &probe, f64::INFINITY));
        }
        assert_eq!(leaks, 0, "scale {scale}, offset {offset}");
    }
}

/// An exact fraction with a denominator above zero.
#[derive(Clone, Copy)]
struct Exact(i64, i64);

impl Exact {
    fn new(numerator: i64, denominator: i64) -> Self {
        Self(numerator * denominator.signum(), denominator.abs())
    }

    fn below(self, other: Self) -> bool {
        self.0 * other.1 < other.0 * self.1
    }

    fn value(self) -> f64 {
        self.0 as f64 / self.1 as f64
    }
}

/// Where the line origin + t direction enters and leaves the box from -`half` to `half`, in exact integers.
fn crossings(half: i64, origin: [i64; 3], direction: [i64; 3]) -> Option<(Exact, Exact)> {
    let (mut enter, mut leave) = (Exact(i64::from(i32::MIN), 1), Exact(i64::from(i32::MAX), 1));
    for (o, d) in origin.into_iter().zip(direction) {
        if d == 0 {
            if o.abs() > half {
                return None;
            }
            continue;
        }
        let (a, b) = (Exact::new(-half - o, d), Exact::new(half - o, d));
        let (near, far) = if a.below(b) { (a, b) } else { (b, a) };
        enter = if enter.below(near) { near } else { enter };
        leave = if far.below(leave) { far } else { leave };
    }
    (!leave.below(enter)).then_some((enter, leave))
}

/// Rays between points of a lattice meet faces, edges and corners exactly. Integers decide what is right: whether
/// the line meets the box, and where. Of two crossings the first lies ahead of an origin outside, the second
/// ahead of one inside: none is missing, none too many.
#[test]
fn boxes_are_met_exactly_where_they_are() {
    const HALF: i64 = 4;
    let cuboid = Cuboid { min: DVec3::splat(-(HALF as f64)), max: DVec3::splat(HALF as f64) };
    let geometry = geometry([Shape::Cuboid(cuboid)]);
    let bvh = Bvh::build(&geometry);
    let float = |p: [i64; 3]| DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64);
    let mut random = Random(9);
    let (mut met, mut touched) = (0, 0);
    for reach in [5, 30, 10_000] {
        for _ in 0..RAYS {
            let mut lattice = |reach: i64| {
                [(); 3]
                    .map(|()| ((random.unit() * (2 * reach + 1) as f64) as i64 - reach).clamp(-reach, reach))
            };
            let (origin, aim) = (lattice(reach), lattice(HALF + 1));
            let direction = [0, 1, 2].map(|axis| aim[axis] - origin[axis]);
            let on_surface = origin.iter().any(|o| o.abs() == HALF) && origin.iter().all(|o| o.abs() <= HALF);
            if direction == [0; 3] || on_surface {
                continue;
            }
            let probe = TraversalRay::new(Ray { origin: float(origin), direction: float(direction) });
            let t = bvh.intersect_one(&geometry, &probe).map(|hit| hit.at.t);
            let zero = Exact(0, 1);
            let expected = crossings(HALF, origin, direction).and_then(|(enter, leave)| {
                touched += u32::from(!enter.below(leave));
                let first = if zero.below(enter) { enter } else { leave };
                zero.below(first).then_some(first.value())
            });
            assert_eq!(t, expected, "from {origin:?} along {direction:?}");
            met += u32::from(t.is_some());
        }
    }
    assert!(met > RAYS && touched > 100, "{met} met, {touched} touched at an edge or corner");
}

/// Turned boxes: a ray at a point inside meets the box, and from that point it leaves exactly once.
#[test]
fn turned_boxes_are_entered_and_left_once() {
    let cuboid = Shape::Cuboid(Cuboid { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) });
    let mut random = Random(10);
    let turn = DAffine3::from_axis_angle(DVec3::new(0.6, 0.64, 0.48), 1.0);
    let affine = DAffine3::from_translation(DVec3::new(5.0, -3.0, 2.0))
        * turn
        * DAffine3::from_scale(DVec3::new(2.0, 1.0, 0.5));
    let placed = Primitive::new(&cuboid, affine, Finish::Material(MaterialBinding::One(0))).expect("a box");
    assert!(placed.transform.is_some(), "it is turned");
    for distance in [6.0, 100.0, 1e4] {
        for _ in 0..RAYS / 3 {
            let inside = affine.transform_point3(random.point(0.999));
            let direction = random.point(1.0).normalize();
            let origin = inside - direction * distance;
            let hit = |origin| {
                placed
                    .intersect_up_to(&TraversalRay::new(Ray { origin, direction }), f64::INFINITY)
                    .map(|at| at.t)
            };
            let enter = hit(origin).expect("it enters");
            let leave = hit(inside).expect("it leaves");
            assert!(enter < distance && leave < 6.0);
            assert_eq!(hit(inside + direction * (leave + 1e-6)), None, "it is outside");
        }
    }
}
