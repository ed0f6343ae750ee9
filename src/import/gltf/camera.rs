//! Cameras.

use super::GltfResult;
use super::json::Item;

/// A camera, which looks along the -z axis of its node, with y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GltfCamera {
    /// Vertical field of view in radians, above 0 and below π.
    Perspective { fov: f64 },
    /// Height of the picture in the units of the scene, above 0.
    Orthographic { height: f64 },
}

/// Reads all cameras.
pub fn cameras(root: &Item<'_>) -> GltfResult<Vec<GltfCamera>> {
    root.list("cameras")?.iter().map(camera).collect()
}

fn camera(item: &Item<'_>) -> GltfResult<GltfCamera> {
    match item.text("type")? {
        Some("perspective") => {
            let item = item.required("perspective")?;
            let fov = item.number("yfov", 0.0)?;
            // The tangent of half the angle must be a number above 0.
            if !(1e-8..std::f64::consts::PI).contains(&fov) {
                return Err(item.error("its `yfov` is not above 0 and below half a turn, in radians"));
            }
            Ok(GltfCamera::Perspective { fov })
        }
        Some("orthographic") => {
            let item = item.required("orthographic")?;
            // Negative magnifications mirror, which the specification discourages.
            let height = 2.0 * item.number("ymag", 0.0)?.abs();
            if height < 1e-30 {
                return Err(item.error("its `ymag` is 0"));
            }
            Ok(GltfCamera::Orthographic { height })
        }
        _ => Err(item.error("its `type` is neither perspective nor orthographic")),
    }
}
