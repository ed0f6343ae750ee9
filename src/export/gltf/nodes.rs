//! Objects as nodes.

use super::Exporter;
use super::keys::Keys;
use super::materials::MaterialIndices;
use super::meshes::{Meshes, Placement};
use crate::base::math::{DMat3, DQuat, DVec3, UpAxis, rotation_and_scale};
use crate::base::time::Time;
use crate::geometry::shape::Shape;
use crate::geometry::transform::{Rotation, TransformTracks};
use crate::sequence::{Object, ShapeTracks};
use crate::track::Animated;
use serde_json::{Map, Value, json};

/// A transform over time: constants, and keys of what changes.
pub struct Placed {
    pub translation: DVec3,
    pub rotation: DQuat,
    pub scale: DVec3,
    pub keys: [Option<Keys>; 3],
}

impl Placed {
    pub fn at(translation: DVec3) -> Self {
        Self { translation, rotation: DQuat::IDENTITY, scale: DVec3::ONE, keys: Default::default() }
    }
}

/// The properties of a node, in the order of [`Placed::keys`].
const PATHS: [&str; 3] = ["translation", "rotation", "scale"];

impl Exporter<'_> {
    /// Adds a node with this transform below another one. Returns its index.
    pub fn node(
        &mut self,
        name: &str,
        placed: &Placed,
        mut more: Map<String, Value>,
        parent: Option<usize>,
    ) -> usize {
        more.insert("name".into(), json!(name));
        let Placed { translation, rotation, scale, keys } = placed;
        // Properties with keys are stated as well, for readers without animations.
        if *translation != DVec3::ZERO || keys[0].is_some() {
            more.insert("translation".into(), json!(translation.to_array()));
        }
        if *rotation != DQuat::IDENTITY || keys[1].is_some() {
            more.insert("rotation".into(), json!(rotation.to_array()));
        }
        if *scale != DVec3::ONE || keys[2].is_some() {
            more.insert("scale".into(), json!(scale.to_array()));
        }
        let index = self.document.push("nodes", Value::Object(more));
        for (keys, path) in keys.iter().zip(PATHS) {
            if let Some(keys) = keys {
                let sampler = keys.sampler(&mut self.document);
                self.document.animate(json!({ "node": index, "path": path }), sampler);
            }
        }
        match parent.and_then(|parent| self.document.entry("nodes", parent)) {
            Some(parent) => match parent.get_mut("children").and_then(Value::as_array_mut) {
                Some(children) => children.push(json!(index)),
                None => parent["children"] = json!([index]),
            },
            None => self.roots.push(index),
        }
        index
    }

    /// Adds the nodes of all objects. Returns the number of triangles of all meshes.
    pub fn objects(&mut self, materials: &MaterialIndices) -> usize {
        let objects = &self.sequence.objects;
        let root = (self.sequence.up != UpAxis::Y).then(|| {
            let rotation = DQuat::from_mat3(&self.sequence.up.matrix());
            self.node("axes", &Placed { rotation, ..Placed::at(DVec3::ZERO) }, Map::new(), None)
        });
        let mut is_parent = vec![false; objects.len()];
        objects.iter().filter_map(|object| object.value.parent).for_each(|parent| is_parent[parent] = true);
        let mut meshes = Meshes::default();
        // The node to which the children of an object belong.
        let mut inner: Vec<Option<usize>> = vec![None; objects.len()];
        for index in parents_first(objects.iter().map(|object| object.value.parent)) {
            let object = &objects[index].value;
            let parent = object.parent.and_then(|parent| inner[parent]).or(root);
            let shown = meshes.of(self, object, materials);
            inner[index] = Some(self.object((&objects[index].name, object), shown, is_parent[index], parent));
        }
        meshes.triangles
    }

    /// Adds the nodes of an object with its mesh. Returns the one to which its children belong.
    fn object(
        &mut self,
        (name, object): (&str, &Object),
        shown: Option<(usize, Placement)>,
        has_children: bool,
        parent: Option<usize>,
    ) -> usize {
        self.note_shape(object);
        let (mut placed, mut within) = self.placed(&object.transform);
        let mut more = Map::new();
        let is_fixed = within == DVec3::ZERO;
        if let Some((mesh, Placement { translation, scale })) = shown.filter(|_| !has_children) {
            if is_fixed && placed.keys[1].is_none() && placed.keys[2].is_none() {
                // The place of the shape goes into the transform of the object: T + R S (c + s p).
                let offset = placed.rotation * (placed.scale * translation);
                placed.translation += offset;
                placed.keys[0] = placed.keys[0].take().map(|keys| keys.scaled(1.0, &offset.to_array()));
                placed.scale *= scale;
                more.insert("mesh".into(), json!(mesh));
                let node = self.node(name, &placed, more, parent);
                self.visibility(&object.visible, node);
                return node;
            }
            within += translation;
            let outer = self.node(name, &placed, more, parent);
            self.visibility(&object.visible, outer);
            let mesh = Map::from_iter([("mesh".into(), json!(mesh))]);
            self.leaf(name, (within, scale), mesh, outer);
            return outer;
        }
        let outer = self.node(name, &placed, more, parent);
        self.visibility(&object.visible, outer);
        let inner = match is_fixed {
            true => outer,
            false => self.node(&format!("{name} pivot"), &Placed::at(within), Map::new(), Some(outer)),
        };
        if let Some((mesh, Placement { translation, scale })) = shown {
            self.leaf(name, (translation, scale), Map::from_iter([("mesh".into(), json!(mesh))]), inner);
        }
        inner
    }

    /// Shows a mesh at a node. It gets a node of its own if it is moved there.
    fn leaf(
        &mut self,
        name: &str,
        (translation, scale): (DVec3, DVec3),
        mesh: Map<String, Value>,
        node: usize,
    ) {
        if translation == DVec3::ZERO && scale == DVec3::ONE {
            if let Some(Value::Object(node)) = self.document.entry("nodes", node) {
                node.extend(mesh);
            }
            return;
        }
        self.node(&format!("{name} shape"), &Placed { scale, ..Placed::at(translation) }, mesh, Some(node));
    }

    /// The transform of an object, and that of its points before: away from its pivot, if it turns or grows about it.
    fn placed(&mut self, tracks: &TransformTracks) -> (Placed, DVec3) {
        let timeline = &self.sequence.timeline;
        let start = timeline.clock(0).time;
        if tracks.motion.is_some() || tracks.explode.is_some() {
            return (self.moved(tracks), DVec3::ZERO);
        }
        let TransformTracks { translation, rotation, scale, pivot, motion: _, explode: _ } = tracks;
        let turned = match rotation {
            Rotation::Quaternion(rotation) => Keys::of(rotation, timeline),
            _ if rotation.is_keyed() => {
                let at = |time: Time| quaternion(&rotation.at(time)).to_array().to_vec();
                Keys::sampled(timeline, false, true, at)
            }
            _ => None,
        };
        let scaled = Keys::of(scale, timeline);
        let now = match rotation {
            Rotation::Quaternion(rotation) => rotation.at(start),
            _ => quaternion(&rotation.at(start)),
        };
        let still = turned.is_none() && scaled.is_none();
        let own = scale.at(start);
        let offset = if still { *pivot - now * (own * *pivot) } else { *pivot };
        let moved = Keys::of(translation, timeline).map(|keys| keys.scaled(1.0, &offset.to_array()));
        let placed = Placed {
            translation: translation.at(start) + offset,
            rotation: now,
            scale: own,
            keys: [moved, turned, scaled],
        };
        (placed, if still { DVec3::ZERO } else { -*pivot })
    }

    /// The transform of an object that moves not by its keys alone, at every frame.
    fn moved(&mut self, tracks: &TransformTracks) -> Placed {
        let timeline = &self.sequence.timeline;
        let mut sheared = false;
        let mut parts = |time: Time| {
            let affine = tracks.at(time);
            let (rotation, scale) = rotation_and_scale(affine.matrix3).unwrap_or_else(|_| {
                sheared = true;
                let (scale, rotation, _) = affine.to_scale_rotation_translation();
                (rotation, scale)
            });
            (affine.translation, rotation, scale)
        };
        let all: Vec<_> = (0..=timeline.frames).map(|frame| parts(timeline.clock(frame).time)).collect();
        let (translation, rotation, scale) = parts(timeline.clock(0).time);
        let frame = |time: Time| timeline.frame_at(time) as usize;
        let keys = [
            Keys::sampled(timeline, false, false, |time| all[frame(time)].0.to_array().to_vec()),
            Keys::sampled(timeline, false, true, |time| all[frame(time)].1.to_array().to_vec()),
            Keys::sampled(timeline, false, false, |time| all[frame(time)].2.to_array().to_vec()),
        ];
        if sheared {
            self.left_out.note_of("the shear", "object");
        }
        Placed { translation, rotation, scale, keys }
    }

    /// Writes the visibility of a node (`KHR_node_visibility`), unless it is always visible.
    fn visibility(&mut self, visible: &Animated<bool>, node: usize) {
        let timeline = &self.sequence.timeline;
        let now = visible.at(timeline.clock(0).time);
        let keys = Keys::of(visible, timeline);
        if now && keys.is_none() {
            return;
        }
        let name = self.document.uses("KHR_node_visibility");
        if let Some(entry) = self.document.entry("nodes", node) {
            entry["extensions"] = json!({ name: { "visible": now } });
        }
        if let Some(keys) = keys {
            let sampler = keys.sampler(&mut self.document);
            self.document.animate_pointer(&format!("/nodes/{node}/extensions/{name}/visible"), sampler);
        }
    }

    /// Notes shapes that change over time.
    fn note_shape(&mut self, object: &Object) {
        match &object.tracks {
            Some(ShapeTracks::Series(series)) if series.is_keyed() => {
                self.left_out.note_of("all meshes but the first", "object");
            }
            Some(ShapeTracks::Deformed(mesh)) if mesh.is_keyed() => {
                self.left_out.note_of("the motion of morph targets and joints", "object");
            }
            Some(ShapeTracks::Particles(_)) => self.left_out.note_of("the particles", "object"),
            _ => {}
        }
        if !object.clip.is_empty() {
            self.left_out.note_of("the cuts", "object");
        }
        if let Shape::Solid(_) = object.shape {
            self.left_out.note_of("the solid made of others", "object");
        }
    }
}

/// The unit quaternion of a rotation matrix.
pub fn quaternion(matrix: &DMat3) -> DQuat {
    DQuat::from_mat3(matrix).normalize()
}

/// Indices, parents before children.
fn parents_first(parents: impl ExactSizeIterator<Item = Option<usize>>) -> Vec<usize> {
    let (mut order, mut children) = (Vec::new(), vec![Vec::new(); parents.len()]);
    for (index, parent) in parents.enumerate() {
        match parent {
            Some(parent) => children[parent].push(index),
            None => order.push(index),
        }
    }
    let mut next = 0;
    while let Some(&parent) = order.get(next) {
        order.append(&mut children[parent]);
        next += 1;
    }
    order
}
