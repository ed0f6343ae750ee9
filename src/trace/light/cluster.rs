//! Clusters of light sources: where there are many, those near each other are weighed as one.

use super::importance::{Facing, Importance};
use crate::base::math::{Aabb, DVec3};

/// Sources that are weighed as one.
pub struct Cluster {
    /// What all of them may give.
    pub importance: Importance,
    /// Each source, and the share of the cluster's light that it may give at a distance.
    pub members: Vec<(usize, f64)>,
}

/// A source that is somewhere.
struct Located {
    source: usize,
    place: DVec3,
    /// What it may give at a distance, times the square of the distance.
    brightness: f64,
}

/// At most so many clusters, with each source in one of them. They depend on the sources alone, so what moves beside them
/// changes no choice.
pub fn clusters(sources: &[Importance], most: usize) -> Vec<Cluster> {
    let far: Vec<usize> = (0..sources.len()).filter(|index| sources[*index].place().is_none()).collect();
    let mut near = vec![located(sources)];
    while near.len() + usize::from(!far.is_empty()) < most {
        // The cluster whose estimate is the most wrong.
        let wrong = near.iter().map(|members| total(members) * bounds(members).size().length_squared());
        let (mut worst, mut greatest) = (None, 0.0);
        for (index, wrong) in wrong.enumerate() {
            if wrong > greatest {
                (worst, greatest) = (Some(index), wrong);
            }
        }
        let Some(worst) = worst else { break };
        let halves = halves(near.swap_remove(worst));
        near.extend(halves);
    }
    let far = (!far.is_empty()).then(|| Cluster::distant(&far, sources));
    let near = near.iter().filter(|members| !members.is_empty());
    near.map(|members| Cluster::near(members, sources)).chain(far).collect()
}

impl Cluster {
    /// Sources that give the same everywhere.
    fn distant(members: &[usize], sources: &[Importance]) -> Self {
        let brightness = |source: usize| sources[source].brightness_from(1.0);
        let whole = members.iter().map(|source| brightness(*source)).sum();
        let members = members.iter().map(|source| (*source, share(brightness(*source), whole)));
        Self { importance: Importance::Distant(whole), members: members.collect() }
    }

    /// Sources near each other.
    fn near(members: &[Located], sources: &[Importance]) -> Self {
        if let [Located { source, .. }] = members {
            return Self { importance: sources[*source], members: vec![(*source, 1.0)] };
        }
        let whole = total(members);
        let shares = || members.iter().map(|member| (member, share(member.brightness, whole)));
        let mean = shares().map(|(member, share)| member.place * share).sum::<DVec3>();
        let center = if whole > 0.0 { mean } else { bounds(members).center() };
        // Among them, their mean distance counts.
        let square =
            |member: &Located| member.place.distance_squared(center) + sources[member.source].least_square();
        let facing = sources[members[0].source].facing();
        let all_alike = members.iter().all(|member| sources[member.source].facing() == facing);
        Self {
            importance: Importance::Area {
                center,
                brightness: whole,
                least_square: shares().map(|(member, share)| square(member) * share).sum(),
                facing: if all_alike { facing } else { Facing::All },
            },
            members: shares().map(|(member, share)| (member.source, share)).collect(),
        }
    }
}

/// The share of a whole; 0 of nothing.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// All sources that are somewhere.
fn located(sources: &[Importance]) -> Vec<Located> {
    let all = Aabb::around(sources.iter().filter_map(Importance::place));
    let distance = 0.5 * all.size().length();
    // Sources that are all in one place are compared at any distance.
    let distance = if distance > 0.0 { distance } else { 1.0 };
    let one = |(source, importance): (usize, &Importance)| {
        let brightness = importance.brightness_from(distance);
        importance.place().map(|place| Located { source, place, brightness })
    };
    sources.iter().enumerate().filter_map(one).collect()
}

fn bounds(members: &[Located]) -> Aabb {
    Aabb::around(members.iter().map(|member| member.place))
}

fn total(members: &[Located]) -> f64 {
    members.iter().map(|member| member.brightness).sum()
}

/// Both sides of the middle of the longest axis.
fn halves(members: Vec<Located>) -> [Vec<Located>; 2] {
    let all = bounds(&members);
    let (axis, middle) = (all.size().max_position(), all.center());
    let (low, high) = members.into_iter().partition(|member| member.place[axis] < middle[axis]);
    [low, high]
}
