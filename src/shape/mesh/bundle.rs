//! Eight rays and one mesh: they share the nodes of its tree and what has to be known of each triangle.

use super::{Any, Mesh, Nearest};
use crate::mesh::ShearedRays;
use crate::shape::bundle::Hit;
use crate::shape::{Crossing, Crossings, Geometric, Rays, Triangle, lanes};
use crate::simd::{Lanes, Octo, Work, dispatch};
use crate::tree::{Branch, BundleLeaves, BundleSlabs, Probe, Slabs, Vicinities, Vicinity};

impl Mesh {
    /// [`Geometric::hit`] of those of eight rays whose bits are set, which should go the same way.
    pub fn hit_of(&self, rays: &Rays, wanted: u32, t_max: &[f64; 8]) -> Crossings {
        dispatch(Hit { shape: self, rays, wanted, limit: t_max })
    }

    /// [`Geometric::blocks`] likewise, a bit each.
    pub fn blocks_of(&self, rays: &Rays, wanted: u32, t_max: &[f64; 8]) -> u32 {
        dispatch(Blocked { mesh: self, rays, wanted, t_max })
    }
}

/// Whether rays meet a mesh.
pub struct Blocked<'a> {
    pub mesh: &'a Mesh,
    pub rays: &'a Rays,
    pub wanted: u32,
    pub t_max: &'a [f64; 8],
}

impl Work for Hit<'_, Mesh> {
    type Output = Crossings;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Crossings {
        let Self { shape, rays, wanted, limit } = self;
        let (mut found, alone) = search::<L, false>(shape, rays, wanted, limit);
        for ray in lanes(alone) {
            if let Some(at) = shape.hit(&Probe::new(rays.one(ray)), limit[ray]) {
                found.set(ray, at);
            }
        }
        found
    }
}

impl Work for Blocked<'_> {
    /// A bit for each ray that does.
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u32 {
        let Self { mesh, rays, wanted, t_max } = self;
        let (found, alone) = search::<L, true>(mesh, rays, wanted, t_max);
        let mut blocked = found.met;
        for ray in lanes(alone) {
            blocked |= u32::from(mesh.blocks(&Probe::new(rays.one(ray)), t_max[ray])) << ray;
        }
        blocked
    }
}

/// Searches along those rays whose bits are set for what is nearest, or for `ANY` triangle; gives what is found, and those
/// that have to be asked for alone: they come from afar, or are not longest along the same axis as the others.
#[inline(always)]
fn search<L: Lanes, const ANY: bool>(
    mesh: &Mesh,
    rays: &Rays,
    wanted: u32,
    t_max: &[f64; 8],
) -> (Crossings, u32) {
    let (origin, direction) = rays.load::<L>();
    let tree = mesh.mesh.tree();
    let (slabs, near, afar) = BundleSlabs::<L>::new(tree, origin, direction, wanted);
    if near == 0 {
        return (Crossings::NONE, afar);
    }
    let Some(sheared) = ShearedRays::new(&slabs, direction, near) else {
        return (Crossings::NONE, near | afar);
    };
    let limit = slabs.limit(Octo::load(t_max));
    let vicinities = Vicinity::of_each(origin, direction, mesh.reach());
    let found = Crossings::NONE;
    let (limits, alone) = (*t_max, [None; 8]);
    let slabs = &slabs;
    let mut bundle =
        Bundle::<L, ANY> { mesh, rays, slabs, sheared, t_max, vicinities, limits, limit, found, alone };
    tree.walk_together(slabs, near, &mut bundle);
    (bundle.found, afar)
}

/// Eight searches at once.
struct Bundle<'a, L: Lanes, const ANY: bool> {
    mesh: &'a Mesh,
    rays: &'a Rays,
    slabs: &'a BundleSlabs<L>,
    sheared: ShearedRays<L>,
    t_max: &'a [f64; 8],
    vicinities: Vicinities,
    /// The t before which hits are of interest: a little beyond the best, so that equally near ones are found; below 0 once a
    /// search is over.
    limits: [f64; 8],
    limit: L,
    found: Crossings,
    /// Rays that have gone on alone.
    alone: [Option<(Probe, Slabs)>; 8],
}

impl<L: Lanes, const ANY: bool> Bundle<'_, L, ANY> {
    /// Notes what is hit along a ray.
    #[inline(always)]
    fn note(&mut self, ray: usize, at: Crossing) {
        self.found.set(ray, at);
        self.limits[ray] = if ANY { -1.0 } else { self.vicinities.end(ray, at.t) };
    }
}

impl<L: Lanes, const ANY: bool> BundleLeaves<L> for Bundle<'_, L, ANY> {
    const ALONE: bool = true;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        let mesh = &self.mesh.mesh;
        let packet = &mesh.packets()[leaf as usize];
        let mut nearer = false;
        for lane in 0..packet.count() {
            let mut candidates = self.sheared.sift(packet, lane, self.limit) & rays;
            if ANY {
                candidates &= !self.found.met;
            }
            if candidates == 0 {
                continue;
            }
            let triangle = Triangle { corners: mesh.packed_corners(packet, lane) };
            let test = Hit { shape: &triangle, rays: self.rays, wanted: candidates, limit: &self.limits };
            let Some(crossings) = L::apart(test) else { continue };
            let part = packet.part(lane);
            for ray in lanes(crossings.met & candidates) {
                let (t, best) = (crossings.t[ray], self.found.t[ray]);
                if t < best || t == best && part < self.found.parts[ray] {
                    let crowded = !ANY && best < self.vicinities.end(ray, t);
                    self.note(ray, Crossing { t, part, crowded });
                    nearer = true;
                } else {
                    self.found.crowded |= 1 << ray;
                }
            }
        }
        if nearer {
            self.limit = self.slabs.limit(Octo::load(&self.limits));
        }
    }

    #[inline(always)]
    fn part(&mut self, ray: usize, below: Branch) {
        let (mesh, t_max) = (self.mesh, self.t_max[ray]);
        let hit = (self.found.met >> ray & 1 == 1).then(|| self.found.one(ray));
        if ANY && hit.is_some() {
            return;
        }
        let slot = &mut self.alone[ray];
        if slot.is_none() {
            let probe = Probe::new(self.rays.one(ray));
            *slot = Slabs::new::<L>(mesh.mesh.tree(), &probe, (0.0, t_max)).map(|slabs| (probe, slabs));
        }
        let Some((probe, slabs)) = slot else { return };
        let limit = slabs.limit(if hit.is_some() { self.limits[ray] } else { t_max });
        let tree = mesh.mesh.tree();
        if ANY {
            let mut search = Any { mesh, probe, sheared: None, t_max, found: false };
            tree.walk_below::<L>(below, slabs, limit, &mut search);
            if !search.found {
                return;
            }
            self.note(ray, Crossing::at(0.0));
        } else {
            let mut search = Nearest { hit, ..Nearest::new(mesh, probe, t_max) };
            tree.walk_below::<L>(below, slabs, limit, &mut search);
            match search.hit {
                Some(found) if search.hit != hit => self.note(ray, found),
                _ => return,
            }
        }
        self.limit = self.slabs.limit(Octo::load(&self.limits));
    }

    #[inline(always)]
    fn limit(&self) -> L {
        self.limit
    }
}
