//! Streams of shadow rays in structure-of-arrays form, one for each light that surfaces are asked about: its rays go the same
//! way.

use super::light::ShadowRay;
use super::stream::{Reals, SLACK, Singles, Wholes, colors, compress, compress_colors, gather};
use crate::base::lanes::{Bits, Color, Lookup, Mask, Real, Row, Single};
use crate::base::math::LaneRay;

/// Light that reaches a surface unless something stands in its way.
#[derive(Clone, Copy)]
pub struct ShadowItem<F: Real> {
    pub ray: ShadowRay<F>,
    /// What the sample gains where nothing dims the light.
    pub light: Color<F::F32>,
    /// What of that is weighed against its being met by chance, and so counts less where light may also come transmitted.
    pub weighed: Color<F::F32>,
    pub medium: F::U32,
    pub slot: F::U32,
}

/// Shadow rays of a wave to the light of one request.
#[derive(Default)]
pub struct ShadowStream {
    /// Whether something lets light pass, and whether anything refracts.
    clear: bool,
    media: bool,
    len: usize,
    origin: [Reals; 3],
    direction: [Reals; 3],
    t_max: Reals,
    light: [Singles; 3],
    weighed: [Singles; 3],
    medium: Wholes,
    slot: Wholes,
}

impl ShadowStream {
    /// `clear` says whether something lets light pass, `media` whether anything refracts.
    pub fn new(clear: bool, media: bool) -> Self {
        Self { clear, media, ..Self::default() }
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes room for so many more.
    pub fn reserve(&mut self, more: usize) {
        let size = (self.len + more + SLACK).next_power_of_two();
        if self.slot.len() >= self.len + more + SLACK {
            return;
        }
        let Self { clear, media, origin, direction, t_max, light, weighed, .. } = self;
        let Self { medium, slot, .. } = self;
        origin.iter_mut().chain(direction).chain([t_max]).for_each(|column| column.resize(size, 0.0));
        light.iter_mut().for_each(|column| column.resize(size, 0.0));
        slot.resize(size, 0);
        if *clear {
            weighed.iter_mut().for_each(|column| column.resize(size, 0.0));
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
        if self.clear {
            compress_colors(&mut self.weighed, item.weighed, mask, at);
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

    /// Only where something lets light pass.
    #[inline(always)]
    pub fn weighed<S: Single>(&self, at: &Lookup) -> Color<S> {
        colors(&self.weighed, at)
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
