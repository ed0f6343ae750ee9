//! What the middle of each pixel sees, to find the same points in other frames.

use super::camera_rays::Placement;
use super::pixels::PixelTracer;
use super::settings::{Moment, TraceSettings};
use super::wavefront::WAVE;
use crate::base::lanes::{Bits, Level, Real, Row, Select, SimdKernel, Vec3, dispatch, prefetch};
use crate::base::math::{Basis, DAffine3, DMat3, DVec3, inverse};
use crate::camera::{Camera, Projection, pixels_of};
use crate::film::denoise::{Memory, Places, RUN, Reprojection, Run, Views};
use crate::geometry::shape::ShapeHit;
use crate::sampling::PixelSampler;
use crate::scene::Scene;
use crate::scene::top_level::{Bvh, NOTHING};
use rayon::prelude::*;

/// How far a surface may lie from the plane through a point of it, at the distance of a pixel, in widths of the pixel:
/// surfaces are curved.
const CURVED: f64 = 2.0;

/// The first hits of the rays through the centres of all pixels, at one moment, and the transforms of their objects.
#[derive(Debug)]
pub struct PrimaryHits {
    size: (u32, u32),
    camera: Camera,
    /// Row by row from the top left.
    hits: Vec<PrimaryHit>,
    /// The normals of the same hits, which only their own frame needs.
    normals: Vec<[f32; 3]>,
    /// Per primitive: from the world to its own space.
    to_object: Vec<DAffine3>,
}

/// A hit in the world. Two are a line of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct PrimaryHit {
    /// Not finite if nothing is hit.
    point: DVec3,
    /// [`NOTHING`] if nothing is hit.
    primitive: u32,
}

/// What the pixels of a run see, in the world of one of the frames.
#[derive(Clone)]
pub struct SeenPoints {
    primitives: [u32; RUN],
    /// Per axis: points of primitives, and the normals of planes through them. Those of the background are as far away
    /// as one unit; in the world of their own frame, they are directions.
    points: [Run; 3],
    normals: [Run; 3],
    /// How far from the plane other points of the surface may lie.
    within: Run,
}

impl PrimaryHits {
    /// Bytes per pixel.
    pub const BYTES_PER_PIXEL: u64 = size_of::<(PrimaryHit, [f32; 3])>() as u64;

    /// The hits that camera rays find, through the centre of the lens.
    pub fn find(scene: &Scene, bvh: &Bvh, settings: &TraceSettings) -> Self {
        let (camera, size) = (Camera { lens: None, ..*scene.camera }, settings.size);
        let scene = Scene { camera: &camera, ..*scene };
        let tracer = PixelTracer::new(&scene, bvh, settings, Moment::ONLY);
        let pixels = size.0 as usize * size.1 as usize;
        let mut hits = vec![PrimaryHit { point: DVec3::NAN, primitive: NOTHING }; pixels];
        let mut normals = vec![[0.0; 3]; pixels];
        let waves = hits.par_chunks_mut(WAVE).zip(normals.par_chunks_mut(WAVE));
        waves.enumerate().for_each(|(wave, (hits, normals))| {
            let mut scratch = tracer.take_scratch();
            let (mut samples, places) = scratch.take_samples();
            samples.clear();
            let centers = (wave * WAVE..).take(hits.len()).map(|pixel| center(pixel, size.0));
            // The way to the first hit takes no random numbers.
            let sampler = PixelSampler::new((0, 0), 0).sample(0);
            centers.clone().for_each(|center| samples.push_at(center, sampler));
            let found = scratch.first_hits(&tracer.context, &samples, Placement::Given);
            let hits = hits.iter_mut().zip(normals);
            for (place, ((hit, normal), center)) in hits.zip(centers).enumerate() {
                let (primitive, part) = (found.primitive[place], found.part[place]);
                if primitive != NOTHING {
                    let ray = camera.pixel_ray(center, size);
                    let at = ShapeHit::of_part(found.t[place], part);
                    let surface = scene.geometry.primitives[primitive as usize].surface_at(&ray, at);
                    *normal = surface.normal.as_vec3().to_array();
                    *hit = PrimaryHit { point: ray.at(at.t), primitive };
                }
            }
            scratch.give_back(samples, places);
            tracer.give_back(scratch);
        });
        let slots = 0..scene.geometry.primitives.len();
        let to_object = slots.map(|slot| *scene.geometry.origin(slot).to_object()).collect();
        Self { size, camera, hits, normals, to_object }
    }

    /// Where other frames see the points that these pixels see. Points move with their objects. What is found has its
    /// memory from `memory`.
    pub fn seen_by(&self, others: &[&Self], memory: &Memory) -> Vec<Reprojection> {
        let others: Vec<_> = others.iter().map(|other| (*other, self.motions(other))).collect();
        Reprojection::all(memory, self.size, others.len(), &Sights { own: self, others })
    }

    /// How each primitive moves to the other frame.
    fn motions(&self, other: &Self) -> Vec<Motion> {
        let both = self.to_object.iter().zip(&other.to_object);
        let motion = |(own, to): (&DAffine3, &DAffine3)| {
            if own == to {
                return Motion::Still;
            }
            match (inverse(own), inverse(to)) {
                (Some(from), Some(back)) => {
                    Motion::Moved { to: back * *own, normals: (from * *to).matrix3.transpose() }
                }
                // Flat objects are hidden.
                _ => Motion::Still,
            }
        };
        both.map(motion).collect()
    }

    /// The direction in which a pixel looks.
    fn direction(&self, pixel: usize) -> DVec3 {
        self.camera.pixel_ray(center(pixel, self.size.0), self.size).direction
    }

    /// A point that is seen in a direction, one unit away.
    #[inline]
    fn point_towards(&self, direction: DVec3) -> Option<DVec3> {
        match self.camera.projection {
            Projection::Perspective { .. } => Some(self.camera.position + direction),
            // All rays have one direction, so it has no place in the picture.
            Projection::Orthographic { .. } => None,
        }
    }
}

/// A frame, and others, to which its points move.
struct Sights<'a> {
    own: &'a PrimaryHits,
    others: Vec<(&'a PrimaryHits, Vec<Motion>)>,
}

impl Views for Sights<'_> {
    type Points = SeenPoints;

    const UNSEEN: SeenPoints = SeenPoints {
        primitives: [NOTHING; RUN],
        points: [[f64::NAN; RUN]; 3],
        normals: [[0.0; RUN]; 3],
        within: [0.0; RUN],
    };

    fn see(&self, first: usize, count: usize, points: &mut SeenPoints) {
        let PrimaryHits { hits, normals, .. } = self.own;
        if count < RUN {
            points.clone_from(&Self::UNSEEN);
        }
        let pixels = (first..).zip(hits[first..][..count].iter().zip(&normals[first..]));
        for (index, (pixel, (hit, normal))) in pixels.enumerate() {
            prefetch(hits, pixel + RUN);
            let point = if hit.primitive == NOTHING { self.own.direction(pixel) } else { hit.point };
            points.set(index, hit.primitive, point, DVec3::from_array(normal.map(f64::from)));
        }
    }

    fn find(&self, film: usize, points: &SeenPoints, moved: &mut SeenPoints, at: &mut [Run; 2]) {
        let (other, motions) = &self.others[film];
        moved.clone_from(points);
        for (index, primitive) in points.primitives.iter().enumerate() {
            let found = match (*primitive, motions.get(*primitive as usize)) {
                (NOTHING, _) => other.point_towards(points.point(index)).map(|point| (point, DVec3::ZERO)),
                (_, Some(Motion::Still)) => continue,
                (_, Some(Motion::Moved { to, normals })) => {
                    let normal = (*normals * points.normal(index)).try_normalize();
                    normal.map(|normal| (to.transform_point3(points.point(index)), normal))
                }
                (_, None) => None,
            };
            match found {
                Some((point, normal)) => moved.set(index, *primitive, point, normal),
                None => moved.set(index, NOTHING, DVec3::NAN, DVec3::ZERO),
            }
        }
        dispatch(Project { by: other, points: &moved.points, at, within: &mut moved.within });
    }

    fn prefetch(&self, film: usize, places: &Places) {
        let (other, _) = &self.others[film];
        // The upper ones have been read for the row above. Two are a line of the cache, as those of two pixels are.
        for pixel in places.pixels[Places::LAST].iter().step_by(2) {
            prefetch(&other.hits, *pixel as usize);
        }
    }

    fn hide(&self, film: usize, moved: &SeenPoints, places: &mut Places) {
        let (from, _) = self.others[film];
        dispatch(Hide { from, seen: moved, places });
    }
}

impl SeenPoints {
    #[inline]
    fn point(&self, index: usize) -> DVec3 {
        DVec3::from_array(self.points.each_ref().map(|axis| axis[index]))
    }

    #[inline]
    fn normal(&self, index: usize) -> DVec3 {
        DVec3::from_array(self.normals.each_ref().map(|axis| axis[index]))
    }

    #[inline]
    fn set(&mut self, index: usize, primitive: u32, point: DVec3, normal: DVec3) {
        self.primitives[index] = primitive;
        for axis in 0..3 {
            (self.points[axis][index], self.normals[axis][index]) = (point[axis], normal[axis]);
        }
    }
}

/// Projects points to a picture.
struct Project<'a> {
    by: &'a PrimaryHits,
    points: &'a [Run; 3],
    /// Positions in pixels; no numbers behind the camera.
    at: &'a mut [Run; 2],
    /// How far surfaces at the points may lie from planes.
    within: &'a mut Run,
}

impl SimdKernel for Project<'_> {
    type Output = ();

    /// In the order of [`Camera::project`].
    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { by: PrimaryHits { size, camera, .. }, points, at: [across, down], within } = self;
        let Basis { right, up, forward } = camera.basis;
        let [right, up, forward] = [Vec3::splat(right), Vec3::splat(up), Vec3::<L::F64>::splat(forward)];
        let position = Vec3::splat(camera.position);
        let [zero, infinite] = [0.0, f64::INFINITY].map(L::F64::splat);
        let (curved, pixel_height) = (L::F64::splat(CURVED), L::F64::splat(2.0 / f64::from(size.1)));
        let none = L::F64::splat(f64::NAN);
        for index in (0..RUN).step_by(L::F64::LANES) {
            let to = load(points, index) - position;
            let depth = to.dot(forward);
            let weight = match camera.projection {
                Projection::Perspective { half_height } => depth * L::F64::splat(half_height),
                Projection::Orthographic { half_height } => L::F64::splat(half_height),
            };
            let [x, y] = [to.dot(right) / weight, to.dot(up) / weight];
            let is_seen = zero.lt(depth) & x.abs().lt(infinite) & y.abs().lt(infinite);
            let [x, y] = pixels_of([x, y], *size);
            L::F64::select(is_seen, x, none).store(across, index);
            L::F64::select(is_seen, y, none).store(down, index);
            (curved * weight * pixel_height).store(within, index);
        }
    }
}

/// Takes the shares of pixels that see something else than the pixels of a run: another primitive, or another part of
/// it.
struct Hide<'a> {
    from: &'a PrimaryHits,
    seen: &'a SeenPoints,
    places: &'a mut Places,
}

impl SimdKernel for Hide<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { from: PrimaryHits { hits, .. }, seen, places: Places { pixels, shares, .. } } = self;
        let (zero, nothing) = (L::F64::splat(0.0), L::U32::splat(NOTHING));
        let (mut points, mut primitives) = ([[0.0; RUN]; 3], [NOTHING; RUN]);
        for (pixels, shares) in pixels.iter().zip(shares) {
            for (index, pixel) in pixels.iter().enumerate() {
                let PrimaryHit { point, primitive } = hits[*pixel as usize];
                [points[0][index], points[1][index], points[2][index]] = point.to_array();
                primitives[index] = primitive;
            }
            for index in (0..RUN).step_by(L::F64::LANES) {
                let away = load::<L::F64>(&points, index) - load(&seen.points, index);
                let away = away.dot(load(&seen.normals, index)).abs();
                let own = L::U32::load(&seen.primitives, index);
                let is_near = away.le(L::F64::load(&seen.within, index)) | own.eq(nothing);
                let is_same = L::U32::load(&primitives, index).eq(own) & is_near;
                L::F64::select(is_same, L::F64::load(shares, index), zero).store(shares, index);
            }
        }
    }
}

/// Vectors of a run from an index on.
#[inline(always)]
fn load<F: Real>([x, y, z]: &[Run; 3], index: usize) -> Vec3<F> {
    Vec3::new(F::load(x, index), F::load(y, index), F::load(z, index))
}

enum Motion {
    Still,
    Moved { to: DAffine3, normals: DMat3 },
}

/// The centre of a pixel, in pixels from the left and from the top.
fn center(pixel: usize, width: u32) -> [f64; 2] {
    let width = width as usize;
    [pixel % width, pixel / width].map(|place| place as f64 + 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::material::{Material, MaterialBinding};
    use crate::base::math::{Angle, DVec2, axis_angle, gamma, look_at};
    use crate::geometry::shape::{Cuboid, Plane, Shape, Sphere};
    use crate::scene::{Finish, Geometry, Shading, Weights};
    use crate::sequence::quality::Quality;

    const SIZE: (u32, u32) = (48, 32);

    /// A floor, a ball and a box that turns about the y-axis by so many degrees.
    fn hits(eye: DVec3, turned: f64) -> PrimaryHits {
        let mut geometry = Geometry::default();
        let finish = Finish::Material(MaterialBinding::One(0));
        let turn = DAffine3::from_mat3(axis_angle(DVec3::Y, Angle(turned)));
        let still = DAffine3::IDENTITY;
        let ball = Sphere { center: DVec3::new(1.5, 1.0, 0.0), radius: 1.0 };
        let cuboid = Cuboid { min: DVec3::new(-2.0, 0.0, -0.5), max: DVec3::new(-1.0, 1.5, 0.5) };
        geometry.push(&Shape::Plane(Plane { point: DVec3::ZERO, normal: DVec3::Y }), still, finish);
        geometry.push(&Shape::Sphere(ball), still, finish);
        geometry.push(&Shape::Cuboid(cuboid), turn, finish);
        let basis = look_at(eye, DVec3::Y, DVec3::Y).expect("a frame");
        let projection = Projection::Perspective { half_height: 0.4 };
        let camera = Camera { position: eye, basis, projection, lens: None };
        let shading = Shading { materials: vec![Material::default()], ..Shading::default() };
        let weights = Weights(Vec::new());
        let scene = Scene { geometry: &geometry, shading: &shading, weights: &weights, camera: &camera };
        PrimaryHits::find(&scene, &Bvh::build(&geometry), &TraceSettings::new(SIZE, Quality::default()))
    }

    /// The number of pixels whose points the other frame sees.
    fn seen(own: &PrimaryHits, other: &PrimaryHits) -> usize {
        let found = own.seen_by(&[other], &Memory::default()).remove(0);
        let pixels = (0..SIZE.1 as usize).flat_map(|y| (0..SIZE.0 as usize).map(move |x| [x, y]));
        pixels.filter(|pixel| found.sees(*pixel)).count()
    }

    const EYE: DVec3 = DVec3::new(0.0, 2.0, 9.0);

    #[test]
    fn still_frames_see_everything() {
        let own = hits(EYE, 20.0);
        let all = (SIZE.0 * SIZE.1) as usize;
        assert_eq!(seen(&own, &hits(EYE, 20.0)), all);
        assert!(own.hits.iter().any(|hit| hit.primitive == NOTHING));
    }

    /// Points of a box that turns are found on its turned sides, and only there.
    #[test]
    fn points_move_with_their_objects() {
        let (own, other) = (hits(EYE, 20.0), hits(EYE, 29.0));
        let Motion::Moved { to, normals } = &own.motions(&other)[2] else { panic!("the box turns") };
        let turn = axis_angle(DVec3::Y, Angle(9.0));
        // Two inverses and products of matrices with entries of at most 1.
        let bound = gamma(32);
        assert!((to.matrix3 - turn).abs_diff_eq(DMat3::ZERO, bound));
        assert!((*normals - turn).abs_diff_eq(DMat3::ZERO, bound));
        assert!(matches!(own.motions(&other)[1], Motion::Still));
        let of_box = |hits: &PrimaryHits| hits.hits.iter().filter(|hit| hit.primitive == 2).count();
        let moved = seen(&own, &other);
        // Some floor behind the box is hidden or appears.
        let all = (SIZE.0 * SIZE.1) as usize;
        assert!(moved < all && moved > all - of_box(&own), "{moved} of {all}, {}", of_box(&own));
    }

    /// From the other side, the same primitives show other points.
    #[test]
    fn hidden_points_are_not_seen() {
        let (own, behind) = (hits(EYE, 0.0), hits(DVec3::new(0.0, 2.0, -9.0), 0.0));
        let found = own.seen_by(&[&behind], &Memory::default()).remove(0);
        // The point of the ball that is nearest to the eye.
        let near = |pixel: &usize| (own.hits[*pixel].point - EYE).length();
        let ball = (0..own.hits.len()).filter(|pixel| own.hits[*pixel].primitive == 1);
        let pixel = ball.min_by(|a, b| near(a).total_cmp(&near(b))).expect("the ball is seen");
        assert!(!found.sees([pixel % SIZE.0 as usize, pixel / SIZE.0 as usize]));
        let floor = own.hits.iter().rposition(|hit| hit.primitive == 0).expect("the floor is seen");
        // A product and a sum along a ray that is a few times as long as the eye is far away.
        let point = own.hits[floor].point;
        assert!(point.y.abs() <= gamma(32) * (point - EYE).length());
    }

    /// Positions in pixels are those through which rays are sent.
    #[test]
    fn points_are_where_rays_meet_them() {
        let own = hits(EYE, 0.0);
        for pixel in 0..own.hits.len() {
            let point = own.point_towards(own.direction(pixel)).expect("a perspective");
            let (mut at, points) = ([[0.0; RUN]; 2], point.to_array().map(|axis| [axis; RUN]));
            dispatch(Project { by: &own, points: &points, at: &mut at, within: &mut [0.0; RUN] });
            // A ray and a projection: fewer than 64 roundings of positions of at most the size of the picture.
            let off = DVec2::new(at[0][0], at[1][0]) - DVec2::from(center(pixel, SIZE.0));
            assert!(off.length() <= gamma(64) * f64::from(SIZE.0), "{pixel}: {at:?}");
        }
    }
}
