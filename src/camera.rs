//! The camera at one moment: a frame in space and a projection.

use crate::digest::content;
use crate::math::{Basis, DVec2, DVec3};
use crate::sampling::{Frame, disk};

/// A ray: `origin` + t·`direction`, with a unit direction when it comes from a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
}

impl Ray {
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// How much a ray stands for: a beam as wide as what a pixel shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Beam {
    /// Where the ray starts.
    pub width: f64,
    /// How much it grows per unit of length.
    pub spread: f64,
}

impl Beam {
    /// Its width after a way.
    pub fn after(&self, length: f64) -> f64 {
        self.width + self.spread * length
    }
}

/// How the camera maps space to the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Half the picture's height at distance 1: the tangent of half the vertical field of view.
    Perspective { half_height: f64 },
    /// Half the picture's height in world units.
    Orthographic { half_height: f64 },
}

content!(enum Projection { Perspective { half_height }, Orthographic { half_height } });

/// A lens that is not a pinhole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Above 0.
    pub radius: f64,
    /// Distance along the line of sight at which points are sharp, above 0.
    pub focus: f64,
}

content!(struct ThinLens { radius, focus });

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub position: DVec3,
    pub basis: Basis,
    pub projection: Projection,
    /// None for a pinhole.
    pub lens: Option<ThinLens>,
}

content!(struct Camera { position, basis, projection, lens });

impl Camera {
    /// The beam of a pixel around a ray; `pixel` is its height in the units of [`Camera::ray`]. Depth of field is no
    /// part of it.
    pub fn beam(&self, ray: &Ray, pixel: f64) -> Beam {
        match self.projection {
            Projection::Perspective { half_height } => {
                Beam { width: 0.0, spread: half_height * pixel * ray.direction.dot(self.basis.forward) }
            }
            Projection::Orthographic { half_height } => Beam { width: half_height * pixel, spread: 0.0 },
        }
    }

    /// The unit vector across a ray that it takes along from the camera (see [`Frame`]): that to the right for one along
    /// the line of sight.
    #[inline]
    pub fn tangent(&self, ray: &Ray) -> DVec3 {
        Frame { x: self.basis.right, y: self.basis.up, z: -self.basis.forward }.tangent(ray.direction)
    }

    /// The ray through a point of the picture: `screen.y` runs from -1 at the bottom to 1 at the top,
    /// `screen.x` likewise times the picture's width / height. `u`, two numbers in 0..1, picks the point of
    /// the lens, evenly over its area.
    pub fn ray(&self, screen: DVec2, u: DVec2) -> Ray {
        let Basis { right, up, forward } = self.basis;
        let (origin, toward) = match self.projection {
            Projection::Perspective { half_height } => {
                let across = right * (screen.x * half_height) + up * (screen.y * half_height);
                (self.position, forward + across)
            }
            Projection::Orthographic { half_height } => {
                let across = right * (screen.x * half_height) + up * (screen.y * half_height);
                (self.position + across, forward)
            }
        };
        let Some(lens) = self.lens else {
            let parallel = matches!(self.projection, Projection::Orthographic { .. });
            return Ray { origin, direction: if parallel { toward } else { toward.normalize() } };
        };
        // `toward` reaches the plane in focus at t = focus: its part along the line of sight is 1.
        let offset = disk(u) * lens.radius;
        let offset = right * offset.x + up * offset.y;
        Ray { origin: origin + offset, direction: (toward * lens.focus - offset).normalize() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{UNIT_ROUNDOFF, look_at};
    use crate::testing::Random;

    #[test]
    fn ca_09_all_rays_of_a_pixel_meet_in_focus() {
        let position = DVec3::new(3.0, 2.0, 9.0);
        let basis = look_at(position, DVec3::ZERO, DVec3::Y).expect("a frame");
        let mut random = Random(4);
        for projection in
            [Projection::Perspective { half_height: 0.4 }, Projection::Orthographic { half_height: 3.0 }]
        {
            let lens = Some(ThinLens { radius: 0.5, focus: 7.0 });
            let camera = Camera { position, basis, projection, lens };
            let pinhole = Camera { lens: None, ..camera };
            let screen = DVec2::new(0.3, -0.8);
            let sharp = pinhole.ray(screen, DVec2::ZERO);
            let sharp = sharp.at(7.0 / sharp.direction.dot(basis.forward));
            for _ in 0..1000 {
                let ray = camera.ray(screen, DVec2::new(random.unit(), random.unit()));
                let met = ray.at((sharp - ray.origin).dot(basis.forward) / ray.direction.dot(basis.forward));
                assert!((met - sharp).length() <= 16.0 * UNIT_ROUNDOFF * 20.0);
            }
        }
    }
}
