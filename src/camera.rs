//! The camera at one moment: a frame in space and a projection.

use crate::math::{Basis, DVec2, DVec3};

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

/// How the camera maps space to the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Half the picture's height at distance 1: the tangent of half the vertical field of view.
    Perspective { half_height: f64 },
    /// Half the picture's height in world units.
    Orthographic { half_height: f64 },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub position: DVec3,
    pub basis: Basis,
    pub projection: Projection,
}

impl Camera {
    /// The ray through a point of the picture: `screen.y` runs from -1 at the bottom to 1 at the top,
    /// `screen.x` likewise times the picture's width / height.
    pub fn ray(&self, screen: DVec2) -> Ray {
        let Basis { right, up, forward } = self.basis;
        match self.projection {
            Projection::Perspective { half_height } => {
                let across = right * (screen.x * half_height) + up * (screen.y * half_height);
                Ray { origin: self.position, direction: (forward + across).normalize() }
            }
            Projection::Orthographic { half_height } => {
                let across = right * (screen.x * half_height) + up * (screen.y * half_height);
                Ray { origin: self.position + across, direction: forward }
            }
        }
    }
}
