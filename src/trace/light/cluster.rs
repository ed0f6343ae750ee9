//! Clusters of light sources: where there are many, those near each other are weighed as one.

use super::importance::{Facing, Importance};
use crate::base::math::{Aabb, DVec3};

/// Sources that are weighed as one.
pub struct Cluster {
    /// What all of them may give.
    pub importance: Importance,
    /// Each source, and the share of the cluster's light that it may give far away.
    pub members: Vec<(usize, f64)>,
}

/// A source whose light falls with the distance.
struct Located {
    source: usize,
    place: DVec3,
}

/// At most so many clusters, two or more, with each source in one of them. They depend on the sources alone, so what moves
/// beside them changes no choice.
pub fn clusters(sources: &[Importance], most: usize) -> Vec<Cluster> {
    let (mut near, mut everywhere) = (Vec::new(), Vec::new());
    for (source, importance) in sources.iter().enumerate() {
        match importance.place() {
            Some(place) => near.push(Located { source, place }),
            None => everywhere.push(source),
        }
    }
    let everywhere = (!everywhere.is_empty()).then(|| Cluster::everywhere(&everywhere, sources));
    let mut near = if near.is_empty() { vec![] } else { vec![near] };
    while near.len() + usize::from(everywhere.is_some()) < most {
        // The one with most sources: unlike sizes, counts do not depend on lights that are far away and give little.
        let largest = (0..near.len()).max_by_key(|index| near[*index].len());
        let Some(largest) = largest.filter(|index| near[*index].len() > 1) else { break };
        let halves = halves(near.swap_remove(largest));
        near.extend(halves);
    }
    near.iter().map(|members| Cluster::near(members, sources)).chain(everywhere).collect()
}

impl Cluster {
    /// Sources whose light is taken to be the same everywhere.
    fn everywhere(members: &[usize], sources: &[Importance]) -> Self {
        let (whole, members) = shares(members.iter().copied(), sources);
        Self { importance: Importance::Distant(whole), members }
    }

    /// Sources near each other.
    fn near(located: &[Located], sources: &[Importance]) -> Self {
        let (whole, members) = shares(located.iter().map(|member| member.source), sources);
        if let [(source, _)] = members[..] {
            return Self { importance: sources[source], members };
        }
        let all = || located.iter().zip(&members).map(|(member, (_, share))| (member, *share));
        let mean = all().map(|(member, share)| member.place * share).sum::<DVec3>();
        let known = members.iter().any(|(_, share)| *share > 0.0);
        let center =
            if known { mean } else { Aabb::around(located.iter().map(|member| member.place)).center() };
        // Among them, their mean square of the distance counts.
        let square =
            |member: &Located| member.place.distance_squared(center) + sources[member.source].least_square();
        let facing = sources[located[0].source].facing();
        let all_alike = located.iter().all(|member| sources[member.source].facing() == facing);
        let importance = Importance::Area {
            center,
            brightness: whole,
            least_square: all().map(|(member, share)| square(member) * share).sum(),
            facing: if all_alike { facing } else { Facing::All },
        };
        Self { importance, members }
    }
}

/// What these sources may give far away, and the share of each: 0 if all give nothing, or too much for a number.
fn shares(members: impl Iterator<Item = usize>, sources: &[Importance]) -> (f64, Vec<(usize, f64)>) {
    let mut members: Vec<(usize, f64)> =
        members.map(|source| (source, sources[source].far_light())).collect();
    let whole = members.iter().map(|(_, light)| light).sum::<f64>();
    let is_known = whole > 0.0 && whole < f64::INFINITY;
    members.iter_mut().for_each(|(_, share)| *share = if is_known { *share / whole } else { 0.0 });
    (whole, members)
}

/// Both sides of the middle of the longest axis. If one has none, as all are in one place, equally many in each.
fn halves(members: Vec<Located>) -> [Vec<Located>; 2] {
    let all = Aabb::around(members.iter().map(|member| member.place));
    let (axis, middle) = (all.size().max_position(), all.center());
    let count = members.len();
    let (mut low, mut high): (Vec<_>, Vec<_>) =
        members.into_iter().partition(|member| member.place[axis] < middle[axis]);
    if high.len() == count {
        low = high.split_off(count / 2);
    }
    [low, high]
}
