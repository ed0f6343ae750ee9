//! Cameras of a scene.

use crate::base::math::Angle;
use crate::camera::path::{CameraPath, Lens};
use crate::import::gltf::GltfCamera;
use crate::sequence::camera::default_camera;

/// A camera without a place.
pub fn camera(given: GltfCamera) -> CameraPath {
    let lens = match given {
        GltfCamera::Perspective { fov } => Lens::Perspective { fov: Angle(fov.to_degrees()).into() },
        GltfCamera::Orthographic { height } => Lens::Orthographic { height: height.into() },
    };
    CameraPath { lens, ..default_camera() }
}
