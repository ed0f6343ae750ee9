//! Eight rays and one mesh: they share the nodes of its tree, and meet its triangles ray by ray.

use super::{Any, Mesh, Nearest};
use crate::shape::bundle::{Hit, lanes};
use crate::shape::{Crossing, Crossings, Rays};
use crate::simd::{Lanes, Octo, Work};
use crate::tree::{Branch, BundleLeaves, BundleSlabs, Leaves, Probe, Slabs};

/// The search along one ray of a bundle.
trait Search<'a>: Leaves {
    fn new(mesh: &'a Mesh, probe: &'a Probe, t_max: f64) -> Self;

    /// The t beyond which nothing is of interest any more; below 0 once the search is over.
    fn reach(&self) -> f64;
}

impl<'a> Search<'a> for Nearest<'a> {
    fn new(mesh: &'a Mesh, probe: &'a Probe, t_max: f64) -> Self {
        Self { mesh, probe, sheared: None, t_max, hit: None }
    }

    #[inline(always)]
    fn reach(&self) -> f64 {
        self.hit.map_or(self.t_max, |hit| hit.t)
    }
}

impl<'a> Search<'a> for Any<'a> {
    fn new(mesh: &'a Mesh, probe: &'a Probe, t_max: f64) -> Self {
        Self { mesh, probe, sheared: None, t_max, found: false }
    }

    #[inline(always)]
    fn reach(&self) -> f64 {
        if self.found { -1.0 } else { self.t_max }
    }
}

/// Eight searches at once.
struct Bundle<'b, 'a, L: Lanes, S> {
    mesh: &'a Mesh,
    probes: &'a [Probe; 8],
    slabs: &'b BundleSlabs<L>,
    searches: [S; 8],
    /// Of rays that have come to a triangle, or gone on alone.
    alone: [Option<Slabs>; 8],
    limit: L,
}

impl<'a, L: Lanes, S: Search<'a>> Bundle<'_, 'a, L, S> {
    #[inline(always)]
    fn limits(&self) -> L {
        let mut reach = [0.0; 8];
        for (reach, search) in reach.iter_mut().zip(&self.searches) {
            *reach = search.reach();
        }
        self.slabs.limit(Octo::load(&reach))
    }

    /// A ray by itself with its limit; none if it is over.
    #[inline(always)]
    fn single(&mut self, ray: usize) -> Option<(Slabs, f32)> {
        let reach = self.searches[ray].reach();
        if reach < 0.0 {
            return None;
        }
        let slot = &mut self.alone[ray];
        if slot.is_none() {
            *slot = Slabs::new::<L>(self.mesh.mesh.tree(), &self.probes[ray], reach);
        }
        slot.map(|slabs| (slabs, slabs.limit(reach)))
    }
}

impl<'a, L: Lanes, S: Search<'a>> BundleLeaves<L> for Bundle<'_, 'a, L, S> {
    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        let mut rest = rays;
        while rest != 0 {
            let ray = rest.trailing_zeros() as usize & 7;
            rest &= rest - 1;
            if let Some((slabs, limit)) = self.single(ray) {
                self.searches[ray].visit::<L>(leaf, &slabs, limit);
            }
        }
        self.limit = self.limits();
    }

    #[inline(always)]
    fn part(&mut self, ray: usize, below: Branch) {
        if let Some((slabs, limit)) = self.single(ray) {
            self.mesh.mesh.tree().walk_below::<L>(below, &slabs, limit, &mut self.searches[ray]);
            self.limit = self.limits();
        }
    }

    #[inline(always)]
    fn limit(&self) -> L {
        self.limit
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
        let probes = std::array::from_fn(|ray| Probe::new(rays.one(ray)));
        let mut hits: [Option<Crossing>; 8] = [None; 8];
        let afar = search::<L, Nearest>(shape, rays, (&probes, limit), wanted, |ray, search| {
            hits[ray] = search.hit;
        });
        for ray in lanes(afar) {
            hits[ray] = super::Geometric::hit(shape, &probes[ray], limit[ray]);
        }
        Crossings::one_by_one(wanted, |ray| hits[ray])
    }
}

impl Work for Blocked<'_> {
    /// A bit for each ray that does.
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u32 {
        let Self { mesh, rays, wanted, t_max } = self;
        let probes = std::array::from_fn(|ray| Probe::new(rays.one(ray)));
        let mut blocked = 0;
        let afar = search::<L, Any>(mesh, rays, (&probes, t_max), wanted, |ray, search| {
            blocked |= u32::from(search.found) << ray;
        });
        for ray in lanes(afar) {
            blocked |= u32::from(super::Geometric::blocks(mesh, &probes[ray], t_max[ray])) << ray;
        }
        blocked & wanted
    }
}

/// Searches along those rays whose bits are set; gives those that come from too far away to go with the others.
#[inline(always)]
fn search<'a, L: Lanes, S: Search<'a>>(
    mesh: &'a Mesh,
    rays: &Rays,
    (probes, t_max): (&'a [Probe; 8], &[f64; 8]),
    wanted: u32,
    mut take: impl FnMut(usize, &S),
) -> u32 {
    let (origin, direction) = rays.load::<L>();
    let tree = mesh.mesh.tree();
    let (slabs, near, afar) = BundleSlabs::<L>::new(tree, origin, direction, wanted);
    if near != 0 {
        let searches = std::array::from_fn(|ray| S::new(mesh, &probes[ray], t_max[ray]));
        let limit = slabs.limit(Octo::load(t_max));
        let mut bundle = Bundle { mesh, probes, slabs: &slabs, searches, alone: [None; 8], limit };
        tree.walk_together(&slabs, near, &mut bundle);
        (0..8).for_each(|ray| take(ray, &bundle.searches[ray]));
    }
    afar
}
