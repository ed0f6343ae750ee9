//! Axis-aligned boxes.

use super::surface::exit;
use super::{Crossing, Geometric, Parameters, Surface};
use crate::camera::Ray;
use crate::digest::content;
use crate::math::{Aabb, DAffine3, DVec2, DVec3, gamma, next_away};
use crate::tree::Probe;

/// The surface of the axis-aligned box from `min` to `max`, each of whose sides is longer than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    pub min: DVec3,
    pub max: DVec3,
}

content!(struct Cuboid { min, max });

impl Geometric for Cuboid {
    const NAME: &'static str = "Box";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let (min, max) = (parameters.vector("min", None), parameters.vector("max", None));
        let (min, max) = (min?, max?);
        let flat: Vec<_> = ["x", "y", "z"]
            .into_iter()
            .zip((max - min).to_array())
            .filter_map(|(axis, side)| (side <= 0.0).then_some(axis))
            .collect();
        if !flat.is_empty() {
            let label = format!("not above `min` in {}", flat.join(" and "));
            parameters.refuse("max", "`max` must be above `min` along every axis".to_owned(), label);
            return None;
        }
        Some(Self { min, max })
    }

    fn hit_after(&self, probe: &Probe, after: f64, t_max: f64) -> Option<Crossing> {
        let [enter, leave] = self.slabs(&probe.ray)?.map(|(t, _)| t);
        let t = if enter > after { enter } else { exit(enter, leave) };
        (enter <= leave && t > after && t < t_max).then_some(Crossing::at(t))
    }

    fn surface(&self, ray: &Ray, at: Crossing) -> Surface {
        self.surface_apart(ray, at, 0.0)
    }

    /// The face is one that the ray enters by, or else leaves by: on an edge of the box that is never the face beyond
    /// the edge, which the ray may not see. The point is put onto its plane exactly, and stays off all edges, so that a
    /// ray that goes in there is between all faces, and leaves the box once.
    fn surface_apart(&self, ray: &Ray, at: Crossing, apart: f64) -> Surface {
        let entering = |&[(enter, _), _]: &[(f64, usize); 2]| enter == at.t;
        let crossings = self.slabs(ray);
        let (enters, axis) = match crossings {
            Some(crossings) if entering(&crossings) => (true, crossings[0].1),
            Some([_, (_, axis)]) => (false, axis),
            None => (true, 0),
        };
        let above = (ray.direction[axis] > 0.0) != enters;
        let (min, max) = self.clear_of_edges(apart);
        let mut point = ray.at(at.t).max(min).min(max);
        point[axis] = if above { self.max[axis] } else { self.min[axis] };
        let mut normal = DVec3::ZERO;
        normal[axis] = if above { 1.0 } else { -1.0 };
        Surface::new(point, point.abs() * gamma(1), normal)
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(Aabb { min: self.min, max: self.max })
    }

    /// A box stays one when moved and scaled along its axes.
    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let m = affine.matrix3;
        let scale = DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z);
        let (a, b) = (affine.transform_point3(self.min), affine.transform_point3(self.max));
        (m == glam::DMat3::from_diagonal(scale)).then(|| Self { min: a.min(b), max: a.max(b) })
    }

    /// 0..=1 over each face, upright when seen from outside with +y up; the top and the bottom as seen with
    /// -z and +z up.
    fn uv(&self, point: DVec3, _: u32) -> DVec2 {
        let share = (point - self.min) / (self.max - self.min);
        let off = (share - DVec3::splat(0.5)).abs();
        if off.x >= off.y && off.x >= off.z {
            DVec2::new(if share.x > 0.5 { 1.0 - share.z } else { share.z }, share.y)
        } else if off.y >= off.z {
            DVec2::new(share.x, if share.y > 0.5 { 1.0 - share.z } else { share.z })
        } else {
            DVec2::new(if share.z > 0.5 { share.x } else { 1.0 - share.x }, share.y)
        }
    }

    fn area(&self) -> Option<f64> {
        Some(2.0 * self.faces().element_sum())
    }

    /// A pair of faces by its area, then one of the two.
    fn sample_area(&self, u: DVec2) -> Option<(Surface, u32)> {
        let faces = self.faces();
        let mut rest = u.x * faces.element_sum();
        let axis = if rest < faces.x {
            0
        } else if rest < faces.x + faces.y {
            rest -= faces.x;
            1
        } else {
            rest -= faces.x + faces.y;
            2
        };
        let across = (2.0 * rest / faces[axis]).clamp(0.0, 2.0);
        let mut share = DVec3::splat(u.y);
        share[(axis + 1) % 3] = across.fract();
        share[axis] = if across < 1.0 { 0.0 } else { 1.0 };
        let mut normal = DVec3::ZERO;
        normal[axis] = 2.0 * share[axis] - 1.0;
        let point = (self.min + (self.max - self.min) * share).clamp(self.min, self.max);
        Some((Surface::new(point, point.abs() * gamma(1), normal), 0))
    }
}

impl Cuboid {
    /// Where a line enters and leaves the box, with the axes across which it does; the first after the second if it
    /// passes by. Slabs: it is inside from the last entry to the first exit. Every side of the box is a difference of
    /// two coordinates, so its sign, and with it what lies ahead, is exact.
    fn slabs(&self, ray: &Ray) -> Option<[(f64, usize); 2]> {
        let (o, d) = (ray.origin, ray.direction);
        let (mut enter, mut leave) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
        for axis in 0..3 {
            if d[axis] == 0.0 {
                if o[axis] < self.min[axis] || o[axis] > self.max[axis] {
                    return None;
                }
                continue;
            }
            let a = (self.min[axis] - o[axis]) / d[axis];
            let b = (self.max[axis] - o[axis]) / d[axis];
            let (near, far) = if a < b { (a, b) } else { (b, a) };
            enter = if near > enter.0 { (near, axis) } else { enter };
            leave = if far < leave.0 { (far, axis) } else { leave };
        }
        Some([enter, leave])
    }

    /// Between which corners points are that far, and at least one number, off all edges; the middle twice if
    /// there are none.
    fn clear_of_edges(&self, apart: f64) -> (DVec3, DVec3) {
        let min = (self.min + apart).map(|v| next_away(v, 1.0));
        let max = (self.max - apart).map(|v| next_away(v, -1.0));
        let middle = self.min * 0.5 + self.max * 0.5;
        (min.min(middle), max.max(middle))
    }

    /// The areas of one face across each axis.
    fn faces(&self) -> DVec3 {
        let side = self.max - self.min;
        DVec3::new(side.y * side.z, side.z * side.x, side.x * side.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Cuboid = Cuboid { min: DVec3::ZERO, max: DVec3::ONE };

    fn hit(origin: DVec3, direction: DVec3) -> Option<f64> {
        UNIT.hit(&Probe::new(Ray { origin, direction }), f64::INFINITY).map(|crossing| crossing.t)
    }

    #[test]
    fn bvh_01_rays_in_its_faces_enter() {
        for x in [0.0, 0.5, 1.0] {
            for y in [0.0, 0.5, 1.0] {
                for (dx, dy) in [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)] {
                    assert_eq!(hit(DVec3::new(x, y, -1.0), DVec3::new(dx, dy, 1.0)), Some(1.0));
                }
            }
        }
    }

    #[test]
    fn from_inside_and_past() {
        assert_eq!(hit(DVec3::splat(0.5), DVec3::X), Some(0.5));
        assert_eq!(hit(DVec3::new(2.0, 0.5, 0.5), DVec3::X), None);
        assert_eq!(hit(DVec3::new(2.0, 0.5, 0.5), DVec3::NEG_X), Some(1.0));
        assert_eq!(hit(DVec3::new(2.0, 2.0, 0.5), DVec3::new(-1.0, 0.5, 0.0)), None);
    }

    #[test]
    fn the_surface_is_on_the_face_that_is_crossed() {
        let surface = |origin, direction| {
            let t = hit(origin, direction).expect("a hit");
            let surface = UNIT.surface(&Ray { origin, direction }, Crossing::at(t));
            (surface.point, surface.normal)
        };
        let top = surface(DVec3::new(0.2, 3.0, 0.7), DVec3::NEG_Y);
        assert_eq!(top, (DVec3::new(0.2, 1.0, 0.7), DVec3::Y));
        // Along an edge of the top: its sides are not seen.
        assert_eq!(surface(DVec3::new(1.0, 3.0, 0.7), DVec3::NEG_Y).1, DVec3::Y);
        let inside = surface(DVec3::new(0.1, 0.4, 0.7), DVec3::new(-1.0, 0.5, 0.25));
        assert_eq!((inside.0.x, inside.1), (0.0, DVec3::NEG_X));
    }
}
