//! Cameras, in world space.

use super::keys::Keys;
use super::nodes::{Placed, quaternion};
use super::{ExportError, Exporter};
use crate::base::math::{DMat3, DQuat, DVec3};
use crate::base::time::Time;
use crate::camera::{Camera, Projection};
use crate::track::Animated;
use serde_json::{Map, Value, json};

/// Clipping planes in units of the scene's extent. Kinora clips nothing.
const NEAR: f64 = 1e-4;
const FAR: f64 = 1e2;

impl Exporter<'_> {
    /// Adds a node for each camera, with its pose at every frame.
    ///
    /// # Errors
    /// If a camera is wrong in any frame.
    pub fn cameras(&mut self) -> Result<(), ExportError> {
        for index in 0..self.sequence.cameras.len() {
            let all = self.moments(index)?;
            self.note_lens(index);
            let timeline = &self.sequence.timeline;
            let at = |time: Time| &all[timeline.frame_at(time) as usize];
            let place = |camera: &Camera| camera.position;
            let turn = |camera: &Camera| quaternion(&axes(camera));
            let Some(first) = all.first() else { continue };
            let placed = Placed {
                translation: place(first),
                rotation: turn(first),
                scale: DVec3::ONE,
                keys: [
                    Keys::sampled(timeline, false, false, |time| place(at(time)).to_array().to_vec()),
                    Keys::sampled(timeline, false, true, |time| DQuat::to_array(&turn(at(time))).to_vec()),
                    None,
                ],
            };
            let size = |camera: &Camera| match camera.projection {
                Projection::Perspective { half_height } => 2.0 * libm::atan(half_height),
                Projection::Orthographic { half_height } => half_height,
            };
            let sizes = Keys::sampled(timeline, false, false, |time| vec![size(at(time))]);
            let camera = self.camera(first, size(first));
            if let Some(sizes) = sizes {
                self.animate_size(first, camera, sizes);
            }
            let name = self.sequence.cameras[index].name.clone();
            self.node(&name, &placed, Map::from_iter([("camera".into(), json!(camera))]), None);
        }
        Ok(())
    }

    /// A camera in every frame, and at the end of the last one if it is right there.
    fn moments(&self, index: usize) -> Result<Vec<Camera>, ExportError> {
        let (path, timeline) = (self.sequence.fitted_camera(index), &self.sequence.timeline);
        let at = |frame: u32| {
            path.at(&timeline.clock(frame), None).map_err(|why| ExportError::Camera {
                name: self.sequence.cameras[index].name.clone(),
                frame,
                why: why.to_string(),
            })
        };
        let mut all = (0..timeline.frames).map(at).collect::<Result<Vec<_>, _>>()?;
        all.extend(at(timeline.frames).ok().or(all.last().copied()));
        Ok(all)
    }

    /// Adds a camera without a place. `size` is its field of view in radians or half its height.
    fn camera(&mut self, camera: &Camera, size: f64) -> usize {
        let extent = self.extent();
        let (near, far) = (extent * NEAR, extent * FAR);
        let given: Value = match camera.projection {
            Projection::Perspective { .. } => json!({ "type": "perspective",
                "perspective": { "yfov": size, "aspectRatio": self.aspect(), "znear": near, "zfar": far } }),
            Projection::Orthographic { .. } => json!({ "type": "orthographic",
                "orthographic": { "xmag": size * self.aspect(), "ymag": size, "znear": near, "zfar": far } }),
        };
        self.document.push("cameras", given)
    }

    /// Animates the field of view, or the height and the width.
    fn animate_size(&mut self, camera: &Camera, index: usize, sizes: Keys) {
        let aspect = self.aspect();
        let properties = match camera.projection {
            Projection::Perspective { .. } => vec![("perspective/yfov", sizes)],
            Projection::Orthographic { .. } => {
                let widths = sizes.clone().scaled(aspect, &[0.0]);
                vec![("orthographic/ymag", sizes), ("orthographic/xmag", widths)]
            }
        };
        for (property, keys) in properties {
            let sampler = keys.sampler(&mut self.document);
            self.document.animate_pointer(&format!("/cameras/{index}/{property}"), sampler);
        }
    }

    /// Width of the picture over its height.
    fn aspect(&self) -> f64 {
        let (width, height) = self.sequence.output.size;
        f64::from(width) / f64::from(height)
    }

    fn note_lens(&mut self, index: usize) {
        let camera = &self.sequence.cameras[index].value;
        if camera.aperture != Animated::Constant(0.0) {
            self.left_out.note_of("the depth of field", "camera");
        }
        if camera.shutter != Animated::Constant(0.0) {
            self.left_out.note_of("the motion blur", "camera");
        }
    }
}

/// The axes of a camera: it looks along -z, with y up.
fn axes(camera: &Camera) -> DMat3 {
    let basis = camera.basis;
    DMat3::from_cols(basis.right, basis.up, -basis.forward)
}
