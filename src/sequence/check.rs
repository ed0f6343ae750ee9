//! What only the whole file shows: whether every frame has a camera.

use super::Named;
use super::fault::Fault;
use super::node::File;
use super::suggest::shortened;
use crate::camera_path::{CameraPath, Lens, NoCamera};
use crate::time::Timeline;
use crate::track::Animated;
use std::ops::Range;

/// Reports each camera that shows nothing at a frame at which it is looked through, with the first such frame.
pub fn report_blind_cameras(
    file: &File<'_>,
    timeline: &Timeline,
    cameras: &[Named<CameraPath>],
    active: &Animated<usize>,
    places: &[Range<usize>],
) {
    let mut done = vec![false; cameras.len()];
    for frame in 0..timeline.frames {
        let clock = timeline.clock(frame);
        let index = active.at(clock.time);
        let (Some(camera), Some(false)) = (cameras.get(index), done.get(index)) else {
            if done.iter().all(|done| *done) {
                return;
            }
            continue;
        };
        match camera.value.at(&clock, None) {
            Err(why) => {
                done[index] = true;
                let place = places.get(index).cloned().unwrap_or(0..0);
                file.push(fault(&camera.name, why, frame, place));
            }
            Ok(_) => done[index] = stands_still(&camera.value),
        }
    }
}

fn fault(name: &str, why: NoCamera, frame: u32, place: Range<usize>) -> Fault {
    let (title, label, help) = match why {
        NoCamera::EyeOnTarget => (
            "stands on its own target",
            "position and target are equal",
            "move `position` or `target`, so that they differ at every frame",
        ),
        NoCamera::Lens => (
            "shows no picture",
            "its field of view leaves 0 to 180 degrees, or its picture has no height",
            "easings such as Back and Elastic go beyond their keys",
        ),
        NoCamera::NotFinite => ("is infinitely far away", "has no place", "check the sizes along its path"),
    };
    let title = format!("camera `{}` {title} at frame {frame}", shortened(name));
    Fault::new(place, title, format!("{label} at frame {frame}")).help(help)
}

/// Whether one frame of the camera is like every other.
fn stands_still(camera: &CameraPath) -> bool {
    let CameraPath { position, target, up, roll, lens, path, .. } = camera;
    let lens = match lens {
        Lens::Perspective { fov } => fov.is_keyed(),
        Lens::Orthographic { height } => height.is_keyed(),
    };
    let keyed = position.is_keyed() || target.is_keyed() || up.is_keyed() || roll.is_keyed() || lens;
    !keyed && path.is_empty()
}
