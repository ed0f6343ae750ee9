//! Decides which frames share a film, and how long films stay in the cache.
//!
//! Frames with equal scene hashes can share a film. The film is traced with every layer that any of its frames shows,
//! and weighted for each frame. It stays in the cache from its first frame to its last while memory suffices.
//! Otherwise, the film whose next use is farthest away is dropped (Belady 1966) and traced again when needed.

use crate::base::color::Rgb;
use crate::base::digest::Digest;
use crate::film::{AovSet, LayerId};
use crate::pipeline::schedule::FrameState;
use crate::sequence::Sequence;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A film to trace, and the frames that use it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SharedFilm {
    /// Traced layers, ascending: those that any of its frames shows.
    pub lit: Vec<LayerId>,
    /// Indices of its frames in the list of frame states, ascending. It is traced for the first.
    pub frames: Vec<usize>,
}

/// The size of films, and the memory limit of the cache in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmCache {
    pub pixels: u64,
    /// Layers of every film besides light.
    pub aovs: u64,
    pub budget: u64,
}

impl FilmCache {
    /// The cache for films of a sequence with these layers besides light.
    pub fn of(sequence: &Sequence, aovs: AovSet, budget: u64) -> Self {
        let (width, height) = sequence.output.size;
        Self { pixels: u64::from(width) * u64::from(height), aovs: aovs.layers() as u64, budget }
    }

    /// Bytes of a film with this number of light layers.
    pub fn bytes(&self, lit: usize) -> u64 {
        let layer = size_of::<Rgb>() as u64;
        self.pixels.saturating_mul((lit as u64 + self.aovs).saturating_mul(layer))
    }
}

/// A film in the cache.
struct CachedFilm {
    shared: usize,
    bytes: u64,
    /// Index of the current frame among the frames of the same scene hash, and of the last frame whose layers the film
    /// has.
    place: usize,
    until: usize,
}

/// The films for these frames in order, and the index of each frame's film.
pub fn shared_films(states: &[FrameState], cache: &FilmCache) -> (Vec<SharedFilm>, Vec<usize>) {
    let mut alike: HashMap<Digest, Vec<usize>> = HashMap::new();
    for (index, state) in states.iter().enumerate().filter(|(_, state)| state.fault.is_none()) {
        alike.entry(state.scene_hash).or_default().push(index);
    }
    let (mut films, mut film_of) = (Vec::new(), Vec::with_capacity(states.len()));
    // Keyed by the frame that needs the film next.
    let mut kept: BTreeMap<usize, CachedFilm> = BTreeMap::new();
    let mut bytes = 0;
    // Current position in each list of equal frames.
    let mut come: HashMap<Digest, usize> = HashMap::new();
    for (index, state) in states.iter().enumerate() {
        let frames = alike.get(&state.scene_hash).map_or(&[][..], Vec::as_slice);
        let place = *come.entry(state.scene_hash).and_modify(|place| *place += 1).or_insert(0);
        let film = kept.remove(&index).map(|film| CachedFilm { place, ..film }).unwrap_or_else(|| {
            let (until, lit) = reach(states, frames, place, cache);
            films.push(SharedFilm { lit: Vec::new(), frames: Vec::new() });
            let size = cache.bytes(lit);
            bytes += size;
            CachedFilm { shared: films.len() - 1, bytes: size, place, until }
        });
        films[film.shared].frames.push(index);
        film_of.push(film.shared);
        if film.place < film.until {
            kept.insert(frames[film.place + 1], film);
        } else {
            bytes -= film.bytes;
        }
        while bytes > cache.budget
            && let Some((_, last)) = kept.pop_last()
        {
            bytes -= last.bytes;
        }
    }
    for shared in &mut films {
        let all: BTreeSet<LayerId> = shared.frames.iter().flat_map(|&index| states[index].lit()).collect();
        shared.lit = all.into_iter().collect();
    }
    (films, film_of)
}

/// The last index in `frames` that a film can serve if it is traced for the frame at `place`, has all layers up to
/// there and fits into the cache; and its number of layers.
fn reach(states: &[FrameState], frames: &[usize], place: usize, cache: &FilmCache) -> (usize, usize) {
    let mut layers: BTreeSet<LayerId> = BTreeSet::new();
    let mut until = place;
    for (index, &frame) in frames.iter().enumerate().skip(place) {
        let more: Vec<LayerId> =
            states[frame].lit().into_iter().filter(|layer| !layers.contains(layer)).collect();
        if index > place && cache.bytes(layers.len() + more.len()) > cache.budget {
            break;
        }
        layers.extend(more);
        until = index;
    }
    (until, layers.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frame states from their scene hashes and the layers that they show.
    fn frame_states(frames: &[(u128, &[usize])]) -> Vec<FrameState> {
        let state = |(frame, (scene_hash, lit)): (u32, &(u128, &[usize]))| {
            let mut weights = vec![Rgb::ZERO; 4];
            lit.iter().for_each(|&layer| weights[layer] = Rgb::ONE);
            FrameState { frame, scene_hash: Digest(*scene_hash), weights, ..FrameState::default() }
        };
        (0..).zip(frames).map(state).collect()
    }

    /// The films of frames if the cache holds `cache` layers of one pixel: their layers, and the film of each frame.
    fn films(frames: &[(u128, &[usize])], cache: u64) -> (Vec<Vec<u32>>, Vec<usize>) {
        let cache = FilmCache { pixels: 1, aovs: 0, budget: cache * size_of::<Rgb>() as u64 };
        let (films, of) = shared_films(&frame_states(frames), &cache);
        for (film, shared) in films.iter().enumerate() {
            assert!(shared.frames.iter().all(|&index| of[index] == film));
        }
        (films.iter().map(|shared| shared.lit.iter().map(|layer| layer.0).collect()).collect(), of)
    }

    #[test]
    fn one_film_has_the_layers_of_all_its_frames() {
        let frames: [(u128, &[usize]); 4] = [(1, &[0, 1]), (1, &[0]), (1, &[0, 3]), (1, &[])];
        assert_eq!(films(&frames, 100), (vec![vec![0, 1, 3]], vec![0, 0, 0, 0]));
    }

    #[test]
    fn films_are_kept_over_others() {
        let frames: [(u128, &[usize]); 6] =
            [(1, &[0]), (2, &[0]), (3, &[0]), (2, &[1]), (1, &[0]), (4, &[0])];
        assert_eq!(films(&frames, 100).1, [0, 1, 2, 1, 0, 3]);
    }

    #[test]
    fn without_room_frames_stand_alone() {
        let frames: [(u128, &[usize]); 3] = [(1, &[0, 1]), (1, &[0, 1]), (1, &[0])];
        assert_eq!(films(&frames, 0), (vec![vec![0, 1], vec![0, 1], vec![0]], vec![0, 1, 2]));
        // A cache of one layer is enough for the frame with one layer.
        assert_eq!(films(&frames, 1).1, [0, 1, 2]);
    }

    #[test]
    fn layers_that_do_not_fit_make_a_film_of_their_own() {
        let frames: [(u128, &[usize]); 5] = [(1, &[0, 1]), (1, &[1]), (1, &[0, 2]), (1, &[2]), (1, &[1])];
        assert_eq!(films(&frames, 2), (vec![vec![0, 1], vec![0, 2], vec![1]], vec![0, 0, 1, 1, 2]));
        assert_eq!(films(&frames, 3), (vec![vec![0, 1, 2]], vec![0; 5]));
    }

    /// If only one of two films fits, the one needed sooner stays. The other film has no layers for frames that it
    /// does not serve.
    #[test]
    fn the_film_needed_last_is_dropped() {
        let frames: [(u128, &[usize]); 6] =
            [(1, &[0]), (2, &[0]), (2, &[0]), (2, &[0]), (1, &[0]), (1, &[0])];
        assert_eq!(films(&frames, 1).1, [0, 1, 1, 1, 2, 2]);
    }
}
