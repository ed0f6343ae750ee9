//! Path tracing: one path per sample, light asked for at every surface (next-event estimation), weighed
//! against light that is met by chance (multiple importance sampling, Veach 1997), with Russian roulette.
//!
//! Lights are asked at every surface. What shines by itself, objects and the sky, is seen after at most as many
//! bounces as the quality allows; asking for its light takes one. Ambient light counts as emission, and
//! highlights show no more than what is asked. Mirrors, boundaries and what is transparent are followed as they
//! are; shadow rays pass what is transparent and, if the settings say so, what refracts.

use super::coincident::Crossed;
use super::lights::seen;
use super::luminaires::Luminaires;
use super::media::Media;
use super::scatter::{Kind, Scatter, scatter, scatter_density};
use super::spawn::{spawn, spawn_gathering};
use super::throughput::Throughput;
use super::tracer::{Dice, Face, Met, Tracer, Work};
use crate::camera::{Beam, Ray};
use crate::color::Rgb;
use crate::counters::RayCounts;
use crate::math::DVec3;
use crate::quality::PathSettings;
use crate::sampling::Use;

/// The integrator over one frame's scene.
pub struct Paths<'a> {
    luminaires: Luminaires<'a>,
    settings: PathSettings,
}

/// Where a path is.
struct Path {
    ray: Ray,
    beam: Beam,
    throughput: Throughput,
    media: Media,
    /// What the ray has just passed.
    crossed: Option<Crossed>,
    /// Bounces that are left.
    left: u32,
    /// Where the direction was drawn, and with which density per solid angle; none where there was no choice.
    drawn: Option<(DVec3, f64)>,
    /// The last surface that has turned the path back, if it has scattered it: then light was asked for there.
    asked: Option<DVec3>,
    /// Whether light that is met now has been counted by a shadow ray from there, through what refracts.
    counted: bool,
}

impl<'a> Paths<'a> {
    pub fn new(tracer: &Tracer<'a>, settings: PathSettings) -> Self {
        Self { luminaires: Luminaires::new(tracer), settings }
    }

    /// Adds what is seen along a camera's ray to `work`.
    pub fn follow(&self, tracer: &Tracer, (ray, beam): (Ray, Beam), mut dice: Dice, work: &mut Work) {
        let mut path = Path {
            ray,
            beam,
            throughput: Throughput::showing(Rgb::ONE),
            media: Media::default(),
            crossed: None,
            left: tracer.quality.bounces,
            drawn: None,
            asked: None,
            counted: false,
        };
        while self.step(tracer, &mut path, dice, work) {
            dice.surface += 1;
        }
    }

    /// Goes on to the next surface and from there; false at the path's end.
    fn step(&self, tracer: &Tracer, path: &mut Path, dice: Dice, work: &mut Work) -> bool {
        let met = tracer.lying_in(path.crossed.as_ref(), path.beam.width).unwrap_or_else(|| {
            path.crossed = None;
            let (met, way) = tracer.advance((&path.ray, &path.beam), &path.media, &path.throughput, work);
            path.throughput.go(way);
            met
        });
        match met {
            Met::Nothing => {
                let weight =
                    self.met_weight(path, |_| self.luminaires.sky_density(tracer, path.ray.direction));
                tracer.add_sky(&path.ray, path.throughput.shining() * weight, path.left, work);
                false
            }
            Met::Light { index, outside, surface, hit } => {
                let light = &tracer.scene.shading.lights[index as usize];
                let density = |from| self.luminaires.density(tracer, from, &hit, &surface);
                let weight = self.met_weight(path, density);
                work.add(light.layer, path.throughput.shining() * seen(light, outside) * weight);
                false
            }
            Met::Surface(face) => {
                path.beam.width = face.width;
                self.at_surface(tracer, path, &face, dice, work)
            }
        }
    }

    /// What light that was met counts, against the density with which it was asked for: the balance heuristic.
    /// None is asked for what can only be met.
    fn met_weight(&self, path: &Path, asked: impl Fn(DVec3) -> Option<f64>) -> f32 {
        if let Some(from) = path.asked.filter(|_| path.counted) {
            return if asked(from).is_some() { 0.0 } else { 1.0 };
        }
        let Some((from, density)) = path.drawn else { return 1.0 };
        asked(from).map_or(1.0, |asked| (density / (density + asked)) as f32)
    }

    fn at_surface(&self, tracer: &Tracer, path: &mut Path, face: &Face, dice: Dice, work: &mut Work) -> bool {
        let boundary = tracer.boundary(face, &path.media);
        if let Some(boundary) = boundary.filter(|boundary| boundary.hidden) {
            path.crossed = Some(face.crossed(path.crossed, path.ray.direction));
            path.ray = Tracer::straight_on(face, &path.ray);
            path.media = boundary.passed;
            return true;
        }
        let density = |from| self.luminaires.density(tracer, from, &face.hit, &face.surface);
        tracer.add_ambient(face, path.throughput.seen(), work);
        tracer.add_emission(face, path.throughput.shining() * self.met_weight(path, density), work);
        self.ask_for_light(tracer, path, face, dice, work);
        let seen = face.seen(&path.ray);
        let u = dice.sampler.four(Use::Scatter(dice.surface));
        let Some(next) = scatter(&seen, boundary.as_ref(), u) else { return false };
        let goes_on = self.go_on(path, face, &next) && self.survives(tracer, path, dice);
        if goes_on {
            count(next.kind, &mut work.counts.rays);
        }
        goes_on
    }

    /// Light from every layer's sources, as far as it arrives.
    fn ask_for_light(&self, tracer: &Tracer, path: &Path, face: &Face, dice: Dice, work: &mut Work) {
        if !face.lobes.reflects_lights() {
            return;
        }
        let seen = face.seen(&path.ray);
        let throughput = path.throughput.seen();
        self.luminaires.ask(tracer, &seen, dice, path.left == 0, |asked| {
            let arrival = &asked.arrival;
            let reflected = seen.reflected(arrival.direction);
            // At the last surface of a path nothing is met by chance any more.
            let met = if path.left > 0 { scatter_density(&seen, arrival.direction) } else { 0.0 };
            let weight = arrival.density.map_or(1.0, |density| density / (density + met)) as f32;
            let scattered = reflected.scattered(tracer.clearness(arrival, seen.surface));
            let share = scattered + reflected.highlight;
            if share == Rgb::ZERO || arrival.radiance == Rgb::ZERO {
                return;
            }
            let passing = tracer.passing(arrival, seen.surface, &path.media, work);
            if passing.whole != Rgb::ZERO {
                // Only what comes unbent may also be met.
                let share = share * passing.whole - scattered * passing.unbent * (1.0 - weight);
                work.add(asked.layer, throughput * share * arrival.radiance);
            }
        });
    }

    fn go_on(&self, path: &mut Path, face: &Face, next: &Scatter) -> bool {
        match next.kind {
            Kind::Unbent => path.throughput.dim(next.shows),
            Kind::Bent | Kind::Mirrored | Kind::Scattered => path.throughput.leave(next.gathers, next.shows),
        }
        // At least as much as reaches the eye of anything else.
        if path.throughput.shining() == Rgb::ZERO {
            return false;
        }
        path.crossed = match next.kind {
            Kind::Unbent | Kind::Bent => Some(face.crossed(path.crossed, next.direction)),
            Kind::Mirrored | Kind::Scattered => None,
        };
        path.ray = match next.kind {
            Kind::Scattered => spawn_gathering(&face.surface, next.direction),
            Kind::Unbent | Kind::Bent | Kind::Mirrored => spawn(&face.surface, next.direction),
        };
        path.media = next.media.unwrap_or(path.media);
        match next.kind {
            // Straight on: what was drawn before still leads there, and no bounce is taken.
            Kind::Unbent => return true,
            Kind::Bent => path.counted |= self.settings.refractive_shadows && path.asked.is_some(),
            // No shadow ray goes by a mirror.
            Kind::Mirrored => (path.asked, path.counted) = (None, false),
            Kind::Scattered => (path.asked, path.counted) = (Some(face.surface.point), false),
        }
        path.drawn = next.density.map(|density| (face.surface.point, density));
        let left = path.left.checked_sub(1);
        path.left = left.unwrap_or(0);
        left.is_some()
    }

    /// Russian roulette: dim paths end at random, and those that go on make up for them.
    fn survives(&self, tracer: &Tracer, path: &mut Path, dice: Dice) -> bool {
        let Some(after) = self.settings.roulette else { return true };
        if tracer.quality.bounces - path.left <= after {
            return true;
        }
        let chance = path.throughput.shining().max_element().min(0.95);
        if dice.sampler.two(Use::Roulette(dice.surface)).x >= f64::from(chance) {
            return false;
        }
        path.throughput.make_up_for(chance);
        true
    }
}

fn count(kind: Kind, rays: &mut RayCounts) {
    match kind {
        Kind::Unbent | Kind::Bent => rays.transmitted += 1,
        Kind::Mirrored => rays.mirror += 1,
        Kind::Scattered => rays.scattered += 1,
    }
}
