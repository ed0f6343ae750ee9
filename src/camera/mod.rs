//! Cameras at one moment (a frame in space and a projection), and their paths over time.
//!
//! In: keyed poses, path steps and times.
//! Out: cameras, their rays, and the moments of a frame.
//! May use: `base`, `sampling`, `track`.

pub mod path;

use crate::base::digest::Content;
use crate::base::lanes::{Real, Vec3};
use crate::base::math::{Basis, DVec2, DVec3, LaneRay, Ray};
use crate::sampling::disk;

/// The footprint of a pixel along a ray: a cone.
#[derive(Clone, Copy, Debug)]
pub struct RayCone<F> {
    /// The width at the origin of the ray.
    pub width: F,
    /// The growth of the width per unit of length.
    pub spread: F,
}

impl<F: Real> RayCone<F> {
    /// The width at a distance along the ray.
    #[inline(always)]
    pub fn width_at(&self, length: F) -> F {
        self.width + self.spread * length
    }
}

/// The mapping from space to the picture.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub enum Projection {
    /// Half the picture's height at distance 1: the tangent of half the vertical field of view.
    Perspective { half_height: f64 },
    /// Half the picture's height in world units.
    Orthographic { half_height: f64 },
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct ThinLens {
    /// In world units, above 0.
    pub radius: f64,
    /// Distance along the line of sight to the plane in focus, above 0.
    pub focus: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct Camera {
    pub position: DVec3,
    pub basis: Basis,
    pub projection: Projection,
    /// None for a pinhole.
    pub lens: Option<ThinLens>,
}

impl Camera {
    /// The cones of pixels around rays. `pixel` is the height of a pixel in the units of [`Camera::ray`]. The cones
    /// ignore depth of field.
    #[inline(always)]
    pub fn cones<F: Real>(&self, ray: &LaneRay<F>, pixel: F) -> RayCone<F> {
        let zero = F::splat(0.0);
        match self.projection {
            Projection::Perspective { half_height } => {
                let along = ray.direction.dot(Vec3::splat(self.basis.forward));
                RayCone { width: zero, spread: F::splat(half_height) * pixel * along }
            }
            Projection::Orthographic { half_height } => {
                RayCone { width: F::splat(half_height) * pixel, spread: zero }
            }
        }
    }

    /// The ray through a point of the picture. `screen.y` is -1 at the bottom and 1 at the top; `screen.x` has the
    /// same scale, so it goes up to ±width / height. `u`, two numbers in 0..1, selects the point of the lens,
    /// uniformly over its area.
    pub fn ray(&self, screen: DVec2, u: DVec2) -> Ray {
        let ray = self.rays::<f64>(screen.to_array(), u.to_array());
        Ray { origin: ray.origin.into(), direction: ray.direction.into() }
    }

    /// [`Camera::ray`] in lanes.
    #[inline(always)]
    pub fn rays<F: Real>(&self, [x, y]: [F; 2], [u, v]: [F; 2]) -> LaneRay<F> {
        let Basis { right, up, forward } = self.basis;
        let (right, up, forward) = (Vec3::<F>::splat(right), Vec3::<F>::splat(up), Vec3::<F>::splat(forward));
        let (Projection::Perspective { half_height } | Projection::Orthographic { half_height }) =
            self.projection;
        let half_height = F::splat(half_height);
        let across = right * (x * half_height) + up * (y * half_height);
        let position = Vec3::splat(self.position);
        let parallel = matches!(self.projection, Projection::Orthographic { .. });
        let (origin, toward) =
            if parallel { (position + across, forward) } else { (position, forward + across) };
        let Some(lens) = self.lens else {
            return LaneRay { origin, direction: if parallel { toward } else { toward.normalize() } };
        };
        // `toward` reaches the plane in focus at t = focus, because its component along the line of sight is 1.
        let (radius, (across, along)) = (F::splat(lens.radius), disk(u, v));
        let offset = right * (across * radius) + up * (along * radius);
        let direction = (toward * F::splat(lens.focus) - offset).normalize();
        LaneRay { origin: origin + offset, direction }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::{UNIT_ROUNDOFF, look_at};
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
