//! Paths at surfaces of one lobe, which most surfaces are: matt ones and mirrors, eight of a kind at a time.
//!
//! Every number is that of `path` and `scatter`, lane by lane, so that pictures do not tell which of them computed it.

mod even;
mod fuzzy;
mod ground;

use super::path::{Path, Paths};
use super::together::{Arrivals, Color, Starts};
use super::tracer::{Tracer, Work};
use super::wave::Shadow;
use crate::bvh::Hit;
use crate::color::Rgb;
use crate::light::Light;
use crate::material::{Lobes, MadeOf, Material};
use crate::sampling::{Frame, Sampler, Use};
use crate::scene::Finish;
use crate::shape::{Crossing, Rays, lanes};
use crate::simd::{self, Lanes, Octo, Rows, Vector, dispatch};
use even::Even;
use fuzzy::Fuzzy;
use ground::Ground;
use std::f64::consts::PI;

/// The lobe of a surface that has no other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// Gathers light and scatters it evenly.
    Even,
    /// A mirror that scatters.
    Fuzzy,
    Mirror,
}

impl Lobe {
    pub const ALL: [Self; 3] = [Self::Even, Self::Fuzzy, Self::Mirror];

    fn of(material: &Material) -> Option<Self> {
        let lobes = &material.lobes;
        let others = [lobes.emission, lobes.specular, lobes.transparency, lobes.refraction];
        let absent = others.iter().all(|lobe| *lobe == Rgb::ZERO) && lobes.microfacet == 0.0;
        // Shares of what has overflowed are not what they are alone.
        let finite = lobes.diffuse.is_finite() && lobes.mirror.is_finite();
        if !absent || !finite || !material.paints.is_empty() {
            return None;
        }
        match [lobes.diffuse != Rgb::ZERO, lobes.mirror != Rgb::ZERO] {
            [true, false] if !lobes.is_fuzzy() => Some(Self::Even),
            [false, true] if lobes.is_fuzzy() => Some(Self::Fuzzy),
            [false, true] => Some(Self::Mirror),
            _ => None,
        }
    }
}

/// What is settled once for a frame.
pub struct OneLobe {
    /// That of each material, if it has only one.
    materials: Vec<Option<Lobe>>,
    /// All there is to ask for light.
    lights: Vec<Light>,
}

/// Eight paths or fewer, and what they hit.
pub struct Eight<'a, 't> {
    pub integrator: &'a Paths<'t>,
    pub tracer: &'a Tracer<'t>,
    pub paths: &'a mut [Path],
    /// Places of paths that go on among all, and what each of them has hit.
    pub active: &'a [u32],
    pub hits: &'a [Option<Hit>],
    /// Which of those these are. There is at least one.
    pub which: &'a [u32],
}

impl OneLobe {
    /// For scenes without fog whose lights are none or have no area. `lights` are all that is asked for light, in their
    /// order.
    pub fn new(tracer: &Tracer, lights: Option<Vec<Light>>) -> Option<Self> {
        let lights = lights.filter(|lights| lights.is_empty() || !tracer.clear && !tracer.media)?;
        let materials = tracer.scene.shading.materials.iter().map(Lobe::of).collect();
        tracer.fog.is_none().then_some(Self { materials, lights })
    }

    /// The lobe of what a path has hit, if it has come to a surface of one.
    pub fn at(&self, tracer: &Tracer, path: &Path, hit: &Hit) -> Option<Lobe> {
        let primitive = &tracer.scene.geometry.primitives[hit.primitive as usize];
        let Finish::Material(MadeOf::One(material)) = primitive.finish else { return None };
        let simple = !hit.at.crowded && path.passed.is_none() && path.media.is_outside();
        self.materials[material as usize].filter(|_| simple)
    }

    /// Takes paths at surfaces of a lobe to where they go on; gives a bit for each that does.
    pub fn follow(&self, lobe: Lobe, eight: Eight, work: &mut Work) -> u32 {
        dispatch(Follow { lights: &self.lights, lobe, eight, work })
    }
}

/// How a lobe scatters light from and to eight surfaces.
trait Scatters<L: Lanes> {
    /// Whether it gathers light, or else shows it.
    const GATHERS: bool;

    fn of(ground: &Ground<L::Quad>, lobes: &[&Lobes; 8]) -> Self;

    /// The shares of light from directions that are scattered, where it falls on what is seen; cosines are those of the
    /// directions to the normals.
    fn share(&self, to_light: Vector<L::Quad>, cosine: Octo<L::Quad>) -> Color<L>;

    /// Directions for rows of numbers in 0..1, in frames around the normals.
    fn draw(
        &self,
        ground: &Ground<L::Quad>,
        frame: &Frame<Vector<L::Quad>>,
        numbers: &[[f64; 8]; 4],
    ) -> Drawn<L>;
}

/// Eight directions that were drawn.
struct Drawn<L: Lanes> {
    direction: Vector<L::Quad>,
    /// Per solid angle.
    density: Octo<L::Quad>,
    /// Of the light from there, what is scattered.
    share: Color<L>,
    /// A bit for each from which light falls on what is seen.
    lit: u32,
}

struct Follow<'a, 'b, 't> {
    lights: &'a [Light],
    lobe: Lobe,
    eight: Eight<'b, 't>,
    work: &'a mut Work,
}

/// Up to eight paths in lanes; lanes without a path repeat the last one.
struct Lined<'a> {
    /// Places of the paths among all.
    places: [usize; 8],
    rays: Rays,
    tangents: Rows,
    at: [Hit; 8],
    lobes: [&'a Lobes; 8],
    /// A bit for each lane that has a path of its own.
    there: u32,
}

impl<'a> Lined<'a> {
    #[inline(always)]
    fn of(eight: &Eight<'_, 'a>) -> Self {
        let Eight { tracer, paths, active, hits, which, .. } = eight;
        let last = which.len() - 1;
        let (mut places, mut at) = ([0; 8], [Hit { at: Crossing::at(0.0), primitive: 0 }; 8]);
        let mut lobes = [&tracer.scene.shading.materials[0].lobes; 8];
        for lane in 0..8 {
            let which = which[lane.min(last)] as usize;
            places[lane] = active[which] as usize;
            if let Some(hit) = &hits[which] {
                (at[lane], lobes[lane]) = (*hit, &tracer.material_of(hit).lobes);
            }
        }
        let rays = Rays::gather(8, |lane| &paths[places[lane]].ray);
        let mut tangents = Rows::ZERO;
        for lane in 0..8 {
            tangents.set(lane, paths[places[lane]].tangent);
        }
        Self { places, rays, tangents, at, lobes, there: 0xff >> (7 - last.min(7)) }
    }
}

impl simd::Work for Follow<'_, '_, '_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(mut self) -> u32 {
        let lined = Lined::of(&self.eight);
        let ground = Ground::of::<L>(self.eight.tracer, &lined.rays, &lined.at);
        self.arrive(&lined);
        match self.lobe {
            Lobe::Even => self.gather::<L, Even<L>>(&lined, &ground),
            Lobe::Fuzzy => self.gather::<L, Fuzzy<L>>(&lined, &ground),
            Lobe::Mirror => self.reflect::<L>(&lined, &ground),
        }
    }
}

impl Follow<'_, '_, '_> {
    /// What is so at the surfaces whatever lights there are: how wide beams are, and ambient light.
    #[inline(always)]
    fn arrive(&mut self, lined: &Lined) {
        let Eight { tracer, paths, .. } = &mut self.eight;
        for lane in lanes(lined.there) {
            let (path, at) = (&mut paths[lined.places[lane]], &lined.at[lane]);
            path.beam.width = path.beam.after(at.at.t);
            if let Some(ambient) = &tracer.ambient {
                self.work.first = path.first;
                let share = lined.lobes[lane].ambient;
                self.work.add(ambient.layer, path.throughput.seen() * share * ambient.radiance);
            }
        }
    }

    /// A bit for each path that would find something by going on.
    #[inline(always)]
    fn further(&self, lined: &Lined) -> u32 {
        let Eight { tracer, paths, .. } = &self.eight;
        let mut further = 0;
        for lane in lanes(lined.there) {
            further |= u32::from(tracer.goes_on(paths[lined.places[lane]].left)) << lane;
        }
        further
    }

    /// At surfaces that scatter: asks for light, and goes on.
    #[inline(always)]
    fn gather<L: Lanes, S: Scatters<L>>(mut self, lined: &Lined, ground: &Ground<L::Quad>) -> u32 {
        let scatters = S::of(ground, &lined.lobes);
        let starts = Starts::gathering(&ground.surfaces, ground.lift.as_ref());
        self.ask_for_light(lined, ground, &scatters, &starts);
        self.scatter(lined, ground, &scatters, &starts)
    }

    /// Puts off a shadow ray to every light that would be reflected.
    #[inline(always)]
    fn ask_for_light<L: Lanes>(
        &mut self,
        lined: &Lined,
        ground: &Ground<L::Quad>,
        scatters: &impl Scatters<L>,
        starts: &Starts<L::Quad>,
    ) {
        for (turn, light) in (0..).zip(self.lights) {
            let (arrivals, arriving) = Arrivals::<L>::of(light, starts.point);
            let (cosine, facing) = ground.cosines(arrivals.direction);
            let lit = lined.there & arriving & facing;
            if lit == 0 {
                continue;
            }
            let share = scatters.share(arrivals.direction, cosine);
            let (shadow, t_max) = arrivals.shadow_rays(starts);
            for lane in lanes(lit & share.not_black()) {
                let path = &self.eight.paths[lined.places[lane]];
                let (share, radiance) = (share.one(lane), arrivals.radiance.one(lane));
                if radiance == Rgb::ZERO {
                    continue;
                }
                let radiance = path.throughput.seen() * share * radiance;
                let (ray, first, layer) = (shadow.one(lane), path.first, light.layer);
                self.work.shadows.push(Shadow { ray, t_max, first, layer, turn, radiance });
            }
        }
    }

    /// Sends paths on in directions that are drawn; gives a bit for each that goes on.
    #[inline(always)]
    fn scatter<L: Lanes, S: Scatters<L>>(
        self,
        lined: &Lined,
        ground: &Ground<L::Quad>,
        scatters: &S,
        starts: &Starts<L::Quad>,
    ) -> u32 {
        let further = self.further(lined);
        if further == 0 {
            return 0;
        }
        let Self { eight: Eight { integrator, tracer, paths, .. }, work, .. } = self;
        let places = &lined.places;
        // All that are followed at once have met as many surfaces.
        let surface = paths[places[0]].dice.surface;
        let mut samplers = [paths[places[0]].dice.sampler; 8];
        for lane in 0..8 {
            samplers[lane] = paths[places[lane]].dice.sampler;
        }
        let numbers = Sampler::four_together(&samplers, Use::Scatter(surface));
        let frame = ground.frame(&lined.tangents);
        let Drawn { direction, density, share, lit } = scatters.draw(ground, &frame, &numbers);
        let each = (Octo::splat(1.0) / (Octo::splat(PI) * density)).narrow();
        let drawn = Octo::splat(0.0).below(density).bits();
        let on = further & lit & drawn & share.not_black();
        let share = share.scaled(L::load(&each));
        let rays = Rays { origin: starts.towards(direction).store(), direction: direction.store() };
        let (tangents, density) = (frame.tangent(direction).store(), density.store());
        let mut goes_on = 0;
        for lane in lanes(on) {
            let path = &mut paths[places[lane]];
            let share = share.one(lane);
            match S::GATHERS {
                true => path.throughput.leave(share, Rgb::ZERO),
                false => path.throughput.leave(Rgb::ZERO, share),
            }
            if path.throughput.shining() == Rgb::ZERO {
                continue;
            }
            path.scattered(
                rays.one(lane),
                tangents.one(lane),
                ground.surfaces.point.one(lane),
                density[lane],
            );
            if integrator.survives(tracer, path) {
                work.counts.rays.scattered += 1;
                goes_on |= 1 << lane;
            }
        }
        goes_on
    }

    /// Sends paths on by mirrors; gives a bit for each that goes on.
    #[inline(always)]
    fn reflect<L: Lanes>(self, lined: &Lined, ground: &Ground<L::Quad>) -> u32 {
        let further = self.further(lined);
        let Self { eight: Eight { integrator, tracer, paths, .. }, work, .. } = self;
        let starts = Starts::gathering(&ground.surfaces, ground.lift.as_ref());
        let rays = starts.mirrored(ground.mirrored());
        let tangents = ground.frame(&lined.tangents).tangent(Vector::load(&rays.direction)).store();
        let mut goes_on = 0;
        for lane in lanes(further) {
            let path = &mut paths[lined.places[lane]];
            path.throughput.leave(Rgb::ZERO, lined.lobes[lane].mirror);
            if path.throughput.shining() == Rgb::ZERO {
                continue;
            }
            path.mirrored(rays.one(lane), tangents.one(lane));
            if integrator.survives(tracer, path) {
                work.counts.rays.mirror += 1;
                goes_on |= 1 << lane;
            }
        }
        goes_on
    }
}
