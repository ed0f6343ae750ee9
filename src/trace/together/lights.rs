//! Light on its way to eight points, as `super::super::lights` has it for one.

use super::everywhere;
use super::shade::Color;
use super::starts::Starts;
use crate::light::{Attenuation, Light, Source};
use crate::math::DVec3;
use crate::shape::Rays;
use crate::simd::{Lanes, Octo, Quad, Vector};

/// Light that would reach eight points if nothing stood in its way.
pub struct Arrivals<L: Lanes> {
    /// Unit vectors towards where it comes from.
    pub direction: Vector<L::Quad>,
    pub radiance: Color<L>,
    /// None for light from infinitely far away.
    from: Option<DVec3>,
}

impl<L: Lanes> Arrivals<L> {
    /// The light that comes to points from a light without an area, and a bit for each to which some comes.
    #[inline(always)]
    pub fn of(light: &Light, at: Vector<L::Quad>) -> (Self, u32) {
        let radiance = Color::splat(light.radiance);
        match &light.source {
            Source::Point { position, attenuation } => {
                let way = everywhere(*position) - at;
                let share = shares(attenuation, way.length());
                (Self::from(*position, way, radiance, share), 0xff)
            }
            Source::Spot { position, cone, attenuation } => {
                let way = everywhere(*position) - at;
                let direction = way.normalized_or(everywhere(DVec3::ZERO));
                let cosine = -direction.dot(everywhere(cone.axis));
                let inside = cosine.store().map(|cosine| cone.share(cosine));
                let share = shares(attenuation, way.length()) * Octo::load(&inside);
                let arriving = Octo::splat(0.0).below(share).bits();
                (Self::from(*position, way, radiance, share), arriving)
            }
            Source::Directional { to_light } => {
                (Self { direction: everywhere(*to_light), radiance, from: None }, 0xff)
            }
            // Of those only single rays ask.
            Source::Sphere(_) | Source::Rectangle { .. } => {
                (Self { direction: everywhere(DVec3::ZERO), radiance, from: None }, 0)
            }
        }
    }

    #[inline(always)]
    fn from(position: DVec3, way: Vector<L::Quad>, radiance: Color<L>, share: Octo<L::Quad>) -> Self {
        let radiance = radiance.scaled(L::load(&share.narrow()));
        Self { direction: way.normalized_or(everywhere(DVec3::ZERO)), radiance, from: Some(position) }
    }

    /// The rays from surfaces to where the light comes from, and the t before which nothing may stand.
    #[inline(always)]
    pub fn shadow_rays(&self, starts: &Starts<L::Quad>) -> (Rays, f64) {
        let Some(position) = self.from else {
            let origin = starts.towards(self.direction).store();
            return (Rays { origin, direction: self.direction.store() }, f64::INFINITY);
        };
        let target: Vector<L::Quad> = everywhere(position);
        let origin = starts.towards(target - starts.point);
        (Rays { origin: origin.store(), direction: (target - origin).store() }, 1.0)
    }
}

/// [`Attenuation::share`].
#[inline(always)]
fn shares<Q: Quad>(attenuation: &Attenuation, distance: Octo<Q>) -> Octo<Q> {
    let Attenuation { constant, linear, quadratic } = *attenuation;
    let one = Octo::splat(1.0);
    if linear <= 0.0 && quadratic <= 0.0 {
        return Octo::splat(attenuation.share(0.0));
    }
    let divisor =
        Octo::splat(constant) + distance * (Octo::splat(linear) + distance * Octo::splat(quadratic));
    one.pick(divisor.at_most(one), one / divisor)
}
