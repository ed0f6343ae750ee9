//! A frame as annotations see it.

use crate::base::math::{Aabb, DAffine3, DVec2, DVec3};
use crate::base::time::Time;
use crate::camera::{Camera, ProjectedPoint};
use crate::drawing::shares_inside;
use crate::encode::FrameInfo;

/// How far lines reach beyond the picture before they are cut off, in heights of the picture. Their ends stay
/// invisible, and coordinates small.
const GUARD: f64 = 2.0;

/// An object at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedObject {
    pub to_world: DAffine3,
    /// The bounds of its shape before its transform; None for groups and for shapes without end.
    pub bounds: Option<Aabb>,
    /// Whether it and all its parents are visible.
    pub visible: bool,
}

/// What annotations need to know about a frame.
pub struct FrameView<'a> {
    pub camera: Camera,
    /// Width and height of the picture in pixels.
    pub size: (u32, u32),
    pub time: Time,
    pub info: FrameInfo<'a>,
    /// The directions of x, y and z of the file.
    pub axes: [DVec3; 3],
    /// An object at a time, by its index.
    pub object: &'a dyn Fn(usize, Time) -> PlacedObject,
    /// Whether something is in front of a point, besides the object of an index and all below it.
    pub is_hidden: &'a dyn Fn(DVec3, Option<usize>) -> bool,
}

impl FrameView<'_> {
    /// The height of the picture in pixels.
    pub fn height(&self) -> f64 {
        self.size.1.into()
    }

    pub fn width(&self) -> f64 {
        self.size.0.into()
    }

    /// The place of a point of the world in pixels from the top left corner. None behind the camera.
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        self.camera.project(point).screen().map(|screen| self.pixel(screen))
    }

    /// The pixels of a place in the units of [`Camera::ray`].
    fn pixel(&self, screen: DVec2) -> DVec2 {
        let half = 0.5 * self.height();
        DVec2::new(0.5 * self.width() + screen.x * half, half - screen.y * half)
    }

    /// Whether a place lies within the picture.
    pub fn shows(&self, place: DVec2) -> bool {
        (0.0..=self.width()).contains(&place.x) && (0.0..=self.height()).contains(&place.y)
    }

    /// The pixels of a line through points of the world, without the parts behind the camera and far outside.
    pub fn project_line(&self, points: &[DVec3]) -> Vec<Vec<DVec2>> {
        let mut lines: Vec<Vec<DVec2>> = Vec::new();
        for [from, to] in points.array_windows() {
            let Some((from, to)) = self.clip(self.camera.project(*from), self.camera.project(*to)) else {
                continue;
            };
            let (Some(from), Some(to)) = (from.screen(), to.screen()) else { continue };
            let (from, to) = (self.pixel(from), self.pixel(to));
            match lines.last_mut().filter(|line| line.last() == Some(&from)) {
                Some(line) => line.push(to),
                None => lines.push(vec![from, to]),
            }
        }
        lines
    }

    /// The part of a line near the picture.
    fn clip(&self, from: ProjectedPoint, to: ProjectedPoint) -> Option<(ProjectedPoint, ProjectedPoint)> {
        let (up, across) = (1.0 + GUARD, self.width() / self.height() + GUARD);
        // Above 0 inside. Those of perspective cameras together bound the weight.
        let distances = |point: &ProjectedPoint| {
            let ProjectedPoint { across: DVec2 { x, y }, weight, depth } = *point;
            [across * weight - x, across * weight + x, up * weight - y, up * weight + y, depth]
        };
        let [first, last] = shares_inside(distances(&from).into_iter().zip(distances(&to)))?;
        let at = |share: f64| match share {
            0.0 => from,
            1.0 => to,
            share => from.lerp(&to, share),
        };
        Some((at(first), at(last)))
    }
}
