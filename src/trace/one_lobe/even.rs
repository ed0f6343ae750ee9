//! Surfaces that scatter what they gather evenly, as `scatter` and `shade` have it for one.

use super::{Drawn, Ground, Scatters};
use crate::material::Lobes;
use crate::math::cos_sin_of_turns;
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
    fn draw(&self, ground: &Ground<L::Quad>, [_, u, v, _]: &[[f64; 8]; 4]) -> Drawn<L> {
        let direction = cosine_hemisphere(ground.normal, Octo::load(u), Octo::load(v));
        let (cosine, lit) = ground.cosines(direction);
        let density = cosine.larger(Octo::splat(0.0)) / Octo::splat(PI);
        Drawn { direction, density, share: self.share(direction, cosine), lit }
    }
}

/// [`crate::sampling::cosine_hemisphere`] around normals, as [`crate::sampling::Frame`] turns it.
#[inline(always)]
fn cosine_hemisphere<Q: Quad>(z: Vector<Q>, u: Octo<Q>, v: Octo<Q>) -> Vector<Q> {
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
