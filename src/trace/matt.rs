//! Paths at surfaces that only gather light and scatter it evenly, which most surfaces are: eight at a time.
//!
//! Every number is that of `path` and `scatter`, lane by lane, so that pictures do not tell which of them computed it.

use super::path::{Path, Paths};
use super::together::{Arrivals, Color, Starts};
use super::tracer::{Tracer, Work};
use super::wave::Shadow;
use crate::bvh::Hit;
use crate::camera::Ray;
use crate::color::Rgb;
use crate::light::Light;
use crate::material::{MadeOf, Material};
use crate::math::{DVec3, cos_sin_of_turns};
use crate::sampling::{Sampler, Use};
use crate::scene::{Finish, Primitive};
use crate::shape::{Rays, Shape, Surface, Surfaces, lanes, on_spheres};
use crate::simd::{self, Lanes, Octo, Rows, Vector, dispatch};
use std::f64::consts::PI;

/// What is settled once for a frame.
pub struct Matt {
    /// Whether each material is such a surface's.
    materials: Vec<bool>,
    /// All there is to ask for light.
    lights: Vec<Light>,
}

/// Eight paths or fewer, and what they hit.
pub struct Eight<'a, 't> {
    pub integrator: &'a Paths<'t>,
    pub tracer: &'a Tracer<'t>,
    pub paths: &'a mut [Path],
    /// Places of these paths among all, and what each has hit. There is at least one.
    pub which: &'a [u32],
    pub hits: &'a [Hit],
}

impl Matt {
    /// For scenes without fog whose lights are none or have no area. `lights` are all that is asked for light, in their
    /// order.
    pub fn new(tracer: &Tracer, lights: Option<Vec<Light>>) -> Option<Self> {
        let lights = lights.filter(|lights| lights.is_empty() || !tracer.clear && !tracer.media)?;
        let materials = tracer.scene.shading.materials.iter().map(is_matt).collect();
        tracer.fog.is_none().then_some(Self { materials, lights })
    }

    /// Whether a path that has hit this is at such a surface.
    pub fn takes(&self, tracer: &Tracer, path: &Path, hit: &Hit) -> bool {
        let primitive = &tracer.scene.geometry.primitives[hit.primitive as usize];
        let Finish::Material(MadeOf::One(material)) = primitive.finish else { return false };
        self.materials[material as usize] && path.crossed.is_none() && path.media.is_outside()
    }

    /// Takes paths to where they go on; gives a bit for each that does.
    pub fn follow(&self, eight: Eight, work: &mut Work) -> u32 {
        dispatch(Follow { matt: self, eight, work })
    }
}

fn is_matt(material: &Material) -> bool {
    let lobes = &material.lobes;
    let others = [lobes.emission, lobes.specular, lobes.mirror, lobes.transparency, lobes.refraction];
    let alone = others.iter().all(|lobe| *lobe == Rgb::ZERO) && lobes.microfacet == 0.0;
    alone && !lobes.is_fuzzy() && lobes.diffuse != Rgb::ZERO && material.paints.is_empty()
}

struct Follow<'a, 'b, 't> {
    matt: &'a Matt,
    eight: Eight<'b, 't>,
    work: &'a mut Work,
}

/// The surfaces that eight paths have come to, turned towards where these came from.
struct Ground<L: Lanes> {
    surfaces: Surfaces,
    /// From points to the smooth surfaces that they stand for, if that is anywhere.
    lift: Option<Rows>,
    /// To shade with.
    normal: Vector<L::Quad>,
    diffuse: Color<L>,
}

/// Up to eight paths in lanes; lanes without a path repeat the last one.
struct Lined {
    /// Places of the paths among all.
    places: [usize; 8],
    rays: [Ray; 8],
    at: [Hit; 8],
    /// A bit for each lane that has a path of its own.
    there: u32,
}

impl Lined {
    #[inline(always)]
    fn of(eight: &Eight) -> Self {
        let Eight { paths, which, hits, .. } = eight;
        let last = which.len() - 1;
        let mut places = [0; 8];
        let mut rays = [paths[which[last] as usize].ray; 8];
        let mut at = [hits[last]; 8];
        for lane in 0..8 {
            let from = lane.min(last);
            places[lane] = which[from] as usize;
            rays[lane] = paths[places[lane]].ray;
            at[lane] = hits[from];
        }
        Self { places, rays, at, there: 0xff >> (7 - last.min(7)) }
    }
}

impl simd::Work for Follow<'_, '_, '_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(mut self) -> u32 {
        let lined = Lined::of(&self.eight);
        let ground = Ground::<L>::of(self.eight.tracer, &Rays::of(&lined.rays), &lined.at);
        let gathering = Starts::gathering(&ground.surfaces, ground.lift.as_ref());
        self.arrive(&lined);
        self.ask_for_light(&lined, &ground, &gathering);
        self.scatter(&lined, &ground, &gathering)
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
                let lobes = &tracer.material_of(at).lobes;
                self.work.add(ambient.layer, path.throughput.seen() * lobes.ambient * ambient.radiance);
            }
        }
    }

    /// Puts off a shadow ray to every light that would be reflected.
    #[inline(always)]
    fn ask_for_light<L: Lanes>(&mut self, lined: &Lined, ground: &Ground<L>, gathering: &Starts<L::Quad>) {
        for (turn, light) in (0..).zip(&self.matt.lights) {
            let (arrivals, arriving) = Arrivals::<L>::of(light, gathering.point);
            let (_, share, lit) = ground.reflected(arrivals.direction, lined.there & arriving);
            if lit == 0 {
                continue;
            }
            let (shadow, t_max) = arrivals.shadow_rays(gathering);
            for lane in lanes(lit) {
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

    /// Sends paths on, evenly over the hemisphere; gives a bit for each that goes on.
    #[inline(always)]
    fn scatter<L: Lanes>(self, lined: &Lined, ground: &Ground<L>, gathering: &Starts<L::Quad>) -> u32 {
        let Self { eight: Eight { integrator, tracer, paths, .. }, work, .. } = self;
        let places = &lined.places;
        let mut further = 0;
        for lane in lanes(lined.there) {
            further |= u32::from(paths[places[lane]].left > 0) << lane;
        }
        if further == 0 {
            return 0;
        }
        // All that are followed at once have met as many surfaces.
        let surface = paths[places[0]].dice.surface;
        let mut samplers = [paths[places[0]].dice.sampler; 8];
        for lane in 0..8 {
            samplers[lane] = paths[places[lane]].dice.sampler;
        }
        let [_, u, v, _] = Sampler::four_together(&samplers, Use::Scatter(surface));
        let direction = cosine_hemisphere(ground.normal, Octo::load(&u), Octo::load(&v));
        let (cosine, share, lit) = ground.reflected(direction, further);
        let density = cosine.larger(Octo::splat(0.0)) / Octo::splat(PI);
        let each = (Octo::splat(1.0) / (Octo::splat(PI) * density)).narrow();
        let gathers = share.scaled(L::load(&each));
        let further_on = Rays { origin: gathering.towards(direction).store(), direction: direction.store() };
        let density = density.store();
        let mut on = 0;
        for lane in lanes(lit) {
            let path = &mut paths[places[lane]];
            path.throughput.leave(gathers.one(lane), Rgb::ZERO);
            if density[lane] <= 0.0 || path.throughput.shining() == Rgb::ZERO {
                continue;
            }
            path.ray = further_on.one(lane);
            let point = ground.surfaces.point.one(lane);
            path.scattered(point, density[lane]);
            if integrator.survives(tracer, path) {
                work.counts.rays.scattered += 1;
                on |= 1 << lane;
            }
        }
        on
    }
}

impl<L: Lanes> Ground<L> {
    #[inline(always)]
    fn of(tracer: &Tracer, rays: &Rays, at: &[Hit; 8]) -> Self {
        let (mut surfaces, lift) = surfaces::<L>(tracer, rays, at);
        let direction = Vector::<L::Quad>::load(&rays.direction);
        let (normal, shading) = (Vector::load(&surfaces.normal), Vector::load(&surfaces.shading));
        let zero = Octo::splat(0.0);
        let outside = normal.dot(direction).at_most(zero);
        let (normal, shading) = (normal.pick(outside, -normal), shading.pick(outside, -shading));
        (surfaces.normal, surfaces.shading) = (normal.store(), shading.store());
        let normal = shading.pick(zero.below(shading.dot(-direction)), normal);
        let mut diffuse = [[0.0; 8]; 3];
        for lane in 0..8 {
            let color = tracer.material_of(&at[lane]).lobes.diffuse;
            (diffuse[0][lane], diffuse[1][lane], diffuse[2][lane]) = (color.x, color.y, color.z);
        }
        Self { surfaces, lift, normal, diffuse: Color::load(&diffuse) }
    }

    /// The cosines of directions, the shares of light from them that are scattered, and a bit for each that is any.
    #[inline(always)]
    fn reflected(&self, to_light: Vector<L::Quad>, wanted: u32) -> (Octo<L::Quad>, Color<L>, u32) {
        let zero = Octo::splat(0.0);
        let cosine = self.normal.dot(to_light);
        let mut above = zero.below(Vector::load(&self.surfaces.normal).dot(to_light));
        if let Some(lift) = &self.lift {
            let lifted = zero.below(Vector::load(lift).longest());
            above = above | (lifted & zero.below(Vector::load(&self.surfaces.shading).dot(to_light)));
        }
        let share = self.diffuse.scaled(L::load(&cosine.narrow()));
        let lit = wanted & (zero.below(cosine) & above).bits();
        (cosine, share, lit & share.not_black())
    }
}

/// Where rays meet surfaces, and from there to the smooth ones that these stand for.
#[inline(always)]
fn surfaces<L: Lanes>(tracer: &Tracer, rays: &Rays, at: &[Hit; 8]) -> (Surfaces, Option<Rows>) {
    let primitives = &tracer.scene.geometry.primitives;
    let t = at.map(|hit| hit.at.t);
    if let Primitive { shape: Shape::Mesh(mesh), placement: None, .. } = &primitives[at[0].primitive as usize]
        && at.iter().all(|hit| hit.primitive == at[0].primitive)
        && let Some((surfaces, lift)) = mesh.surfaces_of::<L>(rays, &t, &at.map(|hit| hit.at.part))
    {
        let lifted = tracer.quality.smooth_terminator && lift.0.iter().flatten().any(|way| *way != 0.0);
        return (surfaces, lifted.then_some(lift));
    }
    let (mut centers, mut radii, mut spheres) = (Rows::ZERO, [0.0; 8], true);
    for lane in 0..8 {
        match &primitives[at[lane].primitive as usize] {
            Primitive { shape: Shape::Sphere(sphere), placement: None, .. } => {
                centers.set(lane, sphere.center);
                radii[lane] = sphere.radius;
            }
            _ => {
                spheres = false;
                break;
            }
        }
    }
    if spheres {
        return (on_spheres::<L>(&centers, &radii, rays, &t), None);
    }
    one_by_one(tracer, rays, at)
}

#[inline(never)]
fn one_by_one(tracer: &Tracer, rays: &Rays, at: &[Hit; 8]) -> (Surfaces, Option<Rows>) {
    let each: [Surface; 8] = std::array::from_fn(|lane| tracer.surface(&rays.one(lane), &at[lane]));
    let lift = each.map(|surface| surface.lift);
    let lifted = lift.iter().any(|lift| *lift != DVec3::ZERO);
    (Surfaces::of(&each), lifted.then(|| Rows::of(&lift)))
}

/// [`crate::sampling::cosine_hemisphere`] around normals, as [`crate::sampling::Frame`] turns it.
#[inline(always)]
fn cosine_hemisphere<Q: simd::Quad>(z: Vector<Q>, u: Octo<Q>, v: Octo<Q>) -> Vector<Q> {
    let (zero, one) = (Octo::splat(0.0), Octo::splat(1.0));
    let (cosine, sine) = cos_sin_of_turns(v);
    let radius = u.root();
    let (across, along, up) = (cosine * radius, sine * radius, (one - u).larger(zero).root());
    let sign = one.signed_like(z.z);
    let a = Octo::splat(-1.0) / (sign + z.z);
    let b = z.x * z.y * a;
    let x = Vector { x: one + sign * z.x * z.x * a, y: sign * b, z: -sign * z.x };
    let y = Vector { x: b, y: sign + z.y * z.y * a, z: -z.y };
    let x = x - z * x.dot(z);
    let y = y - z * y.dot(z);
    x * across + y * along + z * up
}
