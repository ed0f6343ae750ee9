//! Groups of frames that one process should render, because another one would trace the same again.

use crate::base::digest::Digest;
use crate::pipeline::schedule::FrameState;
use std::collections::HashMap;

/// Frames for one process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkGroup {
    /// What processes that render the same frames call it.
    pub name: Digest,
    /// Indices of the frames in the list of frame states, ascending.
    pub frames: Vec<usize>,
}

/// Groups of frames that share a film, samples of views, or most of the samples of their neighbours. In the order of their
/// first frames.
pub fn work_groups(states: &[FrameState]) -> Vec<WorkGroup> {
    let mut groups = Groups { above: (0..states.len()).collect() };
    let (mut films, mut blocks) = (HashMap::new(), HashMap::new());
    for (index, state) in states.iter().enumerate() {
        groups.join(*films.entry(state.shared_work()).or_insert(index), index);
        if let Some(block) = state.block() {
            groups.join(*blocks.entry(block).or_insert(index), index);
        }
    }
    let mut found: Vec<WorkGroup> = Vec::new();
    let mut places: HashMap<usize, usize> = HashMap::new();
    for (index, state) in states.iter().enumerate() {
        let place = *places.entry(groups.first(index)).or_insert(found.len());
        match found.get_mut(place) {
            Some(group) => group.frames.push(index),
            None => found.push(WorkGroup { name: state.shared_work(), frames: vec![index] }),
        }
    }
    for group in &mut found {
        // Processes that begin later know fewer of the frames, so the first one gives no name.
        let block = group.frames.iter().filter_map(|&index| states[index].block()).min();
        group.name = block.map_or(group.name, |block| Digest::of(&block));
    }
    found
}

/// For each frame, one before it in the same group, or itself.
struct Groups {
    above: Vec<usize>,
}

impl Groups {
    fn first(&self, mut index: usize) -> usize {
        while self.above[index] != index {
            index = self.above[index];
        }
        index
    }

    fn join(&mut self, one: usize, other: usize) {
        let [one, other] = [one, other].map(|index| self.first(index));
        self.above[one.max(other)] = one.min(other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::schedule::SampledState;

    /// Groups of frames with these films, by the indices of their frames.
    fn groups(films: &[u128], has_neighbors: bool) -> Vec<Vec<usize>> {
        let neighbor = || SampledState::default();
        let state = |(frame, film): (u32, &u128)| FrameState {
            frame,
            scene_hash: Digest(*film),
            neighbors: has_neighbors.then(|| [neighbor(), neighbor()].into()),
            ..FrameState::default()
        };
        let states: Vec<FrameState> = (0..).zip(films).map(state).collect();
        work_groups(&states).into_iter().map(|group| group.frames).collect()
    }

    #[test]
    fn frames_of_a_film_are_together() {
        assert_eq!(groups(&[1, 2, 1, 3, 2], false), [vec![0, 2], vec![1, 4], vec![3]]);
    }

    /// A film of the first block is shown in the third one, so both are together.
    #[test]
    fn neighbors_are_together_with_all_frames_of_their_films() {
        let mut films: Vec<u128> = (0..24).collect();
        films[20] = 3;
        let all = groups(&films, true);
        assert_eq!(all, [(0..8).chain(16..24).collect::<Vec<_>>(), (8..16).collect()]);
        assert_eq!(groups(&films, false).len(), 23);
    }
}
