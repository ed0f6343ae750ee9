//! Which frames share a film, and how long films are kept.
//!
//! Frames of equal transport can be made of one film: it is traced with every layer of light that any of them shows, and
//! weighted for each. It is kept from the first of them to the last, however many others lie in between, as long as
//! there is room. Beyond that, the film that is wanted again last gives way, as Belady's rule has it (1966), and is
//! traced anew when it is wanted.

use crate::base::color::Rgb;
use crate::base::digest::Digest;
use crate::film::{Extras, LayerId};
use crate::pipeline::schedule::Look;
use crate::sequence::Sequence;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A film that will be traced, and the frames that are made of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Take {
    /// The layers that are traced, ascending: those that any of its frames shows.
    pub lit: Vec<LayerId>,
    /// Where in the survey its frames are, ascending. It is traced for the first of them.
    pub frames: Vec<usize>,
}

/// How large films are, and how many bytes those may have that are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    pub pixels: u64,
    /// Layers that every film has besides those of light.
    pub extras: u64,
    pub budget: u64,
}

impl Room {
    /// For films of a sequence that have these layers besides light.
    pub fn of(sequence: &Sequence, extras: Extras, budget: u64) -> Self {
        let (width, height) = sequence.output.size;
        Self { pixels: u64::from(width) * u64::from(height), extras: extras.layers() as u64, budget }
    }

    /// Bytes of a film with so many layers of light.
    pub fn bytes(&self, lit: usize) -> u64 {
        let layer = size_of::<Rgb>() as u64;
        self.pixels.saturating_mul((lit as u64 + self.extras).saturating_mul(layer))
    }
}

/// A film that is kept.
struct Kept {
    take: usize,
    bytes: u64,
    /// Its place in the list of the frames of its transport, and the last one that it has the layers for.
    place: usize,
    until: usize,
}

/// The films for frames in this order, and of each frame the index of its film.
pub fn takes(looks: &[Look], room: &Room) -> (Vec<Take>, Vec<usize>) {
    let mut alike: HashMap<Digest, Vec<usize>> = HashMap::new();
    for (index, look) in looks.iter().enumerate().filter(|(_, look)| look.fault.is_none()) {
        alike.entry(look.transport).or_default().push(index);
    }
    let (mut takes, mut of) = (Vec::new(), Vec::with_capacity(looks.len()));
    // By the frame that each is wanted for next.
    let mut kept: BTreeMap<usize, Kept> = BTreeMap::new();
    let mut bytes = 0;
    // How far the lists of frames have come.
    let mut come: HashMap<Digest, usize> = HashMap::new();
    for (index, look) in looks.iter().enumerate() {
        let frames = alike.get(&look.transport).map_or(&[][..], Vec::as_slice);
        let place = *come.entry(look.transport).and_modify(|place| *place += 1).or_insert(0);
        let film = kept.remove(&index).map(|film| Kept { place, ..film }).unwrap_or_else(|| {
            let (until, lit) = reach(looks, frames, place, room);
            takes.push(Take { lit: Vec::new(), frames: Vec::new() });
            let size = room.bytes(lit);
            bytes += size;
            Kept { take: takes.len() - 1, bytes: size, place, until }
        });
        takes[film.take].frames.push(index);
        of.push(film.take);
        if film.place < film.until {
            kept.insert(frames[film.place + 1], film);
        } else {
            bytes -= film.bytes;
        }
        while bytes > room.budget
            && let Some((_, last)) = kept.pop_last()
        {
            bytes -= last.bytes;
        }
    }
    for take in &mut takes {
        let all: BTreeSet<LayerId> = take.frames.iter().flat_map(|&index| looks[index].lit()).collect();
        take.lit = all.into_iter().collect();
    }
    (takes, of)
}

/// How far in the list of frames of one transport a film serves that is traced for the one at `place`, if it has all
/// layers for those up to there and may not be larger than the room; and how many layers these are.
fn reach(looks: &[Look], frames: &[usize], place: usize, room: &Room) -> (usize, usize) {
    let mut layers: BTreeSet<LayerId> = BTreeSet::new();
    let mut until = place;
    for (index, &frame) in frames.iter().enumerate().skip(place) {
        let more: Vec<LayerId> =
            looks[frame].lit().into_iter().filter(|layer| !layers.contains(layer)).collect();
        if index > place && room.bytes(layers.len() + more.len()) > room.budget {
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

    /// Frames by their transport and the layers that they show.
    fn looks(frames: &[(u128, &[usize])]) -> Vec<Look> {
        let look = |(frame, (transport, lit)): (u32, &(u128, &[usize]))| {
            let mut weights = vec![Rgb::ZERO; 4];
            lit.iter().for_each(|&layer| weights[layer] = Rgb::ONE);
            Look { frame, transport: Digest(*transport), weights, ..Look::default() }
        };
        (0..).zip(frames).map(look).collect()
    }

    /// The films of frames with room for so many layers of one pixel: their layers, and of each frame its film.
    fn films(frames: &[(u128, &[usize])], room: u64) -> (Vec<Vec<u32>>, Vec<usize>) {
        let room = Room { pixels: 1, extras: 0, budget: room * size_of::<Rgb>() as u64 };
        let (takes, of) = takes(&looks(frames), &room);
        for (film, take) in takes.iter().enumerate() {
            assert!(take.frames.iter().all(|&index| of[index] == film));
        }
        (takes.iter().map(|take| take.lit.iter().map(|layer| layer.0).collect()).collect(), of)
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
        // Room for one layer serves the frame that needs no more.
        assert_eq!(films(&frames, 1).1, [0, 1, 2]);
    }

    #[test]
    fn layers_that_do_not_fit_make_a_film_of_their_own() {
        let frames: [(u128, &[usize]); 5] = [(1, &[0, 1]), (1, &[1]), (1, &[0, 2]), (1, &[2]), (1, &[1])];
        assert_eq!(films(&frames, 2), (vec![vec![0, 1], vec![0, 2], vec![1]], vec![0, 0, 1, 1, 2]));
        assert_eq!(films(&frames, 3), (vec![vec![0, 1, 2]], vec![0; 5]));
    }

    /// Of two films where there is room for one, that which is wanted sooner stays; the other has no layers for
    /// frames that it does not serve.
    #[test]
    fn what_is_wanted_last_gives_way() {
        let frames: [(u128, &[usize]); 6] =
            [(1, &[0]), (2, &[0]), (2, &[0]), (2, &[0]), (1, &[0]), (1, &[0])];
        assert_eq!(films(&frames, 1).1, [0, 1, 1, 1, 2, 2]);
    }
}
