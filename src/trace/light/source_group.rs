//! The light sources of a layer, and the samples that surfaces take of them.

use super::area_table::AreaTable;
use super::sampled_emitter::SampledEmitter;
use super::source_choice::SourceChoice;
use crate::base::lanes::{Mask, Real, Vec3};
use crate::film::LayerId;
use crate::scene::Scene;

/// The most sources of a layer that paths may all sample at a surface.
const MAX_SAMPLED: usize = 8;

/// So few sources are all sampled everywhere, if some of them have no noise of their own.
const FEW: usize = 4;

/// How many numbers separate the requests of a layer.
const REQUESTS: u32 = 2 * MAX_SAMPLED as u32;

/// The sources of a layer.
pub struct SourceGroup<'a> {
    pub layer: LayerId,
    pub members: Vec<SampledEmitter<'a>>,
    /// What the first surface of a path samples, and what each later one.
    taken: [Taken; 2],
    /// How members are chosen; `None` if all are sampled everywhere.
    pub choice: Option<GroupChoice>,
}

/// The sources that a surface samples.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Taken {
    All,
    /// So many, chosen at random, fewer than all.
    Chosen(usize),
}

pub struct GroupChoice {
    pub among: SourceChoice,
    /// The members that lanes sample together.
    pub areas: AreaTable,
}

/// A light sample that surfaces take.
#[derive(Clone, Copy, Debug)]
pub struct LightRequest {
    pub layer: LayerId,
    /// Separates its random numbers from those of other requests.
    pub number: u32,
    pub(super) group: usize,
    pub(super) source: RequestedSource,
    /// Whether the first surface of a path takes it, and whether later ones do.
    takes: [bool; 2],
    /// Whether the sample is random: the source has several directions, or is chosen among several.
    pub is_sampled: bool,
    /// Whether some source casts no shadows.
    pub some_unshadowed: bool,
}

/// The source of a light sample.
#[derive(Clone, Copy, Debug)]
pub enum RequestedSource {
    Member(usize),
    /// One that is chosen at random: for the sample of this number, of so many.
    Chosen(usize, usize),
}

impl LightRequest {
    /// Whether the source is chosen among several.
    pub fn is_choice(&self) -> bool {
        matches!(self.source, RequestedSource::Chosen(..))
    }

    /// The lanes that take the sample, of those at the first surface of a path and of the others.
    #[inline(always)]
    pub fn takers<M: Mask>(&self, is_first: M) -> M {
        let [first, later] = self.takes;
        (is_first & M::splat(first)) | (!is_first & M::splat(later))
    }
}

impl<'a> SourceGroup<'a> {
    /// The sources of a layer. Without `choice`, each is sampled everywhere.
    pub fn new(layer: LayerId, members: Vec<SampledEmitter<'a>>, scene: &Scene, choice: bool) -> Self {
        let taken = if choice { taken(&members) } else { [Taken::All; 2] };
        let choice = (taken != [Taken::All; 2]).then(|| GroupChoice {
            among: SourceChoice::new(&members, scene),
            areas: AreaTable::new(&members, scene),
        });
        Self { layer, members, taken, choice }
    }

    /// What the surfaces take of the group of this index.
    pub fn requests(&self, index: usize) -> Vec<LightRequest> {
        let [first, later] = self.taken;
        let kinds = match first == later {
            true => vec![(first, [true; 2])],
            false => vec![(first, [true, false]), (later, [false, true])],
        };
        let all_cast_shadows = self.members.iter().all(SampledEmitter::casts_shadows);
        let mut requests = Vec::new();
        for (taken, takes) in kinds {
            let mut add = |number: usize, source: RequestedSource, is_sampled: bool, casts_shadows: bool| {
                requests.push(LightRequest {
                    layer: self.layer,
                    number: self.layer.0.wrapping_mul(REQUESTS).wrapping_add(number as u32),
                    group: index,
                    source,
                    takes,
                    is_sampled,
                    some_unshadowed: !casts_shadows,
                });
            };
            match taken {
                Taken::All => {
                    for (number, member) in self.members.iter().enumerate() {
                        let source = RequestedSource::Member(number);
                        add(number, source, member.is_sampled(), member.casts_shadows());
                    }
                }
                Taken::Chosen(count) => {
                    for number in 0..count {
                        let source = RequestedSource::Chosen(number, count);
                        add(MAX_SAMPLED + number, source, true, all_cast_shadows);
                    }
                }
            }
        }
        requests
    }

    /// How many samples of a member surfaces at points may expect, in the lanes of a mask at the first surface of a
    /// path, in the others at a later one.
    #[inline(always)]
    pub fn expected<F: Real>(&self, member: usize, at: Vec3<F>, is_first: F::Mask) -> F {
        let one = F::splat(1.0);
        let Some(GroupChoice { among, .. }) = &self.choice else { return one };
        let (chance, mut counts) = (among.chance(member, at), [one; 2]);
        for (count, taken) in counts.iter_mut().zip(&self.taken) {
            if let Taken::Chosen(chosen) = taken {
                *count = chance * F::splat(*chosen as f64);
            }
        }
        F::select(is_first, counts[0], counts[1])
    }
}

/// What the first surface of a path samples of these sources, and what each later one. Noise of a choice shows most in what
/// is seen directly, and where the sources, such as points, would give light without noise.
fn taken(sources: &[SampledEmitter]) -> [Taken; 2] {
    let some_have_none = !sources.iter().all(SampledEmitter::is_sampled);
    match sources.len() {
        0..=1 => [Taken::All; 2],
        2..=FEW if some_have_none => [Taken::All; 2],
        2 => [Taken::All, Taken::Chosen(1)],
        3..=MAX_SAMPLED if some_have_none => [Taken::All, Taken::Chosen(1)],
        3..=MAX_SAMPLED => [Taken::Chosen(2), Taken::Chosen(1)],
        _ => [Taken::Chosen(1); 2],
    }
}
