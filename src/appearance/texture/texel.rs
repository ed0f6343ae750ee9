//! What textures give at a point: a colour with alpha.

use crate::base::lanes::{Color, Mask, Select, Single};

/// The values of textures at points, in lanes: colours with alpha, which are not premultiplied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texel<S = f32> {
    pub color: Color<S>,
    /// In 0..=1.
    pub alpha: S,
}

/// Values between which lanes interpolate.
pub trait Lerp<S>: Copy {
    /// From this value at 0 to the other one at 1.
    fn lerp(self, other: Self, share: S) -> Self;
}

impl<S: Single> Lerp<S> for Color<S> {
    #[inline(always)]
    fn lerp(self, other: Self, share: S) -> Self {
        Color::lerp(self, other, share)
    }
}

impl<S: Single> Texel<S> {
    #[inline(always)]
    pub fn opaque(color: Color<S>) -> Self {
        Self { color, alpha: S::splat(1.0) }
    }
}

impl<S: Single> Lerp<S> for Texel<S> {
    /// Colours are weighted by their alpha (Porter and Duff, *Compositing Digital Images*, 1984).
    #[inline(always)]
    fn lerp(self, other: Self, share: S) -> Self {
        let one = S::splat(1.0);
        let plain = self.color.lerp(other.color, share);
        let alpha = self.alpha * (one - share) + other.alpha * share;
        let there = (self.color * self.alpha).lerp(other.color * other.alpha, share);
        // If alpha is 0, the colour is arbitrary.
        let color = Color::select(S::splat(0.0).lt(alpha), there / alpha, plain);
        let is_opaque = one.le(self.alpha) & one.le(other.alpha);
        Self::select(is_opaque, Self::opaque(plain), Self { color, alpha })
    }
}

impl<M: Mask, S: Single<Mask = M>> Select<M> for Texel<S> {
    #[inline(always)]
    fn select(mask: M, yes: Self, no: Self) -> Self {
        Self { color: Color::select(mask, yes.color, no.color), alpha: S::select(mask, yes.alpha, no.alpha) }
    }
}
