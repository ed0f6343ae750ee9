//! What only the whole file shows: whether every moment of every frame has a camera.

use super::Named;
use super::fault::Fault;
use super::node::File;
use super::suggest::shortened;
use crate::camera_path::{CameraPath, Lens, NoCamera, moments};
use crate::time::{Clock, Timeline};
use crate::track::Animated;
use std::ops::Range;

/// Reports each camera that shows nothing at a frame at which it is looked through, with the first such frame.
/// While a shutter is open, `steps` moments of a frame are looked at.
pub fn report_blind_cameras(
    file: &File<'_>,
    timeline: &Timeline,
    steps: u32,
    cameras: &[Named<CameraPath>],
    active: &Animated<usize>,
    places: &[Range<usize>],
) {
    let mut done = vec![false; cameras.len()];
    for frame in 0..timeline.frames {
        let index = active.at(timeline.clock(frame).start);
        let (Some(camera), Some(false)) = (cameras.get(index), done.get(index)) else {
            if done.iter().all(|done| *done) {
                return;
            }
            continue;
        };
        // One moment of what stands still is like every other.
        let (still, shutter) = (stands_still(&camera.value), &camera.value.shutter);
        let clocks =
            if still { vec![timeline.clock(frame)] } else { moments(shutter, steps, timeline, frame) };
        let blind = |clock: &Clock| camera.value.at(clock, None).err().map(|why| (clock.time, why));
        done[index] = still;
        if let Some((time, why)) = clocks.iter().find_map(blind) {
            done[index] = true;
            let open = if time == timeline.clock(frame).start { "" } else { ", while the shutter is open" };
            let place = places.get(index).cloned().unwrap_or(0..0);
            file.push(fault(&camera.name, why, &format!("at frame {frame}{open}"), place));
        }
    }
}

fn fault(name: &str, why: NoCamera, when: &str, place: Range<usize>) -> Fault {
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
    let title = format!("camera `{}` {title} {when}", shortened(name));
    Fault::new(place, title, format!("{label} {when}")).help(help)
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
