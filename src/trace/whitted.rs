//! Whitted's integrator: at every hit ambient light, every light as far as it arrives, and on to what mirrors
//! show and what lies behind the transparent (Whitted 1980). Rays branch; nothing is left to chance but where
//! a lens, an area light, a rough surface or motion has to be sampled.

use super::lights::{arrival, seen};
use super::media::Media;
use super::place::Passed;
use super::shade::Seen;
use super::spawn::{spawn, spawn_gathering, spawn_mirrored};
use super::throughput::Throughput;
use super::tracer::{Dice, Face, Met, Tracer, Work};
use crate::camera::{Beam, Ray};
use crate::color::Rgb;
use crate::math::{DVec2, DVec3};
use crate::optics::reflect;
use crate::sampling::Use;

/// A ray that is still to be followed.
#[derive(Clone, Copy, Debug)]
pub struct Pending {
    ray: Ray,
    /// Unit vector across the ray that it takes along for frames around normals.
    tangent: DVec3,
    beam: Beam,
    throughput: Rgb,
    /// Surfaces that are left to reflect or bend light.
    left: u32,
    media: Media,
    /// Whether area lights count where the ray meets them. Those that the surface it comes from has sampled
    /// already do not.
    sees_lights: bool,
    /// How far the ray has come, if it has passed something straight on.
    passed: Option<Passed>,
}

/// Adds what is seen along a camera's ray to `work`.
pub fn follow(tracer: &Tracer, (ray, beam): (Ray, Beam), mut dice: Dice, work: &mut Work) {
    let (throughput, left) = (Rgb::ONE, tracer.quality.surfaces());
    let (media, passed) = (Media::default(), None);
    work.nesting.clear();
    let tangent = tracer.scene.camera.tangent(&ray);
    let mut next = Some(Pending { ray, tangent, beam, throughput, left, media, sees_lights: true, passed });
    while let Some(pending) = next.take() {
        step(tracer, pending, &mut dice, work);
        next = work.pending.pop();
    }
}

/// Follows one ray to where it ends, and puts off those that start there.
fn step(tracer: &Tracer, pending: Pending, dice: &mut Dice, work: &mut Work) {
    let Pending { ray, ref beam, mut throughput, left, media, sees_lights, passed, .. } = pending;
    let (first, showing) = (|| tracer.closest(&ray), Throughput::showing(throughput));
    let (met, way) = tracer.advance((&ray, beam, passed, left), first, media, &showing, work);
    throughput *= way.passed * way.clear;
    let face = match met {
        Met::Nothing => return tracer.add_sky(&ray, throughput, pending.left, work),
        Met::Light { index, outside, .. } => {
            let light = &tracer.scene.shading.lights[index as usize];
            if sees_lights {
                work.add(light.layer, throughput * seen(light, outside));
            }
            return;
        }
        Met::Surface(face) => face,
    };
    let surface = dice.surface;
    dice.surface += 1;
    let branch = Branch { tracer, pending: &pending, face: &face, throughput };
    if branch.hidden(work) {
        return;
    }
    if pending.left == 0 {
        // Behind the last surface that reflects, only what gives off light is seen, through what lets it pass.
        tracer.add_emission(&face, throughput, work);
        return branch.transparent(work);
    }
    tracer.add_ambient(&face, throughput, work);
    tracer.add_emission(&face, throughput, work);
    branch.lights(Dice { surface, ..*dice }, work);
    branch.rough(Dice { surface, ..*dice }, work);
    branch.mirror(Dice { surface, ..*dice }, work);
    branch.transparent(work);
    branch.refracted(work);
}

/// A hit from which rays may go on.
struct Branch<'a, 't> {
    tracer: &'t Tracer<'a>,
    pending: &'t Pending,
    face: &'t Face<'a>,
    throughput: Rgb,
}

impl Branch<'_, '_> {
    fn seen(&self) -> Seen<'_> {
        self.face.seen(&self.pending.ray, self.pending.tangent)
    }

    fn lights(&self, dice: Dice, work: &mut Work) {
        if !self.face.lobes.reflects_lights() {
            return;
        }
        let seen = self.seen();
        for (index, light) in &self.tracer.lights {
            let u = match light.source.is_sampled() {
                true => dice.sampler.two(Use::Light { surface: dice.surface, light: *index }),
                false => DVec2::ZERO,
            };
            let Some(arrival) = arrival(light, &seen, u) else { continue };
            work.counts.evaluations.light_samples += u64::from(arrival.density.is_some());
            let reflected = seen.reflected(arrival.direction);
            let clear = self.tracer.clearness(&arrival, seen.surface, work);
            let share = reflected.scattered(clear) + reflected.highlight;
            if share == Rgb::ZERO {
                continue;
            }
            let passing = self.tracer.passing(&arrival, seen.surface, self.pending.media, work);
            if passing.whole != Rgb::ZERO {
                work.add(light.layer, self.throughput * share * passing.whole * arrival.radiance);
            }
        }
    }

    /// Puts off a ray from this one of the surfaces that are left, if it matters.
    fn bounce(&self, ray: Ray, share: Rgb, media: Media, sees_lights: bool, work: &mut Work) -> bool {
        let throughput = self.throughput * share;
        let left = self.pending.left;
        if !self.tracer.goes_on(left)
            || share == Rgb::ZERO
            || throughput.max_element() < self.tracer.quality.threshold
        {
            return false;
        }
        let left = left - 1;
        let (tangent, beam) = (self.seen().frame().tangent(ray.direction), self.beam());
        let passed = None;
        work.pending.push(Pending { ray, tangent, beam, throughput, left, media, sees_lights, passed });
        true
    }

    fn mirror(&self, dice: Dice, work: &mut Work) {
        let lobes = &self.face.lobes;
        if lobes.mirror == Rgb::ZERO {
            return;
        }
        let seen = self.seen();
        let mirrored = seen.mirrored();
        let Some(fuzz) = seen.fuzz() else { return self.reflect(mirrored, lobes.mirror, work) };
        let [_, u, v, w] = dice.sampler.four(Use::Scatter(dice.surface));
        self.scatter(fuzz.sample(mirrored, DVec3::new(u, v, w)), lobes.mirror, work);
    }

    /// The metallic-roughness surface's reflection: in one of its small mirrors.
    fn rough(&self, dice: Dice, work: &mut Work) {
        let lobes = &self.face.lobes;
        if lobes.microfacet == 0.0 {
            return;
        }
        let seen = self.seen();
        let Some(microfacet) = seen.microfacet() else {
            let fresnel = seen.metallic_fresnel(seen.normal().dot(seen.to_eye));
            return self.reflect(seen.mirrored(), fresnel * lobes.microfacet, work);
        };
        let frame = seen.frame();
        let eye = DVec3::from(frame.to_local(seen.to_eye));
        let [_, _, u, v] = dice.sampler.four(Use::Glossy(dice.surface));
        let half = microfacet.sample(eye, DVec2::new(u, v));
        let light = reflect(-eye, half);
        let density = microfacet.density(eye, light);
        if light.z <= 0.0 || density == 0.0 {
            return;
        }
        let share = (microfacet.reflected(eye, light) / density) as f32;
        let fresnel = seen.metallic_fresnel(eye.dot(half));
        self.scatter(frame.to_world(light.to_array()), fresnel * (share * lobes.microfacet), work);
    }

    /// Puts off the reflection of a sharp mirror.
    fn reflect(&self, direction: DVec3, share: Rgb, work: &mut Work) {
        self.reflected(spawn_mirrored(&self.face.surface, direction), share, true, work);
    }

    /// Puts off a reflection that was drawn, unless it leads below the surface.
    fn scatter(&self, direction: DVec3, share: Rgb, work: &mut Work) {
        let surface = &self.face.surface;
        if direction.dot(surface.normal) > 0.0 || surface.smoothly_faces(direction) {
            self.reflected(spawn_gathering(surface, direction), share, false, work);
        }
    }

    fn reflected(&self, ray: Ray, share: Rgb, sees_lights: bool, work: &mut Work) {
        if self.bounce(ray, share, self.pending.media, sees_lights, work) {
            work.counts.rays.mirror += 1;
        }
    }

    /// Straight on through what hides the surface, if anything does.
    fn hidden(&self, work: &mut Work) -> bool {
        let hidden = self.face.boundary.is_some_and(|boundary| boundary.hidden);
        if hidden {
            self.straight_on(self.throughput, work);
        }
        hidden
    }

    fn straight_on(&self, throughput: Rgb, work: &mut Work) {
        let media = self.face.boundary.map_or(self.pending.media, |boundary| boundary.passed);
        let (beam, passed) = (self.beam(), Some(self.face.passed));
        work.pending.push(Pending { beam, throughput, media, passed, ..*self.pending });
    }

    /// What passes unbent is not reflected: as many surfaces are left.
    fn transparent(&self, work: &mut Work) {
        let throughput = self.throughput * self.face.lobes.transparency;
        if throughput == Rgb::ZERO || throughput.max_element() < self.tracer.quality.threshold {
            return;
        }
        work.counts.rays.transmitted += 1;
        self.straight_on(throughput, work);
    }

    /// The beam where it meets the surface. It goes on as if all surfaces were flat.
    fn beam(&self) -> Beam {
        Beam { width: self.face.width, ..self.pending.beam }
    }

    fn refracted(&self, work: &mut Work) {
        let share = self.face.lobes.refraction;
        let Some(boundary) = self.face.boundary.filter(|_| share != Rgb::ZERO) else { return };
        let seen = self.seen();
        let direction = self.pending.ray.direction;
        let Some(bent) = boundary.meet(self.face.material.fresnel, direction, seen.normal()) else {
            return self.reflect(seen.mirrored(), share, work);
        };
        let reflected = bent.reflected as f32;
        let ray = spawn(&self.face.surface, bent.direction);
        let media = if seen.passes(bent.direction) { boundary.passed } else { self.pending.media };
        // Shadow rays pass here too, so that what they have found must not count again.
        let sees_lights = self.pending.sees_lights;
        if self.bounce(ray, share * (1.0 - reflected), media, sees_lights, work) {
            work.counts.rays.transmitted += 1;
        }
        // A boundary reflects all colours alike, whatever colour it lets pass.
        self.reflect(seen.mirrored(), Rgb::splat(share.max_element() * reflected), work);
    }
}
