//! Surfaces that scatter what they gather evenly, as `scatter` and `shade` have it for one.

use super::{Drawn, Ground, Scatters};
use crate::material::Lobes;
use crate::math::cos_sin_of_turns;
use crate::sampling::Frame;
use crate::simd::{Lanes, Octo, Quad, Vector};
use crate::trace::together::Color;
use std::f64::consts::PI;

/// What they send back.
pub struct Even<L>(Color<L>);

impl<L: Lanes> Scatters<L> for Even<L> {
    const GATHERS: bool = true;

    #[inline(always)]
    fn of(_: &Ground<L::Quad>, lobes: &[&Lobes; 8]) -> Self {
        Self(Color::of(&lobes.map(|lobes| lobes.diffuse)))
    }

    #[inline(always)]
    fn share(&self, _: Vector<L::Quad>, cosine: Octo<L::Quad>) -> Color<L> {
        self.0.scaled(L::load(&cosine.narrow()))
    }

    #[inline(always)]
    fn draw(
        &self,
        ground: &Ground<L::Quad>,
        frame: &Frame<Vector<L::Quad>>,
        [_, u, v, _]: &[[f64; 8]; 4],
    ) -> Drawn<L> {
        let direction = frame.to_world(cosine_hemisphere(Octo::load(u), Octo::load(v)));
        let (cosine, lit) = ground.cosines(direction);
        let density = cosine.larger(Octo::splat(0.0)) / Octo::splat(PI);
        Drawn { direction, density, share: self.share(direction, cosine), lit }
    }
}

/// [`crate::sampling::cosine_hemisphere`].
#[inline(always)]
fn cosine_hemisphere<Q: Quad>(u: Octo<Q>, v: Octo<Q>) -> [Octo<Q>; 3] {
    let (zero, one) = (Octo::splat(0.0), Octo::splat(1.0));
    let (cosine, sine) = cos_sin_of_turns(v);
    let radius = u.root();
    [cosine * radius, sine * radius, (one - u).larger(zero).root()]
}
