//! What is done with the data of a mesh before its tree is built: axes, origin, unit, and crease normals.

use super::{MeshData, crease};
use crate::base::math::{Aabb, Angle, DVec3, UpAxis};

/// Changes of coordinates and normals, in the order of the fields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preparation {
    /// The upward axes of the mesh and of the object that shows it.
    pub up: (UpAxis, UpAxis),
    /// The point that moves to the origin.
    pub center: Center,
    /// Then all coordinates are multiplied by this, above 0.
    pub scale: f64,
    /// The angle between triangles up to which normals are smooth. None leaves the mesh's own normals.
    pub crease: Option<Angle>,
}

/// A point of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Center {
    /// The origin of the file: nothing moves.
    #[default]
    Origin,
    /// The middle of the box around all triangles.
    Bounds,
    /// The middle of the bottom of that box, so that the mesh stands on the ground.
    Base,
}

/// Equal for equal preparations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PreparationKey {
    up: (UpAxis, UpAxis),
    center: Center,
    scale: u64,
    crease: Option<u64>,
}

impl Default for Preparation {
    fn default() -> Self {
        Self { up: Default::default(), center: Center::Origin, scale: 1.0, crease: None }
    }
}

impl Preparation {
    /// The preparation as a key of maps.
    pub fn key(&self) -> PreparationKey {
        let &Self { up, center, scale, crease } = self;
        PreparationKey { up, center, scale: scale.to_bits(), crease: crease.map(|angle| angle.0.to_bits()) }
    }

    /// Prepares a mesh.
    pub fn apply(&self, data: &mut MeshData) {
        self.place(data, None);
        self.crease(data);
    }

    /// Changes the coordinates. A coordinate x becomes (x - c) · scale, with one rounding for the difference and one
    /// for the product; changes of axes are exact. Returns c, which is `center` if given.
    pub fn place(&self, data: &mut MeshData, center: Option<DVec3>) -> Option<DVec3> {
        let (from, to) = self.up;
        if from != to {
            let turned = |v: DVec3| to.from_y_up(from.to_y_up(v));
            data.positions.iter_mut().for_each(|position| *position = turned(*position));
            if let Some(normals) = &mut data.normals {
                normals.change(|normal| turned(normal.as_dvec3()).as_vec3());
            }
        }
        let center = center.or_else(|| self.center_of(data));
        if let Some(center) = center {
            data.positions.iter_mut().for_each(|position| *position -= center);
        }
        if self.scale != 1.0 {
            data.positions.iter_mut().for_each(|position| *position *= self.scale);
        }
        center
    }

    /// Computes crease normals.
    pub fn crease(&self, data: &mut MeshData) {
        if let Some(angle) = self.crease {
            data.normals = Some(crease::normals(&data.positions, &data.triangles, angle));
        }
    }

    /// The point that moves to the origin, if it is another.
    fn center_of(&self, data: &MeshData) -> Option<DVec3> {
        if self.center == Center::Origin {
            return None;
        }
        // Faulty indices are reported when the mesh is built.
        let used =
            data.triangles.as_flattened().iter().filter_map(|&vertex| data.positions.get(vertex as usize));
        let bounds = Aabb::around(used.copied());
        if bounds.is_empty() {
            return None;
        }
        let (middle, up) = (bounds.center(), self.up.1.unit());
        Some(match self.center {
            // The upward axis is a coordinate axis, so the product selects one coordinate.
            Center::Base => middle * (DVec3::ONE - up) + bounds.min * up,
            _ => middle,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::generate;

    fn bounds(data: &MeshData) -> Aabb {
        Aabb::around(data.positions.iter().copied())
    }

    /// A part in millimetres, far from the origin, with z up.
    fn part() -> MeshData {
        let mut data = generate::icosphere(2);
        let far = DVec3::new(1e5, 1e5, 0.0);
        data.positions
            .iter_mut()
            .for_each(|p| *p = (*p * DVec3::new(20.0, 10.0, 5.0) + far).as_vec3().as_dvec3());
        // A vertex that no triangle uses does not count.
        data.positions.push(DVec3::splat(1e9));
        data
    }

    #[test]
    fn a_part_far_away_comes_to_the_origin() {
        let mut data = part();
        let preparation =
            Preparation { up: (UpAxis::Z, UpAxis::Y), center: Center::Base, scale: 0.001, crease: None };
        preparation.apply(&mut data);
        data.positions.pop();
        let bounds = bounds(&data);
        assert_eq!(bounds.min.y, 0.0);
        // Two roundings of f64, of f32 coordinates.
        let middle = bounds.center() * DVec3::new(1.0, 0.0, 1.0);
        assert!(middle.length() <= 4.0 * f64::EPSILON * 0.02, "{middle}");
        assert!(
            (bounds.max - bounds.min - DVec3::new(0.04, 0.01, 0.02)).abs().max_element() < 1e-3,
            "{bounds:?}"
        );
    }

    #[test]
    fn nothing_changes_by_default() {
        let mut data = part();
        Preparation::default().apply(&mut data);
        assert_eq!(data, part());
    }

    #[test]
    fn the_middle_of_the_bounds() {
        let mut data = part();
        Preparation { center: Center::Bounds, ..Preparation::default() }.apply(&mut data);
        data.positions.pop();
        let bounds = bounds(&data);
        assert_eq!(bounds.min, -bounds.max);
    }
}
