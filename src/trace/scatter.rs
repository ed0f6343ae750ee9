//! Where a path goes on from a surface: one lobe is drawn by its strength, then a direction in it.

use super::media::{Boundary, Media};
use super::shade::Seen;
use crate::color::Rgb;
use crate::math::{DVec2, DVec3};
use crate::optics::reflect;
use crate::sampling::cosine_hemisphere;
use std::f64::consts::PI;

/// How a path goes on.
#[derive(Clone, Copy, Debug)]
pub struct Scatter {
    pub direction: DVec3,
    /// What the path's throughput is multiplied with, in the parts that the surface gathers and shows.
    pub gathers: Rgb,
    pub shows: Rgb,
    /// Density per solid angle of the direction; none where there was no choice.
    pub density: Option<f64>,
    pub kind: Kind,
    /// What the ray is inside of, if that changes.
    pub media: Option<Media>,
}

impl Scatter {
    /// On in the one direction that there is.
    fn sharp(kind: Kind, direction: DVec3, shows: Rgb) -> Self {
        Self { direction, gathers: Rgb::ZERO, shows, density: None, kind, media: None }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Mirrored,
    Unbent,
    Bent,
    Scattered,
}

/// The chances of a surface's lobes.
struct Chances {
    diffuse: f64,
    /// The boundary of a metallic-roughness surface.
    shine: f64,
    mirror: f64,
    transparent: f64,
    refracted: f64,
}

impl Chances {
    fn of(seen: &Seen) -> Self {
        let lobes = seen.lobes;
        let microfacet = f64::from(lobes.microfacet);
        let fresnel = seen.metallic_fresnel(seen.normal().dot(seen.to_eye));
        let below = if microfacet > 0.0 { f64::from(seen.rough_base().max_element()) } else { 0.0 };
        let chances = Self {
            diffuse: f64::from(lobes.diffuse.max_element()) + below * microfacet,
            shine: f64::from(fresnel.max_element()) * microfacet,
            mirror: f64::from(lobes.mirror.max_element()),
            transparent: f64::from(lobes.transparency.max_element()),
            refracted: f64::from(lobes.refraction.max_element()),
        };
        let sum = chances.diffuse + chances.shine + chances.mirror + chances.transparent + chances.refracted;
        if sum == 0.0 {
            return chances;
        }
        Self {
            diffuse: chances.diffuse / sum,
            shine: chances.shine / sum,
            mirror: chances.mirror / sum,
            transparent: chances.transparent / sum,
            refracted: chances.refracted / sum,
        }
    }
}

/// The next direction, for four numbers in 0..1; none where the path ends.
pub fn scatter(seen: &Seen, boundary: Option<&Boundary>, [choice, u, v, w]: [f64; 4]) -> Option<Scatter> {
    let chances = Chances::of(seen);
    let mut rest = choice;
    // Which share of the numbers falls to a lobe: what is left of them is uniform again.
    let mut falls_to = |chance: f64| {
        if rest < chance {
            rest /= chance;
            return true;
        }
        rest -= chance;
        false
    };
    if falls_to(chances.diffuse) {
        let direction = seen.frame().to_world(cosine_hemisphere(DVec2::new(u, v)).to_array());
        return drawn(seen, &chances, direction);
    }
    if falls_to(chances.shine) {
        return shine(seen, &chances, DVec2::new(u, v));
    }
    if falls_to(chances.mirror) {
        let mirrored = seen.mirrored();
        return match seen.fuzz() {
            Some(fuzz) => drawn(seen, &chances, fuzz.sample(mirrored, DVec3::new(u, v, w))),
            None => Some(Scatter::sharp(Kind::Mirrored, mirrored, seen.lobes.mirror / chances.mirror as f32)),
        };
    }
    if falls_to(chances.transparent) {
        let share = seen.lobes.transparency / chances.transparent as f32;
        let media = boundary.map(|boundary| boundary.passed);
        return Some(Scatter { media, ..Scatter::sharp(Kind::Unbent, -seen.to_eye, share) });
    }
    // What rounding leaves over falls to the last lobe.
    let boundary = boundary.filter(|_| chances.refracted > 0.0)?;
    bent(seen, boundary, &chances, rest / chances.refracted)
}

/// The metallic-roughness surface's reflection, in one of its small mirrors.
fn shine(seen: &Seen, chances: &Chances, u: DVec2) -> Option<Scatter> {
    let Some(microfacet) = seen.microfacet() else {
        let fresnel = seen.metallic_fresnel(seen.normal().dot(seen.to_eye));
        let share = fresnel * (seen.lobes.microfacet / chances.shine as f32);
        return Some(Scatter::sharp(Kind::Mirrored, seen.mirrored(), share));
    };
    let frame = seen.frame();
    let eye = DVec3::from(frame.to_local(seen.to_eye));
    let light = reflect(-eye, microfacet.sample(eye, u));
    drawn(seen, chances, frame.to_world(light.to_array()))
}

/// A direction that more than one lobe may have given, weighed by all of them.
fn drawn(seen: &Seen, chances: &Chances, direction: DVec3) -> Option<Scatter> {
    let density = density_of(seen, chances, direction);
    let reflected = seen.reflected(direction);
    if density <= 0.0 || reflected.scattered(1.0) == Rgb::ZERO {
        return None;
    }
    let each = (1.0 / (PI * density)) as f32;
    let (gathers, shows) = (reflected.diffuse * each, reflected.shine * each);
    Some(Scatter { direction, gathers, shows, density: Some(density), kind: Kind::Scattered, media: None })
}

/// The density per solid angle with which [`scatter`] gives a direction, but for those without a choice.
pub fn scatter_density(seen: &Seen, direction: DVec3) -> f64 {
    density_of(seen, &Chances::of(seen), direction)
}

fn density_of(seen: &Seen, chances: &Chances, direction: DVec3) -> f64 {
    let mut density = chances.diffuse * seen.diffuse_density(direction);
    if chances.shine > 0.0
        && let Some(microfacet) = seen.microfacet()
    {
        let [eye, light] = seen.local(direction);
        if light.z > 0.0 {
            density += chances.shine * microfacet.density(eye, light);
        }
    }
    if chances.mirror > 0.0
        && let Some(fuzz) = seen.fuzz()
    {
        density += chances.mirror * fuzz.density(seen.mirrored(), direction);
    }
    density
}

/// Into what lies behind a boundary, or back from it, by the share that it reflects.
fn bent(seen: &Seen, boundary: &Boundary, chances: &Chances, choice: f64) -> Option<Scatter> {
    let share = seen.lobes.refraction / chances.refracted as f32;
    let Some(bent) = boundary.meet(seen.material.fresnel, -seen.to_eye, seen.normal()) else {
        return Some(Scatter::sharp(Kind::Mirrored, seen.mirrored(), share));
    };
    if choice < bent.reflected {
        // A boundary reflects all colours alike, whatever colour it lets pass.
        return Some(Scatter::sharp(Kind::Mirrored, seen.mirrored(), Rgb::splat(share.max_element())));
    }
    let media = seen.passes(bent.direction).then_some(boundary.passed);
    Some(Scatter { media, ..Scatter::sharp(Kind::Bent, bent.direction, share) })
}
