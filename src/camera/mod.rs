//! Cameras at one moment (a frame in space and a projection), and their paths over time.
//!
//! In: keyed poses, path steps and times.
//! Out: cameras, their rays, and the moments of a frame.
//! May use: `base`, `sampling`, `track`.

mod cuts;
pub mod path;

pub use cuts::{CameraCuts, CrossFade};

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
#[warn(missing_docs)]
pub enum Projection {
    /// Rays leave from one point.
    Perspective {
        /// Half the picture's height at distance 1: the tangent of half the vertical field of view.
        half_height: f64,
    },
    /// Rays are parallel.
    Orthographic {
        /// Half the picture's height in world units.
        half_height: f64,
    },
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub struct ThinLens {
    /// In world units, above 0.
    pub radius: f64,
    /// Distance along the line of sight to the plane in focus, above 0.
    pub focus: f64,
}

/// A point as the camera sees it, in homogeneous coordinates, in which straight lines stay straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedPoint {
    /// The place in the units of [`Camera::ray`], times `weight`.
    pub across: DVec2,
    /// Above 0 for points that the camera may see.
    pub weight: f64,
    /// The distance along the line of sight. Points are in front of the camera if it is above 0.
    pub depth: f64,
}

impl ProjectedPoint {
    /// The place in the units of [`Camera::ray`]. None behind the camera.
    pub fn screen(&self) -> Option<DVec2> {
        let screen = self.across / self.weight;
        (self.depth > 0.0 && screen.is_finite()).then_some(screen)
    }

    /// A point of the straight line to another point.
    pub fn lerp(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        Self {
            across: self.across + (other.across - self.across) * share,
            weight: mix(self.weight, other.weight),
            depth: mix(self.depth, other.depth),
        }
    }
}

/// The place of a position of a picture of this size, in pixels from the left and from the top, in the units of
/// [`Camera::ray`]: pixels are square, and both axes are in units of half the picture's height, from the centre.
#[inline(always)]
pub fn screen_of<F: Real>([across, down]: [F; 2], (width, height): (u32, u32)) -> [F; 2] {
    let (width, height) = (F::splat(f64::from(width)), F::splat(f64::from(height)));
    let two = F::splat(2.0);
    [(two * across - width) / height, (height - two * down) / height]
}

/// The position in a picture of this size of a place in the units of [`Camera::ray`]: the inverse of [`screen_of`].
#[inline(always)]
pub fn pixels_of<F: Real>([x, y]: [F; 2], (width, height): (u32, u32)) -> [F; 2] {
    let (width, height) = (F::splat(f64::from(width)), F::splat(f64::from(height)));
    let two = F::splat(2.0);
    [(x * height + width) / two, (height - y * height) / two]
}

/// A camera at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub struct Camera {
    /// The eye, or the centre of the lens.
    pub position: DVec3,
    /// Its orientation.
    pub basis: Basis,
    /// How it maps space to the picture.
    pub projection: Projection,
    /// None for a pinhole.
    pub lens: Option<ThinLens>,
}

#[warn(missing_docs)]
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

    /// The ray through the centre of the lens and a position of a picture of this size, in pixels from the left and from the
    /// top.
    pub fn pixel_ray(&self, at: [f64; 2], size: (u32, u32)) -> Ray {
        Self { lens: None, ..*self }.ray(screen_of(at, size).into(), DVec2::ZERO)
    }

    /// The place of a point in the picture: the inverse of [`Camera::ray`] through the centre of the lens.
    pub fn project(&self, point: DVec3) -> ProjectedPoint {
        let Basis { right, up, forward } = self.basis;
        let to = point - self.position;
        let depth = to.dot(forward);
        let weight = match self.projection {
            Projection::Perspective { half_height } => depth * half_height,
            Projection::Orthographic { half_height } => half_height,
        };
        ProjectedPoint { across: DVec2::new(to.dot(right), to.dot(up)), weight, depth }
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

    /// Rays through the projected place of a point meet the point, whatever the lens.
    #[test]
    fn projection_inverts_rays() {
        let mut random = Random(7);
        let mut seen = 0;
        for index in 0..4000 {
            let position = random.point(10.0);
            let Some(basis) = look_at(position, random.point(2.0), DVec3::Y) else { continue };
            let half_height = 0.01 + 3.0 * random.unit();
            let projection = match index % 2 {
                0 => Projection::Perspective { half_height },
                _ => Projection::Orthographic { half_height },
            };
            let lens = (index % 3 == 0).then_some(ThinLens { radius: 0.2, focus: 3.0 });
            let camera = Camera { position, basis, projection, lens };
            let point = random.point(12.0);
            let projected = camera.project(point);
            let Some(screen) = projected.screen() else {
                assert!((point - position).dot(basis.forward) <= 0.0);
                continue;
            };
            seen += 1;
            let ray = Camera { lens: None, ..camera }.ray(screen, DVec2::ZERO);
            let away = (point - ray.origin).cross(ray.direction).length();
            let pixel = half_height * projected.depth.max(1.0) / 1080.0;
            assert!(away < 1e-6 * pixel.max(1e-6), "{away} {pixel}");
        }
        assert!(seen > 1000);
    }

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
