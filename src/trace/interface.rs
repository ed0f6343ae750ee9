//! The media on the two sides of refracting surfaces.

use super::bsdf::Boundary;
use super::coincident::{Events, ISOLATED};
use super::context::TraceContext;
use super::interaction::SurfaceInteraction;
use super::medium::{Enclosure, MediaLists, Passage};
use super::spawn::spawn;
use crate::base::lanes::{Mask, Real, Row, lanes};

/// The two sides of a surface in each lane.
#[derive(Clone, Copy)]
pub struct Interface<F: Real> {
    pub boundary: Boundary<F>,
    /// Lanes in which a medium of higher priority fills both sides, so that the surface is invisible.
    pub is_hidden: F::Mask,
    /// The media around rays after they pass ([`MediaLists`]).
    pub behind: F::U32,
}

impl<F: Real> Interface<F> {
    /// For surfaces without refraction.
    #[inline(always)]
    pub fn none(inside: F::U32) -> Self {
        let boundary = Boundary { eta: F::splat(1.0) };
        Self { boundary, is_hidden: F::Mask::splat(false), behind: inside }
    }

    /// The interfaces of refracting surfaces in the lanes of a mask, for rays inside these media.
    #[inline(always)]
    pub fn gather(
        context: &TraceContext,
        (media, events): (&mut MediaLists, &Events),
        surface: &SurfaceInteraction<F>,
        inside: F::U32,
        wanted: F::Mask,
    ) -> Self {
        let (inside, outside) = (inside.to_array(), surface.outside.bits());
        let (primitives, materials) = (surface.primitive.to_array(), surface.material.to_array());
        let (mut etas, mut behind, mut hidden) = (F::splat(1.0).to_array(), inside, 0);
        let events_of = surface.event.to_array();
        let (all, mut spawned) = (&context.scene.shading.materials, None);
        for lane in lanes(wanted.bits()) {
            let transition = match events.get(events_of[lane]) {
                Some(event) => media.pass_all(inside[lane], &event.passages, all),
                None => {
                    let of = Enclosure { primitive: primitives[lane], material: materials[lane] };
                    let (enters, mut grazes) = (outside >> lane & 1 == 1, false);
                    if context.may_graze(of.primitive) {
                        let out = surface.surface.normal;
                        if spawned.is_none() {
                            let (from, to) =
                                (spawn(&surface.surface, out).origin, spawn(&surface.surface, -out).origin);
                            spawned = Some((from.store(), to.store(), out.store()));
                        }
                        if let Some((from, to, out)) = &spawned {
                            let origins = [from[lane], to[lane]];
                            let clear =
                                events_of[lane] == ISOLATED && context.is_clear(of.primitive, origins);
                            grazes =
                                !clear && context.grazes_an_edge(of.primitive, origins, out[lane], enters);
                        }
                    }
                    media.pass(inside[lane], Passage { of, enters, grazes }, all)
                }
            };
            (etas[lane], behind[lane]) = (transition.eta, transition.behind);
            hidden |= u32::from(transition.hidden) << lane;
        }
        Self {
            boundary: Boundary { eta: F::from_array(etas) },
            is_hidden: F::Mask::from_bits(hidden),
            behind: F::U32::from_array(behind),
        }
    }
}
