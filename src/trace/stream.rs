//! Streams of work items in structure-of-arrays form: the paths of a wave.
//!
//! A stage reads eight items at a time, from any indices of its input, and appends to its output. A stream has no
//! column for what the scene does not need. Reading such a column gives its constant value.

use super::columns::{
    Reals, SLACK, Singles, Wholes, colors, compress, compress_colors, gather, store_colors,
};
use crate::base::lanes::{Color, Lookup, Mask, Real, Row, Single, Vec3};
use crate::base::math::LaneRay;
use crate::camera::RayCone;
use crate::geometry::ray_kinds::RayKind;

/// The optional columns of streams.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// A separate diffuse throughput: with fog.
    pub fog: bool,
    /// Ray cones: if textures are filtered.
    pub cones: bool,
    /// The origin and density of sampled directions: if a path may hit light that was also sampled.
    pub mis: bool,
    /// Media and coincident surfaces: if surfaces may transmit light.
    pub media: bool,
    /// Keys of random numbers for each path: if paths branch.
    pub keys: bool,
    /// Flags of paths: if some light may count twice, or films record AOVs.
    pub flags: bool,
}

/// The throughput of a path, split by the effect of fog. Fog dims specular light: reflections and refractions. It does
/// not dim diffuse lighting: light of lamps, glowing objects and the sky reaches diffuse lobes as if there were no fog.
/// So the lobe by which the path left its last surface decides how the fog after that surface counts.
#[derive(Clone, Copy)]
pub struct Throughput<S> {
    /// For light at the diffuse lobes of the last surface that scattered. Black without fog.
    pub diffuse: Color<S>,
    /// For light at the other lobes. Without fog, for all light.
    pub specular: Color<S>,
    /// The transmittance of the fog since that surface.
    pub fog_transmittance: S,
}

impl<S: Single> Throughput<S> {
    /// For camera rays.
    #[inline(always)]
    pub fn full() -> Self {
        let one = S::splat(1.0);
        Self { diffuse: Color::black(), specular: Color::grey(one), fog_transmittance: one }
    }

    /// The throughput for light that a surface reflects. Fog dims all of it.
    #[inline(always)]
    pub fn at_surface(&self) -> Color<S> {
        (self.diffuse + self.specular) * self.fog_transmittance
    }

    /// The throughput for emitted light.
    #[inline(always)]
    pub fn at_emitter(&self) -> Color<S> {
        self.diffuse + self.specular * self.fog_transmittance
    }
}

/// The state of paths.
#[derive(Clone, Copy)]
pub struct PathState<F: Real> {
    pub ray: LaneRay<F>,
    pub throughput: Throughput<F::F32>,
    pub cone: RayCone<F>,
    /// The last surface that scattered the path, at which light was sampled.
    pub scattered_at: Vec3<F>,
    /// The density per steradian of the direction there. It is 0 for a delta distribution, or if no light was sampled.
    pub pdf: F,
    /// The key of the path's random numbers, which separates branches.
    pub key: F::U32,
    /// The index of the sample in the wave.
    pub slot: F::U32,
    /// Remaining bounces.
    pub bounces_left: F::U32,
    pub flags: F::U32,
    /// The media around the path ([`super::medium::MediaLists`]).
    pub medium: F::U32,
    /// The t of the surface that the ray has just passed straight on, otherwise 0. The next hit is beyond it.
    pub t_start: F,
    /// The event of coincident surfaces that the ray has yet to pass ([`super::coincident::Events`]).
    pub pending: F::U32,
}

/// Flags of paths.
pub mod flags {
    /// Light was sampled at the last surface that scattered the path.
    pub const LIGHT_SAMPLED: u32 = 1;
    /// Light samples there counted in full, so the path ignores light that it hits.
    pub const LIGHT_COUNTED: u32 = 1 << 1;
    /// The path has not been reflected or refracted yet.
    pub const FROM_EYE: u32 = 1 << 2;
    /// The path has only been reflected by mirrors and refracted, if at all.
    pub const SPECULAR: u32 = 1 << 3;
}

/// The paths of a wave.
#[derive(Default)]
pub struct PathStream {
    columns: Columns,
    len: usize,
    origin: [Reals; 3],
    direction: [Reals; 3],
    diffuse: [Singles; 3],
    specular: [Singles; 3],
    fog_transmittance: Singles,
    width: Reals,
    spread: Reals,
    scattered_at: [Reals; 3],
    pdf: Reals,
    key: Wholes,
    slot: Wholes,
    bounces_left: Wholes,
    flags: Wholes,
    medium: Wholes,
    t_start: Reals,
    pending: Wholes,
    /// The key of random numbers at the next surfaces, if it is the same for all paths.
    depth: u32,
}

impl PathStream {
    pub fn new(columns: Columns) -> Self {
        Self { columns, ..Self::default() }
    }

    pub fn columns(&self) -> Columns {
        self.columns
    }

    pub fn len(&self) -> usize {
        self.len
    }

    /// The bits of up to eight paths from `first` on that have not been reflected or refracted yet. Without flags, all.
    #[inline(always)]
    pub fn primary(&self, first: usize) -> u32 {
        let flags = self.flags.iter().skip(first).take(8).enumerate();
        let bits = flags.map(|(lane, flags)| u32::from(flags & flags::FROM_EYE != 0) << lane);
        if self.columns.flags { bits.sum() } else { 0xff }
    }

    /// The kind of the ray of a path.
    pub fn ray_kind(&self, index: usize) -> RayKind {
        if self.primary(index) & 1 == 1 { RayKind::Camera } else { RayKind::Scattered }
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes room for `more` paths.
    pub fn reserve(&mut self, more: usize) {
        let size = self.len + more + SLACK;
        if self.slot.len() >= size {
            return;
        }
        let size = size.max(2 * self.slot.len());
        let Self { columns, origin, direction, diffuse, specular, fog_transmittance, .. } = self;
        let all = origin.iter_mut().chain(direction);
        all.for_each(|column| column.resize(size, 0.0));
        specular.iter_mut().for_each(|column| column.resize(size, 0.0));
        if columns.fog {
            diffuse.iter_mut().chain([fog_transmittance]).for_each(|column| column.resize(size, 0.0));
        }
        let Self { columns, width, spread, scattered_at, pdf, .. } = self;
        if columns.cones {
            [width, spread].into_iter().for_each(|column| column.resize(size, 0.0));
        }
        if columns.mis {
            scattered_at.iter_mut().chain([pdf]).for_each(|column| column.resize(size, 0.0));
        }
        let Self { columns, key, slot, bounces_left, flags, medium, t_start, pending, .. } = self;
        [slot, bounces_left].into_iter().for_each(|column| column.resize(size, 0));
        if columns.flags {
            flags.resize(size, 0);
        }
        if columns.media {
            [medium, pending].into_iter().for_each(|column| column.resize(size, 0));
            t_start.resize(size, 0.0);
        }
        if columns.keys {
            key.resize(size, 0);
        }
    }

    /// Sets the key of random numbers at the paths' next surfaces.
    pub fn set_depth(&mut self, depth: u32) {
        self.depth = depth;
    }

    /// The key of the random numbers of all paths, if it is the same for all.
    #[inline(always)]
    pub fn common_key(&self) -> Option<u32> {
        (!self.columns.keys).then_some(self.depth)
    }

    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// The rays of paths.
    #[inline(always)]
    pub fn ray<F: Real>(&self, at: &Lookup) -> LaneRay<F> {
        LaneRay { origin: gather(&self.origin, at), direction: gather(&self.direction, at) }
    }

    #[inline(always)]
    pub fn throughput<F: Real>(&self, at: &Lookup) -> Throughput<F::F32> {
        let specular = colors(&self.specular, at);
        if !self.columns.fog {
            return Throughput { specular, ..Throughput::full() };
        }
        Throughput {
            diffuse: colors(&self.diffuse, at),
            specular,
            fog_transmittance: Row::gather(&self.fog_transmittance, at),
        }
    }

    /// The t from which rays are traced.
    #[inline(always)]
    pub fn t_start<F: Real>(&self, at: &Lookup) -> F {
        if self.columns.media { F::gather(&self.t_start, at) } else { F::splat(0.0) }
    }

    /// The event of coincident surfaces that a path has yet to pass.
    pub fn pending(&self, index: usize) -> u32 {
        if self.columns.media { self.pending[index] } else { 0 }
    }

    /// The slot of a path.
    pub fn slot(&self, index: u32) -> u32 {
        self.slot[index as usize]
    }

    /// The slots of all paths.
    pub fn slots(&self) -> &[u32] {
        &self.slot[..self.len]
    }

    /// The media around a path.
    pub fn medium(&self, index: usize) -> u32 {
        if self.columns.media { self.medium[index] } else { 0 }
    }

    /// Moves the paths of later samples to another stream. If there is only one sample, moves the later half of its
    /// paths.
    pub fn split(&mut self, into: &mut Self) {
        into.clear();
        into.depth = self.depth;
        let slots = &self.slot[..self.len];
        let (Some(&least), Some(&most)) = (slots.iter().min(), slots.iter().max()) else { return };
        if least == most {
            return self.split_at(self.len / 2, into);
        }
        let middle = least + (most - least).div_ceil(2);
        let all = std::mem::replace(self, Self { depth: self.depth, ..Self::new(self.columns) });
        for index in 0..all.len {
            let state = all.gather::<f64>(&Lookup::run(index as u32, 1));
            if state.slot < middle { self.push(true, &state) } else { into.push(true, &state) }
        }
    }

    /// Moves the paths from an index on.
    fn split_at(&mut self, index: usize, into: &mut Self) {
        into.reserve(self.len - index);
        for index in index..self.len {
            into.push(true, &self.gather::<f64>(&Lookup::run(index as u32, 1)));
        }
        self.len = index;
    }

    /// Replaces the throughput of consecutive paths.
    #[inline(always)]
    pub fn set_throughput<S: Single>(&mut self, at: usize, throughput: &Throughput<S>) {
        let Throughput { diffuse, specular, fog_transmittance } = *throughput;
        store_colors(&mut self.specular, specular, at);
        if self.columns.fog {
            store_colors(&mut self.diffuse, diffuse, at);
            fog_transmittance.store(&mut self.fog_transmittance, at);
        }
    }

    #[inline(always)]
    pub fn gather<F: Real>(&self, at: &Lookup) -> PathState<F> {
        let Columns { cones, mis, media, keys, flags, .. } = self.columns;
        let (zero, nothing) = (F::splat(0.0), F::U32::splat(0));
        let cone = match cones {
            true => RayCone { width: F::gather(&self.width, at), spread: F::gather(&self.spread, at) },
            false => RayCone { width: zero, spread: zero },
        };
        PathState {
            ray: self.ray(at),
            throughput: self.throughput::<F>(at),
            cone,
            scattered_at: if mis { gather(&self.scattered_at, at) } else { Vec3::zero() },
            pdf: if mis { F::gather(&self.pdf, at) } else { zero },
            key: if keys { Row::gather(&self.key, at) } else { F::U32::splat(self.depth) },
            slot: Row::gather(&self.slot, at),
            bounces_left: Row::gather(&self.bounces_left, at),
            flags: if flags { Row::gather(&self.flags, at) } else { nothing },
            medium: if media { Row::gather(&self.medium, at) } else { nothing },
            t_start: if media { F::gather(&self.t_start, at) } else { zero },
            pending: if media { Row::gather(&self.pending, at) } else { nothing },
        }
    }

    /// Appends the lanes of a mask.
    #[inline(always)]
    pub fn push<F: Real>(&mut self, mask: F::Mask, state: &PathState<F>) {
        self.reserve(F::LANES);
        let at = self.len;
        compress(&mut self.origin, state.ray.origin, mask, at);
        compress(&mut self.direction, state.ray.direction, mask, at);
        let Throughput { diffuse, specular, fog_transmittance } = state.throughput;
        compress_colors(&mut self.specular, specular, mask, at);
        if self.columns.fog {
            compress_colors(&mut self.diffuse, diffuse, mask, at);
            fog_transmittance.compress(mask, &mut self.fog_transmittance, at);
        }
        if self.columns.cones {
            state.cone.width.compress(mask, &mut self.width, at);
            state.cone.spread.compress(mask, &mut self.spread, at);
        }
        if self.columns.mis {
            compress(&mut self.scattered_at, state.scattered_at, mask, at);
            state.pdf.compress(mask, &mut self.pdf, at);
        }
        state.slot.compress(mask, &mut self.slot, at);
        state.bounces_left.compress(mask, &mut self.bounces_left, at);
        if self.columns.flags {
            state.flags.compress(mask, &mut self.flags, at);
        }
        if self.columns.keys {
            state.key.compress(mask, &mut self.key, at);
        }
        if self.columns.media {
            state.medium.compress(mask, &mut self.medium, at);
            state.t_start.compress(mask, &mut self.t_start, at);
            state.pending.compress(mask, &mut self.pending, at);
        }
        self.len += mask.bits().count_ones() as usize;
    }
}
