//! Deformed meshes over time.

use super::carrier::Carrier;
use super::mesh::deform::Deformer;
use super::mesh::{MeshError, Normals, TriangleMesh};
use super::shape::{Mesh, MeshStep};
use crate::base::digest::Digest;
use crate::base::math::{Aabb, DAffine3};
use crate::base::time::Time;
use crate::track::Animated;
use std::sync::{Arc, Mutex, PoisonError};

/// Deformed meshes that are kept: an open shutter may return to the one before.
const KEPT: usize = 2;

/// A mesh that morph targets and joints deform.
#[derive(Debug)]
pub struct DeformedMesh {
    rest: Arc<TriangleMesh>,
    normals: Normals,
    deformer: Arc<Deformer>,
    /// One for each morph target.
    weights: Vec<Animated<f64>>,
    /// The joints, each with the map from the mesh at rest to it.
    joints: Vec<(Carrier, DAffine3)>,
    kept: Mutex<Kept>,
}

/// The last poses by their digests.
#[derive(Debug, Default)]
struct Kept {
    bounds: Vec<(Digest, Aabb)>,
    meshes: Vec<(Digest, Arc<TriangleMesh>)>,
}

/// Compared by address, as meshes are.
impl PartialEq for DeformedMesh {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

/// What deforms a mesh at a time.
struct MeshPose {
    weights: Vec<f64>,
    joints: Vec<DAffine3>,
    digest: Digest,
}

impl DeformedMesh {
    /// `rest` is the mesh at rest.
    pub fn new(
        (rest, normals): (Arc<TriangleMesh>, Normals),
        deformer: Arc<Deformer>,
        weights: Vec<Animated<f64>>,
        joints: Vec<(Carrier, DAffine3)>,
    ) -> Self {
        Self { rest, normals, deformer, weights, joints, kept: Mutex::default() }
    }

    /// The joints.
    pub fn joints(&self) -> &[(Carrier, DAffine3)] {
        &self.joints
    }

    /// The same mesh with other joints.
    pub fn with_joints(&self, joints: Vec<(Carrier, DAffine3)>) -> Self {
        let (rest, deformer) = (Arc::clone(&self.rest), Arc::clone(&self.deformer));
        Self::new((rest, self.normals), deformer, self.weights.clone(), joints)
    }

    /// Whether the mesh may change over time.
    pub fn is_keyed(&self) -> bool {
        let joint_moves = self.joints.iter().any(|(carrier, _)| carrier.is_keyed());
        joint_moves || self.weights.iter().any(Animated::is_keyed)
    }

    fn pose(&self, time: Time) -> MeshPose {
        let weights: Vec<f64> = self.weights.iter().map(|weight| weight.at(time)).collect();
        let joints: Vec<DAffine3> =
            self.joints.iter().map(|(carrier, rest)| carrier.at(time) * *rest).collect();
        let digest = Digest::of(&(self.deformer.digest(), &weights, &joints));
        MeshPose { weights, joints, digest }
    }

    fn bounds(&self, pose: &MeshPose) -> Aabb {
        let known =
            self.kept().bounds.iter().find(|(digest, _)| *digest == pose.digest).map(|(_, bounds)| *bounds);
        known.unwrap_or_else(|| {
            let bounds = self.deformer.bounds(&pose.weights, &pose.joints);
            keep(&mut self.kept().bounds, (pose.digest, bounds));
            bounds
        })
    }

    /// A box around the mesh at the start and at the keys of its morph targets.
    pub fn key_bounds(&self) -> Aabb {
        let tracks = self.weights.iter().filter_map(|weight| match weight {
            Animated::Keyed(track) => Some(track.keys().iter().map(|key| key.time)),
            Animated::Constant(_) => None,
        });
        let times = tracks.flatten().chain([Time::from_integer(0)]);
        times.fold(Aabb::EMPTY, |all, time| all.union(self.bounds(&self.pose(time))))
    }

    fn kept(&self) -> std::sync::MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn shape(&self, pose: &MeshPose, mesh: Arc<TriangleMesh>) -> Mesh {
        let step = MeshStep { digest: pose.digest, bounds: self.bounds(pose) };
        Mesh { mesh, normals: self.normals, step: Some(step) }
    }

    /// The shape at a time without its mesh: that at rest takes its place.
    pub fn named(&self, time: Time) -> Mesh {
        self.shape(&self.pose(time), Arc::clone(&self.rest))
    }

    /// The shape at a time.
    ///
    /// # Errors
    /// If no triangle has an area, or a position is not finite.
    pub fn loaded(&self, time: Time) -> Result<Mesh, MeshError> {
        let pose = self.pose(time);
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
                let mesh = Arc::new(TriangleMesh::new(data)?);
                keep(&mut self.kept().meshes, (pose.digest, Arc::clone(&mesh)));
                mesh
            }
        };
        Ok(self.shape(&pose, mesh))
    }
}

/// Keeps an entry instead of the oldest one.
fn keep<T>(entries: &mut Vec<T>, entry: T) {
    if entries.len() == KEPT {
        entries.remove(0);
    }
    entries.push(entry);
}
