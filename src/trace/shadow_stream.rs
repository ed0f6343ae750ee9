//! Streams of shadow rays in structure-of-arrays form, one stream per light request, so that its rays are coherent.

use super::columns::{Reals, SLACK, Singles, Wholes, colors, compress, compress_colors, gather};
use super::light::ShadowRay;
use crate::base::lanes::{Bits, Color, Lookup, Mask, Real, Row, Single};
use crate::base::math::LaneRay;

/// Light that reaches a surface unless something blocks it.
#[derive(Clone, Copy)]
pub struct ShadowItem<F: Real> {
    pub ray: ShadowRay<F>,
    /// The light that the sample gains without occlusion.
    pub light: Color<F::F32>,
    /// The part of that light that BSDF samples account for by their weight. It is subtracted, except where light is
    /// refracted on its way, which BSDF samples do not find.
    pub mis_complement: Color<F::F32>,
    pub medium: F::U32,
    pub slot: F::U32,
}

/// The shadow rays of a wave to the light of one request.
#[derive(Default)]
pub struct ShadowStream {
    /// Whether surfaces may transmit light, and whether any material refracts.
    transmits: bool,
    media: bool,
    len: usize,
    origin: [Reals; 3],
    direction: [Reals; 3],
    t_max: Reals,
    light: [Singles; 3],
    mis_complement: [Singles; 3],
    medium: Wholes,
    slot: Wholes,
}

impl ShadowStream {
    /// `transmits` says whether surfaces may transmit light, `media` whether any material refracts.
    pub fn new(transmits: bool, media: bool) -> Self {
        Self { transmits, media, ..Self::default() }
    }

    /// Whether both streams have the same columns.
    pub fn is_like(&self, other: &Self) -> bool {
        (self.transmits, self.media) == (other.transmits, other.media)
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes room for `more` rays.
    pub fn reserve(&mut self, more: usize) {
        let size = (self.len + more + SLACK).next_power_of_two();
        if self.slot.len() >= self.len + more + SLACK {
            return;
        }
        let Self { transmits, media, origin, direction, t_max, light, mis_complement, .. } = self;
        let Self { medium, slot, .. } = self;
        origin.iter_mut().chain(direction).chain([t_max]).for_each(|column| column.resize(size, 0.0));
        light.iter_mut().for_each(|column| column.resize(size, 0.0));
        slot.resize(size, 0);
        if *transmits {
            mis_complement.iter_mut().for_each(|column| column.resize(size, 0.0));
        }
        if *media {
            medium.resize(size, 0);
        }
    }

    /// Appends the lanes of a mask.
    #[inline(always)]
    pub fn push<F: Real>(&mut self, mask: F::Mask, item: &ShadowItem<F>) {
        self.reserve(F::LANES);
        let at = self.len;
        compress(&mut self.origin, item.ray.ray.origin, mask, at);
        compress(&mut self.direction, item.ray.ray.direction, mask, at);
        item.ray.t_max.compress(mask, &mut self.t_max, at);
        compress_colors(&mut self.light, item.light, mask, at);
        item.slot.compress(mask, &mut self.slot, at);
        if self.transmits {
            compress_colors(&mut self.mis_complement, item.mis_complement, mask, at);
        }
        if self.media {
            item.medium.compress(mask, &mut self.medium, at);
        }
        self.len += mask.bits().count_ones() as usize;
    }

    pub fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    pub fn ray<F: Real>(&self, at: &Lookup) -> ShadowRay<F> {
        let ray = LaneRay { origin: gather(&self.origin, at), direction: gather(&self.direction, at) };
        ShadowRay { ray, t_max: F::gather(&self.t_max, at) }
    }

    #[inline(always)]
    pub fn light<S: Single>(&self, at: &Lookup) -> Color<S> {
        colors(&self.light, at)
    }

    /// Black unless surfaces may transmit light.
    #[inline(always)]
    pub fn mis_complement<S: Single>(&self, at: &Lookup) -> Color<S> {
        colors(&self.mis_complement, at)
    }

    #[inline(always)]
    pub fn media<U: Bits>(&self, at: &Lookup) -> U {
        if self.media { U::gather(&self.medium, at) } else { U::splat(0) }
    }

    #[inline(always)]
    pub fn slots<U: Bits>(&self, at: &Lookup) -> U {
        U::gather(&self.slot, at)
    }
}
