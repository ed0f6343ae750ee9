//! Light on its way to a surface: from where, how much, and with what chance it was asked for.

use super::shade::Seen;
use super::spawn::{spawn_between, spawn_gathering, spawn_to};
use crate::camera::Ray;
use crate::color::Rgb;
use crate::light::{Light, Source};
use crate::math::{DVec2, DVec3};
use crate::shape::{Geometric, Surface};
use std::f64::consts::PI;

/// Light that would reach a point if nothing stood in its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Unit vector towards where it comes from.
    pub direction: DVec3,
    /// What the share that the surface reflects is multiplied with: for light from an area, its radiance
    /// over π and the density of its direction.
    pub radiance: Rgb,
    /// Density per solid angle with which the direction was drawn; none if there was no choice.
    pub density: Option<f64>,
    pub from: Origin,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    Point(DVec3),
    Surface(Surface),
    Infinity,
}

impl Arrival {
    /// Light of this radiance from a point of a surface, drawn with this density per solid angle.
    pub fn from_surface(at: DVec3, surface: Surface, radiance: Rgb, density: f64) -> Self {
        let direction = (surface.point - at).normalize_or_zero();
        let radiance = radiance * (1.0 / (PI * density)) as f32;
        Self { direction, radiance, density: Some(density), from: Origin::Surface(surface) }
    }

    /// The same light, drawn from a source that is asked only with this chance.
    pub fn with_chance(self, chance: f64) -> Self {
        let density = self.density.map(|density| density * chance);
        Self { radiance: self.radiance / chance as f32, density, ..self }
    }

    /// The ray from a surface to where the light comes from, and the t before which nothing may stand.
    #[inline]
    pub fn shadow_ray(&self, surface: &Surface) -> (Ray, f64) {
        match &self.from {
            Origin::Point(point) => (spawn_to(surface, *point), 1.0),
            Origin::Surface(target) => (spawn_between(surface, target), 1.0),
            Origin::Infinity => (spawn_gathering(surface, self.direction), f64::INFINITY),
        }
    }
}

/// The light that comes to a surface from a light, for `u` uniform in the unit square; none if it does not shine there.
pub fn arrival(light: &Light, seen: &Seen, u: DVec2) -> Option<Arrival> {
    let at = seen.surface.point;
    match &light.source {
        Source::Point { position, attenuation } => {
            let way = *position - at;
            let radiance = light.radiance * attenuation.share(way.length()) as f32;
            let direction = way.normalize_or_zero();
            Some(Arrival { direction, radiance, density: None, from: Origin::Point(*position) })
        }
        Source::Spot { position, cone, attenuation } => {
            let way = *position - at;
            let direction = way.normalize_or_zero();
            let share = attenuation.share(way.length()) * cone.share(-direction.dot(cone.axis));
            let radiance = light.radiance * share as f32;
            let arrival = Arrival { direction, radiance, density: None, from: Origin::Point(*position) };
            (share > 0.0).then_some(arrival)
        }
        Source::Directional { to_light } => {
            let (direction, radiance) = (*to_light, light.radiance);
            Some(Arrival { direction, radiance, density: None, from: Origin::Infinity })
        }
        Source::Sphere(sphere) => {
            // No light comes to the inside of a sphere that shines outwards.
            let inside = (at - sphere.center).length() < sphere.radius;
            let (surface, _, density) = sphere.sample_from(at, &seen.frame(), u).filter(|_| !inside)?;
            Some(Arrival::from_surface(at, surface, light.radiance, density))
        }
        Source::Rectangle { rectangle, one_sided } => {
            let (surface, _, density) = rectangle.sample_from(at, &seen.frame(), u)?;
            let shines = !one_sided || surface.normal.dot(at - surface.point) > 0.0;
            shines.then(|| Arrival::from_surface(at, surface, light.radiance, density))
        }
    }
}

/// The radiance of a light that is part of the geometry where it is seen: `outside` says whether from the side
/// that its normal is on.
pub fn seen(light: &Light, outside: bool) -> Rgb {
    let shines = match light.source {
        Source::Sphere(_) => outside,
        Source::Rectangle { one_sided, .. } => outside || !one_sided,
        Source::Point { .. } | Source::Spot { .. } | Source::Directional { .. } => false,
    };
    if shines { light.radiance } else { Rgb::ZERO }
}
