//! Mirrors that scatter, as [`Fuzz`](crate::optics::Fuzz) has it for one.

use super::{Drawn, Ground, Scatters};
use crate::material::Lobes;
use crate::math::cos_sin_of_turns;
use crate::sampling::Frame;
use crate::simd::{Lanes, Octo, Quad, Vector};
use crate::trace::together::Color;
use std::f64::consts::PI;

/// Mirrors that scatter what they show.
pub struct Fuzzy<L: Lanes> {
    mirror: Color<L>,
    fuzz: Octo<L::Quad>,
    mirrored: Vector<L::Quad>,
}

impl<L: Lanes> Scatters<L> for Fuzzy<L> {
    const GATHERS: bool = false;

    #[inline(always)]
    fn of(ground: &Ground<L::Quad>, lobes: &[&Lobes; 8]) -> Self {
        let fuzz = Octo::load(&lobes.map(|lobes| f64::from(lobes.fuzz)));
        Self { mirror: Color::of(&lobes.map(|lobes| lobes.mirror)), fuzz, mirrored: ground.mirrored() }
    }

    #[inline(always)]
    fn share(&self, to_light: Vector<L::Quad>, _: Octo<L::Quad>) -> Color<L> {
        self.shown(self.density(to_light))
    }

    #[inline(always)]
    fn draw(
        &self,
        ground: &Ground<L::Quad>,
        _: &Frame<Vector<L::Quad>>,
        [_, u, v, w]: &[[f64; 8]; 4],
    ) -> Drawn<L> {
        let off = in_ball(Octo::load(u), Octo::load(v), w) * self.fuzz;
        let direction = (self.mirrored + off).normalized_or(self.mirrored);
        let (_, lit) = ground.cosines(direction);
        let density = self.density(direction);
        Drawn { direction, density, share: self.shown(density), lit }
    }
}

impl<L: Lanes> Fuzzy<L> {
    #[inline(always)]
    fn shown(&self, density: Octo<L::Quad>) -> Color<L> {
        self.mirror.scaled(L::load(&(Octo::splat(PI) * density).narrow()))
    }

    /// [`Fuzz::density`](crate::optics::Fuzz::density).
    #[inline(always)]
    fn density(&self, direction: Vector<L::Quad>) -> Octo<L::Quad> {
        let Self { fuzz, mirrored, .. } = *self;
        let zero = Octo::splat(0.0);
        let along = mirrored.dot(direction);
        let across = (mirrored - direction * along).length();
        let square = (fuzz - across) * (fuzz + across);
        let half = square.root();
        let cube = fuzz * fuzz * fuzz;
        let (near, far) = (along - half, (along + half).larger(zero));
        let from_outside =
            half * (Octo::splat(3.0) * along * along + square) / (Octo::splat(2.0 * PI) * cube);
        let from_inside = far * far * far / (Octo::splat(4.0 * PI) * cube);
        let density = from_outside.pick(zero.below(near), from_inside);
        density.pick(zero.below(square), zero)
    }
}

/// [`crate::sampling::in_ball`].
#[inline(always)]
fn in_ball<Q: Quad>(u: Octo<Q>, v: Octo<Q>, w: &[f64; 8]) -> Vector<Q> {
    let (zero, one) = (Octo::splat(0.0), Octo::splat(1.0));
    let z = one - Octo::splat(2.0) * u;
    let across = ((one - z) * (one + z)).larger(zero).root();
    let (x, y) = cos_sin_of_turns(v);
    let radius = Octo::load(&w.map(libm::cbrt));
    Vector { x: x * across, y: y * across, z } * radius
}
