//! Checks across the whole file: every moment of every frame needs a valid camera.

use super::Named;
use super::fault::Fault;
use super::source_file::File;
use super::suggest::shortened;
use crate::base::time::{Clock, Time, Timeline};
use crate::camera::CameraCuts;
use crate::camera::path::{CameraPath, NoCamera, moments};
use rayon::prelude::*;
use std::collections::HashSet;
use std::ops::Range;

/// Maximum number of checked moments: a few seconds of one processor.
const MAX_MOMENTS: u64 = 1 << 24;

/// Frames checked in parallel before finished cameras are skipped.
const BLOCK: u32 = 1 << 13;

/// The cameras to check.
pub struct CheckedCameras<'a> {
    pub list: &'a [Named<CameraPath>],
    pub active: &'a CameraCuts,
    /// Place of each camera in the file.
    pub places: &'a [Range<usize>],
}

/// Reports each camera that has no valid view at a frame that uses it, with the first such frame. Checks `steps`
/// moments per frame while a shutter is open. `place` is where the file gives the number of frames.
pub fn report_blind_cameras(
    file: &File<'_>,
    timeline: &Timeline,
    steps: u32,
    cameras: &CheckedCameras<'_>,
    place: Range<usize>,
) {
    if let Some(fault) = too_many_moments(timeline, steps, cameras, place) {
        file.push(fault);
        return;
    }
    let looked_through: HashSet<usize> = cameras.active.active.values().copied().collect();
    let mut left = looked_through.len();
    let mut done = vec![false; cameras.list.len()];
    for first in (0..timeline.frames).step_by(BLOCK as usize) {
        let block = first..timeline.frames.min(first.saturating_add(BLOCK));
        let check_frame = |frame| check_frame(frame, timeline, steps, cameras, &done);
        let found: Vec<Finding> = block.into_par_iter().flat_map_iter(check_frame).collect();
        for Finding { frame, camera, blind } in found {
            if std::mem::replace(&mut done[camera], true) {
                continue;
            }
            left -= 1;
            if let Some((time, why)) = blind {
                let open =
                    if time == timeline.clock(frame).start { "" } else { ", while the shutter is open" };
                let place = cameras.places.get(camera).cloned().unwrap_or(0..0);
                file.push(fault(&cameras.list[camera].name, why, &format!("at frame {frame}{open}"), place));
            }
        }
        if left == 0 {
            return;
        }
    }
}

/// Result of a check of one frame.
struct Finding {
    frame: u32,
    camera: usize,
    /// The moment without a valid view, and the reason. None if the camera needs no more checks.
    blind: Option<(Time, NoCamera)>,
}

/// Checks a frame's cameras unless they are done. Returns a finding for each camera that needs no more checks.
fn check_frame<'a>(
    frame: u32,
    timeline: &'a Timeline,
    steps: u32,
    cameras: &'a CheckedCameras<'_>,
    done: &'a [bool],
) -> impl Iterator<Item = Finding> + 'a {
    let shown = cameras.active.cameras(timeline.clock(frame).start);
    shown.filter_map(move |index| check_camera(index, frame, timeline, steps, cameras, done))
}

fn check_camera(
    index: usize,
    frame: u32,
    timeline: &Timeline,
    steps: u32,
    cameras: &CheckedCameras<'_>,
    done: &[bool],
) -> Option<Finding> {
    let camera = &cameras.list.get(index).filter(|_| !done[index])?.value;
    // All moments of a static camera are equal.
    let still = camera.is_still();
    let clocks =
        if still { vec![timeline.clock(frame)] } else { moments(&camera.shutter, steps, timeline, frame) };
    let blind = |clock: &Clock| camera.at(clock, None).err().map(|why| (clock.time, why));
    let blind = clocks.iter().find_map(blind);
    (still || blind.is_some()).then_some(Finding { frame, camera: index, blind })
}

/// Refuses timelines that would take too long to check.
fn too_many_moments(
    timeline: &Timeline,
    steps: u32,
    cameras: &CheckedCameras<'_>,
    place: Range<usize>,
) -> Option<Fault> {
    let opens = |camera: &Named<CameraPath>| {
        !camera.value.is_still() && camera.value.shutter.values().any(|open| *open > 0.0)
    };
    let moments = u64::from(timeline.frames) * u64::from(steps);
    if moments <= MAX_MOMENTS || !cameras.list.iter().any(opens) {
        return None;
    }
    let frames = timeline.frames;
    let title = format!("{frames} frames with {steps} moments each, while shutters are open, are too many");
    let fault = Fault::new(place, title, format!("the limit is {MAX_MOMENTS} moments in total"));
    Some(match MAX_MOMENTS / u64::from(frames) {
        0 | 1 => fault.help("write fewer frames, or a `shutter` of 0"),
        most => fault.help(format!("write `shutter_steps: {most}` or less in `quality`, or fewer frames")),
    })
}

fn fault(name: &str, why: NoCamera, when: &str, place: Range<usize>) -> Fault {
    let (title, label, help) = match why {
        NoCamera::EyeOnTarget => (
            "is at its own target",
            "position and target are equal",
            "move `position` or `target`, so that they differ at every frame",
        ),
        NoCamera::Lens => (
            "shows no picture",
            "its field of view leaves 0 to 180 degrees, or its picture has no height",
            "easings such as Back and Elastic go beyond their keys",
        ),
        NoCamera::NotFinite => ("is at infinity", "has no place", "check the sizes along its path"),
    };
    let title = format!("camera `{}` {title} {when}", shortened(name));
    Fault::new(place, title, format!("{label} {when}")).help(help)
}
