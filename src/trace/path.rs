//! Path tracing: one path per sample, light asked for at every surface (next-event estimation), weighed
//! against light that is met by chance (multiple importance sampling, Veach 1997), with Russian roulette.
//!
//! Every surface that reflects light on its way asks all sources for light, and sends the path on. The ray behind the
//! last of them, which the quality sets, only sees what gives off light, so that what is asked and what is met are weighed
//! against each other there as everywhere else. Ambient light is reflected, so it counts at surfaces that reflect, and
//! highlights show no more than what is asked. Mirrors, boundaries and what is transparent are followed as they
//! are; shadow rays pass what is transparent and, if the settings say so, what refracts.

use super::escape;
use super::lights::seen;
use super::luminaires::Luminaires;
use super::media::Media;
use super::one_lobe::{Eight, Lobe, OneLobe};
use super::place::Passed;
use super::scatter::{Kind, Scatter, scatter, scatter_density};
use super::spawn::{spawn, spawn_gathering, spawn_mirrored};
use super::throughput::Throughput;
use super::tracer::{Dice, Face, Met, Tracer, Work};
use super::wave::{Lists, Shadow, WAVE};
use crate::bvh::Hit;
use crate::camera::{Beam, Ray};
use crate::color::Rgb;
use crate::counters::RayCounts;
use crate::math::DVec3;
use crate::quality::PathSettings;
use crate::sampling::{Sampler, Use};
use crate::shape::Shape;

/// The integrator over one frame's scene.
pub struct Paths<'a> {
    luminaires: Luminaires<'a>,
    settings: PathSettings,
    /// For surfaces of which eight are shaded at once.
    one_lobe: Option<OneLobe>,
    /// Whether what the sky sends to paths that meet nothing is found for eight at once.
    skies: bool,
    /// Whether there are any.
    meshes: bool,
}

/// Where a path is.
pub struct Path {
    pub ray: Ray,
    /// Unit vector across the ray that it takes along for frames around normals (see [`Frame`](crate::sampling::Frame)).
    pub tangent: DVec3,
    pub beam: Beam,
    pub throughput: Throughput,
    pub media: Media,
    /// How far the ray has come, if it has passed something straight on.
    pub passed: Option<Passed>,
    /// Surfaces that are left to reflect or bend light.
    pub left: u32,
    /// The last surface that has turned the path back, if it has scattered it: then light was asked for there.
    asked: Option<DVec3>,
    /// The density per solid angle with which the direction was drawn there; none where there was no choice.
    density: Option<f64>,
    /// Whether light that is met now has been counted by a shadow ray from there, through what refracts.
    counted: bool,
    pub dice: Dice,
    /// Where the layers of its sample begin in what is worked with.
    pub first: usize,
}

impl Path {
    /// One that leads nowhere, until it begins.
    pub fn new(ray: Ray, sampler: Sampler) -> Self {
        Self {
            ray,
            tangent: DVec3::ZERO,
            beam: Beam::default(),
            throughput: Throughput::showing(Rgb::ONE),
            media: Media::default(),
            passed: None,
            left: 0,
            asked: None,
            density: None,
            counted: false,
            dice: Dice { sampler, surface: 0 },
            first: 0,
        }
    }

    /// Begins at the eye, but for its beam. Written field by field: what is put together elsewhere and copied has to be
    /// waited for.
    #[inline(always)]
    pub fn begin(&mut self, tracer: &Tracer, along: Ray, sampler: Sampler, layers: usize) {
        let Self {
            ray,
            tangent,
            beam: _,
            throughput,
            media,
            passed,
            left,
            asked,
            density,
            counted,
            dice,
            first,
        } = self;
        (*ray, *first) = (along, layers);
        *tangent = tracer.scene.camera.tangent(&along);
        throughput.begin();
        (*media, *passed) = (Media::default(), None);
        *left = tracer.quality.surfaces();
        (*asked, *density, *counted) = (None, None, false);
        *dice = Dice { sampler, surface: 0 };
    }

    /// Goes on from a point where it was scattered, with a density per solid angle of its direction.
    pub fn scattered(&mut self, ray: Ray, tangent: DVec3, point: DVec3, density: f64) {
        (self.ray, self.tangent, self.passed) = (ray, tangent, None);
        (self.asked, self.density, self.counted) = (Some(point), Some(density), false);
        self.left -= 1;
    }

    /// Goes on by a mirror, past which no shadow ray goes.
    pub fn mirrored(&mut self, ray: Ray, tangent: DVec3) {
        (self.ray, self.tangent, self.passed) = (ray, tangent, None);
        (self.asked, self.density, self.counted) = (None, None, false);
        self.left -= 1;
    }
}

impl<'a> Paths<'a> {
    pub fn new(tracer: &Tracer<'a>, settings: PathSettings) -> Self {
        let luminaires = Luminaires::new(tracer);
        let one_lobe = OneLobe::new(tracer, luminaires.plain_lights());
        let skies = !luminaires.sky_is_asked() && tracer.holdout.is_none();
        let mut primitives = tracer.scene.geometry.primitives.iter();
        let meshes = primitives.any(|primitive| matches!(primitive.shape, Shape::Mesh(_)));
        Self { luminaires, settings, one_lobe, skies, meshes }
    }

    /// Shades every path by itself.
    #[cfg(test)]
    pub fn one_by_one(&mut self) {
        (self.one_lobe, self.skies) = (None, false);
    }

    /// Follows paths from the eye to where they end, all of them from surface to surface. What is seen along them is added
    /// to `work`.
    pub fn follow(&self, tracer: &Tracer, paths: &mut [Path], work: &mut Work) {
        work.nesting.clear();
        let mut lists = std::mem::take(&mut work.lists);
        let Lists { active, hits, queues, escaped } = &mut lists;
        active.clear();
        active.extend(0..paths.len() as u32);
        let mut goes_on = [false; WAVE];
        let mut from_eye = true;
        while !active.is_empty() {
            tracer.meet(paths, active, from_eye, hits);
            if self.meshes {
                tracer.fetch(hits);
            }
            for ((slot, &index), hit) in (0..).zip(&*active).zip(&*hits) {
                let path = &mut paths[index as usize];
                if let (Some(hit), Some(one_lobe)) = (hit, &self.one_lobe)
                    && let Some(lobe) = one_lobe.at(tracer, path, hit)
                {
                    match path.left {
                        // These give off no light.
                        0 => goes_on[index as usize] = false,
                        _ => queues[lobe as usize].push(slot),
                    }
                    continue;
                }
                work.first = path.first;
                // Most paths end this way, and have not to go through all that others may meet.
                if hit.is_none() && path.passed.is_none() && path.media.is_outside() && tracer.fog.is_none() {
                    goes_on[index as usize] = false;
                    match self.skies {
                        true => escaped.push(index),
                        false => self.escape(tracer, path, work),
                    }
                    continue;
                }
                goes_on[index as usize] = self.step(tracer, path, *hit, work);
            }
            escape::add_sky(tracer, paths, escaped, work);
            escaped.clear();
            if let Some(one_lobe) = &self.one_lobe {
                for (lobe, queue) in Lobe::ALL.into_iter().zip(queues.iter_mut()) {
                    for which in queue.chunks(8) {
                        let eight = Eight { integrator: self, tracer, paths, active, hits, which };
                        let on = one_lobe.follow(lobe, eight, work);
                        for (lane, slot) in which.iter().enumerate() {
                            goes_on[active[*slot as usize] as usize] = on >> lane & 1 == 1;
                        }
                    }
                    queue.clear();
                }
            }
            active.retain(|&index| {
                paths[index as usize].dice.surface += 1;
                goes_on[index as usize]
            });
            let mut shadows = std::mem::take(&mut work.shadows);
            tracer.cast(&mut shadows, from_eye, work);
            work.shadows = shadows;
            from_eye = false;
        }
        work.lists = lists;
    }

    /// Goes on to the next surface and from there; false at the path's end. `hit` is what lies ahead of a ray that has not
    /// passed anything.
    fn step(&self, tracer: &Tracer, path: &mut Path, hit: Option<Hit>, work: &mut Work) -> bool {
        let along = (&path.ray, &path.beam, path.passed, path.left);
        let (met, way) = tracer.advance(along, || hit, path.media, &path.throughput, work);
        path.throughput.go(way);
        match met {
            Met::Nothing => {
                self.escape(tracer, path, work);
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
                self.at_surface(tracer, path, &face, work)
            }
        }
    }

    /// Adds what the sky sends to a path that has met nothing.
    fn escape(&self, tracer: &Tracer, path: &Path, work: &mut Work) {
        let weight = self.met_weight(path, |_| self.luminaires.sky_density(tracer, path.ray.direction));
        tracer.add_sky(&path.ray, path.throughput.shining() * weight, path.left, work);
    }

    /// What light that was met counts, against the density with which it was asked for: the balance heuristic.
    /// None is asked for what can only be met.
    fn met_weight(&self, path: &Path, asked: impl Fn(DVec3) -> Option<f64>) -> f32 {
        if let Some(from) = path.asked.filter(|_| path.counted) {
            return if asked(from).is_some() { 0.0 } else { 1.0 };
        }
        let Some((from, density)) = path.asked.zip(path.density) else { return 1.0 };
        asked(from).map_or(1.0, |asked| (density / (density + asked)) as f32)
    }

    fn at_surface(&self, tracer: &Tracer, path: &mut Path, face: &Face, work: &mut Work) -> bool {
        let dice = path.dice;
        let boundary = face.boundary.as_ref();
        if let Some(boundary) = boundary.filter(|boundary| boundary.hidden) {
            (path.passed, path.media) = (Some(face.passed), boundary.passed);
            return true;
        }
        let density = |from| self.luminaires.density(tracer, from, &face.hit, &face.surface);
        if path.left > 0 {
            tracer.add_ambient(face, path.throughput.seen(), work);
        }
        tracer.add_emission(face, path.throughput.shining() * self.met_weight(path, density), work);
        if path.left > 0 {
            self.ask_for_light(tracer, path, face, dice, work);
        }
        // Where nothing would be found by going on, only what is passed straight on leads further.
        let turns = tracer.goes_on(path.left);
        if !turns && face.lobes.transparency == Rgb::ZERO {
            return false;
        }
        let seen = face.seen(&path.ray, path.tangent);
        let u = dice.sampler.four(Use::Scatter(dice.surface));
        let next = scatter(&seen, boundary, u);
        let Some(next) = next.filter(|next| turns || next.kind == Kind::Unbent) else { return false };
        let goes_on = self.go_on(path, face, &next) && self.survives(tracer, path);
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
        let seen = face.seen(&path.ray, path.tangent);
        let throughput = path.throughput.seen();
        let mut turn = 0;
        self.luminaires.ask(tracer, &seen, dice, |asked| {
            let arrival = &asked.arrival;
            work.counts.evaluations.light_samples += u64::from(arrival.density.is_some());
            let reflected = seen.reflected(arrival.direction);
            let weigh = |density| density / (density + scatter_density(&seen, arrival.direction));
            let weight = arrival.density.map_or(1.0, weigh) as f32;
            let scattered = reflected.scattered(tracer.clearness(arrival, seen.surface, work));
            let share = scattered + reflected.highlight;
            if share == Rgb::ZERO || arrival.radiance == Rgb::ZERO {
                return;
            }
            turn += 1;
            if !tracer.clear && !tracer.media {
                let share = share - scattered * (1.0 - weight);
                let radiance = throughput * share * arrival.radiance;
                work.shadows.push(Shadow::new(arrival, seen.surface, (asked.layer, turn), radiance, work));
                return;
            }
            let passing = tracer.passing(arrival, seen.surface, path.media, work);
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
        if let Some(media) = next.media {
            path.media = media;
        }
        let ray = match next.kind {
            // Straight on: what was drawn before still leads there, and no bounce is taken.
            Kind::Unbent => {
                path.passed = Some(face.passed);
                return true;
            }
            Kind::Bent => {
                path.counted |= self.settings.refractive_shadows && path.asked.is_some();
                spawn(&face.surface, next.direction)
            }
            // No shadow ray goes by a mirror.
            Kind::Mirrored => {
                (path.asked, path.counted) = (None, false);
                spawn_mirrored(&face.surface, next.direction)
            }
            Kind::Scattered => {
                (path.asked, path.counted) = (Some(face.surface.point), false);
                spawn_gathering(&face.surface, next.direction)
            }
        };
        path.tangent = face.seen(&path.ray, path.tangent).frame().tangent(ray.direction);
        path.ray = ray;
        path.passed = None;
        path.density = next.density;
        path.left -= 1;
        true
    }

    /// Russian roulette: dim paths end at random, and those that go on make up for them.
    pub fn survives(&self, tracer: &Tracer, path: &mut Path) -> bool {
        let Some(after) = self.settings.roulette else { return true };
        if tracer.quality.surfaces() - path.left <= after {
            return true;
        }
        let chance = path.throughput.shining().max_element().min(0.95);
        if path.dice.sampler.two(Use::Roulette(path.dice.surface)).x >= f64::from(chance) {
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
