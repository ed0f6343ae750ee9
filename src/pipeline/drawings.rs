//! What annotations draw over each frame.
//!
//! Annotations need no world: the sequence says where the camera and the objects are. Only labels that surfaces may hide
//! need the scene, for one ray each.

use crate::annotate::{Annotation, AnnotationKind, FrameView, PlacedObject, drawing};
use crate::base::math::{DVec2, DVec3, Ray, gamma};
use crate::base::time::{Clock, Time};
use crate::camera::Camera;
use crate::camera::path::CameraPath;
use crate::drawing::Drawing;
use crate::encode::{FrameInfo, SequenceInfo};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::ray_kinds::RayKind;
use crate::geometry::shape::{RayInterval, Shape};
use crate::pipeline::schedule::Preview;
use crate::scene::Scene;
use crate::scene::top_level::Bvh;
use crate::sequence::Sequence;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The drawings of frames, in their order. Empty if the sequence has no annotations and no caption.
pub fn drawings(sequence: &Sequence, frames: &[u32]) -> Vec<Arc<Drawing>> {
    let illustrator = Illustrator::new(sequence);
    if illustrator.annotations.is_empty() {
        return Vec::new();
    }
    // One world per part, because a world takes long to build.
    let part = frames.len().div_ceil(rayon::current_num_threads()).max(1);
    let parts = frames.par_chunks(part).flat_map_iter(|frames| illustrator.drawings(frames));
    parts.collect()
}

/// A sequence with what all its frames share.
struct Illustrator<'a> {
    sequence: &'a Sequence,
    cameras: Vec<CameraPath>,
    annotations: Vec<Annotation>,
    /// For each object to which labels are tied, the slots that do not hide them.
    slots: BTreeMap<usize, Vec<u32>>,
    info: SequenceInfo,
}

/// Objects at times, which trails ask for again in every frame. At most so many are kept.
type Places = RefCell<FxHashMap<(usize, Time), PlacedObject>>;
const MAX_PLACES: usize = 1 << 17;

impl<'a> Illustrator<'a> {
    fn new(sequence: &'a Sequence) -> Self {
        let annotations = sequence.annotations.iter().map(|annotation| annotation.value.clone());
        let annotations: Vec<Annotation> = annotations.chain(sequence.output.caption.clone()).collect();
        let tied = annotations.iter().filter_map(|annotation| match &annotation.kind {
            AnnotationKind::Label(label) => label.at.object(),
            _ => None,
        });
        Self {
            sequence,
            cameras: (0..sequence.cameras.len()).map(|index| sequence.fitted_camera(index)).collect(),
            slots: tied.map(|object| (object, slots_below(sequence, object))).collect(),
            annotations,
            info: sequence.about(),
        }
    }

    fn drawings(&self, frames: &[u32]) -> Vec<Arc<Drawing>> {
        let needs_rays = self.annotations.iter().any(|annotation| annotation.kind.needs_rays());
        let mut preview = needs_rays.then(|| Preview::with_rays(self.sequence));
        let (mut bvh, places): (Option<Bvh>, _) = (None, Places::default());
        let mut drawn: Vec<Arc<Drawing>> = Vec::with_capacity(frames.len());
        for &frame in frames {
            let seen = preview.as_mut().and_then(|preview| {
                preview.scene_of(frame, |scene| {
                    let bvh = bvh.get_or_insert_with(|| Bvh::build(scene.geometry));
                    bvh.update(scene.geometry);
                    self.drawing(frame, &places, &|point, own| self.is_hidden(scene, bvh, point, own))
                })
            });
            let next = seen.unwrap_or_else(|| self.drawing(frame, &places, &|_, _| false));
            // Equal frames share memory.
            let last = drawn.last().filter(|last| ***last == next).cloned();
            drawn.push(last.unwrap_or_else(|| Arc::new(next)));
        }
        drawn
    }

    /// The drawing of a frame. Nothing if it has no camera; rendering reports that.
    fn drawing(
        &self,
        frame: u32,
        places: &Places,
        is_hidden: &dyn Fn(DVec3, Option<usize>) -> bool,
    ) -> Drawing {
        let (sequence, clock) = (self.sequence, self.sequence.timeline.clock(frame));
        let Some(camera) = self.camera(&clock) else { return Drawing::default() };
        let object = |index: usize, time: Time| {
            let mut places = places.borrow_mut();
            if places.len() >= MAX_PLACES {
                places.clear();
            }
            *places.entry((index, time)).or_insert_with(|| PlacedObject {
                to_world: sequence.to_world(index, time),
                bounds: sequence.bounds_at(index, time),
                visible: sequence.is_visible(index, time),
            })
        };
        let view = FrameView {
            camera,
            size: sequence.output.size,
            time: clock.start,
            info: FrameInfo { sequence: &self.info, frame, rate: sequence.timeline.rate },
            axes: [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| sequence.up.to_y_up(axis)),
            object: &object,
            is_hidden,
        };
        drawing(&self.annotations, &view)
    }

    /// The camera at the start of a frame: in a cross-fade, the one with the larger share. What is in focus does not
    /// matter.
    fn camera(&self, clock: &Clock) -> Option<Camera> {
        let index = self.sequence.active_camera.leading(clock.start).min(self.cameras.len() - 1);
        self.cameras[index].at(clock, None).ok()
    }

    /// Whether a surface is in front of a point, besides those of an object and all below it.
    fn is_hidden(&self, scene: &Scene, bvh: &Bvh, point: DVec3, own: Option<usize>) -> bool {
        let camera = Camera { lens: None, ..*scene.camera };
        let Some(screen) = camera.project(point).screen() else { return false };
        let ray = camera.ray(screen, DVec2::ZERO);
        let slots = own.and_then(|own| self.slots.get(&own)).map_or(&[][..], Vec::as_slice);
        let within = RayInterval::up_to((point - ray.origin).dot(ray.direction));
        let mut hidden = false;
        bvh.of(RayKind::Camera).each_hit(scene.geometry, &TraversalRay::new(ray), within, &mut |hit| {
            if !slots.contains(&hit.primitive) {
                let surface = scene.geometry.primitives[hit.primitive as usize].surface_at(&ray, hit.at);
                hidden |= is_ahead(&ray, surface.point, surface.error, point);
            }
        });
        hidden
    }
}

/// The slots of an object and of all objects below it. Objects with a shape have slots in their order.
fn slots_below(sequence: &Sequence, own: usize) -> Vec<u32> {
    let objects = &sequence.objects;
    let solid = (0..objects.len()).filter(|index| objects[*index].value.shape != Shape::Group);
    let below = (0..).zip(solid).filter(|(_, index)| sequence.ancestry(*index).any(|at| at == own));
    below.map(|(slot, _)| slot).collect()
}

/// Whether a point of a surface, which is known up to an error, is certainly nearer than another point of a ray. So
/// labels on a surface are not hidden by it.
fn is_ahead(ray: &Ray, surface: DVec3, error: DVec3, point: DVec3) -> bool {
    let along = ray.direction.abs();
    // The differences below, and the ray through the projected point, round in the last bits of coordinates.
    let rounding = (surface.abs() + point.abs() + ray.origin.abs()) * gamma(16);
    (point - surface).dot(ray.direction) > (error + rounding).dot(along)
}
