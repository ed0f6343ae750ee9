//! Fits cameras to the objects that they frame.
//!
//! A direction's support is the largest dot product with a point of the objects. A camera sees all points if it is
//! beyond their supports in four directions: the normals of the sides of its view. Supports are exact for every shape,
//! so nothing is framed that is not there.

use super::placement::all_above;
use super::{Named, Object, Sequence, ShapeTracks};
use crate::base::math::{Aabb, Angle, Basis, DAffine3, DMat3, DVec2, DVec3, inverse, look_at, max};
use crate::base::time::{Clock, Time};
use crate::camera::Projection;
use crate::camera::path::{CameraPath, Fit, Framed};
use crate::geometry::shape::Shape;
use rayon::prelude::*;

/// Maximum number of points that are compared with every direction, a few seconds of one processor. In longer timelines
/// the boxes of meshes are framed.
const MAX_POINTS: u64 = 1 << 30;

#[warn(missing_docs)]
impl Sequence {
    /// The camera with an index. If it frames objects, it is fitted to them over all frames that it shows.
    pub fn fitted_camera(&self, index: usize) -> CameraPath {
        let mut camera = self.cameras[index].value.clone();
        let fit = Framing::of(self, index).and_then(|framing| framing.fit());
        if let Some(frame) = &mut camera.frame {
            frame.fit = fit;
        }
        camera
    }
}

/// The objects that are framed and have bounds.
pub fn framed(objects: &[Named<Object>], framed: &Framed) -> Vec<usize> {
    let is_framed = |index: usize| match framed {
        Framed::All => true,
        Framed::Listed(listed) => !all_above(objects, index, &|at| !listed.contains(&at)),
    };
    let bounded = |index: &usize| objects[*index].value.shape.bounds().is_some();
    (0..objects.len()).filter(|index| is_framed(*index)).filter(bounded).collect()
}

/// A camera and the objects that it frames, over time.
struct Framing<'a> {
    sequence: &'a Sequence,
    camera: &'a CameraPath,
    margin: f64,
    objects: Vec<usize>,
    frames: Vec<u32>,
    /// Whether the boxes of shapes are framed, not the shapes.
    boxes: bool,
}

/// A camera's view at a moment.
struct View {
    basis: Basis,
    /// Half the width and height of the part of the picture within the margins, at distance 1 or in world units.
    half: DVec2,
    parallel: bool,
}

impl View {
    /// The direction towards the camera, and the normals of the right, left, top and bottom sides of the view, scaled
    /// such that a point p is inside of a side with the normal n if the camera's distance is at least n · p.
    fn normals(&self) -> [DVec3; 5] {
        let Basis { right, up, forward } = self.basis;
        let (x, y) = (right / self.half.x, up / self.half.y);
        let toward = if self.parallel { DVec3::ZERO } else { -forward };
        [-forward, toward + x, toward - x, toward + y, toward - y]
    }
}

impl<'a> Framing<'a> {
    fn of(sequence: &'a Sequence, index: usize) -> Option<Self> {
        let camera = &sequence.cameras[index].value;
        let frame = camera.frame.as_ref()?;
        let objects = framed(&sequence.objects, &frame.objects);
        let timeline = &sequence.timeline;
        let shown = |frame: &u32| {
            sequence.active_camera.cameras(timeline.clock(*frame).start).any(|shown| shown == index)
        };
        let shown: Vec<u32> = (0..timeline.frames).filter(shown).collect();
        let frames = if shown.is_empty() { (0..timeline.frames).collect() } else { shown };
        let mut framing = Self { sequence, camera, margin: frame.margin, objects, frames, boxes: false };
        if framing.is_still() {
            framing.frames.truncate(1);
        }
        let points = framing.objects.iter().map(|&object| match &sequence.objects[object].value {
            Object { shape: Shape::Mesh(mesh), tracks: None, .. } => mesh.mesh.positions().len() as u64,
            Object { tracks: Some(ShapeTracks::Deformed(mesh)), .. } => mesh.vertices() as u64,
            _ => 1,
        });
        framing.boxes = points.sum::<u64>().saturating_mul(framing.frames.len() as u64) > MAX_POINTS;
        Some(framing)
    }

    /// Whether neither the camera nor an object moves.
    fn is_still(&self) -> bool {
        let keyed = |index: usize| {
            let object = &self.sequence.objects[index].value;
            let changes = object.tracks.as_ref().is_some_and(ShapeTracks::is_keyed);
            object.transform.is_keyed() || object.visible.is_keyed() || changes
        };
        let objects = &self.sequence.objects;
        self.camera.is_still()
            && self.objects.iter().all(|&object| all_above(objects, object, &|at| !keyed(at)))
    }

    fn clocks(&self) -> impl ParallelIterator<Item = Clock> {
        self.frames.par_iter().map(|frame| self.sequence.timeline.clock(*frame))
    }

    /// The camera's place; none if there is nothing to frame.
    fn fit(&self) -> Option<Fit> {
        let first = self.view(&self.sequence.timeline.clock(*self.frames.first()?))?;
        let turns = |clock: Clock| self.view(&clock).is_some_and(|view| view.basis != first.basis);
        let center = match self.clocks().any(turns) {
            true => self.middle()?,
            false => self.silhouette_middle(&first)?,
        };
        let needed = |clock: Clock| {
            let view = self.view(&clock)?;
            let placed = self.placed(clock.time);
            let [ahead, sides @ ..] =
                view.normals().map(|normal| self.support(&placed, normal) - normal.dot(center));
            Some([ahead, sides.into_iter().fold(f64::NEG_INFINITY, max)])
        };
        let larger = |a: [f64; 2], b: [f64; 2]| [max(a[0], b[0]), max(a[1], b[1])];
        let [ahead, sides] = self.clocks().filter_map(needed).reduce(|| [f64::NEG_INFINITY; 2], larger);
        usable(match first.parallel {
            false => Fit { center, distance: sides, half_height: None },
            // `half` belongs to a picture of height 2, so `sides` is half the height. In front of everything, so that
            // nothing is cut.
            true => Fit { center, distance: ahead + 2.0 * sides, half_height: Some(sides) },
        })
    }

    /// The middle of the box around the objects over time.
    fn middle(&self) -> Option<DVec3> {
        let around = |clock: Clock| {
            let placed = self.placed(clock.time);
            let ends = |axis: DVec3| (-self.support(&placed, -axis), self.support(&placed, axis));
            let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(ends);
            Aabb { min: DVec3::new(x.0, y.0, z.0), max: DVec3::new(x.1, y.1, z.1) }
        };
        let bounds = self.clocks().map(around).reduce(|| Aabb::EMPTY, Aabb::union);
        (!bounds.is_empty()).then(|| bounds.center())
    }

    /// The point that a camera of constant direction looks at, such that the objects touch opposite sides of the view
    /// alike.
    fn silhouette_middle(&self, view: &View) -> Option<DVec3> {
        let supports = |clock: Clock| {
            let placed = self.placed(clock.time);
            let normals = self.view(&clock).map_or_else(|| view.normals(), |view| view.normals());
            normals.map(|normal| self.support(&placed, normal))
        };
        let larger = |a: [f64; 5], b: [f64; 5]| std::array::from_fn(|i| max(a[i], b[i]));
        let [_, right, left, top, bottom] =
            self.clocks().map(supports).reduce(|| [f64::NEG_INFINITY; 5], larger);
        let Basis { right: x, up: y, forward } = view.basis;
        let across = 0.5 * (right - left) * view.half.x;
        let upward = 0.5 * (top - bottom) * view.half.y;
        // The depth of the middle of the box decides about the focus alone.
        let depth = self.middle()?.dot(forward);
        let center = x * across + y * upward + forward * depth;
        center.is_finite().then_some(center)
    }

    /// The view within the margins; none if the camera has no direction.
    fn view(&self, clock: &Clock) -> Option<View> {
        let pose = self.camera.framed_pose(clock);
        let basis = look_at(pose.position, pose.target, pose.up)?;
        let basis = if pose.roll == Angle(0.0) { basis } else { basis.rolled(pose.roll.cos_sin()) };
        let (width, height) = self.sequence.output.size;
        let (height_at_1, parallel) = match pose.projection {
            Projection::Perspective { half_height } => (half_height, false),
            Projection::Orthographic { .. } => (1.0, true),
        };
        let half = DVec2::new(height_at_1 * f64::from(width) / f64::from(height), height_at_1);
        Some(View { basis, half: half - DVec2::splat(2.0 * self.margin * half.min_element()), parallel })
    }

    /// The visible objects and their transforms at a time, without those that a transform flattens: these are not
    /// visible either. If nothing ever is visible, this is empty.
    fn placed(&self, time: Time) -> Vec<(FramedShape<'a>, DAffine3)> {
        let object = |index: usize| &self.sequence.objects[index].value;
        let visible = |index: &usize| self.sequence.is_visible(*index, time);
        let world = |index: usize| (self.shape(object(index), time), self.sequence.to_world(index, time));
        let solid = |(_, world): &(FramedShape, DAffine3)| inverse(world).is_some();
        self.objects.iter().copied().filter(visible).map(world).filter(solid).collect()
    }

    /// What is framed of an object at a time.
    fn shape(&self, object: &'a Object, time: Time) -> FramedShape<'a> {
        match &object.tracks {
            Some(ShapeTracks::Deformed(mesh)) if !self.boxes => FramedShape::Points(mesh.positions(time)),
            Some(tracks) => FramedShape::Box(tracks.bounds_at(time)),
            None => FramedShape::Own(&object.shape),
        }
    }

    /// The largest dot product of a point of the objects with a direction.
    fn support(&self, placed: &[(FramedShape<'_>, DAffine3)], direction: DVec3) -> f64 {
        let of = |(shape, world): &(FramedShape<'_>, DAffine3)| {
            let local = DMat3::transpose(&world.matrix3) * direction;
            let support = match shape {
                FramedShape::Own(shape) if !self.boxes => shape.support(local),
                FramedShape::Own(shape) => shape.bounds().map(|bounds| box_support(bounds, local)),
                FramedShape::Box(bounds) => bounds.map(|bounds| box_support(bounds, local)),
                FramedShape::Points(points) => points.iter().map(|point| point.dot(local)).reduce(max),
            };
            support.map_or(f64::NEG_INFINITY, |support| support + world.translation.dot(direction))
        };
        placed.iter().map(of).fold(f64::NEG_INFINITY, max)
    }
}

/// What is framed of an object.
enum FramedShape<'a> {
    Own(&'a Shape),
    /// The box around a shape that changes over time. It is known without loading files.
    Box(Option<Aabb>),
    /// The vertices of a deformed mesh.
    Points(Vec<DVec3>),
}

/// The support of a box.
fn box_support(bounds: Aabb, direction: DVec3) -> f64 {
    bounds.corners().into_iter().map(|corner| corner.dot(direction)).fold(f64::NEG_INFINITY, max)
}

/// The fit, unless there is nothing to see or it is too far away.
fn usable(fit: Fit) -> Option<Fit> {
    let sizes = [fit.distance, fit.half_height.unwrap_or(1.0)];
    (fit.center.is_finite() && sizes.iter().all(|size| *size > 0.0 && size.is_finite())).then_some(fit)
}
