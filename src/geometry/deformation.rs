//! Deformed meshes over time.

use super::carrier::{LinkIndex, TransformTree};
use super::mesh::deform::Deformer;
use super::mesh::{MeshError, Normals, TriangleMesh};
use super::shape::{Mesh, MeshStep};
use crate::base::digest::Digest;
use crate::base::math::{Aabb, DAffine3, DVec3};
use crate::base::time::Time;
use crate::track::Animated;
use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

/// Deformed meshes that are kept: an open shutter may return to the one before.
const KEPT: usize = 2;

/// The most boxes that are kept, a few megabytes.
const MOST_BOUNDS: usize = 1 << 15;

/// The most moments whose boxes are joined.
const MOST_MOMENTS: usize = 4096;

/// A mesh that morph targets and joints deform.
#[derive(Debug)]
pub struct DeformedMesh {
    rest: Arc<TriangleMesh>,
    normals: Normals,
    deformer: Arc<Deformer>,
    /// One for each morph target.
    weights: Vec<Animated<f64>>,
    joints: Joints,
    kept: Mutex<Kept>,
}

/// The joints of a mesh.
#[derive(Clone, Debug, Default)]
pub struct Joints {
    pub tree: Arc<TransformTree>,
    /// The link of each joint in the tree, with the map from the mesh at rest to it.
    pub links: Arc<[(LinkIndex, DAffine3)]>,
}

/// The last meshes, and the boxes of all, by the digests of their poses. A box is none if nothing is visible.
#[derive(Debug, Default)]
struct Kept {
    bounds: HashMap<Digest, Option<Aabb>>,
    meshes: Vec<(Digest, Arc<TriangleMesh>)>,
}

/// Compared by address, as meshes are.
impl PartialEq for DeformedMesh {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl Joints {
    fn all(&self) -> impl Iterator<Item = LinkIndex> {
        self.links.iter().map(|(link, _)| *link)
    }

    fn is_keyed(&self) -> bool {
        self.all().any(|link| self.tree.is_keyed(link))
    }

    /// The maps from the mesh at rest.
    fn maps(&self, time: Time) -> Vec<DAffine3> {
        let maps = self.tree.maps(self.all(), time).into_iter();
        maps.zip(self.links.iter()).map(|(map, (_, rest))| map * *rest).collect()
    }
}

/// What deforms a mesh at a time.
struct MeshPose {
    weights: Vec<f64>,
    joints: Vec<DAffine3>,
    digest: Digest,
}

impl DeformedMesh {
    /// `rest` is the mesh at rest, or another one that takes its place where only digests and boxes count.
    pub fn new(
        (rest, normals): (Arc<TriangleMesh>, Normals),
        deformer: Arc<Deformer>,
        weights: Vec<Animated<f64>>,
        joints: Joints,
    ) -> Self {
        Self { rest, normals, deformer, weights, joints, kept: Mutex::default() }
    }

    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// The same mesh with the joints in another tree of the same form.
    pub fn with_tree(&self, tree: Arc<TransformTree>) -> Self {
        let (rest, deformer) = (Arc::clone(&self.rest), Arc::clone(&self.deformer));
        let joints = Joints { tree, links: Arc::clone(&self.joints.links) };
        Self::new((rest, self.normals), deformer, self.weights.clone(), joints)
    }

    /// Whether the mesh may change over time.
    pub fn is_keyed(&self) -> bool {
        self.joints.is_keyed() || self.weights.iter().any(Animated::is_keyed)
    }

    /// The number of vertices that triangles show.
    pub fn vertices(&self) -> usize {
        self.deformer.vertices()
    }

    fn pose(&self, time: Time) -> MeshPose {
        let weights: Vec<f64> = self.weights.iter().map(|weight| weight.at(time)).collect();
        let joints = self.joints.maps(time);
        let digest = Digest::of(&(self.deformer.digest(), &weights, &joints));
        MeshPose { weights, joints, digest }
    }

    fn bounds(&self, pose: &MeshPose) -> Option<Aabb> {
        if let Some(known) = self.kept().bounds.get(&pose.digest) {
            return *known;
        }
        let bounds = self.deformer.bounds(&pose.weights, &pose.joints);
        let mut kept = self.kept();
        if kept.bounds.len() >= MOST_BOUNDS {
            kept.bounds.clear();
        }
        kept.bounds.insert(pose.digest, bounds);
        bounds
    }

    /// A box around the mesh at the start, at the keys of its morph targets and joints, and midway between these. At other
    /// times it may reach a little farther, as joints turn.
    pub fn key_bounds(&self) -> Aabb {
        let weights = self.weights.iter().flat_map(Animated::key_times);
        let joints = self.joints.tree.tracks(self.joints.all());
        let keys: BTreeSet<Time> = weights
            .chain(joints.flat_map(|tracks| tracks.key_times()))
            .chain([Time::from_integer(0)])
            .collect();
        let keys: Vec<Time> = keys.into_iter().collect();
        let middle = |pair: &[Time]| (pair[0] + pair[1]) / Time::from_integer(2);
        let times: Vec<Time> = keys.windows(2).map(middle).chain(keys.iter().copied()).collect();
        let step = times.len().div_ceil(MOST_MOMENTS);
        let boxes = times.into_iter().step_by(step).filter_map(|time| self.bounds(&self.pose(time)));
        boxes.fold(Aabb::EMPTY, Aabb::union)
    }

    /// The positions of the vertices that triangles show at a time; none if no triangle has an area.
    pub fn positions(&self, time: Time) -> Vec<DVec3> {
        let pose = self.pose(time);
        match self.bounds(&pose) {
            Some(_) => self.deformer.used_positions(&pose.weights, &pose.joints),
            None => Vec::new(),
        }
    }

    fn kept(&self) -> std::sync::MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The shape with a mesh; none if no triangle has an area.
    fn shape(&self, pose: &MeshPose, mesh: Arc<TriangleMesh>) -> Option<Mesh> {
        let step = MeshStep { digest: pose.digest, bounds: self.bounds(pose)? };
        Some(Mesh { mesh, normals: self.normals, step: Some(step) })
    }

    /// The shape at a time without its mesh: that at rest takes its place. None if no triangle has an area.
    pub fn named(&self, time: Time) -> Option<Mesh> {
        self.shape(&self.pose(time), Arc::clone(&self.rest))
    }

    /// The shape at a time; none if no triangle has an area.
    ///
    /// # Errors
    /// If a position is not finite, or beyond 1e30.
    pub fn loaded(&self, time: Time) -> Result<Option<Mesh>, MeshError> {
        let pose = self.pose(time);
        if self.bounds(&pose).is_none() {
            return Ok(None);
        }
        let known = self
            .kept()
            .meshes
            .iter()
            .find(|(digest, _)| *digest == pose.digest)
            .map(|(_, mesh)| Arc::clone(mesh));
        let mesh = match known {
            Some(mesh) => mesh,
            None => {
                let data = self.deformer.deformed(&pose.weights, &pose.joints);
                let last = self.kept().meshes.last().map(|(_, mesh)| Arc::clone(mesh));
                let mesh = Arc::new(TriangleMesh::after(data, Some(last.as_ref().unwrap_or(&self.rest)))?);
                self.keep(pose.digest, &mesh);
                mesh
            }
        };
        Ok(self.shape(&pose, mesh))
    }

    /// Keeps a mesh instead of the oldest one.
    fn keep(&self, digest: Digest, mesh: &Arc<TriangleMesh>) {
        let meshes = &mut self.kept().meshes;
        if meshes.len() == KEPT {
            meshes.remove(0);
        }
        meshes.push((digest, Arc::clone(mesh)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Angle;
    use crate::geometry::mesh::MeshData;
    use crate::geometry::mesh::deform::{Influence, MorphTarget};
    use crate::geometry::transform::{Rotation, TransformTracks};
    use crate::track::{Ease, Key, Repeat, Track};

    fn seconds(time: i128) -> Time {
        Time::from_integer(time)
    }

    fn keyed<T: crate::track::Animate>(keys: [(i128, T); 2]) -> Track<T> {
        let key = |(time, value)| Key { time: seconds(time), value, ease: Ease::Linear };
        Track::new(keys.into_iter().map(key).collect(), Repeat::Hold, false).expect("a track")
    }

    fn mesh(target: Vec<DVec3>, weight: Animated<f64>, joint: Option<TransformTracks>) -> DeformedMesh {
        let data = MeshData {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2]],
            ..MeshData::default()
        };
        let rest = Arc::new(TriangleMesh::new(data.clone()).expect("a mesh"));
        let mut tree = TransformTree::default();
        let link = joint.map(|tracks| tree.push(None, Some(0), tracks));
        let influences = link.map_or(Vec::new(), |_| vec![Influence { joint: 0, weight: 1.0 }; 3]);
        let width = usize::from(link.is_some());
        let targets = vec![MorphTarget { positions: target, normals: Vec::new() }];
        let deformer = Arc::new(Deformer::new(data, targets, influences, width));
        let links = link.into_iter().map(|link| (link, DAffine3::IDENTITY)).collect();
        DeformedMesh::new(
            (rest, Normals::Flat),
            deformer,
            vec![weight],
            Joints { tree: Arc::new(tree), links },
        )
    }

    #[test]
    fn a_mesh_without_an_area_is_nothing_and_one_out_of_range_is_an_error() {
        let collapse = vec![DVec3::ZERO, DVec3::NEG_X, DVec3::NEG_Y];
        let mesh = mesh(collapse, Animated::Keyed(keyed([(0, 0.0), (2, 2.0)])), None);
        let loaded = |time| mesh.loaded(seconds(time)).expect("in range");
        assert!(loaded(0).is_some() && loaded(1).is_none() && loaded(2).is_some());
        assert_eq!(mesh.named(seconds(1)), None);
        assert_eq!(mesh.positions(seconds(1)), []);
        assert_eq!(mesh.positions(seconds(2)), [DVec3::ZERO, DVec3::NEG_X, DVec3::NEG_Y]);
        let zero = TransformTracks { scale: DVec3::ZERO.into(), ..TransformTracks::default() };
        let flat = self::mesh(Vec::new(), 0.0.into(), Some(zero));
        assert_eq!(flat.loaded(seconds(0)).expect("in range"), None);
        let far = self::mesh(vec![DVec3::X; 3], 1e31.into(), None);
        assert!(far.loaded(seconds(0)).expect_err("too far").to_string().contains("at most 1e30"));
    }

    #[test]
    fn boxes_over_time_follow_joints_and_curves() {
        let rotation = Rotation::AxisAngle {
            axis: DVec3::Z.into(),
            angle: Animated::Keyed(keyed([(0, Angle(0.0)), (1, Angle(180.0))])),
        };
        let turned =
            mesh(Vec::new(), 0.0.into(), Some(TransformTracks { rotation, ..TransformTracks::default() }));
        let bounds = turned.key_bounds();
        assert!((bounds.min - DVec3::new(-1.0, -1.0, 0.0)).length() < 1e-15, "{bounds:?}");
        assert!((bounds.max - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-15, "{bounds:?}");
        // From 0 to 0 with tangents that lead up to 2 midway: (1 - 1/2) 8 · 1/4 + ... = 2.
        let curve = keyed([(0, 0.0), (1, 0.0)]).with_curves(vec![[8.0, -8.0]]);
        let bent = mesh(vec![DVec3::Z; 3], Animated::Keyed(curve), None);
        assert_eq!(bent.key_bounds().max.z, 2.0);
    }
}
