//! Lights and cameras that objects carry.

use super::fault::Fault;
use super::placement::chain;
use super::source_file::File;
use super::{Named, Object, Sequence};
use crate::appearance::light::{LightKind, LightTracks};
use crate::base::math::{Angle, DVec3, UpAxis};
use crate::camera::path::{CameraPath, CarriedPath, Step};
use crate::geometry::carrier::{Carrier, LinkIndex, TransformTree};
use crate::geometry::transform::{Rotation, TransformTracks};
use crate::track::{Animated, Switch};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// The most tracks of visibility that the lights of a sequence may depend on, each counted for every light.
const MOST_TRACKS: usize = 1_000_000;

/// The lights and cameras of a scene, each with the index of the object that carries it, and the place of the scene.
pub struct CarriedDraft {
    pub lights: Vec<(usize, LightTracks)>,
    pub cameras: Vec<(usize, CameraPath)>,
    pub place: Range<usize>,
}

/// Lights and cameras that objects carry, each with the place of its scene.
#[derive(Default)]
pub struct Carried {
    pub lights: Vec<(Named<LightTracks>, Range<usize>)>,
    pub cameras: Vec<(Named<CameraPath>, Range<usize>)>,
}

impl Carried {
    /// `up` is the upward axis of the objects.
    pub fn of(file: &File<'_>, objects: &[Named<Object>], drafts: Vec<CarriedDraft>, up: UpAxis) -> Self {
        let of_draft = |draft: &CarriedDraft| -> Vec<usize> {
            let lights = draft.lights.iter().map(|(object, _)| *object);
            lights.chain(draft.cameras.iter().map(|(object, _)| *object)).collect()
        };
        let carriers = Carriers::of(objects, up, drafts.iter().flat_map(of_draft));
        let (mut all, mut tracks) = (Self::default(), 0);
        let name = |object: usize| objects[object].name.clone();
        for CarriedDraft { lights, cameras, place } in drafts {
            for (object, light) in lights {
                let kind =
                    LightKind::Carried { kind: Box::new(light.kind), carrier: carriers.carrier(object) };
                let on = visibility(objects, object, &light.on);
                tracks += on.parts().len();
                if tracks > MOST_TRACKS {
                    let title = "the lights of scenes depend on too many tracks of visibility";
                    let label =
                        format!("more than {MOST_TRACKS} of them, those of all nodes above each light");
                    file.push(Fault::new(place, title, label));
                    return all;
                }
                let value = LightTracks { kind, on, ..light };
                all.lights.push((Named { name: name(object), value }, place.clone()));
            }
            for (object, camera) in cameras {
                let path = vec![carried_step(carriers.carrier(object))];
                let value = CameraPath { path, ..camera };
                all.cameras.push((Named { name: name(object), value }, place.clone()));
            }
        }
        all
    }
}

/// Builds a tree of the transforms of objects and of those above them. Parents form no cycle.
pub struct TreeBuilder<'a> {
    objects: &'a [Named<Object>],
    tree: TransformTree,
    /// The link of objects without parents.
    root: LinkIndex,
    links: HashMap<usize, LinkIndex>,
}

impl<'a> TreeBuilder<'a> {
    /// A tree to the world, in which y points up. `up` is the upward axis of the objects.
    fn to_world(objects: &'a [Named<Object>], up: UpAxis) -> Self {
        let mut tree = TransformTree::default();
        let rotation = Rotation::AxisAngle { axis: DVec3::X.into(), angle: Angle(-90.0).into() };
        let turn = TransformTracks { rotation, ..TransformTracks::default() };
        let root = if up == UpAxis::Z { tree.push(None, None, turn) } else { None };
        Self { objects, tree, root, links: HashMap::new() }
    }

    /// A tree to the space of the object `base`.
    pub fn within(objects: &'a [Named<Object>], base: usize) -> Self {
        Self { objects, tree: TransformTree::default(), root: None, links: HashMap::from([(base, None)]) }
    }

    /// The link of an object, which is added if the tree does not have it.
    pub fn link(&mut self, object: usize) -> LinkIndex {
        let way: Vec<usize> =
            chain(self.objects, object).take_while(|at| !self.links.contains_key(at)).collect();
        let above = match way.last() {
            Some(outermost) => self.objects[*outermost].value.parent,
            None => Some(object),
        };
        let mut link = above.and_then(|above| self.links.get(&above).copied()).unwrap_or(self.root);
        for at in way.into_iter().rev() {
            link = self.tree.push(link, Some(at), self.objects[at].value.transform.clone());
            self.links.insert(at, link);
        }
        link
    }

    pub fn finish(self) -> Arc<TransformTree> {
        Arc::new(self.tree)
    }
}

/// What carries lights and cameras: links of one tree.
struct Carriers {
    tree: Arc<TransformTree>,
    links: HashMap<usize, LinkIndex>,
}

impl Carriers {
    fn of(objects: &[Named<Object>], up: UpAxis, carrying: impl Iterator<Item = usize>) -> Self {
        let mut builder = TreeBuilder::to_world(objects, up);
        let links = carrying.map(|object| (object, builder.link(object))).collect();
        Self { tree: builder.finish(), links }
    }

    /// The carrier of an object for which there is a link.
    fn carrier(&self, object: usize) -> Carrier {
        Carrier::new(object, Arc::clone(&self.tree), self.links.get(&object).copied().flatten())
    }
}

/// The step of a camera that an object carries.
fn carried_step(carrier: Carrier) -> Step {
    Step::Carried(CarriedPath::new(carrier.object, move |time| carrier.rigid_at(time)))
}

/// Whether an object and everything above it is visible, while `on` holds too.
fn visibility(objects: &[Named<Object>], object: usize, on: &Switch) -> Switch {
    let visible = chain(objects, object).map(|at| objects[at].value.visible.clone());
    let parts: Vec<Animated<bool>> = visible.chain(on.parts().iter().cloned()).collect();
    Switch::all_of(parts)
}

impl Sequence {
    /// Updates the lights and cameras that an object carries, and those of the objects below it.
    pub(super) fn refresh_carried(&mut self, object: usize) {
        let in_lights = self.lights.iter().filter_map(|light| match &light.value.kind {
            LightKind::Carried { carrier, .. } => Some(carrier.object),
            _ => None,
        });
        let in_cameras = self.cameras.iter().flat_map(|camera| &camera.value.path);
        let in_cameras = in_cameras.filter_map(|step| match step {
            Step::Carried(path) => Some(path.object),
            _ => None,
        });
        let carrying: Vec<usize> = in_lights.chain(in_cameras).collect();
        let is_below = |at: usize| chain(&self.objects, at).any(|above| above == object);
        if !carrying.iter().any(|at| is_below(*at)) {
            return;
        }
        let carriers = Carriers::of(&self.objects, self.up, carrying.into_iter());
        for light in &mut self.lights {
            if let LightKind::Carried { carrier, .. } = &mut light.value.kind {
                *carrier = carriers.carrier(carrier.object);
            }
        }
        for step in self.cameras.iter_mut().flat_map(|camera| &mut camera.value.path) {
            if let Step::Carried(found) = step {
                *step = carried_step(carriers.carrier(found.object));
            }
        }
    }
}
