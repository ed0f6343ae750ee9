//! Views: what differs between cameras at one point.

use super::raster::Raster;
use crate::base::digest::Content;
use crate::base::math::{Basis, DVec3};
use crate::camera::{Camera, Projection};

/// The directions and the field of view of a pinhole camera, wherever it is.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct View {
    basis: Basis,
    /// Half the picture's height at distance 1.
    half_height: f64,
}

impl View {
    /// The view of a camera. None if it has a lens or rays that are parallel: then light depends on more than the
    /// direction of a ray.
    pub fn of(camera: &Camera) -> Option<Self> {
        match camera {
            Camera { basis, projection: Projection::Perspective { half_height }, lens: None, .. } => {
                Some(Self { basis: *basis, half_height: *half_height })
            }
            _ => None,
        }
    }

    /// A camera with this view.
    pub fn camera(&self, position: DVec3) -> Camera {
        let projection = Projection::Perspective { half_height: self.half_height };
        Camera { position, basis: self.basis, projection, lens: None }
    }

    /// How many times as many samples per steradian this view has as one whose pixels are 1 / `half_height` as large, in
    /// the middle of its picture.
    pub fn density(&self) -> f64 {
        1.0 / (self.half_height * self.half_height)
    }
}

/// Orders views by the size of their pixels, finest first. Equal views stay once.
pub fn finest_first(views: impl IntoIterator<Item = View>) -> Vec<View> {
    let mut different: Vec<View> = Vec::new();
    for view in views {
        if !different.contains(&view) {
            different.push(view);
        }
    }
    different.sort_by(|a, b| a.half_height.total_cmp(&b.half_height));
    different
}

/// Maps positions in the picture of one view to the picture of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewMap {
    /// Coefficients of (across, down, 1): of the position times the depth, and of the depth.
    pub across: [f64; 3],
    pub down: [f64; 3],
    pub depth: [f64; 3],
    /// The density of the other view, in the middle of its picture.
    density: f64,
}

/// A position in a picture, in pixels from its left and its top. The depth is that of the point at depth 1 of the view
/// that it was mapped from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MappedPosition {
    pub across: f64,
    pub down: f64,
    pub depth: f64,
}

impl ViewMap {
    pub fn between(from: &View, to: &View, raster: &Raster) -> Self {
        let density = to.density();
        if from == to {
            let unit = |axis: usize| std::array::from_fn(|place| f64::from(u8::from(place == axis)));
            return Self { across: unit(0), down: unit(1), depth: unit(2), density };
        }
        let [width, height] = raster.size();
        // The direction of a position is the sum of its coordinates times these vectors, and the last one.
        let step = 2.0 * from.half_height / height;
        let (right, below) = (from.basis.right * step, from.basis.up * -step);
        let corner = from.basis.forward - (right * width + below * height) / 2.0;
        let along = |axis: DVec3| [right.dot(axis), below.dot(axis), corner.dot(axis)];
        // Pictures along one line of sight have the same depths, without rounding errors.
        let is_parallel = from.basis.forward == to.basis.forward;
        let depth = if is_parallel { [0.0, 0.0, 1.0] } else { along(to.basis.forward) };
        let scale = height / (2.0 * to.half_height);
        let placed = |axis: DVec3, side: f64| {
            let along = along(axis);
            std::array::from_fn(|place| scale * along[place] + side / 2.0 * depth[place])
        };
        Self { across: placed(to.basis.right, width), down: placed(-to.basis.up, height), depth, density }
    }

    /// Maps a position. Its depth may be 0 or less: then the view does not have it.
    pub fn position(&self, [across, down]: [f64; 2]) -> MappedPosition {
        let row = |row: &[f64; 3]| row[0] * across + row[1] * down + row[2];
        let depth = row(&self.depth);
        MappedPosition { across: row(&self.across) / depth, down: row(&self.down) / depth, depth }
    }

    /// The samples per steradian of the other view at a depth, in the units of [`View::density`] where the view that is
    /// mapped from has depth 1.
    ///
    /// A pixel at the angle θ to the line of sight covers cos³ θ of the solid angle of one in the middle. The depth is
    /// the cosine, times a length that is the same for all views.
    pub fn density_at(&self, depth: f64) -> f64 {
        self.density / (depth * depth * depth)
    }
}
