//! The light sources of a layer, and the samples that surfaces take of them.

use super::area_table::AreaTable;
use super::sampled_emitter::SampledEmitter;
use super::source_choice::SourceChoice;
use crate::base::lanes::{Mask, Real, Vec3};
use crate::film::LayerId;
use crate::scene::Scene;

/// The most sources of a layer that may all be sampled at a surface.
const MAX_SAMPLED: usize = 8;

/// How many numbers separate the requests of a layer.
const REQUESTS: u32 = 2 * MAX_SAMPLED as u32;

/// The sources of a layer.
pub struct SourceGroup<'a> {
    pub layer: LayerId,
    pub members: Vec<SampledEmitter<'a>>,
    /// How members are chosen; `None` if all are sampled everywhere.
    pub choice: Option<GroupChoice>,
}

pub struct GroupChoice {
    pub among: SourceChoice,
    /// The members that lanes sample together.
    pub areas: AreaTable,
    /// The samples of the first surface of a path, and of each later one.
    samples: [usize; 2],
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
        let samples = samples_of(&members);
        let has_choice = choice && samples.iter().any(|samples| *samples < members.len());
        let choice = has_choice.then(|| GroupChoice {
            among: SourceChoice::new(&members, scene),
            areas: AreaTable::new(&members, scene),
            samples,
        });
        Self { layer, members, choice }
    }

    /// What the surfaces take of the group of this index.
    pub fn requests(&self, index: usize) -> Vec<LightRequest> {
        let (members, mut requests) = (&self.members, Vec::new());
        let mut add = |number: usize, source: RequestedSource, takes: [bool; 2]| {
            let (is_sampled, casts_shadows) = match source {
                RequestedSource::Member(member) => {
                    (members[member].is_sampled(), members[member].casts_shadows())
                }
                RequestedSource::Chosen(..) => (true, members.iter().all(SampledEmitter::casts_shadows)),
            };
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
        let samples = self.choice.as_ref().map_or([members.len(); 2], |choice| choice.samples);
        let takes_all = samples.map(|samples| members.len() <= samples);
        if takes_all != [false; 2] {
            (0..members.len()).for_each(|member| add(member, RequestedSource::Member(member), takes_all));
        }
        let [first, later] = samples;
        let chosen = match takes_all {
            [true, true] => vec![],
            [true, false] => vec![(later, [false, true])],
            [false, true] => vec![(first, [true, false])],
            [false, false] if first == later => vec![(first, [true; 2])],
            [false, false] => vec![(first, [true, false]), (later, [false, true])],
        };
        for (samples, takes) in chosen {
            for number in 0..samples {
                add(MAX_SAMPLED + number, RequestedSource::Chosen(number, samples), takes);
            }
        }
        requests
    }

    /// How many samples of a member surfaces at points may expect, in the lanes of a mask at the first surface of a
    /// path, in the others at a later one.
    #[inline(always)]
    pub fn expected<F: Real>(&self, member: usize, at: Vec3<F>, is_first: F::Mask) -> F {
        let one = F::splat(1.0);
        let Some(GroupChoice { among, samples: [first, later], .. }) = &self.choice else { return one };
        let (count, chance) = (self.members.len(), among.chance(member, at));
        let first = if *first < count { chance * F::splat(*first as f64) } else { one };
        let later = if *later < count { chance * F::splat(*later as f64) } else { one };
        F::select(is_first, first, later)
    }
}

/// How many light samples the first surface of a path takes from these sources, and how many each later one. If they
/// are no more than that, each is sampled once. What is seen directly shows the noise of a choice most, above all that
/// of sources whose light would have none.
fn samples_of(sources: &[SampledEmitter]) -> [usize; 2] {
    let first = match sources.len() {
        count if count > MAX_SAMPLED => 1,
        count if !sources.iter().all(SampledEmitter::is_sampled) => count,
        _ => 2,
    };
    [first, 1]
}
