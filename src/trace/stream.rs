//! Streams of work items in structure-of-arrays form: the paths of a wave.
//!
//! A stage reads items eight at a time, wherever they stand in its input, and appends to its output. What a scene does
//! not call for has no column: nothing is stored for it, and reading it gives what it would always be.

use crate::base::lanes::{Color, Lookup, Mask, Real, Row, Single, Vec3};
use crate::base::math::LaneRay;
use crate::camera::RayCone;

/// Which columns streams have besides those that all have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// The part of the throughput that diffuse lobes gather, apart: with fog.
    pub fog: bool,
    /// Ray cones: where textures are filtered.
    pub cones: bool,
    /// Where and with which density directions were drawn: where what is met may have been asked for light.
    pub mis: bool,
    /// Media and coincident surfaces: where something lets light pass.
    pub media: bool,
    /// Numbers of the random numbers of each path's own: where paths branch.
    pub keys: bool,
    /// Flags of paths: where some light may count twice, or AOVs are recorded.
    pub flags: bool,
}

/// How much of the light that a path meets reaches its eye. Fog dims what a surface shows by reflection or
/// refraction, but not what it gathers: the light of lamps, glowing objects and the sky comes to its diffuse lobe as
/// if there were none. So which lobe the path has left its last surface by decides what the fog since then counts.
#[derive(Clone, Copy)]
pub struct Throughput<S> {
    /// Of what diffuse lobes of the last surface that scattered gather. Without fog, black.
    pub diffuse: Color<S>,
    /// Of what others show; without fog, of all.
    pub specular: Color<S>,
    /// The share of light that the fog since that surface lets pass.
    pub clear: S,
}

impl<S: Single> Throughput<S> {
    /// Of rays from the eye.
    #[inline(always)]
    pub fn full() -> Self {
        let one = S::splat(1.0);
        Self { diffuse: Color::black(), specular: Color::grey(one), clear: one }
    }

    /// Of what surfaces send to the eye because something shines on them: fog dims it all.
    #[inline(always)]
    pub fn lit(&self) -> Color<S> {
        (self.diffuse + self.specular) * self.clear
    }

    /// Of what shines by itself.
    #[inline(always)]
    pub fn shining(&self) -> Color<S> {
        self.diffuse + self.specular * self.clear
    }
}

/// The state of paths.
#[derive(Clone, Copy)]
pub struct PathState<F: Real> {
    pub ray: LaneRay<F>,
    pub throughput: Throughput<F::F32>,
    pub cone: RayCone<F>,
    /// The last surface that has scattered the path, where light was asked for.
    pub scattered_at: Vec3<F>,
    /// Density per steradian with which the direction was drawn there; 0 where there was no choice, or nothing was asked.
    pub pdf: F,
    /// By which the random numbers of a branch differ from those of others.
    pub key: F::U32,
    /// The place of the sample among those of the wave.
    pub slot: F::U32,
    /// Bounces that are left.
    pub left: F::U32,
    pub flags: F::U32,
    /// What the path is inside of ([`super::medium::MediaLists`]).
    pub medium: F::U32,
    /// The t of what the ray has just passed straight on, 0 otherwise: what it meets next lies beyond.
    pub after: F,
    /// What coincides with that and has not been passed yet ([`super::coincident::Events`]).
    pub pending: F::U32,
}

/// Flags of paths.
pub mod flags {
    /// Light has been sampled at the last surface that has scattered the path.
    pub const LIGHT_SAMPLED: u32 = 1;
    /// There, sampled light has been counted in full: it does not count where it is met.
    pub const LIGHT_COUNTED: u32 = 1 << 1;
    /// The path has not been reflected or refracted yet.
    pub const FROM_EYE: u32 = 1 << 2;
}

/// Numbers behind the last one that stages may write.
pub(super) const SLACK: usize = 8;

/// A column of numbers.
pub(super) type Reals = Vec<f64>;
pub(super) type Singles = Vec<f32>;
pub(super) type Wholes = Vec<u32>;

/// Paths of a wave.
#[derive(Default)]
pub struct PathStream {
    columns: Columns,
    len: usize,
    origin: [Reals; 3],
    direction: [Reals; 3],
    diffuse: [Singles; 3],
    specular: [Singles; 3],
    clear: Singles,
    width: Reals,
    spread: Reals,
    scattered_at: [Reals; 3],
    pdf: Reals,
    key: Wholes,
    slot: Wholes,
    left: Wholes,
    flags: Wholes,
    medium: Wholes,
    after: Reals,
    pending: Wholes,
    /// By which the random numbers of a wave's surfaces differ, where they are the same for all paths.
    depth: u32,
}

impl PathStream {
    pub fn new(columns: Columns) -> Self {
        Self { columns, ..Self::default() }
    }

    pub fn len(&self) -> usize {
        self.len
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes room for so many more.
    pub fn reserve(&mut self, more: usize) {
        let size = self.len + more + SLACK;
        if self.slot.len() >= size {
            return;
        }
        let size = size.max(2 * self.slot.len());
        let Self { columns, origin, direction, diffuse, specular, clear, .. } = self;
        let all = origin.iter_mut().chain(direction);
        all.for_each(|column| column.resize(size, 0.0));
        specular.iter_mut().for_each(|column| column.resize(size, 0.0));
        if columns.fog {
            diffuse.iter_mut().chain([clear]).for_each(|column| column.resize(size, 0.0));
        }
        let Self { columns, width, spread, scattered_at, pdf, .. } = self;
        if columns.cones {
            [width, spread].into_iter().for_each(|column| column.resize(size, 0.0));
        }
        if columns.mis {
            scattered_at.iter_mut().chain([pdf]).for_each(|column| column.resize(size, 0.0));
        }
        let Self { columns, key, slot, left, flags, medium, after, pending, .. } = self;
        [slot, left].into_iter().for_each(|column| column.resize(size, 0));
        if columns.flags {
            flags.resize(size, 0);
        }
        if columns.media {
            [medium, pending].into_iter().for_each(|column| column.resize(size, 0));
            after.resize(size, 0.0);
        }
        if columns.keys {
            key.resize(size, 0);
        }
    }

    /// By which the random numbers of these paths' next surfaces differ from those of others.
    pub fn set_depth(&mut self, depth: u32) {
        self.depth = depth;
    }

    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// The rays of items.
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
        Throughput { diffuse: colors(&self.diffuse, at), specular, clear: Row::gather(&self.clear, at) }
    }

    /// From where on rays are looked along.
    #[inline(always)]
    pub fn after<F: Real>(&self, at: &Lookup) -> F {
        if self.columns.media { F::gather(&self.after, at) } else { F::splat(0.0) }
    }

    /// What coincides with what a ray has just passed, and is to be met next.
    pub fn pending(&self, index: usize) -> u32 {
        if self.columns.media { self.pending[index] } else { 0 }
    }

    /// What a path is inside of.
    pub fn medium(&self, index: usize) -> u32 {
        if self.columns.media { self.medium[index] } else { 0 }
    }

    /// Splits the paths of later samples off; of a single sample, its later paths.
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

    /// Splits the paths from an index on off.
    fn split_at(&mut self, index: usize, into: &mut Self) {
        into.reserve(self.len - index);
        for index in index..self.len {
            into.push(true, &self.gather::<f64>(&Lookup::run(index as u32, 1)));
        }
        self.len = index;
    }

    /// Replaces what is left of the light along consecutive paths.
    #[inline(always)]
    pub fn set_throughput<S: Single>(&mut self, at: usize, throughput: &Throughput<S>) {
        let Throughput { diffuse, specular, clear } = *throughput;
        store_colors(&mut self.specular, specular, at);
        if self.columns.fog {
            store_colors(&mut self.diffuse, diffuse, at);
            clear.store(&mut self.clear, at);
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
            left: Row::gather(&self.left, at),
            flags: if flags { Row::gather(&self.flags, at) } else { nothing },
            medium: if media { Row::gather(&self.medium, at) } else { nothing },
            after: if media { F::gather(&self.after, at) } else { zero },
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
        let Throughput { diffuse, specular, clear } = state.throughput;
        compress_colors(&mut self.specular, specular, mask, at);
        if self.columns.fog {
            compress_colors(&mut self.diffuse, diffuse, mask, at);
            clear.compress(mask, &mut self.clear, at);
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
        state.left.compress(mask, &mut self.left, at);
        if self.columns.flags {
            state.flags.compress(mask, &mut self.flags, at);
        }
        if self.columns.keys {
            state.key.compress(mask, &mut self.key, at);
        }
        if self.columns.media {
            state.medium.compress(mask, &mut self.medium, at);
            state.after.compress(mask, &mut self.after, at);
            state.pending.compress(mask, &mut self.pending, at);
        }
        self.len += mask.bits().count_ones() as usize;
    }
}

#[inline(always)]
pub(super) fn gather<F: Real>([x, y, z]: &[Reals; 3], at: &Lookup) -> Vec3<F> {
    Vec3::gather([x, y, z], at)
}

#[inline(always)]
pub(super) fn colors<S: Single>([r, g, b]: &[Singles; 3], at: &Lookup) -> Color<S> {
    Color::gather([r, g, b], at)
}

#[inline(always)]
pub(super) fn compress<F: Real>([x, y, z]: &mut [Reals; 3], v: Vec3<F>, mask: F::Mask, at: usize) {
    v.x.compress(mask, x, at);
    v.y.compress(mask, y, at);
    v.z.compress(mask, z, at);
}

#[inline(always)]
pub(super) fn compress_colors<S: Single>(
    [r, g, b]: &mut [Singles; 3],
    color: Color<S>,
    mask: S::Mask,
    at: usize,
) {
    color.r.compress(mask, r, at);
    color.g.compress(mask, g, at);
    color.b.compress(mask, b, at);
}

#[inline(always)]
fn store_colors<S: Single>([r, g, b]: &mut [Singles; 3], color: Color<S>, at: usize) {
    color.r.store(r, at);
    color.g.store(g, at);
    color.b.store(b, at);
}
