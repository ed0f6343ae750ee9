//! Eight rays from the camera, as [`Camera::ray`] makes one.

use super::everywhere;
use crate::camera::{Camera, Projection};
use crate::math::cos_sin_of_quarters;
use crate::shape::Rays;
use crate::simd::{Octo, Quad};

/// The rays through points of a picture of this width and height, in pixels from its upper left corner; `lens` gives two
/// numbers each in 0..1 for the place on the lens.
#[inline(always)]
pub fn rays<Q: Quad>(camera: &Camera, size: (u32, u32), [x, y]: [Octo<Q>; 2], lens: &[[f64; 8]; 2]) -> Rays {
    let (width, height) = (f64::from(size.0), Octo::splat(f64::from(size.1)));
    let two = Octo::splat(2.0);
    let (x, y) = ((two * x - Octo::splat(width)) / height, (height - two * y) / height);
    let (Projection::Perspective { half_height } | Projection::Orthographic { half_height }) =
        camera.projection;
    let half_height = Octo::splat(half_height);
    let (right, up) = (everywhere(camera.basis.right), everywhere(camera.basis.up));
    let across = right * (x * half_height) + up * (y * half_height);
    let (position, forward) = (everywhere(camera.position), everywhere(camera.basis.forward));
    let (origin, toward) = match camera.projection {
        Projection::Orthographic { .. } => (position + across, forward),
        Projection::Perspective { .. } => (position, forward + across),
    };
    let one = Octo::splat(1.0);
    let Some(thin) = camera.lens else {
        let direction = match camera.projection {
            Projection::Orthographic { .. } => toward,
            Projection::Perspective { .. } => toward * (one / toward.length()),
        };
        return Rays { origin: origin.store(), direction: direction.store() };
    };
    let [u, v] = disk(Octo::load(&lens[0]), Octo::load(&lens[1]));
    let radius = Octo::splat(thin.radius);
    let offset = right * (u * radius) + up * (v * radius);
    let toward = toward * Octo::splat(thin.focus) - offset;
    let direction = toward * (one / toward.length());
    Rays { origin: (origin + offset).store(), direction: direction.store() }
}

/// [`crate::sampling::disk`].
#[inline(always)]
fn disk<Q: Quad>(u: Octo<Q>, v: Octo<Q>) -> [Octo<Q>; 2] {
    let (zero, one, two) = (Octo::splat(0.0), Octo::splat(1.0), Octo::splat(2.0));
    let (x, y) = (u * two - one, v * two - one);
    let flat = y.absolute().below(x.absolute());
    let (c, s) = cos_sin_of_quarters(Octo::splat(0.5) * (y / x).pick(flat, x / y));
    let middle = x.absolute().at_most(zero) & y.absolute().at_most(zero);
    let across = (c * x).pick(flat, s * y);
    let along = (s * x).pick(flat, c * y);
    [zero.pick(middle, across), zero.pick(middle, along)]
}
