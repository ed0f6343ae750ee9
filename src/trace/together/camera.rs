//! Eight rays from the camera, as [`Camera::ray`] makes one, where there is no lens.

use super::everywhere;
use crate::camera::{Camera, Projection};
use crate::math::DVec2;
use crate::shape::Rays;
use crate::simd::{Lanes, Octo};

/// The rays through points of pixels, `inside` of each by as much, of a picture of this width and height.
#[inline(always)]
pub fn rays<L: Lanes>(camera: &Camera, size: (u32, u32), pixels: &[(u32, u32); 8], inside: DVec2) -> Rays {
    let (width, height) = (f64::from(size.0), Octo::<L::Quad>::splat(f64::from(size.1)));
    let two = Octo::splat(2.0);
    let x = Octo::load(&pixels.map(|(x, _)| f64::from(x))) + Octo::splat(inside.x);
    let y = Octo::load(&pixels.map(|(_, y)| f64::from(y))) + Octo::splat(inside.y);
    let (x, y) = ((two * x - Octo::splat(width)) / height, (height - two * y) / height);
    let (Projection::Perspective { half_height } | Projection::Orthographic { half_height }) =
        camera.projection;
    let half_height = Octo::splat(half_height);
    let across =
        everywhere(camera.basis.right) * (x * half_height) + everywhere(camera.basis.up) * (y * half_height);
    let (position, forward) = (everywhere(camera.position), everywhere(camera.basis.forward));
    let (origin, direction) = match camera.projection {
        Projection::Orthographic { .. } => (position + across, forward),
        Projection::Perspective { .. } => {
            let toward = forward + across;
            (position, toward * (Octo::splat(1.0) / toward.length()))
        }
    };
    Rays { origin: origin.store(), direction: direction.store() }
}
